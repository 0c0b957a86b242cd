"""What an experiment leaves on disk besides its result: pictures and data."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

# No display, whatever the environment says; before pyplot is imported anywhere.
matplotlib.use("Agg")

import matplotlib.pyplot as plt
import xarray as xr
from matplotlib.figure import Figure

from ._loading import Loaded
from ._quantity import CONVENTIONS
from ._version import version


class Files:
    """The `store` that an experiment's `run` is given.

    **Arguments:** `folder`: where the run is being written; `loaded`: its config, named in every data file;
    `unfinished`: where `unfinished` keeps things, inside of `folder` unless said.
    """

    def __init__(self, folder: Path, loaded: Loaded, unfinished: Path | None = None) -> None:
        self.folder = folder
        self._loaded = loaded
        self._unfinished = unfinished or folder / "unfinished"

    def unfinished(self) -> Path:
        """A folder that an interrupted run leaves to the next run of the same config; a finished one removes it."""
        self._unfinished.mkdir(parents=True, exist_ok=True)
        return self._unfinished

    def picture(self, name: str, figure: Figure) -> None:
        """Save a figure as `<name>.png` and close it."""
        figure.savefig(self.folder / f"{name}.png", metadata={"Software": f"jaxocean {version()}"})
        plt.close(figure)

    def text(self, name: str, content: str) -> None:
        """Save a text, such as `report.md`, under its full name."""
        (self.folder / name).write_text(content.rstrip("\n") + "\n", encoding="utf-8")

    def data(
        self,
        name: str,
        variables: Mapping[str, xr.Variable],
        coordinates: Mapping[str, xr.Variable] | None = None,
        *,
        title: str,
        attributes: Mapping[str, Any] | None = None,
    ) -> None:
        """Save variables made by `variable` as CF netCDF `<name>.nc`.

        **Arguments:** `variables`, `coordinates`: by name; `title`: of the data set; `attributes`: what the
        numbers also depend on (the band, the area measure, the spectral tail), as global attributes.
        """
        dataset = xr.Dataset(dict(variables), dict(coordinates or {}))
        dataset.attrs = {
            "Conventions": CONVENTIONS,
            "title": title,
            "source": f"jaxocean {version()}, experiment {self._loaded.experiment.name}",
            "history": f"written by jaxocean run {self._loaded.name}",
            **(attributes or {}),
        }
        # _FillValue is said once here: CF forbids it on coordinates.
        encoding = {str(c): {"_FillValue": None} for c in dataset.coords}
        encoding |= {
            str(v): {"zlib": True, "complevel": 4} for v in dataset.data_vars if dataset[v].size > 4096
        }
        dataset.to_netcdf(self.folder / f"{name}.nc", engine="netcdf4", format="NETCDF4", encoding=encoding)


def variable(
    dimensions: str | tuple[str, ...],
    values: Any,
    *,
    units: str,
    long_name: str,
    standard_name: str | None = None,
    **attributes: Any,
) -> xr.Variable:
    """One variable with CF attributes; `units` as UDUNITS writes them ("m", "rad m-1", "1").

    **Returns:** an `xarray.Variable`.
    """
    if dimensions == "":
        dimensions = ()
    known = {"units": units, "long_name": long_name}
    if standard_name is not None:
        known["standard_name"] = standard_name
    return xr.Variable(dimensions, values, {**known, **attributes})
