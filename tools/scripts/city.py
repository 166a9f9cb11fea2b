#!/usr/bin/env python3
"""A city of a square kilometre, or up to four, and a drive through all its streets, and what mapping it takes from its first scans to its last.

  city.py GDTSLAM -o FOLDER [--side M] [--blocks N] [--scans N] [--seed N] [--only-log] [--set PATH=VALUE] [--loops]

The campus of docs/benchmarks.md is --side 1994 --blocks 4 --scans 60000. Blocks of houses whose facades have recesses, parked cars, trees; the laser sees 80 m over half a turn. The drive goes through
every street at least once and comes back to where it began. FOLDER gets city.yaml, city.log.gz and city.truth.tum, some
25 MB at 30,000 scans; a log that is there and was made with the same options is used again. Then
`gdtslam bench live --speed 0` maps the log, without loops or with them, and its figures are held against the bounds: time a
keyframe of the last tenth within 10 % of the first, 3 GB, 30 ms a scan. The exit code is 1 where one is missed.
"""

import argparse
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import time

STREET_M = 14.0
SPEED_M_S = 4.0
CORNER_M = 11.0  # from a crossing's middle to where cars may park
BOUNDS = {"growth": 1.10, "memory_bytes": 3e9, "largest_s": 0.030}

ROBOT = """
robot:
  body: {{radius: 80 cm, height: 1.6 m}}
  laser: {{preset: sick-361, height: 60 cm}}
  wheels: {{slip: 2 mm, left_scale: 1.003, right_scale: 0.998}}
  motion: {{speed: {speed:g} m/s, acceleration: 1.5 m/s^2, turn_rate: 60 deg/s, turn_acceleration: 120 deg/s^2, corner_cut: 4 m}}
recording: {{scan_rate: {rate:.4f} Hz, odometry_rate: 0 Hz}}
"""


class City:
    """Streets in a grid; the middle of the crossing (0, 0) is the origin. Metres."""

    def __init__(self, side_m, blocks, seed):
        self.blocks = blocks
        # A scene lies within 1000 m of its origin.
        self.shift_m = 0.0 if side_m <= 980.0 else -(side_m - STREET_M) / 2
        self.pitch_m = (side_m - STREET_M) / blocks
        self.rng = random.Random(f"city {seed}")
        self.walls, self.cars, self.trees = [], [], []
        for column in range(blocks):
            for row in range(blocks):
                self.block(column * self.pitch_m + STREET_M / 2, row * self.pitch_m + STREET_M / 2)
        edge = -STREET_M / 2
        self.walls.append(self.facades((edge, edge), side_m, -1.0))
        for line in range(blocks + 1):
            for part in range(blocks):
                self.street(line, part)

    def facades(self, corner, side_m, inward):
        """Around a square, counterclockwise: fronts of houses, and recesses to the inside (or to the outside: -1)."""
        points = []
        (x, y), (dx, dy) = corner, (1.0, 0.0)
        for _ in range(4):
            at = 0.0
            while at < side_m:
                front = min(at + self.rng.uniform(5.0, 18.0), side_m)
                recess = min(front + self.rng.uniform(1.5, 6.0), side_m)
                deep = inward * self.rng.uniform(0.3, 2.0)
                if recess > side_m - 4.0:  # a corner has no recess
                    front = recess = side_m
                points += [(x + dx * at, y + dy * at), (x + dx * front, y + dy * front)]
                if recess > front:
                    points += [(x + dx * at_ - dy * deep, y + dy * at_ + dx * deep) for at_ in (front, recess)]
                at = recess
            x, y, (dx, dy) = x + dx * side_m, y + dy * side_m, (-dy, dx)
        return [point for point, before in zip(points, points[-1:] + points[:-1]) if math.dist(point, before) > 0.01]

    def block(self, x, y):
        self.walls.append(self.facades((x, y), self.pitch_m - STREET_M, 1.0))

    def street(self, line, part):
        """Cars and trees on both sides of a street between two crossings, one along x and one along y."""
        for along_x in (True, False):
            for side in (-1.0, 1.0):
                self.along(self.rng.uniform(4.8, 12.0), 1.0, line, part, along_x, side, self.car)
                self.along(self.rng.uniform(1.0, 6.0), 7.0, line, part, along_x, side, self.tree)

    def along(self, at, gap_m, line, part, along_x, side, put):
        at += CORNER_M
        while at < self.pitch_m - CORNER_M:
            put(part * self.pitch_m + at, line * self.pitch_m, along_x, side)
            at += gap_m + self.rng.choice((4.8, 5.4, 6.0, 9.0, 14.0, 25.0))

    def car(self, at, middle, along_x, side):
        across = middle + side * (STREET_M / 2 - self.rng.uniform(3.0, 3.3))
        size = (self.rng.uniform(3.6, 4.9), self.rng.uniform(1.6, 1.9))
        yaw = self.rng.uniform(-2.0, 2.0) + (0.0 if along_x else 90.0)
        self.cars.append(((at, across) if along_x else (across, at), size, yaw))

    def tree(self, at, middle, along_x, side):
        across = middle + side * (STREET_M / 2 - 1.2)
        self.trees.append(((at, across) if along_x else (across, at), self.rng.uniform(0.12, 0.35)))

    def drive(self):
        """Corners of a way through every street, back to where it began: a circuit of Euler (Hierholzer) once the streets
        between crossings of three are doubled."""
        n = self.blocks
        ways = {}

        def join(a, b):
            ways.setdefault(a, []).append(b)
            ways.setdefault(b, []).append(a)

        for i in range(n + 1):
            for k in range(n):
                join((i, k), (i, k + 1))
                join((k, i), (k + 1, i))
        rim = [(i, 0) for i in range(n)] + [(n, i) for i in range(n)] + [(n - i, n) for i in range(n)] + [(0, n - i) for i in range(n)]
        is_between = False  # of two crossings of three
        for a, b in zip(rim, rim[1:] + rim[:1]):
            is_between ^= not {*a} <= {0, n}
            if is_between:
                join(a, b)
        circuit, stack = [], [(0, 0)]
        while stack:
            here = stack[-1]
            if not ways[here]:
                circuit.append(stack.pop())
                continue
            last = stack[-2] if len(stack) > 1 else None
            # Straight on where the street goes on, back only where nothing else is left.
            ahead = (2 * here[0] - last[0], 2 * here[1] - last[1]) if last else None
            rank = sorted(ways[here], key=lambda there: (there == last, there != ahead, there))
            ways[here].remove(rank[0])
            ways[rank[0]].remove(here)
            stack.append(rank[0])
        return [(x * self.pitch_m, y * self.pitch_m) for x, y in circuit]

    def text_of(self, x, y):
        return f"[{x + self.shift_m:.3f}, {y + self.shift_m:.3f}]"

    def scene(self, waypoints, rate_hz):
        lines = ["gdtslam_scene: 1", "name: city", "wall_defaults: {thickness: 20 cm, height: 6 m}", "walls:"]
        for points in self.walls:
            text = ", ".join(self.text_of(x, y) for x, y in points)
            lines.append(f"  - {{points: [{text}], closed: true}}")
        lines.append("boxes:")
        for (x, y), (length, width), yaw in self.cars:
            lines.append(f"  - {{centre: {self.text_of(x, y)}, size: [{length:.3f}, {width:.3f}], height: 1.5 m, yaw: {yaw:.2f} deg}}")
        lines.append("cylinders:")
        for (x, y), radius in self.trees:
            lines.append(f"  - {{centre: {self.text_of(x, y)}, radius: {radius:.3f}, height: 5 m, sides: 12}}")
        points = "".join(f"  - {self.text_of(x, y)}\n" for x, y in waypoints)
        return "\n".join(lines) + ROBOT.format(speed=SPEED_M_S, rate=rate_hz) + "waypoints:\n" + points


def length_of(waypoints):
    return sum(abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in zip(waypoints, waypoints[1:]))


def run(*command):
    """What it prints, its CPU seconds and the most memory in bytes that it had."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE)
    text = process.stdout.read().decode()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"city.py: {' '.join(map(str, command))}: exit {process.returncode}")
    return text, usage.ru_utime + usage.ru_stime, 1024.0 * usage.ru_maxrss


def make_log(options):
    """The log of the scene in the folder; made only where the scene is another."""
    city = City(options.side, options.blocks, options.seed)
    waypoints = city.drive()
    rate_hz = 1.01 * options.scans * SPEED_M_S / length_of(waypoints)
    scene, log = city.scene(waypoints, rate_hz), options.output / "city.log.gz"
    file = options.output / "city.yaml"
    if log.exists() and file.exists() and file.read_text() == scene:
        return log
    options.output.mkdir(parents=True, exist_ok=True)
    log.unlink(missing_ok=True)
    file.write_text(scene)
    print(f"{len(city.walls)} blocks and their rim, {len(city.cars)} cars, {len(city.trees)} trees; {length_of(waypoints) / 1000:.1f} km")
    run(options.program, "simulate", file, "-o", log, "--seed", options.seed, "--quiet")
    return log


def verdict(live, memory_bytes):
    """Lines of a table, and whether all bounds hold."""
    first, last = live["parts"][0], live["parts"][-1]
    values = {"growth": last["keyframe_cpu_s"] / first["keyframe_cpu_s"], "memory_bytes": memory_bytes,
              "largest_s": live["cpu"]["largest_s"]}
    texts = {"growth": ("a keyframe's CPU time, last tenth by first", "{:.2f}"), "memory_bytes": ("memory, bytes", "{:.3g}"),
             "largest_s": ("largest CPU time of a scan, s", "{:.4f}")}
    lines = ["| | measured | at most |", "|---|---|---|"]
    lines += [f"| {text} | {shape.format(values[key])} | {shape.format(BOUNDS[key])} |" for key, (text, shape) in texts.items()]
    return lines, all(values[key] <= BOUNDS[key] for key in BOUNDS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--side", type=float, default=1000.0, help="of the city, metres (%(default)s)")
    parser.add_argument("--blocks", type=int, default=10, help="along a side (%(default)s)")
    parser.add_argument("--scans", type=int, default=30000, help="at least (%(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only-log", action="store_true", help="do not map it")
    parser.add_argument("--loops", action="store_true", help="map with loops")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="passed on")
    options = parser.parse_args()
    if not (60.0 <= options.side <= 1994.0 and options.blocks >= 1 and options.side / options.blocks >= 60.0):
        parser.error("--side is 60 to 1994 m, 60 m a block at least")
    start = time.monotonic()
    log = make_log(options)
    print(f"{log}: {time.monotonic() - start:.0f} s")
    if options.only_log:
        return
    words = [word for value in options.set for word in ("--set", value)]
    text, cpu_s, memory_bytes = run(options.program, "bench", "live", "--log", log, "--speed", 0, "--json", *words,
                                    *([] if options.loops else ["--no-loops"]))
    live = json.loads(text)
    (options.output / "live.json").write_text(text)
    lines, is_met = verdict(live, memory_bytes)
    print(f"{live['scans']} scans, {live['keyframes']} keyframes, {cpu_s:.1f} s of CPU time; {options.output / 'live.json'} has more")
    print("\n".join(lines))
    sys.exit(0 if is_met else 1)


if __name__ == "__main__":
    main()
