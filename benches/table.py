"""Prints as Markdown what `cargo bench` and the peers measured; `benches/table` runs all of it."""

import json
import sys
from pathlib import Path

CRITERION = Path(__file__).resolve().parent.parent / "target/criterion"
SIZES = ["2000", "20000", "200000", "2000000"]
# What is in the table, in order: its name there, and where its number lies.
ROWS = [
    ("pipeline, straight lines", "pipeline"),
    ("pipeline, motion model", "pipeline-wnoa"),
    ("pipeline, GP", "pipeline-gp"),
    ("*D*: prior, minima, σ, verdict", "d-closed-form"),
    ("*D* by the paper's search prior", "d-search"),
    ("whole path: settings to new errors", "whole"),
    ("joint estimate, checks included", "joint"),
    ("peer: Ceres, analytic, solve", "ceres"),
    ("peer: Ceres, set-up of the problem", "ceres-set-up"),
    ("peer: crate `levenberg-marquardt`", "peer-levenberg-marquardt"),
    ("peer: scipy `lm`", "scipy-lm"),
    ("peer: scipy `trf` (default)", "scipy-trf"),
]
PANES = ["residuals", "rates", "intervals", "channels"]


def criterion_ms(*names):
    path = CRITERION.joinpath(*names, "new", "estimates.json")
    return json.loads(path.read_text())["median"]["point_estimate"] / 1e6 if path.is_file() else None


def told(ms):
    return "–" if ms is None else f"{ms:.3g}" if ms < 100 else f"{ms:,.0f}".replace(",", " ")


def main():
    peers = {}
    for line in Path(sys.argv[1]).read_text().splitlines():
        size, name, ms = line.split()
        peers[name, size] = float(ms)
    print("| ms | " + " | ".join(f"{int(size):,}".replace(",", " ") for size in SIZES) + " |")
    print("|---" + "|---:" * len(SIZES) + "|")
    for title, name in ROWS:
        found = [peers.get((name, size), criterion_ms("path", name, size)) for size in SIZES]
        print(f"| {title} | " + " | ".join(map(told, found)) + " |")
    print("\n| one published run, ms | cold: a whole process | warm: the calibration in a loop |\n|---|---:|---:|")
    for title, name in [("*D*", "inter-prism"), ("joint estimate", "joint")]:
        print(f"| {title} | {told(peers.get((name, 'process')))} | {told(criterion_ms('field', name))} |")
    print("\n| a frame with a million readings, ms | orbit | cursor |\n|---|---:|---:|")
    for pane in PANES:
        cells = [told(criterion_ms("window", f"{event}-{pane}")) for event in ("orbit", "cursor")]
        print(f"| window with {pane} in front | " + " | ".join(cells) + " |")
    cells = [told(criterion_ms("scene", event)) for event in ("orbit", "cursor")]
    print("| scene alone | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
