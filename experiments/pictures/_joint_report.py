"""What `joint_targets` says."""

from collections.abc import Sequence

import numpy as np

import fitting

from .. import schema
from ..common._markdown import page
from ..harness._result import Result, Table
from ._joint_views import LEVEL


def result(config: schema.JointTargetsConfig, objectives: Sequence, picture, scatter: float) -> Result:
    """Errors, correlations and intervals of each objective."""
    del config
    every = [*objectives, picture]
    deviations = [np.sqrt(np.diag(each.told)) for each in every]
    doubted = [np.sqrt(np.diag(each.covariance)) for each in every]
    intervals = [_interval(each.profile) for each in every]
    rows = [
        (
            each.name,
            float(each.values[0]),
            float(own[0]),
            float(each.values[1]),
            float(own[1]),
            f"{each.correlation:+.3f}",
            *(
                ("-", "-")
                if each.doubted is None
                else (f"{whole[0]:.3f}, {whole[1]:.3f}", f"{each.correlation_in_doubt:+.3f}")
            ),
            words,
        )
        for each, own, whole, words in zip(every, deviations, doubted, intervals, strict=True)
    ]
    columns = (
        "objective",
        "ε",
        "± ε",
        "λ",
        "± λ",
        "correlation",
        "± ε and λ with renderers in doubt",
        "correlation with these",
        f"{100 * LEVEL:g} % profile interval of λ",
    )
    values = {
        "objectives": [each.name for each in every],
        "values": [each.values for each in every],
        "errors": deviations,
        "errors_with_renderers_in_doubt": doubted,
        "correlations": [each.correlation for each in every],
        "correlations_with_renderers_in_doubt": [each.correlation_in_doubt for each in every],
        "picture_scatter": scatter,
    }
    return Result(values=values, tables=(Table("ε and λ", columns, rows),))


def _interval(profile: fitting.Profile | None) -> str:
    if profile is None:
        return "-"
    found = profile.interval(LEVEL)
    lower = "open" if found.lower_is_open else f"{found.lower:.3f}"
    upper = "open" if found.upper_is_open else f"{found.upper:.3f}"
    return f"{lower} to {upper}"


def report(config: schema.JointTargetsConfig, objectives: Sequence, picture, result: Result) -> str:
    """One page."""
    law, slopes, joint = objectives
    errors = dict(zip(result.values["objectives"], result.values["errors"], strict=True))
    words = [
        f"A coverage law alone hardly tells ε from λ: their errors have a correlation of {law.correlation:+.2f}, and "
        f"λ is known to ± {errors[law.name][1]:.2g} (a prior of ± {config.prior_deviation:g} holds it). With slopes, "
        f"which tell the spectrum, it is {slopes.correlation:+.2f} and ± {errors[slopes.name][1]:.2g}; with one "
        f"picture as well **{joint.correlation:+.2f} and ± {errors[joint.name][1]:.2g}**.",
        f"The picture alone has {picture.correlation:+.2f} and ± {errors[picture.name][1]:.2g}. It weighs what parts "
        "of the image say when each errs by itself. That is what the picture tells if the renderer is right; how far ε "
        "and λ would move if it were drawn by the other method, or with a single look at each pixel, is in the table, "
        f"and dotted in the figure; with that their errors have a correlation of {joint.correlation_in_doubt:+.2f}.",
    ]
    setting = (
        f"truth U10 = {config.wind.speed:g} m/s, ε = {config.threshold:g}, λ = {config.choppiness:g}, "
        f"Ω = {config.inverse_wave_age:g}; free are ε, λ and Ω, each {100 * config.away:g} % off at first; law and "
        "slopes are those of the truth at "
        f"{len(config.winds.speed)} winds, with scatters of {config.law_scatter:g} in log10 and "
        f"{100 * config.slope_scatter:g} %; the picture is drawn by rays with {config.detail}² times as many pixels; "
        f"its waves' random numbers, its camera and its light are known; seed {config.seed}"
    )
    return page("ε and λ from several targets", words, result.tables, picture="joint", setting=setting)
