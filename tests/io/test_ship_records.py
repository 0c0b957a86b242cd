"""Tables of ship records: what is read, and files that are none."""

import os
from pathlib import Path

import numpy as np
import pytest

from jaxocean import io

FILE = Path(os.environ.get("JAXOCEAN_DATA", Path(__file__).parents[3] / "shared" / "data"))
FILE = FILE / "meteorology" / "test_36_data.txt"
GOOD = "jd u zu ta cp sigH\n9.5 8.0 18 25 15 2.5\n\n9.6 nan 18 25 15 2.5\n9.7 8.0 18 25 15 -999\n"


def test_columns_are_found_by_name_and_gaps_are_known(tmp_path):
    path = tmp_path / "ship.txt"
    path.write_text(GOOD)
    ship = io.read_ship_records(path)
    np.testing.assert_allclose(ship.day, [9.5, 9.6, 9.7])
    np.testing.assert_allclose(ship.peak_speed, 15)
    np.testing.assert_array_equal(ship.complete(), [True, False, False])
    assert np.isnan(ship.sea_temperature).all()


@pytest.mark.skipif(not FILE.is_file(), reason=f"no ship records in {FILE} (set JAXOCEAN_DATA)")
def test_the_records_of_a_cruise_agree_with_numpy():
    ship = io.read_ship_records(FILE)
    names = FILE.read_text().split("\n", 1)[0].split()
    table = np.genfromtxt(FILE, skip_header=1)
    for name, values in (
        ("u", ship.wind_speed),
        ("cp", ship.peak_speed),
        ("sigH", ship.significant_wave_height),
    ):
        np.testing.assert_array_equal(values, table[:, names.index(name)])
    assert ship.wind_speed.size == 2165
    assert ship.complete().sum() == 2165 - np.isnan(table[:, names.index("sigH")]).sum()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "lacks `u` .wind speed"),
        (b"u zu cp\n1 2 3\n", "lacks `sigH` .Hs"),
        (b"u zu cp sigH\n", "holds no record"),
        (b"u zu cp sigH\n1 2 3 4\n1 2 3\n", "Line 3 of .* must hold 4 numbers, .* but holds 3"),
        (b"u zu cp sigH\n1 2 3 four\n", "Line 2 of .* must hold numbers, but holds 'four'"),
        (b"\xff\xfe\x00\x81", "is not a text file"),
    ],
)
def test_a_file_that_holds_no_ship_records_is_one_sentence(tmp_path, content, says):
    path = tmp_path / "ship.txt"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=says) as error:
        io.read_ship_records(path)
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_there_is_said_so(tmp_path):
    with pytest.raises(FileNotFoundError, match="There is no file"):
        io.read_ship_records(tmp_path / "none.txt")
