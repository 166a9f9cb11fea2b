"""A nodding laser as simulated, one whose encoder ends, and one that tells its elevation (docs/formats.md, ENCODER and TILT)."""

import math

from cli_support import command, expect, expect_exit, one_error_line
from nodding_log import TICKS_PER_TURN, UNCOVERED, Drive, closest, encoder, expect_lost, expect_warnings, kind_of, scans_between, stamp_of, ticks_of


def nodding_as_simulated():
    """Nothing is wrong: no warning, every scan placed, points on the room's surfaces."""
    drive = Drive("nodding_as_simulated")
    outcome = drive.map("plain", drive.lines)
    expect(outcome.stderr == "", outcome.stderr)
    expect_warnings(outcome, {}, "plain")
    nodding = outcome.nodding
    expect(nodding["fixes"] + nodding["between"] + nodding["by_odometry"] == drive.scans, f"{nodding}")
    expect(nodding["told_by"] == "ENCODER" and nodding["cloud"]["written"] == len(outcome.points), f"{nodding}")
    expect_lost(outcome, drive, 0, "plain")
    last, truth = outcome.poses[-1], drive.truth[-1]
    expect(abs(math.hypot(last[1], last[2]) - math.hypot(truth[0], truth[1])) < 0.03, "the last pose is off")


def nodding_encoder_ends():
    """The messages end: what comes after has poses by odometry and no points."""
    drive = Drive("nodding_encoder_ends")
    lines = drive.edited(lambda line: line if stamp_of(line) <= 8.0 else None)
    outcome = drive.map("ends", lines)
    lost = scans_between(lines, 8.0, 1e9)
    expect_lost(outcome, drive, lost, "ends")
    expect_warnings(outcome, {UNCOVERED: lost}, "ends")
    expect(max(outcome.scans_with_points()) < drive.scans - lost, "points of scans after the end")
    expect(outcome.nodding["by_odometry"] >= lost, f"{outcome.nodding}")


def nodding_tilt():
    """A laser that tells its elevation itself: the same cloud as the crank gives, within what interpolating the angle costs."""
    drive = Drive("nodding_tilt")
    plain = drive.map("plain", drive.lines)
    angle = elevation_of(drive.linkage.read_text())
    tilt = drive.edited(lambda line: f"TILT {angle(ticks_of(line)):.9f} {stamp_of(line):.6f} robot 0")
    outcome = drive.map("tilt", tilt)
    expect(outcome.nodding["told_by"] == "TILT", f"{outcome.nodding}")
    expect_warnings(outcome, {}, "tilt")
    apart = closest(outcome.points, plain.points)
    expect(apart < 0.02, f"{apart} m apart")
    lines = [line for line in tilt if kind_of(line) != "TILT" or not 5.0 <= stamp_of(line) < 6.0]
    outcome = drive.map("missing", lines)
    lost = scans_between(lines, 4.98, 6.0)
    expect_lost(outcome, drive, lost, "messages missing")
    expect_warnings(outcome, {"nodding messages missing": 1, UNCOVERED: lost}, "messages missing")
    outcome = drive.map("ends", [line for line in tilt if kind_of(line) != "TILT" or stamp_of(line) <= 8.0])
    lost = scans_between(tilt, 8.0, 1e9)
    expect_lost(outcome, drive, lost, "ends")
    at = next(k for k, line in enumerate(tilt) if kind_of(line) == "TILT" and stamp_of(line) >= 6.0)
    for value, warnings in (("3.0", {"nodding jumps": 2, UNCOVERED: 1}), ("nan", None), ("high", None)):
        lines = list(tilt)
        lines[at] = encoder(lines[at], value)
        if warnings is not None:
            expect_warnings(drive.map("wild", lines), warnings, f"TILT {value}")
            continue
        process = command("map", drive.write("garbage", lines), "-o", drive.folder / "garbage")
        expect_exit(process, 65)
        one_error_line(process.stderr)
        expect(f"garbage.log:{at + 1}: " in process.stderr, process.stderr)


def elevation_of(linkage):
    """Ticks to elevation in radians, from the point where two circles meet; positive lifts."""
    value = {key: float(linkage.split(f"  {key}: ")[1].split()[0]) for key in ("crank", "coupler", "rocker", "ground", "zero", "offset")}

    def of(ticks):
        crank = value["zero"] + 2 * math.pi * ticks / TICKS_PER_TURN
        ax, ay = value["crank"] * math.cos(crank), value["crank"] * math.sin(crank)
        dx, dy = value["ground"] - ax, -ay
        distance = math.hypot(dx, dy)
        along = (distance**2 + value["coupler"] ** 2 - value["rocker"] ** 2) / (2 * distance)
        across = math.sqrt(value["coupler"] ** 2 - along**2)
        bx, by = ax + (along * dx - across * dy) / distance, ay + (along * dy + across * dx) / distance
        return math.atan2(by, bx - value["ground"]) + value["offset"]

    return of
