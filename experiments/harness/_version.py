"""The version of jaxocean, found without importing it."""

import tomllib
from importlib import metadata
from pathlib import Path


def version() -> str:
    """The installed version, or that of the checkout this file stands in."""
    try:
        return metadata.version("jaxocean")
    except metadata.PackageNotFoundError:
        project = Path(__file__).resolve().parents[2] / "pyproject.toml"
        return tomllib.loads(project.read_text())["project"]["version"] if project.is_file() else "unknown"
