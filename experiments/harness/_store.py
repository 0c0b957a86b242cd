"""Finished runs: found again by what decides their outcome, written as a whole or not at all."""

import hashlib
import json
import os
import re
import shutil
import socket
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import uuid4

import yaml

from ._errors import UserError
from ._loading import Loaded
from ._version import version

PARTIAL = re.compile(r"^\.(?P<run>.+)\.(?P<host>[^.]*)\.(?P<pid>\d+)\.[0-9a-f]{8}\.(partial|replaced)$")
FINISHED = ("config.yaml", "provenance.json", "result.json", "summary.txt")
"""A folder that holds all of these is a finished run."""


def identity(loaded: Loaded) -> str:
    """SHA-256 of everything that decides a run's outcome: experiment, config, input files, version."""
    content = {
        "experiment": loaded.experiment.name,
        "config": loaded.config.identity(),
        "inputs": digests(loaded.config.inputs()),
        "version": version(),
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True)
class FinishedRun:
    """A run that is complete on disk."""

    folder: Path

    def summary(self) -> str:
        """The tables and notes that were shown when it finished."""
        return (self.folder / "summary.txt").read_text(encoding="utf-8")

    def provenance(self) -> dict[str, Any]:
        """Versions, commit, seed, device, hash, date and duration."""
        return json.loads((self.folder / "provenance.json").read_text(encoding="utf-8"))

    def files(self) -> list[str]:
        """Names of its files, sorted."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*") if path.is_file())

    def contents(self) -> list[str]:
        """Names of its files and folders, sorted; a folder with how many files it holds."""

        def called(path: Path) -> str:
            if path.is_file():
                return path.name
            return f"{path.name}/ ({sum(inside.is_file() for inside in path.rglob('*'))} files)"

        return [called(path) for path in sorted(self.folder.iterdir())]


def run_folder(loaded: Loaded, digest: str) -> Path:
    """`<output>/<config>-<hash8>`."""
    name = re.sub(r"[^\w-]+", "_", loaded.name).strip("_") or loaded.experiment.name
    return Path(loaded.config.output).expanduser() / f"{name}-{digest[:8]}"


def find(folder: Path) -> FinishedRun | None:
    """The finished run in `folder`, or None."""
    complete = all((folder / name).is_file() for name in FINISHED)
    return FinishedRun(folder) if complete else None


class RunWriter:
    """A run being written, in a hidden sibling of its final folder; use it as a context manager.

    Leaving the context without `finish` removes everything but `unfinished`, the hidden folder where a long run may
    keep parts for the next run of the same config. A process that is killed leaves its own hidden folder to the next
    run, which removes it.
    """

    def __init__(self, target: Path) -> None:
        self.target = target
        self._mark = f"{socket.gethostname().replace('.', '_')}.{os.getpid()}.{uuid4().hex[:8]}"
        self.folder = target.parent / f".{target.name}.{self._mark}.partial"
        self.unfinished = target.parent / f".{target.name}.unfinished"

    def __enter__(self) -> "RunWriter":
        parent = self.target.parent
        try:
            parent.mkdir(parents=True, exist_ok=True)
            remove_stale(parent)
            self.folder.mkdir()
        except OSError as error:
            raise UserError(
                f"The output folder {parent} cannot be written ({error.strerror or error}): "
                "choose another with --output."
            ) from error
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)
        # One that holds nothing is of no use to the next run.
        with suppress(OSError):
            self.unfinished.rmdir()

    def write_json(self, name: str, content: Mapping[str, Any]) -> None:
        """Write `content` as JSON."""
        self.write_text(name, json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n")

    def write_yaml(self, name: str, content: Mapping[str, Any]) -> None:
        """Write `content` as YAML, in its own order."""
        self.write_text(name, yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True))

    def write_text(self, name: str, content: str) -> None:
        """Write a text file in UTF-8."""
        (self.folder / name).write_text(content, encoding="utf-8")

    def finish(self) -> FinishedRun:
        """Flush everything to disk and move it to its final place, replacing what is there."""
        missing = [name for name in FINISHED if not (self.folder / name).is_file()]
        if missing:
            raise RuntimeError(f"A run cannot finish without {', '.join(missing)}.")
        for path in (*self.folder.rglob("*"), self.folder):
            _flush(path)
        replaced = self.folder.with_name(f".{self.target.name}.{self._mark}.replaced")
        if self.target.exists():
            os.replace(self.target, replaced)
        os.replace(self.folder, self.target)
        _flush(self.target.parent)
        shutil.rmtree(replaced, ignore_errors=True)
        self.forget()
        return FinishedRun(self.target)

    def forget(self) -> None:
        """Remove what an interrupted run has kept."""
        shutil.rmtree(self.unfinished, ignore_errors=True)


def remove_stale(parent: Path) -> None:
    """Remove hidden folders that dead processes of this machine left behind."""
    host = socket.gethostname().replace(".", "_")
    for path in parent.iterdir():
        match = PARTIAL.match(path.name)
        if not match or match["host"] != host or _alive(int(match["pid"])):
            continue
        target = parent / match["run"]
        if match[4] == "replaced" and not target.exists():
            # It died between the two moves of `finish`: the earlier run is still good.
            os.replace(path, target)
        else:
            shutil.rmtree(path, ignore_errors=True)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _flush(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def digests(names: Iterable[str]) -> dict[str, str | None]:
    """SHA-256 of the contents of files or folders, by name; None where there is nothing."""
    return {name: _digest(Path(name)) for name in names}


def _digest(path: Path) -> str | None:
    """SHA-256 of a file, or of a folder's files; None where there is nothing."""
    if path.is_dir():
        parts = [f"{child.name}:{_digest(child)}" for child in sorted(path.iterdir()) if child.is_file()]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()
    if not path.is_file():
        return None
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
