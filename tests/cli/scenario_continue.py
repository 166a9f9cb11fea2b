"""map --continue: what is gone on with is what was mapped in one go, byte for byte, whenever and however the run ended."""

import fcntl
import gzip
import json
import os
import pathlib
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
    process = command("map", "-q", *arguments, **options)
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
    """Half a log, then the other half, the first one gone by then: the same as both in one go. With ranges that are no whole
    millimetres, odometry between the scans, without loops, and into a folder of its own, which leaves the run as it was."""
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
        first.unlink()
        map_quietly("--continue", folder / "run", second, "-o", folder / "other")
        expect_same_run(folder / "other", folder / "both", f"{name}, another folder")
        expect(digests(folder / "run") == before, f"{name}: the run that was gone on with has changed")
        map_quietly("--continue", folder / "run", second)
        expect_same_run(folder / "run", folder / "both", name)
        process = command("map", "--continue", folder / "run", second)
        expect_exit(process, 0)
        expect("ends with this log already" in process.stderr, process.stderr)
        expect_same_run(folder / "run", folder / "both", f"{name}, the same log again")
        second.unlink()
        map_quietly("--continue", folder / "run")
        expect_same_run(folder / "run", folder / "both", f"{name}, mapped again")
        # A copy is a log like any other.
        map_quietly(folder / "run" / "log-1.copy", folder / "run" / "log-2.copy", "-o", folder / "of_copies", *options)
        for file in ("trajectory.tum", "gdt.png", "map.pgm", "log-1.copy"):
            expect(digests(folder / "of_copies")[file] == digests(folder / "both")[file], f"{name}: {file} of the copies")


def continued_run_of_a_nodding_laser():
    """The same of a laser that nods, whose linkage lies beside its log; without it afterwards."""
    folder = cli.fresh_folder("continue_nodding")
    text = gzip.decompress((SOURCE / "assets/logs/nodding-start.log.gz").read_bytes()).decode()
    first, second = write_halves(folder, text.splitlines(keepends=True))
    shutil.copy(SOURCE / "assets/logs/nodding-start.linkage.yaml", folder / "a.linkage.yaml")
    options = ("--no-pictures", "--set", "cloud.voxel=10 cm")
    map_quietly(first, second, "-o", folder / "both", *options)
    map_quietly(first, "-o", folder / "run", *options)
    first.unlink()
    (folder / "a.linkage.yaml").unlink()
    map_quietly("--continue", folder / "run", second)
    expect_same_run(folder / "run", folder / "both", "a nodding laser")


def warnings_of_a_log_that_is_gone():
    """What the reader had to say of the first log is in the report of the run that was gone on with."""
    folder = cli.fresh_folder("continue_warnings")
    first, second = write_halves(folder, lines_of_drive(60))
    first.write_text("NEVERHEARD 1 2 3\nFLASER 3 much\n" + first.read_text() + "NEVERHEARD 1 2 3\n")
    map_quietly(first, second, "--lenient", "-o", folder / "both")
    map_quietly(first, "--lenient", "-o", folder / "run")
    first.unlink()
    map_quietly("--continue", folder / "run", second)
    expect_same_run(folder / "run", folder / "both", "warnings")
    expect(scans_in(folder / "run")["warnings"] == {"skipped message NEVERHEARD": 2, "malformed line": 1},
           scans_in(folder / "run")["warnings"])


def killed(arguments, after_s):
    """A run that is killed so many seconds after its start, unless it ends before, for there may be nothing to go on with yet;
    whether it was."""
    process = subprocess.Popen([PROGRAM, "map", "-q", *map(str, arguments)], stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        _, stderr = process.communicate(timeout=after_s)
    except subprocess.TimeoutExpired:
        process.kill()
        _, stderr = process.communicate()
    is_empty = process.returncode == 65 and "--continue" in arguments and "has no run to go on with" in stderr
    expect(process.returncode in (0, -signal.SIGKILL) or is_empty, f"exit {process.returncode}: {stderr}")
    return process.returncode == -signal.SIGKILL


def killed_runs_go_on():
    """SIGKILL at random moments of `map` and of `map --continue`: gone on with, it is the run that was not killed, and no file
    is left over. GDTSLAM_KILLS says how many."""
    kills = int(os.environ.get("GDTSLAM_KILLS", "8"))
    folder = cli.fresh_folder("continue_killed")
    first, second = write_halves(folder, lines_of_drive(400))
    logs = (first, second)
    start = time.monotonic()
    map_quietly(*logs, "-o", folder / "both")
    whole_s = time.monotonic() - start
    map_quietly(first, "-o", folder / "first")
    chance = random.Random(17)
    seen = {"killed": 0, "again": 0, "nothing to go on with": 0, "ended before": 0}
    while seen["killed"] < kills:
        run = folder / "run"
        shutil.rmtree(run, ignore_errors=True)
        with_continue = chance.random() < 0.5
        if with_continue:
            shutil.copytree(folder / "first", run)
        arguments = ["--continue", run, second] if with_continue else [*logs, "-o", run]
        if not killed(arguments, chance.uniform(0.0, whole_s)):
            seen["ended before"] += 1
            continue
        seen["killed"] += 1
        while chance.random() < 0.4 and killed(["--continue", run, *([second] if with_continue else [])],
                                               chance.uniform(0.0, whole_s)):
            seen["again"] += 1
        process = command("map", "-q", "--continue", run, *([second] if with_continue else []))
        if process.returncode == 65 and "has no run to go on with" in process.stderr and not with_continue:
            expect(not run.exists() or not any(run.glob(".gdtslam-staging-*/continue.json")), process.stderr)
            seen["nothing to go on with"] += 1
            continue
        expect_exit(process, 0)
        expect_same_run(run, folder / "both", f"kill {seen}")
    print(seen)
    expect(seen["nothing to go on with"] <= max(1, kills // 3), f"{seen}")


def killed_run_finds_its_log():
    """A killed run whose log is gone, or another: one line, and what was copied is still there when the log is back."""
    folder = cli.fresh_folder("continue_log")
    log = folder / "a.log"
    lines = lines_of_drive(400)
    log.write_text("".join(lines))
    map_quietly(log, "-o", folder / "both")
    process = subprocess.Popen([PROGRAM, "map", "-q", str(log), "-o", str(folder / "run")], stdin=subprocess.DEVNULL)
    copies = []
    while process.poll() is None and not (copies and copies[0].stat().st_size > 20000):
        copies = list(folder.glob("run/.gdtslam-staging-*/log-1.copy"))
    process.kill()
    expect(process.wait() == -signal.SIGKILL, "the run ended before it could be killed")
    copy = copies[0]
    # As after a power failure: the end of what was written is not what was meant.
    copy.write_bytes(copy.read_bytes()[:len(copy.read_bytes()) * 2 // 3] + b"\0" * 100)
    log.unlink()
    process = command("map", "--continue", folder / "run")
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect("a.log" in process.stderr and "put it back" in process.stderr, process.stderr)
    log.write_text("".join([*lines[:5], *lines[6:]]))
    process = command("map", "-q", "--continue", folder / "run")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("is not the log that the run was reading" in process.stderr, process.stderr)
    expect(not (folder / "run" / "report.json").exists(), "a report of a run that failed")
    log.write_text("".join(lines))
    process = command("map", "-q", "--continue", folder / "run", LOG)
    expect_exit(process, 2)
    expect("is unfinished" in process.stderr, process.stderr)
    map_quietly("--continue", folder / "run")
    expect_same_run(folder / "run", folder / "both", "the log is back")


def recording_of_a_killed_drive_is_kept():
    """What a killed drive left may be all that there is of its log: an edit and another run that fail in its folder leave it, a
    merge leaves it, and it is gone on with in place of a file of somebody else where --force says so, and at no other time."""
    folder = cli.fresh_folder("continue_recording")
    lines = lines_of_drive(120)
    run, drive = folder / "run", folder / "drive"
    map_quietly(*write_halves(folder, lines), "-o", run)
    map_quietly(folder / "b.log", "-o", folder / "half")
    process = subprocess.Popen([PROGRAM, "map", "-q", "-", "-o", str(drive)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stdin.write("".join(lines))
    process.stdin.flush()
    end = time.monotonic() + 60 * cli.SLOWNESS
    while not has_copied(drive, 1000) or not list(drive.glob(".gdtslam-staging-*/continue.json")):
        expect(time.monotonic() < end and process.poll() is None, "the drive did not begin")
        time.sleep(0.02)
    process.kill()
    process.communicate()
    recording = lambda: {str(path): path.read_bytes() for path in drive.glob(".gdtslam-staging-*/*")}
    before = recording()
    expect(len(before) == 2, f"{sorted(before)}")
    for arguments, code in ((("edit", run, "--crop", "900,900,901,901"), 65), (("map", "--continue", run, folder / "none.log"), 74),
                            (("merge", run, folder / "half"), 0)):
        expect_exit(command(*arguments, "-o", drive, "-q"), code)
        expect(recording() == before, f"{arguments}: the recording is gone")
    for arguments, place in ((("--continue", run, "-o", folder / "other"), folder / "other"), (("--continue", drive), drive)):
        place.mkdir(exist_ok=True)
        (place / "map.yaml").touch()
        process = map_quietly(*arguments, code=2)
        expect("--force to replace it" in process.stderr and recording() == before, process.stderr)
        map_quietly(*arguments, "--force")
        expect((place / "map.yaml").stat().st_size > 0, f"{arguments}: map.yaml of somebody else stays")
    expect(scans_in(drive)["scans"] > 0 and not recording(), "the drive is not mapped")


def has_copied(folder, size):
    """Whether a run that is being made has so much of its log's copy."""
    try:
        return any(copy.stat().st_size > size for copy in folder.rglob("log-1.copy"))
    except FileNotFoundError:  # it got its name meanwhile
        return True


def interrupted_run_goes_on():
    """After SIGINT the rest of the log is mapped as if there had been none; what came over a pipe cannot come again."""
    folder = cli.fresh_folder("continue_interrupted")
    log = folder / "a.log"
    log.write_text("".join(lines_of_drive(400)))
    map_quietly(log, "-o", folder / "both")
    process = subprocess.Popen([PROGRAM, "map", "-q", str(log), "-o", str(folder / "run"), "--set", "search.when=always"],
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 15 * cli.SLOWNESS
    while process.poll() is None and not has_copied(folder / "run", 1000) and time.monotonic() < end:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    cli.finish(process)
    expect(process.returncode in (0, 130), f"exit {process.returncode}")
    map_quietly(log, "-o", folder / "both", "--set", "search.when=always")
    map_quietly("--continue", folder / "run")
    expect_same_run(folder / "run", folder / "both", "interrupted")
    # A pipe that was cut, and a second one: two logs.
    first, second = write_halves(folder, lines_of_drive(120))
    map_quietly(first, second, "-o", folder / "both")
    process = subprocess.Popen([PROGRAM, "map", "-q", "-", "-o", str(folder / "pipe")], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdin.write(first.read_text())
    process.stdin.flush()
    time.sleep(0.25 * cli.SLOWNESS)
    process.send_signal(signal.SIGINT)
    expect_exit(cli.finish(process), 130)
    map_quietly("--continue", folder / "pipe", "-", input=second.read_text())
    poses = [len((folder / run / "trajectory.tum").read_text().splitlines()) for run in ("pipe", "both")]
    expect(poses[0] in (poses[1], poses[1] - 1), f"{poses} poses")


def continue_mistakes():
    """No run, no copies, options of the run, --first, another process: exit code and one line, and nothing changes."""
    folder = cli.fresh_folder("continue_mistakes")
    log = folder / "a.log"
    log.write_text("".join(lines_of_drive(40)))
    map_quietly(log, "-o", folder / "none", "--no-copy")
    expect(not (folder / "none" / "log-1.copy").exists() and not (folder / "none" / "continue.json").exists(), "a copy")
    map_quietly(log, "-o", folder / "part", "--first", 20)
    map_quietly("--continue", folder / "part")
    expect(scans_in(folder / "part")["scans"] == 20, "other scans than the first 20")
    cases = [(["--continue", folder / "nowhere"], 65, "no run to go on with"),
             (["--continue", folder / "none", log], 65, "no run to go on with"),
             (["--continue", folder / "part", log], 2, "--first"),
             (["--continue", folder / "part", "--set", "map.resolution=10 cm"], 2, "--set"),
             (["--continue", folder / "part", "--no-loops"], 2, "--no-loops"),
             (["--continue", folder / "part", folder / "nowhere.log"], 2, "--first"),
             ([], 2, "log is required")]
    map_quietly(log, "-o", folder / "run")
    damaged = folder / "damaged"
    shutil.copytree(folder / "run", damaged)
    for text in ("{", "[]", "{}", '{"format": 7}'):
        (damaged / "continue.json").write_text(text)
        before = digests(damaged)
        process = command("map", "--continue", damaged)
        expect_exit(process, 65)
        one_error_line(process.stderr)
        expect("continue.json" in process.stderr and digests(damaged) == before, process.stderr)
    for arguments, code, text in cases:
        before = digests(folder)
        process = command("map", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(text in process.stderr, process.stderr)
        expect(digests(folder) == before, f"{arguments}: files changed")
    living = folder / "run" / f".gdtslam-staging-{os.getpid()}"
    living.mkdir()
    held = os.open(folder / "run", os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    process = command("map", "--continue", folder / "run")
    os.close(held)
    expect_exit(process, 2)
    expect(f"process {os.getpid()} is writing" in process.stderr, process.stderr)


def continue_of_a_stream_with_a_log_that_fails():
    """A log that is misspelt or damaged takes a run of the standard input nothing, and holds it up in nothing: what came once
    is kept, without that log."""
    folder = cli.fresh_folder("continue_of_a_stream")
    first, second = write_halves(folder, lines_of_drive(120))
    damaged = folder / "damaged.log"
    damaged.write_text(second.read_text() + "FLASER 3 1.0\n")
    map_quietly(first, second, "-o", folder / "both")
    map_quietly("-", "-o", folder / "run", input=first.read_text())
    for log, code in ((folder / "nowhere.log", 74), (damaged, 65)):
        before = digests(folder)
        process = command("map", "-q", "--continue", folder / "run", log)
        expect_exit(process, code)
        expect("is kept" not in process.stderr and digests(folder) == before, process.stderr)
        process = command("map", "-q", "-", log, "-o", folder / "new", input=first.read_text())
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect("what came by then is kept" in process.stderr, process.stderr)
        map_quietly("--continue", folder / "new")
        expect(scans_in(folder / "new")["scans"] == scans_in(folder / "run")["scans"], "not what had come")
        shutil.rmtree(folder / "new")
    map_quietly("--continue", folder / "run", second)
    for name in ("map.pgm", "trajectory.tum", "graph.g2o"):  # of pictures and continue.json the names of the logs are others
        same = (folder / "run" / name).read_bytes() == (folder / "both" / name).read_bytes()
        expect(same, f"{name}: gone on with after two logs that failed")


def run_with_fewer_logs_leaves_no_copy():
    """A run of one log into the folder of a run of two leaves one copy; a run without copies none."""
    folder = cli.fresh_folder("continue_fewer")
    first, second = write_halves(folder, lines_of_drive(40))
    copies = lambda: sorted(path.name for path in pathlib.Path(folder / "run").glob("*.copy"))
    map_quietly(first, second, "-o", folder / "run")
    expect(copies() == ["log-1.copy", "log-2.copy"], copies())
    map_quietly(first, "-o", folder / "run")
    expect(copies() == ["log-1.copy"], copies())
    kept = json.loads((folder / "run" / "continue.json").read_text())
    expect(kept["log"] == [str(first)] and kept["path"] == [str(first)], kept["log"])
    map_quietly(first, "-o", folder / "run", "--no-copy")
    expect(copies() == [] and not (folder / "run" / "continue.json").exists(), copies())
