"""Many logs into an atlas: the same hash however they are shared out, what is done is skipped, and what failed is told."""

import csv
import hashlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time

import cli_support as cli
from cli_support import LOG, PROGRAM, command, expect, expect_exit, fresh_folder, one_error_line
from content_policy import faults_of

# Finding out how late odometry is stamped takes most of the time that a short log takes.
QUICK = ("--set", "log.odometry_stamps=log")


def make_logs(folder, count=5, bad=0):
    """Pieces of the simulated drive, and logs that cannot be mapped."""
    lines = LOG.read_text().splitlines(keepends=True)
    folder.mkdir(parents=True)
    piece = len(lines) // (count + 1)
    for k in range(count):
        (folder / f"drive-{k}.log").write_text("".join(lines[k * piece:(k + 1) * piece + 20 * k]))
    for k in range(bad):
        (folder / f"bad-{k}.log").write_text("# no scan\n" * (k + 1) + "FLASER 2 1.0 wall\n" * (k % 2))
    return folder


def fleet_run(atlas, *arguments, code=0, **options):
    process = command("fleet", "run", *arguments, "-o", atlas, *QUICK, **options)
    expect_exit(process, code)
    if code not in (0, 130):
        expect(process.stderr.splitlines()[-1].startswith("gdtslam: error: "), process.stderr)
    return process


def finished(atlas, code=0):
    """atlas.json, and the rows of summary.csv."""
    process = command("fleet", "finish", atlas, "--json")
    expect_exit(process, code)
    with open(atlas / "summary.csv", encoding="utf-8", newline="") as file:
        return json.loads(process.stdout), list(csv.DictReader(file))


def done_alone(folder, logs):
    """The hash of an atlas that one command made."""
    fleet_run(folder / "reference", logs, "-q")
    return finished(folder / "reference")[0]["atlas_sha256"]


def fleet_local():
    """One command maps as `map` does; a hash that can be computed by hand, one page, what failed; a second time all is skipped."""
    folder = fresh_folder("fleet_local")
    logs = make_logs(folder / "logs", bad=2)
    atlas = folder / "atlas"
    process = fleet_run(atlas, logs, code=65)
    expect(process.stdout == "7 logs: 5 mapped, 0 skipped as they are done, 2 refused, 0 failed\n", process.stdout)
    expect(f"{logs}/bad-0.log refused: " in process.stderr and "2 of 7 logs not mapped" in process.stderr, process.stderr)
    report, rows = finished(atlas, code=65)
    expect((report["logs"], report["mapped"], report["refused"], report["failed"], report["missing"]) == (7, 5, 2, 0, 0), str(report))
    lines = []
    for row in rows:
        log = pathlib.Path(row["log"])
        expect(row["log_sha256"] == hashlib.sha256(log.read_bytes()).hexdigest(), f"{log}: another hash")
        lines.append(f"{row['log_sha256']} {row['options_sha256']} {row['outcome']} {row['result_sha256']}\n")
        alone = command("map", log, "-o", folder / log.stem, "-q", *QUICK)
        expect(alone.returncode == int(row["exit_code"]), f"{log}: {row}")
        if row["outcome"] == "refused":
            expect(row["reason"].removeprefix("line ") in alone.stderr, f"{row['reason']} is not {alone.stderr}")
            continue
        alone, here = cli.digests(folder / log.stem), cli.digests(atlas / row["run"])
        del alone["report.json"], alone["continue.json"], here["report.json"]
        expect(alone == here, f"{log}: another run than by map")
    expect(report["atlas_sha256"] == hashlib.sha256("".join(sorted(lines)).encode()).hexdigest(), "another hash")
    page = (atlas / "index.html").read_text()
    faults = faults_of(page)
    expect(not faults, f"the page's policy: {faults}")
    expect("drive-3.log" in page and "bad-0.log" in page and report["atlas_sha256"] in page, "the page lacks a log")
    process = command("fleet", "finish", atlas)
    expect(f"{logs}/bad-0.log refused (exit 65): " in process.stdout and report["atlas_sha256"] in process.stdout, process.stdout)
    process = fleet_run(atlas, logs, code=65)
    expect("0 mapped, 5 skipped as they are done, 2 refused" in process.stdout, process.stdout)


def fleet_shards():
    """The same hash for any number and order of shards, at the same time or not, from a list, and by baseline."""
    folder = fresh_folder("fleet_shards")
    logs = make_logs(folder / "logs")
    reference = done_alone(folder, logs)
    listed = "\n".join(str(logs / f"drive-{k}.log") for k in (3, 1, 4, 0, 2))
    for shard in ("3/3", "1/3"):
        fleet_run(folder / "three", "--list", "-", "--shard", shard, "--isa", "baseline", input=listed)
    expect(finished(folder / "three", code=65)[0]["atlas_sha256"] is None, "a hash though a shard is missing")
    fleet_run(folder / "three", "--list", "-", "--shard", "2/3", input=listed)
    both = [subprocess.Popen([PROGRAM, "fleet", "run", logs, "-o", folder / "both", "--shard", shard, "-q", "-j", "1", *QUICK])
            for shard in ("1/2", "2/2")]
    for process in both:
        expect(process.wait(timeout=300 * cli.SLOWNESS) == 0, "a shard beside another one")
    for name in ("three", "both"):
        expect(finished(folder / name)[0]["atlas_sha256"] == reference, f"{name}: another hash")
    expect({row["device"].rpartition(" ")[2] for row in finished(folder / "three")[1]} > {"baseline"}, "baseline was not used")


def fleet_on_vulkan():
    """The same hash on a Vulkan device."""
    cli.require_vulkan()
    folder = fresh_folder("fleet_on_vulkan")
    logs = make_logs(folder / "logs", count=2)
    reference = done_alone(folder, logs)
    fleet_run(folder / "vulkan", logs, "-q", "--device", "vulkan")
    expect(finished(folder / "vulkan")[0]["atlas_sha256"] == reference, "another hash")


def wait_for(what, message):
    end = time.monotonic() + 60 * cli.SLOWNESS
    while not what():
        expect(time.monotonic() < end, message)
        time.sleep(0.01)


def fleet_resume():
    """Killed, terminated, a damaged record and a run that is gone: the same command ends in the same hash."""
    folder = fresh_folder("fleet_resume")
    logs = make_logs(folder / "logs")
    reference = done_alone(folder, logs)
    atlas = folder / "atlas"
    for sign, code in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGTERM, 130)):
        done = len(list(atlas.glob("logs/*/record.json")))
        process = subprocess.Popen([PROGRAM, "fleet", "run", logs, "-o", atlas, "-j", "2", *QUICK], text=True,
                                   stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
        wait_for(lambda before=done: len(list(atlas.glob("logs/*/record.json"))) > before, "no log was done")
        process.send_signal(sign)
        _, text = process.communicate(timeout=60 * cli.SLOWNESS)
        expect(process.returncode == code, f"exit {process.returncode}: {text}")
        report, rows = finished(atlas, code=65)
        expect(0 < report["mapped"] < 5 and report["missing"] == 5 - report["mapped"], f"{report}, {rows}")
    records = sorted(atlas.glob("logs/*/record.json"))
    records[0].write_bytes(records[0].read_bytes()[:40])
    shutil.rmtree(atlas / "runs" / records[1].parent.name)
    expect(finished(atlas, code=65)[0]["missing"] == report["missing"] + 2, "what is damaged or gone counts as mapped")
    fleet_run(atlas, logs)
    expect(finished(atlas)[0]["atlas_sha256"] == reference, "another hash")
    expect(not list(atlas.rglob(".gdtslam-staging-*")), "something is left of a killed run")


def fleet_failures():
    """A log that is gone, one whose process is killed: recorded, told, and mapped by the same command later; a full disk ends it."""
    folder = fresh_folder("fleet_failures")
    logs = make_logs(folder / "logs", count=3)
    reference = done_alone(folder, logs)
    atlas = folder / "atlas"
    (logs / "drive-1.log").rename(folder / "kept.log")
    (logs / "drive-1.log").symlink_to("../kept.log")
    (logs / "drive-2.log").chmod(0)
    can_read_all = os.access(logs / "drive-2.log", os.R_OK)  # as root can
    process = fleet_run(atlas, logs, code=0 if can_read_all else 74)
    (logs / "drive-2.log").chmod(0o644)
    if not can_read_all:
        expect("drive-2.log failed: cannot be read: Permission denied" in process.stderr, process.stderr)
        report, rows = finished(atlas, code=65)
        expect((report["failed"], report["atlas_sha256"], rows[2]["exit_code"]) == (1, None, "74"), str(report))
    fleet_run(atlas, logs)
    expect(finished(atlas)[0]["atlas_sha256"] == reference, "another hash")
    killed = folder / "killed"
    process = subprocess.Popen([PROGRAM, "fleet", "run", logs, "-o", killed, "-j", "1", *QUICK], text=True, stderr=subprocess.PIPE)
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    wait_for(lambda: children.read_text(), "no log is mapped")
    os.kill(int(children.read_text().split()[0]), signal.SIGKILL)
    _, text = process.communicate(timeout=100 * cli.SLOWNESS)
    expect(process.returncode == 1 and "was ended by signal 9 (Killed)" in text, text)
    report, _ = finished(killed, code=65)
    expect((report["mapped"], report["failed"]) == (2, 1), str(report))
    fleet_run(killed, logs)
    expect(finished(killed)[0]["atlas_sha256"] == reference, "another hash")
    if not cli.IS_SANITIZED:
        process = fleet_run(folder / "full", logs, code=74, env=cli.full_disk(at=12))
        expect("No space left on device" in process.stderr, process.stderr)


def fleet_bad_input():
    """One line each, with the right code; nothing is written."""
    folder = fresh_folder("fleet_bad_input")
    logs = make_logs(folder / "logs", count=1)
    atlas = folder / "atlas"
    (folder / "none").mkdir()
    for arguments, code, words in ((("run", "-o", atlas), 2, "name logs or folders of logs"),
                                   (("run", logs), 2, "--output"),
                                   (("run", folder / "absent.log", "-o", atlas), 74, "absent.log"),
                                   (("run", "--list", folder / "absent.txt", "-o", atlas), 74, "absent.txt"),
                                   (("run", folder / "none", "-o", atlas), 65, "named as a log"),
                                   (("run", logs, "-o", atlas, "--shard", "2/1"), 2, "I from 1 to N"),
                                   (("run", logs, "-o", atlas, "--device", "gpu"), 2, "gpu"),
                                   (("run", logs, "-o", atlas, "--isa", "sse9"), 2, "sse9"),
                                   (("run", logs, "-o", atlas, "--linkage", "paper-z"), 74, "paper-z"),
                                   (("run", logs, "-o", atlas, "--set", "map.resolutoin=1 m"), 78, "map.resolution"),
                                   (("finish", atlas), 74, "gdtslam fleet run LOG")):
        process = command("fleet", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
        expect(not atlas.exists(), "something was written")
    (folder / "site").mkdir()
    (folder / "site/index.html").write_text("somebody's")
    process = fleet_run(folder / "site", logs, code=2)
    expect("index.html, which an atlas would replace" in process.stderr, process.stderr)
    expect(os.listdir(folder / "site") == ["index.html"], "something was written")
    fleet_run(atlas, logs)
    before = sorted(atlas.rglob("*"))
    process = fleet_run(atlas, logs, "--lenient", code=2)
    expect("names other options" in process.stderr, process.stderr)
    expect(sorted(atlas.rglob("*")) == before, "something was written")
