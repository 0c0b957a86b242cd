"""A strict session: float64, strict promotion, warnings as errors, shapes and types checked at every call."""

import gc
import os
from pathlib import Path

from _compiler import QUICK

os.environ.setdefault("JAX_PLATFORMS", "cpu")

# XLA_FLAGS=--xla_cpu_use_fusion_emitters=true tests what users run, as most commands do that tests start.
os.environ.setdefault("XLA_FLAGS", QUICK)

import jax
import pytest
from jaxtyping import install_import_hook

# The compiler reads its flags once; commands that tests start shall not inherit ours.
jax.block_until_ready(jax.numpy.zeros(()) + 1)
if os.environ["XLA_FLAGS"] == QUICK:
    del os.environ["XLA_FLAGS"]

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_numpy_dtype_promotion", "strict")
install_import_hook(["jaxocean", "fitting"], "beartype.beartype")

# What is traced stays: to look for cycles in it after every 700 objects takes a quarter of the time of tracing.
gc.set_threshold(100_000, 20, 20)


MOST_MAPS = 20_000
"""Linux gives a process 65,530 memory maps by default; a compiled program takes a few, and the compiler crashes without
a word when there are none left."""


@pytest.fixture(autouse=True, scope="module")
def _room_for_programs():
    """Forget compiled programs when a worker has gathered very many."""
    yield
    maps = Path("/proc/self/maps")
    if maps.exists() and maps.read_text().count("\n") > MOST_MAPS:
        jax.clear_caches()
