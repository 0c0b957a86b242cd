"""Where real data lie, if they are there."""

import os
from pathlib import Path

DATA_VARIABLE = "JAXOCEAN_DATA"


def data_folder() -> Path:
    """The folder of measurements: that of the environment variable, else `../shared/data`."""
    return Path(os.environ.get(DATA_VARIABLE, "../shared/data"))
