"""Posteriors against distributions that are known in closed form, and against brute-force quadrature."""

import dataclasses
import importlib

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.scipy.special import log_ndtr
from jaxtyping import Array, Float
from scipy import special, stats

import fitting
from fitting import _nuts
from fitting._posterior_result import posterior_warnings
from jaxocean._numerics import as_leaf

LN10 = np.log(10.0)


class ApartSea(eqx.Module):
    """Each wind sees one number alone, so that their posteriors are independent and known."""

    level: Float[Array, ""] = eqx.field(converter=as_leaf, default=-2.0)
    factor: Float[Array, ""] = eqx.field(converter=as_leaf, default=1e-2)
    part: Float[Array, ""] = eqx.field(converter=as_leaf, default=-2.0)
    common: Float[Array, ""] = eqx.field(converter=as_leaf, default=-2.0)
    rate: Float[Array, ""] = eqx.field(converter=as_leaf, default=2.0)

    def log_coverage(self, wind):
        each = jnp.stack([LN10 * self.level, jnp.log(self.factor), LN10 * self.part, LN10 * self.common])
        return each[jnp.minimum(jnp.round(wind.speed).astype(int), 3)]


SCATTER = np.asarray([0.3, 0.4, 0.2])
OBSERVED = np.asarray([-2.0, -2.0, -1.8])
NOISE = np.asarray([0.3, -0.2, 0.1, -0.4, 0.2])
PART = fitting.Interval(-2.1, -1.6)


@pytest.fixture(scope="module")
def apart():
    """Numbers that are real, positive, in an interval, of unknown scatter, or known by a log-normal prior only."""
    free = [
        lambda m: m.level,
        lambda m: m.factor,
        fitting.Parameter(lambda m: m.part, bounds=PART),
        lambda m: m.common,
        fitting.Parameter(lambda m: m.rate, bounds=fitting.Positive(), prior=fitting.LogNormal(2.0, 0.3)),
    ]
    known = fitting.CoveragePoints([0.0, 1.0, 2.0], 10**OBSERVED, SCATTER, "known")
    unknown = fitting.CoveragePoints(
        np.arange(3.0, 8.0), 10 ** (NOISE - 2), fitting.FreeScatter(0.3), "unknown"
    )
    return ApartSea(), free, known + unknown


@pytest.fixture(scope="module")
def drawn(apart):
    model, free, target = apart
    return fitting.posterior(model, free, target, draws=2000, warmup=400, key=jax.random.key(5))


EXACT = {
    "level": stats.norm(-2.0, 0.3),
    # Flat in the number itself, Gaussian data in its logarithm: log-normal, moved up by its own variance.
    "factor": stats.lognorm(0.4 * LN10, scale=1e-2 * np.exp((0.4 * LN10) ** 2)),
    "part": stats.truncnorm((-2.1 + 1.8) / 0.2, (-1.6 + 1.8) / 0.2, -1.8, 0.2),
    # Student's problem: a mean, and a scatter that is flat in its logarithm.
    "common": stats.t(NOISE.size - 1, NOISE.mean() - 2, NOISE.std(ddof=1) / np.sqrt(NOISE.size)),
    "rate": stats.lognorm(0.3, scale=2.0),
}


@pytest.mark.parametrize("name", EXACT)
def test_draws_follow_the_distribution_that_is_known_in_closed_form(drawn, name):
    sample = drawn.values[name].ravel()
    size = drawn.effective_size[drawn.labels.index(name)]
    assert size > 1000
    # Under the true distribution the shares below its quantiles are uniform; thinned well, they are nearly
    # independent.
    shares = EXACT[name].cdf(sample[:: int(np.ceil(2 * len(sample) / size))])
    assert stats.kstest(shares, "uniform").pvalue > 1e-3
    lower, upper = drawn.interval(0.9)[name]
    assert EXACT[name].cdf(upper) - EXACT[name].cdf(lower) == pytest.approx(0.9, abs=0.03)


def test_chains_agree_and_are_reproducible_from_their_key(apart, drawn):
    assert np.all(drawn.r_hat < 1.01)
    assert drawn.draws.shape == (4, 2000, 6)
    assert drawn.divergences == 0
    assert 0.7 < drawn.acceptance < 0.99
    model, free, target = apart
    again = fitting.posterior(model, free, target, chains=2, draws=30, warmup=400, key=jax.random.key(5))
    other = fitting.posterior(model, free, target, chains=2, draws=30, warmup=400, key=jax.random.key(6))
    repeat = fitting.posterior(model, free, target, chains=2, draws=30, warmup=400, key=jax.random.key(5))
    np.testing.assert_array_equal(again.draws, repeat.draws)
    assert not np.array_equal(again.draws, other.draws)


def test_verdict_trusts_the_fit_where_the_posterior_is_gaussian_and_names_what_is_not(drawn):
    checks = {check.label: check for check in drawn.laplace()}
    assert checks["level"].ratio == pytest.approx(1.0, abs=0.08)
    assert checks["level"].faults == ()
    assert any("skewed" in fault for fault in checks["factor"].faults)
    verdict = drawn.verdict()
    assert "do not describe" in verdict
    assert "factor:" in verdict
    assert "level:" not in verdict


def test_draws_that_disagree_pass_no_verdict_on_the_fit(drawn):
    stuck = dataclasses.replace(drawn, r_hat=np.full(drawn.draws.shape[-1], 1.3))
    assert "cannot judge" in stuck.verdict()
    short = dataclasses.replace(drawn, effective_size=np.full(drawn.draws.shape[-1], 12.0))
    assert "cannot judge" in short.verdict()


def test_report_holds_every_number_in_words_and_plain_values(drawn):
    text = str(drawn)
    assert "R-hat" in text
    assert "leans on its bound" not in text
    plain = drawn.as_dict(0.5)
    assert [p["name"] for p in plain["parameters"]] == list(drawn.labels)
    lower, upper = plain["parameters"][0]["interval"]
    assert (lower, upper) == drawn.interval(0.5)["level"]
    assert plain["level"] == 0.5


class RidgeSea(eqx.Module):
    """What coverage knows of ε and λ: little more than (1 − ε)/λ, a bent ridge."""

    threshold: Float[Array, ""] = eqx.field(converter=as_leaf, default=0.6)
    choppiness: Float[Array, ""] = eqx.field(converter=as_leaf, default=1.0)

    def log_coverage(self, wind):
        roughness = self.choppiness * (0.1 + 0.005 * wind.speed)
        return log_ndtr((self.threshold - 1) / roughness)


def test_draws_along_a_bent_ridge_agree_with_quadrature_over_the_whole_plane():
    prior = fitting.Normal(1.0, 0.5)
    free = [lambda m: m.threshold, fitting.Parameter(lambda m: m.choppiness, prior=prior)]
    speeds, observed = np.asarray([8.0, 12.0, 16.0]), np.asarray([-2.8, -2.1, -1.7])
    target = fitting.CoveragePoints(speeds, 10**observed, 0.5)
    drawn = fitting.posterior(RidgeSea(), free, target, draws=2000, warmup=400)
    threshold, choppiness = np.meshgrid(
        np.linspace(-1.5, 1.6, 1201), np.linspace(1e-3, 2.999, 1001), indexing="ij"
    )
    cost = ((choppiness - 1.0) / 0.5) ** 2
    for speed, number in zip(speeds, observed, strict=True):
        roughness = choppiness * (0.1 + 0.005 * speed)
        predicted = special.log_ndtr((threshold - 1) / roughness) / LN10
        cost += ((predicted - number) / 0.5) ** 2
    density = np.exp(-0.5 * cost)
    density /= density.sum()
    for i, axis in enumerate((threshold, choppiness)):
        name = drawn.labels[i]
        mean = np.sum(density * axis)
        deviation = np.sqrt(np.sum(density * (axis - mean) ** 2))
        error = deviation / np.sqrt(drawn.effective_size[i])
        assert abs(drawn.mean[name] - mean) < 4 * error
        assert drawn.deviation[name] == pytest.approx(deviation, rel=0.08)
        lower, upper = drawn.interval(0.9)[name]
        assert np.sum(density * ((lower < axis) & (axis < upper))) == pytest.approx(0.9, abs=0.03)
    assert not all(check.faults == () for check in drawn.laplace())


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"chains": 1}, "`chains` must be at least 2"),
        ({"draws": 3}, "`draws` must be at least 4"),
        ({"warmup": 5}, "`warmup` must be at least 20"),
        ({"acceptance": 1.0}, "`acceptance` must lie between"),
    ],
)
def test_senseless_numbers_are_refused(apart, options, sentence):
    with pytest.raises(ValueError, match=sentence):
        fitting.posterior(*apart, **options)


def test_a_level_outside_its_range_is_refused(drawn):
    with pytest.raises(ValueError, match="`level` must lie between 0 and 1, but is 90"):
        drawn.interval(90.0)


def test_without_blackjax_one_sentence_names_the_extra(apart, monkeypatch):
    def absent(name):
        raise ModuleNotFoundError(f"No module named {name!r}")

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(ImportError, match=r"jaxocean\[posterior\]") as caught:
        fitting.posterior(*apart)
    assert type(caught.value) is ImportError


def test_trouble_is_said_in_words():
    rng = np.random.default_rng(0)
    values = np.stack([rng.normal(size=(2, 200)), np.full((2, 200), 2.9999)], axis=-1)
    none = np.zeros((2, 200), bool)
    block = _nuts.Block(values, values[..., 0], ~none, ~none, values[..., 0], none.astype(int))
    texts = posterior_warnings(
        ("a", "b"),
        (fitting.Real(), fitting.Interval(0, 3)),
        block,
        np.asarray([1.2, np.nan]),
        np.asarray([20.0, 900.0]),
    )
    assert "do not agree on a (1.200), b (nan)" in texts[0]
    assert "Fewer than 400 effective draws of a (20)" in texts[1]
    assert "400 of 400 draws diverged" in texts[2]
    assert "long thread" in texts[3]
    assert "b leans on its bound 3" in texts[4]
