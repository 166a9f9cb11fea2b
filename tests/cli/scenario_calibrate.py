"""calibrate: from a log of a wall to a linkage file that map and linkage take."""

import itertools
import json
import math
import re

import cli_support as cli
from cli_support import command, expect, expect_exit, one_error_line
from nodding_log import SCENE, Drive, kind_of, stamp_of

TRUE = """gdtslam_linkage: 1
name: mount
bars: {crank: 3.7 cm, coupler: 8.4 cm, rocker: 8.85 cm, ground: 4.9 cm}
assembly: open
encoder: {ticks_per_turn: 20000, wraps: true, zero: 40 deg, direction: 1}
elevation: {sign: 1, offset: -61.5 deg}
"""


def wall_log(folder):
    """A log of the wall by a mount that is near paper-b, 5 s at each of 200 stops."""
    (folder / "true.yaml").write_text(TRUE)
    log = folder / "wall.log"
    process = command("simulate", cli.SOURCE / "assets/scenes/wall.yaml", "-o", log, "--linkage", folder / "true.yaml")
    if process.returncode == 69:
        cli.skip("the simulator is not built in")
    expect_exit(process, 0)
    return log


def refused(linkage, code, *arguments):
    """One error line, nothing written; returns the line."""
    process = command("calibrate", *arguments, "-o", linkage)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(process.stdout == "" and not linkage.exists(), f"{arguments}: printed {process.stdout!r} or wrote a linkage")
    return process.stderr


def calibrate_recovers_the_mount():
    """The wall of the paper's protocol: the zero and the offset within what the tool states, figure and file written."""
    folder = cli.fresh_folder("calibrate")
    (folder / "true.yaml").write_text(TRUE)
    log = folder / "wall.log.gz"
    expect_exit(command("simulate", cli.SOURCE / "assets/scenes/wall.yaml", "-o", log, "--linkage", folder / "true.yaml"), 0)
    linkage, figure = folder / "linkage.yaml", folder / "figure.svg"
    process = command("calibrate", log, "-o", linkage, "--start", "paper-b", "--svg", figure, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "calibrate")
    result = json.loads(process.stdout)
    expect(result["distrust"] is None and result["warnings"] == [] and process.stderr == "", f"faults: {process.stderr!r}")
    expect("uncertainty:" in linkage.read_text(), "the linkage file states no standard deviations")
    found = {entry["name"]: entry for entry in json.loads(process.stdout)["parameters"]}
    for name, true in (("zero", 0.6981317), ("offset", -1.0733775), ("distance.wall", 2.0)):
        error = abs(found[name]["estimate"] - true)
        expect(error < 4.0 * found[name]["sigma"] + 1e-4, f"{name} is off by {error}, sigma {found[name]['sigma']}")
        expect(found[name]["observable"], f"{name} passes for not observed")
    expect(not any(found[bar]["observable"] for bar in ("crank", "coupler", "rocker", "ground")), "a bar passes for observed")
    expect(figure.read_text().startswith("<svg"), "no figure")
    expect_exit(command("linkage", linkage), 0)


def calibrate_refuses_a_fit_that_does_not_fit():
    """The wrong preset to start from: exit 1, one line, nothing written; --force writes, without standard deviations."""
    folder = cli.fresh_folder("calibrate_hopeless")
    log, linkage, figure = wall_log(folder), folder / "linkage.yaml", folder / "figure.svg"
    said = refused(linkage, 1, log, "--start", "paper-a", "--svg", figure, "--json")
    for words in ("do not fit", "--start", "--surfaces", "--force"):
        expect(words in said, f"no '{words}' in {said!r}")
    expect(not figure.exists(), "a figure was written")
    process = command("calibrate", log, "-o", linkage, "--start", "paper-a", "--force", "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "calibrate")
    result = json.loads(process.stdout)
    expect("do not fit" in result["distrust"] and 3 * result["outliers"] > result["observations"], f"distrust: {result['distrust']}")
    expect(result["all_rms"] > 10, f"all ranges: {result['all_rms']} sigma")
    expect(result["distrust"] in process.stderr and "warning: " in process.stderr, f"no warning: {process.stderr!r}")
    expect("uncertainty:" not in linkage.read_text(), "standard deviations of a fit that is wrong")
    process = command("calibrate", log, "-o", linkage, "--start", "paper-a", "--force")
    expect("NOT TO BE TRUSTED" in process.stdout and "elevation known to" not in process.stdout, process.stdout)


def calibrate_needs_a_robot_that_stands():
    """A log of a drive, and one of a robot that turns on the spot: one line that names the way and --self."""
    drive = Drive("calibrate_drive")
    linkage = drive.folder / "out.yaml"
    said = refused(linkage, 65, drive.log)
    expect("2.4" in said and "--self" in said and "room.log" in said, said)
    # ROBOTLASER1 type start field step range accuracy remission NUM ranges NUM remissions laser(3) robot(3) ...
    turning = []
    for line in wall_log(cli.fresh_folder("calibrate_turning")).read_text().splitlines():
        words = line.split()
        if words[0] == "ROBOTLASER1" and float(words[-3]) > 600.0:
            at = 9 + int(words[8])
            at += 1 + int(words[at])
            words[at + 2] = words[at + 5] = "0.1"
        turning.append(" ".join(words))
    log = drive.folder / "turning.log"
    log.write_text("\n".join(turning) + "\n")
    expect("5.7 deg" in refused(linkage, 65, log), "the turn is not told")
    # Odometry in rows of its own, and none in those of the scans: 1 m in 2500 s.
    rows = drive.folder / "rows.jsonl"
    expect_exit(command("convert", drive.folder.parent / "calibrate_turning/wall.log", "-o", rows), 0)
    told = 0
    with open(rows, encoding="utf-8") as file, open(drive.folder / "moving.jsonl", "w", encoding="utf-8") as moving:
        for row in map(json.loads, file):
            if "ranges" in row:
                row.pop("odom", None)
            elif "odom" in row:
                row["odom"] = [0.0004 * row["stamp"], 0.0, 0.0]
                told += 1
            moving.write(json.dumps(row) + "\n")
    expect(told > 100, f"{told} rows of odometry")
    expect("1.00 m" in refused(linkage, 65, drive.folder / "moving.jsonl"), "the way is not told")


def calibrate_tells_faults_of_the_encoder():
    """Messages missing, stamps twice: warnings in text and JSON. A jump without an index mark: an error that says when."""
    folder = cli.fresh_folder("calibrate_faults")
    log, linkage = wall_log(folder), folder / "linkage.yaml"
    lines = log.read_text().splitlines()
    faulty = []
    for line in lines:
        is_encoder = kind_of(line) == "ENCODER"
        if is_encoder and 100.01 < stamp_of(line) < 101.01:
            continue
        faulty += [line, line] if is_encoder and abs(stamp_of(line) - 300.0) < 0.001 else [line]
    broken = folder / "broken.log"
    broken.write_text("\n".join(faulty) + "\n")
    process = command("calibrate", broken, "-o", linkage, "--start", "paper-b", "--force", "--json")
    expect_exit(process, 0)
    warnings = {entry["kind"]: entry["count"] for entry in json.loads(process.stdout)["warnings"]}
    lost = warnings.pop("scans without the crank's position", 0)
    expect(warnings == {"nodding messages missing": 1, "nodding stamp in the past": 1}, f"the warnings are {warnings}")
    scans = sum(kind_of(line) == "ROBOTLASER1" and 100.0 < stamp_of(line) < 101.025 for line in lines)
    expect(0 < lost <= scans + 2, f"{lost} scans without the crank, {scans} in the gap")
    text = command("calibrate", broken, "-o", linkage, "--start", "paper-b", "--force")
    for kind in warnings:
        expect(f"gdtslam: warning: {kind} (1 times; first: " in text.stderr, text.stderr)
    expect(command("calibrate", broken, "-o", linkage, "--start", "paper-b", "--force", "-q").stderr == "", "--quiet is not quiet")

    linkage.unlink()
    (folder / "counting.yaml").write_text(TRUE.replace("wraps: true", "wraps: false"))
    turns, last, slipped = 0, 0, []
    for line in lines:
        if kind_of(line) == "ENCODER":
            words = line.split()
            turns += int(words[1]) < last
            last = int(words[1])
            words[1] = str(last + 20000 * turns + (3000 if stamp_of(line) > 500.0 else 0))
            line = " ".join(words)
        slipped.append(line)
    log.write_text("\n".join(slipped) + "\n")
    said = refused(linkage, 65, log, "--start", folder / "counting.yaml")
    expect("jumps (1 times, first at 500.0" in said and "index mark" in said, said)


def calibrate_searches_the_zero():
    """A zero that is not known at all, wherever the start has it: the same linkage as from a start that is near."""
    folder = cli.fresh_folder("calibrate_zero")
    log, linkage = wall_log(folder), folder / "linkage.yaml"
    for off in (75, 180, 290):
        start = folder / f"off-{off}.yaml"
        start.write_text(TRUE.replace("zero: 40 deg", f"zero: {40 + off} deg"))
        process = command("calibrate", log, "-o", linkage, "--start", start, "--search-zero", "--force", "--json")
        expect_exit(process, 0)
        result = json.loads(process.stdout)
        zero = next(entry for entry in result["parameters"] if entry["name"] == "zero")
        error = (zero["estimate"] - math.radians(40.0) + math.pi) % (2.0 * math.pi) - math.pi
        expect(abs(error) < 4.0 * zero["sigma"] + 1e-3, f"{off} deg: off by {error}, sigma {zero['sigma']}")
        expect(result["distrust"] is None and result["all_rms"] < 2.0, f"{off} deg: {result['all_rms']}")


def calibrate_from_two_drives():
    """--self with two logs, each of a clock of its own that begins at 0: the zero as from one of them."""
    drive = Drive("calibrate_two")
    linkage = drive.folder / "out.yaml"
    other = drive.folder / "other.log"
    scene = drive.folder / "there.yaml"
    scene.write_text(SCENE.replace("[[0, 0], {at: [2.4, 0.3], speed: 0.15}]", "[[2.4, -0.6], {at: [0.2, 0.4], speed: 0.15}]"))
    expect_exit(command("simulate", scene, "-o", other, "--seed", 5), 0)
    true = float(drive.linkage.read_text().split("zero: ")[1].split()[0])
    slipped = drive.folder / "slipped.yaml"
    slipped.write_text(drive.linkage.read_text().replace(f"zero: {true}", f"zero: {true + math.radians(3.0)}"))
    process = command("calibrate", drive.log, other, "-o", linkage, "--self", "--start", slipped, "--json")
    expect_exit(process, 0)
    result = json.loads(process.stdout)
    zero = next(entry for entry in result["parameters"] if entry["name"] == "zero")
    error = abs(zero["estimate"] - true)
    expect(error < 4.0 * zero["sigma"] and error < math.radians(1.0), f"the zero is off by {error} rad, sigma {zero['sigma']}")
    expect(result["distrust"] is None, f"distrust: {result['distrust']}")


def calibrate_from_a_drive():
    """--self: a zero that slipped by 3 degrees is found again within what the tool states; a gap in the encoder's messages is told."""
    drive = Drive("calibrate_self")
    linkage = drive.folder / "out.yaml"
    true = float(drive.linkage.read_text().split("zero: ")[1].split()[0])
    unit = drive.linkage.read_text().split("zero: ")[1].split()[1]
    expect(unit == "rad", f"the zero is in {unit}")
    slipped = drive.folder / "slipped.yaml"
    slipped.write_text(drive.linkage.read_text().replace(f"zero: {true}", f"zero: {true + math.radians(3.0)}"))
    gap = drive.write("gap", [line for line in drive.lines if kind_of(line) != "ENCODER" or not 4.01 < stamp_of(line) < 5.01])
    process = command("calibrate", gap, "-o", linkage, "--self", "--start", slipped, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "calibrate_self")
    result = json.loads(process.stdout)
    zero = next(entry for entry in result["parameters"] if entry["name"] == "zero")
    error = abs(zero["estimate"] - true)
    expect(error < 4.0 * zero["sigma"] and error < math.radians(1.0), f"the zero is off by {error} rad, sigma {zero['sigma']}")
    expect(result["converged"] and result["distrust"] is None, f"distrust: {result['distrust']}")
    warnings = {entry["kind"]: entry["count"] for entry in result["warnings"]}
    expect(warnings.get("nodding messages missing") == 1, f"the warnings are {warnings}")
    expect("gdtslam: warning: nodding messages missing (1 times; first: at 5" in process.stderr, process.stderr)


def calibrate_refuses_what_tells_nothing():
    """No crank in the log, an elevation beyond the wall, no log: one line each, nothing written."""
    folder = cli.fresh_folder("calibrate_refuses")
    linkage = folder / "linkage.yaml"
    for code, arguments in ((65, [cli.LOG]), (2, [cli.LOG, "--up-to", "95deg"]),
                            (74, [folder / "missing.log"])):
        process = command("calibrate", *arguments, "-o", linkage)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(not linkage.exists(), "a linkage was written")
    still = folder / "still.log"
    with open(wall_log(folder)) as lines, open(still, "w") as to:
        for line in itertools.islice(lines, 20000):
            to.write(re.sub(r"^ENCODER \S+", "ENCODER 12345", line))
    said = refused(linkage, 65, still)
    expect("at one place of the crank only; does it turn?" in said, said)
