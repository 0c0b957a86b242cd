"""What the README shows, works."""

import re
import warnings
from pathlib import Path

import pytest

README = Path(__file__).parents[1] / "README.md"


@pytest.mark.parametrize("number", [0, 1])
def test_python_of_the_readme_runs(number):
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    with warnings.catch_warnings():
        exec(compile(blocks[number], f"README, block {number}", "exec"), {})
