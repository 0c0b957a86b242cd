"""Free leaves: how they are picked, named, bounded and refused."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import SPEEDS, PowerSea

import fitting

TARGET = fitting.CoveragePoints(SPEEDS, 2e-5 * SPEEDS**2.5)


class TwoSeas(eqx.Module):
    """Two leaves of the same name, and one that is an array."""

    first: PowerSea
    second: PowerSea
    weights: jnp.ndarray

    def log_coverage(self, wind):
        return (
            self.first.log_coverage(wind)
            + self.second.log_coverage(wind)
            + jnp.sum(self.weights)
            - jnp.log(1e-5)
        )


def names(fit):
    return [parameter.name for parameter in fit.parameters]


def test_parameters_are_named_after_their_leaf_with_the_unit_of_the_house():
    fit = fitting.fit(fitting_model(), lambda m: (m.exponent, m.coefficient), TARGET)
    assert names(fit) == ["exponent", "coefficient"]
    assert fit.parameters[1].unit == "-"
    assert "exponent" in fit.summary()


def fitting_model():
    return PowerSea(1e-5, 3.0)


def test_leaves_of_one_name_are_told_apart_by_their_path():
    model = TwoSeas(PowerSea(), PowerSea(), jnp.zeros(2))
    picks = [
        lambda m: (m.first.exponent, m.second.exponent),
        fitting.Parameter(lambda m: m.weights, prior=fitting.Normal(0.0, 1.0)),
    ]
    fit = fitting.fit(
        model, picks, TARGET, priors=[fitting.Normal(1.0, 1.0, where=lambda m: m.first.exponent)]
    )
    assert names(fit) == ["first.exponent", "second.exponent", "weights"]
    assert fit.labels == ("first.exponent", "second.exponent", "weights[0]", "weights[1]")
    assert fit.values["weights"].shape == (2,)
    assert fit.model.weights.shape == (2,)


def test_a_parameter_may_be_named_and_given_a_unit():
    pick = fitting.Parameter(lambda m: m.exponent, name="steepness", unit="rad")
    fit = fitting.fit(fitting_model(), pick, TARGET)
    assert names(fit) == ["steepness"]
    assert "rad" in fit.summary()


@pytest.mark.parametrize(
    ("free", "message"),
    [
        ([], "at least one leaf"),
        (lambda m: m.absent, "but it fails"),
        (lambda m: m.nothing, "picks nothing"),
        (lambda m: 3.0, "not a leaf"),
        (lambda m: (m.exponent, m.exponent), "picks `exponent` twice"),
        (
            fitting.Parameter(lambda m: m.exponent, bounds=fitting.Interval(4.0, 5.0)),
            "between 4 and 5, but is 3",
        ),
    ],
)
def test_picks_that_make_no_sense_are_refused(free, message):
    with pytest.raises(ValueError, match=message):
        fitting.fit(fitting_model(), free, TARGET)


def test_a_fixed_name_or_count_is_no_floating_point_leaf():
    class Counted(eqx.Module):
        count: jnp.ndarray

        def log_coverage(self, wind):
            return wind.speed

    with pytest.raises(ValueError, match="no floating-point number"):
        fitting.fit(Counted(jnp.asarray(3)), lambda m: m.count, TARGET)


@pytest.mark.parametrize(
    ("priors", "message"),
    [
        ([fitting.Normal(1.0, 0.1)], "must say of which leaf"),
        ([fitting.Normal(1.0, 0.1, where=lambda m: m.threshold)], "`threshold` is fixed"),
        ([fitting.Normal(1.0, 0.1, where=lambda m: m.exponent)] * 2, "one prior, but has two"),
    ],
)
def test_priors_that_make_no_sense_are_refused(priors, message):
    with pytest.raises(ValueError, match=message):
        fitting.fit(fitting_model(), lambda m: m.exponent, TARGET, priors=priors)


def test_a_prior_needs_a_positive_deviation():
    with pytest.raises(ValueError, match="`deviation` must be greater than 0"):
        fitting.Normal(1.0, 0.0)
    with pytest.raises(ValueError, match="`median` must be greater than 0"):
        fitting.LogNormal(-1.0, 1.0)


def test_choppiness_is_bounded_by_default():
    model = fitting.SpectralModel(0.5, 3.5, band=(1e-3, 100.0))
    with pytest.raises(ValueError, match=r"`choppiness` must be between 0 and 3, but is 3\.5"):
        fitting.fit(model, lambda m: m.choppiness, TARGET)


def test_priors_are_residuals_in_standard_deviations():
    value = jnp.asarray([0.5, 2.0])
    np.testing.assert_allclose(fitting.Normal(1.0, 0.5).residual(value), [-1.0, 2.0])
    np.testing.assert_allclose(fitting.LogNormal(1.0, np.log(2.0)).residual(value), [-1.0, 1.0])
