"""Reading files of measured spectra through wavespectra."""

import os
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

from ..spectra import AbstractTail, Dispersion, MeasuredSpectrum
from ._dataset import ORIGIN, Record, WindOrigin, spectrum_from_dataset
from ._negative import AbstractNegativeCells

if TYPE_CHECKING:
    import xarray

Kind: TypeAlias = Literal["ndbc", "spotter", "triaxys", "ww3", "swan", "wavespectra"]
"""File formats: NDBC's five ASCII files, Spotter CSV, TRIAXYS, WAVEWATCH III netCDF, SWAN ASCII, and netCDF
in wavespectra's own convention (which `write_spectrum` writes)."""

Paths: TypeAlias = str | os.PathLike | Sequence[str | os.PathLike]

NDBC_COLUMNS = ("spec_1", "alpha1_1", "alpha2_1", "r1_1", "r2_1")
"""What the header of each of NDBC's five files names, in the order in which they are read."""

NDBC_SUFFIXES = ("data_spec", "swdir", "swdir2", "swr1", "swr2")


def read_spectrum(
    path: Paths,
    *,
    kind: Kind | None = None,
    record: Record = 0,
    tail: AbstractTail | None = None,
    dispersion: Dispersion | None = None,
    cut_off: float | None = None,
    negative: AbstractNegativeCells | None = None,
    tail_bins: int = 1,
) -> MeasuredSpectrum:
    """One record of a file of measured or modelled directional spectra.

    **Arguments:** `path`, `kind` as in `open_spectra`, the others as in `spectrum_from_dataset`.

    **Returns:** a `MeasuredSpectrum`, with the tail that was chosen.

    **Raises:** `FileNotFoundError`; `ValueError` for a file that is no spectrum or has another convention;
    `ImportError` where wavespectra is needed and not installed.
    """
    return spectrum_from_dataset(
        open_spectra(path, kind=kind),
        record=record,
        tail=tail,
        dispersion=dispersion,
        cut_off=cut_off,
        negative=negative,
        tail_bins=tail_bins,
    )


def open_spectra(path: Paths, *, kind: Kind | None = None) -> "xarray.Dataset":
    """All records of a file as a dataset `efth(…, freq, dir)` in wavespectra's conventions, in memory.

    **Arguments:** `path`: the file, or NDBC's five files in any order (one of them is enough if its siblings
    lie beside it); `kind`: the format, found out from the content if None.

    **Raises:** `FileNotFoundError`; `ValueError` for a file that is none of the formats or cannot be read as
    the one it seems to be; `ImportError` where wavespectra is needed and not installed.
    """
    files = [Path(path)] if isinstance(path, str | os.PathLike) else [Path(p) for p in path]
    if not files:
        raise ValueError("Argument `path` must name at least one file, but is empty.")
    for file in files:
        if not file.is_file():
            raise FileNotFoundError(f"There is no file `{file}`.")
    if kind is not None and kind not in get_args(Kind):
        raise ValueError(f"Argument `kind` must be one of {', '.join(get_args(Kind))}, but is {kind!r}.")
    found = _detect(files[0]) if kind is None else kind
    if found == "ndbc":
        files = _ndbc_files(files)
    elif len(files) > 1:
        raise ValueError(f"A spectrum of kind {found} is one file, but {len(files)} are given.")
    try:
        return _read(found, files)
    except (ImportError, MemoryError):
        raise
    except Exception as error:  # readers of foreign formats fail in any way whatever
        raise ValueError(
            f"File `{files[0]}` could not be read as a spectrum of kind {found} "
            f"({type(error).__name__}: {' '.join(str(error).split())}): check the file, or name its format with `kind`."
        ) from error


def _detect(file: Path) -> Kind:
    """The format of a file by its first bytes."""
    with file.open("rb") as stream:
        head = stream.read(4096)
    if head.startswith((b"CDF", b"\x89HDF")):
        names = _netcdf_names(file)
        if {"frequency", "direction", "efth"} <= names:
            return "ww3"
        if "efth" in names:
            return "wavespectra"
        raise ValueError(
            f"File `{file}` is netCDF, but has no variable `efth`: it is not a directional spectrum."
        )
    text = head.decode("latin-1")
    if text.startswith("SWAN"):
        return "swan"
    if text.startswith("TRIAXYS"):
        return "triaxys"
    if text.startswith("#") and any(f"{column} " in text for column in NDBC_COLUMNS):
        return "ndbc"
    if "Epoch Time" in text and "," in text:
        return "spotter"
    raise ValueError(
        f"File `{file}` is not a spectrum of a known format ({', '.join(get_args(Kind))}): "
        "check the path, or name the format with `kind`."
    )


def _netcdf_names(file: Path) -> set[str]:
    import netCDF4

    try:
        with netCDF4.Dataset(file) as dataset:
            return set(dataset.variables)
    except OSError as error:
        raise ValueError(
            f"File `{file}` begins like netCDF, but cannot be opened as such: it is cut short or damaged."
        ) from error


def _ndbc_files(files: list[Path]) -> list[Path]:
    """NDBC's five files in the order of `NDBC_COLUMNS`."""
    if len(files) == 1:
        siblings = [files[0].with_suffix(f".{suffix}") for suffix in NDBC_SUFFIXES]
        files = [sibling for sibling in siblings if sibling.is_file()] or files
    by_column = {}
    for file in files:
        with file.open("rb") as stream:
            header = stream.readline().decode("latin-1")
        by_column.update({column: file for column in NDBC_COLUMNS if f"{column} " in header})
    missing = [column for column in NDBC_COLUMNS if column not in by_column]
    if missing:
        raise ValueError(
            "A directional NDBC spectrum needs five files (data_spec, swdir, swdir2, swr1, swr2), but "
            f"{', '.join(missing)} is in none of {', '.join(f'`{file.name}`' for file in files)}."
        )
    return [by_column[column] for column in NDBC_COLUMNS]


def _read(kind: Kind, files: list[Path]) -> Any:
    import xarray

    if kind == "wavespectra":
        with xarray.open_dataset(files[0]) as dataset:
            return dataset.load()
    with warnings.catch_warnings():
        # wavespectra's use of pandas and its open files are no business of whoever reads a spectrum.
        for category in (DeprecationWarning, FutureWarning, ResourceWarning):
            warnings.simplefilter("ignore", category)
        try:
            return _read_foreign(kind, [str(file) for file in files])
        except Exception as error:
            traceback.clear_frames(error.__traceback__)  # closes what a reader left open when it failed
            raise


def _read_foreign(kind: Kind, names: list[str]) -> Any:
    wavespectra = _wavespectra()
    if kind == "ndbc":
        return wavespectra.read_ndbc_ascii(names)
    if kind == "spotter":
        return _with_wind(wavespectra.read_spotter(names[0]), "derived")
    if kind == "triaxys":
        return wavespectra.read_triaxys(names[0])
    if kind == "swan":
        return _with_wind(wavespectra.read_swan(names[0]), "model")
    dataset = wavespectra.read_ww3(names[0]).load()
    # wavespectra turns the directions to "coming from" but leaves the attributes that say "to".
    dataset["dir"].attrs = {"standard_name": "sea_surface_wave_from_direction", "units": "degree"}
    return _with_wind(dataset, "model")


def _with_wind(dataset: Any, origin: WindOrigin) -> Any:
    """Say on the wind where it comes from: see `wind_origin`."""
    if "wspd" in dataset:
        dataset["wspd"].attrs[ORIGIN] = origin
    return dataset


def _wavespectra() -> Any:
    try:
        import wavespectra
    except ImportError as error:
        raise ImportError(
            "Reading measured spectra needs wavespectra, which is not installed: "
            "`pip install jaxocean[spectra]`."
        ) from error
    return wavespectra
