"""Measured spectra in files and datasets: the way in, the way out, and files that are none."""

import math
import os
import subprocess
import sys
import warnings
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray
from _seas import table

import jaxocean as jo
from jaxocean import io
from jaxocean import spectra as sp

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import wavespectra  # noqa: F401 (registers the accessor `spec`)

DATA = Path(os.environ.get("JAXOCEAN_DATA", Path(__file__).parents[3] / "shared" / "data")) / "spectra"
real_files = pytest.mark.skipif(
    not DATA.is_dir(), reason=f"no measured spectra in {DATA} (set JAXOCEAN_DATA)"
)
FILES = {
    "ndbc": "41010.data_spec",
    "spotter": "spotter_20210929.csv",
    "triaxys": "triaxys.DIRSPEC",
    "ww3": "ww3file.nc",
    "swan": "swanfile.spec",
}

height = eqx.filter_jit(sp.significant_wave_height)
density = eqx.filter_jit(lambda s, k, phi: s.density(k, phi))


def made(times: int = 3) -> xarray.Dataset:
    """A made-up dataset in wavespectra's convention: a narrow swell from the west and noise."""
    f = 0.04 * 1.1 ** np.arange(26)
    degrees = np.arange(0.0, 360.0, 15.0)
    rng = np.random.default_rng(0)
    beam = np.cos(np.deg2rad(0.5 * (degrees - 270))) ** 30
    shape = np.exp(-(((f - 0.09) / 0.02) ** 2))[:, None] * beam + (
        0.01 * np.minimum(1, 0.1 / f)[:, None] ** 4 * rng.gamma(0.5, 1, (f.size, 24))
    )
    efth = np.arange(1, times + 1)[:, None, None] * shape
    return xarray.Dataset(
        {"efth": (("time", "freq", "dir"), efth)},
        {"time": np.arange(times), "freq": f, "dir": degrees},
    )


def records(dataset):
    """All records of a dataset, as `record` wants them."""
    dims = [name for name in dataset["efth"].dims if name not in ("freq", "dir")]
    for index in np.ndindex(*(dataset.sizes[name] for name in dims)):
        yield dict(zip(dims, map(int, index), strict=True))


def test_a_dataset_keeps_its_height():
    dataset = made()
    for record in records(dataset):
        expected = dataset["efth"].isel(record).spec.hs(tail=False)
        spectrum = io.spectrum_from_dataset(dataset, record=record, tail=sp.NoTail())
        np.testing.assert_allclose(height(spectrum), expected, rtol=1e-3)
        np.testing.assert_allclose(height(spectrum), expected, rtol=1e-12)


def test_a_power_tail_adds_what_wavespectra_adds():
    dataset = made()
    expected = float(dataset["efth"].isel(time=0).spec.hs(tail=True))
    spectrum = io.spectrum_from_dataset(dataset, tail=sp.PowerTail())
    assert expected > 1.0001 * float(height(eqx.tree_at(lambda s: s.tail, spectrum, sp.NoTail())))
    np.testing.assert_allclose(height(spectrum, band=(1e-3, 1e4)), expected, rtol=1e-3)


@real_files
@pytest.mark.parametrize("kind", FILES)
def test_every_record_of_a_real_file_keeps_its_height(kind):
    dataset = io.open_spectra(DATA / FILES[kind])
    efth = dataset["efth"]
    if kind == "triaxys":  # it has 0° and 360°: the same direction, which wavespectra counts twice
        assert 360 in efth["dir"]
        efth = efth.isel(dir=slice(0, -1))
    expected = efth.spec.hs(tail=False)
    for record in records(dataset):
        spectrum = io.spectrum_from_dataset(dataset, record=record, tail=sp.NoTail())
        np.testing.assert_allclose(height(spectrum), expected.isel(record), rtol=1e-6)
    doubled = float(dataset["efth"].isel(record).spec.hs(tail=False))
    np.testing.assert_allclose(height(spectrum), doubled, rtol=1e-3)


@real_files
@pytest.mark.parametrize("kind", FILES)
def test_mean_directions_and_periods_of_real_files_survive(kind):
    dataset = io.open_spectra(DATA / FILES[kind])
    efth = dataset["efth"].isel(next(records(dataset)))
    spectrum = io.spectrum_from_dataset(dataset, record=next(records(dataset)), negative=io.Clip())
    # The mean direction from the table itself, with negative cells clipped on both sides.
    towards = np.deg2rad(270 - efth["dir"].values)
    weights = np.maximum(efth.values, 0).sum(axis=efth.dims.index("freq"))
    if kind == "triaxys":
        weights[-1] = 0
    expected = math.atan2(np.sum(weights * np.sin(towards)), np.sum(weights * np.cos(towards)))
    phi = float(spectrum.first_direction) + np.arange(spectrum.energy.shape[1]) * (
        2 * np.pi / spectrum.energy.shape[1]
    )
    total = np.asarray(spectrum.energy).sum(axis=0)
    found = math.atan2(np.sum(total * np.sin(phi)), np.sum(total * np.cos(phi)))
    np.testing.assert_allclose(math.remainder(found - expected, 2 * math.pi), 0, atol=1e-6)


def test_waves_from_the_west_travel_east():
    spectrum = io.spectrum_from_dataset(made(1))
    k = sp.Dispersion().wavenumber(jnp.asarray(2 * np.pi * 0.09))
    phi = np.linspace(-np.pi, np.pi, 721)
    swell = density(spectrum, jnp.full(721, k), jnp.asarray(phi))
    np.testing.assert_allclose(phi[np.argmax(swell)], 0.0, atol=0.02)
    # From the north: towards −y.
    turned = made(1).assign_coords(dir=(made(1)["dir"] + 90) % 360)
    swell = density(io.spectrum_from_dataset(turned), jnp.full(721, k), jnp.asarray(phi))
    np.testing.assert_allclose(phi[np.argmax(swell)], -np.pi / 2, atol=0.02)


@real_files
def test_a_model_file_brings_its_depth_and_its_wind():
    dataset = io.open_spectra(DATA / FILES["ww3"])
    record = {"time": 1, "site": 0}
    spectrum = io.spectrum_from_dataset(dataset, record=record)
    np.testing.assert_allclose(spectrum.dispersion.depth, dataset["dpt"].isel(record), rtol=1e-6)
    wind = io.wind_from_dataset(dataset, record=record)
    np.testing.assert_allclose(wind.speed, 6.149, rtol=1e-3)
    # It comes from 331°, so it blows towards 151°: to the south-south-east.
    assert float(jnp.cos(wind.direction)) > 0 > float(jnp.sin(wind.direction))
    with pytest.raises(ValueError, match="along site too"):
        io.spectrum_from_dataset(dataset, record=1)


@real_files
def test_negative_cells_are_taken_out_without_adding_energy():
    dataset = io.open_spectra(DATA / FILES["ndbc"])
    negative = float((dataset["efth"] < 0).mean())
    assert 0.12 < negative < 0.15
    expected = dataset["efth"].spec.hs(tail=False).values
    heights = {}
    for repair in (io.Clip(), io.ClipAndRenormalise(), io.MaximumEntropy()):
        heights[type(repair)] = np.array(
            [
                height(io.spectrum_from_dataset(dataset, record=i, tail=sp.NoTail(), negative=repair))
                for i in range(0, 149, 12)
            ]
        )
    np.testing.assert_allclose(heights[io.ClipAndRenormalise], expected[::12], rtol=1e-6)
    np.testing.assert_allclose(heights[io.MaximumEntropy], expected[::12], rtol=1e-6)
    inflation = np.mean(heights[io.Clip] / expected[::12]) - 1
    assert 0.015 < inflation < 0.06


@real_files
def test_ndbcs_files_are_found_in_any_order_or_by_one_of_them():
    names = [DATA / f"41010.{suffix}" for suffix in ("swr2", "swdir", "data_spec", "swr1", "swdir2")]
    shuffled, one = io.open_spectra(names), io.open_spectra(DATA / "41010.swdir")
    xarray.testing.assert_identical(shuffled, one)
    with pytest.raises(ValueError, match=r"needs five files .* r2_1 is in none of"):
        io.open_spectra([name for name in names if name.suffix != ".swr2"][:4])


@real_files
def test_a_maximum_entropy_distribution_keeps_the_measured_coefficients():
    dataset = io.open_spectra(DATA / FILES["ndbc"]).isel(time=[40])
    fine = io.spectrum_from_dataset(dataset, negative=io.MaximumEntropy())
    table = dataset["efth"].values[0]
    towards = np.deg2rad(270 - dataset["dir"].values)
    phi = float(fine.first_direction) + np.arange(36) * (2 * np.pi / 36)
    row = int(np.argmax(table.sum(axis=1)))
    for n in (1, 2):
        measured = table[row] @ np.exp(1j * n * towards) / table[row].sum()
        kept = np.asarray(fine.energy)[row] @ np.exp(1j * n * phi) / np.asarray(fine.energy)[row].sum()
        assert abs(kept - measured) < 0.02


def test_directions_that_are_missing_values_become_isotropic():
    # NDBC writes 999 where it has no directions; the truncated sum is then absurd, its mean is right.
    dataset = made(1)
    wave = 1 + 2 * 999 * np.cos(np.deg2rad(dataset["dir"].values - 20))
    dataset["efth"][0, 3] = 0.7 * wave
    spectrum = io.spectrum_from_dataset(dataset, tail=sp.NoTail())
    np.testing.assert_allclose(spectrum.energy[3], 0.7 * 180 / np.pi, rtol=1e-9)


def test_a_written_sea_is_read_back(tmp_path):
    sea = sp.JONSWAP(
        significant_wave_height=2.0, peak_period=8.0, direction=1.0, dispersion=sp.Dispersion(12.0)
    )
    path = io.write_spectrum(sea, tmp_path / "sea.nc", dispersion=sea.dispersion)
    assert list(tmp_path.iterdir()) == [path]
    back = io.read_spectrum(path)
    np.testing.assert_allclose(height(back), 2.0, rtol=5e-3)
    np.testing.assert_allclose(back.dispersion.depth, 12.0)
    np.testing.assert_allclose(eqx.filter_jit(sp.peak_period)(back), 8.0, rtol=3e-2)
    k = jnp.asarray([0.09, 0.2, 0.5])
    phi = jnp.asarray([1.0, 1.3, 0.7])
    np.testing.assert_allclose(density(back, k, phi), density(sea, k, phi), rtol=0.05)
    assert isinstance(back.tail, sp.PowerTail)


def test_wavespectra_reads_what_is_written(tmp_path):
    sea = table()
    dataset = io.dataset_from_spectrum(sea, frequency=np.linspace(0.04, 0.4, 120), directions=72)
    expected = height(sea, band=(float(sp.Dispersion().wavenumber(jnp.asarray(2 * np.pi * 0.04))), 0.64))
    np.testing.assert_allclose(dataset["efth"].isel(time=0).spec.hs(tail=False), expected, rtol=1e-2)


def test_the_chosen_cut_off_and_tail_are_part_of_the_result():
    dataset = made(1)
    tail = sp.ElfouhailyTail(jo.Wind(8.0))
    spectrum = io.spectrum_from_dataset(dataset, tail=tail, cut_off=0.3)
    assert spectrum.tail is tail
    assert float(spectrum.frequency[-1]) <= 0.3 < 1.2 * float(spectrum.frequency[-1])
    padded = made(1)
    padded["efth"][0, -5:] = 0
    assert io.spectrum_from_dataset(padded).frequency.size == dataset["freq"].size - 5


def test_the_dtype_follows_the_session():
    with jax.enable_x64(False):
        spectrum = io.spectrum_from_dataset(made(1))
        assert spectrum.energy.dtype == jnp.float32
        single = float(height(spectrum))
    np.testing.assert_allclose(single, height(io.spectrum_from_dataset(made(1))), rtol=1e-4)


def with_attributes(name, **attributes):
    dataset = made(1)
    dataset[name].attrs.update(attributes)
    return dataset


BAD = {
    "going to": (
        lambda: with_attributes("dir", standard_name="sea_surface_wave_to_direction"),
        r"directions that waves go to .*: replace it by \(dir \+ 180\) % 360",
    ),
    "radians": (
        lambda: made(1).assign_coords(dir=np.deg2rad(made(1)["dir"])),
        "`dir` seems to be in radians",
    ),
    "radian units": (lambda: with_attributes("dir", units="radian"), "`dir` seems to be in radians"),
    "energy per radian": (lambda: with_attributes("efth", units="m2 s rad-1"), "must be in m² s degree⁻¹"),
    "out of range": (
        lambda: made(1).assign_coords(dir=made(1)["dir"] - 180),
        "between 0 and 360 degrees .* but runs from -180 to 165",
    ),
    "half a circle": (lambda: made(1).isel(dir=slice(0, 12)), "must cover the circle"),
    "uneven": (lambda: made(1).isel(dir=[0, 1, 2, 5, 9, 12, 20]), "must cover the circle"),
    "no variable": (lambda: made(1).rename(efth="spectrum"), "no variable `efth` .it has `spectrum`"),
    "no directions": (lambda: made(1).isel(dir=0, drop=True), "no coordinate `dir`"),
    "no coordinate": (lambda: made(1).drop_vars("freq"), "no coordinate `freq`"),
    "missing values": (lambda: made(1).where(made(1)["dir"] > 40), "`efth` has missing values in"),
    "flat": (lambda: 0 * made(1), "`efth` is 0 everywhere"),
    "frequencies twice": (
        lambda: made(1).assign_coords(freq=np.full(26, 0.1)),
        "`freq` must hold different numbers",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_dataset_in_another_convention_is_refused_in_one_sentence(name):
    make, message = BAD[name]
    with pytest.raises(ValueError, match=message) as error:
        io.spectrum_from_dataset(make())
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (7, "must lie within the 3 entries of `time`, but is 7"),
        ({"site": 0}, "`efth` has no dimension `site`"),
    ],
)
def test_a_record_that_is_not_there_is_refused(record, message):
    with pytest.raises(ValueError, match=message):
        io.spectrum_from_dataset(made(), record=record)


def test_a_dataset_without_wind_says_so():
    with pytest.raises(ValueError, match="no variable `wspd`"):
        io.wind_from_dataset(made())


@pytest.mark.parametrize(
    ("content", "kind", "message"),
    [
        (b"name,age\nAda,36\n", None, "is not a spectrum of a known format"),
        (b"", None, "is not a spectrum of a known format"),
        (b"\x00\xff\x10" * 99, None, "is not a spectrum of a known format"),
        (
            b"SWAN   1   Swan standard spectral file\nnothing more\n",
            None,
            "could not be read as a spectrum of kind swan",
        ),
        (b"TRIAXYS BUOY\n", "triaxys", "could not be read as a spectrum of kind triaxys"),
        (b"CDF\x01 broken", None, "could not be read|not a directional spectrum"),
        (b"#YY  MM DD hh mm alpha1_1 (freq_1)\n", None, "needs five files"),
    ],
)
def test_a_file_that_is_no_spectrum_is_refused(tmp_path, content, kind, message):
    path = tmp_path / "file.dat"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=message) as error:
        io.read_spectrum(path, kind=kind)
    assert "\n" not in str(error.value)


def test_other_netcdf_is_no_spectrum(tmp_path):
    xarray.Dataset({"temperature": ("x", [1.0, 2.0])}).to_netcdf(tmp_path / "other.nc", engine="netcdf4")
    with pytest.raises(ValueError, match="no variable `efth`"):
        io.read_spectrum(tmp_path / "other.nc")


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no file `.*nowhere\.nc`"):
        io.read_spectrum(tmp_path / "nowhere.nc")


def test_without_wavespectra_the_error_says_how_to_install_it(tmp_path, monkeypatch):
    path = tmp_path / "buoy.csv"
    path.write_text("Battery Voltage (V) ,Epoch Time ,f_0\n1,2,3\n")
    monkeypatch.setitem(sys.modules, "wavespectra", None)
    with pytest.raises(ImportError, match=r"pip install jaxocean\[spectra\]"):
        io.read_spectrum(path)


def test_importing_jaxocean_loads_neither_wavespectra_nor_xarray():
    heavy = ("xarray", "wavespectra", "netCDF4", "pandas")
    code = f"import sys, jaxocean; print([m for m in {heavy} if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
