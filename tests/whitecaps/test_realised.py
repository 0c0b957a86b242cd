"""Coverage counted on realisations: against the closure, and against what a camera above a displaced mesh sees."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo
from jaxocean.whitecaps import ExactClosure, SmoothBreaking, jacobian, realised_coverage

CASCADE = jo.surface.Cascade(sizes=(200.0, 37.0), resolution=64)
LIMIT = CASCADE.wavenumber_limit


def spectrum(speed=15.0):
    return jo.spectra.Elfouhaily(jo.Wind(speed), inverse_wave_age=0.84)


@pytest.fixture(scope="module")
def strains():
    """Strain of 64 seas at λ = 1.7."""

    @jax.jit
    def strain(key):
        return jo.surface.realise(spectrum(), CASCADE, key=key).fields(0.0, 1.7, LIMIT).strain

    return jax.lax.map(strain, jax.random.split(jax.random.key(7), 64))


@pytest.mark.parametrize("measure", ["rest", "projected"])
@pytest.mark.parametrize("threshold", [0.6, 0.45, 0.3])
def test_realisations_agree_with_the_closure_within_their_own_error(strains, measure, threshold):
    counted = np.asarray(
        jax.lax.map(lambda s: realised_coverage(s, threshold, measure=measure, shifts=4), strains)
    )
    stats = jo.whitecaps.strain_statistics(spectrum(), 1.7, cascade=CASCADE, breaking_wavenumber=LIMIT)
    expected = float(ExactClosure(measure=measure)(stats, threshold))
    error = counted.std(ddof=1) / np.sqrt(counted.size)
    assert abs(counted.mean() - expected) < 3 * error
    assert error < 0.25 * expected


def test_smooth_indicator_tends_to_the_hard_one(strains):
    hard = realised_coverage(strains[0], 0.5)
    smooth = realised_coverage(strains[0], 0.5, breaking=SmoothBreaking(1e-4))
    np.testing.assert_allclose(smooth, hard, rtol=0.02)


def view_from_above(x, y, height, foam):
    """Share of the plane where the uppermost sheet of a triangle mesh is foam: a z-buffer, one pixel per cell."""
    n = foam.shape[0]
    corners = [(0, 0), (0, 1), (1, 1), (1, 0)]
    fields = [np.pad(f, ((0, 1), (0, 1)), mode="wrap") for f in (height, foam)]
    px, py = (np.pad(c, ((0, 1), (0, 1)), mode="wrap") for c in (x, y))
    px[:, -1] += n
    py[-1, :] += n
    pixels, heights, whites = [], [], []
    for triangle in ((0, 1, 2), (0, 2, 3)):
        (ax, ay, az, af), (bx, by, bz, _), (cx, cy, cz, _) = (
            [f[dy : dy + n, dx : dx + n].ravel() for f in (px, py, *fields)]
            for dy, dx in (corners[v] for v in triangle)
        )
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        area = np.where(area == 0, 1e-30, area)
        left, low = np.ceil(np.minimum(np.minimum(ax, bx), cx)), np.ceil(np.minimum(np.minimum(ay, by), cy))
        for i in range(5):
            for j in range(5):
                qx, qy = left + i, low + j
                u = ((qx - ax) * (cy - ay) - (cx - ax) * (qy - ay)) / area
                v = ((bx - ax) * (qy - ay) - (qx - ax) * (by - ay)) / area
                inside = (u >= 0) & (v >= 0) & (u + v < 1)
                pixels.append((qy[inside] % n) * n + qx[inside] % n)
                heights.append((az + u * (bz - az) + v * (cz - az))[inside])
                whites.append(af[inside])
    pixels, heights, whites = (np.concatenate(part) for part in (pixels, heights, whites))
    order = np.lexsort((heights, pixels))
    last = np.append(np.diff(pixels[order]) > 0, True)
    assert np.count_nonzero(last) > 0.999 * n * n
    return whites[order][last].mean()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("choppiness", "threshold", "tolerance"),
    [
        (1.3, 0.5, 0.03),
        (2.2, 0.5, 0.03),
        (2.2, 0.3, 0.03),
        (3.5, 0.4, 0.03),
        # Where foam is little more than the folds themselves, their crests also overhang their flanks.
        (3.5, 0.1, 0.3),
        (3.5, -0.2, 0.3),
    ],
)
def test_both_measures_are_what_a_displaced_mesh_shows(choppiness, threshold, tolerance):
    size, n = 60.0, 512
    cascade = jo.surface.Cascade(sizes=(size,), resolution=n)
    limit = 0.25 * cascade.wavenumber_limit
    above, rest, counted = [], [], {"rest": [], "projected": []}
    for seed in range(3):
        # The mesh and the foam see the same, well resolved waves.
        sea = jo.surface.realise(
            _LowPassed(spectrum(16.0), jnp.asarray(limit)), cascade, key=jax.random.key(seed)
        )
        fields = sea.fields(0.0, choppiness)
        j = np.asarray(jacobian(fields.strain[0]))
        rest.append((j < threshold).mean())
        for measure, values in counted.items():
            values.append(float(realised_coverage(fields.strain, threshold, measure=measure)))
        grid = np.arange(n)
        move = np.asarray(fields.displacement[0]) * n / size
        x, y = grid[None, :] + move[..., 0], grid[:, None] + move[..., 1]
        above.append(view_from_above(x, y, np.asarray(fields.height[0]), (j < threshold).astype(float)))
    np.testing.assert_allclose(np.mean(counted["rest"]), np.mean(rest), rtol=1e-12)
    np.testing.assert_allclose(np.mean(counted["projected"]), np.mean(above), rtol=tolerance)


class _LowPassed(jo.spectra.AbstractSpectrum):
    """A spectrum with its short waves taken away."""

    spectrum: jo.spectra.AbstractSpectrum
    limit: jax.Array

    def density(self, wavenumber, angle):
        return jo.spectra.breaking_filter(wavenumber, self.limit) ** 2 * self.spectrum.density(
            wavenumber, angle
        )

    def harmonics(self, wavenumber):
        return jo.spectra.integrate_harmonics(self, wavenumber)


def test_shifts_must_be_positive(strains):
    with pytest.raises(ValueError, match="`shifts` must be at least 1"):
        realised_coverage(strains[0], 0.5, shifts=0)
