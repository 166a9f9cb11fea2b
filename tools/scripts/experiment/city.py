"""A drive through all streets of a city, and what mapping it takes: from its first scans to its last, and against how far a
robot drives and how large the city is."""

import json
import math
import random

from experiment.common import print_table, print_row, peak_of
from long_drives import run

STREET_M = 14.0
SPEED_M_S = 4.0
CORNER_M = 11.0  # from a crossing's middle to where cars may park
CITY_ROBOT = """
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
        return "\n".join(lines) + CITY_ROBOT.format(speed=SPEED_M_S, rate=rate_hz) + "waypoints:\n" + points


def city_log(program, folder, side_m, blocks, scans, seed):
    """The log of a city in the folder; made only where its scene is another than before."""
    city = City(side_m, blocks, seed)
    waypoints = city.drive()
    length_m = sum(abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in zip(waypoints, waypoints[1:]))
    scene, log, file = city.scene(waypoints, 1.01 * scans * SPEED_M_S / length_m), folder / "city.log.gz", folder / "city.yaml"
    if not (log.exists() and file.exists() and file.read_text() == scene):
        folder.mkdir(parents=True, exist_ok=True)
        log.unlink(missing_ok=True)
        file.write_text(scene)
        print(f"{len(city.walls)} blocks and their rim, {len(city.cars)} cars, {len(city.trees)} trees; {length_m / 1000:.1f} km")
        run(program, "simulate", file, "-o", log, "--force", "--seed", seed, "--quiet")
    return log


def city(chosen):
    """Maps a city as `gdtslam-lab bench live --speed 0` does: a keyframe's time in the last tenth by that in the first, memory, slowest scan."""
    log = city_log(chosen.program, chosen.folder, chosen.side, chosen.blocks, chosen.scans, chosen.seed)
    text, memory_bytes = peak_of(chosen.program.with_name("gdtslam-lab"), "bench", "/live/", "--log", log, "--speed", 0, "--benchmark_format=json", *chosen.mapping,
                                 *([] if chosen.loops else ["--no-loops"]))
    (chosen.folder / "live.json").write_text(text)
    live = json.loads(text)["benchmarks"][0]
    rows = (("a keyframe's CPU time, last tenth by first", "{:.2f}", live["part9_keyframe_cpu_s"] / live["part0_keyframe_cpu_s"], 1.10),
            ("memory, bytes", "{:.3g}", memory_bytes, 3e9), ("largest CPU time of a scan, s", "{:.4f}", live["cpu_largest_s"], 0.030))
    print_table("", "measured", "at most")
    for name, shape, value, most in rows:
        print_row(name, shape.format(value), shape.format(most))
    return all(value <= most for _, _, value, most in rows)


CAMPUS_SPACING_M = 23778.0 / 60704  # between scans
CAMPUS_KM = (1, 5, 20)
CITY_SIDES = ((125, 2), (250, 4), (500, 4), (1000, 4))  # metres, blocks
AREA_SCANS = 12000


def campus_row(chosen, label, log, scans, folder):
    for mode in ("with loops", "--no-loops"):
        out = chosen.folder / f"{folder}{mode[:2]}"
        kept = out.with_suffix(".json")
        if not kept.exists():
            _, memory_bytes = peak_of(chosen.program, "map", log, "--first", scans, "-o", out, "--force", "--quiet",
                                      *(["--no-loops"] if mode == "--no-loops" else []))
            kept.write_text(json.dumps([memory_bytes, json.loads((out / "report.json").read_text())]))
        memory_bytes, report = json.loads(kept.read_text())
        print_row(label, mode, f"{report['scans']:,}", f"{memory_bytes / 1e6:.0f} MB", f"{report['cpu_s']:.1f} s",
                  f"{1000.0 * report['cpu_s'] / report['scans']:.2f} ms", report.get("tiles", "none"))


def campus(chosen):
    """Maps drives of 1, 5 and 20 km, and 12,000 scans of cities of other sizes, with loops and without."""
    log = city_log(chosen.program, chosen.folder / "campus", 1994.0, 4, 60000, 1)
    print_table("driven", "", "scans", "memory", "CPU time", "a scan", "tiles")
    for km in CAMPUS_KM:
        campus_row(chosen, f"{km} km", log, round(1000 * km / CAMPUS_SPACING_M), f"length_{km}")
    print()
    print_table("side", "", "scans", "memory", "CPU time", "a scan", "tiles")
    for side, blocks in CITY_SIDES:
        log = city_log(chosen.program, chosen.folder / f"side_{side}", float(side), blocks, AREA_SCANS, 1)
        campus_row(chosen, f"{side} m", log, AREA_SCANS, f"area_{side}")
    return True
