"""A run folder is one thing: whoever reads a run notices a file that is not the one that the run wrote, and at no moment do
files of two runs lie beside each other."""

import hashlib
import os
import shutil
import subprocess
import time

import cli_support as cli
from cli_support import LOG, PROGRAM, SOURCE, TRUTH, command, digests, expect, expect_exit, mapped, one_error_line, scans_in, without_told_files

HAS_VIEWER = os.environ.get("GDTSLAM_VIEWER") == "1"
NODDING_LOG = SOURCE / "assets/logs/nodding-start.log.gz"
PICTURES = {cli.OVERVIEW, cli.OVERVIEW.replace("overview", "graph"), "cloud.png"}
SMALL = ("--size", "64x64")

# What each reader of a run reads of it: arguments with the run's folder, another run, and a folder for what is written.
MAP, FIELD, PATH = {"map.pgm", "map.yaml"}, {"gdt.png", "gdt.yaml"}, {"trajectory.tum"}
KEYFRAMES, CONTINUED = {"keyframes.bin.gz", "config.yaml"}, {"continue.json"}
READERS = {
    "localize": (lambda run, other, out: ("localize", run, LOG, "--scan", 3, "-o", out / "a.tum"), FIELD),
    "localize --changes": (lambda run, other, out: ("localize", run, LOG, "--track", "--changes", out / "a.svg"),
                           FIELD | MAP | {"keyframes.bin.gz"}),
    "live --map": (lambda run, other, out: ("live", "--map", run, "-"), FIELD),
    "evaluate": (lambda run, other, out: ("evaluate", run, "--reference", TRUTH), PATH | {"covariance.csv"}),
    "evaluate --reference": (lambda run, other, out: ("evaluate", TRUTH, "--reference", run), PATH),
    "doctor --after": (lambda run, other, out: ("doctor", "--after", run), PATH | {"covariance.csv"}),
    "merge": (lambda run, other, out: ("merge", other, run, "-o", out / "site"), KEYFRAMES | PATH | {"graph.g2o"}),
    "edit": (lambda run, other, out: ("edit", run, "-o", out / "edited", "--origin", "1,1"),
             KEYFRAMES | PATH | CONTINUED | {"covariance.csv", "graph.g2o"}),
    "edit --crop": (lambda run, other, out: ("edit", run, "-o", out / "edited", "--crop", "-9,-9,99,99"), KEYFRAMES | MAP),
    "map --continue": (lambda run, other, out: ("map", "--continue", run, LOG, "-o", out / "more"), set()),
}
VIEWS = {
    "render map": (lambda run, other, out: ("render", run, "--view", "map", "-o", out / "a.png", *SMALL), MAP | PATH),
    "render field": (lambda run, other, out: ("render", run, "--view", "field", "-o", out / "a.png", *SMALL), FIELD | PATH),
    "render graph": (lambda run, other, out: ("render", run, "--view", "graph", "-o", out / "a.png", *SMALL),
                     MAP | PATH | {"covariance.csv"}),
    "render loops": (lambda run, other, out: ("render", run, "--view", "loops", "-o", out / "a.png", *SMALL), {"graph.g2o"}),
}
NODDING_READERS = {
    "evaluate --planes": (lambda run, other, out: ("evaluate", run, "--planes"), {"cloud.ply"}),
}
NODDING_VIEWS = {
    "render cloud": (lambda run, other, out: ("render", run, "--view", "cloud", "-o", out / "a.png", *SMALL), {"cloud.ply", "linkage.yaml"}),
}


def told_files(run):
    """name: (bytes, SHA-256) by report.json."""
    return {name: (size, sha256) for name, size, sha256 in scans_in(run)["files"]}


def lying_files(run):
    return {path.name: (path.stat().st_size, hashlib.sha256(path.read_bytes()).hexdigest())
            for path in run.iterdir() if path.name != "report.json"}


def faults_of(name, run, other):
    """The file with a byte changed, cut, removed, and as another run has it."""
    data = (run / name).read_bytes()
    yield "changed", data[:len(data) // 2] + bytes([data[len(data) // 2] ^ 1]) + data[len(data) // 2 + 1:]
    yield "cut", data[:-1]
    yield "removed", None
    if (other / name).exists() and (other / name).read_bytes() != data:
        yield "of another run", (other / name).read_bytes()


def expect_noticed(readers, run, other, folder):
    """Each reader ends with 65 and one line that names the file, whatever is wrong with it, and writes nothing."""
    copy = folder / "copy"
    for reader, (arguments, names) in readers.items():
        for name in sorted(names):
            for fault, data in faults_of(name, run, other):
                shutil.rmtree(copy, ignore_errors=True)
                shutil.copytree(run, copy)
                (copy / name).unlink() if data is None else (copy / name).write_bytes(data)
                if name == "continue.json" and data is None and reader.startswith("edit"):
                    continue  # who leaves the copies out wants the keyframes
                out = cli.fresh_folder(f"{folder.name}/out")
                before = digests(copy)
                process = command(*arguments(copy, other, out))
                what = f"{reader}: {name} {fault}: exit {process.returncode}: {process.stderr}"
                expect(process.returncode == 65, what)
                one_error_line(process.stderr)
                expect(str(copy / name) in process.stderr or name == "continue.json", what)
                expect(not any(out.iterdir()) and digests(copy) == before, f"{what}: something was written")


def readers_notice_other_files():
    """Every file of a run that a command reads, changed, cut, removed and of another run: 65 and one line."""
    folder = cli.fresh_folder("readers_notice")
    run, other = folder / "run", folder / "other"
    mapped(run, "--first", 120)
    mapped(other, "--first", 150, "--set", "map.resolution=10 cm")
    expect(told_files(run) == lying_files(run), f"report.json tells of {sorted(told_files(run))}, there are {sorted(lying_files(run))}")
    readers = {**READERS, **(VIEWS if HAS_VIEWER else {})}
    read = set().union(*(names for _, names in READERS.values()))
    expect(set(told_files(run)) - PICTURES == read, f"no reader is asked about {set(told_files(run)) - PICTURES - read}")
    expect_noticed(readers, run, other, folder)


def readers_notice_another_cloud():
    """Likewise of a run with a cloud."""
    folder = cli.fresh_folder("readers_notice_cloud")
    run, other = folder / "run", folder / "other"
    expect_exit(command("map", NODDING_LOG, "-o", run, "-q"), 0)
    expect_exit(command("map", NODDING_LOG, "-o", other, "-q", "--set", "cloud.voxel=20 cm"), 0)
    expect(told_files(run) == lying_files(run), f"report.json tells of {sorted(told_files(run))}, there are {sorted(lying_files(run))}")
    expect_noticed({**NODDING_READERS, **(NODDING_VIEWS if HAS_VIEWER else {})}, run, other, folder)


def files_that_no_reader_minds():
    """What a command does not read may be gone. A map that was cleaned by hand: a line that helps, and map.yaml named itself is
    taken. Reports that tell of no files, as older versions wrote them, are read as they were."""
    folder = cli.fresh_folder("no_reader_minds")
    run = folder / "run"
    mapped(run, "--first", 120)
    for name in (*PICTURES, "continue.json", "keyframes.bin.gz", "gdt.png"):
        (run / name).unlink(missing_ok=True)
    expect_exit(command("doctor", "--after", run), 0)
    mapped(run, "--first", 120)
    pgm = (run / "map.pgm").read_bytes()
    (run / "map.pgm").write_bytes(pgm[:-1] + bytes([0 if pgm[-1] else 254]))
    process = command("edit", run, "-o", folder / "edited", "--crop", "-9,-9,99,99")
    expect_exit(process, 65)
    for word in ("map.pgm", "gdtslam edit", "map.yaml itself", "map the log again: gdtslam map LOG -o"):
        expect(word in process.stderr, process.stderr)
    expect_exit(command("localize", run / "map.yaml", LOG, "--scan", 3, "-q"), 0)
    without_told_files(run)
    (run / "covariance.csv").write_text((run / "covariance.csv").read_text())
    expect_exit(command("edit", run, "-o", folder / "edited", "--crop", "-9,-9,99,99", "-q"), 0)
    expect(told_files(folder / "edited") == lying_files(folder / "edited"), "an edit tells of other files than it wrote")


def start_writer(folder):
    """A run that has begun to write to the folder and waits for more of its log."""
    process = subprocess.Popen([PROGRAM, "map", "-", "-o", str(folder), "--force", "-q"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    process.stdin.write("".join(LOG.read_text().splitlines(keepends=True)[:400]))
    process.stdin.flush()
    deadline = time.monotonic() + 60
    while not (folder.parent / f".{folder.name}.gdtslam-new" / "log-1.jsonl.zst").exists():
        expect(time.monotonic() < deadline and process.poll() is None, "the first writer did not begin")
        time.sleep(0.02)
    return process


def two_writers():
    """While one process writes to a folder, each other ends with 2 and one line, by whatever name it calls the folder. A killed
    one keeps nobody out."""
    place = cli.fresh_folder("two_writers")
    folder = place / "run"
    mapped(folder, "--first", 40)
    (place / "other").mkdir()
    mapped(place / "other", "--first", 40)
    (place / "link").symlink_to("run")
    first = start_writer(folder)
    before = digests(folder)
    for arguments in (("map", LOG, "-o", folder, "--first", 50), ("map", LOG, "-o", place / "link", "--first", 50),
                      ("edit", place / "other", "-o", folder, "--origin", "1,1"),
                      ("map", "--continue", place / "other", "-o", folder)):
        process = command(*arguments, "--force")
        expect_exit(process, 2)
        one_error_line(process.stderr)
        expect("is writing to" in process.stderr, process.stderr)
        expect(digests(folder) == before, f"{arguments}: the folder changed")
    stdout, stderr = first.communicate(timeout=60 * cli.SLOWNESS)
    expect(first.returncode == 0, f"exit {first.returncode}: {stderr}")
    expect(told_files(folder) == lying_files(folder), "the first writer's run is not whole")
    killed = start_writer(folder)
    killed.kill()
    killed.wait()
    mapped(folder, "--first", 50)
    expect(told_files(folder) == lying_files(folder), "the run after a killed one is not whole")
