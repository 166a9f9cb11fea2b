"""What the tests of the command share: where things are, running the command, the logs that the cases need."""

import gzip
import hashlib
import json
import math
import os
import pathlib
import pty
import shutil
import struct
import subprocess
import tempfile
import sys
import time

import json_fields

SOURCE = pathlib.Path(os.environ["GDTSLAM_SOURCE"])
PROGRAM = os.environ["GDTSLAM"]
# The program of the experiments; empty where it was not built.
LAB = os.environ.get("GDTSLAM_LAB", "")
LAB_COMMANDS = ("compare", "ablation", "bench")
WORK = pathlib.Path(os.environ["GDTSLAM_CLI_WORK"])
LOG = pathlib.Path(os.environ["GDTSLAM_CLI_LOG"])
TRUTH = LOG.with_suffix(".truth.tum")
RUN = WORK / "run"
DATA = WORK / "data"
SKIP = 77
# How many times as long as usual commands may take in this build.
SLOWNESS = int(os.environ.get("GDTSLAM_CLI_SLOWNESS", "1"))
# Whether it is one of a sanitizer, which needs more time and memory, and into which no other library can be preloaded.
IS_SANITIZED = "FAILING_CALLS" not in os.environ


def vulkan_devices(**options):
    """The Vulkan devices that can be used here, as `gdtslam doctor --devices --json` has them."""
    process = command("doctor", "--devices", "--json", **options)
    expect_exit(process, 0)
    return [device for device in json.loads(process.stdout)["vulkan"]["devices"] if device["problem"] is None]


def require_vulkan():
    """Skips a scenario where there is no Vulkan device; fails it when GDTSLAM_REQUIRE_VULKAN=1."""
    devices = vulkan_devices()
    if not devices:
        expect(os.environ.get("GDTSLAM_REQUIRE_VULKAN") != "1", "there is no Vulkan device, and GDTSLAM_REQUIRE_VULKAN=1")
        skip("there is no Vulkan device")
    return devices


def full_terminal():
    """Both ends of a terminal that nobody reads, as over a connection that hangs: whoever writes to the second one waits."""
    ours, theirs = pty.openpty()
    os.set_blocking(theirs, False)
    end = time.monotonic() + 0.3
    while time.monotonic() < end:  # the system moves on what was written, and then there is room once more
        try:
            os.write(theirs, b".")
            end = time.monotonic() + 0.3
        except BlockingIOError:
            time.sleep(0.01)
    os.set_blocking(theirs, True)
    return ours, theirs


def environment(**changes):
    """The environment with changes; None takes a variable out."""
    return {key: value for key, value in {**os.environ, **changes}.items() if value is not None}


def environment_without_fonts(folder):
    """The environment in which no font is found; its configuration is written into the folder."""
    file = folder / "fonts.conf"
    file.write_text("<?xml version='1.0'?><!DOCTYPE fontconfig SYSTEM 'fonts.dtd'><fontconfig></fontconfig>\n")
    return environment(FONTCONFIG_FILE=str(file))


def failing_calls(kinds, at, how="ENOSPC", on=False, **changes):
    """The environment in which the call of that number of these kinds fails, and all later ones where `on`; 0 only counts
    (tests/cli/failing_calls.c)."""
    return environment(LD_PRELOAD=os.environ["FAILING_CALLS"], FAILING_KINDS=kinds, FAILING_AT=str(at), FAILING_HOW=how,
                       FAILING_ON="1" if on else "0", **changes)


def full_disk(at=1, **changes):
    """The environment in which the disk is full from that write or sync on."""
    return failing_calls("write,sync", at, on=True, **changes)


def calls_counted(kinds, *arguments):
    """How many calls of these kinds a command makes that succeeds."""
    with tempfile.NamedTemporaryFile() as state:
        state.write(bytes(8))
        state.flush()
        expect_exit(command(*arguments, env=failing_calls(kinds, 0, FAILING_STATE=state.name)), 0)
        return struct.unpack("Q", pathlib.Path(state.name).read_bytes())[0]


def program_of(name):
    """The program that has that sub-command."""
    if name not in LAB_COMMANDS:
        return PROGRAM
    if not LAB:
        skip("gdtslam-lab was not built")
    return LAB


def command(*arguments, **options):
    """Runs gdtslam, or gdtslam-lab for a command of its own; returns the finished process with text output."""
    options["timeout"] = SLOWNESS * options.get("timeout", 100)
    options.setdefault("stdin", subprocess.DEVNULL if "input" not in options else None)
    if options["stdin"] is None:
        del options["stdin"]
    return subprocess.run([program_of(arguments[0] if arguments else ""), *map(str, arguments)], capture_output=True, text=True,
                          check=False, **options)


# Runs what is given and says what it took. A process of its own, because the largest size of a child counts from before
# its program was loaded, and a test that has made large files is itself large.
MEASURE = """
import json, os, subprocess, sys
process = subprocess.Popen(sys.argv[2:], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
text = process.stdout.read().decode(errors="replace")
_, status, usage = os.wait4(process.pid, 0)
with open(sys.argv[1], "w") as file:
    json.dump([os.waitstatus_to_exitcode(status), text, usage.ru_maxrss // 1024, usage.ru_utime + usage.ru_stime], file)
"""


def measured(*arguments, timeout=100, **options):
    """Runs gdtslam; exit code, all that it printed, the most memory that it held in MB, and seconds of CPU."""
    with tempfile.NamedTemporaryFile("r") as found:
        subprocess.run([sys.executable, "-S", "-c", MEASURE, found.name, PROGRAM, *map(str, arguments)], check=True,
                       timeout=timeout * SLOWNESS, **options)
        return tuple(json.load(found))


def fresh_folder(name):
    """An empty folder below the work folder."""
    folder = WORK / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def installed_copy(folder):
    """A copy of the program in folder/bin; where the program is then."""
    program = pathlib.Path(folder) / "bin/gdtslam"
    program.parent.mkdir(parents=True)
    shutil.copy2(PROGRAM, program)
    return program


def expect(condition, message):
    if not condition:
        print("FAILED:", message)
        sys.exit(1)


def finish(process):
    """Waits for the end with the pipe to its standard input still open."""
    try:
        process.wait(timeout=60 * SLOWNESS)
    except subprocess.TimeoutExpired:
        process.kill()
        expect(False, "the command did not end")
    stdout, stderr = process.communicate(timeout=60 * SLOWNESS)
    return subprocess.CompletedProcess(process.args, process.returncode, stdout, stderr)


def expect_exit(process, code):
    expect(process.returncode == code,
           f"exit {process.returncode}, expected {code}\nstdout: {process.stdout}\nstderr: {process.stderr}")


def one_error_line(stderr):
    """Standard error holds exactly one line, an error of ours."""
    lines = stderr.splitlines()
    expect(len(lines) == 1 and lines[0].startswith("gdtslam: error: "), f"not one error line: {stderr!r}")


def without_thread_remark(stderr):
    """Standard error less the one warning that comes where there is no room for a thread's stack."""
    lines = stderr.splitlines(keepends=True)
    remarks = [line for line in lines if line.startswith("gdtslam: warning: no thread to look for loops")]
    expect(len(remarks) <= 1, stderr)
    return "".join(line for line in lines if line not in remarks)


def validate(text, output):
    """Compares JSON text with the table of the output in docs/reference/json.md."""
    faults = json_fields.faults_of(json.loads(text), json_fields.table_of(output))
    expect(not faults, "\n".join(faults))


def flaser(ranges, laser, robot, stamp):
    """A FLASER line; poses are (x, y, theta)."""
    words = ["FLASER", str(len(ranges)), *(f"{r:.2f}" for r in ranges), *(f"{v:.6f}" for v in (*laser, *robot))]
    return " ".join([*words, f"{stamp:.6f}", "robot", f"{stamp:.6f}"]) + "\n"


def room_ranges(x, y, theta, width=6.0, depth=4.0, beams=180):
    """Ranges in an empty room with one corner at (0, 0)."""
    ranges = []
    for k in range(beams):
        angle = theta - math.pi / 2 + math.pi * k / beams
        dx, dy = math.cos(angle), math.sin(angle)
        hits = []
        if abs(dx) > 1e-9:
            hits.append(((width if dx > 0 else 0.0) - x) / dx)
        if abs(dy) > 1e-9:
            hits.append(((depth if dy > 0 else 0.0) - y) / dy)
        ranges.append(min(hits))
    return ranges


def room_scan(x, y, theta, stamp, odometry=None):
    pose = (x, y, theta)
    robot = odometry if odometry is not None else pose
    return flaser(room_ranges(*pose), robot, robot, stamp)


def write_rooms():
    """A room of 4 x 3 x 2.5 m as a grid of 5 cm on its six sides and on a wall that stands in it, and the same seen by a
    scanner that stands 30 cm farther along x and looks 10 degrees to the left."""
    steps = [[-2 + 0.05 * k for k in range(81)], [-1.5 + 0.05 * k for k in range(61)], [-1 + 0.05 * k for k in range(51)]]
    points = [(x, y, z) for x in steps[0] for y in steps[1] for z in (-1, 1.5)]
    points += [(x, y, z) for x in steps[0] for y in (-1.5, 1.5) for z in steps[2]]
    points += [(x, y, z) for x in (-2, 2) for y in steps[1] for z in steps[2]]
    points += [(x, 0.5, z) for x in steps[0] if x < -0.8 for z in steps[2]]
    c, s = math.cos(math.radians(10)), math.sin(math.radians(10))
    moved = [(c * (x - 0.3) + s * y, -s * (x - 0.3) + c * y, z) for x, y, z in points]
    for name, cloud in (("room.ply", points), ("room_moved.ply", moved)):
        header = f"ply\nformat ascii 1.0\nelement vertex {len(cloud)}\n" + "".join(f"property float {a}\n" for a in "xyz")
        (DATA / name).write_text(header + "end_header\n" + "".join(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in cloud))


def write_data():
    """The small logs and files of the cases, in DATA."""
    fresh_folder("data")
    drive = [(1.0 + 0.05 * k, 1.5 + 0.02 * k, 0.01 * k, 100.0 + 0.2 * k) for k in range(40)]
    (DATA / "empty.log").write_text("")
    (DATA / "no_scan.log").write_text("# a comment\nODOM 0 0 0 0 0 0 100.0 robot 100.0\n")
    (DATA / "malformed.log").write_text(room_scan(*drive[0]) + room_scan(*drive[1]) + "FLASER many 1.0 2.0\n")
    (DATA / "malformed.log").open("a").write("# the end\n")
    (DATA / "no_return.log").write_text("".join(flaser([81.91] * 180, (0, 0, 0), (0, 0, 0), 1.0 + k) for k in range(5)))
    (DATA / "no_odometry.log").write_text("".join(room_scan(*pose, odometry=(0, 0, 0)) for pose in drive))
    faults = [list(pose) for pose in drive]
    faults[10][3] = faults[9][3] - 0.5  # backward
    faults[20][3] = faults[19][3]  # repeated
    for pose in faults[30:]:
        pose[3] += 30.0  # gap
    text = ""
    for k, (x, y, theta, stamp) in enumerate(faults):
        text += room_scan(x, y, theta, stamp, odometry=(x + (5.0 if k >= 25 else 0.0), y, theta))  # one jump
    (DATA / "faults.log").write_text(text)
    (DATA / "bad.tum").write_text("1 0 0 0 0 0 0 1\n2 0 0 zero 0 0 0 1\n")
    header = "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    (DATA / "none.ply").write_text(header.format(0))
    (DATA / "few.ply").write_text(header.format(3) + "0 0 0\n1 0 0\n0 1 0\n")
    (DATA / "far.tum").write_text("".join(f"{k} 0 0 0 0 0 0 1\n" for k in (9001, 9002, 9003)))
    (DATA / "nanoseconds.tum").write_text("".join(f"{k}00000000 0 0 0 0 0 0 1\n" for k in (1001, 1002, 1003)))
    (DATA / "clockwise.csv").write_text("stamp,angle_min,angle_increment,ranges\n1,-3.14159265,-0.0174532925,"
                                        + " ".join(f"{0.05 * (k % 2) * (k + 20):.2f}" for k in range(360)) + "\n")
    (DATA / "far.relations").write_text("9001 9002 0 0 0 0 0 0\n")
    # In the room of three-boxes: half a metre before a wall, 2 cm before the outside of one that is 12 cm thick, and 25 cm
    # over the floor.
    places = "3.04 2 1\n3.64 2 1\n-1 -1 0.25\n"
    header = "ply\nformat ascii 1.0\nelement vertex 3\n" + "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    (DATA / "places.ply").write_text(header + places)
    write_rooms()
    (DATA / "empty.ply").write_text(header.replace("vertex 3", "vertex 0"))
    (DATA / "good.yaml").write_text("version: 1\nmap:\n  resolution: 10 cm\n")
    (DATA / "unknown_key.yaml").write_text("version: 1\nmerge:\n  treshold: 5 cm\n")
    stamps = [line.split()[0] for line in TRUTH.read_text().splitlines() if line[0] != "#"]
    relations = f"{stamps[0]} {stamps[10]} 0.5 0 0 0 0 0\n{stamps[0]} {stamps[-1]} 1 0 0 0 0 0\n"
    (DATA / "drive.relations").write_text(relations)
    (DATA / "drive.relations.gz").write_bytes(gzip.compress(relations.encode(), mtime=0))


OVERVIEW = "overview.png"
LEVEL_OUTPUTS = ["config.yaml", "gdt.png", "gdt.yaml", "map.pgm", "map.yaml", OVERVIEW, "report.json", "trajectory.tum", "continue.json"]
# Of a run that closed no loops: --no-loops, an interrupt.
PLAIN_OUTPUTS = sorted([*LEVEL_OUTPUTS, "keyframes.bin.gz"])
LOOP_OUTPUTS = ["covariance.csv", "graph.g2o", OVERVIEW.replace("overview", "graph")]
OUTPUTS = sorted([*PLAIN_OUTPUTS, *LOOP_OUTPUTS])
# Of a laser that nods, with and without loops; the picture of the cloud where the viewer is built in.
NODDING_OUTPUTS = sorted([*LEVEL_OUTPUTS, *LOOP_OUTPUTS, "linkage.yaml"])
PLAIN_NODDING_OUTPUTS = sorted([*LEVEL_OUTPUTS, "linkage.yaml"])
CLOUD_PICTURE = ["cloud.png"] if os.environ.get("GDTSLAM_VIEWER") == "1" else []
CLOUD_OUTPUTS = sorted([*NODDING_OUTPUTS, "cloud.ply", *CLOUD_PICTURE])


def skip(reason):
    print(reason)
    sys.exit(SKIP)


def digests(folder):
    """sha256 by name of every file in a folder, hidden ones and folders too."""
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "folder"
            for path in sorted(folder.rglob("*"))}


def mapped(folder, *arguments, log=LOG, **options):
    """Maps, in place of what is in the folder; returns report.json."""
    process = command("map", log, "-o", folder, "--force", "--json", *arguments, **options)
    expect_exit(process, 0)
    return json.loads(process.stdout)


def results(report):
    return report["map_sha256"], report["trajectory_sha256"]

def scans_in(folder):
    """report.json of a run folder."""
    return json.loads((folder / "report.json").read_text())


def without_told_files(run):
    """The run as an older version wrote it, whose report told of no files."""
    report = scans_in(run)
    del report["files"]
    (run / "report.json").write_text(json.dumps(report))
