#!/usr/bin/env python3
"""Compares two texts: numbers within a relative tolerance, all else literally. Prints the largest difference.

    compare.py LINUX WINDOWS TOLERANCE

The separators of paths may differ, and the program is resect.exe on Windows.
"""

import re
import sys

NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w])")
# A difference of numbers below this is rounding, whatever their size.
ROUNDING = 1e-12


def read(path):
    with open(path, encoding="utf-8", newline="") as file:
        text = file.read().replace("resect.exe", "resect")
    # JSON doubles the separator of Windows.
    return text.replace("\\\\", "/").replace("\\", "/")


def value(text):
    return float(text.replace("−", "-"))


def place(text, at):
    line = text.count("\n", 0, at) + 1
    return f"line {line}: {text[max(0, at - 60):at + 60]!r}"


def main():
    linux, windows, tolerance = read(sys.argv[1]), read(sys.argv[2]), float(sys.argv[3])
    ours, theirs = list(NUMBER.finditer(linux)), list(NUMBER.finditer(windows))
    largest, end_linux, end_windows = 0.0, 0, 0
    for a, b in zip(ours, theirs):
        if linux[end_linux:a.start()] != windows[end_windows:b.start()]:
            break
        x, y = value(a.group()), value(b.group())
        off = abs(x - y)
        if off > ROUNDING:
            largest = max(largest, off / max(abs(x), abs(y)))
        if off > max(tolerance * max(abs(x), abs(y)), ROUNDING):
            sys.exit(f"{a.group()} on Linux is {b.group()} on Windows; {place(linux, a.start())}")
        end_linux, end_windows = a.end(), b.end()
    if linux[end_linux:] != windows[end_windows:]:
        sys.exit(f"Linux {place(linux, end_linux)}\nWindows {place(windows, end_windows)}")
    print(f"{len(ours)} numbers, largest relative difference {largest:.1e}")


main()
