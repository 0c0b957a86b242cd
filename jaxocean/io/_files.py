"""Files that exist, and files that appear whole."""

import os
from collections.abc import Callable
from pathlib import Path


def existing(path: str | os.PathLike) -> Path:
    """The path, if there is a file."""
    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"There is no image `{source}`.")
    return source


def written_whole(target: Path, write: Callable[[Path], None]) -> Path:
    """Write to a file beside the target and put it in its place when it is complete."""
    partial = target.with_name(f".{target.stem}.{os.getpid()}.partial{target.suffix}")
    try:
        write(partial)
        os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)
    return target
