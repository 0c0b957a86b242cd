"""Tables and words of `repetition`."""

import numpy as np

from .. import schema
from ..common import _build
from ..common._markdown import page
from ..common._words import low_pass
from ..harness._result import Result, Table
from ._repetition_views import EARTH, Repetition, family, named, others


def result(found: list[Repetition], peak: float, config: schema.RepetitionConfig) -> Result:
    """Numbers, tables and the answer in words."""
    limits = _build.outside_validity(config.spectrum, config.wind)
    return Result(
        values={"peak_wavelength_m": peak, "cascades": [_numbers(one) for one in found]},
        tables=(_sizes_table(found), _peaks_table(found)),
        notes=(*_notes(found), *limits),
    )


def report(result: Result, found: list[Repetition], peak: float, config: schema.RepetitionConfig) -> str:
    """`report.md`."""
    setting = (
        f"U10 = {config.wind.speed:g} m/s, peak wavelength {peak:.3g} m, λ = 1, ε = {config.threshold:g}, "
        f"{low_pass(config.breaking_wavenumber)}; autocorrelations in closed form every {config.step:g} m along the "
        f"lattices' axes from {3 * peak:.3g} m to {config.reach:g} m; the foam that comes again from "
        f"{config.draws:,} drawn pairs of points at the distance where j repeats most, ± one standard error"
    )
    answer = "\n".join(f"- {note}" for note in result.notes)
    shares = "\n".join(
        f"- {one.name}: height {_shares(one.height_shares)}; j {_shares(one.jacobian_shares)}"
        for one in found
        if one not in others(found)
    )
    text = page("How many patterns?", (answer,), result.tables, picture="repetition", setting=setting)
    return f"{text}\n\n## Shares of the patterns in the variances of height and j, largest pattern first\n\n{shares}"


def _shares(shares: np.ndarray) -> str:
    return ", ".join(f"{share:.2g}" for share in shares)


def _numbers(one: Repetition) -> dict:
    return {
        "name": one.name,
        "sizes": list(one.cascade.sizes),
        "resolution": one.cascade.resolution,
        "bands": [list(band) for band in one.cascade.bands],
        "period_m": one.cascade.period,
        "height_peak": one.height[0],
        "height_peak_distance_m": one.height[1],
        "jacobian_peak": one.jacobian[0],
        "jacobian_peak_distance_m": one.jacobian[1],
        "jacobian_peak_near": one.jacobian[3],
        "height_shares": one.height_shares,
        "jacobian_shares": one.jacobian_shares,
        "foam_again": one.again[0],
        "foam_again_standard_error": one.again[1],
        "coverage": one.coverage,
    }


def _sizes_table(found: list[Repetition]) -> Table:
    rows = [
        (
            one.name,
            ", ".join(f"{size:g}" for size in one.cascade.sizes),
            one.cascade.resolution,
            f"{one.cascade.period / 1000:.4g}",
        )
        for one in found
    ]
    return Table("The sums of patterns", ("sum", "sizes (m)", "N", "period (km)"), rows)


def _peaks_table(found: list[Repetition]) -> Table:
    rows = [
        (
            one.name,
            f"{one.height[0]:.3f} at {one.height[1]:.0f}",
            f"{one.jacobian[0]:.3f} at {one.jacobian[1]:.0f}",
            f"{one.jacobian[3]:.3f}",
            f"{one.again[0]:.3f} ± {one.again[1]:.3f}" if one.coverage > 0 else "no foam",
        )
        for one in found
    ]
    columns = ("sum", "height (m)", "Jacobian (m)", "Jacobian, within 500 m", "foam again")
    return Table("Highest side peaks of the autocorrelation", columns, rows)


def _notes(found: list[Repetition]) -> list[str]:
    every, paper = family(found), named(found, "paper")
    commensurate, recommended = named(found, "commensurate"), named(found, "recommended")
    shared = named(found, "peak shared")
    peaks = ", ".join(f"{one.jacobian[0]:.2f}" for one in every)
    numbers = ", ".join(str(one.patterns) for one in every)
    largest = max(paper.cascade.sizes)
    notes = [
        f"More patterns make j repeat less, and the fall is slow, not a step at n = 4: the highest side peaks of its "
        f"autocorrelation are {peaks} with n = {numbers}.",
        f"They do not help the height: nearly all of it ({100 * paper.height_shares.max():.0f} % with the paper's "
        f"sizes) is in one pattern, and comes again with it. Its highest side peaks are "
        f"{', '.join(f'{one.height[0]:.2f}' for one in every)}; with the paper's sizes {paper.height[0]:.2f}, every "
        f"{largest:g} m. What helps is a larger largest pattern, or two that share the waves of the peak (side peak "
        f"{shared.height[0]:.2f} instead of {recommended.height[0]:.2f}).",
        f"The paper's four sizes repeat j up to {paper.jacobian[0]:.2f} (at {paper.jacobian[1]:.0f} m), {_four(every)}"
        f"The exact period, {paper.cascade.period / 1000:.5g} km for the paper's sizes, says nothing about that: it "
        f"grows with the product of the sizes ({_periods(every)}), and long before it single patterns return.",
        _foam(every, paper),
        _coprime(found, commensurate),
    ]
    return notes


def _four(every: list[Repetition]) -> str:
    four = next((one for one in every if one.patterns == 4), None)
    return "" if four is None else f"four in equal steps up to {four.jacobian[0]:.2f}. "


def _periods(every: list[Repetition]) -> str:
    listed = ", ".join(f"{one.cascade.period / 1000:.2g}" for one in every)
    around = next((one.patterns for one in every if one.cascade.period / 1000 > EARTH), None)
    beyond = "" if around is None else f", more than once around the Earth from n = {around} on"
    return f"{listed} km{beyond}"


def _foam(every: list[Repetition], paper: Repetition) -> str:
    seen = [one for one in [*every, paper] if one.coverage > 0]
    if not seen:
        return "Nothing breaks at this threshold: the foam that comes again cannot be told."
    listed = ", ".join(f"{_percent(one.again[0])} ({one.name})" for one in seen)
    return (
        f"Foam repeats less than j. Of the foam at one point, so much is foam again where j repeats most: {listed}; by "
        f"chance it would be {100 * paper.coverage:.2g} %."
    )


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def _coprime(found: list[Repetition], commensurate: Repetition) -> str:
    peaks = [one.jacobian[0] for one in others(found)]
    periods = [one.cascade.period / 1000 for one in others(found)]
    four = next((one for one in family(found) if one.patterns == 4), None)
    primes = "" if four is None else f" (primes in equal steps: {four.jacobian[0]:.2f})"
    return (
        f"Common factors are harmful: {', '.join(f'{size:g}' for size in commensurate.cascade.sizes)} m repeat "
        f"exactly after {commensurate.cascade.period:g} m. Beyond that, special sizes do not matter: {len(peaks)} sets "
        f"drawn at random have side peaks of j from {min(peaks):.2f} to {max(peaks):.2f}{primes} and periods from "
        f"{min(periods):.2g} to {max(periods):.2g} km."
    )
