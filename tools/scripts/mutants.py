#!/usr/bin/env python3
"""Changes lines of the engine, one at a time, and tells which changes the tests do not notice.

  mutants.py BUILD_TREE [--parts mapping,loops,compute,calib,io,runs] [--count 20] [--seed 1] [--whole] [--jobs N]
             [--kinds KIND,...] [--only FILE] [--slow SECONDS] [--json FILE] [--again FILE]

A mutant is one change in one line of a source, drawn at random: a comparison that is turned or made strict, a sign, also that of
an angle, a whole number that is one off, another number doubled or halved, `&&` for `||`, min for max, a condition that is
turned round, a call whose result nobody uses left out, so an fsync or a lock. Each is compiled and held against the unit,
property and oracle tests of its part until one fails. It is noticed when one fails, crashes or takes half a minute more than
three times its usual time. The first run is of the programs as they are: all has to pass; tests that take longer than --slow
(2 s) there are left out, unless their name is that of the source or they are of a suite that includes its header and take at
most ten times as long, and named. With --whole, what survived is then held against
every test that uses the part's library, those that take long among them, and against the tests of the command that PARTS
names. --again FILE judges once more what survived in a run whose --json is that file, so that new tests can be tried.

The build tree must have been made by Ninja, with tests, from the sources as they are; it may be one with
CMAKE_UNITY_BUILD. Neither the sources nor the tree change. tests/mutants.txt lists mutants that no test can notice, each with the
reason; the table gives the shares with and without them. Exit code 1 where tests fail without a change; survivors are for a
person to judge.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import re
import sys
import tempfile
import threading
import time

from mutant_build import ROOT, Tree, has_avx512
from mutant_changes import KINDS, drawn, equivalent_mutants, found_again, sources_of
from mutant_tests import CommandTests, Program, placed_program, removed, suites_beside

LAYERS = ("unit", "property", "oracle")
LOOPS = ("engine/mapping/loops/", "engine/mapping/back_end/")


class Part:
    """The sources of a part, the names of its tests, its library, and which tests of the command use it."""

    def __init__(self, folders, tests, library, command, without=(), modules=(), also=()):
        self.folders, self.library, self.command = folders, library, command
        self.tests = [*(f"{layer}/{name}" for layer in LAYERS for name in tests), *also]
        self.without, self.modules = without, modules

    def sources(self):
        found = [path for folder in self.folders for path in sources_of(folder, self.without)]
        # The cases of the self-test are inputs, as a test has them; sets of instructions that are not here cannot be tested.
        return [path for path in found if not path.stem.endswith("_cases") and (has_avx512() or path.stem != "lanes_avx512")]


PARTS = {
    "mapping": Part(["engine/mapping"], ("mapping", "back_end"), "gdtslam_mapping",
                    "same_bytes|accuracy_of_the_sample|report_adds_up|keyframes_are|continued_run_is|nodding_as_sim|merge_joins|"
                    "changes_are|localize_finds|track_follows", LOOPS),
    "loops": Part(list(LOOPS), ("back_end",), "gdtslam_mapping",
                  "same_bytes_with_loops|graph_agrees|covariances_belong|keyframes_are|nodding_closes_loops|live_corrections"),
    "compute": Part(["engine/compute"], ("compute",), "gdtslam_compute", "same_bytes|verify_|accuracy_of_the_sample",
                    ("engine/compute/cases/",), also=("oracle/mapping",)),  # of pose_bounds
    "calib": Part(["calib"], ("calib",), "gdtslam_calib", "calibrate_|linkage_|nodding_linkage", modules=("calibrate",)),
    "io": Part(["engine/io"], ("io",), "gdtslam_io",
               "every_write|killed_at|converted_logs|packed_logs|bag_|ros2_|bad_input|hostile|readers_notice|simulated_formats|doctor_"),
    "runs": Part(["engine/runs"], ("tools", "runs"), "gdtslam_runs",
                 "continue|edit_|evaluate|graph_agrees|covariances|keyframes|tiles|fleet_(local|shards|resume|record|bad)|localize_|"
                 "merge_|measure|doctor_|nodding_|live_equals|two_writers|logs_in_sequence|report_adds|run_|readers_notice|"
                 "killed|interrupt|files_of|foreign|recorded_run"),
}


class Judge:
    """Holds mutants of a part against the tests of the part, and survivors against all that use its library."""

    def __init__(self, tree, part, arguments, scratch):
        self.tree, self.part, self.slow_s, self.scratch = tree, part, arguments.slow, scratch
        self.folders = [f"tests/{name}" for name in part.tests]
        self.targets = tree.targets()
        self.programs = self.measured([f"gdtslam_{name.replace('/', '_')}_tests" for name in part.tests])
        if not self.programs:
            sys.exit(f"mutants: {tree.build} has no tests of {', '.join(part.tests)}; configure it with GDTSLAM_BUILD_TESTS=ON")
        for program in self.programs:
            for name in program.left_out:
                print(f"  left out, for it takes more than {self.slow_s:g} s: {name}", flush=True)
        self.others, self.command_tests, self.measuring = [], None, threading.Lock()

    def measured(self, names):
        programs = [Program(self.tree, name, self.slow_s) for name in names if name in self.targets]
        for program in programs:
            self.measure(program)
        return sorted(programs, key=lambda program: program.usual_s)

    def measure(self, program):
        if not program.measure(self.scratch):
            sys.exit(f"mutants: {program.name} fails without a change, or is not built")

    def prepare_whole(self):
        here = {program.name for program in self.programs}
        names = sorted(name for name in self.targets if name.startswith("gdtslam_") and name.endswith("_tests")
                       and name not in here and self.tree.uses(name, self.part.library))
        built = [name for name in names if (self.tree.build / "bin" / name).exists()]
        if built != names:
            print(f"  left out, for they are not built: {', '.join(name for name in names if name not in built)}", flush=True)
        self.others = [Program(self.tree, name, self.slow_s) for name in built]
        self.command_tests = CommandTests(self.tree)

    def check_without_change(self, test):
        """Ends where a test of the command that fails with a mutant does so without one."""
        with tempfile.TemporaryDirectory(dir=self.scratch) as name:
            folder = pathlib.Path(name)
            command = placed_program(self.tree, {}, folder, ())
            if self.command_tests.failure(command, folder / "cli", f"^{re.escape(test)}$"):
                sys.exit(f"mutants: {test} fails without a change; nothing can be told of what survives")

    def by_part(self, mutant):
        """What the part's tests say: a verdict, what noticed it."""
        with tempfile.TemporaryDirectory(dir=self.scratch) as name:
            folder = pathlib.Path(name)
            objects = self.tree.compile(mutant, folder)
            if objects is None:
                return "does not compile", ""
            linked = [(program, self.tree.link(program.name, objects, folder / program.name)) for program in self.programs]
            if None in [file for _, file in linked]:
                return "does not compile", ""
            suites = suites_beside(mutant.path, self.folders)
            beside = ":".join([f"*{suite}.*" for suite in suites] + [f"*{mutant.path.stem}*"])
            for chosen in (beside, ""):
                for program, file in linked:
                    tests = chosen + program.quick(mutant.path, suites)
                    why = program.failure(file, folder / "work", tests)
                    if why:
                        return "noticed", why
        return "survived", ""

    def by_all(self, mutant):
        """What notices it of all tests that use the library but those of by_part, those of the command first; empty where none
        does. Programs are measured when they are first needed."""
        with tempfile.TemporaryDirectory(dir=self.scratch) as name:
            folder = pathlib.Path(name)
            objects = self.tree.compile(mutant, folder)
            command = placed_program(self.tree, objects, folder, self.part.modules)
            why = self.command_tests.failure(command, folder / "cli", self.part.command)
            if why:
                self.check_without_change(why.split(",")[0])
                return why
            rows = [(program, ":".join(program.left_out)) for program in self.programs if program.left_out]
            for program, tests in rows + [(program, "*") for program in self.others]:
                with self.measuring:
                    if not program.times:
                        self.measure(program)
                file = self.tree.link(program.name, objects, folder / program.name)
                why = program.failure(file, folder / "work", tests)
                if why:
                    return why
            return ""


def judged(mutants, count, judge, jobs):
    """As many mutants as compile, in order, with a verdict each; several at a time."""
    rows, waiting, pending = {}, iter(enumerate(mutants)), {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        while True:
            while len(pending) < jobs and len(pending) + len(rows) < count:
                number, mutant = next(waiting, (None, None))
                if mutant is None:
                    break
                pending[pool.submit(judge.by_part, mutant)] = (number, mutant, time.monotonic())
            if not pending:
                return [rows[number] for number in sorted(rows)]
            done, _ = concurrent.futures.wait(pending, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in done:
                number, mutant, began_s = pending.pop(future)
                verdict, why = future.result()
                print(f"{mutant.describe()}\n    {verdict}{f' by {why}' if why else ''}, {time.monotonic() - began_s:.0f} s", flush=True)
                if verdict != "does not compile":
                    rows[number] = {"mutant": mutant, "by_part": why, "by_all": why}


def hold_against_all(rows, judge, jobs, reasons):
    """Sets by_all of what survived the part's tests, but of those that none can notice."""
    survivors = [row for row in rows if not row["by_part"] and row["mutant"].key not in reasons]
    if survivors:
        judge.prepare_whole()
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for row, why in zip(survivors, pool.map(lambda row: judge.by_all(row["mutant"]), survivors)):
            row["by_all"] = why
            print(f"{row['mutant'].describe()}\n    {f'noticed by {why}' if why else 'survived the whole suite'}", flush=True)


def share(part, whole):
    return f"{part} ({100 * part / max(whole, 1):.0f} %)"


def print_table(results, reasons, whole):
    print("\n| part | mutants | noticed by the part's tests | of those that can be |" + (" by the whole suite | of those that can be |" if whole else ""))
    print("|---|---|---|---|" + ("---|---|" if whole else ""))
    for part, rows in results.items():
        can_be = [row for row in rows if row["by_all"] or row["mutant"].key not in reasons]
        cells = [part, str(len(rows))]
        for key in ("by_part", "by_all")[:2 if whole else 1]:
            noticed = sum(bool(row[key]) for row in rows)
            cells += [share(noticed, len(rows)), share(noticed, len(can_be))]
        print("| " + " | ".join(cells) + " |")
    for rows in results.values():
        for row in rows:
            if not row["by_all" if whole else "by_part"]:
                reason = reasons.get(row["mutant"].key)
                print(f"survived: {row['mutant'].describe()}" + (f"\n    {reason}" if reason else ""))


def as_json(results):
    fields = ("path", "line", "kind", "begin", "end", "text", "old")
    return json.dumps({part: [{**{field: str(getattr(row["mutant"], field)) if field == "path" else getattr(row["mutant"], field)
                                  for field in fields}, "by_part": row["by_part"], "by_all": row["by_all"]} for row in rows]
                       for part, rows in results.items()}, indent=1)


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--parts", default=",".join(PARTS), help="of: " + ", ".join(PARTS))
    parser.add_argument("--count", type=int, default=20, help="mutants a part that compile (default 20)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--whole", action="store_true", help="hold what survives against the whole suite")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="mutants at a time (default: as many as processors)")
    parser.add_argument("--kinds", default=",".join(KINDS), help="of: " + ", ".join(KINDS))
    parser.add_argument("--only", metavar="FILE", help="lines of this source only, by its path from the root")
    parser.add_argument("--slow", type=float, default=2.0, metavar="SECONDS")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--again", type=pathlib.Path, metavar="FILE", help="what survived there")
    arguments = parser.parse_args()
    for given, known in ((arguments.parts, PARTS), (arguments.kinds, KINDS)):
        unknown = set(given.split(",")) - set(known)
        if unknown:
            parser.error(f"no {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    return arguments


def main():
    arguments = parsed()
    os.nice(3)
    tree = Tree(arguments.build)
    before = json.loads(arguments.again.read_text()) if arguments.again else None
    results, reasons = {}, equivalent_mutants(ROOT / "tests/mutants.txt")
    with tempfile.TemporaryDirectory(prefix="gdtslam-mutants-") as name:
        for part in arguments.parts.split(","):
            judge = Judge(tree, PARTS[part], arguments, pathlib.Path(name))
            if before is not None:
                again = [found_again(row) for row in before.get(part, []) if not row["by_part"]]
                mutants, count = [mutant for mutant in again if mutant], len(again)
            else:
                sources = [path for path in PARTS[part].sources() if not arguments.only or str(path) == arguments.only]
                rng = random.Random(f"{part} {arguments.seed}")
                # Twice as many as wanted: some do not compile.
                mutants, count = drawn(sources, 2 * arguments.count, rng, arguments.kinds.split(",")), arguments.count
            results[part] = judged(mutants, count, judge, arguments.jobs)
            if arguments.whole:
                hold_against_all(results[part], judge, arguments.jobs, reasons)
            if arguments.json:
                arguments.json.write_text(as_json(results))
    print_table(results, reasons, arguments.whole)


if __name__ == "__main__":
    main()
