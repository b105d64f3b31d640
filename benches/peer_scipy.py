#!/usr/bin/env python3
"""Times scipy's least_squares on the triplets that `cargo bench --bench path` left behind.

A line for each number: triplets wanted, name, milliseconds (median of several). `benches/table` runs it. scipy gets the vectorised analytic Jacobian, its default method (`trf`) and its fastest (`lm`), and starts from the same good prior as the Rust peer (2 mm, 4 cm in z,
0.06 mrad off). One thread. Its answer is checked against ours.
"""

import os
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402
from scipy.optimize import least_squares  # noqa: E402

TARGET = Path(__file__).resolve().parent.parent / "target"


def place(q, t):
    """Points in frame 1, and their derivative by yaw."""
    c, s = np.cos(t[3]), np.sin(t[3])
    x, y = c * q[:, 0] - s * q[:, 1], s * q[:, 0] + c * q[:, 1]
    return np.stack([x + t[0], y + t[1], q[:, 2] + t[2]], 1), np.stack([-y, x, 0 * x], 1)


def solve(q1, q2, q3, distances, prior, method):
    n = len(q1)

    def residuals(p):
        p2, p3 = place(q2, p[:4])[0], place(q3, p[4:])[0]
        pairs = (q1 - p2, q1 - p3, p2 - p3)
        return np.concatenate([np.linalg.norm(e, axis=1) - d for e, d in zip(pairs, distances)])

    def jacobian(p):
        (p2, d2), (p3, d3) = place(q2, p[:4]), place(q3, p[4:])
        j = np.zeros((3 * n, 8))
        for pair, (e, a, b) in enumerate([(q1 - p2, None, 0), (q1 - p3, None, 4), (p2 - p3, 0, 4)]):
            u = e / np.linalg.norm(e, axis=1)[:, None]
            rows = slice(pair * n, (pair + 1) * n)
            for column, sign in ((a, 1.0), (b, -1.0)):
                if column is not None:
                    j[rows, column : column + 3] = sign * u
                    turned = d2 if column == 0 else d3
                    j[rows, column + 3] = sign * np.einsum("ij,ij->i", u, turned)
        return j

    return least_squares(residuals, prior, jac=jacobian, method=method)


def main():
    for size in (2000, 20000, 200000, 2000000):
        folder = TARGET / "bench-triplets" / str(size)
        table = np.loadtxt(folder / "triplets.csv", delimiter=",", skiprows=1)
        q1, q2, q3 = (np.ascontiguousarray(table[:, i : i + 3]) for i in (2, 5, 8))
        told = (folder / "problem.csv").read_text().splitlines()
        distances, prior, ours = (np.array(line.split(","), float) for line in told)
        for method in ("lm", "trf"):
            times_ms = []
            for _ in range(9 if size < 100000 else 3):
                start = time.perf_counter()
                found = solve(q1, q2, q3, distances, prior, method)
                times_ms.append((time.perf_counter() - start) * 1e3)
            off = np.abs(found.x - ours).max()
            assert off < 1e-6, f"scipy and resect disagree by {off}"
            print(size, f"scipy-{method}", f"{np.median(times_ms):.3f}", flush=True)


if __name__ == "__main__":
    main()
