"""A strict session: float64, strict promotion, warnings as errors, shapes and types checked at every call."""

import os

os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax
from jaxtyping import install_import_hook

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_numpy_dtype_promotion", "strict")
install_import_hook(["jaxocean", "fitting"], "beartype.beartype")
