"""Run one benchmark by name."""

import argparse
import importlib

BENCHMARKS = {
    "calibrate": "a full fit of a whitecap law against the same fit in NumPy and SciPy",
    "coverage": "foam in pictures against a hard indicator at 256 points of each pixel, from 20 m to 4.6 km",
    "ocean_step": "one frame of the sea against numpy, scipy, pyFFTW and XLA's bare transforms",
    "render": "a picture with new waves in each frame, from 2 m to 5 km, against Mitsuba",
    "silhouettes": "the share of moving silhouettes in the gradient of an image loss, against differences",
    "sweep": "a sweep of closed-form coverage against the bare vmapped closed form",
}
"""Name of a module of this package, which has `run(*, quick)`, and what it measures."""


def main() -> None:
    listing = "\n".join(f"  {name:<12} {what}" for name, what in BENCHMARKS.items())
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=f"Benchmarks:\n{listing}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", choices=sorted(BENCHMARKS))
    parser.add_argument("--quick", action="store_true", help="few rounds: does it run, not how fast")
    arguments = parser.parse_args()
    importlib.import_module(f"benchmarks.{arguments.name}").run(quick=arguments.quick)


if __name__ == "__main__":
    main()
