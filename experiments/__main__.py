"""The command line: `jaxocean run | sweep | list | show`. Nothing here imports JAX until something runs."""

import atexit
import gc
import logging
import signal
import sys
from typing import Annotated, Any

import typer
from rich.console import Console

from .harness._errors import Interrupted, UserError
from .harness._version import version

app = typer.Typer(
    name="jaxocean",
    help="A differentiable ocean: from the wind to whitecaps, and back.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Config = Annotated[
    str, typer.Argument(metavar="CONFIG", help="A name from `jaxocean list`, or a path to a YAML file.")
]
Overrides = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[KEY.PATH=VALUE]...", help="Changes, for example wind.speed=12 choppiness=[1,1,0.8,0.8]."
    ),
]


def _version(wanted: bool) -> None:
    if wanted:
        print(f"jaxocean {version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    del version


@app.command()
def run(
    config: Config,
    overrides: Overrides = None,
    force: Annotated[bool, typer.Option("--force", help="Repeat a run that is already finished.")] = False,
    output: Annotated[
        str | None, typer.Option("--output", metavar="DIR", help="Folder for runs; runs unless said.")
    ] = None,
) -> None:
    """Run an experiment, or find its finished run again."""
    from .harness._cache import keep_compiled_programs
    from .harness._execute import execute, find_finished, interrupted
    from .harness._loading import load
    from .harness._progress import bars

    loaded = load(config, overrides or [], output=output)
    found = None if force else find_finished(loaded)
    finished = found
    if finished is None:
        # Libraries that set up logging make JAX chat about accelerators that are not there.
        logging.getLogger("jax").setLevel(logging.WARNING)
        keep_compiled_programs()
        try:
            with bars(Console(stderr=True)) as progress:
                finished = execute(loaded, progress, anew=force)
        except KeyboardInterrupt:
            raise interrupted(loaded) from None
    sys.stdout.write(finished.summary())
    origin = finished.provenance()
    if found:
        print(f"\nFound again, finished {origin['date']} (--force repeats it): {finished.folder}")
    else:
        print(f"\nFinished in {origin['duration_s']:.1f} s: {finished.folder}")
    print("  " + "  ".join(finished.contents()))


@app.command()
def sweep(
    config: Config,
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="KEY.PATH=VALUES...",
            help="What is swept: wind.speed=4:24:2 (with its end), threshold=0.2,0.4 (lists and names too), "
            "or wind.speed=4:24 with --design; one value alone is a plain change.",
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", "-j", min=1, help="Processes; one per core unless said.")
    ] = None,
    zipped: Annotated[
        bool, typer.Option("--zip", help="Take the values side by side instead of every combination.")
    ] = False,
    design: Annotated[
        str | None, typer.Option("--design", metavar="sobol|random", help="Draw points from intervals.")
    ] = None,
    points: Annotated[int | None, typer.Option("--points", help="How many points to draw.")] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Compute on this dask.distributed cluster."),
    ] = None,
    output: Annotated[
        str | None, typer.Option("--output", metavar="DIR", help="Folder for sweeps; runs unless said.")
    ] = None,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Compute points that failed again.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Throw away what is there and start anew.")] = False,
) -> None:
    """Run an experiment at many points, or go on where an earlier command stopped."""
    from ._sweep_command import sweep_command

    sweep_command(
        config,
        values or [],
        workers=workers,
        zipped=zipped,
        design=design,
        points=points,
        scheduler=scheduler,
        output=output,
        retry_failed=retry_failed,
        force=force,
    )


@app.command("list")
def list_() -> None:
    """List the configs that can be run, and the experiments behind them."""
    from ._show import configs_table

    _print(configs_table())


@app.command()
def show(config: Config, overrides: Overrides = None) -> None:
    """Show every key of a config with its value, unit, default, range and meaning."""
    from ._show import keys_table
    from .harness._loading import load

    _print(keys_table(load(config, overrides or [])))


def _print(table: Any) -> None:
    """To a terminal in its width; to a file or pipe wide enough for one line per key."""
    console = Console()
    if not console.is_terminal:
        console = Console(width=250)
    console.print(table)


def main() -> None:
    """Entry point: exit code 0, or 2 with one sentence, or 130 after Ctrl-C."""
    # A terminated run cleans up like an interrupted one.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    # A traced program is millions of small objects that stay to the end: look for garbage seldom, and not on the
    # way out (it takes a second of every run).
    gc.set_threshold(100_000, 20, 20)
    atexit.register(gc.freeze)
    try:
        app(prog_name="jaxocean")
    except UserError as error:
        print(f"Error: {error}", file=sys.stderr)
        sys.exit(2)
    except Interrupted as interrupt:
        print(interrupt, file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
