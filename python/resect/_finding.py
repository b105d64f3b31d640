"""Findings of readers, pipeline and solvers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """A finding about the data or the answer.

    `code` is stable, for scripts; `message` is for people and may change. `severity` is note, warning or problem.
    `subject` is a station, a pair of prisms, a file or a point, as in the JSON. `quantities` are named with their SI
    unit; an estimate is a dictionary of `value` and `sigma`.
    """

    code: str
    severity: str
    message: str
    subject: dict[str, Any] | None
    quantities: dict[str, Any]

    def __str__(self) -> str:
        return f"{self.severity}: {self.message}"


def findings_by_code(objects: Iterable[Mapping[str, Any]]) -> dict[str, tuple[Finding, ...]]:
    """Returns findings of the JSON by their code, in their order."""
    found: dict[str, tuple[Finding, ...]] = {}
    for values in objects:
        finding = Finding(**values)
        found[finding.code] = (*found.get(finding.code, ()), finding)
    return found


def lines(findings: Mapping[str, tuple[Finding, ...]]) -> list[str]:
    """Returns warnings and problems as lines."""
    return [str(one) for all_of_code in findings.values() for one in all_of_code if one.severity != "note"]
