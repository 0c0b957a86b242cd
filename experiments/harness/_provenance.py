"""Where a result comes from: versions, commit, seed, device, hash, date, duration."""

import platform
import subprocess
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from ._loading import Loaded
from ._version import version

PACKAGES = (
    "jax",
    "jaxlib",
    "equinox",
    "optimistix",
    "lineax",
    "numpy",
    "xarray",
    "netCDF4",
    "matplotlib",
    "pydantic",
    "wavespectra",
)


def provenance(loaded: Loaded, digest: str, duration: float) -> dict[str, Any]:
    """The content of `provenance.json`; imports JAX to name the device."""
    import jax

    return {
        "experiment": loaded.experiment.name,
        "config": loaded.name,
        "hash": digest,
        "seed": loaded.config.seed,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "duration_s": round(duration, 3),
        "device": ", ".join(f"{device.platform}: {device.device_kind}" for device in jax.devices()),
        "machine": f"{platform.system()} {platform.machine()}",
        "commit": commit(),
        "versions": {"jaxocean": version(), "python": platform.python_version(), **_versions()},
    }


def commit() -> str | None:
    """The git commit of the checkout (with `-dirty` if files differ), or None outside of one."""
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return None
    try:
        described = subprocess.run(
            ["git", "-C", str(root), "describe", "--always", "--abbrev=40", "--dirty", "--exclude=*"],
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return described.stdout.strip() or None


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found
