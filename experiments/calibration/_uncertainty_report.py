"""What `calibration_uncertainty` says: tables, sentences, and the numbers for `result.json`."""

import numpy as np

import fitting

from ..common import _build, _calibrated_sea, _markdown
from ..harness._files import Files
from ..harness._result import Result, Table
from ._uncertainty_views import METHODS, SYMBOLS, View

TITLE = "Can the errors of a calibration be trusted?"

TOLERATED = 0.05
"""How far the share of intervals that contain the truth may lie from their level."""


def report(store: Files, view: View) -> Result:
    """Result, tables, and `report.md`."""
    tables = (_laplace_table(view), _interval_table(view), _hit_table(view))
    answer = [*_posterior_words(view), _profile_words(view), _hit_words(view)]
    warnings = _warnings(view)
    config = view.config
    speeds = config.wind.speed
    setting = (
        f"{_build.law(config.law).name} at {len(speeds)} winds from {speeds[0]:g} to {speeds[-1]:g} m/s, "
        f"σ = {config.scatter:g} of log10 W; {_calibrated_sea.named(config)}; "
        f"{config.chains} chains of {config.draws} draws"
    )
    text = _markdown.page(
        TITLE, [*answer, *warnings], tables, picture="calibration_uncertainty", setting=setting
    )
    store.text("report.md", text)
    notes = (*answer, *warnings, *_calibrated_sea.limits(config))
    return Result(values=_values(view), tables=tables, notes=tuple(dict.fromkeys(notes)))


def _posterior_words(view: View) -> list[str]:
    texts = []
    for kind in ("prior", "scatter", "weak"):
        posterior = view.posteriors[kind]
        ratios = ", ".join(f"{SYMBOLS[check.label]} {check.ratio:.2f}" for check in posterior.laplace())
        fit, drawn = posterior.fit.correlations[0, 1], posterior.correlations[0, 1]
        texts.append(
            f"With {view.names[kind]}: the deviation of the draws over the error of the fit is {ratios}; the "
            f"correlation of ε and λ is {drawn:.3f} (fit: {fit:.3f}). {posterior.verdict()}"
        )
    return texts


def _profile_words(view: View) -> str:
    parts = []
    for kind, each in view.profiles.items():
        found = "; ".join(
            profile.interval(view.config.level).words(SYMBOLS[name]) for name, profile in each.items()
        )
        parts.append(f"with {view.names[kind]}: {found}")
    return f"Profile likelihood, {'. '.join(parts)}."


def _hit_words(view: View) -> str:
    repeated, level = view.repeated, view.config.level
    shares = {(m, n): repeated.share(m, n, level) for m in ("laplace", "profile") for n in repeated.labels}
    kept = all(abs(share.value - level) <= TOLERATED + 1e-9 for share in shares.values())
    listed = "; ".join(
        f"{METHODS[method]}: "
        + ", ".join(f"{SYMBOLS[n]} {_hits(shares[method, n])}" for n in repeated.labels)
        for method in ("laplace", "profile")
    )
    return (
        f"The {100 * level:g} % intervals {'keep' if kept else 'do NOT keep'} their promise, within "
        f"{100 * TOLERATED:g} points. They contain the truth in so many of the synthetic data sets: {listed}."
        f"{_hundreds(view)}{_sampled(view)} In each data set λ has a truth of its own, drawn from its prior, and ε is "
        "the calibrated one: an interval that leans on a prior keeps its promise over the worlds that the prior "
        "describes, and over no others."
    )


def _hits(share: fitting.Share) -> str:
    return f"{share.hits} of {share.total}"


def _hundreds(view: View) -> str:
    """The counts in each hundred data sets, where there are several hundreds."""
    repeated = view.repeated
    count = int(repeated.converged.sum()) // 100
    if count < 2:
        return ""
    inside = np.concatenate(
        [
            repeated.probability(method)[: 100 * count] <= view.config.level
            for method in ("laplace", "profile")
        ],
        axis=1,
    )
    hits = inside.reshape(count, 100, -1).sum(axis=1)
    return f" In each hundred of them it is between {hits.min()} and {hits.max()}."


def _sampled(view: View) -> str:
    """Posterior intervals, beside those of the fits of the same few data sets."""
    repeated, level, count = view.repeated, view.config.level, len(view.repeated.ranks)
    if not count:
        return ""
    pairs = [
        f"{SYMBOLS[n]} {repeated.share('posterior', n, level).hits} "
        f"(fit ± error: {repeated.share('laplace', n, level, count).hits})"
        for n in repeated.labels
    ]
    listed = ", ".join(pairs)
    return (
        f" Of the first {count}, whose posterior was drawn too, its intervals contain the truth of {listed}."
    )


def _warnings(view: View) -> list[str]:
    texts = []
    for kind, posterior in view.posteriors.items():
        texts += [f"With {view.names[kind]}: {text}" for text in posterior.warnings]
    for kind, each in view.profiles.items():
        for profile in each.values():
            texts += [f"Profile with {view.names[kind]}: {text}" for text in profile.warnings]
    return [*texts, *view.repeated.warnings]


def _laplace_table(view: View) -> Table:
    rows = []
    for kind in ("prior", "scatter", "weak"):
        posterior = view.posteriors[kind]
        for i, check in enumerate(posterior.laplace()):
            rows.append(
                (
                    view.names[kind],
                    SYMBOLS[check.label],
                    f"{check.value:.3f} ± {check.error:.3f}",
                    f"{check.mean:.3f} ± {check.deviation:.3f}",
                    f"{check.ratio:.2f}",
                    f"{check.skewness:+.2f}",
                    f"{posterior.r_hat[i]:.3f}",
                    f"{posterior.effective_size[i]:.0f}",
                )
            )
    columns = ("case", "", "fit", "posterior", "ratio", "skew", "R-hat", "draws")
    return Table(
        "The fit's errors beside the posterior's; draws: how many independent ones they are worth",
        columns,
        rows,
    )


def _interval_table(view: View) -> Table:
    level = view.config.level
    rows = []
    for kind, each in view.profiles.items():
        for name, profile in each.items():
            posterior = view.posteriors.get(kind)
            drawn = "-" if posterior is None else _range(*posterior.interval(level)[name])
            fitted = "-" if profile.fit is None else _fitted(profile.fit, name, level)
            rows.append((view.names[kind], SYMBOLS[name], fitted, _open(profile, level), drawn))
    return Table(f"{100 * level:g} % intervals", ("case", "", "fit ± error", "profile", "posterior"), rows)


def _open(profile: fitting.Profile, level: float) -> str:
    found = profile.interval(level)
    lower = "open" if found.lower_is_open else f"{found.lower:.3f}"
    upper = "open" if found.upper_is_open else f"{found.upper:.3f}"
    return f"{lower} to {upper}"


def _fitted(fit: fitting.Fit, name: str, level: float) -> str:
    half = np.sqrt(fitting.profile_limit(level)) * float(fit.errors[name])
    return _range(float(fit.values[name]) - half, float(fit.values[name]) + half)


def _range(lower: float, upper: float) -> str:
    return f"{lower:.3f} to {upper:.3f}"


def _hit_table(view: View) -> Table:
    rows = []
    for method in view.repeated.methods:
        for name in view.repeated.labels:
            share = view.repeated.share(method, name, view.config.level)
            interval = f"{100 * share.lower:.1f} to {100 * share.upper:.1f} %"
            rows.append(
                (
                    METHODS[method],
                    SYMBOLS[name],
                    share.hits,
                    share.total,
                    f"{100 * share.value:.1f} %",
                    interval,
                )
            )
    title = f"Intervals of {100 * view.config.level:g} % that contain the truth, with their 95 % binomial interval"
    return Table(title, ("interval", "", "hits", "data sets", "share", "binomial"), rows)


def _values(view: View) -> dict:
    level, repeated = view.config.level, view.repeated
    return {
        "measure": view.config.measure,
        "breaking_wavenumber_rad_per_m": view.config.breaking_wavenumber,
        "wind_m_per_s": view.config.wind.speed,
        "law": view.config.law,
        "level": level,
        "posteriors": {kind: posterior.as_dict(level) for kind, posterior in view.posteriors.items()},
        "profiles": {
            kind: {name: profile.as_dict(level) for name, profile in each.items()}
            for kind, each in view.profiles.items()
        },
        "coverage_probability": {
            method: {name: repeated.share(method, name, level)._asdict() for name in repeated.labels}
            for method in repeated.methods
        },
        "data_sets": int(repeated.converged.sum()),
    }
