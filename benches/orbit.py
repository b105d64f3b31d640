"""How many different pictures a second the window shows while the pointer orbits the scene.

Seen from outside: Xvfb keeps its screen in a file, in which a part of the scene changes with each picture. Needs Xvfb and xdotool.
    python3 benches/orbit.py target/release/resect [PATH…]
"""

import os
import subprocess
import sys
import tempfile
import time

import start

SECONDS = 6.0
# Steps of the pointer, faster than any picture.
STEP_S = 0.01
# Middle of the scene in the default layout of a new user, at 1600×1000, and the side of the part that is watched (pixels).
MIDDLE = (755, 330)
SIDE = 80


def watched(pixels):
    left, top = MIDDLE[0] - SIDE // 2, MIDDLE[1] - SIDE // 2
    rows = range(top, top + SIDE)
    return hash(b"".join(bytes(pixels[row * start.WIDTH + left :][:SIDE]) for row in rows))


def pictures(pixels, until):
    """The number of changes, each seen twice in a row so that no half of a picture counts."""
    shown = before = watched(pixels)
    count = 0
    while time.perf_counter() < until:
        time.sleep(0.003)
        now = watched(pixels)
        if now == before and now != shown:
            shown, count = now, count + 1
        before = now
    return count


def drag():
    """A drag with the left button, as commands of xdotool: to and fro, so that the scene stays in the picture."""
    steps = [f"mousemove {MIDDLE[0]} {MIDDLE[1]}", "sleep 0.5", "mousedown 1"]
    for step in range(int(4 * SECONDS / STEP_S)):
        there = step % 240
        x = MIDDLE[0] + (there if there < 120 else 240 - there) * 2
        steps += [f"mousemove {x} {MIDDLE[1] + there % 40}", f"sleep {STEP_S}"]
    return "\n".join(steps)


def pictures_a_second(program, paths, display, pixels):
    with tempfile.TemporaryDirectory() as home:
        environment = dict(os.environ, DISPLAY=display, HOME=home, XDG_CONFIG_HOME=home, XDG_DATA_HOME=home)
        environment.pop("WAYLAND_DISPLAY", None)
        process = subprocess.Popen([program, *paths], env=environment, stderr=subprocess.DEVNULL)
        pointer = None
        try:
            time.sleep(8)
            pointer = subprocess.Popen(["xdotool", "-"], env=environment, stdin=subprocess.PIPE)
            pointer.stdin.write(drag().encode())
            pointer.stdin.close()
            time.sleep(2)
            since = time.perf_counter()
            count = pictures(pixels, since + SECONDS)
            return count / (time.perf_counter() - since)
        finally:
            for ended in filter(None, (pointer, process)):
                ended.kill()
                ended.wait()


def main():
    with tempfile.TemporaryDirectory() as folder:
        server, display, pixels = start.server_with_screen(folder)
        try:
            rate = pictures_a_second(sys.argv[1], sys.argv[2:], display, pixels)
        finally:
            server.terminate()
            server.wait()
    print(f"{rate:.1f} pictures a second")


if __name__ == "__main__":
    main()
