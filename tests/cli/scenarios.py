#!/usr/bin/env python3
"""Scenarios of the command that take more than one run: `scenarios.py NAME`. Exit 0 passed, 1 failed, 77 skipped."""

import hashlib
import json
import os
import pty
import re
import resource
import select
import signal
import subprocess
import sys
import time

import cli_support as cli
from cli_support import DATA, LOG, PROGRAM, RUN, SOURCE, TRUTH, command, expect, expect_exit, one_error_line

OUTPUTS = ["config.yaml", "gdt.png", "gdt.yaml", "map.pgm", "map.yaml", "overview.png", "report.json", "trajectory.tum"]


def skip(reason):
    print(reason)
    sys.exit(cli.SKIP)


def digests(folder):
    """sha256 by name of every file in a folder, hidden ones and folders too."""
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "folder"
            for path in sorted(folder.rglob("*"))}


def mapped(folder, *arguments, log=LOG, **options):
    """Maps; returns report.json."""
    process = command("map", log, "-o", folder, "--json", *arguments, **options)
    expect_exit(process, 0)
    return json.loads(process.stdout)


def results(report):
    return report["map_sha256"], report["trajectory_sha256"]


# --- files ---------------------------------------------------------------------------------------------------------------


def fixture():
    """The drive and the map that the other tests start from."""
    cli.WORK.mkdir(parents=True, exist_ok=True)
    process = command("simulate", "office-loop", "-o", LOG, "--seed", 3, "--rate", 5, "--json")
    expect_exit(process, 0)
    cli.write_data()
    mapped(RUN)
    expect(sorted(digests(RUN)) == OUTPUTS, f"the run folder holds {sorted(digests(RUN))}")


def old_run(name):
    """A folder with an earlier run, to be kept or replaced."""
    folder = cli.fresh_folder(name) / "run"
    mapped(folder, "--first", 40)
    return folder, digests(folder)


def every_write_fails():
    """Whichever write or sync fails because the disk is full: exit 74, one line, the old files byte for byte."""
    if "FULL_DISK" not in os.environ:
        skip("the library that fills the disk is not preloaded into a sanitized program")
    folder, before = old_run("every_write_fails")
    count_file = folder.parent / "count"
    environment = {**os.environ, "LD_PRELOAD": os.environ["FULL_DISK"], "FULL_DISK_AT": "0", "FULL_DISK_COUNT": str(count_file)}
    expect_exit(command("map", LOG, "-o", folder, "--first", 50, "-q", env=environment), 0)
    count = int(count_file.read_text())
    expect(count >= 2 * len(OUTPUTS), f"only {count} writes were seen")
    folder, before = old_run("every_write_fails")
    for failing in range(1, count + 1):
        environment["FULL_DISK_AT"] = str(failing)
        process = command("map", LOG, "-o", folder, "--first", 50, "-q", env=environment)
        expect_exit(process, 74)
        one_error_line(process.stderr)
        expect("No space left on device" in process.stderr, process.stderr)
        expect(digests(folder) == before, f"the folder changed when write {failing} failed")
    fresh = folder.parent / "fresh"
    environment["FULL_DISK_AT"] = "1"
    expect_exit(command("map", LOG, "-o", fresh, "--first", 50, "-q", env=environment), 74)
    expect(not fresh.exists(), "a folder that was made for a run that failed is still there")


def file_size_limit():
    """A limit of the file size (as of a quota): exit 74, the old files byte for byte."""
    folder, before = old_run("file_size_limit")

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    process = command("map", LOG, "-o", folder, "--first", 50, "-q", preexec_fn=limit)
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect(digests(folder) == before, "the folder changed")


def unwritable_output():
    """An output below a regular file, and a result whose name a folder has: exit 74, nothing lost."""
    folder, before = old_run("unwritable_output")
    process = command("map", LOG, "-o", folder / "map.pgm" / "below", "-q")
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect(digests(folder) == before, "the folder changed")
    (folder / "map.yaml").unlink()
    (folder / "map.yaml" / "inside").mkdir(parents=True)
    before = digests(folder)
    process = command("map", LOG, "-o", folder, "--first", 50, "-q")
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect("map.yaml" in process.stderr, process.stderr)
    expect(digests(folder) == before, "the folder changed although map.yaml could not be replaced")
    process = command("ablation", LOG, "--relations", DATA / "drive.relations", "-o", folder, "--first", 5, "--variant",
                      "merge.kappa=1", "-q")
    expect_exit(process, 74)


def old_files_are_replaced():
    """A second run into a folder replaces its files and leaves others alone; leftovers of a killed run go."""
    folder, before = old_run("old_files_are_replaced")
    (folder / "notes.txt").write_text("mine")
    dead = subprocess.Popen(["true"])
    dead.wait()
    (folder / f".gdtslam-staging-{dead.pid}").mkdir()
    mapped(folder, "--first", 60)
    after = digests(folder)
    expect(sorted(after) == sorted([*OUTPUTS, "notes.txt"]), f"the folder holds {sorted(after)}")
    unchanged = [name for name in OUTPUTS if after[name] == before[name]]
    expect(set(unchanged) <= {"config.yaml", "gdt.yaml", "map.yaml"}, f"unchanged: {unchanged}")


def default_folder_and_latest():
    """Without -o: runs/<log>-<UTC time>, and runs/latest points to it."""
    folder = cli.fresh_folder("default_folder")
    (folder / "drive.log").symlink_to(LOG)
    for _ in range(2):
        expect_exit(command("map", "drive.log", "--first", 10, "-q", cwd=folder), 0)
    runs = sorted(path.name for path in (folder / "runs").iterdir())
    expect(len(runs) == 3 and runs[2] == "latest", f"runs holds {runs}")
    expect(all(re.fullmatch(r"drive-\d{8}T\d{6}Z(-2)?", name) for name in runs[:2]), f"runs holds {runs}")
    expect(os.readlink(folder / "runs/latest") == runs[1], "latest does not point to the last run")
    expect(sorted(digests(folder / "runs" / runs[1])) == OUTPUTS, "the folder is not complete")


# --- signals -------------------------------------------------------------------------------------------------------------


def start_slow_run(folder, **options):
    """A run that takes long enough to be interrupted: the log over and over through a pipe."""
    return subprocess.Popen([PROGRAM, "map", "-", "-o", str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)


def finish(process):
    stdout, stderr = process.communicate(timeout=60)
    return subprocess.CompletedProcess(process.args, process.returncode, stdout, stderr)


def scans_in(folder):
    return json.loads((folder / "report.json").read_text())


def interrupt_writes_what_there_is():
    """SIGINT or SIGTERM in the middle of a file: the scan in hand is finished, all files are there, exit 130."""
    for number in (signal.SIGINT, signal.SIGTERM):
        folder = cli.fresh_folder("interrupt") / "run"
        logs = [str(LOG)] * 200
        process = subprocess.Popen([PROGRAM, "map", *logs, "-o", str(folder)], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        time.sleep(1.0)
        process.send_signal(number)
        done = finish(process)
        expect_exit(done, 130)
        report = scans_in(folder)
        expect(sorted(digests(folder)) == OUTPUTS, "files are missing")
        expect(report["interrupted"] is True and report["scans"] > 0, "the report does not say so")
        poses = [line for line in (folder / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
        expect(len(poses) == report["scans"], f"{len(poses)} poses, {report['scans']} scans")
        expect(f"interrupted after {report['scans']} scans" in done.stderr, done.stderr)


def interrupt_of_standard_input():
    """SIGINT while the command waits for a pipe that stays open."""
    folder = cli.fresh_folder("interrupt_stdin") / "run"
    process = start_slow_run(folder)
    lines = LOG.read_text().splitlines(keepends=True)[:400]
    process.stdin.write("".join(lines))
    process.stdin.flush()
    time.sleep(1.5)
    expect(process.poll() is None, "the command did not wait for more input")
    process.send_signal(signal.SIGINT)
    done = finish(process)
    expect_exit(done, 130)
    scans = sum(line.startswith("FLASER") for line in lines)
    expect(0 < scans_in(folder)["scans"] <= scans, "no scan was mapped")
    expect(scans_in(folder)["scans"] >= scans - 1, f"{scans_in(folder)['scans']} of {scans} scans")


def interrupt_before_the_first_scan():
    """SIGINT before anything came: exit 130, one line, no folder."""
    folder = cli.fresh_folder("interrupt_early") / "run"
    process = start_slow_run(folder)
    process.stdin.write("# nothing yet\n")
    process.stdin.flush()
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    done = finish(process)
    expect_exit(done, 130)
    one_error_line(done.stderr)
    expect(not folder.exists(), "a folder was left")


def second_interrupt_ends():
    """A second SIGINT ends the process at once, also where it cannot look at the flag."""
    folder = cli.fresh_folder("second_interrupt")
    os.mkfifo(folder / "pipe")
    process = subprocess.Popen([PROGRAM, "doctor", str(folder / "pipe")], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    writer = os.open(folder / "pipe", os.O_WRONLY)
    os.write(writer, b"# a comment\n")
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    time.sleep(0.3)
    expect(process.poll() is None, "the first signal ended the process")
    process.send_signal(signal.SIGINT)
    process.wait(timeout=10)
    expect(process.returncode == -signal.SIGINT, f"exit {process.returncode}")
    os.close(writer)


# --- the same bytes ------------------------------------------------------------------------------------------------------


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
    for matcher in ("simplex", "exhaustive"):
        reports = [mapped(cli.fresh_folder("threads") / "run", "--threads", n, "--matcher", matcher, "--first", 300) for n in (1, 2, 3)]
        expect(len({results(report) for report in reports}) == 1, f"{matcher}: the result depends on the threads")


def same_bytes_by_isa():
    devices = json.loads(command("devices", "--json").stdout)
    variants = [v["name"] for v in devices["devices"][0]["isa"] if v["available"]]
    expect("baseline" in variants, f"variants: {variants}")
    for matcher in ("simplex", "exhaustive"):
        reports = [mapped(cli.fresh_folder("isa") / "run", "--isa", isa, "--matcher", matcher, "--first", 300) for isa in variants]
        expect([report["device"]["driver"] for report in reports] == variants, "not the variant that was asked for")
        expect(len({results(report) for report in reports}) == 1, f"{matcher}: the result depends on the instruction set")


def live_equals_offline():
    """The example program maps live from a pipe; its poses are those of the command, and they come scan by scan."""
    if "LIVE_MAPPER" not in os.environ:
        skip("the examples are not built")
    lines = LOG.read_text().splitlines(keepends=True)
    with subprocess.Popen([os.environ["LIVE_MAPPER"]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1) as live:
        scans = [k for k, line in enumerate(lines) if line.startswith("FLASER")]
        shown = []
        for begin, end in ((0, scans[10]), (scans[10], scans[11]), (scans[11], scans[12])):
            live.stdin.writelines(lines[begin:end])
            live.stdin.flush()
            while len(shown) < scans.index(end):
                ready, _, _ = select.select([live.stdout], [], [], 20)
                expect(ready, f"only {len(shown)} poses came for {scans.index(end)} scans while the pipe was open")
                shown.append(live.stdout.readline())
        rest, _ = live.communicate("".join(lines[scans[12]:]), timeout=100)
        rest = "".join(shown) + rest
    rows = [line.split() for line in rest.splitlines()]
    poses = [line.split() for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expect(len(rows) == len(poses), f"{len(rows)} live poses, {len(poses)} offline")
    for row, pose in zip(rows, poses):
        expect(row[:3] == pose[:3], f"live {row}, offline {pose}")
    expect({row[4] for row in rows} <= {"accepted", "predicted"}, "the rows have another form")
    expect(sum(row[4] == "accepted" for row in rows) == scans_in(RUN)["matched"], "accepted rows")


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
    process = command("map", folder / "b.log", folder / "a.log", "-o", folder / "run", "--skip", 5, "--first", 10, "-q")
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


# --- what is printed -----------------------------------------------------------------------------------------------------


def quiet_and_silent_in_a_pipe():
    """No progress in a pipe; -q prints nothing at all; --json prints JSON only."""
    folder = cli.fresh_folder("quiet") / "run"
    process = command("map", LOG, "-o", folder, "--first", 300)
    expect_exit(process, 0)
    expect("\r" not in process.stdout + process.stderr and process.stderr == "", f"stderr: {process.stderr!r}")
    process = command("map", LOG, "-o", folder, "--first", 100, "-q")
    expect(process.stdout == "" and process.stderr == "", "-q is not quiet")
    process = command("map", LOG, "-o", folder, "--first", 100, "-q", "--json")
    expect(json.loads(process.stdout) == json.loads((folder / "report.json").read_text()), "--json is not report.json")


def progress_on_a_terminal():
    """On a terminal a line with share, rate and time left is drawn on standard error and wiped at the end."""
    folder = cli.fresh_folder("terminal") / "run"
    ours, theirs = pty.openpty()
    process = subprocess.Popen([PROGRAM, "map", str(LOG), str(LOG), "-o", str(folder)], stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    drawn = b""
    try:
        while chunk := os.read(ours, 4096):
            drawn += chunk
    except OSError:  # the other end is closed
        pass
    expect(process.wait(timeout=60) == 0, "the run failed")
    text = drawn.decode()
    expect(re.search(r"\r\x1b\[K +\d+ %  [\d,]+ scans  [\d,]+/s  .* left", text), f"no progress: {text!r}")
    expect(text.endswith("\r\x1b[K"), "the line is not wiped")


def closed_standard_output():
    """Standard output that cannot be written is an error, and the run's files are there all the same."""
    folder = cli.fresh_folder("closed") / "run"
    with open("/dev/full", "w") as full:
        process = subprocess.run([PROGRAM, "map", LOG, "-o", folder, "--first", "20"], stdout=full, stderr=subprocess.PIPE,
                                 text=True, check=False)
    expect(process.returncode == 74, f"exit {process.returncode}")
    one_error_line(process.stderr)
    expect(sorted(digests(folder)) == OUTPUTS, "the files of the run are missing")
    read_end, write_end = os.pipe()
    os.close(read_end)
    process = subprocess.run([PROGRAM, "config", "show"], stdout=write_end, stderr=subprocess.PIPE, text=True, check=False)
    expect(process.returncode == 74 and "Broken pipe" in process.stderr, f"exit {process.returncode}: {process.stderr}")


# --- bad input -----------------------------------------------------------------------------------------------------------


def out_of_memory():
    """An allocation that fails is an error (exit 1), not an abort."""
    if "FULL_DISK" not in os.environ:
        skip("a sanitized program needs all the address space")
    folder = cli.fresh_folder("memory") / "run"
    limit = 160 << 20
    process = command("map", LOG, "-o", folder, "--set", "map.resolution=0.5 cm", "--set", "map.truncation=1 m", "-q",
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    expect_exit(process, 1)
    one_error_line(process.stderr)
    expect("out of memory" in process.stderr, process.stderr)
    expect(not folder.exists(), "a folder was left")


def hostile_log(name, text, code, pattern, *arguments):
    """One log and its one outcome, within a second and 256 MB."""
    folder = cli.fresh_folder(f"hostile/{name}")
    (folder / "drive.log").write_bytes(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = command("map", folder / "drive.log", "-o", folder / "run", *arguments)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{name}: exit {process.returncode}, {cpu_s:.2f} s CPU, at most {after.ru_maxrss // 1024} MB")
    expect_exit(process, code)
    expect(re.search(pattern, process.stdout + process.stderr), f"{name}: {process.stdout}{process.stderr}")
    if code != 0:
        one_error_line(process.stderr)
        expect(not (folder / "run").exists(), f"{name}: a folder was left")
    expect(cpu_s < 1.0, f"{name}: took {cpu_s:.2f} s of CPU")
    expect(after.ru_maxrss < 256 * 1024, f"{name}: took {after.ru_maxrss // 1024} MB")


def hostile_logs():
    """Damaged and malicious logs: one stated outcome each."""
    if "FULL_DISK" not in os.environ:
        skip("a sanitized program needs more time and memory")
    drive = "".join(cli.room_scan(1 + 0.05 * k, 1.5, 0.01 * k, 10 + 0.2 * k) for k in range(20))
    good = drive.encode()
    scan = cli.room_scan(1.5, 1.5, 0.0, 20.0)
    hostile_log("empty", b"", 65, "is empty")
    hostile_log("binary", bytes(range(256)) * 500, 65, "binary data")
    hostile_log("text", b"lorem ipsum dolor sit amet\n" * 1000, 65, "holds no complete CARMEN message")
    hostile_log("cut_gzip", b"\x1f\x8b\x08\x00\x00\x00", 65, "gzip")
    hostile_log("long_line", good + b"FLASER 180 " + b"1.0 " * (2 << 20) + b"\n", 65, "drive.log:21: .*longer than")
    hostile_log("long_line_lenient", good + b"FLASER 180 " + b"1.0 " * (2 << 20) + b"\n", 0, "malformed line", "--lenient")
    hostile_log("billion_beams", good + b"FLASER 1000000000 1.0 2.0\n", 65, "drive.log:21: ")
    hostile_log("negative_beams", good + b"FLASER -5 1.0 2.0\n", 65, "drive.log:21: ")
    hostile_log("many_digits", good + b"FLASER " + b"9" * 1000 + b" 1.0\n", 65, "drive.log:21: ")
    words = scan.split()
    for name, word in (("nan", "nan"), ("infinite", "inf"), ("negative", "-3.0"), ("huge", "1e300")):
        changed = " ".join([*words[:50], word, *words[51:]]) + "\n"
        hostile_log(f"range_{name}", good + changed.encode(), 0, "21 scans")
    for name, word in (("nan", "nan"), ("infinite", "inf"), ("huge", "1e300")):
        changed = " ".join([*words[:182], *[word] * 6, *words[188:]]) + "\n"
        hostile_log(f"pose_{name}", good + changed.encode(), *((0, "21 scans|warning") if name == "huge" else (65, "drive.log:21: ")))
        changed = " ".join([*words[:188], word, *words[189:]]) + "\n"
        hostile_log(f"stamp_{name}", good + changed.encode(), *((0, "21 scans") if name == "huge" else (65, "drive.log:21: ")))
    hostile_log("repeated_stamps", scan.encode() * 20, 0, "repeated stamp")
    hostile_log("backward_stamps", "".join(reversed(drive.splitlines(keepends=True))).encode(), 0, "backward stamp")
    fewer = cli.flaser(cli.room_ranges(1.5, 1.5, 0.0, beams=90), (1.5, 1.5, 0), (1.5, 1.5, 0), 30.0)
    hostile_log("beams_change", good + fewer.encode() + scan.encode(), 0, "beam count changed")
    hostile_log("no_beams", good + cli.flaser([], (1, 1, 0), (1, 1, 0), 30.0).encode(), 0, "scan without beams")
    far = cli.flaser(cli.room_ranges(1.5, 1.5, 0.0), (1e7, 0, 0), (1e7, 0, 0), 30.0)
    hostile_log("far_jump", good + far.encode() * 3, 0, "23 scans")
    step = len(good) // 60
    for size in range(step, len(good), step):
        scans = good[:size].count(b"\n")
        tail = good[:size].rsplit(b"\n", 1)[-1].split()
        scans += len(tail) == len(words)  # only the end of the last word is missing, which is not used
        hostile_log("cut", good[:size], 0 if scans else 65, f"^{scans} scans" if scans else "no complete CARMEN message")


# --- results -------------------------------------------------------------------------------------------------------------


def accuracy_of_the_sample():
    """The simulated drive is mapped to a few centimetres; a wrong merge rule is not (so this test can fail)."""
    process = command("evaluate", RUN / "trajectory.tum", "--reference", TRUTH, "--json")
    expect_exit(process, 0)
    report = json.loads(process.stdout)
    expect(report["unmatched"] == 0, f"{report['unmatched']} poses have no truth")
    expect(report["ate"]["translation_m"]["rmse"] < 0.08, f"ATE {report['ate']['translation_m']}")
    expect(report["ate"]["rotation_deg"]["rmse"] < 0.5, f"ATE {report['ate']['rotation_deg']}")
    folder = cli.fresh_folder("wrong_merge")
    error_m = {}
    for rule in ("working", "literal"):
        mapped(folder / rule, "--first", 400, "--set", f"merge.rule={rule}", "--set", "search.when=never")
        process = command("evaluate", folder / rule / "trajectory.tum", "--reference", TRUTH, "--json")
        error_m[rule] = json.loads(process.stdout)["ate"]["translation_m"]["rmse"]
    expect(error_m["working"] < 0.04 and error_m["literal"] > 0.2, f"errors {error_m}")


def report_adds_up():
    """report.json agrees with the other files of the run."""
    report = scans_in(RUN)
    cli.validate((RUN / "report.json").read_text(), "report")
    poses = [line for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expect(len(poses) == report["scans"], "scans and poses")
    expect(report["matched"] + report["doubtful"] >= report["scans"], "matched and doubtful scans")
    expect(len(report["doubtful_scans"]) == report["doubtful"], "doubtful scans are listed")
    path_m = 0.0
    last = None
    for line in poses:
        _, x, y = (float(word) for word in line.split()[:3])
        if last is not None:
            path_m += ((x - last[0]) ** 2 + (y - last[1]) ** 2) ** 0.5
        last = (x, y)
    expect(abs(path_m - report["path_m"]) < 1e-4 * report["scans"], f"path {path_m}, report {report['path_m']}")
    with open(RUN / "map.pgm", "rb") as pgm:
        header = pgm.read(64).split()
        expect([int(header[1]), int(header[2])] == [report["map"]["width"], report["map"]["height"]], f"map.pgm {header[:3]}")
    cells = (RUN / "map.pgm").read_bytes()[-report["map"]["width"] * report["map"]["height"]:]
    expect(set(cells) == {0, 205, 254}, f"levels of map.pgm: {sorted(set(cells))}")
    expect(cells.count(0) > 1000 and cells.count(254) > 10 * cells.count(0), "the map is no building")
    stages = report["stages"]
    expect(abs(stages["read"] + stages["mapper"] + stages["occupancy"] - report["wall_s"]) < 0.2 * report["wall_s"] + 0.05,
           f"stages {stages} of {report['wall_s']} s")


def config_round_trip():
    """The configuration that a run wrote, and that `config show --yaml` prints, give the same run again."""
    folder = cli.fresh_folder("config")
    sets = ["--set", "map.resolution=8 cm", "--set", "merge.kappa=0.75", "--set", "occupancy.min_ends=3"]
    first = mapped(folder / "a", "--first", 100, *sets)
    again = mapped(folder / "b", "--first", 100, "-c", folder / "a" / "config.yaml")
    expect(results(first) == results(again), "another result with the configuration of the run")
    for name in ("config.yaml", "map.pgm", "map.yaml"):
        expect((folder / "a" / name).read_bytes() == (folder / "b" / name).read_bytes(), f"another {name}")
    shown = command("config", "show", "--yaml", *sets).stdout
    expect(shown == (folder / "a" / "config.yaml").read_text(), "config show --yaml differs from the run's")
    try:
        import jsonschema
        import yaml
    except ImportError:
        return
    schema = json.loads(command("config", "schema").stdout)
    jsonschema.validate(yaml.safe_load(shown), schema)
    wrong = yaml.safe_load(shown)
    wrong["map"]["resolutoin"] = 1
    expect(not jsonschema.Draft7Validator(schema).is_valid(wrong), "the schema lets an unknown key pass")


def ablation_table():
    """The table has a row for each variant, with the variant's assignments."""
    folder = cli.fresh_folder("ablation")
    process = command("ablation", LOG, "--relations", DATA / "drive.relations", "-o", folder / "table.md", "--first", 120)
    expect_exit(process, 0)
    table = (folder / "table.md").read_text()
    rows = [line for line in table.splitlines() if line.startswith("| ")][1:]
    expect(len(rows) >= 8, f"{len(rows)} rows")
    for words in ("merge.rule=literal", "merge.kappa=1", "keyframe.every_scan=true", "match.matcher=exhaustive", "match.cost=squared"):
        expect(any(f"`{words}`" in row for row in rows), f"no row for {words}")
    expect(all(row.count("|") == 9 for row in rows), "a row has another number of columns")
    process = command("ablation", LOG, "--relations", DATA / "drive.relations", "-o", folder / "own.md", "--first", 50,
                      "--variant", "merge.kappa=0.25  merge.threshold=0.1", "-q")
    expect_exit(process, 0)
    expect("`merge.kappa=0.25` `merge.threshold=0.1`" in (folder / "own.md").read_text(), "own variant")


def reference_pages():
    """docs/reference is what the command says of itself."""
    if "Not in this build" in command("--help").stdout:
        skip("this build leaves commands out")
    process = subprocess.run([SOURCE / "tools/scripts/make_reference.sh", "--check", PROGRAM], capture_output=True,
                             text=True, check=False)
    expect(process.returncode == 0, process.stdout + process.stderr)


if __name__ == "__main__":
    globals()[sys.argv[1]]()
