"""Draws the errors of the inter-prism distances of a deployment: python plot_residuals.py FOLDER [PICTURE.png]"""

from __future__ import annotations

import sys

import matplotlib
import numpy as np
import resect

# Without a window.
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def main() -> None:
    answer = resect.open(sys.argv[1]).calibrate()
    residuals = answer.residuals
    time_s = residuals["time_s"] - residuals["time_s"][0]
    figure, axes = plt.subplots(3, 1, sharex=True, sharey=True, figsize=(9, 6), layout="constrained")
    for axis, pair in zip(axes, ("12", "13", "23")):
        error_mm = residuals[f"error_{pair}_mm"]
        axis.plot(time_s, error_mm, ".", markersize=2)
        axis.set_ylabel(f"prisms {pair[0]}–{pair[1]} (mm)")
        axis.set_title(f"median of |error| {np.median(np.abs(error_mm)):.1f} mm", fontsize="small", loc="right")
    axes[0].set_title(f"{answer.deployment} · verdict: {answer.verdict}", loc="left")
    axes[-1].set_xlabel("time (s)")
    figure.savefig(sys.argv[2] if len(sys.argv) > 2 else "residuals.png", dpi=150)


if __name__ == "__main__":
    main()
