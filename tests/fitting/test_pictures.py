"""From a picture back to numbers: the way of a fit, its errors, and what it refuses."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import fitting
import jaxocean as jo
from fitting.pictures import PictureTarget, SceneModel, View, _descent, fit_picture, recover_waves
from fitting.pictures._descent import Descent
from fitting.pictures._sandwich import sandwich

SIZE = (40, 56)


class Stripes(eqx.Module):
    """A picture of two sets of stripes: quick to draw, and not linear in what it is made from."""

    phase: jax.Array
    contrast: jax.Array
    choppiness: jax.Array
    exposure: jax.Array
    unseen: jax.Array

    def __init__(self, phase=0.3, contrast=0.5, choppiness=0.8, exposure=1.0, unseen=2.0):
        self.phase, self.contrast = jnp.asarray(phase), jnp.asarray(contrast)
        self.choppiness, self.exposure, self.unseen = (
            jnp.asarray(choppiness),
            jnp.asarray(exposure),
            jnp.asarray(unseen),
        )

    def picture(self, size, method):
        y, x = jnp.meshgrid(*(jnp.arange(side, dtype=float) for side in size), indexing="ij")
        crest = jnp.sin(0.5 * y + 0.1 * x + self.phase) + self.choppiness * jnp.sin(0.23 * x - 0.3 * y)
        grey = jnp.exp(self.contrast * crest)
        return jnp.exp2(self.exposure) * jnp.stack([grey, 0.9 * grey, 0.5 + grey], axis=-1)

    def log_coverage(self, wind):
        return -self.unseen * 20 / wind.speed


def free(model):
    return model.phase, model.contrast, model.choppiness, model.exposure


TRUTH = Stripes()
START = Stripes(0.8, 0.35, 1.1, 0.2)
NAMES = ("phase", "contrast", "choppiness", "exposure")


@pytest.fixture(scope="module")
def target():
    return PictureTarget(TRUTH.picture(SIZE, None))


def test_numbers_are_found_again_and_each_step_is_told(target):
    told = []
    found = fit_picture(START, free, target, report=told.append)
    for name in NAMES:
        np.testing.assert_allclose(found.values[name], getattr(TRUTH, name), atol=1e-4)
        np.testing.assert_allclose(getattr(found.model, name), getattr(TRUTH, name), atol=1e-4)
    assert found.model.unseen == START.unseen
    assert told == list(found.steps)
    assert told[0].values == {name: float(getattr(START, name)) for name in NAMES}
    assert [step.number for step in told] == list(range(len(told)))
    for finest in (8, 1):
        costs = [step.cost for step in told if step.finest == finest]
        assert costs == sorted(costs, reverse=True)
    assert found.cost < 1e-6 * told[0].cost


def test_residuals_are_means_over_growing_squares():
    rng = np.random.default_rng(0)
    first, second = rng.uniform(0.1, 2, (2, 5, 7, 3))
    mask = rng.uniform(0, 1, (5, 7))
    target = PictureTarget(jnp.asarray(second), jnp.asarray(mask), levels=3)
    found = np.asarray(target.residuals(jnp.asarray(first)))
    middle = np.median(second @ np.asarray(jo.optics.luminance(jnp.eye(3))))
    apart = np.zeros((8, 8, 3))
    apart[:5, :7] = mask[..., None] * (np.log1p(first / middle) - np.log1p(second / middle))
    expected = []
    for level, (rows, columns) in enumerate(((5, 7), (3, 4), (2, 2))):
        side = 2**level
        means = apart.reshape(8 // side, side, 8 // side, side, 3).mean(axis=(1, 3))
        expected.append(side * means[:rows, :columns].ravel())
    np.testing.assert_allclose(found, np.concatenate(expected), rtol=1e-12, atol=1e-14)
    # The transpose: what pixels add to a weighted sum of residuals.
    weights = rng.normal(0, 1, found.size)
    by_pixels = np.asarray(target.of_pixels(jnp.asarray(weights))) @ apart[:5, :7].ravel()
    np.testing.assert_allclose(by_pixels, weights @ found, rtol=1e-10)


class Rough(Stripes):
    def picture(self, size, method):
        exact = super().picture(size, method)
        # Too little contrast, as a mesh that loses the shortest waves.
        return exact if isinstance(method, jo.render.Rays) else exact**0.97


def test_a_more_exact_method_at_the_end_takes_out_what_the_quick_one_gets_wrong():
    truth, start = Rough(), Rough(0.8, 0.35, 1.1, 0.2)
    target = PictureTarget(truth.picture(SIZE, jo.render.Rays()))
    quick = fit_picture(start, free, target)
    exact = fit_picture(start, free, target, finish=jo.render.Rays())
    assert abs(quick.values["contrast"] - 0.5) > 0.005
    for name in NAMES:
        np.testing.assert_allclose(exact.values[name], getattr(truth, name), atol=1e-4)
    assert exact.cost < 1e-3 * quick.cost


def unexplained(size):
    return jnp.sin(0.11 * jnp.arange(size[1], dtype=float))[:, None]


class Astray(Stripes):
    """A mesh sees more in λ than there is."""

    def picture(self, size, method):
        more = 0.0 if isinstance(method, jo.render.Rays) else 0.3 * (self.choppiness - 0.8)
        return super().picture(size, method) * jnp.exp(more * unexplained(size))


def test_derivatives_by_differences_find_the_bottom_where_those_of_another_method_lead_beside_it(monkeypatch):
    rounds, refined = [], _descent._refined
    monkeypatch.setattr(_descent, "_refined", lambda *given: rounds.append(1) or refined(*given))
    rays = jo.render.Rays()
    # What no number explains pulls at wrong derivatives otherwise than at right ones.
    image = Stripes().picture(SIZE, rays) * jnp.exp(0.2 * unexplained(SIZE))
    target, start = PictureTarget(image), Astray(0.5, 0.4, 0.9, 0.8)
    best = fit_picture(start, free, target, method=rays, tolerance=1e-5)
    beside = fit_picture(start, free, target, finish=rays)
    found = fit_picture(start, free, target, finish=rays, refine=20)
    off, left = (
        max(abs(each.values[name] - best.values[name]) for name in NAMES) for each in (beside, found)
    )
    assert left < 1e-3 < off
    assert best.cost <= found.cost * (1 + 1e-6) < beside.cost
    assert 1 < len(rounds) < 6
    with pytest.raises(ValueError, match="Argument `refine`"):
        fit_picture(start, free, target, refine=1)


class Jagged(Astray):
    """Samples of pixels change by chance as crests move: steeply, and by little."""

    def picture(self, size, method):
        chance = 0.02 * jnp.sin(2e3 * self.choppiness + 7.0 * jnp.arange(size[0], dtype=float))
        return super().picture(size, method) * jnp.exp(chance[:, None, None])


def test_derivatives_over_wide_differences_lead_down_where_pictures_change_by_chance(monkeypatch):
    rays = jo.render.Rays()
    image = Stripes().picture(SIZE, rays) * jnp.exp(0.2 * unexplained(SIZE))
    target, start = PictureTarget(image), Jagged(0.3, 0.5, 0.82, 1.0)

    def found(**more):
        return fit_picture(start, lambda m: m.choppiness, target, finish=rays, tolerance=0.5, **more)

    wide = found(refine=6)
    monkeypatch.setattr(_descent, "DIFFERENCE", 1e-4)
    narrow = found(refine=6)
    off = [abs(each.values["choppiness"] - 0.8) for each in (wide, narrow)]
    assert off[0] < 0.01 < 0.02 < off[1]
    # Errors are those by the last of these derivatives: steep ones make them too small.
    assert off[0] < wide.errors["choppiness"]
    assert off[1] > 10 * narrow.errors["choppiness"]


class Pair(Stripes):
    """Each set of stripes has its own λ."""

    def picture(self, size, method):
        first, second = self.choppiness
        one = Stripes(self.phase, self.contrast, first, self.exposure).picture(size, method)
        return one * Stripes(self.phase + 1.0, self.contrast, second, 0.0).picture(size, method)


def test_a_number_may_be_one_for_each_pattern():
    truth, told = Pair(choppiness=jnp.array([0.7, 1.1])), []
    target = PictureTarget(truth.picture(SIZE, None))
    start = Pair(0.4, 0.4, jnp.array([1.0, 0.8]), 0.8)
    found = fit_picture(start, free, target, scouts=9, report=told.append)
    np.testing.assert_allclose(found.values["choppiness"], [0.7, 1.1], rtol=1e-3)
    assert found.errors["choppiness"].shape == told[-1].values["choppiness"].shape == (2,)
    assert found.covariance.shape == (5, 5)


def test_what_another_method_would_change_counts_as_an_error():
    truth, start = Rough(), Rough(0.8, 0.35, 1.1, 0.2)
    target = PictureTarget(truth.picture(SIZE, jo.render.Rays()))
    sure = fit_picture(start, free, target)
    found = fit_picture(start, free, target, doubts=[jo.render.Rays()])
    for name in NAMES:
        moved = abs(found.values[name] - float(getattr(truth, name)))
        expected = np.hypot(sure.errors[name], moved)
        np.testing.assert_allclose(found.errors[name], expected, rtol=0.05)
    assert found.errors["contrast"] > 3 * sure.errors["contrast"]


def test_pictures_at_the_end_are_drawn_with_more_detail():
    class Coarse(Stripes):
        def picture(self, size, method, detail=1):
            exact = super().picture(size, method)
            return exact if detail == 2 else exact**0.97

    target = PictureTarget(Coarse().picture(SIZE, None, 2))
    found = fit_picture(Coarse(0.8, 0.35, 1.1, 0.2), free, target, finish=jo.render.Rays(), detail=2)
    for name in NAMES:
        np.testing.assert_allclose(found.values[name], getattr(Stripes(), name), atol=1e-4)
    with pytest.raises(ValueError, match="Argument `detail`"):
        fit_picture(Coarse(), free, target, detail=0)


def test_scouts_begin_nearer_to_the_target(target):
    start = Stripes(3.2, 0.3, 1.4, 0.3)
    alone = fit_picture(start, free, target)
    found, again = (fit_picture(start, free, target, scouts=300) for _ in range(2))
    assert found.steps[0].cost < 0.5 * alone.steps[0].cost
    assert found.values == again.values
    for name in NAMES:
        np.testing.assert_allclose(found.values[name], getattr(TRUTH, name), atol=1e-4)
    with pytest.raises(ValueError, match="scouts"):
        fit_picture(start, free, target, scouts=-1)


def test_of_two_ways_down_only_the_lower_one_is_gone_on_with(target, monkeypatch):
    gone, go = [], Descent.go
    monkeypatch.setattr(Descent, "go", lambda way, most: gone.append((way, most)) or go(way, most))
    found = fit_picture(START, free, target, scouts=30)
    np.testing.assert_allclose(found.values["phase"], 0.3, atol=1e-4)
    (first, heat), (second, again), (best, most), (fine, _) = gone
    assert first is not second
    assert heat == again < most
    assert best is min(first, second, key=lambda way: way.cost)
    assert found.steps == tuple(best.steps + fine.steps)


def test_large_pictures_are_drawn_once_for_each_derivative_with_the_same_result(target, monkeypatch):
    small = fit_picture(START, free, target)
    monkeypatch.setattr(_descent, "LARGE", 0)
    monkeypatch.setattr(_descent, "look_once", None)
    large = fit_picture(START, free, target)
    assert len(large.steps) == len(small.steps)
    for name in NAMES:
        np.testing.assert_allclose(large.values[name], small.values[name], rtol=1e-6)
        np.testing.assert_allclose(large.errors[name], small.errors[name], rtol=1e-3, atol=1e-9)


def test_a_threshold_comes_back_from_where_there_is_no_foam():
    class Foamy(Stripes):
        threshold: jax.Array

        def __init__(self, *numbers, threshold):
            super().__init__(*numbers)
            self.threshold = jnp.asarray(threshold)

        def picture(self, size, method):
            plain = super().picture(size, method)
            share = jnp.mean(plain, axis=-1, keepdims=True) / 8
            foam = jax.nn.sigmoid((self.threshold - share) / 0.02)
            return (1 - foam) * plain + 20 * foam

    target = PictureTarget(Foamy(threshold=0.15).picture(SIZE, None))
    start = Foamy(0.3, 0.5, 0.8, 0.9, threshold=-2.0)
    found = fit_picture(start, lambda m: (m.exposure, m.threshold), target)
    np.testing.assert_allclose(found.values["threshold"], 0.15, atol=1e-3)
    np.testing.assert_allclose(found.values["exposure"], 1.0, atol=1e-3)


def test_of_several_methods_the_one_counts_that_explains_the_picture():
    truth, start = Rough(), Rough(0.8, 0.35, 1.1, 0.2)
    mesh, rays = jo.render.Raster(), jo.render.Rays()
    for method in (mesh, rays):
        target = PictureTarget(truth.picture(SIZE, method))
        found = fit_picture(start, free, target, finish=[mesh, rays])
        sure = fit_picture(start, free, target, finish=[method])
        for name in NAMES:
            np.testing.assert_allclose(found.values[name], getattr(truth, name), atol=1e-4)
        # The other is in doubt, and would have found another contrast.
        assert found.errors["contrast"] > sure.errors["contrast"] + 0.005


def test_what_is_masked_does_not_count(target):
    spoilt = target.image.at[:, 30:].set(7.0)
    mask = jnp.ones(SIZE).at[:, 30:].set(0.0)
    found = fit_picture(START, free, PictureTarget(spoilt, mask))
    for name in NAMES:
        np.testing.assert_allclose(found.values[name], getattr(TRUTH, name), atol=1e-4)


def test_what_the_picture_does_not_tell_is_left_to_the_prior(target):
    prior = fitting.Normal(3.0, 0.5, where=lambda m: m.unseen)
    found = fit_picture(START, lambda m: (*free(m), m.unseen), target, priors=[prior])
    np.testing.assert_allclose(found.values["unseen"], 3.0, atol=1e-3)
    np.testing.assert_allclose(found.errors["unseen"], 0.5, rtol=1e-3)
    np.testing.assert_allclose(found.values["phase"], TRUTH.phase, atol=1e-4)


def test_what_the_picture_does_not_tell_another_target_does(target):
    winds = [8.0, 12.0]
    points = fitting.CoveragePoints(winds, [np.exp(-3.0 * 20 / u) for u in winds], 0.1)
    found = fit_picture(START, lambda m: (*free(m), m.unseen), target, beside=points)
    np.testing.assert_allclose(found.values["unseen"], 3.0, atol=1e-3)
    # Of two independent data, each -20 unseen/U / ln 10 with a scatter of 0.1.
    expected = 0.1 * np.log(10) / np.hypot(20 / 8, 20 / 12)
    np.testing.assert_allclose(found.errors["unseen"], expected, rtol=1e-3)
    np.testing.assert_allclose(found.values["phase"], TRUTH.phase, atol=1e-4)
    with pytest.raises(ValueError, match="known scatter"):
        fit_picture(
            START, free, target, beside=fitting.CoveragePoints(winds, [0.1, 0.2], fitting.FreeScatter())
        )


def test_a_scatter_is_what_makes_independent_residuals_tell_as_much():
    rng = np.random.default_rng(1)
    rough = np.kron(rng.normal(0, 0.03, (8, 8)), np.ones((5, 7)))
    image = jnp.asarray(np.asarray(TRUTH.picture(SIZE, None)) * np.exp(rough)[..., None])
    found = fit_picture(TRUTH, free, PictureTarget(image))
    again = fit_picture(TRUTH, free, PictureTarget(image, scatter=found.scatter))
    np.testing.assert_allclose(again.scatter, found.scatter, rtol=1e-6)
    for name in NAMES:
        np.testing.assert_allclose(again.values[name], found.values[name], atol=1e-5)
        np.testing.assert_allclose(again.errors[name], found.errors[name], rtol=1e-3)
    # A prior as wide as the picture's own error halves the variance, if both weigh what they tell.
    name = "exposure"
    prior = fitting.Normal(found.values[name], found.errors[name], where=lambda m: m.exposure)
    held = fit_picture(
        TRUTH, lambda m: (m.exposure,), PictureTarget(image, scatter=found.scatter), priors=[prior]
    )
    alone = fit_picture(TRUTH, lambda m: (m.exposure,), PictureTarget(image, scatter=found.scatter))
    assert held.errors[name] < alone.errors[name]


def test_nine_in_ten_intervals_hold_the_truth_though_neighbours_err_together():
    rng = np.random.default_rng(1)
    clean = np.asarray(TRUTH.picture(SIZE, None))
    inside = []
    for _ in range(25):
        # Errors of blocks of 5 × 7 pixels: what single pixels seem to know is 35 times too much.
        rough = np.kron(rng.normal(0, 0.03, (8, 8)), np.ones((5, 7)))
        found = fit_picture(TRUTH, free, PictureTarget(jnp.asarray(clean * np.exp(rough)[..., None])))
        inside += [
            abs(found.values[name] - float(getattr(TRUTH, name))) < 1.645 * found.errors[name]
            for name in NAMES
        ]
    # Binomial, 100 of 90 %: 0.84 to 0.96, were they independent.
    assert 0.8 < np.mean(inside) < 0.98


def test_a_covariance_of_parts_that_err_apart_is_that_of_least_squares():
    rng = np.random.default_rng(2)
    places = np.repeat(np.arange(400), 5)
    jacobian = rng.normal(0, 1, (2000, 3))
    rows = rng.normal(0, 0.3, 2000)
    found = sandwich(rows[:, None] * jacobian, places, jacobian.T @ jacobian, np.zeros((3, 3)))
    expected = 0.3**2 * np.linalg.inv(jacobian.T @ jacobian)
    np.testing.assert_allclose(np.diag(found), np.diag(expected), rtol=0.25)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda image: PictureTarget(image.at[0, 0].set(jnp.nan)), "must be finite"),
        (lambda image: PictureTarget(0 * image), "must hold light"),
        (lambda image: PictureTarget(image, jnp.zeros(SIZE)), "hides the whole image"),
        (lambda image: PictureTarget(image, 2 * jnp.ones(SIZE)), "between 0 and 1"),
        (lambda image: PictureTarget(image, levels=0), "`levels`"),
    ],
)
def test_pictures_that_cannot_be_compared_are_refused(target, change, words):
    with pytest.raises(ValueError, match=words):
        change(target.image)


def test_fits_that_lead_nowhere_say_why(target):
    with pytest.raises(fitting.FitError, match="come to rest in 1 steps"):
        fit_picture(START, free, target, most_steps=1)
    with pytest.raises(fitting.FitError, match="not finite"):
        fit_picture(Stripes(contrast=1e3), free, target)
    with pytest.raises(ValueError, match=r"picture\(size, method\)"):
        fit_picture(jo.Wind(3.0), lambda m: m.speed, target)
    with pytest.raises(ValueError, match="tolerance"):
        fit_picture(START, free, target, tolerance=0.0)


CASCADE = jo.surface.Cascade((120.0, 17.0), 32)
NOISE = jo.surface.draw_noise(CASCADE, key=jax.random.key(3))


def scene(speed=13.0, direction=0.3, choppiness=1.0, threshold=0.65, exposure=3.0):
    return SceneModel(
        jo.Wind(speed, direction),
        jo.render.Camera((1.0, 2.0, 15.0), heading=0.5, pitch=0.4, field_of_view=0.8),
        cascade=CASCADE,
        noise=NOISE,
        choppiness=choppiness,
        threshold=threshold,
        breaking_wavenumber=4.0,
        exposure=exposure,
    )


def test_a_scene_is_the_ocean_that_it_says():
    ocean = scene().ocean()
    sea = jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(13.0, 0.3)), CASCADE, noise=NOISE)
    expected = jo.Ocean(sea, threshold=0.65, breaking_wavenumber=4.0)
    assert jax.tree.structure(ocean.sea.waves) == jax.tree.structure(expected.sea.waves)
    for one, other in zip(jax.tree.leaves(ocean), jax.tree.leaves(expected), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)


def test_noise_of_another_cascade_is_refused():
    with pytest.raises(ValueError, match="shape"):
        SceneModel(jo.Wind(3.0), jo.render.Camera((0.0, 0.0, 5.0)), cascade=CASCADE, noise=NOISE[:, :16, :16])


def test_waves_are_not_sought_without_pictures_or_scatter():
    view = View(scene().camera, 0.0, PictureTarget(jnp.ones((24, 32, 3))))
    with pytest.raises(ValueError, match="views"):
        recover_waves(scene(), [])
    with pytest.raises(ValueError, match="scatter"):
        recover_waves(scene(), [view], scatter=0.0)
    with pytest.raises(ValueError, match="most_steps"):
        recover_waves(scene(), [view], most_steps=0)


@pytest.mark.slow
def test_a_sea_is_found_again_in_a_picture_by_the_other_renderer_at_twice_the_resolution():
    rows, columns = 36, 64
    fine = jax.jit(lambda m: m.picture((2 * rows, 2 * columns), jo.render.Rays()))(scene())
    image = np.asarray(fine).reshape(rows, 2, columns, 2, 3).mean(axis=(1, 3))
    # So small a sea has no whitecaps that would tell ε.
    start = scene(17.0, 0.8, 1.3, 0.65, 3.6)
    found = fit_picture(
        start,
        lambda m: (m.wind.speed, m.wind.direction, m.choppiness, m.exposure),
        PictureTarget(jnp.asarray(image)),
        # Of so few pixels a vertex in every fourth makes no sea.
        method=jo.render.Raster(1.0),
    )
    assert abs(found.values["speed"] / 13.0 - 1) < 0.05
    assert abs(found.values["direction"] - 0.3) < 0.06
    assert abs(found.values["choppiness"] - 1) < 0.1
    assert abs(found.values["exposure"] - 3.0) < 0.1
