"""Means and second moments of slopes and strain of every pattern, box-filtered to all levels."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..surface import Cascade, Fields
from ._boxes import Levels
from ._footprint import DEFAULT_PROBES, Footprint, check_probes
from ._look_up import average_probes, computing_type, look_up, reduce_centres
from ._moments import Moments, pair_products, symmetric_matrix
from ._refine import refine


class MomentPyramid(eqx.Module):
    """Footprint means and covariances of the slopes and of the strain, by look-up.

    Each pattern is filtered with its own size: a footprint larger than the pattern finds its constants, one smaller
    than the distance of its samples finds the surface between them and no spread. Means and covariances of
    independent patterns add.

    Two textures with at most eight channels each, all levels of a pattern one behind the other, so that what one
    footprint needs lies together: means of (a, b, c, ∂η/∂x, ∂η/∂y) and of the slopes' three products; means of the
    strain's six products. The patterns have no mean, hence products about 0 lose no digits that matter in float32.

    **Arguments:** `sizes` L_i [m] and `resolution`, samples a side; `means`, `products`: the textures [-].

    `from_fields` makes one; differentiable in the fields, and so in wind, noise, time and choppiness.

    **Source:** Dupuy & Bruneton 2012, section 3, with the products that their two channels lack.
    """

    sizes: tuple[float, ...] = eqx.field(static=True)
    resolution: int = eqx.field(static=True)
    means: Float[Array, "pattern texel 8"]
    products: Float[Array, "pattern texel 6"]

    @classmethod
    def from_fields(cls, fields: Fields, cascade: Cascade, *, refinement: int = 1) -> "MomentPyramid":
        """The pyramid of a sea's fields at one time.

        **Arguments:** `refinement`: 2 takes twice as many samples a side, for four times the memory. Between samples
        look-ups are bilinear, which flattens waves of few samples: where the bands reach up to their patterns' Nyquist
        wavenumbers, as they do by default, footprints of a few samples see too little strain.

        **Raises:** `ValueError` for a refinement below 1.
        """
        return _build(fields.slope, fields.strain, cascade.sizes, refinement)

    @classmethod
    def from_samples(
        cls,
        slope: Float[Array, "pattern y x 2"],
        strain: Float[Array, "pattern y x 3"],
        sizes: tuple[float, ...],
    ) -> "MomentPyramid":
        """The pyramid of slopes [-] and strains [-] sampled on patterns of the given sizes [m]."""
        return _build(slope, strain, sizes, 1)

    @property
    def nbytes(self) -> int:
        """Bytes of both textures."""
        return self.means.nbytes + self.products.nbytes

    def stored_as(self, dtype: jnp.dtype | type) -> "MomentPyramid":
        """The same rounded to another floating-point type; look-ups compute in float32 at least.

        In half precision the covariance is the difference of rounded numbers: see `CompressedMoments` for a form that
        keeps its digits.
        """
        return MomentPyramid(
            self.sizes, self.resolution, self.means.astype(dtype), self.products.astype(dtype)
        )

    def __call__(self, footprint: Footprint, probes: int = DEFAULT_PROBES) -> Moments:
        """Moments of the sum of the patterns in footprints.

        **Arguments:**

        - `footprint`: parallelograms on the rest plane, any batch.
        - `probes`: isotropic probes along the longer axis, each as wide as the shorter one. More than the ratio of
          the axes gain nothing; fewer blur across.

        **Returns:** `Moments`, batched like the footprint.

        **Raises:** `ValueError` for a number of probes below 1 or above 64.
        """
        return self._filter(footprint, probes, summed=True)

    def patterns(self, footprint: Footprint, probes: int = DEFAULT_PROBES) -> Moments:
        """Moments of each pattern by itself; the pattern is the last axis of the batch."""
        return self._filter(footprint, probes, summed=False)

    def _filter(self, footprint: Footprint, probes: int, *, summed: bool) -> Moments:
        check_probes(probes)
        dtype = computing_type(self.means.dtype)
        centres = reduce_centres(footprint, self.sizes, self.resolution, dtype)
        return _filter(self, centres, jnp.asarray(footprint.axes, dtype), probes, summed)


@partial(jax.jit, static_argnames=("sizes", "refinement"))
def _build(slope, strain, sizes: tuple[float, ...], refinement: int) -> MomentPyramid:
    slope, strain = refine(slope, refinement), refine(strain, refinement)
    levels = Levels(strain.shape[-2])
    means = jnp.concatenate([strain, slope, pair_products(slope)], axis=-1)
    return MomentPyramid(sizes, strain.shape[-2], levels.build(means), levels.build(pair_products(strain)))


@eqx.filter_jit
def _filter(
    pyramid: MomentPyramid,
    centres: Float[Array, "n *b 2"],
    axes: Float[Array, "*c 2 2"],
    probes: int,
    summed: bool,
) -> Moments:
    batch = jnp.broadcast_shapes(centres.shape[1:-1], axes.shape[:-2])
    scales = jnp.asarray([pyramid.resolution / size for size in pyramid.sizes], axes.dtype)

    def one(pattern) -> Moments:
        means, products, centre, scale = pattern
        look = partial(_raw_moments, (means, products), pyramid.resolution)
        shape = jnp.broadcast_to(axes * scale, (*batch, 2, 2))
        found = average_probes(look, jnp.broadcast_to(centre, (*batch, 2)), shape, probes)
        strain, slope, strains, slopes = found
        return Moments(
            slope,
            symmetric_matrix(slopes - pair_products(slope)),
            strain,
            symmetric_matrix(strains - pair_products(strain)),
        )

    patterns = (pyramid.means, pyramid.products, centres, scales)
    if not summed:
        return jax.tree.map(lambda each: jnp.moveaxis(each, 0, len(batch)), jax.lax.map(one, patterns))
    # One after the other: a program for all patterns at once takes longer to compile and is no faster.
    shapes = jax.eval_shape(one, jax.tree.map(lambda leaf: leaf[0], patterns))
    none = jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), shapes)
    return jax.lax.scan(lambda total, each: (jax.tree.map(jnp.add, total, one(each)), None), none, patterns)[
        0
    ]


def _raw_moments(textures, resolution: int, place, variance) -> tuple[Float[Array, "*b _"], ...]:
    """Means and mean products of strain and slopes under one isotropic probe."""
    (first, strains), inside = look_up(textures, resolution, place, variance)
    strain, slope, slopes = first[..., :3], first[..., 3:5], first[..., 5:]
    # What lies between neighbouring samples spreads inside the probe only as far as this is wide.
    inside = inside[..., None]
    point, across = pair_products(strain), pair_products(slope)
    return strain, slope, point + inside * (strains - point), across + inside * (slopes - across)
