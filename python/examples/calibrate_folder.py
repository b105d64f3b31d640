"""Calibrates every deployment of a folder, and writes a table: python calibrate_folder.py FOLDER [TABLE.csv]"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import resect


def rows(folder: Path) -> list[dict[str, object]]:
    """Returns a row for each of stations 2 and 3 of each deployment; others are reported."""
    found: list[dict[str, object]] = []
    for path in sorted(path for path in folder.iterdir() if path.is_dir()):
        try:
            answer = resect.open(path).calibrate()
        except resect.ResectError as error:
            print(error, file=sys.stderr)
            continue
        for transform in answer.transforms:
            sigma_m = transform.sigma_translation_m
            if sigma_m is None:
                sigma_m = np.full(3, np.nan)
            row: dict[str, object] = {"deployment": answer.deployment, "verdict": answer.verdict}
            row |= {"station": transform.station, "yaw_rad": transform.yaw_rad}
            row |= {"sigma_yaw_rad": transform.sigma_yaw_rad}
            row |= dict(zip(("x_m", "y_m", "z_m"), transform.translation_m))
            row |= dict(zip(("sigma_x_m", "sigma_y_m", "sigma_z_m"), sigma_m))
            found.append(row | {"findings": " ".join(answer.findings)})
    return found


def main() -> None:
    table = pd.DataFrame(rows(Path(sys.argv[1])))
    if len(sys.argv) > 2:
        table.to_csv(sys.argv[2], index=False)
    print(table.to_string(index=False))


if __name__ == "__main__":
    main()
