"""From active to total coverage: the closures against simulated points and against foam on a tile."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean.whitecaps import foam
from tests._derivatives import assert_gradient_matches

TAU = np.array([0.5, 2.0, 8.0])
CASCADE, LIMIT, LEVEL = jo.surface.Cascade((64.0,), 64), 3.0, 0.65


def sea_motion(speed=12.0, choppiness=1.0):
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed))
    return foam.strain_motion(spectrum, choppiness, cascade=CASCADE, breaking_wavenumber=LIMIT)


class Life:
    """A simulated point that breaks for `durations` and waits for `gaps`, in turns."""

    def __init__(self, durations, gaps):
        self.durations, self.gaps = durations, gaps
        self.length = float(np.sum(durations) + np.sum(gaps))

    def foam(self, tau):
        """The mean of e^{−age/τ} over all time, gap by gap."""
        fresh = tau * -np.expm1(-self.gaps[:, None] / tau)
        return (np.sum(self.durations) + np.sum(fresh, axis=0)) / self.length

    def statistics(self, horizon=None, count=3000):
        rest, rate = np.sum(self.durations) / self.length, len(self.durations) / self.length
        known = [jnp.asarray(x) for x in (rest, rest, rate)]
        if horizon is None:
            return foam.PointBreaking(*known)
        lags = (np.arange(count) + 0.5) * (horizon / count)
        edges = np.ravel(np.column_stack([self.durations, self.gaps]).cumsum().reshape(-1, 2))
        starts, ends = np.concatenate([[0.0], edges[1:-1:2]]), edges[0::2]
        middle = np.linspace(0.0, self.length - horizon, 400_000)

        def breaks(time):
            place = np.searchsorted(starts, time, side="right") - 1
            return time < ends[place]

        now = middle[breaks(middle)]
        recurrence = [np.mean(breaks(now + lag)) for lag in lags]
        return foam.PointBreaking(
            *known, *map(jnp.asarray, (lags, np.full(count, horizon / count), recurrence))
        )


def test_poisson_foam_is_exact_for_gaps_without_memory():
    random = np.random.default_rng(0)
    life = Life(random.uniform(0.1, 0.5, 400_000), random.exponential(3.0, 400_000))
    closed = foam.PoissonFoam("rest")(life.statistics(), jnp.asarray(TAU))
    np.testing.assert_allclose(closed, life.foam(TAU), rtol=4e-3)


def test_renewal_foam_is_exact_for_independent_gaps_where_poisson_foam_is_not():
    random = np.random.default_rng(1)
    life = Life(random.rayleigh(0.25, 300_000), 1.5 + random.exponential(1.0, 300_000))
    statistics, truth = life.statistics(horizon=40.0), life.foam(TAU)
    renewal = np.asarray(foam.RenewalFoam("rest")(statistics, jnp.asarray(TAU)))
    poisson = np.asarray(foam.PoissonFoam("rest")(statistics, jnp.asarray(TAU)))
    np.testing.assert_allclose(renewal, truth, rtol=0.01)
    assert np.max(np.abs(poisson / truth - 1)) > 0.08


@pytest.fixture(scope="module")
def point():
    """A point that knows how soon it breaks again."""
    return foam.point_breaking(sea_motion(), LEVEL, horizon=30.0)


@pytest.mark.parametrize("closure", [foam.PoissonFoam, foam.RenewalFoam])
@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_total_coverage_grows_with_the_decay_time_from_active_coverage_to_one(point, closure, measure):
    tau = jnp.geomspace(0.05, 1e5, 40)
    total = np.asarray(closure(measure)(point, tau))
    active = float(getattr(point, measure))
    assert np.all(np.diff(total) > 0)
    assert total[0] > active
    assert float(closure(measure)(point, 1e-4)) == pytest.approx(active, rel=1e-3)
    assert total[-1] == pytest.approx(1.0, abs=2e-3)


def test_both_closures_agree_with_foam_on_a_tile(point):
    """The mean of six seas on a tile; each frame of it is exact."""
    tau, step, spin, count = 2.0, 0.05, 240, 900
    spectrum = jo.spectra.Elfouhaily(jo.Wind(12.0))
    model = foam.FoamModel(LEVEL, tau)

    @eqx.filter_jit
    def grow(key):
        tile = jo.surface.WorldTile(jo.surface.realise(spectrum, CASCADE, key=key), 64)
        bare = foam.Foam.bare(64, 64)
        _, seen = foam.evolve(
            bare, tile, model, start=0.0, step=step, count=spin + count, breaking_wavenumber=LIMIT
        )
        return jax.tree.map(lambda x: jnp.mean(x[spin:]), seen)

    seen = np.array([grow(key) for key in jax.random.split(jax.random.key(3), 6)])
    mean = foam.Coverage(*seen.mean(axis=0).tolist())
    error = foam.Coverage(*(seen.std(axis=0, ddof=1) / np.sqrt(len(seen))).tolist())
    assert float(point.rest) == pytest.approx(mean.active_rest, abs=3 * float(error.active_rest))
    assert float(point.projected) == pytest.approx(
        mean.active_projected, abs=3 * float(error.active_projected)
    )
    assert float(point.rate) == pytest.approx(mean.birth_rate, abs=3 * float(error.birth_rate))
    # Coverage that decays follows the births of these very seas: their common scatter is divided out.
    factor = float(mean.birth_rate / point.rate)
    for closure in (foam.PoissonFoam, foam.RenewalFoam):
        for measure in ("rest", "projected"):
            total = float(closure(measure)(point, tau)) * factor
            assert total == pytest.approx(getattr(mean, f"total_{measure}"), rel=0.04)


@pytest.mark.slow
def test_total_coverage_has_the_derivatives_of_finite_differences():
    def total(x):
        tau, level, choppiness, speed = x
        point = foam.point_breaking(sea_motion(speed, choppiness), level, horizon=20.0)
        return jnp.log(foam.RenewalFoam()(point, tau) * foam.PoissonFoam("rest")(point, tau))

    assert_gradient_matches(total, [[3.0, LEVEL, 1.0, 12.0]], rtol=1e-4, step=1e-4)


def test_renewal_foam_says_that_it_needs_a_horizon():
    with pytest.raises(ValueError, match="horizon"):
        foam.RenewalFoam()(foam.point_breaking(sea_motion(), LEVEL), 3.0)


def test_batches_of_seas_and_decay_times(point):
    tau = jnp.asarray(TAU)
    points = eqx.filter_vmap(lambda u: foam.point_breaking(sea_motion(u), LEVEL, horizon=30.0))(
        jnp.array([8.0, 12.0])
    )
    both = eqx.filter_vmap(lambda one: foam.RenewalFoam()(one, tau))(points)
    np.testing.assert_allclose(both[1], foam.RenewalFoam()(point, tau), rtol=1e-6)
