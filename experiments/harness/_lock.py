"""One writer for each folder; the system frees the lock of a process that dies."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ._errors import UserError

try:
    import fcntl
except ImportError:  # not a POSIX system: there a second writer is the user's own affair
    fcntl = None


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the folder's lock, a hidden file beside it.

    **Raises:** `UserError` if another process holds it.
    """
    path = folder.parent / f".{folder.name}.lock"
    with path.open("a") as file:
        if fcntl is not None:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                mine = os.fstat(file.fileno()).st_ino == path.stat().st_ino
            except (BlockingIOError, FileNotFoundError):
                mine = False
            if not mine:
                raise UserError(f"Another process is working on {folder}: wait until it has finished.")
        try:
            yield
        finally:
            path.unlink(missing_ok=True)
