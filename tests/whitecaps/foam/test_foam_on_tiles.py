"""Foam as a state: born, decaying, ageing, carried through time, averaged over footprints."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean.whitecaps import foam
from tests._derivatives import assert_gradient_matches

N, SIZE, LIMIT, LEVEL, STEP = 32, 40.0, 2.4, 0.7, 0.1
CASCADE = jo.surface.tiling_cascade(jo.surface.Cascade((40.0, 14.0), 16), SIZE)


def tile_of(speed=12.0, key=0):
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed))
    return jo.surface.WorldTile(jo.surface.realise(spectrum, CASCADE, key=jax.random.key(key)), N, SIZE)


@pytest.fixture(scope="module")
def tile():
    return tile_of()


def grow(tile, model, count, *, start=0.0, since=None, **options):
    since = foam.Foam.bare(N, N) if since is None else since
    return foam.evolve(
        since, tile, model, start=start, step=STEP, count=count, breaking_wavenumber=LIMIT, **options
    )


def keep_all(moment):
    return moment.foam, moment.jacobian, moment.time


def test_foam_decays_exponentially_and_ages_until_the_point_breaks_again():
    model = foam.FoamModel(0.5, 2.0)
    now = foam.Foam.bare(3)
    for j in ([0.4, 0.9, 0.9], [0.8, 0.3, 1.1], [0.6, 0.7, 0.9], [0.49, 1.4, 0.8]):
        now = model.step(now, jnp.array(j), 0.5)
    np.testing.assert_allclose(now.coverage, [1.0, np.exp(-1.0 / 2.0), 0.0])
    np.testing.assert_allclose(now.age, [0.0, 1.0, 2.0])


def test_a_breaker_makes_the_same_foam_in_one_step_or_in_many():
    model = foam.FoamModel(0.5, 2.0, breaking=jo.whitecaps.SmoothBreaking(0.1))
    start = foam.Foam(jnp.array([0.9, 0.1]), jnp.array([1.0, 1.0]))
    j = jnp.array([0.45, 0.45])
    once = model.step(start, j, 1e-6)
    often = start
    for _ in range(10):
        often = model.step(often, j, 1e-7)
    np.testing.assert_allclose(often.coverage, once.coverage, rtol=1e-6)
    assert float(once.coverage[0]) == pytest.approx(0.9, rel=1e-6)
    assert float(once.coverage[1]) > 0.6


def test_on_a_tile_coverage_and_age_are_the_history_of_the_jacobian(tile):
    model, count = foam.FoamModel(LEVEL, 1.5), 40
    final, (states, j, time) = grow(tile, model, count, observe=keep_all)
    np.testing.assert_allclose(time, STEP * np.arange(1, count + 1))
    exact = np.stack([jo.whitecaps.jacobian(tile.strain(float(t), 1.0, LIMIT)) for t in (time[0], time[25])])
    np.testing.assert_allclose(np.asarray(j)[[0, 25]], exact, atol=1e-9)
    broke = np.asarray(j) < LEVEL
    assert 0.02 < broke.any(axis=0).mean() < 0.9
    last = np.where(broke.any(axis=0), count - 1 - np.argmax(broke[::-1], axis=0), -1)
    age = STEP * (count - 1 - last)
    np.testing.assert_allclose(final.age, age, atol=1e-9)
    np.testing.assert_allclose(final.coverage, np.where(last < 0, 0, np.exp(-age / 1.5)), atol=1e-9)
    np.testing.assert_array_equal(states.coverage[-1], final.coverage)


def test_two_calls_one_after_the_other_are_one_long_one(tile):
    model = foam.FoamModel(LEVEL, 1.5)
    whole, seen = grow(tile, model, 30)
    half, first = grow(tile, model, 15)
    end, second = grow(tile, model, 15, start=15 * STEP, since=half)
    np.testing.assert_allclose(end.coverage, whole.coverage, atol=1e-9)
    for long, one, two in zip(seen, first, second, strict=True):
        np.testing.assert_allclose(jnp.concatenate([one, two]), long, atol=1e-9)


def test_what_is_counted_is_what_is_there(tile):
    _, (states, j, _) = grow(tile, foam.FoamModel(LEVEL, 1.5), 40, observe=keep_all)
    _, seen = grow(tile, foam.FoamModel(LEVEL, 1.5), 40)
    j, a = np.asarray(j), np.asarray(states.coverage)
    breaks = j < LEVEL
    plane = (1, 2)
    assert j.min() > -LEVEL / 3  # no deep folds: projected area is a plain mean of j
    np.testing.assert_allclose(seen.active_rest, breaks.mean(plane), atol=1e-12)
    np.testing.assert_allclose(seen.active_projected, (j * breaks).mean(plane), atol=1e-12)
    np.testing.assert_allclose(seen.total_rest, a.mean(plane), atol=1e-12)
    np.testing.assert_allclose(seen.total_projected, (j * a).mean(plane), atol=1e-12)
    births = (breaks[1:] & ~breaks[:-1]).mean(plane) / STEP
    np.testing.assert_allclose(seen.birth_rate[1:], births, atol=1e-12)


def test_short_lived_foam_is_active_breaking_in_either_area():
    model = foam.FoamModel(0.1, 1e-6)
    j = jnp.array([[-0.4, -0.01, 0.05], [0.3, 1.0, 1.2]])  # a deep fold and a shallow one among them
    now = model.step(foam.Foam.bare(2, 3), j, 1.0)
    for measure in ("rest", "projected"):
        active = model.active_coverage(j, measure)
        assert float(model.total_coverage(now, j, measure)) == pytest.approx(float(active), abs=1e-12)
        lasting = foam.Foam(jnp.ones((2, 3)), now.age)
        assert float(model.total_coverage(lasting, j, measure)) > float(active)


@pytest.mark.slow
def test_total_coverage_is_differentiable_through_time_in_decay_time_threshold_choppiness_and_wind():
    def total(x):
        tau, level, choppiness, speed = x
        model = foam.FoamModel(level, tau, breaking=jo.whitecaps.SmoothBreaking(0.05))
        _, seen = grow(tile_of(speed), model, 12, choppiness=choppiness)
        return jnp.log(seen.total_projected[-1])

    assert_gradient_matches(total, [[1.5, LEVEL, 1.1, 11.0]], rtol=2e-4, step=1e-5)


def test_a_hard_threshold_leaves_a_derivative_in_the_decay_time_only(tile):
    def total(tau, level):
        return grow(tile, foam.FoamModel(level, tau), 25)[1].total_rest[-1]

    in_tau, in_level = jax.grad(total, argnums=(0, 1))(jnp.array(1.5), jnp.array(LEVEL))
    assert float(in_tau) > 0.0
    assert float(in_level) == 0.0


def test_seas_are_batched_by_vmap(tile):
    model = foam.FoamModel(LEVEL, 1.5)
    tiles = eqx.filter_vmap(lambda key: tile_of(key=key))(jnp.arange(2))
    _, seen = eqx.filter_vmap(lambda one: grow(one, model, 30))(tiles)
    np.testing.assert_allclose(seen.total_rest[0], grow(tile, model, 30)[1].total_rest, atol=1e-12)
    assert float(jnp.max(jnp.abs(seen.total_rest[1] - seen.total_rest[0]))) > 1e-3


def test_a_sea_in_single_precision_keeps_its_type(tile):
    model = foam.FoamModel(LEVEL, 1.5)
    spectrum = jax.tree.map(lambda x: x.astype(jnp.float32), tile.sea.spectrum)
    sea = jo.surface.realise(spectrum, CASCADE, key=jax.random.key(0))
    final, seen = grow(jo.surface.WorldTile(sea, N, SIZE), model, 30)
    assert {x.dtype for x in jax.tree.leaves((final, seen))} == {jnp.dtype(jnp.float32)}
    np.testing.assert_allclose(seen.total_rest[-1], grow(tile, model, 30)[1].total_rest[-1], rtol=0.02)


def test_footprint_means_of_foam_are_plain_means_at_every_level(tile):
    final, (_, j, _) = grow(tile, foam.FoamModel(LEVEL, 1.5), 40, observe=keep_all)
    pyramid = foam.coverage_pyramid(final.coverage)
    assert [level.shape[0] for level in pyramid] == [32, 16, 8, 4, 2, 1]
    for level, means in enumerate(pyramid):
        side = 2**level
        boxes = np.asarray(final.coverage).reshape(N // side, side, N // side, side).mean(axis=(1, 3))
        np.testing.assert_allclose(means, boxes, atol=1e-12)
    # Breaking is not linear: the threshold of a mean Jacobian is no mean of foam.
    coarse = np.asarray(foam.coverage_pyramid(j[-1])[3]) < LEVEL
    fine = foam.coverage_pyramid((j[-1] < LEVEL).astype(float))[3]
    assert np.max(np.abs(coarse - np.asarray(fine))) > 0.1
    with pytest.raises(ValueError, match="square"):
        foam.coverage_pyramid(jnp.zeros((4, 2)))
    assert len(foam.coverage_pyramid(jnp.zeros((12, 12)))) == 3


def test_errors_name_what_is_wrong(tile):
    model = foam.FoamModel()
    with pytest.raises(ValueError, match="tile's shape"):
        grow(tile, model, 1, since=foam.Foam.bare(N, N + 2))
    with pytest.raises(ValueError, match="`count` must be at least 1"):
        grow(tile, model, 0)
    with pytest.raises(ValueError, match="`decay_time` must be greater than 0 s"):
        foam.FoamModel(0.5, 0.0)
    with pytest.raises(ValueError, match="`threshold` must be finite"):
        foam.FoamModel(float("nan"))
