"""What the tests of the C interface and the Python package share."""
import gzip
import json
import os
import pathlib
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["GDTSLAM_SOURCE"])
LIBRARY = pathlib.Path(os.environ["GDTSLAM_LIBRARY"])
WORK = pathlib.Path(os.environ["GDTSLAM_BINDINGS_WORK"])
HEADER = SOURCE / "engine/c/include/gdtslam.h"
SAMPLE = SOURCE / "assets/logs/office-start.log.gz"
SKIPPED = 77


def fail(text):
    sys.exit(f"FAILED: {text}")


def skip_without(program, package):
    """The program's path. Without it the test is skipped, or with GDTSLAM_REQUIRE_PROGRAMS=1 fails."""
    found = shutil.which(program)
    if found:
        return found
    print(f"SKIPPED: no {program} on this machine (package {package})")
    sys.exit(1 if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1" else SKIPPED)


def run(*command, status=0, **how):
    """The standard output of a program that ends as it should."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **how)
    if done.returncode != status:
        fail(f"exit {done.returncode} instead of {status}: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def folder(name):
    """A new one for a test."""
    path = WORK / name
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir(parents=True)
    return path


def sample_hashes(loops=True):
    """Those that ship with the sample log: of the map and the trajectory."""
    runs = json.loads((SOURCE / "assets/expected/office-start.json").read_text())["runs"]
    for one in runs:
        if one["matcher"] == "gauss-newton" and one["loops"] == loops:
            return one["map_sha256"], one["trajectory_sha256"]
    return fail("assets/expected has no such run")


def same_run(command, other):
    """Fails unless two folders hold the same files of the same bytes; report.json, which holds times, the same hashes."""
    names = sorted(path.name for path in command.iterdir())
    if names != sorted(path.name for path in other.iterdir()):
        fail(f"{other} holds {sorted(path.name for path in other.iterdir())} and not {names}")
    for name in names:
        a, b = (command / name).read_bytes(), (other / name).read_bytes()
        if name == "report.json":
            a, b = ([json.loads(text)[key] for key in ("map_sha256", "trajectory_sha256", "scans")] for text in (a, b))
        if a != b:
            fail(f"{name} differs between {command} and {other}")


def unpacked(path):
    return gzip.decompress(path.read_bytes())
