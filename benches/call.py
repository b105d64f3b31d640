"""How long a joint estimate by call takes in Python, in milliseconds, and what of that the Python module adds.

    target/python/bin/python benches/call.py FOLDER…
Needs the wheel that `tests/run --python` installs.
"""

import os
import statistics
import sys
import time

# With it, answers have no durations.
os.environ.pop("SOURCE_DATE_EPOCH", None)

import resect

REPEATS = 21


def main():
    for folder in sys.argv[1:]:
        deployment = resect.open(folder)
        calls_ms, added_ms = [], []
        for _ in range(REPEATS):
            began_s = time.perf_counter()
            answer = deployment.calibrate()
            calls_ms.append(1e3 * (time.perf_counter() - began_s))
            own_ms = answer.to_dict()["time_ms"]
            added_ms.append(calls_ms[-1] - (own_ms["total"] - own_ms["load"]))
        print(f"{folder}: median {statistics.median(calls_ms):.1f} ms, of which the module adds {statistics.median(added_ms):.2f} ms")


if __name__ == "__main__":
    main()
