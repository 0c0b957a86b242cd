"""`repetition`: how many patterns does a sea need, lest it repeat visibly?"""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

import jaxocean as jo
from jaxocean.whitecaps import StrainStatistics, jacobian

from .. import schema
from ..common import _build
from ..harness._errors import UserError
from ..harness._files import Files
from ..harness._progress import Reporter
from ..harness._result import Result
from . import _repetition_report, _repetition_views
from ._repetition_views import Repetition

PEAK_WAVES = 3
"""Side peaks are looked for beyond so many wavelengths of the spectral peak."""
NEAR = 500.0
BIN = 5.0
"""Distance [m] over which the drawn curves take their maximum."""
BATCH = 100_000
SPREAD = 0.05


def run(config: schema.RepetitionConfig, progress: Reporter, store: Files) -> Result:
    """Autocorrelation and period of sums of patterns; see `schema.RepetitionConfig`."""
    with jax.enable_x64(True):
        spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind))
        peak = 2 * math.pi / float(_elfouhaily(spectrum).peak_wavenumber())
        cascades = _cascades(config, spectrum)
        if PEAK_WAVES * peak >= config.reach:
            raise UserError(
                f"Key `reach` must be more than {PEAK_WAVES * peak:.4g} m, three wavelengths of the peak, but is "
                f"{config.reach:g} m."
            )
        advance = progress.count("Autocorrelations", len(cascades))
        found = []
        for name, cascade in cascades.items():
            found.append(_repeat(name, cascade, spectrum, peak, config))
            advance()
    progress.step("Drawing")
    strips = _strips(config, cascades)
    _repetition_views.plot(store, found, strips, config)
    _repetition_views.save(store, found, config)
    result = _repetition_report.result(found, peak, config)
    store.text("report.md", _repetition_report.report(result, found, peak, config))
    return result


def _elfouhaily(spectrum: jo.spectra.AbstractSpectrum) -> jo.spectra.Elfouhaily:
    inner = spectrum.spectrum if isinstance(spectrum, jo.spectra.ScaledSpectrum) else spectrum
    assert isinstance(inner, jo.spectra.Elfouhaily)
    return inner


def _cascades(
    config: schema.RepetitionConfig, spectrum: jo.spectra.AbstractSpectrum
) -> dict[str, jo.surface.Cascade]:
    """The family of n patterns, and what it is compared with."""
    cascades = {f"n = {n}": _family(n, config) for n in config.patterns}
    n = config.resolution
    cascades["paper"] = jo.surface.Cascade(config.paper, n)
    cascades["commensurate"] = jo.surface.Cascade(config.commensurate, n)
    peak = float(_elfouhaily(spectrum).peak_wavenumber())
    cascades["recommended"] = jo.surface.recommend_cascade(
        peak_wavenumber=peak, smallest_scale=2 * config.spacing, resolution=n, waves=config.waves
    )
    cascades["peak shared"] = _shared(cascades["recommended"], spectrum)
    middle = jo.surface.spread_sizes(config.largest, config.spacing * n, 4)
    noise = np.random.default_rng(config.seed).uniform(-SPREAD, SPREAD, (config.others, 4))
    for i, one in enumerate(noise):
        sizes = [float(f"{size * (1 + x):.2f}") for size, x in zip(middle, one, strict=True)]
        cascades[f"random {i + 1}"] = jo.surface.Cascade(sizes, n)
    return cascades


def _family(count: int, config: schema.RepetitionConfig) -> jo.surface.Cascade:
    """n patterns with the same samples and the same spacing, as large as the waves per pattern allow."""
    resolution = 2 * round(math.sqrt(config.samples / count) / 2)
    smallest = config.spacing * resolution
    ratio = resolution / (2 * config.waves)
    largest = min(config.largest, smallest * ratio ** (count - 1))
    if count > 1 and largest <= smallest * 1.2 ** (count - 1):
        raise UserError(
            f"Key `largest` must leave room for {count} patterns above the smallest, {smallest:.4g} m, but at most "
            f"{largest:.4g} m are possible: lower `patterns`, `spacing` or `waves`."
        )
    return jo.surface.Cascade(jo.surface.spread_sizes(largest, smallest, count), resolution)


def _shared(cascade: jo.surface.Cascade, spectrum: jo.spectra.AbstractSpectrum) -> jo.surface.Cascade:
    """The same, with the peak's waves in two large patterns that carry half of the height each."""
    sizes, n = cascade.sizes, cascade.resolution
    second = jo.surface.spread_sizes(sizes[0] / 1.3, sizes[0] / 1.3, 1)[0]
    lower, upper = math.pi / sizes[0], math.pi * n / sizes[0]
    total = float(jo.spectra.height_variance(spectrum, band=(lower, upper)))
    edges = [lower, upper]
    for _ in range(12):
        half = math.sqrt(edges[0] * edges[1])
        below = float(jo.spectra.height_variance(spectrum, band=(lower, half)))
        edges[int(below > 0.5 * total)] = half
    half = edges[0]
    bands = [(lower, half), (half, math.pi * n / second)]
    rest = list(cascade.bands[1:])
    rest[0] = (math.pi * n / second, rest[0][1])
    return jo.surface.Cascade((sizes[0], second, *sizes[1:]), n, bands + rest)


def _repeat(
    name: str,
    cascade: jo.surface.Cascade,
    spectrum: jo.spectra.AbstractSpectrum,
    peak: float,
    config: schema.RepetitionConfig,
) -> Repetition:
    distance = np.arange(0.0, config.reach, config.step)
    heights, curves, strain, strains = _correlate(spectrum, cascade, distance, config.breaking_wavenumber)
    far = distance > PEAK_WAVES * peak
    highest = {}
    for i, what in enumerate(("height", "jacobian")):
        both = np.asarray(curves[i])
        axis, place = np.unravel_index(np.argmax(np.where(far, both, -1)), both.shape)
        near = float(both[:, far & (distance < NEAR)].max(initial=0.0))
        highest[what] = (float(both[axis, place]), float(distance[place]), int(axis), near)
    _, lag, axis, _ = highest["jacobian"]
    # Both points of a pair on the same axis: the other one's sum is rounded otherwise.
    along = np.asarray(strain, np.float64)[axis]
    again, coverage = _again((along[0], along[np.searchsorted(distance, lag)]), config)
    bins = max(1, round(BIN / config.step))
    return Repetition(
        name=name,
        cascade=cascade,
        height_shares=_shares(heights),
        jacobian_shares=_shares(strains),
        height=highest["height"],
        jacobian=highest["jacobian"],
        again=again,
        coverage=coverage,
        distance=_binned(distance, bins, np.min),
        height_curve=_binned(np.asarray(curves[0][0]), bins, np.max),
        jacobian_curve=_binned(np.asarray(curves[1][0]), bins, np.max),
    )


def _shares(parts: Float[Array, " n"]) -> np.ndarray:
    parts64 = np.asarray(parts, np.float64)
    return parts64 / parts64.sum()


def _binned(values: np.ndarray, size: int, of) -> np.ndarray:
    whole = len(values) // size * size
    return of(values[:whole].reshape(-1, size), axis=1)


@eqx.filter_jit
def _correlate(
    spectrum: jo.spectra.AbstractSpectrum,
    cascade: jo.surface.Cascade,
    distance: Float[np.ndarray, " r"],
    breaking_wavenumber: float | None,
) -> tuple[
    Float[Array, " pattern"],
    tuple[Float[Array, "2 r"], Float[Array, "2 r"]],
    Float[Array, "2 r 3 3"],
    Float[Array, " pattern"],
]:
    """How the sea resembles itself along both axes, and what each pattern has of it (λ = 1).

    **Returns:** variances of the height; autocorrelations of the height and of the Jacobian; autocovariance of the
    strain; variances of the Jacobian.
    """
    energy = jo.surface.cell_energy(spectrum, cascade)
    # In single precision but for the distances: enough for a correlation, and twice as fast.
    rough = energy.astype(jnp.float32)
    heights, strains, variances = [], [], []
    for axis in (0, 1):
        heights.append(jnp.sum(jo.surface.autocovariance(rough, cascade, distance, axis=axis), 0))
        covariance = jo.surface.strain_autocovariance(
            rough, cascade, distance, breaking_wavenumber=breaking_wavenumber, axis=axis
        )
        strains.append(jnp.sum(covariance, 0))
        variances.append(_jacobian_variance(covariance[:, 0]))
    height, strain = jnp.stack(heights), jnp.stack(strains)
    j = _jacobian_variance(strain)
    return jnp.sum(energy, (1, 2)), (height / height[:, :1], j / j[:, :1]), strain, variances[0]


def _jacobian_variance(covariance: Float[Array, "*b 3 3"]) -> Float[Array, "*b"]:
    return StrainStatistics(jnp.zeros_like(covariance[..., 0]), covariance).jacobian_variance()


def _again(
    strain: tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "3 3"]], config: schema.RepetitionConfig
) -> tuple[tuple[float, float], float]:
    """Of the foam at a point, how much is foam again at the other one (± standard error); and the coverage."""
    here, there = strain
    values, vectors = np.linalg.eigh(np.block([[here, there], [there, here]]))
    root = jnp.asarray(vectors * np.sqrt(np.maximum(values, 0)), jnp.float32)
    count = math.ceil(config.draws / BATCH)
    keys = jax.random.split(jax.random.fold_in(jax.random.key(config.seed), 1), count)
    one, both = (int(jnp.sum(x)) for x in _count_pairs(keys, root, jnp.float32(config.threshold)))
    if one == 0:
        return (math.nan, math.nan), 0.0
    share = both / one
    return (share, math.sqrt(max(share * (1 - share), 1 / one) / one)), one / (2 * count * BATCH)


@eqx.filter_jit
def _count_pairs(keys: PRNGKeyArray, root, threshold):
    """Breaking points of both kinds, and twice the breaking pairs."""

    def batch(key):
        draws = jax.random.normal(key, (BATCH, 6), jnp.float32) @ root.T
        breaks = jacobian(draws.reshape(BATCH, 2, 3)) < threshold
        return jnp.sum(breaks), 2 * jnp.sum(breaks[:, 0] & breaks[:, 1])

    return jax.lax.map(batch, keys)


def _strips(
    config: schema.RepetitionConfig, cascades: dict[str, jo.surface.Cascade]
) -> dict[str, Float[np.ndarray, "y x"]]:
    """Height [m] on a long strip, of one realised sea of the fewest patterns and one of the paper's."""
    spectrum = _build.spectrum(config.spectrum, _build.wind(config.wind))
    step = config.strip / 1350
    x, y = np.arange(0.0, config.strip, step), np.arange(0.0, config.strip / 16, step)
    strips = {}
    for name in (f"n = {config.patterns[0]}", "paper"):
        sea = jo.surface.realise(spectrum, cascades[name], key=jax.random.key(config.seed))
        heights = np.asarray(sea.fields(0.0).height)
        n = sea.cascade.resolution
        strips[name] = np.sum(
            [
                height[np.ix_(*(np.floor(along / size * n).astype(int) % n for along in (y, x)))]
                for height, size in zip(heights, sea.cascade.sizes, strict=True)
            ],
            axis=0,
        )
    return strips
