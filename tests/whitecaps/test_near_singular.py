"""The exact closure where the covariance of the strain is nearly singular: pixels, long-crested seas, bad float32."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _conditional import partial_moments

from jaxocean.whitecaps import ExactClosure, StrainStatistics

# Footprints that defeat contours chosen with less care: mean, root of the covariance and threshold.
HARD = [
    # a wide eigenvalue beside one that is tiny, but moves j far (several per cent off)
    ((0.0, 0.0, 0.0), [[0.3, 0.3, 0.0], [-0.1, 0.1, 0.0], [0.12, 0.0, 1e-3]], 0.02),
    # rank one: j has a vertex
    ((0.1, -0.2, 0.05), [[0.3, 0, 0], [-0.25, 0, 0], [0.1, 0, 0]], 0.3),
    # rank one and bounded: everything breaks
    ((-0.3, -0.2, 0.0), [[0.05, 0, 0], [-0.05, 0, 0], [0.3, 0, 0]], 0.75),
    # rank two, eigenvalues 10⁸ apart
    ((0.0, 0.1, 0.1), [[0.2, 1e-5, 0], [-0.2, 2e-5, 0], [0.2, 1e-5, 0]], 0.6),
]


def footprints(count, *, seed):
    """Means, covariances of rank one to three with eigenvalues up to 10¹² apart, and thresholds that matter."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        spread = [1.0, 10 ** rng.uniform(-8, 0), 10 ** rng.uniform(-12, 0)]
        spread[1 + number % 3 :] = [0.0] * (2 - number % 3)
        covariance = (turn * spread) @ turn.T * 10 ** rng.uniform(-4, 0)
        mean = rng.normal(size=3) * 10 ** rng.uniform(-2, -0.3)
        j = (1 + mean[0]) * (1 + mean[1]) - mean[2] ** 2
        gradient = np.array([1 + mean[1], 1 + mean[0], -2 * mean[2]])
        deviation = np.sqrt(gradient @ covariance @ gradient + 0.5 * np.trace(covariance) ** 2)
        yield mean, covariance, np.clip(j - deviation * rng.uniform(-1, 4), -0.1, 0.8)


@pytest.fixture(scope="module")
def cases():
    """Mean, covariance, threshold and true W in both measures."""
    hard = [(np.array(m), np.array(r) @ np.array(r).T, t) for m, r, t in HARD]
    rows = []
    for mean, covariance, level in [*hard, *footprints(45, seed=11)]:
        rest, signed = partial_moments(mean, covariance, level)
        deep = partial_moments(mean, covariance, -level / 3)[1] if level > 0 else 0.0
        rows.append((mean, covariance, level, rest, signed - 2 * deep if level > 0 else -signed))
    return tuple(np.array(column) for column in zip(*rows, strict=True))


@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_every_rank_agrees_with_conditional_quadrature(cases, measure):
    mean, covariance, level, rest, projected = cases
    truth = rest if measure == "rest" else np.maximum(projected, 0)
    assert np.mean((truth > 1e-8) & (truth < 0.99)) > 0.5
    found = ExactClosure(measure=measure)(
        StrainStatistics(jnp.asarray(mean), jnp.asarray(covariance)), jnp.asarray(level)
    )
    np.testing.assert_array_less(np.abs(found - truth), 1e-6 * np.maximum(rest, 1e-8))


@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_single_precision_is_good_enough_for_a_picture(cases, measure):
    mean, covariance, level, rest, projected = cases
    truth = rest if measure == "rest" else np.maximum(projected, 0)
    single = [jnp.asarray(x, jnp.float32) for x in (mean, covariance, level)]
    found = ExactClosure(measure=measure)(StrainStatistics(single[0], single[1]), single[2])
    assert found.dtype == jnp.float32
    np.testing.assert_array_less(np.abs(np.asarray(found, float) - truth), np.maximum(1e-8, 1e-4 * truth))


@pytest.mark.parametrize("measure", ["rest", "projected"])
def test_a_point_is_foam_or_not(measure):
    closure = ExactClosure(measure=measure)
    j = jnp.array([0.4, 0.6, -0.1, -0.3])
    still = StrainStatistics(jnp.stack([j - 1, 0 * j, 0 * j], axis=-1), jnp.zeros((4, 3, 3)))
    nearly = StrainStatistics(still.mean, 1e-10 * jnp.eye(3) * jnp.ones((4, 1, 1)))
    # j = −0.1 is the flank of a fold whose crest hides foam: it counts for nothing.
    expected = [1.0, 0.0, 1.0, 1.0] if measure == "rest" else [0.4, 0.0, 0.0, 0.3]
    for stats in (still, nearly):
        np.testing.assert_allclose(closure(stats, 0.5), expected, atol=1e-7)


@pytest.mark.parametrize("dtype", [jnp.float32])
def test_variances_lost_to_rounding_are_harmless(dtype):
    stats = StrainStatistics(
        jnp.array([[-0.6, 0.1, 0.0], [-0.45, 0.0, 0.0], [0.2, 0.0, 0.1]], dtype),
        jnp.array(
            [
                [[-1e-8, 0, 0], [0, 1e-8, 0], [0, 0, -2e-9]],  # all noise
                [[4e-3, 5e-3, 0], [5e-3, 4e-3, 0], [0, 0, -1e-5]],  # correlation 1.25
                [[0.02, 0.02, 0.01], [0.02, 0.02, 0.01], [0.01, 0.01, 0.004]],
            ],
            dtype,
        ),
    )
    closure = ExactClosure()
    coverage = closure(stats, 0.5)
    assert bool(jnp.all((coverage >= 0) & (coverage <= 1)))
    gradient = jax.grad(lambda c: jnp.sum(closure(StrainStatistics(stats.mean, c), 0.5)))(stats.covariance)
    assert bool(jnp.all(jnp.isfinite(gradient)))
