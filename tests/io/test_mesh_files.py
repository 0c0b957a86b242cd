"""Meshes as files."""

import numpy as np
import pytest

from jaxocean.io import write_mesh

VERTICES = np.array([[0.0, 0, 0], [1, 0, 0.5], [1, 1, 0], [0, 1, -2]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def test_a_mesh_file_says_what_it_holds_and_holds_it(tmp_path):
    path = write_mesh(tmp_path / "patch.ply", VERTICES, FACES)
    header, body = path.read_bytes().split(b"end_header\n")
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    assert "element vertex 4" in lines
    assert "element face 2" in lines
    np.testing.assert_array_equal(np.frombuffer(body[:48], "<f4").reshape(4, 3), VERTICES)
    for number, face in enumerate(FACES):
        record = body[48 + 13 * number : 61 + 13 * number]
        assert record[0] == 3
        np.testing.assert_array_equal(np.frombuffer(record[1:], "<i4"), face)
    assert len(body) == 48 + 26


def test_meshes_that_make_no_sense_are_refused(tmp_path):
    with pytest.raises(ValueError, match="finite"):
        write_mesh(tmp_path / "a.ply", VERTICES * np.nan, FACES)
    with pytest.raises(ValueError, match="faces"):
        write_mesh(tmp_path / "a.ply", VERTICES, FACES + 2)
    assert not list(tmp_path.iterdir())
