#!/usr/bin/env python3
"""Hostile words for every option: `hostile_words.py PROGRAM [--commands "map,fleet plan"] [--sample N] [--seed N]`.

Each option that takes a value, of each command as its --help lists them, is given words that are no number, no text, no file
and no end: bytes that are no UTF-8, nothing at all, infinities, 5,000 letters, line ends, braces and percent signs. After each
call:

* it ended in time, by no signal, with an exit code that --help states;
* where that is not 0, there is exactly one error line on standard error, none that the program did not mean;
* where the words were refused, with 2 or 78, no file is another than before.

Prints the number of calls and each finding; the exit code is 1 where there is one."""

import argparse
import collections
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import command_cases  # noqa: E402

CODES = {0, 1, 2, 65, 69, 70, 74, 78, 130}
REFUSED = {2, 78}
WORDS = (b"\xff", b"name=\xff", b"", b"nan", b"inf m", b"1e999", b"-1", b"0", b"99999999999999999999", b"a" * 5000, b"%n%s{}{0}", b"x\ny",
         b"/dev/null", b"/dev/null/x", b".", b"\xc3(:=,", b"=", b",", b"1,2,3", b"\x1b[2J", b"../../..", b"map.resolution=")
# What makes each command work, as short as it goes.
ARGUMENTS = {
    "map": "drive.log -o out --no-pictures", "live": "drive.log -o out", "merge": "run other -o out", "edit": "run -o out --origin 1,1,90", "tiles": "run",
    "fleet plan": "drive.log -o out", "fleet run": "atlas --shard 1", "fleet status": "atlas", "fleet finish": "atlas", "fleet merge": "atlas",
    "fleet submit": "atlas --engine print", "fleet verify": "atlas", "render": "run -o out.png --size 64x48", "localize": "run drive.log --scan 0",
    "doctor": "drive.log", "convert": "drive.log -o out.csv", "measure": "deep --planes", "evaluate": "run --reference run", "calibrate": "deep.log -o out.yaml",
    "linkage": "paper-b", "simulate": "room.yaml -o out.log", "reproduce": "-o out --only fig3",
    "compare": "drive.log --scans 1 --matchers simplex --starts-at none", "ablation": "drive.log --relations drive.relations -o out",
    "bench": "seed_scatter --samples 1", "devices": "", "verify": "seed_scatter --device cpu", "config show": "", "config schema": "", "generate man": "gdtslam",
    "generate completion": "bash"}
NOTHING_TO_DO = {"fleet merge": 65, "calibrate": 65}  # words are looked at before: two runs that overlap, and walls, would take long
SKIPPED = {("live", "--listen"), ("live", "--page"), ("live", "--follow"), ("fleet plan", "--list"), ("bench", "--seconds")}


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--commands", default=",".join(ARGUMENTS), help="which, by commas (default: all)")
    parser.add_argument("--sample", type=int, help="calls, drawn (default: all)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds that a call may take (60)")
    return parser.parse_args()


class Bench:
    def __init__(self, program, folder, limit_s):
        self.program, self.work, self.template, self.limit_s = os.path.abspath(program), folder / "work", folder / "begin", limit_s
        self.variables = {key: value for key, value in os.environ.items() if not key.startswith("GDTSLAM_")}
        self.variables.update(XDG_CACHE_HOME=str(folder / "cache"), TMPDIR=str(folder / "tmp"), LC_ALL="C.UTF-8")
        (folder / "tmp").mkdir()
        self.template.mkdir()
        command_cases.prepare_3d(self.template, self.must)
        for path in list(self.template.glob("drive.*")):
            path.rename(path.with_name(path.name.replace("drive", "deep", 1)))
        self.must("map", "deep.log", "-o", "deep", "-q", "--first", 30, "--no-pictures", cwd=self.template)
        command_cases.prepare_run(self.template, self.must)
        self.must("map", "drive.log", "-o", "other", "-q", "--first", 10, "--no-pictures", cwd=self.template)
        (self.template / "drive.relations").write_text("0 1 0.4 0 0 0 0 0\n")
        self.must("fleet", "plan", "drive.log", "-o", "atlas", "--shards", 1, "-q", cwd=self.template)
        self.must("fleet", "run", "atlas", "--shard", 1, "-q", cwd=self.template)
        self.begin()

    def begin(self):
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.template, self.work, symlinks=True)
        self.files = self.snapshot()

    def snapshot(self):
        return {(path, stat.st_size, stat.st_mtime_ns, stat.st_ino) for path in self.work.rglob("*") for stat in [path.lstat()]
                if not path.is_dir()}

    def call(self, *words):
        arguments = [self.program, *(word if isinstance(word, bytes) else str(word).encode() for word in words)]
        return subprocess.run(arguments, cwd=self.work, env=self.variables, capture_output=True, check=False, timeout=self.limit_s,
                              stdin=subprocess.DEVNULL)

    def must(self, *words, cwd):
        ended = subprocess.run([self.program, *map(str, words)], cwd=cwd, env=self.variables, capture_output=True, text=True, check=False)
        if ended.returncode != 0:
            sys.exit(f"gdtslam {' '.join(map(str, words))}: exit {ended.returncode}: {ended.stderr}")

    def options_of(self, command):
        """Those that take a value."""
        text = self.call(*command.split(), "--help").stdout.decode()
        found = re.findall(r"^  (?:-\w, )?(--[a-z0-9-]+) [^ \n]", text, re.MULTILINE)
        return [option for option in found if (command, option) not in SKIPPED]

    def require_sound(self, command):
        """Without the words the command works, or it would be refused for something else."""
        ended = self.call(*command.split(), *ARGUMENTS[command].split())
        if ended.returncode != NOTHING_TO_DO.get(command, 0):
            sys.exit(f"gdtslam {command} {ARGUMENTS[command]}: exit {ended.returncode}: {ended.stderr.decode()}")
        self.begin()

    def faults_of(self, command, option, word):
        try:
            ended = self.call(*command.split(), *ARGUMENTS[command].split(), option, word)
        except subprocess.TimeoutExpired:
            self.begin()
            return None, ["did not end in time"]
        faults = []
        errors = [line for line in ended.stderr.decode(errors="replace").splitlines() if line.startswith("gdtslam: error:")]
        if ended.returncode not in CODES:
            faults.append(f"ended with {ended.returncode}")
        if len(errors) != (ended.returncode != 0):
            faults.append(f"{len(errors)} error lines with exit code {ended.returncode}")
        if any(line.startswith("gdtslam: error: unexpected: ") for line in errors):
            faults.append(errors[0])
        if self.snapshot() != self.files:
            if ended.returncode in REFUSED:
                faults.append(f"refused with {ended.returncode}, and files changed")
            self.begin()
        return ended.returncode, faults


def main():
    arguments = arguments_of()
    commands = arguments.commands.split(",")
    if unknown := set(commands) - set(ARGUMENTS):
        sys.exit(f"hostile_words.py: no command {', '.join(sorted(unknown))}")
    with tempfile.TemporaryDirectory(prefix="gdtslam-words-") as scratch:
        bench = Bench(arguments.program, pathlib.Path(scratch), arguments.limit)
        if not arguments.sample:
            for command in commands:
                bench.require_sound(command)
        calls = [(command, option, word) for command in commands for option in bench.options_of(command) for word in WORDS]
        options = len(calls) // len(WORDS)
        if arguments.sample:
            calls = random.Random(arguments.seed).sample(calls, min(arguments.sample, len(calls)))
        outcomes, findings = collections.Counter(), 0
        for command, option, word in calls:
            code, faults = bench.faults_of(command, option, word)
            outcomes[code] += 1
            for fault in faults:
                findings += 1
                print(f"{command} {option} {word[:40]!r}: {fault}", flush=True)
    codes = ", ".join(f"{code}: {count}" for code, count in sorted(outcomes.items(), key=lambda item: (item[0] is None, item[0])))
    print(f"{len(calls)} calls of {len(commands)} commands with {options} options that take a value; {codes}; {findings} findings")
    return 0 if calls and not findings else 1


if __name__ == "__main__":
    sys.exit(main())
