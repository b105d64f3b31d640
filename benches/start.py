"""How long the window takes to its first picture with the sample, in milliseconds from the start of the process.

Seen from outside: Xvfb keeps its screen in a file, and the picture is there once the screen shows many colours.
    python3 benches/start.py target/release/resect [STARTS]
"""

import mmap
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DISPLAY = ":93"
WIDTH, HEIGHT = 1600, 1000
# A frame without any text has fewer; one with the panes has hundreds.
COLOURS = 100
LONGEST_S = 20.0


def screen(folder):
    """The pixels of the screen as they change: all behind the header of the X window dump."""
    path = Path(folder) / "Xvfb_screen0"
    while not path.is_file():
        time.sleep(0.01)
    file = open(path, "rb")
    pixels = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    return memoryview(pixels)[-4 * WIDTH * HEIGHT :].cast("I")


def colours(pixels):
    # Every so many pixels, in a stride that no row divides.
    return len(set(pixels[::97].tolist()))


def start_ms(program, pixels):
    # A user whose last window did not crash.
    with tempfile.TemporaryDirectory() as home:
        return start_of_ms(program, pixels, home)


def start_of_ms(program, pixels, home):
    environment = dict(os.environ, DISPLAY=DISPLAY, HOME=home, XDG_CONFIG_HOME=home, XDG_DATA_HOME=home)
    environment.pop("WAYLAND_DISPLAY", None)
    while colours(pixels) > 1:
        time.sleep(0.01)
    since = time.perf_counter()
    process = subprocess.Popen([program], env=environment, stderr=subprocess.DEVNULL)
    try:
        while colours(pixels) < COLOURS:
            if time.perf_counter() - since > LONGEST_S or process.poll() is not None:
                sys.exit("no picture")
            time.sleep(0.001)
        return 1e3 * (time.perf_counter() - since)
    finally:
        process.kill()
        process.wait()


def main():
    program, starts = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 9
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["Xvfb", DISPLAY, "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", folder]
        server = subprocess.Popen(arguments, stderr=subprocess.DEVNULL)
        try:
            pixels = screen(folder)
            # The first start reads the program from the disk.
            all_ms = [start_ms(program, pixels) for _ in range(starts + 1)][1:]
        finally:
            server.terminate()
    print(f"{statistics.median(all_ms):.0f} ms ({min(all_ms):.0f} to {max(all_ms):.0f}, {starts} starts)")


if __name__ == "__main__":
    main()
