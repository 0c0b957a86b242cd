"""The fast closure against the exact one, on footprints of realised seas."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import finite_difference

import jaxocean as jo
from jaxocean.whitecaps import ExactClosure, FastClosure, StrainStatistics
from jaxocean.whitecaps._elementary import exponential, inverse_root, reciprocal

MEASURES = ("rest", "projected")
PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def block_means(field, rows, columns):
    n = field.shape[0]
    return field.reshape(n // rows, rows, n // columns, columns, -1).mean((1, 3)).reshape(-1, field.shape[-1])


@pytest.fixture(scope="module")
def footprints():
    """Footprints of 0.1 to 340 m, square and long, in seas of 4 to 24 m/s with λ up to 3.5, computed in float32."""
    rng = np.random.default_rng(4)
    cascade = jo.surface.Cascade(sizes=(340.0, 53.0, 11.0), resolution=128)
    sea = jax.jit(
        lambda speed, key: (
            jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(speed, 0.4)), cascade, key=key)
            .fields(0.0, 1.0)
            .strain
        )
    )
    means, covariances = [], []
    for number, speed in enumerate((4.0, 10.0, 24.0)):
        strain = np.asarray(sea(speed, jax.random.key(number)), np.float32)
        products = np.stack([strain[..., i] * strain[..., j] for i, j in PRODUCTS], axis=-1)
        for level in range(13):
            for stretch in (1, 8):
                mean, covariance = np.zeros((60, 3), np.float32), np.zeros((60, 6), np.float32)
                choppiness = rng.choice([1.0, 2.0, 3.5], (60, 1)).astype(np.float32)
                for pattern, size in enumerate(cascade.sizes):
                    side = 11.0 / 128 * 2.0**level / (size / 128)
                    rows = int(np.clip(2.0 ** np.round(np.log2(side)), 1, 128))
                    columns = min(128, rows * stretch)
                    blocks = block_means(strain[pattern], rows, columns)
                    squares = block_means(products[pattern], rows, columns)
                    chosen = rng.integers(len(blocks), size=60)
                    m = choppiness * blocks[chosen]
                    mean += m
                    covariance += choppiness**2 * squares[chosen]
                    covariance -= np.stack([m[:, i] * m[:, j] for i, j in PRODUCTS], axis=-1)
                means.append(mean)
                covariances.append(covariance)
    mean, entries = np.concatenate(means), np.concatenate(covariances)
    matrix = np.zeros((len(mean), 3, 3), np.float32)
    for k, (i, j) in enumerate(PRODUCTS):
        matrix[:, i, j] = matrix[:, j, i] = entries[:, k]
    # Half of the thresholds where the footprint is partly foam.
    j = (1 + mean[:, 0]) * (1 + mean[:, 1]) - mean[:, 2] ** 2
    deviation = np.sqrt(np.maximum(np.trace(matrix, axis1=1, axis2=2), 0))
    near = np.clip(j - deviation * rng.uniform(-1, 3, len(mean)), -0.1, 0.8)
    level = np.where(rng.uniform(size=len(mean)) < 0.5, near, rng.uniform(-0.1, 0.8, len(mean)))
    return mean, matrix, level.astype(np.float32)


@pytest.fixture(scope="module", params=MEASURES)
def both(request, footprints):
    """The exact coverage in float64 and the fast one in float32."""
    mean, covariance, level = footprints
    wide = [jnp.asarray(x, jnp.float64) for x in footprints]
    exact = ExactClosure(measure=request.param)(StrainStatistics(wide[0], wide[1]), wide[2])
    narrow = StrainStatistics(jnp.asarray(mean), jnp.asarray(covariance))
    fast = FastClosure(measure=request.param)(narrow, jnp.asarray(level))
    assert fast.dtype == jnp.float32
    return np.asarray(exact), np.asarray(fast)


def test_fast_closure_is_within_two_per_cent_on_footprints_of_every_size(footprints, both):
    exact, fast = both
    # A footprint without variance to speak of is foam or not by the last digit of its mean.
    varied = np.trace(footprints[1], axis1=1, axis2=2) > 1e-6
    assert np.mean(exact[varied] > 1e-4) > 0.4
    assert np.mean(varied) > 0.8
    np.testing.assert_array_less(np.abs(fast - exact)[varied], np.maximum(0.02 * exact, 2e-5)[varied])


def test_fast_closure_is_a_step_where_the_strain_does_not_vary(footprints, both):
    exact, fast = both
    mean, covariance, level = footprints
    j = (1 + mean[:, 0]) * (1 + mean[:, 1]) - mean[:, 2] ** 2
    still = (np.trace(covariance, axis1=1, axis2=2) < 1e-6) & (np.abs(j - level) > 5e-3)
    still &= np.abs(j + level / 3) > 5e-3
    assert np.count_nonzero(still) > 20
    np.testing.assert_allclose(fast[still], exact[still], atol=2e-5, rtol=0.02)


def test_more_nodes_are_more_accurate(footprints):
    mean, covariance, level = (jnp.asarray(x, jnp.float64)[::7] for x in footprints)
    stats = StrainStatistics(mean, covariance)
    exact = ExactClosure(measure="rest")(stats, level)
    errors = [
        float(jnp.mean(jnp.abs(FastClosure(measure="rest", nodes=nodes)(stats, level) - exact)))
        for nodes in (4, 6, 10)
    ]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]


@pytest.mark.parametrize("measure", MEASURES)
def test_gradient_is_that_of_the_exact_closure(measure):
    def stats_of(x):
        covariance = jnp.array([[x[3], x[6], x[7]], [x[6], x[4], x[8]], [x[7], x[8], x[5]]])
        return StrainStatistics(x[:3], covariance)

    closure, exact = (
        FastClosure(measure=measure),
        jax.jit(lambda x: ExactClosure(measure=measure)(stats_of(x), x[9])),
    )
    gradient = jax.jit(jax.grad(lambda x: closure(stats_of(x), x[9])))
    points = [
        [-0.2, -0.1, 0.05, 0.04, 0.02, 0.01, 0.01, 0.003, -0.002, 0.45],
        [0.1, 0.0, -0.05, 0.10, 0.06, 0.03, 0.02, 0.0, 0.01, 0.1],
        [-0.4, -0.3, 0.0, 0.02, 0.02, 0.01, 0.005, 0.0, 0.0, 0.6],
    ]
    for point in points:
        x = jnp.asarray(point)
        expected = np.array([finite_difference(exact, x, unit, 1e-4) for unit in jnp.eye(10)])
        np.testing.assert_allclose(gradient(x), expected, atol=0.02 * np.abs(expected).max())


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_nothing_is_nan_whatever_the_footprint(measure, dtype):
    means = [(0, 0, 0), (-1, -1, 0), (-1, 0, 0), (3, -4, 2), (-0.5, 0, 0), (0, 0, 0), (0, 0, 0)]
    roots = [
        np.zeros((3, 3)),
        np.zeros((3, 3)),
        np.diag([1e-9, 0, 0]),
        np.eye(3),
        np.array([[0.3, 0, 0], [-0.3, 0, 0], [0.3, 0, 0]]),
        np.diag([1e-3, 0, 0]),
        np.diag([0.3, 0.2, 1e-6]),
    ]
    covariance = np.stack([root @ root.T for root in roots])
    covariance[5, 2, 2] = -1e-9
    stats = StrainStatistics(jnp.asarray(means, dtype), jnp.asarray(covariance, dtype))
    closure = FastClosure(measure=measure)
    for threshold in (-0.1, 0.0, 0.2, 0.8):
        level = jnp.asarray(threshold, dtype)
        coverage = closure(stats, level)
        assert coverage.dtype == dtype
        assert bool(jnp.all(coverage >= 0) & jnp.all(jnp.isfinite(coverage)))
        gradient = jax.grad(lambda s, t=level: jnp.sum(closure(s, t)))(stats)
        assert bool(jnp.all(jnp.isfinite(gradient.mean)) & jnp.all(jnp.isfinite(gradient.covariance)))
    assert float(closure.log(StrainStatistics(stats.mean[0], stats.covariance[0]), 0.5)) == -np.inf


def test_the_whole_sea_and_a_batch_of_thresholds():
    sea = jo.whitecaps.strain_statistics(jo.spectra.Elfouhaily(jo.Wind(12.0)), 1.0, band=(1e-3, 100.0))
    levels = jnp.linspace(0.2, 0.8, 7)
    exact, fast = ExactClosure()(sea, levels), FastClosure()(sea, levels)
    assert fast.shape == (7,)
    np.testing.assert_array_less(np.abs(fast - exact), np.maximum(0.02 * exact, 2e-5))
    np.testing.assert_allclose(FastClosure().log(sea, 0.5), np.log(FastClosure()(sea, 0.5)), rtol=1e-12)
    one_by_one = jax.vmap(lambda level: FastClosure()(sea, level))(levels)
    np.testing.assert_allclose(one_by_one, fast, rtol=1e-12)


def test_bad_arguments_are_refused():
    with pytest.raises(ValueError, match="`nodes` must be at least 4, but is 2"):
        FastClosure(nodes=2)
    with pytest.raises(Exception, match="measure"):
        FastClosure(measure="sphere")  # pyright: ignore[reportArgumentType]


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
