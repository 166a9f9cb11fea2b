#!/usr/bin/env python3
"""One of each command under valgrind's memcheck: `memcheck.py PROGRAM [--commands map,over,...] [--limit SECONDS]`.

The commands that write are those of command_cases.py; those that read look at what they made. Each ends as it does without
valgrind: memory that was never written or is freed, and memory that nobody can free any more, are errors. Processes that a
command starts are looked at too, other programs than this one excepted. tests/memcheck.supp names what libraries do, with the
reason.

Prints a table as Markdown, and valgrind's words of each error; the exit code is 1 where there is one, or where a command
does not end with 0."""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import command_cases  # noqa: E402
from command_cases import Case, QUICK  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOUND = 99
VALGRIND = ("valgrind", "--quiet", f"--error-exitcode={FOUND}", "--num-callers=24", "--leak-check=full",
            "--errors-for-leak-kinds=definite", "--show-leak-kinds=definite", "--keep-debuginfo=yes",
            "--trace-children=yes", "--trace-children-skip=*/ffmpeg,*/sh,*/git",
            f"--suppressions={ROOT}/tests/memcheck.supp")


def prepare_drive(folder, run):
    command_cases.short_log(folder, run, 300)
    command_cases.short_log(folder, run, 60, "next.log", 200)
    run("map", "drive.log", "-o", "run", "-q", "--no-pictures", *QUICK, cwd=folder)


def prepare_truth(folder, run):
    run("simulate", "office-loop", "-o", "drive.log", "--seed", 3, "--rate", 5, "-q", cwd=folder)
    run("map", "drive.log", "-o", "run", "-q", "--no-pictures", cwd=folder)


READERS = (
    Case("localize", prepare_drive, ("localize", "run", "next.log", "--scan", 3)),
    Case("track", prepare_drive, ("localize", "run", "next.log", "--track", "-o", "out.tum", "-q")),
    Case("evaluate", prepare_truth, ("evaluate", "run", "--reference", "drive.truth.tum")),
    Case("doctor", command_cases.prepare_map, ("doctor", "drive.log")),
    Case("live", command_cases.prepare_map, ("live", "drive.log", "-o", "out", "-q", *QUICK)),
    Case("tiles", command_cases.prepare_run, ("tiles", "run")),
    Case("linkage", command_cases.prepare_3d, ("linkage", "drive.linkage.yaml")),
    Case("measure", command_cases.prepare_cloud, ("measure", "run", "--planes", "--boxes")),
    Case("config", lambda folder, run: None, ("config", "show")),
    Case("devices", lambda folder, run: None, ("devices",)),
)
CASES = {**command_cases.CASES, **{case.name: case for case in READERS}}


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--commands", help=f"of: {', '.join(CASES)} (default: all)")
    parser.add_argument("--limit", type=float, default=1800.0, help="seconds that a command may take (1800)")
    arguments = parser.parse_args()
    arguments.commands = arguments.commands.split(",") if arguments.commands else list(CASES)
    if unknown := set(arguments.commands) - set(CASES):
        parser.error(f"no command {', '.join(sorted(unknown))}")
    if shutil.which("valgrind") is None:
        parser.error("there is no valgrind; tools/soak.sh memcheck installs it")
    return arguments


class Bench:
    """Where the commands run."""

    def __init__(self, program, folder, limit_s):
        self.program, self.folder, self.limit_s = os.path.abspath(program), folder, limit_s
        self.variables = {key: value for key, value in os.environ.items() if not key.startswith("GDTSLAM_")}
        self.variables["XDG_CACHE_HOME"] = str(folder / "cache")

    def run(self, *words, cwd):
        ended = subprocess.run([self.program, *map(str, words)], cwd=cwd, env=self.variables, capture_output=True, text=True,
                               check=False, stdin=subprocess.DEVNULL)
        if ended.returncode != 0:
            sys.exit(f"gdtslam {' '.join(map(str, words))}: exit {ended.returncode}: {ended.stderr}")

    def check(self, case):
        """Exit code, seconds and valgrind's words; None for the code where it did not end."""
        work = self.folder / case.name
        (work / "tmp").mkdir(parents=True)
        case.prepare(work, self.run)
        logs = self.folder / f"{case.name}.%p.txt"
        begin = time.monotonic()
        try:
            ended = subprocess.run([*VALGRIND, f"--log-file={logs}", self.program, *case.arguments], cwd=work, check=False,
                                   env={**self.variables, "TMPDIR": str(work / "tmp")}, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=self.limit_s)
            code, words = ended.returncode, ended.stderr
        except subprocess.TimeoutExpired:
            code, words = None, ""
        seconds = time.monotonic() - begin
        words += "".join(path.read_text(errors="replace") for path in sorted(self.folder.glob(f"{case.name}.*.txt")))
        return code, seconds, words


def main():
    arguments = arguments_of()
    is_sound = True
    print("| command | ends with | errors | seconds |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="gdtslam-memcheck-") as scratch:
        bench = Bench(arguments.program, pathlib.Path(scratch), arguments.limit)
        for name in arguments.commands:
            code, seconds, words = bench.check(CASES[name])
            errors = sum(" at 0x" in line for line in words.splitlines())
            is_good = code == 0 and errors == 0
            print(f"| `{name}` | {'no end' if code is None else code} | {errors} | {seconds:.0f} |", flush=True)
            if not is_good:
                is_sound = False
                print(words, file=sys.stderr)
    return 0 if is_sound else 1


if __name__ == "__main__":
    sys.exit(main())
