"""What a number that an experiment hands out is: its unit and its name, as CF wants them."""

import re
from dataclasses import dataclass

CONVENTIONS = "CF-1.11"
"""What our files follow."""

UNDEFINED = "NaN where it is undefined"
"""What data files say of a number that need not be one."""


@dataclass(frozen=True)
class Quantity:
    """One number of a result.

    **Arguments:** `units`: as UDUNITS writes them ("m", "rad m-1", "1"); `long_name`: one line;
    `standard_name`: CF's name, where there is one; `may_be_undefined`: whether NaN is an answer, not a failure.
    """

    units: str
    long_name: str
    standard_name: str | None = None
    may_be_undefined: bool = False

    def attributes(self) -> dict[str, str]:
        """The CF attributes of a variable that holds it."""
        known = {"units": self.units, "long_name": self.long_name}
        if self.standard_name is not None:
            known["standard_name"] = self.standard_name
        return known | ({"comment": UNDEFINED} if self.may_be_undefined else {})


def udunits(unit: str) -> str:
    """A unit of a config ("rad/m", "m^-2", "-") as UDUNITS writes it ("rad m-1", "m-2", "1")."""
    if unit in ("", "-"):
        return "1"
    above, *below = unit.split("/")
    parts = [above.replace("^", ""), *(f"{part.replace('^', '')}-1" for part in below)]
    return " ".join(parts)


def shown(unit: str) -> str:
    """A unit of UDUNITS ("rad m-1", "1") as tables and axes have it ("rad/m", "-")."""
    if unit in ("", "1"):
        return "-"
    if unit == "percent":
        return "%"
    above, *rest = re.sub(r"(?<=[A-Za-z])(?=-?\d)", "^", unit).split(" ")
    return above + "".join(f"/{part[:-3]}" if part.endswith("^-1") else f" {part}" for part in rest)


SUFFIXES = {
    "_m_per_s": "m s-1",
    "_rad_per_m": "rad m-1",
    "_m": "m",
    "_s": "s",
    "_hz": "Hz",
    "_rad": "rad",
    "_percent": "percent",
}
"""How the names of numbers in `result.json` tell their units; a name without one is a pure number."""


def unit_of_name(name: str) -> str:
    """The unit that the name of a result tells, "1" where it tells none."""
    lowered = re.sub(r"\W+", "_", name).lower()
    found = (unit for suffix, unit in SUFFIXES.items() if lowered.endswith(suffix))
    return next(found, "1")
