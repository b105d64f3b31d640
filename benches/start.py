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

# Larger than the window, which would else be made smaller.
WIDTH, HEIGHT = 1920, 1200
# A frame without any text has fewer; one with the panes has hundreds.
COLOURS = 100
LONGEST_S = 20.0


def server_with_screen(folder):
    """The server, the name of its display, and the pixels of its screen as they change."""
    read, write = os.pipe()
    arguments = ["Xvfb", "-displayfd", str(write), "-noreset", "-fbdir", folder]
    arguments += ["-screen", "0", f"{WIDTH}x{HEIGHT}x24"]
    server = subprocess.Popen(arguments, stderr=subprocess.DEVNULL, pass_fds=[write])
    os.close(write)
    # It tells the number when it is ready.
    with open(read) as told:
        display = f":{told.readline().strip()}"
    with open(Path(folder) / "Xvfb_screen0", "rb") as file:
        pixels = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    # All behind the header of the X window dump.
    return server, display, memoryview(pixels)[-4 * WIDTH * HEIGHT :].cast("I")


def colours(pixels):
    # Every so many pixels, in a stride that no row divides.
    return len(set(pixels[::97].tolist()))


def start_ms(program, display, pixels):
    # A user whose last window did not crash.
    with tempfile.TemporaryDirectory() as home:
        return start_of_ms(program, display, pixels, home)


def start_of_ms(program, display, pixels, home):
    environment = dict(os.environ, DISPLAY=display, HOME=home, XDG_CONFIG_HOME=home, XDG_DATA_HOME=home)
    environment.pop("WAYLAND_DISPLAY", None)
    while colours(pixels) > 1:
        time.sleep(0.01)
    since = time.perf_counter()
    process = subprocess.Popen([program], env=environment, stderr=subprocess.DEVNULL)
    try:
        while colours(pixels) < COLOURS:
            if time.perf_counter() - since > LONGEST_S or process.poll() is not None:
                sys.exit("no picture")
            # To look costs about a millisecond, of a machine that has few cores.
            time.sleep(0.005)
        return 1e3 * (time.perf_counter() - since)
    finally:
        process.kill()
        process.wait()


def main():
    program, starts = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 9
    with tempfile.TemporaryDirectory() as folder:
        server, display, pixels = server_with_screen(folder)
        try:
            # The first start reads the program from the disk.
            all_ms = [start_ms(program, display, pixels) for _ in range(starts + 1)][1:]
        finally:
            server.terminate()
            server.wait()
    print(f"{statistics.median(all_ms):.0f} ms ({min(all_ms):.0f} to {max(all_ms):.0f}, {starts} starts)")


if __name__ == "__main__":
    main()
