"""What a sweep writes behind a key: lists, ranges and intervals, read and counted without making them long."""

import json
import re
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import YAMLError

from ..harness._errors import UserError

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
RANGE = re.compile(rf"^({NUMBER}):({NUMBER})(?::({NUMBER}))?$")
EXACT = 2**53
"""Whole numbers up to here are exact in double precision."""

LONGEST = 1_000_000
"""Ranges inside a list are written out up to so many values."""


@dataclass(frozen=True)
class Listed:
    """Values one by one: numbers, names, lists or null, as typed."""

    values: tuple[Any, ...]
    spelled: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.values)

    def spell(self, code: int | float) -> str:
        """The value as it would stand on the command line."""
        return self.spelled[int(code)]

    @property
    def numeric(self) -> bool:
        """Whether all values are numbers."""
        return all(is_number(value) for value in self.values)

    def numbers(self, codes: np.ndarray) -> np.ndarray:
        """The values of these codes, if numeric."""
        return np.asarray(self.values, float)[codes]

    def canonical(self) -> Any:
        """The same for all ways of writing these values."""
        return [float(value) if is_number(value) else value for value in self.values]

    def sorted(self) -> "Listed":
        """Numbers in ascending order, whatever is no number as it was."""
        if not self.numeric:
            return self
        order = sorted(range(len(self)), key=lambda i: self.values[i])
        return Listed(tuple(self.values[i] for i in order), tuple(self.spelled[i] for i in order))


@dataclass(frozen=True)
class Steps:
    """The numbers (first + i step)/10^digits, i < count, exactly as decimal fractions."""

    first: int
    step: int
    count: int
    digits: int
    whole: bool
    numeric = True

    def __len__(self) -> int:
        return self.count

    def spell(self, code: int | float) -> str:
        value = self.first + int(code) * self.step
        return str(value) if self.whole else repr(float(Decimal(value).scaleb(-self.digits)))

    def numbers(self, codes: np.ndarray) -> np.ndarray:
        # Both are exact in double precision, so that the quotient is the decimal number as one would type it.
        return (self.first + codes * self.step) / 10.0**self.digits

    def canonical(self) -> Any:
        if self.count > 4096:
            return {"first": self.first, "step": self.step, "count": self.count, "digits": self.digits}
        return [float(self.spell(code)) for code in range(self.count)]

    def sorted(self) -> "Steps":
        if self.step > 0:
            return self
        last = self.first + (self.count - 1) * self.step
        return Steps(last, -self.step, self.count, self.digits, self.whole)


@dataclass(frozen=True)
class Between:
    """All numbers from low to high: for designs that draw."""

    low: float
    high: float
    whole: bool
    numeric = True

    def spell(self, code: int | float) -> str:
        return str(int(code)) if self.whole else repr(float(code))

    def numbers(self, codes: np.ndarray) -> np.ndarray:
        """The codes themselves: a drawn number is its own code."""
        return np.asarray(codes, float)

    def draw(self, uniform: np.ndarray) -> np.ndarray:
        """Numbers for uniform draws in [0, 1)."""
        if self.whole:
            return np.floor(self.low + uniform * (self.high - self.low + 1))
        return self.low + uniform * (self.high - self.low)

    def canonical(self) -> Any:
        return {"low": self.low, "high": self.high, "whole": self.whole}

    def sorted(self) -> "Between":
        return self


Values = Listed | Steps | Between


def is_number(value: Any) -> bool:
    """Whether a value is a number and not true or false."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def parse(key: str, text: str) -> Values | None:
    """The values behind `key=`, or None where there is just one.

    `4:24:2` is a range with its end, `1,2,5` a list (of ranges too), `[1,1,0.8]` one value, `4:24` an interval.

    **Raises:** `UserError` for nothing, an empty range, a step of zero, or what is no YAML.
    """
    parts = _split(text)
    if len(parts) > 1:
        found = [value for part in parts for value in _expand(key, part)]
        return Listed(tuple(value for value, _ in found), tuple(spelled for _, spelled in found))
    match = RANGE.match(parts[0])
    if match is None:
        if not parts[0]:
            raise UserError(f"The key `{key}` must have a value or several, but has none: write {key}=1,2,3.")
        return None
    if match[3] is not None:
        return _steps(key, match)
    low, high = Decimal(match[1]), Decimal(match[2])
    if not low < high:
        raise UserError(f"The interval `{key}={text}` must read low:high with low < high.")
    return Between(float(low), float(high), _is_whole(match[1]) and _is_whole(match[2]))


def _expand(key: str, part: str) -> list[tuple[Any, str]]:
    """The values of one part of a list."""
    match = RANGE.match(part)
    if match is None:
        return [(_read(key, part), part)]
    if match[3] is None:
        raise UserError(
            f"The part `{part}` of `{key}` must read start:stop:step; an interval cannot be part of a list."
        )
    steps = _steps(key, match)
    if len(steps) > LONGEST:
        raise UserError(f"The range `{part}` of `{key}` is too long for a part of a list: give it alone.")
    return [(json.loads(steps.spell(i)), steps.spell(i)) for i in range(len(steps))]


def _steps(key: str, match: re.Match[str]) -> Steps:
    start, stop, step = (Decimal(match[i]) for i in (1, 2, 3))
    if step == 0:
        raise UserError(f"The range `{key}={match[0]}` must have a step other than 0.")
    count = int((stop - start) / step) + 1 if (stop - start) * step >= 0 else 0
    if count < 1:
        raise UserError(
            f"The range `{key}={match[0]}` is empty: it must read start:stop:step, "
            f"and {stop} cannot be reached from {start} in steps of {step}."
        )
    digits = max(0, *(-int(number.as_tuple().exponent) for number in (start, step)))
    first, by = int(start.scaleb(digits)), int(step.scaleb(digits))
    if digits > 22 or max(abs(first), abs(first + (count - 1) * by)) > EXACT:
        raise UserError(f"The range `{key}={match[0]}` has more digits than a number can hold.")
    whole = _is_whole(match[1]) and _is_whole(match[3])
    return Steps(first, by, count, digits, whole)


def _is_whole(text: str) -> bool:
    return re.fullmatch(r"[+-]?\d+", text) is not None


def _read(key: str, text: str) -> Any:
    """One value, read as a config reads it."""
    if not text:
        raise UserError(f"The list of values of `{key}` has an empty place: write {key}=1,2,3.")
    try:
        read: Any = OmegaConf.to_container(OmegaConf.from_dotlist([f"value={text}"]))
    except (OmegaConfBaseException, YAMLError, ValueError) as error:
        first = str(error).strip().splitlines()[0].rstrip(".")
        raise UserError(f"The value `{text}` of `{key}` cannot be read: {first}.") from error
    return read["value"]


def _split(text: str) -> list[str]:
    """The parts of a list, at commas outside of brackets and quotes."""
    parts, depth, quote, start = [], 0, "", 0
    for place, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter in "[{":
            depth += 1
        elif letter in "]}":
            depth -= 1
        elif letter == "," and depth == 0:
            parts.append(text[start:place].strip())
            start = place + 1
    return [*parts, text[start:].strip()]
