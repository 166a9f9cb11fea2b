#!/usr/bin/env python3
"""Every call fails once: `fail_each_call.py PROGRAM [--commands map,over,...] [--sample N] [--seed N] [--json]`.

For each command that writes: an undisturbed run counts its calls of each kind (tests/cli/failing_calls.c says which there are
and what is left out); then it runs again and again, each time with another call that fails, falls short, or is the last one
before a SIGKILL, until every call has had its turn, or N of each kind, drawn with the seed. Of allocations, of which there
are tens of thousands, one has its turn for each place that asks for memory, told by its two innermost calls of the program.
After each run:

* it ended in time, by no signal but ours, with 0, with 74 where a file failed, with 1 where memory did;
* where it failed, there is exactly one error line on standard error;
* where memory ended in a function of a library that lets no exception through, it ended at once, and left what a killed one does;
* where memory ended in a picture of the map, the run is there without it, and its report says so;
* the files are, byte for byte, those of before, or those of an undisturbed run, and with 0 the latter; nothing else lies there;
* interrupted calls and short transfers change nothing;
* after a SIGKILL there are files of one of the two only, besides what docs/formats.md says may be left; the same command run
  again succeeds, gives the bytes of an undisturbed run, and leaves nothing else.

Prints a table as Markdown and each finding with the call that made it; the exit code is 1 where there is one."""

import argparse
import collections
import json
import os
import pathlib
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import failing_commands  # noqa: E402
from file_states import differences, digests_of, volatile_keys  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = [ROOT / "tests/cli" / name for name in ("failing_calls.c", "failing_calls_memory.c")]
KINDS = ("open", "read", "write", "sync", "close", "rename", "unlink", "mkdir", "link", "truncate", "map", "allocate", "change")
STATE = struct.Struct(f"{len(KINDS) + 2}Q1024s")  # CallState of failing_calls.h
FAULTS = {
    "open": ("EIO", "ENOSPC", "EINTR"), "read": ("EIO", "EINTR", "EAGAIN", "short"),
    "write": ("EIO", "ENOSPC", "EINTR", "EAGAIN", "short"), "write,sync": ("ENOSPC on",), "change": ("kill-before", "kill-after", "EROFS on"),
    "sync": ("EIO", "ENOSPC", "EINTR"), "close": ("EIO", "EINTR"), "rename": ("EIO", "ENOSPC"), "unlink": ("EIO",),
    "mkdir": ("EIO", "ENOSPC"), "link": ("EIO",), "truncate": ("EIO", "ENOSPC"), "map": ("ENOMEM",), "allocate": ("ENOMEM",)}
UNNOTICED = ("EINTR", "short")  # of which a command must notice nothing
# What a killed process may leave until the same command runs again (docs/formats.md).
LEFTOVER = re.compile(r"(^|/)(\.gdtslam-staging-\d+(-\d+)?|\.[^/]+\.\d+-\d+\.tmp|\.latest-\d+)(/|$)")

ENDED_AT_ONCE = "gdtslam: error: out of memory\n"  # and no more: by the handler of std::terminate
PICTURES = ("overview", "graph")

Outcome = collections.namedtuple("Outcome", "code errors files counts where is_hang")


class Command:
    """One command in a folder that begins the same each time."""

    def __init__(self, case, bench):
        self.case, self.bench = case, bench
        self.template = bench.folder / f"begin-{case.name}"
        self.work = bench.folder / "work"
        self.template.mkdir()
        (self.template / "tmp").mkdir()
        case.prepare(self.template, bench.run)
        self.keys = set()
        self.files = lambda: digests_of(self.work, self.keys)
        self.begin()
        self.old = self.files()
        self.learn()

    def begin(self):
        shutil.rmtree(self.work, ignore_errors=True)
        shutil.copytree(self.template, self.work, symlinks=True)

    def learn(self):
        """Files of undisturbed runs; what differs between two of them is no result: times."""
        results = []
        for _ in range(3):
            self.begin()
            outcome = self.run()
            if outcome.code != 0:
                sys.exit(f"{self.case.name}: an undisturbed run ends with {outcome.code}: {outcome.errors}")
            results.append(self.work.parent / f"undisturbed-{len(results)}")
            shutil.rmtree(results[-1], ignore_errors=True)
            self.work.rename(results[-1])
        self.keys = volatile_keys(results) | self.case.varies
        self.new = digests_of(results[0], self.keys)
        for other in results[1:]:
            if digests_of(other, self.keys) != self.new:
                sys.exit(f"{self.case.name}: undisturbed runs differ: {differences(digests_of(other, self.keys), self.new)}")
        self.unfinished = self.learn_unfinished()
        self.begin()
        self.old = self.files()
        self.counts = outcome.counts
        if self.new == self.old:
            sys.exit(f"{self.case.name}: writes nothing")

    def learn_unfinished(self):
        if self.case.leave_unfinished is None:
            return {}
        self.begin()
        self.case.leave_unfinished(self.work, self.bench.start)
        return self.files()

    def one_of_each_place(self, callers, chance):
        """Numbers of allocations, one for each place of the program that asks for memory."""
        file = self.bench.folder / "places"
        file.write_bytes(b"")
        self.begin()
        self.run(more={"FAILING_PLACES": str(file), "FAILING_CALLERS": str(callers)})
        places = collections.defaultdict(list)
        for number, (place,) in enumerate(struct.iter_unpack("Q", file.read_bytes()), 1):
            places[place].append(number)
        return sorted(chance.choice(numbers) for numbers in places.values())

    def run(self, kinds="", number=0, how="", preloaded=True, more=()):
        state = self.bench.folder / "state"
        state.write_bytes(bytes(STATE.size))
        variables = {**self.bench.variables, "TMPDIR": str(self.work / "tmp"), **dict(more)}
        if preloaded:
            how, _, on = how.partition(" ")
            variables.update(LD_PRELOAD=str(self.bench.library), FAILING_STATE=str(state), FAILING_BELOW=str(self.work),
                             FAILING_KINDS=kinds, FAILING_AT=str(number), FAILING_HOW=how, FAILING_ON="1" if on else "0")
        process = subprocess.Popen([self.bench.program, *self.case.arguments], cwd=self.work, env=variables, text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, errors="replace",
                                   start_new_session=True)
        try:
            _, errors = process.communicate(timeout=self.bench.limit_s)
            is_hang = False
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            _, errors = process.communicate()
            is_hang = True
        self.wait_for_group(process.pid)
        *counts, where = STATE.unpack(state.read_bytes())
        where = where.split(b"\0")[0].decode(errors="replace").replace(str(self.work) + "/", "")
        return Outcome(process.returncode, errors, self.files(), dict(zip(KINDS, counts)), where, is_hang)

    def wait_for_group(self, group):
        """Processes that the command started may outlive it for a moment where it was killed."""
        end = time.monotonic() + self.bench.limit_s
        while time.monotonic() < end:
            try:
                os.killpg(group, 0)
            except ProcessLookupError:
                return
            time.sleep(0.005)
        os.killpg(group, signal.SIGKILL)

    def state_of(self, files):
        """Which run's files there are: old, new, less than those of one run, or None: of both."""
        if files == self.new:
            return "new"
        if files == self.old:
            return "old"
        for of in (self.old, self.new):
            if all(of.get(name) == digest for name, digest in files.items()):
                return "part"
        is_each_whole = all(digest in (of.get(name) for of in (self.old, self.new, self.unfinished)) for name, digest in files.items())
        return "each" if is_each_whole and self.case.has_single_files else None

    def try_call(self, kinds, number, how):
        """Lets that call fail; what became of it, and what is wrong with that."""
        self.begin()
        outcome = self.run(kinds, number, how)
        if outcome.is_hang:
            return "hang", ["did not end in time"], outcome
        if how.startswith("kill") and outcome.code == -signal.SIGKILL:
            return *self.after_kill(outcome), outcome
        if how.startswith("kill") and outcome.code != 0 and outcome.where:
            # Of a process that the command had started; it tells of it as of any failure.
            return f"{outcome.code}", self.faults_of_failure(outcome, (1, 74), kinds, how), outcome
        if outcome.code == 0:
            if kinds == "allocate":
                outcome = outcome._replace(files=self.with_pictures_told_of(outcome.files))
            faults = [] if outcome.files == self.new else [f"exit 0, but {differences(outcome.files, self.new)}"]
            is_left = self.may_leave(kinds, outcome) and self.without_stated_leftovers(outcome.files) == self.new
            return "passed", [] if is_left else faults, outcome
        faults = self.faults_of_failure(outcome, (1,) if kinds == "allocate" else (74,), kinds, how)
        if how in UNNOTICED and kinds != "sync":
            faults.append(f"{how} is no reason to fail: {outcome.errors.strip()}")
        return f"{outcome.code}", faults, outcome

    def with_pictures_told_of(self, files):
        """The files, with those pictures of a run in place that its report says could not be made."""
        files = dict(files)
        for report in [name for name in files if name.rpartition("/")[2] == "report.json" and name in self.new]:
            told = json.loads((self.work / report).read_text())["warnings"]
            folder = report[:-len("report.json")]
            for name in PICTURES:
                png = f"{folder}{name}.png"
                if png in self.new and png not in files and f"no pixels for {name}" in told:
                    files.pop(f"{folder}{name}.svg", None)
                    files |= {png: self.new[png], report: self.new[report]}
        return files

    def is_stated(self, files, is_lost=False):
        """Whether these are the old files, the new ones, or what the pages say is there after a failure; on a disk that
        takes no more changes, also less than all of them."""
        return files in (self.old, self.new) or self.case.may_stay(files, self.old, self.new, self.unfinished) or (
            is_lost and self.state_of(files) is not None)

    def may_leave(self, kinds, outcome):
        """Whether that call was to remove something, or to look what is in what is to be removed."""
        opened = outcome.where.rpartition(" ")[2]
        return kinds in ("unlink", "change") or (kinds == "allocate" and outcome.errors == ENDED_AT_ONCE) or (
            kinds == "open" and bool(LEFTOVER.search(opened) or self.case.is_left_by_kill(opened)))

    def without_stated_leftovers(self, files):
        """Files without what could not be removed; nor, unless the new files are there, the folders made for it."""
        left = {name for name in files.keys() - self.new.keys() if LEFTOVER.search(name) or self.case.is_left_by_kill(name)}
        rest = {name: digest for name, digest in files.items() if name not in left}
        if rest == self.new:
            return rest
        parents = {str(parent) for name in left for parent in pathlib.PurePath(name).parents}
        return {name: digest for name, digest in rest.items() if name in self.old or name not in parents}

    def faults_of_failure(self, outcome, codes, kinds, how):
        faults = []
        if outcome.code < 0:
            faults.append(f"ended by signal {-outcome.code}: {outcome.errors.strip()}")
        elif outcome.code not in codes:
            faults.append(f"exit {outcome.code}: {outcome.errors.strip()}")
        lines = outcome.errors.splitlines()
        errors = [line for line in lines if line.startswith("gdtslam: error: ")]
        others = [line for line in lines if not line.startswith("gdtslam: ")]
        if outcome.code >= 0 and (len(errors) != 1 or others):
            faults.append(f"not one error line: {outcome.errors!r}")
        files = self.without_stated_leftovers(outcome.files) if self.may_leave(kinds, outcome) else outcome.files
        if not self.is_stated(files, is_lost=how == "EROFS on"):
            faults.append(f"exit {outcome.code}, but {differences(outcome.files, self.old)}")
        return faults

    def after_kill(self, outcome):
        faults = []
        files = self.without_stated_leftovers(outcome.files)
        state = self.state_of(files)
        if state is None:
            faults.append(f"killed: files of two runs: {differences(files, self.old)}; {differences(files, self.new)}")
        again = self.run(preloaded=False)
        if again.code == 2 and files == self.new and again.files == self.new:
            pass  # all was done before it was killed, and the command replaces no file unless it is told to
        elif again.code != 0:
            faults.append(f"killed, and run again: exit {again.code}: {again.errors.strip()}")
        elif again.files != self.new:
            faults.append(f"killed, and run again: {differences(again.files, self.new)}")
        return f"killed, {state or 'mixed'}", faults


class Bench:
    """Where and with what the commands run."""

    def __init__(self, options, folder):
        self.program, self.folder, self.limit_s = os.path.abspath(options.program), folder, options.limit
        self.variables = {key: value for key, value in os.environ.items()
                          if not key.startswith(("GDTSLAM_", "FAILING_")) and key != "LD_PRELOAD"}
        self.variables["XDG_CACHE_HOME"] = str(folder / "cache")
        self.library = pathlib.Path(options.library).resolve() if options.library else self.built()

    def built(self):
        library = self.folder / "libfailing_calls.so"
        subprocess.run([os.environ.get("CC", "cc"), "-std=gnu11", "-O1", "-fPIC", "-shared", "-fexceptions", "-D_GNU_SOURCE", "-o",
                        library, *SOURCES, "-ldl"], check=True)
        return library

    def start(self, *arguments, cwd):
        return subprocess.Popen([self.program, *map(str, arguments)], cwd=cwd, env=self.variables, stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def run(self, *arguments, cwd):
        process = subprocess.run([self.program, *map(str, arguments)], cwd=cwd, env=self.variables, capture_output=True, text=True,
                                 check=False, stdin=subprocess.DEVNULL)
        if process.returncode != 0:
            sys.exit(f"gdtslam {' '.join(map(str, arguments))}: exit {process.returncode}: {process.stderr}")


def numbers_of(command, count, options, chance, kinds):
    """Which of the calls fail: all, or a sample."""
    most = options.sample
    if kinds == "allocate" and not most:
        if options.allocations is None:
            return command.one_of_each_place(options.callers, chance)
        most = options.allocations
    if not most or count <= most:
        return list(range(1, count + 1))
    return sorted(chance.sample(range(1, count + 1), most))


def rows_of(command, options, chance):
    for kinds, ways in FAULTS.items():
        count = sum(command.counts[kind] for kind in kinds.split(","))
        if options.kinds and not set(kinds.split(",")) <= set(options.kinds.split(",")):
            continue
        outcomes, findings, runs = collections.Counter(), [], 0
        for how in ways if count else ():
            for number in numbers_of(command, count, options, chance, kinds):
                outcome, faults, details = command.try_call(kinds, number, how)
                outcomes[outcome] += 1
                runs += 1
                for fault in faults:
                    findings.append({"kind": kinds, "how": how, "call": number, "where": details.where, "fault": fault})
                    print(f"{command.case.name}: {kinds} {number} {how} ({details.where}): {fault}", file=sys.stderr, flush=True)
        yield {"command": command.case.name, "kind": kinds, "calls": count, "runs": runs, "outcomes": dict(sorted(outcomes.items())),
               "findings": findings}


def line_of(row):
    outcomes = ", ".join(f"{name}: {count}" for name, count in row["outcomes"].items())
    return f"| {row['command']} | {row['kind']} | {row['calls']} | {row['runs']} | {outcomes} | {len(row['findings'])} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--commands", default=",".join(failing_commands.CASES), help="which, by commas (default: all)")
    parser.add_argument("--kinds", help="kinds of calls, by commas (default: all)")
    parser.add_argument("--sample", type=int, default=0, help="calls of each kind (default: every one)")
    parser.add_argument("--allocations", type=int, help="so many allocations, drawn; 0: all (default: one of each place)")
    parser.add_argument("--callers", type=int, default=2, help="calls of the program by which places are told apart (2)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=120, help="seconds that a run may take")
    parser.add_argument("--library", help="the preloaded library, where it is built already")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    unknown = set(options.commands.split(",")) - set(failing_commands.CASES)
    if unknown:
        parser.error(f"no such command: {', '.join(sorted(unknown))}")
    rows = []
    if not options.json:
        print("| command | calls | there are | made to fail | outcomes | findings |\n|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory(prefix="fail-each-call-") as folder:
        bench = Bench(options, pathlib.Path(folder).resolve())
        for name in options.commands.split(","):
            command = Command(failing_commands.CASES[name], bench)
            for row in rows_of(command, options, random.Random(f"{options.seed} {name}")):
                rows.append(row)
                if not options.json:
                    print(line_of(row), flush=True)
    findings = sum(len(row["findings"]) for row in rows)
    if options.json:
        print(json.dumps({"rows": rows, "runs": sum(row["runs"] for row in rows), "findings": findings}, indent=1))
    else:
        print(f"\n{sum(row['runs'] for row in rows)} runs, {findings} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
