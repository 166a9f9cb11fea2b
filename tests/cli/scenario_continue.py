"""map --continue: the results are those of all logs in one go, byte for byte; and the logs of streams, which come only once."""

import gzip
import json
import os
import random
import shutil
import signal
import subprocess
import time

import cli_support as cli
from cli_support import LOG, PROGRAM, SOURCE, command, digests, expect, expect_exit, one_error_line, scans_in

# Of report.json: what differs from run to run.
TIMES = {"wall_s", "cpu_s", "scans_per_s", "scans_per_core_s", "realtime_factor", "stages", "smooth_s", "assemble_s"}


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items() if key not in TIMES}
    return [without_times(item) for item in value] if isinstance(value, list) else value


def expect_same_run(folder, expected, what):
    """All files but the report are the same bytes, and the report says the same."""
    ours, theirs = digests(folder), digests(expected)
    ours.pop("report.json"), theirs.pop("report.json")
    differ = sorted(name for name in set(ours) | set(theirs) if ours.get(name) != theirs.get(name))
    expect(not differ, f"{what}: {differ} differ")
    expect(without_times(scans_in(folder)) == without_times(scans_in(expected)), f"{what}: report.json differs")


def map_quietly(*arguments, code=0, **options):
    process = command("map", "-q", "--force", *arguments, **options)
    expect_exit(process, code)
    return process


def write_halves(folder, lines):
    """The lines as two logs, cut at the middle scan."""
    scans = [k for k, line in enumerate(lines) if line.split(" ", 1)[0].startswith(("FLASER", "ROBOTLASER1"))]
    middle = scans[len(scans) // 2]
    for name, part in (("a.log", lines[:middle]), ("b.log", lines[middle:])):
        (folder / name).write_text("".join(part))
    return folder / "a.log", folder / "b.log"


def lines_of_drive(scans):
    lines = LOG.read_text().splitlines(keepends=True)
    ends = [k for k, line in enumerate(lines) if line.startswith("FLASER")]
    return lines[:ends[min(scans, len(ends)) - 1] + 1]


def lines_with_odometry_between(scans):
    """Scans that carry no odometry, which is interpolated between ODOM lines of other times."""
    lines = []
    for line in lines_of_drive(scans):
        words = line.split()
        if words[0] != "FLASER":
            continue
        beams = int(words[1])
        stamp = float(words[beams + 8])
        lines.append(f"ODOM {' '.join(words[beams + 5:beams + 8])} 0 0 0 {stamp - 0.03:.6f} robot {stamp - 0.03:.6f}\n")
        lines.append(f"ROBOTLASER1 0 -1.570796 3.141593 0.017453 81.83 0.01 0 {beams} {' '.join(words[2:2 + beams])} 0 "
                     f"0 0 0 0 0 0 0 0 0 0 0 {stamp:.6f} robot {stamp:.6f}\n")
    return lines


def continued_run_is_that_of_all_logs():
    """Half a log, then the other half: the same as both in one go. With ranges that are no whole millimetres, odometry between
    the scans, without loops, and into a folder of its own, which leaves the run as it was."""
    odd = [line if not line.startswith("FLASER") else
           " ".join([*line.split()[:2], *(f"{float(word) + 0.00037:.5f}" for word in line.split()[2:182]), *line.split()[182:]]) + "\n"
           for line in lines_of_drive(120)]
    for name, lines, options in (("plain", lines_of_drive(160), ()), ("odd", odd, ("--no-loops",)),
                                 ("between", lines_with_odometry_between(120), ("--set", "map.resolution=10 cm"))):
        folder = cli.fresh_folder(f"continue_{name}")
        first, second = write_halves(folder, lines)
        map_quietly(first, second, "-o", folder / "both", *options)
        map_quietly(first, "-o", folder / "run", *options)
        before = digests(folder / "run")
        map_quietly("--continue", folder / "run", second, "-o", folder / "other")
        expect_same_run(folder / "other", folder / "both", f"{name}, another folder")
        expect(digests(folder / "run") == before, f"{name}: the run that was continued has changed")
        map_quietly("--continue", folder / "run", second)
        expect_same_run(folder / "run", folder / "both", name)
        process = map_quietly("--continue", folder / "run", second, code=2)
        expect(f"has '{second}' already" in process.stderr, process.stderr)
        map_quietly("--continue", folder / "run")
        expect_same_run(folder / "run", folder / "both", f"{name}, mapped again")


def continued_run_of_a_nodding_laser():
    """The same of a laser that nods, whose linkage lies beside its log."""
    folder = cli.fresh_folder("continue_nodding")
    text = gzip.decompress((SOURCE / "assets/logs/nodding-start.log.gz").read_bytes()).decode()
    first, second = write_halves(folder, text.splitlines(keepends=True))
    shutil.copy(SOURCE / "assets/logs/nodding-start.linkage.yaml", folder / "a.linkage.yaml")
    options = ("--no-pictures", "--set", "cloud.voxel=10 cm")
    map_quietly(first, second, "-o", folder / "both", *options)
    map_quietly(first, "-o", folder / "run", *options)
    map_quietly("--continue", folder / "run", second)
    expect_same_run(folder / "run", folder / "both", "a nodding laser")


def killed_runs_leave_the_old_one():
    """SIGKILL at random moments of `map` over a run: the old run is there, or the new one, whole, and the next run leaves
    nothing of the killed one behind. GDTSLAM_KILLS says how many."""
    kills = int(os.environ.get("GDTSLAM_KILLS", "8"))
    folder = cli.fresh_folder("continue_killed")
    first, second = write_halves(folder, lines_of_drive(200))
    start = time.monotonic()
    map_quietly(first, second, "-o", folder / "new")
    whole_s = time.monotonic() - start
    map_quietly(first, "-o", folder / "old")
    chance = random.Random(17)
    seen = {"old": 0, "new": 0}
    while sum(seen.values()) < kills:
        run = folder / "run"
        shutil.rmtree(run, ignore_errors=True)
        shutil.copytree(folder / "old", run)
        process = subprocess.Popen([PROGRAM, "map", "-q", "--force", str(first), str(second), "-o", str(run)], stdin=subprocess.DEVNULL)
        try:
            process.wait(timeout=chance.uniform(0.0, whole_s))
        except subprocess.TimeoutExpired:
            process.kill()
        if process.wait() == 0:
            continue
        is_new = digests(run) != digests(folder / "old")
        if is_new:
            expect_same_run(run, folder / "new", f"kill {seen}")
        seen["new" if is_new else "old"] += 1
        map_quietly(first, second, "-o", run)
        expect(not [path.name for path in folder.iterdir() if path.name.startswith(".")], list(folder.iterdir()))
    expect(seen["old"] > 0, f"{seen}")


def start_stream(run, lines):
    """A drive over standard input of which these lines came, once a part of them is kept."""
    process = subprocess.Popen([PROGRAM, "map", "-q", "-", "-o", str(run)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stdin.write("".join(lines[:-1]))
    process.stdin.flush()
    kept = run.parent / f".{run.name}.gdtslam-new" / "log-1.jsonl.zst"
    end = time.monotonic() + 60 * cli.SLOWNESS
    while not (kept.exists() and kept.stat().st_size > 0):
        expect(time.monotonic() < end and process.poll() is None, "the drive did not begin")
        time.sleep(1.1)  # what comes a second later ends what is waiting
        process.stdin.write(lines[-1])
        process.stdin.flush()
    return process


def the_log_of_a_stream_is_kept():
    """Of a run over standard input it lies in the run, and gives the same map; an interrupted drive has it too, a killed one leaves
    it beside the folder."""
    folder = cli.fresh_folder("continue_stream")
    lines = lines_of_drive(120)
    first, second = write_halves(folder, lines)
    map_quietly(folder / "a.log", "-o", folder / "file")
    map_quietly("-", "-o", folder / "pipe", input=first.read_text())
    map_quietly(folder / "pipe/log-1.jsonl.zst", "-o", folder / "again")
    for name in ("map.pgm", "trajectory.tum", "gdt.png"):
        expect((folder / "again" / name).read_bytes() == (folder / "file" / name).read_bytes(), f"{name} of the log that was kept")
    map_quietly("--continue", folder / "pipe", second)
    expect((folder / "pipe/log-1.jsonl.zst").exists(), "the log is gone")
    map_quietly(first, second, "-o", folder / "both")
    expect((folder / "pipe/map.pgm").read_bytes() == (folder / "both/map.pgm").read_bytes(), "another map")
    process = map_quietly(folder / "pipe/log-1.jsonl.zst", "-o", folder / "pipe", code=2)
    expect("lies in the folder that would be replaced" in process.stderr, process.stderr)
    process = start_stream(folder / "cut", lines)
    process.send_signal(signal.SIGINT)
    expect_exit(cli.finish(process), 130)
    expect((folder / "cut/log-1.jsonl.zst").stat().st_size > 0, "an interrupted drive has no log")
    process = start_stream(folder / "killed", lines)
    process.kill()
    process.communicate()
    expect(not (folder / "killed").exists(), "a killed drive left a folder")
    process = command("map", first, "-o", folder / "killed")
    expect_exit(process, 0)
    expect("killed-left-1.jsonl.zst" in process.stderr, process.stderr)
    map_quietly(folder / "killed-left-1.jsonl.zst", "-o", folder / "found")
    expect(scans_in(folder / "found")["scans"] > 0, "nothing was kept")


def continue_mistakes():
    """No run, options of the run, --first, a log that is gone or another: exit code and one line, and nothing changes."""
    folder = cli.fresh_folder("continue_mistakes")
    log = folder / "a.log"
    log.write_text("".join(lines_of_drive(40)))
    map_quietly(log, "-o", folder / "part", "--first", 20)
    map_quietly("--continue", folder / "part")
    expect(scans_in(folder / "part")["scans"] == 20, "other scans than the first 20")
    map_quietly(log, "-o", folder / "run")
    for name, change in (("gone", lambda path: path.unlink()), ("other", lambda path: path.write_text("".join(lines_of_drive(41))))):
        shutil.copy(log, folder / f"{name}.log")
        map_quietly(folder / f"{name}.log", "-o", folder / name)
        change(folder / f"{name}.log")
    for name, text in (("damaged", "{"), ("list", "[]"), ("empty", "{}"), ("newer", '{"format": 7}')):
        shutil.copytree(folder / "run", folder / name)
        (folder / name / "continue.json").write_text(text)
    shutil.copytree(folder / "run", folder / "stranger")  # names a file that the stranger cannot know
    kept = json.loads((folder / "run/continue.json").read_text())
    kept["logs"][0]["path"] = "/etc/passwd"
    (folder / "stranger/continue.json").write_text(json.dumps(kept))
    cases = [(["--continue", folder / "nowhere"], 65, "has no continue.json"),
             (["--continue", folder / "gone"], 65, "is not there; put it back"),
             (["--continue", folder / "other"], 65, "has another SHA-256"),
             (["--continue", folder / "stranger"], 65, "/etc/passwd: has another SHA-256"),
             (["--continue", folder / "part", log], 2, "--first"),
             (["--continue", folder / "part", "--set", "map.resolution=10 cm"], 2, "--set"),
             (["--continue", folder / "part", "--no-loops"], 2, "--no-loops"),
             ([], 2, "log is required"),
             *((["--continue", folder / name], 65, "continue.json") for name in ("damaged", "list", "empty", "newer"))]
    for arguments, code, text in cases:
        before = digests(folder)
        process = command("map", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(text in process.stderr, process.stderr)
        expect(digests(folder) == before, f"{arguments}: files changed")


def a_stream_with_a_log_that_fails():
    """A log that is misspelt or damaged takes what came over standard input nothing: it is kept beside the folder."""
    folder = cli.fresh_folder("continue_of_a_stream")
    first, second = write_halves(folder, lines_of_drive(120))
    damaged = folder / "damaged.log"
    damaged.write_text(second.read_text() + "FLASER 3 1.0\n")
    map_quietly("-", "-o", folder / "run", input=first.read_text())
    for number, log, code in ((1, folder / "nowhere.log", 74), (2, damaged, 65)):
        process = command("map", "-q", "-", log, "-o", folder / "new", input=first.read_text())
        expect_exit(process, code)
        one_error_line(process.stderr)
        kept = folder / f"new-left-{number}.jsonl.zst"
        expect(f"what was read is kept: gdtslam map {kept}" in process.stderr, process.stderr)
        map_quietly(kept, "-o", folder / "of_kept")
        expect(scans_in(folder / "of_kept")["scans"] == scans_in(folder / "run")["scans"], "not what had come")
        expect(not (folder / "new").exists(), "a folder of a run that failed")
