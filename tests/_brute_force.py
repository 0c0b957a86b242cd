"""Rays against every triangle of a mesh, in NumPy."""

import numpy as np


def triangles_of_grid(place) -> np.ndarray:
    """(n, 3, 3) corners of the triangles of a grid of vertices (rows, columns, 3)."""
    corners = np.asarray(place)
    a, b, c, d = corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]
    return np.concatenate(
        [np.stack([a, b, c], -2).reshape(-1, 3, 3), np.stack([a, c, d], -2).reshape(-1, 3, 3)]
    )


def nearest_triangle(triangles: np.ndarray, start: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Depth along each ray (n, 3) to the nearest triangle, by the rule of Möller and Trumbore; infinite without one."""
    e1, e2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    s = start - triangles[:, 0]
    q = np.cross(s, e1)
    depth = np.full(len(rays), np.inf)
    for number, ray in enumerate(rays):
        p = np.cross(ray, e2)
        det = np.sum(e1 * p, -1)
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v, t = np.sum(s * p, -1) / det, q @ ray / det, np.sum(e2 * q, -1) / det
        inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
        depth[number] = np.min(t[inside], initial=np.inf)
    return depth
