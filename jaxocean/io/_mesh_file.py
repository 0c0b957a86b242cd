"""Triangles as PLY files, which renderers and modellers read."""

import os
from pathlib import Path

import numpy as np
from jaxtyping import Array, Float, Int

from ._files import written_whole


def write_mesh(
    path: str | os.PathLike,
    vertices: Float[Array, "vertex 3"] | Float[np.ndarray, "vertex 3"],
    faces: Int[Array, "face 3"] | Int[np.ndarray, "face 3"],
) -> Path:
    """Write triangles as a PLY file, binary and little-endian. The file appears whole or not at all.

    **Arguments:** `path`: of the file; `vertices` (x, y, z) [m], kept as float32; `faces`: numbers of each triangle's
    vertices, the first of which is 0. See `jaxocean.render.patch_mesh`.

    **Returns:** the path.

    **Raises:** `ValueError` for vertices that are not finite or faces of vertices that do not exist; `OSError` if the
    file cannot be written.
    """
    places, corners = np.asarray(vertices, "<f4"), np.asarray(faces)
    if not np.all(np.isfinite(places)):
        raise ValueError("Argument `vertices` must be finite, but some are not.")
    if corners.size and not 0 <= corners.min() <= corners.max() < len(places):
        raise ValueError(
            f"Argument `faces` must number vertices from 0 to {len(places) - 1}, but goes from {corners.min()} to "
            f"{corners.max()}."
        )
    triangles = np.empty(len(corners), [("count", "u1"), ("corners", "<i4", 3)])
    triangles["count"], triangles["corners"] = 3, corners
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment lengths in metres, z up\n"
        f"element vertex {len(places)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )

    def write(target: Path) -> None:
        target.write_bytes(header.encode("ascii") + places.tobytes() + triangles.tobytes())

    return written_whole(Path(path), write)
