"""JAX as the command line wants it: compiled programs are kept between runs."""

import hashlib
import os
import platform
import tempfile
from importlib import metadata
from pathlib import Path

VARIABLE = "JAXOCEAN_CACHE"
"""Environment variable: a folder for compiled programs, or "off"."""


def cache_folder() -> Path | None:
    """Where compiled programs are kept, one folder per jaxlib version and CPU; None if switched off."""
    chosen = os.environ.get(VARIABLE, "").strip()
    if chosen.lower() in ("off", "0", "no", "false"):
        return None
    if chosen:
        base = Path(chosen).expanduser()
    elif platform.system() == "Darwin":
        base = Path.home() / "Library" / "Caches" / "jaxocean"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "jaxocean"
    return base / f"jaxlib-{metadata.version('jaxlib')}-{_cpu()}"


def keep_compiled_programs() -> None:
    """Switch JAX's persistent compilation cache on if it can be written; the user's own setting wins."""
    if os.environ.get("JAX_COMPILATION_CACHE_DIR"):
        return
    folder = cache_folder()
    if folder is None or not _writable(folder):
        return
    import jax

    jax.config.update("jax_compilation_cache_dir", str(folder))
    # Many small programs cost more than a few large ones: keep them all.
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
    # A broken entry is compiled again, not an error.
    jax.config.update("jax_raise_persistent_cache_errors", False)


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except (OSError, RuntimeError):
        return False


def _cpu() -> str:
    """A short name for this CPU's instruction sets: programs compiled for one may crash on another."""
    description = platform.machine() + platform.processor()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        features = [line for line in lines if line.startswith(("flags", "Features", "model name"))]
        description += "".join(sorted(set(features)))
    except OSError:
        pass
    return f"{platform.machine()}-{hashlib.sha256(description.encode()).hexdigest()[:8]}"
