"""A random sea on a cascade of periodic patterns."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float, Int

from ..._numerics import as_leaf, is_concrete, safe_sqrt
from ..._types import PerPattern, Scalar, ScalarLike
from ...spectra import AbstractSpectrum, Dispersion
from .._inverse import RestPoint, Sample, highest_root, implicit_offset
from .._protocol import AbstractSurface, Points
from ._cascade import Cascade
from ._choppiness import pattern_choppiness
from ._complex import turn
from ._evolve import Waves, height_spectrum
from ._fields import Fields, fields_of_waves, strains_of_waves, wave_filters
from ._phase import Clock, split_time
from ._points import interpolate_grids, reduce_points, sum_waves, wave_table


class Sea(AbstractSurface):
    """A linear Gaussian sea, made by `realise`.

    $$ η(x, t) = \\sum_k ĥ(k, t) e^{ik·x}, \\quad ĥ(k, t) = h_0(k) e^{−iωt} + h_0^*(−k) e^{+iωt} $$

    $$ D̂ = +i (k/|k|) ĥ $$

    so that a crest has j < 1. `fields` gives everything on the grids; `height`, `displacement`, `slope` and
    `strain` the sum over all patterns at any points; `rest_point` and `height_at` answer for places on the
    displaced surface.

    **Leaves:** the amplitudes and frequencies follow from `spectrum`, `noise` and `dispersion` when the sea
    is made: to change or to fit one of those, call `realise` again with it (differentiable).
    """

    cascade: Cascade = eqx.field(static=True)
    spectrum: AbstractSpectrum
    dispersion: Dispersion
    noise: Complex[Array, "pattern y x"]
    repeat_period: float | None = eqx.field(static=True)
    waves: Waves

    @property
    def amplitude(self) -> Complex[Array, "pattern y x"]:
        """h0(k) [m], in the order of the FFT."""
        return 0.5 * (self.waves.cosine + turn(self.waves.sine))

    @property
    def frequency(self) -> Float[Array, "pattern y x"]:
        """ω(k) [rad/s], in the order of the FFT."""
        return 2 * np.pi * self.waves.rate

    def fields(
        self, time: ScalarLike, choppiness: PerPattern = 1.0, breaking_wavenumber: ScalarLike | None = None
    ) -> Fields:
        """Height, displacement, slope and strain of every pattern on its grid.

        **Arguments:** `time` t [s]; `choppiness` λ [-], one number or one per pattern;
        `breaking_wavenumber` k_b [rad/m]: low-pass of the strain (not of the slope), or None.

        **Returns:** `Fields`, indexed [pattern, y, x]; displacement and strain include λ.

        **Raises:** `ValueError` for more or fewer λ than patterns, or a time or k_b that makes no sense.
        """
        arguments = self._arguments(time, choppiness, breaking_wavenumber)
        return fields_of_waves(self.cascade, self.waves, *arguments)

    def strains(
        self, time: ScalarLike, choppiness: PerPattern = 1.0, breaking_wavenumber: ScalarLike | None = None
    ) -> Float[Array, "pattern y x 3"]:
        """Strain (a, b, c) [-] of every pattern on its grid: `fields(…).strain` for less than half of its cost.

        **Arguments**, **Raises:** those of `fields`.
        """
        clock, lam, limit = self._arguments(time, choppiness, breaking_wavenumber)
        # At the start every wave is its cosine part: no sines and cosines of phases that are all 0.
        start = isinstance(time, (int, float)) and time == 0
        return strains_of_waves(self.cascade, self.waves, None if start else clock, lam, limit)

    def height(self, p: Points, time: ScalarLike) -> Float[Array, "*b"]:
        """Height η [m] over the rest points `p` (x, y) [m] at time t [s]."""
        return self._query(("height",), p, time, 1.0, None)[..., 0]

    def displacement(self, p: Points, time: ScalarLike, choppiness: PerPattern = 1.0) -> Float[Array, "*b 2"]:
        """Horizontal displacement Σλ_i(u_i, v_i) [m] of the rest points `p` [m] at time t [s]."""
        return self._query(("u", "v"), p, time, choppiness, None)

    def slope(self, p: Points, time: ScalarLike) -> Float[Array, "*b 2"]:
        """Slope (∂η/∂x, ∂η/∂y) [-] over the rest points `p` [m] at time t [s]."""
        return self._query(("slope_x", "slope_y"), p, time, 1.0, None)

    def strain(
        self,
        p: Points,
        time: ScalarLike,
        choppiness: PerPattern = 1.0,
        breaking_wavenumber: ScalarLike | None = None,
    ) -> Float[Array, "*b 3"]:
        """Strain (a, b, c) [-] at the rest points `p` [m] at time t [s], low-passed at k_b [rad/m]."""
        return self._query(("a", "b", "c"), p, time, choppiness, breaking_wavenumber)

    def rest_point(self, x: Points, time: ScalarLike, choppiness: PerPattern = 1.0) -> RestPoint:
        """The rest point p whose displaced place is now x: p + D(p, t) = x.

        Where the sea folds (j < 0) there are several: of those that the search finds it is the one with the
        highest surface. The derivative is that of this root, by the implicit function theorem; it grows as
        1/j towards the edge of a fold. First derivatives only.

        **Arguments:** `x` (x, y) [m]; `time` t [s]; `choppiness` λ [-], one number or one per pattern.

        **Returns:** a `RestPoint` with the point, its offset p − x, what remains of |p + D(p) − x|, and
        whether that is small enough: no place is given up, and none is silently wrong.
        """
        places = reduce_points(x, self.cascade, self.waves.rate.dtype)
        clock, lam, _ = self._arguments(time, choppiness, None)
        offset, residual, tolerance, _ = _invert(self, places, clock, lam)
        near = jnp.asarray(x)
        return RestPoint(near + offset.astype(near.dtype), offset, residual, tolerance)

    def height_at(self, x: Points, time: ScalarLike, choppiness: PerPattern = 1.0) -> Float[Array, "*b"]:
        """Height [m] of the displaced surface over the fixed places `x` [m]; the highest, where it folds.

        **Arguments** and the choice between several heights: as in `rest_point`.
        """
        places = reduce_points(x, self.cascade, self.waves.rate.dtype)
        clock, lam, _ = self._arguments(time, choppiness, None)
        return _invert(self, places, clock, lam)[3]

    def height_bound(self) -> Scalar:
        """Σ 2|h0| [m]: |η| is never more, however the waves meet."""
        return jnp.sum(2 * jnp.abs(self.amplitude))

    def slope_bound(self) -> Scalar:
        """Σ 2|k||h0| [-]: |∇η| is never more, however the waves meet."""
        filters = wave_filters(self.cascade, jnp.ones(self.cascade.count, self.waves.rate.dtype), None)
        return jnp.sum(2 * jnp.hypot(filters.kx, filters.ky) * jnp.abs(self.amplitude))

    def _arguments(self, time: ScalarLike, choppiness: PerPattern, breaking_wavenumber: ScalarLike | None):
        """Arguments as arrays of the sea's own type, checked."""
        dtype = self.waves.rate.dtype
        clock = split_time(time, self.repeat_period, dtype)
        if breaking_wavenumber is not None:
            if is_concrete(breaking_wavenumber) and not np.all(np.asarray(breaking_wavenumber) > 0):
                raise ValueError(
                    "Argument `breaking_wavenumber` must be greater than 0 rad/m, "
                    f"but is {breaking_wavenumber}."
                )
            breaking_wavenumber = as_leaf(breaking_wavenumber).astype(dtype)
        return clock, pattern_choppiness(choppiness, self.cascade.count).astype(dtype), breaking_wavenumber

    def _query(self, names, p, time, choppiness, breaking_wavenumber) -> Float[Array, "*b field"]:
        places = reduce_points(p, self.cascade, self.waves.rate.dtype)
        return _query(self, names, places, *self._arguments(time, choppiness, breaking_wavenumber))


@eqx.filter_jit
def _query(
    sea: Sea,
    names: tuple[str, ...],
    places: Float[Array, "n *b 2"],
    clock: Clock,
    choppiness: Float[Array, " n"],
    breaking_wavenumber: Scalar | None,
) -> Float[Array, "*b field"]:
    filters = wave_filters(sea.cascade, choppiness, breaking_wavenumber)
    return sum_waves(wave_table(filters.apply(names, height_spectrum(sea.waves, clock))), places, sea.cascade)


@eqx.filter_jit
def _invert(
    sea: Sea, places: Float[Array, "n *b 2"], clock: Clock, choppiness: Float[Array, " n"]
) -> tuple[Float[Array, "*b 2"], Float[Array, "*b"], Scalar, Float[Array, "*b"]]:
    """Offsets to the rest points, residuals, the tolerance on these, and heights."""
    filters = wave_filters(sea.cascade, choppiness, None)
    spectrum = height_spectrum(sea.waves, clock)
    points = places.reshape(sea.cascade.count, -1, 2)

    fixed, fixed_points = jax.lax.stop_gradient(
        (fields_of_waves(sea.cascade, sea.waves, clock, choppiness, None), points)
    )
    grids = jnp.concatenate([fixed.displacement, fixed.strain, fixed.height[..., None]], axis=-1)
    table = wave_table(filters.apply(("u", "v", "a", "b", "c", "height"), spectrum))
    fixed_table = jax.lax.stop_gradient(table)

    def unpack(values: Float[Array, "*s 6"]) -> Sample:
        return Sample(values[..., :2], values[..., 2:5], values[..., 5])

    def rough(which: Int[Array, " p"], offset: Float[Array, "s p 2"]) -> Sample:
        return unpack(interpolate_grids(grids, fixed_points[:, None, which] + offset, sea.cascade))

    def exact(which: Int[Array, " p"], offset: Float[Array, "s p 2"]) -> Sample:
        return unpack(sum_waves(fixed_table, fixed_points[:, None, which] + offset, sea.cascade))

    variance = jnp.sum(choppiness[:, None, None] ** 2 * jnp.abs(sea.waves.cosine) ** 2)
    scale = jax.lax.stop_gradient(safe_sqrt(variance))
    tolerance = 1e-5 * scale if points.dtype == jnp.float32 else 1e-10 * scale
    root, residual = jax.lax.stop_gradient(highest_root(rough, exact, points.shape[1], scale, tolerance))

    offset = implicit_offset(root, unpack(sum_waves(table, points + root, sea.cascade)))
    height = sum_waves(table, points + offset, sea.cascade)[..., 5]
    batch = places.shape[1:-1]
    return offset.reshape(*batch, 2), residual.reshape(batch), tolerance, height.reshape(batch)
