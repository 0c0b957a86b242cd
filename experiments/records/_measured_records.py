"""Records of files of measured spectra: which ones, and their numbers, many at a time."""

import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import jaxocean as jo
from jaxocean import io
from jaxocean.spectra import measured as tails
from jaxocean.spectra.measured import MeasuredSpectrum

from .. import schema
from ..common import _build

NEGATIVE = {"renormalise": io.ClipAndRenormalise, "maximum_entropy": io.MaximumEntropy, "clip": io.Clip}
FREQUENCIES = np.geomspace(0.03, 3.0, 200)

OTHER_TAILS = (-5.0, -4.0)
"""Exponents of the tails between which the sea may lie, whatever tail is chosen."""

LARGE = 10_000_000
"""Size [bytes] of a file of which only one is kept in memory."""

BATCH = 32
"""Records that are integrated together, in bounded memory; fewer are filled up, so that all share one program."""


class SeaNumbers(NamedTuple):
    """What is reported of each record.

    The last axis of `projected` is ε less its error, ε, ε plus its error; that of `other_tails` follows `OTHER_TAILS`.
    """

    wave_height: Any
    peak_period: Any
    mean_square_slope: Any
    measured_slope: Any
    cut_off: Any
    projected: Any
    rest: Any
    other_tails: Any
    energy: Any


@dataclass(frozen=True)
class Station:
    """One file.

    **Arguments:** `times`: of each record, or its number; `numbers`; `winds`: U10 [m/s] in the file, NaN where there is
    none; `wind_origin`: where they come from; `left_out`: why records were left out.
    """

    name: str
    times: np.ndarray
    numbers: SeaNumbers
    winds: np.ndarray
    wind_origin: io.WindOrigin | None
    left_out: tuple[str, ...]

    @property
    def dated(self) -> bool:
        """Whether the records follow each other in time."""
        return (
            np.issubdtype(self.times.dtype, np.datetime64) and np.unique(self.times).size == self.times.size
        )


def read(path: Path, kind: io.Kind | None) -> Any:
    """A file's records as a dataset. Small files and the last large one are kept: a sweep comes back to them."""
    if not path.is_file():
        return io.open_spectra(path, kind=kind)
    stat = path.stat()
    kept = _small if stat.st_size < LARGE else _large
    return kept(path, kind, (stat.st_mtime_ns, stat.st_size))


def _read(path: Path, kind: io.Kind | None, version: tuple[int, int]) -> Any:
    del version
    return io.open_spectra(path, kind=kind)


_small, _large = functools.lru_cache(maxsize=8)(_read), functools.lru_cache(maxsize=1)(_read)


def choose(dataset: Any, records: Sequence[dict[str, int]], config: schema.MeasuredSeaConfig) -> list[int]:
    """The numbers of the records that a config asks for; none where the file has none of them."""
    chosen = np.arange(len(records))
    if config.record is not None:
        first, last = config.record if isinstance(config.record, tuple) else (config.record, config.record)
        chosen = chosen[first : last + 1]
    if config.times is not None:
        if "time" not in dataset:
            return []
        first, last = (np.datetime64(moment) for moment in config.moments())
        times = dataset["time"].values
        moments = times[[records[i]["time"] for i in chosen.tolist()]]
        chosen = chosen[(moments >= first) & (moments <= last)]
    if config.records is not None and chosen.size > config.records:
        chosen = chosen[np.linspace(0, chosen.size - 1, config.records).astype(int)]
    return chosen.tolist()


def describe(
    name: str,
    dataset: Any,
    config: schema.MeasuredSeaConfig,
    counter: Callable[[str, int], Callable[[], None]],
) -> Station | None:
    """The numbers of the chosen records of a file, or None if it has none of them.

    A record that cannot be used is left out, with the reason.

    **Raises:** `ValueError` if all are left out, or the dataset is no directional spectrum.
    """
    reader = io.SpectrumRecords(dataset, cut_off=config.cut_off, negative=NEGATIVE[config.negative]())
    bins = int(np.sum(reader.frequency >= config.tail_from * reader.frequency[-1]))
    records = reader.records()
    chosen = choose(dataset, records, config)
    if not chosen:
        return None
    advance = counter(f"Integrating {len(chosen)} records of {name}", len(chosen))
    kept, found, winds, left_out = [], [], [], []
    numbers: dict[int, SeaNumbers] = {}
    for number in chosen:
        record = records[number]
        advance()
        try:
            tail = _tail(config, dataset, record)
            spectrum = reader.spectrum(record, tail=tail, tail_bins=bins)
        except ValueError as error:
            left_out.append(str(error))
            continue
        kept.append(number)
        winds.append(_speed(dataset, record))
        found.append((number, spectrum))
        if len(found) == BATCH:
            numbers |= _integrate(found, config)
            found = []
    if found:
        numbers |= _integrate(found, config)
    if not kept:
        raise ValueError(f"File {name} holds no usable record: {left_out[0]}")
    stacked = jax.tree.map(lambda *each: np.stack(each), *(numbers[number] for number in kept))
    times = [dataset["time"].values[records[i]["time"]] if "time" in records[i] else i for i in kept]
    return Station(
        name, np.asarray(times), stacked, np.asarray(winds), io.wind_origin(dataset), tuple(left_out)
    )


def _integrate(
    found: Sequence[tuple[int, MeasuredSpectrum]], config: schema.MeasuredSeaConfig
) -> dict[int, SeaNumbers]:
    """The numbers of some records, those of one structure (depth or none, wind or none) together."""
    kinds: dict[Any, list[tuple[int, MeasuredSpectrum]]] = {}
    for number, spectrum in found:
        kinds.setdefault(jax.tree.structure(spectrum), []).append((number, spectrum))
    numbers = {}
    epsilon = config.threshold + config.threshold_error * np.array([-1.0, 0.0, 1.0])
    limit = None if config.breaking_wavenumber is None else np.asarray(config.breaking_wavenumber)
    for same in kinds.values():
        for batch in _batches(same):
            filled = [batch[min(i, len(batch) - 1)][1] for i in range(BATCH)]
            stacked = jax.tree.map(lambda *leaves: np.stack(leaves), *filled)
            integrals, covariance = _integrals(stacked, np.asarray(config.choppiness), limit, config.band)
            host = SeaNumbers(**jax.tree.map(np.asarray, integrals | _coverages(covariance, epsilon)))
            numbers |= {n: jax.tree.map(lambda x, i=i: x[i], host) for i, (n, _) in enumerate(batch)}
    return numbers


def _batches(items: Sequence[Any]) -> Iterator[Sequence[Any]]:
    for start in range(0, len(items), BATCH):
        yield items[start : start + BATCH]


@eqx.filter_jit
def _integrals(stacked, choppiness, breaking_wavenumber, band) -> tuple[dict[str, Any], Any]:
    """Numbers that are integrals over a spectrum; the covariances of its strain, then those with other tails."""

    def covariance(spectrum: MeasuredSpectrum):
        return jo.whitecaps.strain_statistics(
            spectrum, choppiness, band=band, breaking_wavenumber=breaking_wavenumber
        ).covariance

    def one(spectrum: MeasuredSpectrum):
        def with_tail(tail: tails.AbstractTail) -> MeasuredSpectrum:
            return eqx.tree_at(lambda s: s.tail, spectrum, tail)

        others = jax.vmap(lambda n: covariance(with_tail(tails.PowerTail(n))))(jnp.asarray(OTHER_TAILS))
        numbers = {
            "wave_height": jo.spectra.significant_wave_height(spectrum, band=band),
            "peak_period": jo.spectra.peak_period(spectrum),
            "mean_square_slope": jo.spectra.mean_square_slope(spectrum, band=band),
            "measured_slope": jo.spectra.mean_square_slope(with_tail(tails.NoTail()), band=band),
            "cut_off": spectrum.cut_off(),
            "energy": jo.spectra.frequency_spectrum(spectrum, jnp.asarray(FREQUENCIES)),
        }
        return numbers, jnp.concatenate([covariance(spectrum)[None], others])

    return eqx.filter_vmap(one)(stacked)


@eqx.filter_jit
def _coverages(covariance, thresholds) -> dict[str, Any]:
    """Coverage of each record; a program of its own, which files with any frequencies and directions share."""
    # One closure for all: this sea at three ε, the others at the middle one.
    sea, others = jnp.repeat(covariance[:, :1], 3, axis=1), covariance[:, 1:]
    together = jnp.concatenate([sea, others], axis=1)
    levels = jnp.append(thresholds, jnp.broadcast_to(thresholds[1], len(OTHER_TAILS)))

    def statistics(covariance) -> jo.whitecaps.StrainStatistics:
        return jo.whitecaps.StrainStatistics(jnp.zeros_like(covariance[..., 0]), covariance)

    projected = jo.whitecaps.ExactClosure("projected")(statistics(together), levels)
    rest = jo.whitecaps.ExactClosure("rest")(statistics(covariance[:, 0]), thresholds[1])
    return {"projected": projected[:, :3], "rest": rest, "other_tails": projected[:, 3:]}


def _tail(config: schema.MeasuredSeaConfig, dataset: Any, record: dict[str, int]) -> tails.AbstractTail:
    """The tail of a config; that of Elfouhaily has the record's own wind where there is one."""
    match config.tail:
        case schema.NoTailConfig():
            return tails.NoTail()
        case schema.PowerTailConfig():
            return tails.PowerTail(config.tail.exponent)
        case schema.ElfouhailyTailConfig():
            try:
                wind = io.wind_from_dataset(dataset, record=record)
            except ValueError:
                wind = _build.wind(config.wind)
            return tails.ElfouhailyTail(wind, blend=config.tail.blend, exponent=config.tail.exponent)


def _speed(dataset: Any, record: dict[str, int]) -> float:
    """U10 [m/s] that the file has for a record, NaN where it has none."""
    if "wspd" not in dataset:
        return float("nan")
    wind = dataset["wspd"]
    return float(wind.isel({name: i for name, i in record.items() if name in wind.dims}).values)
