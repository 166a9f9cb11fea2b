"""The same input gives the same bytes: runs, threads, instruction sets, live and offline."""

import json
import os
import select
import subprocess

import cli_support as cli
from cli_support import LOG, OUTPUTS, command, digests, expect, expect_exit, mapped, results, skip


def same_bytes_twice():
    """Two runs give the same files; report.json differs in times only."""
    folders = [cli.fresh_folder("same_bytes") / name for name in ("a", "b")]
    reports = [mapped(folder) for folder in folders]
    expect(results(reports[0]) == results(reports[1]), "the hashes differ")
    first, second = (digests(folder) for folder in folders)
    differing = [name for name in OUTPUTS if first[name] != second[name]]
    expect(differing in ([], ["report.json"]), f"differing files: {differing}")
    times = {"wall_s", "cpu_s", "scans_per_s", "scans_per_core_s", "realtime_factor", "stages"}
    expect(all(reports[0][key] == reports[1][key] for key in reports[0] if key not in times), "the reports differ")


def same_bytes_by_threads():
    for matcher in ("gauss-newton", "exhaustive"):
        reports = [mapped(cli.fresh_folder("threads") / "run", "--threads", n, "--matcher", matcher, "--first", 300) for n in (1, 2, 3)]
        expect(len({results(report) for report in reports}) == 1, f"{matcher}: the result depends on the threads")


def same_bytes_by_isa():
    devices = json.loads(command("doctor", "--devices", "--json").stdout)
    variants = [v["name"] for v in devices["devices"][0]["isa"] if v["available"]]
    expect("baseline" in variants, f"variants: {variants}")
    for matcher in ("gauss-newton", "exhaustive"):
        reports = [mapped(cli.fresh_folder("isa") / "run", "--isa", isa, "--matcher", matcher, "--first", 300) for isa in variants]
        expect([report["device"]["driver"] for report in reports] == variants, "not the variant that was asked for")
        expect(len({results(report) for report in reports}) == 1, f"{matcher}: the result depends on the instruction set")


def same_bytes_with_loops():
    """Loops closed: threads, instruction sets and a device give the same bytes; the report lists each loop."""
    devices = json.loads(command("doctor", "--devices", "--json").stdout)
    variants = [v["name"] for v in devices["devices"][0]["isa"] if v["available"]]
    runs = [(), ("--threads", 1), ("--threads", 2), *(("--isa", isa) for isa in variants)]
    reports = [mapped(cli.fresh_folder("loops") / "run", *run) for run in runs]
    expect(len({results(report) for report in reports}) == 1, "the result depends on threads or instruction set")
    loops = reports[0]["loops"]
    expect(loops["found"] == len(loops["closures"]) > 0, f"{loops['found']} loops in a drive that ends where it began")
    expect(loops["on"] == sum(loop["on"] for loop in loops["closures"]) > 0, "none of the loops holds")
    expect(loops["rms_m"] < 0.03, f"points lie {loops['rms_m']} m from the walls of other scans")
    if cli.vulkan_devices():
        both = [mapped(cli.fresh_folder("loops") / "run", "--first", 100, "--matcher", "exhaustive", "--device", device)
                for device in ("cpu", "vulkan")]
        expect(len({results(report) for report in both}) == 1, "the device gives another result")


def live_equals_offline():
    """The example program maps live from a pipe; its poses are those of the command, and they come scan by scan."""
    if "LIVE_MAPPER" not in os.environ:
        skip("the examples are not built")
    lines = LOG.read_text().splitlines(keepends=True)
    with subprocess.Popen([os.environ["LIVE_MAPPER"]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as live:
        scans = [k for k, line in enumerate(lines) if line.startswith("FLASER")]
        shown = b""
        for begin, end in ((0, scans[1]), (scans[1], scans[2]), (scans[2], scans[3])):
            live.stdin.write("".join(lines[begin:end]).encode())
            while shown.count(b"\n") < scans.index(end):
                ready, _, _ = select.select([live.stdout], [], [], 20)
                expect(ready, f"only {shown.count(10)} poses came for {scans.index(end)} scans while the pipe was open")
                shown += os.read(live.stdout.fileno(), 65536)
        rest, _ = live.communicate("".join(lines[scans[3]:]).encode(), timeout=100 * cli.SLOWNESS)
        rest = (shown + rest).decode()
    rows = [line.split() for line in rest.splitlines()]
    run = cli.fresh_folder("live") / "run"
    report = mapped(run, "--no-loops")
    poses = [line.split() for line in (run / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expect(len(rows) == len(poses), f"{len(rows)} live poses, {len(poses)} offline")
    for row, pose in zip(rows, poses):
        expect(row[:3] == pose[:3], f"live {row}, offline {pose}")
    expect({row[4] for row in rows} <= {"accepted", "predicted"}, "the rows have another form")
    expect(sum(row[4] == "accepted" for row in rows) == report["matched"], "accepted rows")


def live_corrections():
    """With --loops the example's poses are the front end's; corrections stand between them, the same each time."""
    if "LIVE_MAPPER" not in os.environ:
        skip("the examples are not built")
    text = LOG.read_text()
    runs = [subprocess.run([os.environ["LIVE_MAPPER"], "--loops"], input=text, capture_output=True, text=True,
                           timeout=100 * cli.SLOWNESS)
            for _ in range(2)]
    for run in runs:
        expect(run.returncode == 0, run.stderr)
    expect(runs[0].stdout == runs[1].stdout, "two runs differ")
    rows = [line.split() for line in runs[0].stdout.splitlines()]
    corrections = [row for row in rows if row[0] == "correction"]
    poses = [row for row in rows if row[0] != "correction"]
    expect(len(poses) == sum(line.startswith("FLASER") for line in text.splitlines()), "a pose a scan")
    expect(all(len(row) == 4 and all(abs(float(x)) < 1.0 for x in row[1:]) for row in corrections), str(corrections))
    expect(all(a != b for a, b in zip(corrections, corrections[1:])), "a correction that changes nothing")
    expect(rows[0][0] != "correction", "a correction before the first pose")
    run = subprocess.run([os.environ["LIVE_MAPPER"], "--lops"], input="", capture_output=True, text=True, timeout=100 * cli.SLOWNESS)
    expect(run.returncode == 2 and run.stderr.startswith("Usage:"), f"{run.returncode}: {run.stderr}")


def logs_in_sequence():
    """A log in two parts gives the poses of the whole: odometry carries over, --skip and --first count over all."""
    folder = cli.fresh_folder("sequence")
    lines = LOG.read_text().splitlines(keepends=True)
    cut = [k for k, line in enumerate(lines) if line.startswith("FLASER")][100]
    (folder / "a.log").write_text("".join(lines[:cut]))
    (folder / "b.log").write_text("".join(lines[cut:]))
    process = command("map", folder / "a.log", folder / "b.log", "-o", folder / "run", "--first", 150, "--json")
    expect_exit(process, 0)
    report = json.loads(process.stdout)
    expect(report["scans"] == 150 and len(report["log"]) == 2, "scans of both logs")
    process = command("map", folder / "b.log", folder / "a.log", "-o", folder / "run", "--force", "--skip", 5, "--first", 10, "-q")
    expect_exit(process, 0)


def equal_odometry_from_records():
    """Scans whose own odometry was moved into ODOM records of the same time map as before."""
    folder = cli.fresh_folder("records")
    text = ""
    count = 0
    for line in LOG.read_text().splitlines():
        words = line.split()
        if words[0] != "FLASER" or count == 200:
            continue
        count += 1
        beams = int(words[1])
        stamp = words[beams + 8]
        odometry = words[beams + 5:beams + 8]
        text += f"ODOM {' '.join(odometry)} 0 0 0 {stamp} robot {stamp}\n{line}\n"
    (folder / "with.log").write_text(text)
    expect(results(mapped(folder / "a", log=folder / "with.log")) == results(mapped(folder / "b", "--first", 200)),
           "ODOM records beside the scans' own odometry change the result")
