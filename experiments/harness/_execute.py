"""One run, from a checked config to a finished folder."""

import time
import traceback
import warnings
from dataclasses import replace
from typing import Any

from ._errors import Interrupted, UserError
from ._loading import Loaded
from ._progress import Reporter, Silent
from ._report import render
from ._result import Result, jsonable
from ._store import FinishedRun, RunWriter, find, identity, run_folder

ROOMS = ("jaxocean", "fitting", "experiments")


def find_finished(loaded: Loaded) -> FinishedRun | None:
    """The finished run of this config, or None; imports no JAX."""
    return find(run_folder(loaded, identity(loaded)))


def interrupted(loaded: Loaded) -> Interrupted:
    """What Ctrl-C leaves of the run of this config."""
    folder = RunWriter(run_folder(loaded, identity(loaded))).unfinished
    if folder.is_dir() and any(folder.iterdir()):
        return Interrupted(
            "Interrupted: finished parts of the run are kept, and the same command goes on from there."
        )
    return Interrupted("Interrupted: nothing was kept of the unfinished run.")


def execute(loaded: Loaded, progress: Reporter | None = None, *, anew: bool = False) -> FinishedRun:
    """Run the experiment and replace an earlier run of the same config.

    **Arguments:** `loaded`: the config; `progress`: who is told what is being done; `anew`: whether to throw away what
    an interrupted run has kept.

    **Returns:** the finished run.

    **Raises:** `UserError` for whatever the user can mend; the output folder is then as it was.
    """
    digest = identity(loaded)
    with RunWriter(run_folder(loaded, digest)) as writer:
        start = time.perf_counter()
        if anew:
            writer.forget()
        try:
            run = loaded.experiment.load()
            # Only now: xarray and matplotlib come with the experiment.
            from ._files import Files
            from ._provenance import provenance

            with warnings.catch_warnings():
                messages = collect_warnings()
                result = run(
                    loaded.config, progress or Silent(), Files(writer.folder, loaded, writer.unfinished)
                )
            result = replace(result, notes=(*result.notes, *dict.fromkeys(messages)))
            _write(writer, result, loaded, provenance(loaded, digest, time.perf_counter() - start))
            return writer.finish()
        except OSError as error:
            raise UserError(
                f"A file could not be read or written, and nothing was kept: {str(error).rstrip('.')}."
            ) from error
        except Exception as error:
            if not is_ours(error):
                raise
            raise UserError(one_line(error)) from error


def _write(writer: RunWriter, result: Result, loaded: Loaded, origin: dict[str, Any]) -> None:
    writer.write_yaml("config.yaml", loaded.config.model_dump(mode="json", exclude={"output"}))
    writer.write_json("provenance.json", origin)
    writer.write_json("result.json", jsonable(result.values))
    writer.write_text("summary.txt", render(result))


def collect_warnings() -> list[str]:
    """Let the rooms' own warnings become notes of the result, even where warnings are errors."""
    notes: list[str] = []

    def keep(message: Warning | str, *_: Any, **__: Any) -> None:
        notes.append(f"Warning: {one_line(message)}")

    def show(message: Any, category: type[Warning], filename: str, lineno: int, *rest: Any) -> None:
        if issubclass(category, UserWarning):
            keep(message)
        else:
            original(message, category, filename, lineno, *rest)

    original = warnings.showwarning
    warnings.showwarning = show
    warnings.filterwarnings("always", category=UserWarning, module=rf"({'|'.join(ROOMS)})(\.|$)")
    return notes


def is_ours(error: Exception) -> bool:
    """Whether a room raised this on purpose: a ValueError from our own code, or an error of fitting's own.

    A plain ImportError is one too: it names the extra to install (a bug raises ModuleNotFoundError).
    """
    if type(error).__module__.partition(".")[0] == "fitting":
        return True
    if not (isinstance(error, ValueError) or type(error) is ImportError):
        return False
    last = list(traceback.walk_tb(error.__traceback__))[-1][0]
    return str(last.f_globals.get("__name__", "")).partition(".")[0] in ROOMS


def one_line(message: object) -> str:
    """A message without line breaks."""
    return " ".join(str(message).split())
