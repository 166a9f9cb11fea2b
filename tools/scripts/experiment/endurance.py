"""Whether memory and the time of a scan stay what they are however long mapping goes on."""

import itertools
import math
import os
import pathlib
import subprocess
import sys
import threading
import time

from experiment.drives import print_table, run

ROOT = pathlib.Path(__file__).resolve().parents[3]
KINDS = ("live", "no-loops", "follow", "drive", "maps")
SCAN_HZ = 10
SAMPLES = 200
PAGE, TICK = os.sysconf("SC_PAGE_SIZE"), os.sysconf("SC_CLK_TCK")

# Bounds of a long run: docs/reliability.md says what is kept of a scan, a keyframe, a map.
MOST_BYTES_A_SCAN = {"live": 600.0, "no-loops": 700.0, "drive": 5000.0}
MOST_MB_AN_HOUR = {"follow": 1.0}
SETTLED_H = 5.0  # from which on what waits for the end goes to disk, so that less is allowed
MOST_MB_AN_HOUR_SETTLED = {"live": 1.0, "no-loops": 1.0}
MOST_BYTES_A_MAP = 1000.0
MOST_TIMES_SLOWER = {"live": 3.0, "no-loops": 1.5, "follow": 1.5, "drive": 3.0, "maps": 1.5}

HALL = """gdtslam_scene: 1
name: hall
walls:
  - {points: [[0, 0], [24, 0], [24, 16], [0, 16]], closed: true}
  - {points: [[6, 5.5], [18.5, 5.5], [18.5, 10.5], [6, 10.5]], closed: true}
boxes:
  - {centre: [0.5, 7], size: [1, 2], height: 2 m}
  - {centre: [10, 0.3], size: [0.6, 0.6], height: 2 m}
  - {centre: [23.4, 11], size: [1.2, 0.8], height: 2 m, yaw: 20 deg}
  - {centre: [15, 15.5], size: [2, 0.7], height: 2 m}
  - {centre: [4, 15.2], size: [0.5, 1.1], height: 2 m, yaw: 35 deg}
robot:
  laser: {preset: sick-lms, range_resolution: 1 mm, max_range: 30 m, no_return: 81.91 m}
  wheels: {slip: 2 cm, left_scale: 1.005, right_scale: 0.995}
  motion: {speed: 0.5 m/s, acceleration: 1 m/s^2, turn_rate: 60 deg/s, corner_cut: 50 cm}
recording: {scan_rate: %d Hz, odometry_rate: %d Hz}
waypoints:
  - [12, 3]
  - [21, 3]
  - [21, 13]
  - [3, 13]
  - [3, 3]
  - [12, 3]
"""


def times(a, b):
    """The product of two poses (x, y, heading)."""
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], math.remainder(a[2] + b[2], 2.0 * math.pi)


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]


class Lap:
    """A lap whose end is its beginning: (the line up to its ranges, odometry, time) of each scan."""

    def __init__(self, program, folder):
        scene, log = folder / "hall.yaml", folder / "hall.log"
        scene.write_text(HALL % (SCAN_HZ, SCAN_HZ))
        run(program, "simulate", scene, "-o", log, "--force", "--seed", 1, "--quiet")
        self.scans = []
        for line in log.read_text().splitlines():
            word = line.split()
            if word and word[0] == "FLASER":
                beams = int(word[1])
                self.scans.append((" ".join(word[:2 + beams]), tuple(map(float, word[5 + beams:8 + beams])), float(word[8 + beams])))
        odometry = [scan[1] for scan in self.scans]
        self.round = times(odometry[-1], inverse(odometry[0]))
        self.length_m = sum(math.dist(a[:2], b[:2]) for a, b in zip(odometry, odometry[1:]))

    def lines(self, count):
        """`count` scans of as many laps as that takes."""
        before, shift_s = (0.0, 0.0, 0.0), 0.0
        left = count
        while left > 0:
            for text, odometry, stamp_s in itertools.islice(self.scans, left):
                x, y, turn = times(before, odometry)
                at = f"{x:.6f} {y:.6f} {turn:.6f}"
                when = f"{stamp_s + shift_s:.6f}"
                yield f"{text} {at} {at} {when} robot {when}\n".encode()
            left -= len(self.scans)
            before = times(self.round, before)
            shift_s += self.scans[-1][2] - self.scans[0][2] + 1.0 / SCAN_HZ


class Watched:
    """Memory and CPU of a process after so many scans or maps."""

    def __init__(self, pid):
        self.pid, self.samples = pid, []

    def sample(self, done):
        with open(f"/proc/{self.pid}/statm", encoding="ascii") as file:
            pages = int(file.read().split()[1])
        with open(f"/proc/{self.pid}/stat", encoding="ascii") as file:
            field = file.read().rsplit(")", 1)[1].split()
        self.samples.append((done, pages * PAGE, (int(field[11]) + int(field[12])) / TICK))

    def growth(self):
        """Bytes a scan, by the second half."""
        half = self.samples[len(self.samples) // 2:]
        mean_x = sum(s[0] for s in half) / len(half)
        mean_y = sum(s[1] for s in half) / len(half)
        return sum((s[0] - mean_x) * (s[1] - mean_y) for s in half) / sum((s[0] - mean_x) ** 2 for s in half)

    def cpu_s(self, first, last):
        """Of one scan, between these shares of all of them."""
        a, b = (self.samples[min(int(share * len(self.samples)), len(self.samples) - 1)] for share in (first, last))
        return (b[2] - a[2]) / (b[0] - a[0])

    def peak(self):
        return max(s[1] for s in self.samples)


def fed(command, lap, scans):
    """Gives the scans to a process and looks at it meanwhile; its figures, seconds after the last scan and largest memory."""
    process = subprocess.Popen([str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    said = []
    readers = [threading.Thread(target=lambda: [None for _ in iter(lambda: process.stdout.read(1 << 16), b"")]),
               threading.Thread(target=lambda: said.append(process.stderr.read()))]
    for reader in readers:
        reader.start()
    watched, step = Watched(process.pid), max(scans // SAMPLES, 1)
    try:
        for k, line in enumerate(lap.lines(scans), 1):
            process.stdin.write(line)
            if k % step == 0:
                watched.sample(k)
        process.stdin.close()
    except BrokenPipeError:
        pass
    ended = time.monotonic()
    status, usage = os.wait4(process.pid, 0)[1:]
    process.returncode = os.waitstatus_to_exitcode(status)
    for reader in readers:
        reader.join()
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {process.returncode}: {said[0].decode().strip()}")
    return watched, time.monotonic() - ended, 1024 * usage.ru_maxrss


def mapped_again(program, lap, folder, count, scans):
    """The library beside the program makes the same map so often, in this process."""
    beside = sorted(program.resolve().parents[1].glob("lib/**/libgdtslam.so.0"))
    if beside:
        os.environ.setdefault("GDTSLAM_LIBRARY", str(beside[0]))
    sys.path.insert(0, str(ROOT / "python"))
    try:
        import gdtslam  # pylint: disable=import-outside-toplevel
    except ModuleNotFoundError as error:
        sys.exit(f"endurance: this Python has no {error.name}; run it with one that has, on Debian /usr/bin/python3 with python3-numpy")
    log = folder / "short.log"
    log.write_bytes(b"".join(lap.lines(scans)))
    watched, step = Watched(os.getpid()), max(count // SAMPLES, 1)
    for k in range(1, count + 1):
        gdtslam.map(log, out=folder / "again", pictures=False)
        if k % step == 0:
            watched.sample(k)
    return watched


def maps_line(program, lap, folder, count, scans):
    watched = mapped_again(program, lap, folder, count, scans)
    first, last = watched.cpu_s(0.0, 0.25), watched.cpu_s(0.75, 1.0)
    growth = watched.growth()
    row = (f"| maps | {count:,} maps of {scans} scans | | {watched.peak() / 1e6:.0f} MB | {growth:.0f} bytes a map | "
           f"{1e3 * first:.1f}, {1e3 * last:.1f} ms a map | |")
    return row, [("bytes a map", growth, MOST_BYTES_A_MAP), ("CPU of the last quarter to the first", last / first, MOST_TIMES_SLOWER["maps"])]


def endurance_line(kind, program, lap, folder, scans):
    """A row of the table, and (what, measured, most)."""
    out = folder / f"run-{kind}"
    options = {"live": ["live", "-", "-q", "-o", out, "--force"], "no-loops": ["live", "-", "-q", "--no-loops", "-o", out, "--force"],
               "follow": ["live", "-", "-q", "--map", folder / "known"],
               "drive": ["map", "-", "-q", "--no-pictures", "-o", out, "--force"]}[kind]
    if kind == "follow":
        known = folder / "known.log"
        known.write_bytes(b"".join(lap.lines(len(lap.scans))))
        run(program, "map", known, "-o", folder / "known", "--force", "-q")
    watched, closing_s, peak = fed([program, *options], lap, scans)
    hours = scans / SCAN_HZ / 3600
    first, last = watched.cpu_s(0.0, 0.25), watched.cpu_s(0.75, 1.0)
    mb_an_hour = watched.growth() * SCAN_HZ * 3600 / 1e6
    row = (f"| {kind} | {scans:,} scans, {lap.length_m * scans / len(lap.scans) / 1000:.2f} km | {hours:.2f} h | "
           f"{watched.peak() / 1e6:.0f} MB, {peak / 1e6:.0f} at its end | {mb_an_hour:.2f} MB an hour, {watched.growth():.0f} bytes a scan | "
           f"{1e6 * first:.0f}, {1e6 * last:.0f} us a scan | {closing_s:.1f} s |")
    bounds = [("CPU of the last quarter to the first", last / first, MOST_TIMES_SLOWER[kind])]
    if kind in MOST_MB_AN_HOUR:
        bounds.append(("MB an hour", mb_an_hour, MOST_MB_AN_HOUR[kind]))
    if kind in MOST_MB_AN_HOUR_SETTLED and hours >= SETTLED_H:
        bounds.append(("MB an hour", mb_an_hour, MOST_MB_AN_HOUR_SETTLED[kind]))
    elif kind in MOST_BYTES_A_SCAN:
        bounds.append(("bytes a scan", watched.growth(), MOST_BYTES_A_SCAN[kind]))
    return row, bounds


def endurance(chosen):
    """A lap of a hall is driven again and again, the wheels going on, as fast as the program takes it, for --hours of the robot.
    KINDs: live with loops, no-loops, follow a map that was made before, drive --scans through `map -`, and --maps made one after
    the other in one process by the library. Memory is that which the process holds, its growth the slope over the second half.
    CPU is that of all threads, in the first and the last quarter."""
    beyond = []
    lap = Lap(chosen.program, chosen.folder)
    print_table("kind", "of", "robot's time", "memory", "growth", "CPU, first and last quarter", "closing")
    for kind in chosen.kinds or KINDS:
        if kind == "maps":
            row, bounds = maps_line(chosen.program, lap, chosen.folder, chosen.maps, chosen.map_scans)
        else:
            scans = chosen.scans if kind == "drive" else int(chosen.hours * 3600 * SCAN_HZ)
            row, bounds = endurance_line(kind, chosen.program, lap, chosen.folder, scans)
        print(row, flush=True)
        beyond += [f"{kind}: {what}: {value:.3g}, at most {most:g}" for what, value, most in bounds if value > most]
    if beyond:
        print("beyond the bounds: " + "; ".join(beyond), file=sys.stderr)
    return not beyond
