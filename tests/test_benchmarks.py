import os
import subprocess
import sys
from pathlib import Path

import pytest
from _compiler import QUICK

from benchmarks.__main__ import BENCHMARKS


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(BENCHMARKS))
def test_each_benchmark_prints_its_table(name):
    command = [sys.executable, "-m", "benchmarks", name, "--quick"]
    environment = {"XLA_FLAGS": QUICK, **os.environ}
    run = subprocess.run(
        command, cwd=Path(__file__).parents[1], env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    # Times decide nothing here; but a table without numbers says that a contestant did not run.
    numbers = [line for line in run.stdout.splitlines() if any(c.isdigit() for c in line)]
    assert len(numbers) >= 4
    assert "nan" not in run.stdout.split()
