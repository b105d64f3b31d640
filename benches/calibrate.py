"""How long a whole process of `resect calibrate` takes, in milliseconds from its start to its end: the cold time of an answer.

    python3 benches/calibrate.py target/release/resect FOLDER [RUNS]
Prints a line for each method, as the peers of `benches/table` do.
"""

import statistics
import subprocess
import sys
import time

METHODS = ["inter-prism", "joint"]


def process_ms(program, method, folder):
    since = time.perf_counter()
    subprocess.run([program, "calibrate", "--method", method, folder], stdout=subprocess.DEVNULL, check=True)
    return 1e3 * (time.perf_counter() - since)


def main():
    program, folder = sys.argv[1:3]
    runs = int(sys.argv[3]) if len(sys.argv) > 3 else 41
    # Both methods take turns, so that a busy machine slows both; the first turn reads program and data from the disk.
    turns = [[process_ms(program, method, folder) for method in METHODS] for _ in range(runs + 1)][1:]
    for method, all_ms in zip(METHODS, zip(*turns)):
        print("process", method, statistics.median(all_ms))


if __name__ == "__main__":
    main()
