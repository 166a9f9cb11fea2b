"""Logs in other formats: what convert and simulate write, read by gdtslam and by readers that are not ours."""

import bz2
import collections
import gzip
import json
import lzma
import math
import shutil
import signal
import struct
import subprocess

import cli_support as cli
import recording_reader
import scenario_bags as bags
from cli_support import LOG, command, expect, expect_exit, mapped, results


def converted(target, *arguments, log=LOG):
    process = command("convert", log, "-o", target, "-q", *arguments)
    expect_exit(process, 0)
    expect(process.stdout == process.stderr == "", process.stdout + process.stderr)
    return target


def lines_of(log):
    """FLASER lines as (stamp, ranges, odometry), ODOM lines as (stamp, pose)."""
    scans, odometry = [], []
    for line in log.read_text().splitlines():
        words = line.split()
        if words[0] == "FLASER":
            count = int(words[1])
            numbers = [float(word) for word in words[2 : 2 + count + 6]]
            scans.append((float(words[count + 8]), numbers[:count], numbers[count + 3 :]))
        elif words[0] == "ODOM":
            odometry.append((float(words[7]), [float(word) for word in words[1:4]]))
    return scans, odometry


def single(values):
    return struct.unpack(f"<{len(values)}f", struct.pack(f"<{len(values)}f", *values))


def check_messages(messages, scans, poses, what):
    """The messages against the lines of the log."""
    counts = collections.Counter(topic for topic, *_ in messages)
    expect(counts == {"/scan": len(scans), "/odom": len(poses), "/tf": len(poses), "/tf_static": 1}, f"{what}: {counts}")
    expect({topic: kind for topic, kind, *_ in messages} ==
           {"/scan": "sensor_msgs/msg/LaserScan", "/odom": "nav_msgs/msg/Odometry", "/tf": "tf2_msgs/msg/TFMessage",
            "/tf_static": "tf2_msgs/msg/TFMessage"}, what)
    for (stamp, ranges, _), (_, _, received, data) in zip(scans, [m for m in messages if m[0] == "/scan"]):
        stamp_ns, frame, numbers, found = recording_reader.cdr_scan(data)
        expect(stamp_ns == received == round(stamp * 1e9) and frame == "laser", f"{what}: {stamp_ns}, {received}, {stamp}")
        expect(found == single(ranges), f"{what}: ranges at {stamp}")
        expect(numbers[:3] == single([-math.pi / 2, math.pi / 2 - math.pi / 180, math.pi / 180]), f"{what}: {numbers}")
    for (stamp, pose), (_, _, _, data) in zip(poses, [m for m in messages if m[0] == "/odom"]):
        stamp_ns, frame, child, x, y, z, w = recording_reader.cdr_pose(data)
        expect((stamp_ns, frame, child) == (round(stamp * 1e9), "odom", "base_link"), f"{what}: {stamp_ns} {frame} {child}")
        expect([x, y] == pose[:2] and abs(2 * math.atan2(z, w) - pose[2]) < 1e-12, f"{what}: pose at {stamp}")


def beginning_of(*words, lines=1):
    """The first lines that a command prints to a reader who has enough then, as `head` has; its exit code and remarks."""
    with subprocess.Popen([cli.PROGRAM, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        read = [process.stdout.readline() for _ in range(lines)]
        process.stdout.close()
        remarks = process.stderr.read()
        return read, process.wait(timeout=60 * cli.SLOWNESS), remarks


def readers_that_had_enough():
    """A log that is sent ends quietly with its reader; what cannot be written for another reason is an error."""
    for name in ("jsonl", "csv", "carmen"):
        read, code, remarks = beginning_of("convert", LOG, "-o", "-", "--format", name)
        expect(read[0].endswith("\n") and (code, remarks) == (0, ""), f"{name}: {code} {remarks}")
    for pace in ((), ("--pace", 1)):  # its drive takes more than a minute
        read, code, remarks = beginning_of("simulate", "office-loop", "-o", "-", *pace, lines=3)
        expect(read[0].startswith("PARAM") and (code, remarks) == (0, ""), f"{pace}: {code} {remarks}")
    # Ctrl-C ends the reader, too; what was sent is not the whole then.
    process = subprocess.Popen([cli.PROGRAM, "simulate", "office-loop", "-o", "-", "--pace", "1"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    process.send_signal(signal.SIGSTOP)  # so that it hears of both at once
    process.stdout.close()
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGCONT)
    remarks = process.stderr.read()
    expect(process.wait() == 130 and "interrupted after" in remarks, f"{process.returncode} {remarks}")
    with open("/dev/full", "w", encoding="utf-8") as full:
        process = subprocess.run([cli.PROGRAM, "convert", LOG, "-o", "-", "--format", "csv"], stdout=full, stderr=subprocess.PIPE,
                                 text=True, check=False)
    expect(process.returncode == 74 and "No space left" in process.stderr, process.stderr)


def convert_takes_what_is_stated():
    """Times of the beams go into the log that is written; what would change nothing is refused."""
    folder = cli.fresh_folder("convert_takes_what_is_stated")
    stated = ("--set", "log.beam_times=stated", "--set", "log.first_beam_after=-10 ms", "--set", "log.beam_period=-0.1 ms")
    scans = [row for row in map(json.loads, converted(folder / "a.jsonl", *stated).read_text().splitlines()) if "ranges" in row]
    expect({(row["first_beam_after"], row["time_increment"]) for row in scans} == {(-0.01, -0.0001)}, "times of the beams")
    level = converted(folder / "b.jsonl", "--set", "log.deskew=false", log=folder / "a.jsonl").read_text().splitlines()
    expect({row["time_increment"] for row in map(json.loads, level) if "ranges" in row} == {0}, "log.deskew=false")
    for setting in ("log.odometry_stamps=log", "map.resolution=1cm"):
        process = command("convert", LOG, "-o", folder / "c.csv", "--set", setting)
        expect_exit(process, 2)
        cli.one_error_line(process.stderr)
        expect(f"convert has no use for {setting.split('=')[0]}" in process.stderr and not (folder / "c.csv").exists(), process.stderr)
    times = converted(folder / "c.csv", "--set", "log.mount=stated", "--set", "log.mount_x=10 cm")
    expect(",0.1,0,0," in times.read_text(), "the mount that was stated")


BEGIN = ("--first", 600)  # what is mapped of a log that is converted whole


def converted_logs_give_the_same_map():
    """Every format gives the same map and path, byte for byte: CARMEN, CSV and JSON lines carry every number, and of those
    of ROS, which have 32-bit bearings, one mount, and headings as quaternions, the numbers are found again. What they
    contain is checked by readers that are not ours."""
    folder = cli.fresh_folder("converted_logs_give_the_same_map")
    expected = results(mapped(folder / "run", *BEGIN))
    for name in ("a.log", "a.csv", "a.jsonl", "b.csv.gz"):
        report = mapped(folder / f"run-{name}", *BEGIN, log=converted(folder / name))
        expect(results(report) == expected and report["warnings"] == {}, f"{name}: another map or path")
    expect_exit(command("convert", folder / "a.csv", "-o", folder / "c.jsonl", "-q"), 0)
    expect((folder / "c.jsonl").read_bytes() == (folder / "a.jsonl").read_bytes(), "by way of CSV another file")
    for recording in (converted(folder / "c.mcap", "--compression", "lz4"), bags.database_of_log(folder / "a.db3")):
        report = mapped(folder / f"run-{recording.name}", *BEGIN, log=recording)
        expect(results(report) == expected and report["warnings"] == {}, f"{recording.name}: another map or path")
    scans, odometry = lines_of(LOG)
    poses = sorted({(stamp, tuple(pose)) for stamp, *_, pose in scans} | {(stamp, tuple(pose)) for stamp, pose in odometry})
    poses = [(stamp, list(pose)) for stamp, pose in poses]
    for name, packing in (("a.mcap", "zstd"), ("b.mcap", "none")):
        data = converted(folder / name, "--compression", packing).read_bytes()
        check_messages(recording_reader.mcap_messages(data), scans, poses, name)
    process = command("convert", LOG, "-o", folder / "a.csv", "-q")
    expect_exit(process, 2)
    expect_exit(command("convert", LOG, "-o", folder / "a.csv", "-q", "--force"), 0)


def simulated_formats():
    """simulate writes every format with the numbers of its CARMEN log."""
    folder = cli.fresh_folder("simulated_formats")
    drive = ("simulate", "office-loop", "--seed", 3, "--rate", 1, "-q", "--force")
    expect_exit(command(*drive, "-o", folder / "a.log"), 0)
    for name in ("a.csv", "a.jsonl", "a.mcap"):
        expect_exit(command(*drive, "-o", folder / name), 0)
        expect_exit(command("convert", folder / "a.log", "-o", folder / f"c-{name}", "-q"), 0)
        expect((folder / name).read_bytes() == (folder / f"c-{name}").read_bytes(), f"{name} is not the converted log")


# A laser of 5 turns a second on a robot that turns by 12 degrees meanwhile.
SLOW = ("--laser", "lidar-360", "--mirror-rate", 5, "--rate", 5, "--speed", "0.8 m/s", "--turn-rate", "60deg/s", "-q")


def slow_lasers_are_deskewed():
    """Beams of a simulated laser are measured one after the other, the log says when, and the map makes up for it; in every
    format but CARMEN, where it can be stated."""
    folder = cli.fresh_folder("slow_lasers_are_deskewed")
    drive = ("simulate", "office-loop", "--force", *SLOW)
    for name in ("a.csv", "a.jsonl", "a.mcap"):
        expect_exit(command(*drive, "-o", folder / name), 0)
    period = 1 / (360 * 5)
    scan = next(json.loads(line) for line in (folder / "a.jsonl").open() if "ranges" in line)
    expect(scan["first_beam_after"] == 0 and abs(scan["time_increment"] - period) < 3e-11 and len(scan["ranges"]) == 360,
           f"the scan says {scan}")
    expected = mapped(folder / "run", log=folder / "a.csv")
    mapped(folder / "still", "--set", "log.deskew=false", log=folder / "a.csv")

    def error_m(run):
        process = command("evaluate", folder / run / "trajectory.tum", "--reference", folder / "a.truth.tum", "--json")
        expect_exit(process, 0)
        return json.loads(process.stdout)["ate"]["translation_m"]["mean"]

    with_m, without_m = error_m("run"), error_m("still")
    expect(2 * with_m <= without_m and with_m < 0.03, f"off by {with_m} m with deskewing, by {without_m} m without")
    expect(results(mapped(folder / "run-mcap", log=folder / "a.mcap")) == results(expected), "another map of MCAP")
    process = command(*drive[:-1], "-o", folder / "a.log")
    expect_exit(process, 0)
    expect(process.stderr.count("cannot carry: time of each beam") == 1, process.stderr)
    stated = ("--set", "log.beam_times=stated", "--set", f"log.beam_period={period!r} s")
    report = mapped(folder / "run-log", *stated, "--first", 100, log=folder / "a.log")
    expect(report["warnings"] == {}, f"{report['warnings']}")


def packed_logs_give_the_same_map():
    """bzip2, xz, zstd and gzip around a log, in one or two streams, from a file or a pipe; cut and damaged ones."""
    folder = cli.fresh_folder("packed_logs_give_the_same_map")
    text = b"".join(LOG.read_bytes().splitlines(keepends=True)[:400])
    (folder / "a.log").write_bytes(text)
    expected = results(mapped(folder / "run", log=folder / "a.log"))
    packers = {"bz2": bz2.compress, "xz": lzma.compress, "gz": gzip.compress}
    if shutil.which("zstd"):
        packers["zst"] = lambda data: subprocess.run(["zstd", "-c"], input=data, capture_output=True, check=True).stdout
    for name, pack in packers.items():
        half = text.index(b"\n", len(text) // 2) + 1
        for form, data in (("one", pack(text)), ("two", pack(text[:half]) + pack(text[half:]))):
            file = folder / f"{form}.log.{name}"
            file.write_bytes(data)
            report = mapped(folder / f"run-{form}-{name}", log=file)
            expect(results(report) == expected and report["warnings"] == {}, f"{file.name}: another map")
        process = subprocess.run([cli.PROGRAM, "map", "-", "-o", str(folder / f"pipe-{name}"), "--json"], input=data,
                                 capture_output=True, check=False)
        expect(process.returncode == 0 and results(json.loads(process.stdout)) == expected, process.stderr.decode())
        (folder / "cut").write_bytes(data[:-30])
        report = mapped(folder / f"cut-{name}", log=folder / "cut")
        kind = "gzip stream" if name == "gz" else "packed stream"
        expect(report["warnings"].get(kind) == 1, f"{name}: {report['warnings']}")
        hurt = bytearray(data)
        hurt[len(hurt) // 4] ^= 0x55
        (folder / "hurt").write_bytes(hurt)
        process = command("map", folder / "hurt", "-o", folder / "none")
        expect_exit(process, 65)
        cli.one_error_line(process.stderr)
        expect("hurt" in process.stderr, process.stderr)


def recorded_run():
    """map --mcap: the poses of trajectory.tum, the cells of map.pgm and the ranges of the log, read by a reader not ours."""
    folder = cli.fresh_folder("recorded_run")
    report = mapped(folder / "run", "--mcap", folder / "run.mcap")
    expect(results(report) == results(mapped(folder / "plain")), "--mcap changed the run")
    messages = recording_reader.mcap_messages((folder / "run.mcap").read_bytes())
    scans, _ = lines_of(LOG)
    found = [m for m in messages if m[0] == "/scan"]
    expect(len(found) == len(scans) == report["scans"], f"{len(found)} scans")
    for (stamp, ranges, _), (*_, data) in zip(scans, found):
        stamp_ns, frame, _, values = recording_reader.cdr_scan(data)
        expect((stamp_ns, frame, values) == (round(stamp * 1e9), "laser", single(ranges)), f"scan at {stamp}")
    rows = [[float(word) for word in line.split()] for line in (folder / "run" / "trajectory.tum").read_text().splitlines()]
    poses = [recording_reader.cdr_stamped_pose(m[3]) for m in messages if m[0] == "/pose"]
    expect(len(poses) == len(rows), f"{len(poses)} poses")
    for row, (stamp_ns, frame, x, y, z, w) in zip(rows, poses):
        expect(frame == "map" and abs(stamp_ns * 1e-9 - row[0]) < 1e-9, f"{stamp_ns} {frame}")
        expect(max(abs(x - row[1]), abs(y - row[2]), abs(z - row[6]), abs(w - row[7])) < 1e-8, f"pose at {row[0]}")
    (grid,) = [m[3] for m in messages if m[0] == "/map"]
    width, height, cells = recording_reader.cdr_grid(grid)
    data = (folder / "run" / "map.pgm").read_bytes()
    values = {0: 100, 254: 0, 205: -1}
    pixels = data[len(data) - width * height :]
    expected = [values[value] for y in reversed(range(height)) for value in pixels[y * width : (y + 1) * width]]
    expect(list(cells) == expected, "the grid is not map.pgm")
    expect(sum(m[0] == "/tf_static" for m in messages) == 1, "the mount is told more than once")
