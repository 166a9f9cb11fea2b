#!/usr/bin/env python3
"""Changes lines of the engine, one at a time, and tells which changes the tests do not notice.

  mutants.py BUILD_TREE [--parts mapping,compute,calib,io,runs] [--count 20] [--seed 1] [--only FILE] [--slow SECONDS]

A mutant is one change in one line of a source, drawn at random: a comparison that is turned or made strict, a sign, a bound that
is one off, `&&` for `||`, min for max, a condition that is turned round, a call whose result nobody uses left out. Each is
compiled and the unit, property and oracle tests of its part are run until one fails. It is noticed when one fails, crashes or
takes more than five times its usual time. The first run is of the sources as they are: all has to pass; tests that take longer
than --slow (4 s) there are left out, and named.

The build tree must be of this clone, with tests, and no source may have changes that are not committed: each source is put back
as it was, also after an interrupt. Prints a table by part, and each survivor with its line. Exit code 1 where tests fail without
a change; survivors are for a person to judge.
"""

import argparse
import pathlib
import random
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The sources of a part, and the programs of its tests (gdtslam_LAYER_NAME_tests, those that there are).
PARTS = {
    "mapping": ("engine/mapping", ("mapping", "back_end")),
    "compute": ("engine/compute", ("compute",)),
    "calib": ("calib", ("calib",)),
    "io": ("engine/io", ("io",)),
    "runs": ("engine/runs", ("tools",)),
}
LAYERS = ("unit", "property", "oracle")
NUMBER = r"(?<![\w.'])(\d+)(?=U?\b(?!\.|'|[a-zA-Z]))"

# Pattern of the code, what takes its place. As clang-format leaves it, an operator between two values has blanks around it, and
# brackets of templates have none.
CHANGES = [
    ("comparison", re.compile(r" (<|<=|>|>=|==|!=) "), {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}),
    ("sign", re.compile(r"(?<=[\w)\]]) ([+-]|[+-]=) "), {"+": "-", "-": "+", "+=": "-=", "-=": "+="}),
    ("one off", re.compile(NUMBER), None),
    ("logic", re.compile(r" (&&|\|\|) "), {"&&": "||", "||": "&&"}),
    ("extremum", re.compile(r"std::(min|max)(?=\()"), {"min": "max", "max": "min"}),
    ("condition", re.compile(r"^\s*(?:\} else )?if (\()(?!constexpr)(?=.*\)(?: \{| \w.*;)$)"), {"(": "(!"}),
    ("dropped call", re.compile(r"^\s+((?!return|throw|delete|co_|using|static_assert|assert)[\w.:>-]+\(.*\);)$"), None),
]


class Mutant:
    """One change: of a line (from 1) of a file, the characters from begin to end become text."""

    def __init__(self, path, line, kind, begin, end, text):
        self.path, self.line, self.kind, self.begin, self.end, self.text = path, line, kind, begin, end, text

    def apply(self, lines):
        old = lines[self.line - 1]
        changed = list(lines)
        changed[self.line - 1] = old[:self.begin] + self.text + old[self.end:]
        return changed

    def describe(self, lines):
        return f"{self.path}:{self.line}: {self.kind}: {lines[self.line - 1].strip()}  ->  {self.apply(lines)[self.line - 1].strip()}"


def code_of(line):
    """The line with comments and texts blanked, so that places stay."""
    line = re.sub(r'"(?:[^"\\]|\\.)*"', lambda m: " " * len(m[0]), line)
    return re.sub(r"//.*", lambda m: " " * len(m[0]), line)


def negated(line, begin):
    """The end of the condition whose bracket opens at begin: `if (a && b)` becomes `if (!(a && b))`."""
    depth = 0
    for place in range(begin, len(line)):
        depth += {"(": 1, ")": -1}.get(line[place], 0)
        if depth == 0:
            return place
    return None


def mutants_of_line(path, number, line):
    code = code_of(line)
    stripped = code.strip()
    if not stripped or stripped.startswith(("#", "template", "using", "static_assert", "assert(", "/*", "*", "case ")):
        return
    for kind, pattern, table in CHANGES:
        for match in pattern.finditer(code):
            begin, end = match.span(1)
            if kind == "one off":
                yield Mutant(path, number, kind, begin, end, str(int(match[1], 8 if re.match(r"0\d", match[1]) else 10) + 1))
            elif kind == "dropped call":
                yield Mutant(path, number, kind, begin, end, ";")
            elif kind == "condition":
                close = negated(code, begin)
                if close is not None:
                    yield Mutant(path, number, kind, begin, close + 1, "(!" + line[begin:close + 1] + ")")
            else:
                yield Mutant(path, number, kind, begin, end, table[match[1]])


def sources_of(folder):
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", folder], capture_output=True, text=True, check=True).stdout
    return [pathlib.Path(name) for name in listed.splitlines() if name.endswith((".cpp", ".hpp"))]


def drawn(folder, count, rng, only):
    """Mutants of as many lines drawn at random, no line twice; what a line offers is drawn among, too."""
    places = []
    for path in sources_of(folder):
        if only and str(path) != only:
            continue
        for number, line in enumerate((ROOT / path).read_text().splitlines(), 1):
            offered = list(mutants_of_line(path, number, line))
            if offered:
                places.append(offered)
    return [rng.choice(offered) for offered in rng.sample(places, min(count, len(places)))]


class Tests:
    """The test programs of a part in a build tree."""

    def __init__(self, build, names, slow_s):
        self.build, self.slow_s = build, slow_s
        wanted = [f"gdtslam_{layer}_{name}_tests" for layer in LAYERS for name in names]
        targets = subprocess.run(["ninja", "-C", build, "-t", "targets", "all"], capture_output=True, text=True, check=True).stdout
        self.programs = [name for name in wanted if f"\n{name}: phony" in targets]
        if not self.programs:
            sys.exit(f"mutants: {build} has no tests of {', '.join(names)}; configure it with GDTSLAM_BUILD_TESTS=ON")
        self.left_out = {name: [] for name in self.programs}
        self.usual_s = {}

    def compile(self):
        done = subprocess.run(["cmake", "--build", self.build, "--parallel", "2", "--target", *self.programs], capture_output=True,
                              text=True, check=False)
        return done.returncode == 0

    def run(self, program, limit_s, extra=()):
        """Exit status and output; None where the time is up."""
        skipped = "".join(f":{name}" for name in self.left_out[program])
        try:
            done = subprocess.run([f"bin/{program}", f"--gtest_filter=-{skipped[1:]}", *extra], cwd=self.build, capture_output=True,
                                  text=True, errors="replace", timeout=limit_s, check=False)
        except subprocess.TimeoutExpired:
            return None, ""
        return done.returncode, done.stdout

    def measure(self):
        """The usual times, of the sources as they are."""
        if not self.compile():
            sys.exit("mutants: the tree does not compile as it is")
        for program in self.programs:
            status, output = self.run(program, 3600)
            if status != 0:
                print(output[-2000:])
                sys.exit(f"mutants: {program} fails without a change")
            times = [(name, float(ms) / 1000) for name, ms in re.findall(r"\[       OK \] (\S+?),? .*?\((\d+) ms\)", output)]
            self.left_out[program] = [name for name, s in times if s > self.slow_s]
            self.usual_s[program] = sum(s for _, s in times if s <= self.slow_s)
            for name in self.left_out[program]:
                print(f"  left out, for it takes more than {self.slow_s:g} s: {name}", flush=True)

    def notice(self):
        """What notices the sources as they lie there now: a test's name, or None."""
        for program in self.programs:
            status, output = self.run(program, 5 * self.usual_s[program] + 30, ("--gtest_fail_fast", "--gtest_brief=1"))
            if status != 0:
                failed = re.search(r"\[  FAILED  \] (\S+)", output)
                return failed[1].rstrip(",") if failed else f"{program} {'takes too long' if status is None else f'ends with {status}'}"
        return None


def judged(mutant, tests):
    """ "noticed", "survived" or "does not compile"; the source is as before afterwards."""
    file = ROOT / mutant.path
    before = file.read_text()
    lines = before.splitlines()
    print(f"{mutant.describe(lines)}", end="", flush=True)
    began_s = time.monotonic()
    try:
        file.write_text("\n".join(mutant.apply(lines)) + "\n")
        if not tests.compile():
            verdict, why = "does not compile", ""
        else:
            why = tests.notice()
            verdict = "noticed" if why else "survived"
    finally:
        file.write_text(before)
    print(f"\n    {verdict}{f' by {why}' if why else ''}, {time.monotonic() - began_s:.0f} s", flush=True)
    return verdict


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--parts", default=",".join(PARTS), help="of: " + ", ".join(PARTS))
    parser.add_argument("--count", type=int, default=20, help="mutants a part that compile (default 20)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", metavar="FILE", help="lines of this source only, by its path from the root")
    parser.add_argument("--slow", type=float, default=4.0, metavar="SECONDS")
    arguments = parser.parse_args()
    unknown = set(arguments.parts.split(",")) - set(PARTS)
    if unknown:
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    if subprocess.run(["git", "-C", ROOT, "diff", "--quiet", "HEAD", "--", "engine", "calib"], check=False).returncode != 0:
        sys.exit("mutants: engine/ or calib/ has changes that are not committed; commit them first, for sources are put back")
    rows = []
    for part in arguments.parts.split(","):
        folder, names = PARTS[part]
        tests = Tests(arguments.build, names, arguments.slow)
        tests.measure()
        counts, survivors = {"noticed": 0, "survived": 0, "does not compile": 0}, []
        # Twice as many as wanted: some do not compile.
        for mutant in drawn(folder, 2 * arguments.count, random.Random(f"{part} {arguments.seed}"), arguments.only):
            if counts["noticed"] + counts["survived"] == arguments.count:
                break
            lines = (ROOT / mutant.path).read_text().splitlines()
            verdict = judged(mutant, tests)
            counts[verdict] += 1
            if verdict == "survived":
                survivors.append(mutant.describe(lines))
        rows.append((part, counts, survivors))
    print("\n| part | mutants | noticed by the part's tests | share |\n|---|---|---|---|")
    for part, counts, _ in rows:
        made = counts["noticed"] + counts["survived"]
        print(f"| {part} | {made} | {counts['noticed']} | {100 * counts['noticed'] / max(made, 1):.0f} % |")
    for _, _, survivors in rows:
        for survivor in survivors:
            print(f"survived: {survivor}")


if __name__ == "__main__":
    main()
