"""Total coverage as a model to be fitted: the foam's decay time from a law."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

import fitting
import jaxocean as jo
from jaxocean.whitecaps import foam

WINDS = (8.0, 12.0, 16.0)


def model_of(decay_time=3.0, threshold=0.6, **options):
    active = fitting.SpectralModel(threshold, 1.0, band=(0.02, 8.0), breaking_wavenumber=6.0)
    return fitting.TotalCoverageModel(active, decay_time, **options)


@pytest.fixture(scope="module")
def truth():
    """Total coverage at a decay time of 2.4 s, by the room itself."""
    coverage = []
    for speed in WINDS:
        motion = foam.strain_motion(
            jo.spectra.Elfouhaily(jo.Wind(speed)), 1.0, band=(0.02, 8.0), breaking_wavenumber=6.0
        )
        point = foam.point_breaking(motion, 0.6, horizon=30.0)
        coverage.append(float(foam.RenewalFoam("projected")(point, 2.4)))
    return np.array(coverage)


def test_the_decay_time_is_found_that_makes_the_coverage(truth):
    targets = fitting.CoveragePoints(WINDS, truth, 0.1)
    fit = fitting.fit(model_of(), lambda m: m.decay_time, targets)
    assert fit.values["decay_time"] == pytest.approx(2.4, rel=1e-6)
    # One number from three points of 0.1 decades each, at nearly W ∝ τ.
    expected = 2.4 * np.log(10) * 0.1 / np.sqrt(3)
    assert fit.errors["decay_time"] == pytest.approx(expected, rel=0.1)
    assert fit.parameters[0].unit == "s"


def test_one_decay_time_for_each_wind(truth):
    targets = fitting.CoveragePoints(WINDS, truth * np.array([1.0, 1.1, 0.9]), 0.1)
    free = fitting.Parameter(lambda m: m.decay_time, per_wind=True)
    values = np.asarray(fitting.fit(model_of(), free, targets).values["decay_time"])
    assert values[0] == pytest.approx(2.4, rel=1e-6)
    assert values[1] > 2.5
    assert values[2] < 2.3


def test_a_prepared_model_answers_the_same():
    model, wind = model_of(), jo.Wind(12.0)
    direct = eqx.filter_jit(lambda m: m.coverage(wind))(model)
    np.testing.assert_allclose(model.prepared(model.prepare(wind)).coverage(wind), direct, rtol=1e-9)
    np.testing.assert_allclose(jnp.exp(model.log_coverage(wind)), direct, rtol=1e-9)


def test_what_makes_no_model_is_refused():
    with pytest.raises(ValueError, match="`decay_time` must be greater than 0 s"):
        model_of(-1.0)
    with pytest.raises(ValueError, match="`horizon` must be greater than 0 s"):
        model_of(horizon=0.0)
