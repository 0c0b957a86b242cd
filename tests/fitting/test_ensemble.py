"""One model calibrated to several laws, each over its own range."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _fitting_models import PowerSea
from jaxtyping import Array, Float

import fitting
import jaxocean as jo
from jaxocean._numerics import as_leaf
from jaxocean.whitecaps import laws

WINDS = np.arange(2.0, 25.0)
FREE = [lambda m: m.coefficient, lambda m: m.exponent]
LAWS = (laws.Monahan1980(), laws.GoddijnMurphy2011(), laws.Callaghan2008(), laws.MonahanLu1990StageA())


@pytest.fixture(scope="module")
def found():
    return fitting.ensemble(PowerSea(), FREE, LAWS, WINDS)


def test_power_laws_are_recovered_exactly(found):
    for member in found.members[:2]:
        assert member.fit.values["coefficient"] == pytest.approx(member.law.coefficient, rel=1e-4)
        assert member.fit.values["exponent"] == pytest.approx(member.law.exponent, rel=1e-4)
        assert member.rms < 1e-5
    np.testing.assert_allclose(found.values("exponent")[:2], [3.41, 2.7], rtol=1e-4)


def test_each_law_counts_only_in_its_range_and_where_it_gives_whitecaps(found):
    monahan, _, callaghan, _ = found.members
    np.testing.assert_array_equal(WINDS[monahan.seen], np.arange(2.0, 18.0))
    # In its range from 3.7 m/s, but below 1e-5 up to 4.38 m/s.
    np.testing.assert_array_equal(WINDS[callaghan.seen], np.arange(5.0, 24.0))
    assert np.all(np.isnan(callaghan.law_coverage[~callaghan.seen]))
    assert np.all(np.isfinite(callaghan.coverage))


def test_unseen_winds_change_nothing(found):
    callaghan = found.members[2]
    alone = fitting.fit(PowerSea(), FREE, fitting.CoverageLaw(laws.Callaghan2008(), WINDS[callaghan.seen]))
    for name in ("coefficient", "exponent"):
        assert callaghan.fit.values[name] == pytest.approx(alone.values[name], rel=1e-5)
        assert callaghan.fit.errors[name] == pytest.approx(alone.errors[name], rel=1e-5)
    (rms,) = alone.rms.values()
    assert callaghan.rms == pytest.approx(rms, rel=1e-5)


def test_draws_spread_as_the_errors_of_each_member_say(found):
    drawn = found.draw(2000, jax.random.key(0))
    assert drawn.shape == (4, 2000, WINDS.size)
    for member, sea in zip(found.members, drawn, strict=True):
        # log W is linear in the logarithm of the coefficient and in the exponent.
        scale = np.asarray([1 / member.fit.values["coefficient"], 1.0])
        covariance = member.fit.covariance * np.outer(scale, scale)
        slope = np.stack([np.ones(WINDS.size), np.log(WINDS)], axis=1)
        deviation = np.sqrt(np.einsum("wi,ij,wj->w", slope, covariance, slope))
        np.testing.assert_allclose(np.std(np.log(sea), axis=0), deviation, rtol=0.07)
        np.testing.assert_allclose(np.median(sea, axis=0), member.coverage, rtol=0.1)


def test_the_foam_that_a_law_counts_is_known():
    counted = {law.name: law.foam for law in laws.ALL}
    assert counted["Monahan & Lu 1990 (stage A)"] == "active"
    assert counted["Monahan & Lu 1990 (stage B)"] == "decaying"
    assert sum(foam == "total" for foam in counted.values()) == len(laws.ALL) - 2


def test_all_laws_share_one_compiled_program():
    traced = []

    class Counting(eqx.Module):
        exponent: Float[Array, ""] = eqx.field(converter=as_leaf, default=3.0)

        def log_coverage(self, wind):
            traced.append(1)
            return jnp.log(1e-5) + self.exponent * jnp.log(wind.speed)

    def one(m):
        return m.exponent

    fitting.ensemble(Counting(), one, LAWS[:2], WINDS)
    first = len(traced)
    fitting.ensemble(Counting(), one, LAWS[2:], WINDS)
    assert first > 0
    assert len(traced) == first


def test_laws_without_data_at_these_winds_are_left_out_in_words():
    calm = fitting.ensemble(
        PowerSea(), FREE, (*LAWS, laws.StramskaPetelski2003Undeveloped()), [3.0, 4.0, 5.0, 6.0]
    )
    assert "Stramska & Petelski 2003 (undeveloped) has fewer than two" in calm.skipped[-1]
    assert all("Stramska" not in member.law.name for member in calm.members)


def test_nothing_to_calibrate_to_is_refused():
    with pytest.raises(ValueError, match="`laws` must hold at least one law"):
        fitting.ensemble(PowerSea(), FREE, (), WINDS)
    with pytest.raises(ValueError, match="two winds in the range of some law"):
        fitting.ensemble(PowerSea(), FREE, LAWS, [0.5])


def test_winds_may_be_winds(found):
    same = fitting.ensemble(PowerSea(), FREE, LAWS[:1], [jo.Wind(float(u)) for u in WINDS])
    np.testing.assert_allclose(same.members[0].coverage, found.members[0].coverage, rtol=1e-9)
