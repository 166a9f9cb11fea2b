"""A short drive with a nodding laser in a room that is known in closed form, the log's lines to be edited, and how far the points
of a cloud are from the room."""

import json
import math
import shutil
import struct

import cli_support as cli
from cli_support import command, expect, expect_exit, fresh_folder

SCENE = """gdtslam_scene: 1
name: nodding-room
floor: 0 m
ceiling: 2.4 m
wall_defaults: {thickness: 10 cm, height: 2.4 m}
walls:
  - {points: [[-1.5, -2.0], [4.5, -2.0], [4.5, 2.0], [-1.5, 2.0]], closed: true}
boxes:
  - {centre: [3.9, 1.2], size: [0.5, 0.8], height: 90 cm}
  - {centre: [-0.9, -1.5], size: [0.6, 0.5], height: 120 cm}
robot:
  laser: {preset: hokuyo-961, beams: 241, bearing_step: 1 deg, noise: 5 mm, height: 30 cm}
  nodding: {linkage: paper-b, crank_rate: 0.25 Hz, encoder: {rate: 50 Hz}}
recording: {scan_rate: 20 Hz, odometry_rate: 20 Hz}
waypoints: [[0, 0], {at: [2.4, 0.3], speed: 0.15}]
"""
WALL = 0.05  # half the thickness of a wall
X_WALLS, Y_WALLS, CEILING = (-1.5 + WALL, 4.5 - WALL), (-2.0 + WALL, 2.0 - WALL), 2.4
BOXES = [((3.65, 4.15), (0.8, 1.6), (0.0, 0.9)), ((-1.2, -0.6), (-1.75, -1.25), (0.0, 1.2))]
TICKS_PER_TURN = 20000
SCAN = "ROBOTLASER1"
UNCOVERED = "scans without the crank's position"
FULL = 79000  # points of all scans, about


def kind_of(line):
    return line.split(" ", 1)[0]


def stamp_of(line):
    return float(line.split()[-3])


def with_stamp(line, stamp):
    words = line.split()
    words[-3] = words[-1] = f"{stamp:.6f}"
    return " ".join(words)


def ticks_of(line):
    return int(line.split()[1])


def encoder(line, ticks):
    words = line.split()
    words[1] = str(ticks)
    return " ".join(words)


def scans_between(lines, from_s, to_s):
    """How many scans have some of their beams in that time; a turn of the mirror, 25 ms, takes 16.7 ms for 241 of 360 beams."""
    half = 0.5 * 0.025 * 240 / 360
    stamps = [stamp_of(line) for line in lines if kind_of(line) == SCAN]
    return sum(from_s < stamp + half and to_s > stamp - half for stamp in stamps)


class Drive:
    """The simulated log in a fresh folder, and runs of edited copies of it."""

    def __init__(self, name):
        self.folder = fresh_folder(name)
        (self.folder / "room.yaml").write_text(SCENE)
        process = command("simulate", self.folder / "room.yaml", "-o", self.folder / "room.log", "--seed", 3, "--json")
        if process.returncode == 69:
            cli.skip("the simulator is not built in")
        expect_exit(process, 0)
        self.log = self.folder / "room.log"
        self.linkage = self.folder / "room.linkage.yaml"
        self.lines = self.log.read_text().splitlines()
        self.scans = sum(kind_of(line) == SCAN for line in self.lines)
        rows = [line.split() for line in (self.folder / "room.truth.tum").read_text().splitlines() if line[0] != "#"]
        self.truth = [(float(row[1]), float(row[2]), 2 * math.atan2(float(row[6]), float(row[7]))) for row in rows]

    def write(self, name, lines, linkage=True):
        """A log of these lines with the linkage beside it; returns its path."""
        path = self.folder / f"{name}.log"
        path.write_text("\n".join(lines) + "\n")
        if linkage:
            shutil.copy(self.linkage, self.folder / f"{name}.linkage.yaml")
        return path

    def edited(self, change, kind="ENCODER"):
        """The lines with those of one kind replaced by what `change` makes of them: a line, a list of lines, or None."""
        lines = []
        for line in self.lines:
            made = change(line) if kind_of(line) == kind else line
            lines += made if isinstance(made, list) else [] if made is None else [made]
        return lines

    def map(self, name, lines, *arguments, first_scan=0, **options):
        """Maps these lines with every point kept; returns the Outcome."""
        path = self.write(name, lines, **options)
        process = command("map", path, "-o", self.folder / name, "--force", "--json", "--set", "cloud.voxel=0", *arguments)
        expect_exit(process, 0)
        cli.validate(process.stdout, "report")
        return Outcome(self, self.folder / name, process, first_scan)


class Outcome:
    def __init__(self, drive, folder, process, first_scan=0):
        self.folder = folder
        self.stderr = process.stderr
        self.report = json.loads(process.stdout)
        self.nodding = self.report["nodding"]
        self.warnings = self.report["warnings"]
        self.poses = [tuple(map(float, line.split())) for line in (folder / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
        self.points = points_of(folder / "cloud.ply") if (folder / "cloud.ply").exists() else []
        self.origin = drive.truth[first_scan + self.nodding["dropped"] + self.nodding["before_first_fix"]]

    def scans_with_points(self):
        return {point[5] for point in self.points}

    def off_the_room(self, every=7):
        """Distances of the points to the room's surfaces, in increasing order."""
        x0, y0, theta = self.origin
        cosine, sine = math.cos(theta), math.sin(theta)
        return sorted(distance_to_room(x0 + cosine * x - sine * y, y0 + sine * x + cosine * y, z) for x, y, z, *_ in self.points[::every])

    def expect_right_points(self, at_least, what):
        """Nearly all points lie on the room's surfaces; what is far off sits on the edges of boxes, where the poses' errors show."""
        expect(len(self.points) >= at_least, f"{what}: only {len(self.points)} points")
        off = self.off_the_room()
        middle, most = off[len(off) // 2], off[int(0.98 * len(off))]
        expect(middle < 0.015 and most < 0.05, f"{what}: half the points are {middle:.4f} m off, 98 % of them {most:.4f} m")


def points_of(path):
    """(x, y, z, elevation, time, scan) of each point of a cloud.ply."""
    data = path.read_bytes()
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    return list(struct.iter_unpack("<ffffdI", data[begin:]))


def distance_to_room(x, y, z):
    distances = [abs(x - wall) for wall in X_WALLS] + [abs(y - wall) for wall in Y_WALLS] + [abs(z), abs(z - CEILING)]
    for box in BOXES:
        out = [max(low - v, v - high) for v, (low, high) in zip((x, y, z), box)]
        outside = math.hypot(*(max(d, 0.0) for d in out))
        distances.append(outside if outside > 0.0 else -max(out))
    return min(distances)


def closest(a, b):
    """Largest distance between points of the same place in two clouds of the same beams."""
    expect(len(a) == len(b) and len(a) > 0, f"{len(a)} and {len(b)} points")
    return max(math.dist(p[:3], q[:3]) for p, q in zip(a, b))


def expect_warnings(outcome, expected, what):
    expect(outcome.warnings == expected, f"{what}: the warnings are {outcome.warnings}, expected {expected}")
    for kind in expected:
        expect(f"warning: {kind} (" in outcome.stderr, f"{what}: {outcome.stderr}")


def expect_lost(outcome, drive, lost, what):
    """So many scans have poses and no points, and the rest is right."""
    expect(outcome.nodding["without_nod"] == lost, f"{what}: {outcome.nodding['without_nod']} scans without points, expected {lost}")
    expect(len(outcome.poses) == drive.scans, f"{what}: {len(outcome.poses)} poses of {drive.scans}")
    expect(len(outcome.scans_with_points()) <= drive.scans - lost, f"{what}: points of scans that are not covered")
    outcome.expect_right_points(0.8 * FULL * (drive.scans - lost) / drive.scans, what)
