import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean._elementary import exponential, inverse_root, reciprocal
from jaxocean.filtering import Footprint, MomentPyramid
from jaxocean.whitecaps import ExactClosure, FastClosure, StrainStatistics, footprint_statistics

CASCADE = jo.surface.Cascade((201.0, 23.0, 5.0), 64)


@pytest.fixture(scope="module")
def footprints():
    """Strain in footprints of a metre's fraction to a whole pattern, of calm and of steep seas, in float32."""
    rng = np.random.default_rng(0)
    batches = []
    for speed, choppiness in ((4.0, 1.0), (12.0, 1.0), (20.0, 1.6)):
        sea = jo.surface.realise(
            jo.spectra.Elfouhaily(jo.Wind(speed)), CASCADE, key=jax.random.key(int(speed))
        )
        pyramid = MomentPyramid.from_fields(sea.fields(0.0, choppiness), CASCADE)
        for size in (0.05, 0.4, 3.0, 20.0, 150.0):
            moments = pyramid(Footprint.square(rng.uniform(0, 400, (200, 2)), size), probes=1)
            batches.append(footprint_statistics(moments))
    return jax.tree.map(lambda *x: jnp.concatenate([np.asarray(each, np.float32) for each in x]), *batches)


@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_footprints_of_a_frame_are_within_two_percent_of_the_exact_closure(footprints, measure):
    wide = jax.tree.map(lambda x: x.astype(jnp.float64), footprints)
    for threshold in (0.1, 0.4, 0.7):
        exact = np.asarray(ExactClosure(measure)(wide, threshold))
        fast = np.asarray(FastClosure(measure)(footprints, threshold), np.float64)
        assert np.all(np.isfinite(fast))
        assert np.mean(exact > 1e-5) > 0.05
        excess = np.abs(fast - exact) / np.maximum(0.02 * exact, 2e-5)
        assert np.max(excess) < 1, (threshold, np.max(excess), np.mean(excess > 1))


@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_fast_coverage_has_the_derivatives_of_the_exact_closure_in_both_modes(measure):
    root = np.array([[0.16, 0, 0], [0.05, 0.13, 0], [0.01, 0.01, 0.09]])
    point = np.concatenate([[-0.1, 0.05, 0.02], root[np.tril_indices(3)], [0.5]])

    def coverage(closure):
        def of(x):
            lower = jnp.zeros((3, 3)).at[np.tril_indices(3)].set(x[3:9])
            return closure(StrainStatistics(x[:3], lower @ lower.T), x[9])

        return of

    fast = coverage(FastClosure(measure))
    step = 1e-4 * np.eye(10)
    ahead, behind = jax.jit(jax.vmap(coverage(ExactClosure(measure))))(
        point + np.stack([step, -step]).reshape(-1, 10)
    ).reshape(2, 10)
    exact = np.asarray(ahead - behind) / 2e-4
    reverse = np.asarray(jax.jit(jax.grad(fast))(jnp.asarray(point)))
    # The contour is held, so that derivatives are right to the accuracy of W, not to rounding.
    np.testing.assert_allclose(reverse, exact, rtol=0.02, atol=0.005 * np.max(np.abs(exact)))
    along = jnp.asarray(np.random.default_rng(0).normal(size=10))
    _, forward = jax.jit(lambda x, v: jax.jvp(fast, (x,), (v,)))(jnp.asarray(point), along)
    np.testing.assert_allclose(forward, reverse @ np.asarray(along), rtol=1e-10)


@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_nothing_is_nan_whatever_the_footprint(measure):
    means = [(0, 0, 0), (-1, -1, 0), (-1, 0, 0), (3, -4, 2), (-0.5, 0, 0), (0, 0, 0), (0, 0, 0)]
    roots = [np.zeros((3, 3)), np.zeros((3, 3)), np.diag([1e-9, 0, 0]), np.eye(3)]
    roots += [
        np.array([[0.3, 0, 0], [-0.3, 0, 0], [0.3, 0, 0]]),
        np.diag([1e-3, 0, 0]),
        np.diag([0.3, 0.2, 1e-6]),
    ]
    covariance = np.stack([root @ root.T for root in roots])
    covariance[5, 2, 2] = -1e-9
    stats = StrainStatistics(jnp.asarray(means, jnp.float32), jnp.asarray(covariance, jnp.float32))
    closure = FastClosure(measure=measure)

    for threshold in (-0.1, 0.0, 0.8):
        coverage = closure(stats, jnp.float32(threshold))
        assert bool(jnp.all((coverage >= 0) & (coverage <= (1 if measure == "rest" else jnp.inf))))
    assert float(closure.log(StrainStatistics(stats.mean[0], stats.covariance[0]), 0.5)) == -np.inf


def test_a_whole_sea_takes_a_batch_of_thresholds():
    sea = jo.whitecaps.strain_statistics(jo.spectra.Elfouhaily(jo.Wind(12.0)), 1.0, band=(1e-3, 100.0))
    levels = jnp.linspace(0.2, 0.8, 7)
    exact, fast = ExactClosure()(sea, levels), FastClosure()(sea, levels)
    assert fast.shape == (7,)
    np.testing.assert_array_less(np.abs(fast - exact), np.maximum(0.02 * exact, 2e-5))
    np.testing.assert_allclose(jax.vmap(lambda level: FastClosure()(sea, level))(levels), fast, rtol=1e-9)


@pytest.mark.parametrize(
    ("mine", "theirs", "low", "high"),
    [
        (reciprocal, lambda x: 1 / x, 1e-30, 1e30),
        (inverse_root, lambda x: 1 / np.sqrt(x), 1e-30, 1e30),
        (exponential, np.exp, 1e-6, 80.0),
        (lambda x: exponential(-x), lambda x: np.exp(-x), 1e-6, 80.0),
    ],
    ids=["reciprocal", "inverse-root", "exponential", "falling-exponential"],
)
def test_elementary_functions_are_good_to_single_precision(mine, theirs, low, high):
    x = np.geomspace(low, high, 20001).astype(np.float32)
    np.testing.assert_allclose(
        mine(jnp.asarray(x)), theirs(x.astype(float)), rtol=4e-6 if high == 80 else 3e-7
    )
    middle = jnp.asarray(2.7, jnp.float64)
    np.testing.assert_allclose(mine(middle), theirs(2.7), rtol=1e-14)
    slope = (theirs(2.7 + 1e-5) - theirs(2.7 - 1e-5)) / 2e-5
    np.testing.assert_allclose(jax.grad(mine)(middle), slope, rtol=1e-8)
    np.testing.assert_allclose(jax.grad(mine)(jnp.asarray(2.7, jnp.float32)), slope, rtol=1e-5)
