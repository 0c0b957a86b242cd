"""The closures against Monte Carlo, quadrature, inversion of the characteristic function and their own limits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches
from scipy import integrate, special, stats

import jaxocean as jo
from jaxocean.whitecaps import ExactClosure, GaussianClosure, PublishedClosure, StrainStatistics

REST, PROJECTED = ExactClosure(measure="rest"), ExactClosure(measure="projected")
BAND = (1e-3, 400.0)


def sea_statistics(speed, choppiness=1.0, *, age=0.84, direction=0.0, **where):
    where = where or {"band": BAND}
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed, direction), inverse_wave_age=age)
    return jo.whitecaps.strain_statistics(spectrum, choppiness, **where)


def ordinary(a=0.024, b=0.0147, s=0.00646, scale=1.0, mean=(0.0, 0.0, 0.0)):
    covariance = scale * jnp.array([[a, s, 0.0], [s, b, 0.0], [0.0, 0.0, s]])
    return StrainStatistics(jnp.array(mean), covariance)


@pytest.mark.parametrize(
    ("speed", "height", "slope", "a", "b", "s", "variance", "exact", "gaussian"),
    [
        (5.0, 0.6441, 0.02932, 0.01395, 0.00804, 0.00367, 0.02947, 0.000440, 0.00179),
        (10.0, 2.606, 0.05164, 0.02399, 0.01474, 0.00646, 0.05212, 0.00665, 0.01426),
        (15.0, 5.869, 0.06887, 0.03228, 0.01938, 0.00861, 0.06972, 0.01701, 0.02914),
        (20.0, 10.42, 0.08130, 0.03877, 0.02221, 0.01016, 0.08247, 0.02653, 0.04083),
    ],
)
def test_reference_table_is_reproduced(speed, height, slope, a, b, s, variance, exact, gaussian):
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed), inverse_wave_age=0.84)
    sea = sea_statistics(speed)
    measured = [
        jo.spectra.significant_wave_height(spectrum, band=BAND),
        jo.spectra.mean_square_slope(spectrum, band=BAND),
        *(sea.covariance[i, j] for i, j in ((0, 0), (1, 1), (0, 1))),
        sea.jacobian_variance(),
        REST(sea, 0.5),
        GaussianClosure(measure="rest")(sea, 0.5),
    ]
    np.testing.assert_allclose(measured, [height, slope, a, b, s, variance, exact, gaussian], rtol=0.01)


def test_mean_of_the_jacobian_is_one_and_its_variance_is_that_of_monte_carlo():
    sea = sea_statistics(12.0, 1.5, direction=0.4)
    draws = np.random.default_rng(1).multivariate_normal(np.zeros(3), np.asarray(sea.covariance), 1_000_000)
    j = (1 + draws[:, 0]) * (1 + draws[:, 1]) - draws[:, 2] ** 2
    np.testing.assert_allclose(sea.jacobian_mean(), 1.0, rtol=1e-12)
    np.testing.assert_allclose(j.var(), sea.jacobian_variance(), rtol=0.005)
    (a, s, p), (_, b, q), _ = np.asarray(sea.covariance)
    formula = a + b + 2 * s + a * b + 3 * s**2 - 4 * p * q
    np.testing.assert_allclose(sea.jacobian_variance(), formula, rtol=1e-12)


def test_skewness_of_the_jacobian_is_that_of_its_density_and_grows_with_the_sea():
    stats_of = [sea_statistics(speed, direction=0.3) for speed in (5.0, 20.0)] + [
        ordinary(mean=(0.1, -0.2, 0.05))
    ]
    for sea in stats_of:
        deviation = jnp.sqrt(sea.jacobian_variance())
        j = jnp.linspace(sea.jacobian_mean() - 9 * deviation, sea.jacobian_mean() + 14 * deviation, 1500)
        density = jax.vmap(jax.grad(lambda level, sea=sea: REST(sea, level)))(j)
        third = np.trapezoid((j - sea.jacobian_mean()) ** 3 * density, j)
        np.testing.assert_allclose(sea.jacobian_skewness(), third / deviation**3, rtol=1e-4)
    assert 0.2 < stats_of[0].jacobian_skewness() < stats_of[1].jacobian_skewness() < 0.8


MONTE_CARLO_CASES = [
    (5.0, 0.5, 1.0, 1), (5.0, 0.8, 0.7, 4), (8.0, 0.3, 1.5, 4), (8.0, 0.6, 1.0, 1),
    (10.0, 0.5, 1.0, 4), (10.0, 0.2, 2.0, 1), (12.0, 0.4, 1.2, 4), (12.0, 0.7, 0.7, 1),
    (15.0, 0.3, 1.0, 1), (15.0, 0.5, 2.0, 4), (18.0, 0.2, 1.5, 1), (20.0, 0.5, 1.0, 1),
    (20.0, 0.8, 0.7, 4), (25.0, 0.2, 2.0, 4), (25.0, 0.6, 1.0, 1), (25.0, 0.4, 1.5, 4),
]  # fmt: skip


@pytest.fixture(scope="module")
def normal_draws():
    return np.random.default_rng(2012).standard_normal((3, 10_000_000), dtype=np.float32)


@pytest.mark.slow
@pytest.mark.parametrize(("speed", "threshold", "choppiness", "patterns"), MONTE_CARLO_CASES)
def test_exact_closure_lies_in_the_interval_of_ten_million_draws(
    normal_draws, speed, threshold, choppiness, patterns
):
    cascade = jo.surface.Cascade(sizes=(893.0, 101.0, 21.0, 11.0)[-patterns:], resolution=256)
    where = {"cascade": cascade} if patterns > 1 else {"band": (1e-3, 400.0)}
    lam = choppiness if patterns == 1 else tuple(choppiness * f for f in (1.2, 1.1, 1.0, 0.8))
    sea = sea_statistics(speed, lam, **where)
    root = np.linalg.cholesky(np.asarray(sea.covariance)).astype(np.float32)
    a = root[0, 0] * normal_draws[0]
    b = root[1, 0] * normal_draws[0] + root[1, 1] * normal_draws[1]
    c = root[2, 0] * normal_draws[0] + root[2, 1] * normal_draws[1] + root[2, 2] * normal_draws[2]
    j = (1 + a) * (1 + b) - c * c
    hits = int(np.count_nonzero(j < threshold))
    interval = stats.binomtest(hits, j.size).proportion_ci(0.99, method="wilson")
    assert interval.low <= float(REST(sea, threshold)) <= interval.high

    contribution = np.where(j < threshold, j, 0.0) - 2 * np.where(j < -threshold / 3, j, 0.0)
    error = contribution.std(dtype=float) / np.sqrt(j.size)
    assert abs(contribution.mean(dtype=float) - float(PROJECTED(sea, threshold))) < 2.8 * error


def gil_pelaez(stats_: StrainStatistics, level: float) -> float:
    """P(j < x) from the characteristic function, written independently: matrices and an adaptive rule."""
    form = np.array([[0, 0.5, 0], [0.5, 0, 0], [0, 0, -1.0]])
    x = np.array([1.0, 1.0, 0.0]) + np.asarray(stats_.mean)
    c = np.asarray(stats_.covariance)

    def characteristic(t):
        matrix = np.eye(3) - 2j * t * c @ form
        # The square root of each eigenvalue keeps the branch continuous.
        root = np.prod(np.sqrt(np.linalg.eigvals(matrix)))
        return np.exp(1j * t * x @ form @ np.linalg.solve(matrix, x)) / root

    def integrand(t):
        return np.imag(np.exp(-1j * t * level) * characteristic(t)) / t

    total = sum(
        integrate.quad(integrand, lo, hi, epsabs=1e-13, epsrel=1e-11, limit=400)[0]
        for lo, hi in zip((1e-12, 5.0, 50.0, 200.0), (5.0, 50.0, 200.0, 2000.0), strict=True)
    )
    return 0.5 - total / np.pi


@pytest.mark.parametrize(
    ("scale", "threshold", "mean"),
    [
        (1.0, 0.5, (0.0, 0.0, 0.0)),
        (1.0, 0.9, (0.0, 0.0, 0.0)),
        (1.0, 1.2, (0.1, -0.05, 0.02)),
        (3.0, 0.2, (0.0, 0.0, 0.0)),
        (4.0, 0.0, (-0.1, -0.2, 0.05)),
        (5.0, -0.3, (0.0, 0.0, 0.0)),
    ],
)
def test_exact_closure_agrees_with_inversion_of_the_characteristic_function(scale, threshold, mean):
    sea = ordinary(scale=scale, mean=mean)
    np.testing.assert_allclose(REST(sea, threshold), gil_pelaez(sea, threshold), rtol=1e-6, atol=1e-7)


def conditional_quadrature(sea: StrainStatistics, level: float, *, weight) -> float:
    """E[g(j); j < x] by conditioning on (d, c) = ((a − b)/2, c), nested adaptive rules (SPEC: the other exact form)."""
    mean, c = np.asarray(sea.mean), np.asarray(sea.covariance)
    turn = np.array([[0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [0.0, 0.0, 1.0]])
    m, c = turn @ (mean + np.array([1.0, 1.0, 0.0])), turn @ c @ turn.T
    gain = np.linalg.solve(c[1:, 1:], c[1:, 0])
    tau = np.sqrt(c[0, 0] - c[0, 1:] @ gain)
    root = np.linalg.cholesky(c[1:, 1:])
    nodes, weights = np.polynomial.legendre.leggauss(400)
    z1, z2 = np.meshgrid(9 * nodes, 9 * nodes)
    mass = 81 * np.outer(weights, weights) * np.exp(-0.5 * (z1**2 + z2**2)) / (2 * np.pi)
    d, e = root[0, 0] * z1, root[1, 0] * z1 + root[1, 1] * z2
    centre = m[0] + gain[0] * d + gain[1] * e
    rho2 = (m[1] + d) ** 2 + (m[2] + e) ** 2
    r = np.sqrt(np.maximum(level + rho2, 0))
    lower, upper = (-r - centre) / tau, (r - centre) / tau
    cdf = special.ndtr(upper) - special.ndtr(lower)
    if weight == "one":
        return float(np.sum(np.where(level + rho2 > 0, mass * cdf, 0)))
    # j = s² − ρ²; E[s²; −r < s < r] for Gaussian s
    pdf = stats.norm.pdf
    second = (centre**2 + tau**2) * cdf - tau * ((centre + r) * pdf(upper) - (centre - r) * pdf(lower))
    return float(np.sum(np.where(level + rho2 > 0, mass * (second - rho2 * cdf), 0)))


@pytest.mark.parametrize(
    ("scale", "threshold"), [(1.0, 0.5), (1.0, 0.2), (2.0, 0.5), (3.0, 0.05), (4.0, -0.2)]
)
def test_both_measures_agree_with_conditional_quadrature(scale, threshold):
    sea = ordinary(scale=scale, mean=(0.02, -0.01, 0.03))
    rest = conditional_quadrature(sea, threshold, weight="one")
    np.testing.assert_allclose(REST(sea, threshold), rest, rtol=2e-4)
    signed = conditional_quadrature(sea, threshold, weight="j")
    deep = conditional_quadrature(sea, -threshold / 3, weight="j")
    expected = signed - 2 * deep if threshold > 0 else -signed
    np.testing.assert_allclose(PROJECTED(sea, threshold), expected, rtol=2e-3)


def test_small_steepness_tends_to_the_gaussian_closure():
    sea = ordinary(scale=1e-6)
    level = 1 - 2.5 * jnp.sqrt(sea.jacobian_variance())
    for measure in ("rest", "projected"):
        exact, gaussian = (
            ExactClosure(measure=measure)(sea, level),
            GaussianClosure(measure=measure)(sea, level),
        )
        np.testing.assert_allclose(exact, gaussian, rtol=2e-2)


def test_gaussian_projected_measure_is_the_integral_of_its_density():
    sea = ordinary(scale=4.0)
    mean, deviation = float(sea.jacobian_mean()), float(jnp.sqrt(sea.jacobian_variance()))

    def below(x):
        return integrate.quad(lambda j: j * stats.norm.pdf(j, mean, deviation), -6, x, epsabs=1e-14)[0]

    closure = GaussianClosure()
    np.testing.assert_allclose(closure(sea, 0.4), below(0.4) - 2 * below(-0.4 / 3), rtol=1e-8)
    np.testing.assert_allclose(closure(sea, -0.1), -below(-0.1), rtol=1e-8)


@pytest.mark.parametrize("closure", [REST, PROJECTED, GaussianClosure(measure="rest"), GaussianClosure()])
def test_coverage_grows_with_the_threshold_and_stays_between_zero_and_one(closure):
    thresholds = jnp.linspace(-0.4, 0.95, 40)
    coverage = jax.vmap(lambda t: closure(ordinary(), t))(thresholds)
    assert bool(jnp.all(jnp.diff(coverage) > 0))
    assert bool(jnp.all((coverage >= 0) & (coverage <= 1)))


def test_everything_breaks_when_the_threshold_exceeds_any_jacobian():
    np.testing.assert_allclose(REST(ordinary(), 4.0), 1.0, rtol=1e-12)
    np.testing.assert_allclose(PROJECTED(ordinary(), 4.0), 1.0, rtol=1e-12)


def test_projected_measure_is_continuous_at_a_threshold_of_zero():
    sea = ordinary(scale=3.0)
    above, below = PROJECTED(sea, 1e-7), PROJECTED(sea, -1e-7)
    np.testing.assert_allclose(above, below, rtol=1e-5)


@pytest.mark.parametrize("measure", ["rest", "projected"])
@pytest.mark.parametrize("closure", [ExactClosure, GaussianClosure])
def test_log_coverage_stays_finite_and_differentiable_in_the_far_tail(closure, measure):
    def log_coverage(x):
        return closure(measure=measure).log(ordinary(scale=1e-3 * x[0]), x[1])

    points = [jnp.array([1.0, threshold]) for threshold in (0.3, 0.0, -0.5)]
    for point in points:
        assert float(log_coverage(point)) < -1000
    # At ε = 0 the projected measure is continuously differentiable, but its second derivative jumps.
    assert_gradient_matches(
        log_coverage, points if measure == "rest" else [points[0], points[2]], rtol=1e-6, step=2e-5
    )
    assert np.all(np.isfinite(jax.grad(log_coverage)(points[1])))


@pytest.mark.parametrize("measure", ["rest", "projected"])
@pytest.mark.parametrize(
    "root",
    [
        np.diag([0.15, 0.0, 0.0]),  # long-crested
        np.array([[0.1, 0, 0], [0.08, 0, 0], [0.05, 0, 0]]),  # rank one
        np.array([[0.1, 0.05, 0], [0.02, 0.1, 0], [0.0, 0.04, 0]]),  # rank two
        np.diag([0.15, 0.1, 1e-8]),
    ],
    ids=["long-crested", "rank-one", "rank-two", "nearly-singular"],
)
def test_singular_covariances_give_the_monte_carlo_coverage_and_finite_gradients(root, measure):
    closure = ExactClosure(measure=measure)
    covariance = jnp.asarray(root @ root.T)
    draws = np.random.default_rng(3).standard_normal((2_000_000, 3)) @ root.T
    j = (1 + draws[:, 0]) * (1 + draws[:, 1]) - draws[:, 2] ** 2
    for threshold in (0.85, 0.7):
        sea = StrainStatistics(jnp.zeros(3), covariance)
        weight = 1.0 if measure == "rest" else j
        hits = weight * (j < threshold) - (0 if measure == "rest" else 2 * j * (j < -threshold / 3))
        error = hits.std() / np.sqrt(j.size)
        assert abs(float(closure(sea, threshold)) - hits.mean()) < 4 * error
        gradient = jax.grad(lambda c, t=threshold: closure.log(StrainStatistics(jnp.zeros(3), c), t))(
            covariance
        )
        assert np.all(np.isfinite(gradient))


def test_calm_sea_has_no_whitecaps_and_a_gradient_of_zero():
    for closure in (REST, PROJECTED, GaussianClosure()):
        value, gradient = jax.value_and_grad(lambda u, c=closure: c(sea_statistics(u), 0.5))(0.0)
        assert float(value) == 0
        assert float(gradient) == 0
        assert float(closure.log(sea_statistics(0.0), 0.5)) == -np.inf


@pytest.mark.parametrize("speed", [1e-4, 1e-2, 0.3, 1.0])
def test_gradients_are_finite_as_the_wind_dies(speed):
    for f in (
        lambda u: PROJECTED(sea_statistics(u), 0.5),
        lambda u: REST(sea_statistics(u), 0.5),
        lambda u: jo.spectra.significant_wave_height(jo.spectra.Elfouhaily(jo.Wind(u))),
    ):
        assert np.isfinite(float(jax.grad(f)(speed)))


@pytest.mark.parametrize(
    "closure", [REST, PROJECTED, GaussianClosure()], ids=["rest", "projected", "gaussian"]
)
@pytest.mark.parametrize("logarithm", [False, True], ids=["W", "logW"])
def test_derivatives_in_wind_age_direction_choppiness_and_threshold(closure, logarithm):
    cascade = jo.surface.Cascade(sizes=(893.0, 101.0, 21.0, 11.0), resolution=256)

    def coverage(x):
        where = {"cascade": cascade, "breaking_wavenumber": 70.0}
        sea = sea_statistics(x[0], x[3:7], age=x[1], direction=x[2], **where)
        return closure.log(sea, x[7]) if logarithm else closure(sea, x[7])

    points = [[11.0, 1.3, 0.5, 1.9, 1.6, 1.5, 1.2, threshold] for threshold in (0.5, 0.1, -0.05)]
    assert_gradient_matches(coverage, points, rtol=1e-6, atol=1e-8)


def test_published_variance_is_undefined_for_four_patterns_and_right_for_one():
    cascade = jo.surface.Cascade(sizes=(893.0, 101.0, 21.0, 11.0), resolution=256)
    closure = PublishedClosure()
    four = sea_statistics(12.0, (2.3, 2.1, 1.3, 0.9), age=2.0, cascade=cascade)
    assert not bool(closure.defined(four))
    assert np.isnan(float(closure(four, 0.2)))
    one = sea_statistics(12.0)
    assert bool(closure.defined(one))
    np.testing.assert_allclose(closure(one, 0.5), GaussianClosure(measure="rest")(one, 0.5), rtol=1e-12)


def test_published_moments_are_those_of_the_printed_k_i():
    cascade = jo.surface.Cascade(sizes=(893.0, 101.0, 21.0, 11.0), resolution=256)
    sea = sea_statistics(12.0, (2.3, 2.1, 1.3, 0.9), age=2.0, cascade=cascade)
    rng = np.random.default_rng(5)
    mean = square = 0.0
    for covariance in np.asarray(sea.patterns.covariance):
        a, b, c = rng.multivariate_normal(np.zeros(3), covariance, 1_000_000).T
        k = 0.25 + a + b + a * b - c**2
        mean, square = mean + k.mean(), square + (k**2).mean()
    mu, variance = PublishedClosure().moments(sea)
    np.testing.assert_allclose(mu, mean, atol=2e-3)
    np.testing.assert_allclose(variance, square - mean**2, atol=5e-3)
    assert float(variance) < -0.2


def test_published_closure_without_patterns_says_what_to_do():
    with pytest.raises(ValueError, match=r"needs `stats\.patterns`"):
        PublishedClosure()(ordinary(), 0.5)


def test_measure_must_be_one_of_the_two():
    with pytest.raises(Exception, match="measure"):
        ExactClosure(measure="sphere")  # pyright: ignore[reportArgumentType]


def test_closures_batch_over_footprints_and_thresholds():
    seas = StrainStatistics(
        jnp.zeros((5, 3)), jnp.stack([ordinary(scale=s).covariance for s in (0.5, 1, 2, 3, 4.0)])
    )
    together = PROJECTED(seas, 0.4)
    single = jnp.stack([PROJECTED(StrainStatistics(seas.mean[i], seas.covariance[i]), 0.4) for i in range(5)])
    np.testing.assert_allclose(together, single, rtol=1e-12)
    assert PROJECTED(ordinary(), jnp.linspace(0.1, 0.9, 7)).shape == (7,)


def test_single_precision_agrees_with_double():
    double = [
        [float(c(ordinary(scale=s), t)) for c in (REST, PROJECTED)]
        for s in (0.5, 1.0, 3.0)
        for t in (0.3, 0.6)
    ]
    with jax.enable_x64(False):
        single = [
            [c(ordinary(scale=s), t) for c in (REST, PROJECTED)] for s in (0.5, 1.0, 3.0) for t in (0.3, 0.6)
        ]
        assert single[0][0].dtype == jnp.float32
    np.testing.assert_allclose(single, double, rtol=2e-3)


def test_derivative_is_right_for_thresholds_just_above_zero():
    # There a path may run far before exp(−sε) decides to which side it must bend.
    assert_gradient_matches(
        lambda x: REST.log(ordinary(scale=1.5 + 0 * x[0]), x[0]),
        [[1e-4], [1e-3], [0.02]],
        rtol=1e-5,
        step=2e-5,
    )
