"""The waves that foam does not see still bend the light."""

import jax
import jax.numpy as jnp
import numpy as np
from _waves import wind_sea

from jaxocean.render import SurfaceMoments
from jaxocean.render._footprint import displaced
from jaxocean.surface import Cascade, realise

CASCADE = Cascade((60.0, 9.0), 32)


def test_slopes_of_the_displaced_surface_do_not_depend_on_the_breaking_wavenumber():
    sea = realise(wind_sea(14.0), CASCADE, key=jax.random.key(3))
    x, y = jnp.asarray(np.random.default_rng(0).uniform(0, 540, (2, 500)))

    variance = jnp.where(jnp.arange(500) % 2 == 0, 0.05, 3.0) ** 2

    @jax.jit
    def see(fields):
        return displaced(SurfaceMoments.from_fields(fields, CASCADE)(jnp.zeros(2), x, y, variance))

    all_waves, few_waves = see(sea.fields(2.0, 1.3)), see(sea.fields(2.0, 1.3, 0.1))
    assert np.std(all_waves.strain[0]) > 5 * np.std(few_waves.strain[0])
    for name in ("deformation", "slope", "slopes"):
        np.testing.assert_allclose(getattr(few_waves, name), getattr(all_waves, name), atol=1e-9)
