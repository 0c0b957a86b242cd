"""Where compiled programs are kept."""

import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

import experiments
from experiments.harness._cache import cache_folder

PROGRAM = """
import jax
from experiments.harness._cache import keep_compiled_programs
keep_compiled_programs()
print(jax.config.jax_compilation_cache_dir)
jax.jit(lambda x: x + 1)(1.0).block_until_ready()
"""


def compile_with(**environment: str) -> str:
    """The cache folder that a fresh process uses, after it has compiled something."""
    inherited = {
        k: v for k, v in os.environ.items() if k not in ("JAXOCEAN_CACHE", "JAX_COMPILATION_CACHE_DIR")
    }
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", PROGRAM],
        env={**inherited, "PYTHONPATH": str(Path(experiments.__file__).parents[1]), **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    return done.stdout.strip()


def test_the_folder_is_keyed_by_jaxlib_and_processor(tmp_path, monkeypatch):
    monkeypatch.setenv("JAXOCEAN_CACHE", str(tmp_path))
    folder = cache_folder()
    assert folder is not None
    assert folder.parent == tmp_path
    assert metadata.version("jaxlib") in folder.name
    monkeypatch.setattr("experiments.harness._cache._cpu", lambda: "another")
    assert cache_folder() != folder


@pytest.mark.parametrize("word", ["off", "0", "OFF"])
def test_it_can_be_switched_off(monkeypatch, word):
    monkeypatch.setenv("JAXOCEAN_CACHE", word)
    assert cache_folder() is None


def test_compiled_programs_are_kept_in_the_folder(tmp_path):
    used = compile_with(JAXOCEAN_CACHE=str(tmp_path))
    assert Path(used).parent == tmp_path
    assert list(Path(used).iterdir())


def test_a_folder_that_cannot_be_written_is_done_without(tmp_path):
    (tmp_path / "file").write_text("no folder")
    assert compile_with(JAXOCEAN_CACHE=str(tmp_path / "file")) == "None"


def test_the_users_own_setting_wins(tmp_path):
    own = tmp_path / "own"
    used = compile_with(JAXOCEAN_CACHE=str(tmp_path / "ours"), JAX_COMPILATION_CACHE_DIR=str(own))
    assert used == str(own)
    assert not (tmp_path / "ours").exists()
