"""What every sky can be asked."""

import abc

import equinox as eqx
from jaxtyping import Array, Float


class AbstractSky(eqx.Module):
    """The light that comes down to the sea: a dome of diffuse radiance and the sun's direct beam, kept apart.

    Directions are unit vectors (*b, 3) that point away from the surface (x east, y north, z up). Colours are linear
    with sRGB primaries in the last axis and may lie outside of the gamut. Radiance is in W m⁻² sr⁻¹ nm⁻¹, weighted
    so that a spectrum which is 1 at all wavelengths has the luminance Y = 1; irradiance is in W m⁻² nm⁻¹ likewise.
    A direction that points below the horizon sees the sky that its mirror image sees: on the sea such a ray would be
    reflected once more.
    """

    @property
    @abc.abstractmethod
    def sun_direction(self) -> Float[Array, "3"]:
        """Unit vector towards the centre of the sun."""

    @property
    @abc.abstractmethod
    def sun_irradiance(self) -> Float[Array, "3"]:
        """Irradiance [W m⁻² nm⁻¹] of the sun's beam at the surface on a plane perpendicular to it.

        It falls smoothly to zero while the sun's disc sets.
        """

    @abc.abstractmethod
    def radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        """Diffuse radiance [W m⁻² sr⁻¹ nm⁻¹] that comes from `direction`, without the sun's disc."""

    @abc.abstractmethod
    def sun_radiance(self, direction: Float[Array, "*b 3"]) -> Float[Array, "*b 3"]:
        """Radiance [W m⁻² sr⁻¹ nm⁻¹] of the sun's disc; 0 beside it and below the horizon, where nothing is mirrored.

        Its edge is sharp: an image should sample the disc finely, or see it through `sun_irradiance`.
        """

    @abc.abstractmethod
    def lobe_radiance(
        self, direction: Float[Array, "*b 3"], variance: Float[Array, "*b"]
    ) -> Float[Array, "*b 3"]:
        """Mean diffuse radiance [W m⁻² sr⁻¹ nm⁻¹] over a lobe of directions.

        **Arguments:** `direction`: the lobe's axis; `variance`: its angular variance [rad²] along each of the two
        directions across the axis, at least 0. A facet whose slope varies by σ² turns the mirrored ray by 4σ².
        """

    @abc.abstractmethod
    def irradiance(self) -> Float[Array, "3"]:
        """Diffuse irradiance [W m⁻² nm⁻¹] on a horizontal plane, ∫ L cosθ dΩ over the upper half."""
