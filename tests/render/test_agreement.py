"""Two ways to find the water of one picture, as far as an eye can tell."""

import jax
import numpy as np
import pytest

import jaxocean as jo
from jaxocean import imagery

pytestmark = pytest.mark.slow

SIZE = (90, 160)


@pytest.fixture(scope="module")
def ocean() -> jo.Ocean:
    """A moderate sea under a clear sky."""
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed=8.0, direction=0.4))
    sea = jo.surface.realise(spectrum, jo.surface.Cascade((150.0, 29.0), 64), key=jax.random.key(0))
    sky = jo.optics.sky.HosekWilkie(3.0, sun_elevation=0.7, sun_azimuth=2.0)
    return jo.Ocean(sea, choppiness=1.0, threshold=0.6, breaking_wavenumber=6.0, sky=sky)


def test_a_mesh_with_a_vertex_in_each_pixel_and_rays_show_the_same_picture(ocean):
    camera = jo.render.Camera((0.0, 0.0, 10.0), heading=0.6, pitch=0.35, field_of_view=0.9)
    mesh, rays = (
        jo.render.render(ocean, camera, 1.0, SIZE, method=method)
        for method in (jo.render.Raster(1.0), jo.render.Rays())
    )
    assert float(np.std(mesh)) > 0.05 * float(np.mean(mesh))
    tone = imagery.Exposure(0.5 / float(np.mean(rays)))
    assert float(imagery.psnr(tone(mesh), tone(rays))) > 35.0
