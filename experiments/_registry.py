"""Every experiment: its name, its config, and where its `run` lives (imported only when it runs)."""

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from . import schema
from .harness._errors import UserError, nearest
from .harness._result import Result


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    **Arguments:**

    - `name`: the value of the key `experiment` in its configs.
    - `summary`: one line for `jaxocean list`.
    - `config`: its config class, from `experiments.schema` (no JAX there).
    - `module`: the module with `run(config, progress, store) -> Result`; the only place that may import JAX.
    """

    name: str
    summary: str
    config: type[schema.ExperimentConfig]
    module: str

    def load(self) -> Callable[..., Result]:
        """Import the experiment's module, and with it JAX, and return its `run`."""
        return importlib.import_module(self.module).run


EXPERIMENTS = (
    Experiment(
        "calibrate_monahan",
        "the breaking threshold and choppiness for which a sea obeys a whitecap law",
        schema.CalibrationConfig,
        "experiments.calibration.calibrate_monahan",
    ),
    Experiment(
        "spectrum",
        "a sea state: its spectrum, Hs, Tp, slopes per band, and one realisation",
        schema.SeaStateConfig,
        "experiments.seas.spectrum",
    ),
    Experiment(
        "render",
        "a picture of a sea with correctly filtered whitecaps, and the layers that it is made of",
        schema.RenderConfig,
        "experiments.pictures.render",
    ),
    Experiment(
        "animate",
        "a sequence of pictures along a camera path, as PNG, GIF and MP4, and how much it flickers",
        schema.AnimateConfig,
        "experiments.pictures.animate",
    ),
    Experiment(
        "flyover",
        "the camera climbs from metres to kilometres: time per frame against footprint, and whitecaps seen",
        schema.FlyoverConfig,
        "experiments.pictures.flyover",
    ),
    Experiment(
        "picture_recovery",
        "wind, choppiness, threshold, sun and exposure of seas, found again in pictures of them",
        schema.PictureRecoveryConfig,
        "experiments.pictures.picture_recovery",
    ),
    Experiment(
        "wave_recovery",
        "the waves of a small patch from pictures of it, every random number free, with maps of the error",
        schema.WaveRecoveryConfig,
        "experiments.pictures.wave_recovery",
    ),
    Experiment(
        "joint_targets",
        "what a whitecap law, slopes and a picture say of ε and λ: errors, correlation, profile",
        schema.JointTargetsConfig,
        "experiments.pictures.joint_targets",
    ),
    Experiment(
        "fit_image",
        "the wind and the light from one photograph of the sea, with an interval and a filmstrip",
        schema.FitImageConfig,
        "experiments.pictures.fit_image",
    ),
    Experiment(
        "unknown_seas",
        "winds from pictures of seas whose waves are not known, and whether their intervals hold",
        schema.UnknownSeasConfig,
        "experiments.pictures.unknown_seas",
    ),
    Experiment(
        "buoy_photographs",
        "winds from photographs of buoys, beside what they measured and what needs no model",
        schema.BuoyPhotographsConfig,
        "experiments.pictures.buoy_photographs",
    ),
    Experiment(
        "coverage",
        "whitecap coverage of one sea in closed form: the plain thing to sweep",
        schema.CoverageConfig,
        "experiments.closures.coverage",
    ),
    Experiment(
        "measured_sea",
        "whitecap coverage predicted from measured directional spectra, per record",
        schema.MeasuredSeaConfig,
        "experiments.records.measured_sea",
    ),
    Experiment(
        "sea_states",
        "whitecaps at one wind: against swell from any side, and against the age of the wind sea",
        schema.SeaStatesConfig,
        "experiments.seas.sea_states",
    ),
    Experiment(
        "ship_records",
        "wind sea and swell from what ships report, and their whitecaps beside empirical laws",
        schema.ShipRecordsConfig,
        "experiments.records.ship_records",
    ),
    Experiment(
        "gaussian_vs_monte_carlo",
        "is the Jacobian Gaussian? coverage by three closures, by Monte Carlo and by FFT seas",
        schema.GaussianVsMonteCarloConfig,
        "experiments.closures.gaussian_vs_monte_carlo",
    ),
    Experiment(
        "footprint_bias",
        "how wrong closures are in footprints of every size, and how normal the sea is inside them",
        schema.FootprintBiasConfig,
        "experiments.footprints.footprint_bias",
    ),
    Experiment(
        "calibration_uncertainty",
        "can the errors of a calibration be trusted? posterior, profile likelihood, coverage probability",
        schema.UncertaintyConfig,
        "experiments.calibration.calibration_uncertainty",
    ),
    Experiment(
        "law_ensemble",
        "one sea calibrated to every whitecap law: the spread of ε and the band of W(U10)",
        schema.LawEnsembleConfig,
        "experiments.calibration.law_ensemble",
    ),
    Experiment(
        "foam_in_time",
        "foam that outlives breaking: active and total coverage on a world tile and without, the decay time",
        schema.FoamInTimeConfig,
        "experiments.foam.foam_in_time",
    ),
    Experiment(
        "dupuy_scenes",
        "the paper's own scenes: coverage by its equations, its program, exactly, and counted",
        schema.DupuyScenesConfig,
        "experiments.patterns.dupuy_scenes",
    ),
    Experiment(
        "repetition",
        "how many patterns a sea needs, lest it repeat visibly: autocorrelation over kilometres, and period",
        schema.RepetitionConfig,
        "experiments.patterns.repetition",
    ),
)


def find(name: str, experiments: Sequence[Experiment] = EXPERIMENTS) -> Experiment:
    """The experiment of that name, or an error that names the nearest one."""
    for experiment in experiments:
        if experiment.name == name:
            return experiment
    names = [experiment.name for experiment in experiments]
    near = nearest(name, names)
    hint = f"did you mean `{near}`?" if near else f"the experiments are {', '.join(names)}."
    raise UserError(f"There is no experiment `{name}`: {hint}")
