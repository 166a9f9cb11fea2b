"""Drives followed in a map that stays."""

import csv
import gzip
import json
import math

from experiment.common import printed, times, inverse, stamped_poses
from long_drives import run

PLACE_NEAR_M = 1.0
SAME_WAY_RAD = math.radians(45.0)
WITHIN_M = 0.1
WITHIN_RAD = math.radians(1.0)
STARTS = 10
CARRIED = 5
JUMP = 500  # scans


def turned(a, b):
    return abs((a - b + math.pi) % (2.0 * math.pi) - math.pi)


class Passed:
    """Poses by place, to find the nearest that looks the same way, else the nearest."""

    def __init__(self, poses):
        self.poses, self.cells = poses, {}
        for k, pose in enumerate(poses):
            self.cells.setdefault((math.floor(pose[0]), math.floor(pose[1])), []).append(k)

    def nearest(self, pose):
        """(index, whether it is near and looks the same way)"""
        x, y = math.floor(pose[0]), math.floor(pose[1])
        near = [k for i in (-1, 0, 1) for j in (-1, 0, 1) for k in self.cells.get((x + i, y + j), ())]
        near = [k for k in near if math.dist(self.poses[k][:2], pose[:2]) <= PLACE_NEAR_M]
        alike = [k for k in near if turned(self.poses[k][2], pose[2]) <= SAME_WAY_RAD]
        return min(alike or near or range(len(self.poses)), key=lambda k: math.dist(self.poses[k][:2], pose[:2])), bool(alike)


def mapped(program, log, folder, *arguments):
    if not (folder / "trajectory.tum").exists():
        run(program, "map", log, "-o", folder, "--force", "-q", *arguments)
    return stamped_poses(folder / "trajectory.tum")


def tracked(program, map_folder, log, table, *arguments):
    report = json.loads(printed(program, "localize", map_folder, log, "--track", "--json", "--table", table, *arguments))
    with open(table, newline="", encoding="ascii") as file:
        return report, list(csv.DictReader(file))


def is_right(row, pose):
    return (row["whereabouts"] != "unknown" and math.hypot(float(row["x_m"]) - pose[0], float(row["y_m"]) - pose[1]) <= WITHIN_M
            and turned(float(row["theta_rad"]), pose[2]) <= WITHIN_RAD)


def second_half(program, log, folder):
    whole = mapped(program, log, folder / "whole")
    half = mapped(program, log, folder / "half", "--first", len(whole) // 2)
    passed = Passed([pose for _, pose in whole[:len(half)]])
    places, are_mapped = [], []
    for stamp, pose in whole[len(half):]:
        near, is_mapped = passed.nearest(pose)
        places.append((stamp, times(times(half[near][1], inverse(whole[near][1])), pose)))
        are_mapped.append(is_mapped)
    report, rows = tracked(program, folder / "half", log, folder / "half.csv", "--scan", len(half))
    right = [is_right(row, pose) for row, (_, pose) in zip(rows, places, strict=True)]
    count = sum(are_mapped)
    share = sum(r and m for r, m in zip(right, are_mapped, strict=True)) / max(count, 1)
    said = [row["whereabouts"] == "tracked" for row in rows]
    believed = sum(s and m for s, m in zip(said, are_mapped, strict=True))
    correct = sum(s and m and r for s, m, r in zip(said, are_mapped, right, strict=True))
    print(f"| {folder.name}, second half in the map of the first | {count} of {len(rows)} | {100 * share:.1f} % | "
          f"{100 * correct / max(believed, 1):.1f} % of {believed} | {1e3 * report['times']['wall_s'] / len(rows):.1f} ms a scan, {report['searches']} searches |")
    return whole


def until_right(rows, poses):
    """Scans, and seconds by the log, until the first that is right and of which the place is not ambiguous."""
    for k, (row, (stamp, pose)) in enumerate(zip(rows, poses, strict=True)):
        if is_right(row, pose):
            return k, stamp - poses[0][0]
    return None


def starts(program, log, folder, whole):
    found = []
    for k in range(STARTS):
        first = k * len(whole) // STARTS
        _, rows = tracked(program, folder / "whole", log, folder / "start.csv", "--scan", first)
        found.append(until_right(rows, whole[first:]))
    seconds = sorted(f[1] for f in found if f is not None)
    print(f"| {folder.name}, {STARTS} starts in the whole map | found {len(seconds)}, median {seconds[len(seconds) // 2]:.1f} s, at most {seconds[-1]:.1f} s |")


def carried_lines(lines, cuts):
    """Without the scans of the cuts, and odometry that knows nothing of the ways between."""
    scans, before, moved, was_cut = 0, None, (0.0, 0.0, 0.0), False
    for line in lines:
        words = line.split()
        if not words or words[0] not in ("ODOM", "FLASER"):
            yield line
            continue
        places = [1] if words[0] == "ODOM" else [2 + int(words[1]), 5 + int(words[1])]
        pose = tuple(map(float, words[places[-1]:places[-1] + 3]))
        is_cut = any(first <= scans < first + JUMP for first in cuts)
        scans += words[0] == "FLASER"
        if is_cut or (was_cut and words[0] == "ODOM"):
            was_cut = True
            continue
        if was_cut:
            moved, was_cut = times(before, inverse(pose)), False
        before = times(moved, pose)
        for at in places:
            words[at:at + 3] = [f"{value:.6f}" for value in times(moved, tuple(map(float, words[at:at + 3])))]
        yield " ".join(words) + "\n"


def carried(program, log, folder, whole):
    cuts = [(k + 1) * len(whole) // (CARRIED + 1) for k in range(CARRIED)]
    jump = min(JUMP, len(whole) // (CARRIED + 1) - 1)
    cuts = [first for first in cuts if jump == JUMP]
    if not cuts:
        cuts = [len(whole) // 2]
    with (gzip.open(log, "rt", encoding="latin-1") if log.suffix == ".gz" else open(log, encoding="latin-1")) as file:
        (folder / "carried.log").write_text("".join(carried_lines(file, cuts)), encoding="latin-1")
    kept = [row for k, row in enumerate(whole) if not any(first <= k < first + JUMP for first in cuts)]
    _, rows = tracked(program, folder / "whole", folder / "carried.log", folder / "carried.csv")
    found = []
    for k, first in enumerate(cuts):
        begin = first - k * JUMP
        found.append(until_right(rows[begin:], kept[begin:]))
    words = ", ".join("never" if f is None else f"{f[0]} scans ({f[1]:.1f} s)" for f in found)
    wrong = sum(row["whereabouts"] == "tracked" and math.hypot(float(row["x_m"]) - pose[0], float(row["y_m"]) - pose[1]) > 1.0
                for row, (_, pose) in zip(rows, kept, strict=True))
    print(f"| {folder.name}, carried away {len(cuts)} times | right again after {words}; tracked elsewhere: {wrong} scans |")


def tracking(chosen):
    """Each log (CARMEN, plain or gzip) is mapped whole, and its first half alone. The second half is followed in the map of the
    first; the whole log in the whole map, from starts in different places, and carried away five times. Both maps have the scans
    of the first half, each in its own frame, so a scan's place is taken from the nearest of them:
    T_half(near) T_whole(near)^-1 T_whole(scan). A place is mapped where the first half passed within a metre looking the same
    way within 45 degrees."""
    for log in chosen.logs:
        folder = chosen.folder / log.name.split(".")[0]
        folder.mkdir(parents=True, exist_ok=True)
        whole = second_half(chosen.program, log, folder)
        starts(chosen.program, log, folder, whole)
        carried(chosen.program, log, folder, whole)
    return True
