"""An answer of a command, as JSON, text and a page for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ._tables import html_page, text_table


class Answer:
    """Answer of a command. Classes that derive from it give a title, rows and remarks."""

    def __init__(self, values: dict[str, Any]) -> None:
        self._json: dict[str, Any] = values["json"]
        self._text: str = values["text"]

    def to_dict(self) -> dict[str, Any]:
        """Returns the object that the command prints with `--json`."""
        return self._json

    def _title(self) -> str:
        return self._text.partition("\n")[0]

    def _rows(self) -> Sequence[Sequence[str]]:
        raise NotImplementedError

    def _remarks(self) -> Iterable[str]:
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"{self._title()}\n{text_table(self._rows())}"

    def __str__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        return html_page(self._title(), self._rows(), self._remarks())
