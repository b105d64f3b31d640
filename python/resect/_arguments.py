"""Checks of arguments. An argument of another form is a `ResectError` that names it, and states the expected form."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Iterable, Sequence
from numbers import Real
from typing import Any, NoReturn

from ._native import ResectError

COUNTS = {2: "two", 3: "three"}
# Endings of names, the longest of those that match.
UNITS = {
    "_m_per_s": "in metres per second",
    "_deg_per_s": "in degrees per second",
    "_m": "in metres",
    "_mm": "in millimetres",
    "_rad": "in radians",
    "_s": "in seconds",
    "_seconds": "in seconds",
    "_hz": "in hertz",
    "rate": "in hertz",
    "body": "in metres",
}
# Characters of a value in a line.
LONGEST_VALUE = 40
LARGEST_SHOWN = 1 << 64


def refuse(name: str, problem: str, form: str) -> NoReturn:
    """Raises "rate is 'fast'; give a number, in hertz"."""
    raise ResectError(f"{name} {problem}; give {form}")


def in_words(value: Any) -> str:
    """Returns "is 'fast'", or "is of type list" for a value that does not fit a line."""
    if isinstance(value, int) and abs(value) > LARGEST_SHOWN:
        return "is too large"
    if value is None or isinstance(value, (str, int, float)):
        text = repr(value)
        return f"is {text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + '…'}"
    return f"is of type {type(value).__name__}"


def with_unit(name: str, form: str) -> str:
    """Returns "a number, in metres" by the unit at the end of a name."""
    unit = max((ending for ending in UNITS if name.endswith(ending)), key=len, default=None)
    return form if unit is None else f"{form}, {UNITS[unit]}"


def number(name: str, value: Any) -> float:
    """Returns a number; a truth value is not one."""
    if is_number(value):
        return float(value)
    refuse(name, in_words(value), with_unit(name, "a number"))


def optional_number(name: str, value: Any) -> float | None:
    """Returns a number, or None."""
    return None if value is None else number(name, value)


def is_number(value: Any) -> bool:
    """Returns true for a real number that a float can have."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        float(value)
    except OverflowError:
        return False
    return True


def is_station_number(value: Any) -> bool:
    """Returns true for an integer that a file can have."""
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1 << 63


def is_word(value: Any) -> bool:
    """Returns true for a string."""
    return isinstance(value, str)


def items(name: str, values: Any, is_item: Callable[[Any], bool], kind: str, count: int | None = None) -> list[Any]:
    """Returns a list of values of one kind, of this length if one is given."""
    form = with_unit(name, f"a list of {kind}s" if count is None else f"{COUNTS[count]} {kind}s")
    if not isinstance(values, (list, tuple)):
        refuse(name, in_words(values), form)
    for value in values:
        if not is_item(value):
            refuse(name, f"has a value that {in_words(value)}", form)
    if count not in (None, len(values)):
        refuse(name, f"has {len(values)} {kind}{'' if len(values) == 1 else 's'}", form.replace(f" {kind}s", "", 1))
    return list(values)


def numbers(name: str, values: Any, count: int | None = None) -> list[float]:
    """Returns a list of numbers, of this length if one is given."""
    return [float(value) for value in items(name, values, is_number, "number", count)]


def words(name: str, values: Any, count: int | None = None) -> list[str]:
    """Returns a list of strings, of this length if one is given."""
    return items(name, values, is_word, "name", count)


def whole_number(name: str, value: Any, lowest: int, highest: int, form: str) -> int:
    """Returns an integer between two limits."""
    if isinstance(value, int) and not isinstance(value, bool) and lowest <= value <= highest:
        return int(value)
    refuse(name, in_words(value), form)


def seed(value: Any) -> int:
    """Returns the seed of a simulation."""
    return whole_number("seed", value, 0, (1 << 64) - 1, "a whole number from 0 to 2**64 - 1")


def truth(name: str, value: Any) -> bool:
    """Returns a truth value."""
    if isinstance(value, bool):
        return value
    refuse(name, in_words(value), "True or False")


def word(name: str, value: Any, form: str = "a name") -> str:
    """Returns a string."""
    if isinstance(value, str):
        return value
    refuse(name, in_words(value), form)


def choice(name: str, value: Any, choices: Sequence[Any]) -> Any:
    """Returns a value that is one of a few."""
    if type(value) in {type(one) for one in choices} and value in choices:
        return value
    *others, last = map(str, choices)
    refuse(name, in_words(value), f"{', '.join(others)} or {last}")


def path(name: str, value: Any) -> str | os.PathLike[str]:
    """Returns a path."""
    if isinstance(value, (str, os.PathLike)):
        return value
    refuse(name, in_words(value), "a path: a string or a pathlib.Path")


def paths(name: str, values: Any) -> list[str | os.PathLike[str]]:
    """Returns one path, or several, as a list."""
    if isinstance(values, (str, os.PathLike)):
        return [values]
    form = "a path, or a list of paths"
    if not isinstance(values, Iterable) or isinstance(values, (bytes, dict)):
        refuse(name, in_words(values), form)
    every = list(values)
    for value in every:
        if not isinstance(value, (str, os.PathLike)):
            refuse(name, f"has a value that {in_words(value)}", form)
    return every


def known(kind: str, given: Iterable[str], names: Sequence[str], others: Iterable[str] = ()) -> None:
    """Refuses names that are unknown, with the nearest of the known names and of the `others` that a call accepts."""
    for name in given:
        if name not in names:
            near = nearest(name, [*names, *others])
            hint = f"; {kind}s are" if near is None else f"; did you mean {near}? All {kind}s:"
            raise ResectError(f"unknown {kind} `{name}`{hint} {', '.join(names)}")


def nearest(name: str, names: Sequence[str]) -> str | None:
    """Returns the shortest name that starts with a mistyped one, or else one of similar spelling."""
    longer = [one for one in names if name and one.startswith(name)]
    return min(longer, key=len) if longer else next(iter(difflib.get_close_matches(name, names, 1)), None)
