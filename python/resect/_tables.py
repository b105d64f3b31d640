"""Tables, numbers with their standard deviation, and pages for notebooks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Table = dict[str, NDArray[Any]]


def columns(rows: Sequence[Mapping[str, Any]], names: Iterable[str]) -> Table:
    """Returns rows as columns; a missing number is NaN, a missing word is empty."""
    return {name: _column([row.get(name) for row in rows]) for name in names}


def _column(values: list[Any]) -> NDArray[Any]:
    known = [value for value in values if value is not None]
    if known and all(isinstance(value, str) for value in known):
        return np.array(["" if value is None else value for value in values])
    if known and len(known) == len(values):
        return np.array(values)
    return np.array([math.nan if value is None else value for value in values], dtype=np.float64)


def with_sigma(value: float, sigma: float | None, factor: float = 1.0) -> str:
    """Returns "1.2346 ± 0.0012": σ with two digits, and the value to the same place."""
    value *= factor
    if sigma is None or not math.isfinite(sigma) or sigma <= 0.0:
        return f"{value:.4f}"
    sigma *= factor
    places = min(max(1 - math.floor(math.log10(sigma)), 0), 9)
    return f"{value:.{places}f} ± {sigma:.{places}f}"


def text_table(rows: Sequence[Sequence[str]]) -> str:
    """Returns rows with aligned columns; the first row is the header."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows)
    return "\n".join(lines)


def html_page(title: str, rows: Sequence[Sequence[str]], lines: Iterable[str] = ()) -> str:
    """Returns a title, a table whose first row is the header, and a list of lines."""

    def row(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    table = row(rows[0], "th") + "".join(row(cells, "td") for cells in rows[1:]) if rows else ""
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<p><b>{escape(title)}</b></p><table>{table}</table>" + (f"<ul>{items}</ul>" if items else "")
