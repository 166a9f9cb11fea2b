"""Runs in 3D from the outside: parts of logs, pipes, interrupts, options of the cloud, a full disk, linkage files that are wrong."""

import math
import re
import signal
import subprocess
import time

import cli_support as cli
from cli_support import PROGRAM, command, digests, expect, expect_exit, finish, one_error_line, skip
from nodding_log import FULL, SCAN, UNCOVERED, Drive, encoder, expect_lost, expect_warnings, kind_of, points_of, stamp_of, with_stamp


def nodding_logs_in_sequence():
    """Two logs one after the other are one: also where the second has a clock of its own."""
    drive = Drive("nodding_logs_in_sequence")
    first = [line for line in drive.lines if kind_of(line) == "PARAM" or stamp_of(line) < 8.21]
    second = [line for line in drive.lines if kind_of(line) == "PARAM" or stamp_of(line) >= 8.21]
    for name, shift_s in (("same-clock", 0.0), ("own-clock", -8.2), ("later-clock", 5000.0)):
        path = drive.write("b", [line if kind_of(line) == "PARAM" else with_stamp(line, stamp_of(line) + shift_s) for line in second])
        outcome = drive.map(name, first, path)
        lost = outcome.warnings.get(UNCOVERED, 0)
        expect(lost <= 2, f"{name}: {outcome.warnings}")
        expect_warnings(outcome, {UNCOVERED: lost} if lost else {}, name)
        expect_lost(outcome, drive, lost, name)


def nodding_part_of_a_log():
    """--skip and --first leave scans out, not what tells their elevation."""
    drive = Drive("nodding_part_of_a_log")
    plain = drive.map("plain", drive.lines)
    outcome = drive.map("part", drive.lines, "--skip", 70, "--first", 170, first_scan=70)
    expect(len(outcome.poses) == 170, f"{len(outcome.poses)} poses")
    expect_warnings(outcome, {}, "part")
    outcome.expect_right_points(0.8 * FULL * 170 / drive.scans, "part")
    elevations = {round(p[4], 5): p[3] for p in plain.points}
    for point in outcome.points[::53]:
        expect(abs(point[3] - elevations[round(point[4], 5)]) < 1e-6, f"elevation at {point[4]} s")
    process = command("map", drive.log, "-o", drive.folder / "none", "--skip", 9999)
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect(f"room.log: --skip 9999 leaves none of its {drive.scans} scans" in process.stderr, process.stderr)


def nodding_standard_input():
    """The same cloud from standard input; without --linkage the preset with a warning."""
    drive = Drive("nodding_standard_input")
    plain = drive.map("plain", drive.lines)
    for arguments in (("--linkage", drive.linkage), ()):
        process = command("map", "-", "-o", drive.folder / "run", "--force", "--json", "--set", "cloud.voxel=0", *arguments, input=drive.log.read_text())
        expect_exit(process, 0)
        cli.validate(process.stdout, "report")
        expect(points_of(drive.folder / "run/cloud.ply") == plain.points, "another cloud")
        if arguments:
            expect(process.stderr == "", process.stderr)
        else:
            lines = process.stderr.splitlines()
            expect(len(lines) == 1 and lines[0].startswith("gdtslam: warning: the laser nods and no --linkage is given: "), process.stderr)
            expect("paper-b" in lines[0], process.stderr)


def interrupted_run(drive, lines):
    """Maps these lines from a pipe that stays open, with SIGINT when they have been read; returns the process."""
    process = subprocess.Popen([PROGRAM, "map", "-", "--linkage", drive.linkage, "-o", drive.folder / "run"], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdin.write("\n".join(lines) + "\n")
    process.stdin.flush()
    time.sleep(2.0)
    expect(process.poll() is None, "the command did not wait for more input")
    process.send_signal(signal.SIGINT)
    return finish(process)


def nodding_interrupt():
    """SIGINT in the middle: the cloud of what came is written, exit 130; before a scan could be placed nothing is."""
    drive = Drive("nodding_interrupt")
    run = drive.folder / "run"
    process = interrupted_run(drive, [line for line in drive.lines if kind_of(line) == "PARAM" or 1.0 < stamp_of(line) < 2.0])
    expect_exit(process, 130)
    one_error_line(process.stderr)
    expect("nothing is written" in process.stderr and not run.exists(), process.stderr)
    lines = [line for line in drive.lines if kind_of(line) == "PARAM" or stamp_of(line) < 8.0]
    process = interrupted_run(drive, lines)
    expect_exit(process, 130)
    report = cli.scans_in(run)
    expect(sorted(digests(run)) == sorted([*cli.PLAIN_NODDING_OUTPUTS, "cloud.ply", "log-1.jsonl.zst"]), "files are missing")
    points = points_of(run / "cloud.ply")
    expect(report["interrupted"] is True and report["cloud_points"] == len(points) > 10000, f"{report['cloud_points']} points")
    poses = [line for line in (run / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    scans = sum(kind_of(line) == SCAN for line in lines)
    expect(f"interrupted after {len(poses)} scans" in process.stderr, process.stderr)
    expect(scans - 2 <= len(poses) <= scans, f"{len(poses)} poses of {scans} scans")


def nodding_closes_loops():
    """The path's loops are closed and the sweeps follow it: the files and the report of a run with loops, one covariance a scan, the same
    bytes with one thread; --no-loops leaves all that out."""
    drive = Drive("nodding_closes_loops")
    outcome = drive.map("closed", drive.lines)
    expect(sorted(digests(outcome.folder)) == cli.CLOUD_OUTPUTS, f"{sorted(digests(outcome.folder))}")
    expect(len(outcome.poses) == outcome.report["scans"] == drive.scans, f"{len(outcome.poses)} poses")
    expect({"loops", "wheels", "uncertain"} <= set(outcome.report), f"{sorted(outcome.report)}")
    rows = [line for line in (outcome.folder / "covariance.csv").read_text().splitlines() if line[0].isdigit()]
    expect(len(rows) == drive.scans, f"{len(rows)} covariances of {drive.scans} scans")
    expect(max(outcome.report["keyframe_scans"]) < drive.scans, f"{outcome.report['keyframe_scans']}")
    outcome.expect_right_points(0.8 * FULL, "closed")
    one = drive.map("one-thread", drive.lines, "--threads", 1)
    for name in ("cloud.ply", "trajectory.tum", "covariance.csv", "graph.g2o", "gdt.png"):
        expect(digests(one.folder)[name] == digests(outcome.folder)[name], f"{name} is another with one thread")
    plain = drive.map("plain", drive.lines, "--no-loops")
    expect("loops" not in plain.report and "wheels" not in plain.report, f"{sorted(plain.report)}")
    expect(sorted(digests(plain.folder)) == sorted([*cli.PLAIN_NODDING_OUTPUTS, "cloud.ply", *cli.CLOUD_PICTURE]), f"{sorted(digests(plain.folder))}")
    plain.expect_right_points(0.8 * FULL, "plain")
    process = command("doctor", "--after", outcome.folder)
    expect_exit(process, 0)
    expect("not closed" not in process.stdout, process.stdout)


def nodding_no_horizontal_scan():
    """No scan within the tolerance: exit 65, the elevations that were seen, and what to do."""
    drive = Drive("nodding_no_horizontal_scan")
    text = drive.linkage.read_text()
    offset = re.search(r"offset: (\S+) rad", text)
    drive.linkage.write_text(text.replace(offset.group(0), f"offset: {float(offset.group(1)) + math.radians(20)!r} rad"))
    process = command("map", drive.write("raised", drive.lines), "-o", drive.folder / "raised")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("raised.log: no scan is horizontal" in process.stderr and "elevations go from 20.0 to 113.0 deg" in process.stderr, process.stderr)
    expect("nod.horizontal is 1.0 deg; is the linkage the right one?" in process.stderr, process.stderr)
    expect(not (drive.folder / "raised").exists(), "a folder was left")


def nodding_or_not():
    """--linkage with a log that does not nod: exit 65. A log that tells of it only later is mapped flat, with a warning."""
    drive = Drive("nodding_or_not")
    process = command("map", drive.write("flat", drive.edited(lambda line: None)), "-o", drive.folder / "flat", "--linkage", "paper-b")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("flat.log: has no ENCODER or TILT message among its first 10000 records, so --linkage has nothing to work on" in process.stderr, process.stderr)
    expect(not (drive.folder / "flat").exists(), "a folder was left")
    level = next(line for line in drive.lines if kind_of(line) == SCAN)
    late = [with_stamp(level, 0.05 * k) for k in range(50)]
    late += [f"ENCODER {k} {0.05 * len(late) + 0.01 * k:.6f} robot 0" for k in range(50)]
    process = command("map", drive.write("late", late, linkage=False), "-o", drive.folder / "late", "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "report")
    expect('"nodding"' not in process.stdout, "mapped in 3D")
    expect("warning: nodding message not used (50 times; first: ENCODER at 2.5 s)" in process.stderr, process.stderr)
    garbage = drive.write("garbage", [encoder(line, "nan") if kind_of(line) == "ENCODER" else line for line in drive.lines])
    process = command("map", garbage, "-o", drive.folder / "garbage", "--linkage", "paper-b")
    expect_exit(process, 65)
    expect("garbage.log:18: " in process.stderr and "nan" in process.stderr, process.stderr)
    both = drive.edited(lambda line: [line, f"TILT 0.3 {stamp_of(line):.6f} robot 0"])  # the first kind counts
    outcome = drive.map("both", both)
    expect(outcome.nodding["told_by"] == "ENCODER", f"{outcome.nodding}")
    expect_warnings(outcome, {"nodding message not used": sum(kind_of(line) == "TILT" for line in both)}, "both")
    expect_lost(outcome, drive, 0, "both")


def nodding_cloud_options():
    """--no-cloud, removal of floor and ceiling, thinning: what the report says is what is in the file."""
    drive = Drive("nodding_cloud_options")
    plain = drive.map("run", drive.lines)
    expect(plain.nodding["cloud"]["measured"] == plain.nodding["cloud"]["written"] == len(plain.points), f"{plain.nodding['cloud']}")
    both = drive.map("both", drive.lines, "--set", "cloud.remove=both")
    cloud = both.nodding["cloud"]
    expect(abs(cloud["floor"]["height_m"]) < 0.01 and abs(cloud["ceiling"]["height_m"] - 2.4) < 0.01, f"{cloud}")
    expect(all(0.04 < point[2] < 2.36 for point in both.points), "floor or ceiling is left")
    expect(len(both.points) == cloud["written"] == cloud["measured"] - cloud["removed"], f"{cloud}")
    removed = sum(point[2] < 0.05 or point[2] > 2.35 for point in plain.points)
    expect(abs(cloud["removed"] - removed) < 0.05 * removed, f"{cloud['removed']} points removed, {removed} lie there")
    floor = drive.map("floor", drive.lines, "--set", "cloud.remove=floor")
    expect(floor.nodding["cloud"]["ceiling"] is None and max(point[2] for point in floor.points) > 2.39, "the ceiling went too")
    thin = drive.map("thin", drive.lines, "--set", "cloud.voxel=10 cm")
    voxels = {tuple(math.floor(v / 0.1) for v in point[:3]) for point in plain.points}
    expect(abs(len(thin.points) - len(voxels)) < 0.02 * len(voxels), f"{len(thin.points)} points, {len(voxels)} voxels")
    expect(sorted(digests(both.folder)) == cli.CLOUD_OUTPUTS, f"{sorted(digests(both.folder))}")
    again = drive.map("run", drive.lines, "--no-cloud")
    expect("cloud" not in again.nodding and again.report["cloud_points"] == 0, f"{again.nodding}")
    expect(again.poses == plain.poses and again.nodding["sweep_check"]["pairs"] == plain.nodding["sweep_check"]["pairs"], "other poses")
    expect(sorted(digests(again.folder)) == cli.NODDING_OUTPUTS, f"{sorted(digests(again.folder))}: the cloud of the run before is still there")
    drive.map("run", drive.lines)
    expect_exit(command("map", drive.write("flat", drive.edited(lambda line: None)), "-o", drive.folder / "run", "--force", "-q", "--first", 5), 0)
    expect(sorted(digests(again.folder)) == cli.OUTPUTS, "a flat run left the cloud of the run before")


def nodding_full_disk():
    """Whichever write fails while cloud and results are written: exit 74, one line, the old run byte for byte."""
    if cli.IS_SANITIZED:
        skip("the library that fills the disk is not preloaded into a sanitized program")
    drive = Drive("nodding_full_disk")
    arguments = ["map", drive.log, "--force", "--first", 120, "-q", "--set", "cloud.voxel=10 cm"]
    run = drive.folder / "run"
    expect_exit(command(*arguments, "-o", run), 0)
    before = digests(run)
    for options in (["--set", "cloud.remove=none"], ["--set", "cloud.remove=both", "--no-pictures"], ["--no-cloud"]):
        count = cli.calls_counted("write,sync", *arguments, "-o", drive.folder / "counted", *options)
        expect(count >= 2 * len(cli.NODDING_OUTPUTS), f"only {count} writes were seen")
        for failing in range(1, count):  # the last is the sync of the folder above, when the new run has taken its place
            process = command(*arguments, "-o", run, *options, env=cli.full_disk(failing))
            expect_exit(process, 74)
            one_error_line(process.stderr)
            expect("No space left on device" in process.stderr, process.stderr)
            expect(digests(run) == before, f"{options}: the folder changed when write {failing} of {count} failed")


def nodding_linkage_mistakes():
    """A linkage file that is not right, through map and through linkage: 78 and one line with file and line."""
    drive = Drive("nodding_linkage_mistakes")
    text = drive.linkage.read_text()
    mistakes = {
        "missing": (text.replace("  rocker: 8.8 cm\n", ""), "bars.rocker is missing; give its length with its unit"),
        "unknown": (text.replace("rocker:", "rockr:"), "unknown key 'rockr'; did you mean 'rocker'?"),
        "binary": ("\x00\x01\x02", ""),
    }
    for name, (content, says) in mistakes.items():
        path = drive.folder / f"{name}.yaml"
        path.write_text(content)
        for process in (command("map", drive.log, "--linkage", path, "-o", drive.folder / "out"), command("linkage", path)):
            expect_exit(process, 78)
            one_error_line(process.stderr)
            expect(re.search(rf"/{name}\.yaml:\d+: ", process.stderr) and says in process.stderr, f"{name}: {process.stderr}")
        expect(not (drive.folder / "out").exists(), f"{name}: a folder was left")
    path = drive.write("beside", drive.lines)  # a file beside the log counts as much as one that is named
    (drive.folder / "beside.linkage.yaml").write_text(mistakes["missing"][0])
    process = command("map", path, "-o", drive.folder / "out")
    expect_exit(process, 78)
    one_error_line(process.stderr)
    expect(re.search(r"/beside\.linkage\.yaml:\d+: bars\.rocker is missing", process.stderr), process.stderr)
