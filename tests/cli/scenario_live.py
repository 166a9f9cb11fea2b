"""Scans in as lines, a pose out for each while they come, and the run folder of `map` when they end."""

import json
import os
import select
import signal
import subprocess

import cli_support as cli
from cli_support import LOG, PROGRAM, RUN, expect, expect_exit
from scenario_continue import expect_same_run, lines_of_drive

FIELDS = ["scan", "stamp_s", "pose", "covariance", "correction", "accepted", "keyframe", "doubt", "mean_distance_m", "overlap",
          "contradiction"]


def started(*arguments):
    return subprocess.Popen([PROGRAM, "live", "-", "-q", *map(str, arguments)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, bufsize=1)


def mapped_by_pipe(folder, lines):
    expect_exit(cli.command("map", "-", "-o", folder, "-q", input="".join(lines)), 0)


def next_line(process):
    """The next line of standard output, which has to come though nothing more is sent."""
    line = b""
    while not line.endswith(b"\n"):  # what is buffered beyond it would be seen by no select()
        ready, _, _ = select.select([process.stdout], [], [], 20 * cli.SLOWNESS)
        byte = os.read(process.stdout.fileno(), 1) if ready else b""
        expect(byte, "no line came for a scan that was sent")
        line += byte
    return line.decode()


def live_gives_each_pose_before_the_next_scan():
    """One line for each scan before another one is sent; at the end the bytes of `map`."""
    folder = cli.fresh_folder("live")
    lines = lines_of_drive(60)
    process = started("-o", folder / "live")
    poses = []
    for line in lines:
        process.stdin.write(line)
        process.stdin.flush()
        if line.startswith("FLASER"):
            poses.append(json.loads(next_line(process)))
    process.stdin.close()
    expect(process.wait(60 * cli.SLOWNESS) == 0, process.stderr.read())
    expect([pose["scan"] for pose in poses] == list(range(60)), "scans left out, or out of order")
    expect(all(list(pose) == FIELDS for pose in poses), f"{list(poses[0])}")
    mapped_by_pipe(folder / "map", lines)
    expect_same_run(folder / "live", folder / "map", "mapped live")
    rows = [[float(word) for word in line.split()] for line in (folder / "map/trajectory.tum").read_text().splitlines()
            if not line.startswith("#")]
    expect(len(rows) == len(poses), f"{len(rows)} poses in the trajectory")
    for row, pose in zip(rows, poses):
        away = max(abs(row[1] - pose["pose"][0]), abs(row[2] - pose["pose"][1]))
        expect(abs(row[0] - pose["stamp_s"]) < 1e-5 and away < 0.1, f"{pose} is {away} m from where the run has it")


def live_ends_at_a_signal():
    """SIGTERM is the end of the drive, in the middle of a line too: exit 0 and the bytes of `map`."""
    folder = cli.fresh_folder("live_signal")
    lines = lines_of_drive(60)
    process = started("-o", folder / "live", "--format", "tum")
    process.stdin.write("".join(lines))
    process.stdin.flush()
    for _ in range(60):
        expect(len(next_line(process).split()) == 8, "no line of a trajectory")
    process.stdin.write(lines[-1][: len(lines[-1]) // 2])
    process.stdin.flush()
    process.send_signal(signal.SIGTERM)
    expect(process.wait(60 * cli.SLOWNESS) == 0, process.stderr.read())
    mapped_by_pipe(folder / "map", lines)
    for name in ("map.pgm", "trajectory.tum", "keyframes.bin.gz", "graph.g2o"):
        expect((folder / "live" / name).read_bytes() == (folder / "map" / name).read_bytes(), f"{name} is another")


def live_sender_that_breaks_off():
    """Half a line and the end, or a line that is none: a line says so, and what came before is mapped."""
    folder = cli.fresh_folder("live_broken")
    lines = lines_of_drive(60)
    mapped_by_pipe(folder / "map", lines)
    for rest, code, said in ((lines[-1][: len(lines[-1]) // 2], 0, "cut last line"), ("FLASER many 1 2\n" + lines[-1], 65, "gdtslam: error: the log broke off")):
        process = cli.command("live", "-o", folder / "live", "--force", input="".join(lines) + rest)
        expect_exit(process, code)
        expect(said in process.stderr, process.stderr)
        expect(len(process.stdout.splitlines()) == 60, f"{len(process.stdout.splitlines())} lines")
        for name in ("map.pgm", "trajectory.tum", "keyframes.bin.gz", "graph.g2o"):
            expect((folder / "live" / name).read_bytes() == (folder / "map" / name).read_bytes(), f"{name} is another")


def live_tells_of_a_laser_that_nods():
    """It takes the laser for level, and says what does not."""
    folder = cli.fresh_folder("live_tells_of_a_laser_that_nods")
    lines = LOG.read_text().splitlines(keepends=True)
    (folder / "nods.log").write_text("ENCODER 5 0.0 robot 0.0\nENCODER 9 0.1 robot 0.1\n" + "".join(lines))
    for line in (("-o", folder / "run", "--no-loops"), ("--map", RUN)):
        for log, nods in ((folder / "nods.log", True), (LOG, False)):
            process = cli.command("live", log, *line, *(() if "--map" in line else ("--force",)))
            expect_exit(process, 0)
            expect(("the laser of this log nods" in process.stderr) == nods, process.stderr)
