"""An encoder that stops, jumps, runs backwards, wraps or falls silent: one stated outcome each (docs/formats.md, ENCODER and TILT)."""

import math

from cli_support import command, expect, expect_exit, one_error_line
from nodding_log import APART, FULL, TICKS_PER_TURN, UNCOVERED, Drive, closest, encoder, expect_lost, expect_warnings, kind_of, scans_between, stamp_of
from nodding_log import ticks_of, with_stamp


def first_after(drive, stamp_s):
    """The first ENCODER line from then on."""
    return next(line for line in drive.lines if kind_of(line) == "ENCODER" and stamp_of(line) >= stamp_s)


def cloud_digest(outcome):
    return outcome.nodding["cloud"]["sha256"]


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


def nodding_encoder_stands():
    """A counter that stands while messages come is a crank that stands: used as measured; that it jumps on afterwards is counted."""
    drive = Drive("nodding_encoder_stands")
    stuck = ticks_of(first_after(drive, 5.0))
    outcome = drive.map("stands", drive.edited(lambda line: encoder(line, stuck) if 5.0 <= stamp_of(line) < 6.0 else line))
    elevations = {round(point[3], 6) for point in outcome.points if 5.05 < point[4] < 5.95}
    expect(len(elevations) == 1, f"elevations while it stands: {sorted(elevations)[:5]}")
    expect(outcome.warnings.pop("nodding jumps") == 1, f"{outcome.warnings}")
    expect(outcome.warnings.pop(UNCOVERED, 0) == outcome.nodding["without_nod"] <= 1 and not outcome.warnings, f"{outcome.warnings}")


def nodding_encoder_jumps():
    """The scans between the two messages are lost, those before and after are not; one wild message loses both sides.
    Without loops what comes before does not know what comes after; with them the path is adjusted as a whole."""
    drive = Drive("nodding_encoder_jumps")
    plain = drive.map("plain", drive.lines, "--no-loops")
    wild = first_after(drive, 6.0)
    at = stamp_of(wild)
    outcome = drive.map("wild", drive.edited(lambda line: encoder(line, ticks_of(line) + 9000) if line == wild else line))
    lost = scans_between(drive.lines, at - 0.02, at + 0.02)
    expect(lost > 0, "no scan lies there")
    expect_lost(outcome, drive, lost, "wild")
    expect_warnings(outcome, {"nodding jumps": 2, UNCOVERED: lost}, "wild")
    # The counter is 45 deg off for four seconds: nobody can tell, but the two jumps are counted.
    outcome = drive.map("off", drive.edited(lambda line: encoder(line, (ticks_of(line) + 2500) % TICKS_PER_TURN) if at <= stamp_of(line) < 10.0 else line), "--no-loops")
    lost = scans_between(drive.lines, at - 0.02, at) + scans_between(drive.lines, 9.98, 10.0)
    expect(outcome.nodding["without_nod"] == lost, f"off: {outcome.nodding}")
    expect_warnings(outcome, {"nodding jumps": 2, APART: 1, **({UNCOVERED: lost} if lost else {})}, "off")
    before = [[p for p in points if p[4] < 4.0] for points in (outcome.points, plain.points)]
    expect(closest(*before) < 1e-6, "what comes before has moved")


def nodding_encoder_runs_backwards():
    """Used as measured and counted: a counter of the other sign, with the linkage's direction turned, gives the same cloud."""
    drive = Drive("nodding_encoder_runs_backwards")
    plain = drive.map("plain", drive.lines)
    path = drive.folder / "turned.yaml"
    path.write_text(drive.linkage.read_text().replace("direction: 1", "direction: -1"))
    outcome = drive.map("backwards", drive.edited(lambda line: encoder(line, -ticks_of(line) % TICKS_PER_TURN)), "--linkage", path)
    messages = sum(kind_of(line) == "ENCODER" for line in drive.lines)
    expect_warnings(outcome, {"nodding runs backwards": messages - 1}, "backwards")
    expect(closest(outcome.points, plain.points) < 1e-3, "another cloud")
    start = ticks_of(first_after(drive, 6.0))
    some = drive.edited(lambda line: encoder(line, (2 * start - ticks_of(line)) % TICKS_PER_TURN) if 6.0 <= stamp_of(line) < 6.5 else line)
    outcome = drive.map("some", some)
    expect(outcome.warnings["nodding runs backwards"] == 24 and outcome.warnings["nodding jumps"] == 1, f"{outcome.warnings}")


def nodding_encoder_wraps():
    """The counter that starts again at the index mark and the one that counts on give the same cloud, byte for byte."""
    drive = Drive("nodding_encoder_wraps")
    plain = drive.map("plain", drive.lines)
    ticks = [ticks_of(line) for line in drive.lines if kind_of(line) == "ENCODER"]
    wraps = sum(after < before for before, after in zip(ticks, ticks[1:]))
    expect(wraps == 4 and ticks[:3] == [0, 100, 200], f"{wraps} turns")

    def counting_from(start):
        counts = iter(range(start, start + 100 * len(ticks), 100))
        return drive.edited(lambda line: encoder(line, next(counts)))

    no_index = drive.folder / "no-index.yaml"
    no_index.write_text(drive.linkage.read_text().replace("wraps: true", "wraps: false"))
    for start, linkage in ((0, drive.linkage), (0, no_index), (-100_000, drive.linkage), (-100_000, no_index), (4 * 10**14 * TICKS_PER_TURN, no_index)):
        outcome = drive.map("on", counting_from(start), "--linkage", linkage)
        expect_warnings(outcome, {}, f"from {start}")
        expect(cloud_digest(outcome) == cloud_digest(plain), f"from {start}, {linkage.name}: another cloud")
    # A linkage file that denies the index mark: each fall of the counter is a jump.
    outcome = drive.map("denied", drive.lines, "--linkage", no_index)
    expect(outcome.warnings["nodding jumps"] == wraps, f"{outcome.warnings}")
    lost = sum(scans_between(drive.lines, 4.0 * k - 0.02, 4.0 * k) for k in range(1, wraps + 1))
    expect_lost(outcome, drive, lost, "denied")


def nodding_encoder_messages_missing():
    """Nothing for a second: those scans are lost, counted once. Less than the limit of 0.25 s: nothing is lost."""
    drive = Drive("nodding_encoder_messages_missing")
    lines = drive.edited(lambda line: None if 5.0 <= stamp_of(line) < 6.0 else line)
    outcome = drive.map("second", lines)
    lost = scans_between(lines, 4.98, 6.0)
    expect(lost > 15, f"{lost} scans lie there")
    expect_lost(outcome, drive, lost, "second")
    expect_warnings(outcome, {"nodding messages missing": 1, UNCOVERED: lost}, "second")
    outcome = drive.map("short", drive.edited(lambda line: None if 5.0 <= stamp_of(line) < 5.22 else line))
    expect_lost(outcome, drive, 0, "short")
    expect_warnings(outcome, {}, "short")


def nodding_stamps_step_back():
    """A stamp in the past or repeated drops the message; one far ahead, and a clock that is set back, cost what lies around."""
    drive = Drive("nodding_stamps_step_back")
    plain = drive.map("plain", drive.lines)
    late = first_after(drive, 6.0)
    outcome = drive.map("late", drive.edited(lambda line: with_stamp(line, stamp_of(line) - 0.5) if line == late else line))
    expect_lost(outcome, drive, 0, "late")
    expect_warnings(outcome, {"nodding stamp in the past": 1}, "late")
    outcome = drive.map("twice", drive.edited(lambda line: [line, line]))
    expect_warnings(outcome, {"nodding stamp in the past": sum(kind_of(line) == "ENCODER" for line in drive.lines)}, "twice")
    expect(cloud_digest(outcome) == cloud_digest(plain), "twice: another cloud")
    for ahead in (3.0, 1e9):
        outcome = drive.map("ahead", drive.edited(lambda line: with_stamp(line, stamp_of(line) + ahead) if line == late else line))
        expect(0 < outcome.warnings[UNCOVERED] <= 6, f"ahead by {ahead}: {outcome.warnings}")
        expect(outcome.warnings["nodding stamp in the past"] == 1, f"ahead by {ahead}: {outcome.warnings}")
        expect_lost(outcome, drive, outcome.warnings[UNCOVERED], f"ahead by {ahead}")
    for back in (0.1, 5.0, 1000.0):
        outcome = drive.map("set-back", [line if kind_of(line) == "PARAM" or stamp_of(line) < 8.0 else with_stamp(line, stamp_of(line) - back) for line in drive.lines])
        lost = outcome.warnings.pop(UNCOVERED, 0)
        expect(lost <= 2, f"set back by {back}: {lost} scans lost")
        expect_warnings(outcome, {"backward stamp": 1, "nodding stamp in the past": 1}, f"set back by {back}")
        expect_lost(outcome, drive, lost, f"set back by {back}")
    scan = next(k for k, line in enumerate(drive.lines) if kind_of(line) == "ROBOTLASER1" and stamp_of(line) > 6.0)
    lines = list(drive.lines)
    lines[scan] = with_stamp(lines[scan], 1e6)  # a scan far ahead: alone without points
    outcome = drive.map("scan-ahead", lines)
    expect_lost(outcome, drive, 1, "a scan far ahead")
    expect_warnings(outcome, {"backward stamp": 1, UNCOVERED: 1}, "a scan far ahead")


def nodding_messages_before_and_after():
    """Messages up to a second before or after their scans in the log change nothing; two seconds after they come too late."""
    drive = Drive("nodding_messages_before_and_after")
    plain = drive.map("plain", drive.lines)

    def moved(shift_s):
        """The log with its ENCODER lines so much later in the file; their stamps stay."""
        keyed = [(stamp_of(line) + (shift_s if kind_of(line) == "ENCODER" else 0.0), k, line) for k, line in enumerate(drive.lines)]
        return [line for _, _, line in sorted(keyed)]

    for shift_s in (-1.0, 0.5, 0.9):
        outcome = drive.map("moved", moved(shift_s))
        expect_warnings(outcome, {}, f"moved by {shift_s} s")
        expect(cloud_digest(outcome) == cloud_digest(plain), f"moved by {shift_s} s: another cloud")
    # All but the scans of the log's last second are lost: a horizontal one among them or not decides.
    process = command("map", drive.write("late", moved(2.0)), "-o", drive.folder / "late", "--json")
    expect_exit(process, 0)
    expect(f"warning: {UNCOVERED} (3" in process.stderr and "scan 0 at " in process.stderr, process.stderr)
    path = drive.write("later", [line for line in moved(2.0) if kind_of(line) == "PARAM" or stamp_of(line) < 15.0])
    process = command("map", path, "-o", drive.folder / "later")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("later.log: no scan " in process.stderr, process.stderr)
    expect(not (drive.folder / "later").exists(), "a folder was left")


def nodding_garbage_fields():
    """A count that is no number, or beyond 64 bits: file and line, exit 65; with --lenient the message is left out."""
    drive = Drive("nodding_garbage_fields")
    number = drive.lines.index(first_after(drive, 6.0))
    for ticks in ("nan", "inf", "12.5", "0x10", "9223372036854775808", "-9223372036854775809", "1e3", ""):
        lines = list(drive.lines)
        lines[number] = encoder(lines[number], ticks)
        process = command("map", drive.write("garbage", lines), "-o", drive.folder / "garbage")
        expect_exit(process, 65)
        one_error_line(process.stderr)
        expect(f"garbage.log:{number + 1}: " in process.stderr and "--lenient" in process.stderr, process.stderr)
        outcome = drive.map("lenient", lines, "--lenient")
        expect_lost(outcome, drive, 0, f"ticks {ticks!r}")
        expect_warnings(outcome, {"malformed line": 1}, f"ticks {ticks!r}")
    no_index = drive.folder / "no-index.yaml"
    no_index.write_text(drive.linkage.read_text().replace("wraps: true", "wraps: false"))
    counts = [100 * k for k in range(sum(kind_of(line) == "ENCODER" for line in drive.lines))]
    for ticks in ("9223372036854775807", "-9223372036854775808"):  # a jump there and back
        at = sum(kind_of(line) == "ENCODER" for line in drive.lines[:number])
        far = iter([*counts[:at], ticks, *counts[at + 1:]])
        outcome = drive.map("far", drive.edited(lambda line: encoder(line, next(far))), "--linkage", no_index)
        lost = scans_between(drive.lines, stamp_of(drive.lines[number]) - 0.02, stamp_of(drive.lines[number]) + 0.02)
        expect_lost(outcome, drive, lost, ticks)
        expect_warnings(outcome, {"nodding jumps": 2, APART: 1, UNCOVERED: lost}, ticks)  # 100 ticks a message is no drive of this mount


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
