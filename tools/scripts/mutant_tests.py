"""The tests that a mutant is held against (mutants.py): programs of GoogleTest, and tests of the command by ctest's list."""

import json
import os
import pathlib
import re
import resource
import shutil
import subprocess

from mutant_build import ROOT, run

MEMORY_BYTES, FILE_BYTES = 12 << 30, 2 << 30  # what a mutant may take that does not end
SLOW_BESIDE = 10  # tests of suites beside a source may take so many times as long as others


def bounded():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_BYTES, FILE_BYTES))


def surroundings(folder):
    """The environment in which nothing is shared with other runs of the same test."""
    folder.mkdir(parents=True, exist_ok=True)
    return {**os.environ, "TMPDIR": str(folder), "TEST_TMPDIR": str(folder), "XDG_CACHE_HOME": str(folder / "cache")}


def finished(arguments, limit_s, **options):
    """Exit status and output; None where the time is up. What it has started ends with it."""
    with subprocess.Popen([str(word) for word in arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", stdin=subprocess.DEVNULL, start_new_session=True, preexec_fn=bounded, **options) as process:
        try:
            output, _ = process.communicate(timeout=limit_s)
            return process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.communicate()
            return None, ""


class Program:
    """A program of GoogleTest in the tree: its usual time, and the tests that are left out for theirs."""

    def __init__(self, tree, name, slow_s):
        self.tree, self.name, self.slow_s = tree, name, slow_s
        self.left_out, self.times, self.usual_s, self.slowest_s = [], {}, 0.0, 0.0

    def measure(self, folder):
        """Its times as it is; they are kept in the tree beside it. False where it fails."""
        program = self.tree.build / "bin" / self.name
        if not program.exists():
            return False
        kept = self.tree.build / "mutants" / f"{self.name}.json"
        if kept.exists() and kept.stat().st_mtime > program.stat().st_mtime:
            times = json.loads(kept.read_text())
        else:
            status, output = finished([program], 3600, cwd=self.tree.build, env=surroundings(folder / self.name))
            if status != 0:
                print(output[-2000:])
                return False
            times = [(name, float(ms) / 1000) for name, ms in re.findall(r"\[       OK \] (\S+?),? .*?\((\d+) ms\)", output)]
            kept.parent.mkdir(exist_ok=True)
            kept.write_text(json.dumps(times))
        self.times = dict(times)
        self.left_out = [name for name, s in times if s > self.slow_s]
        self.usual_s = sum(s for _, s in times if s <= self.slow_s)
        self.slowest_s = sum(s for _, s in times if s > self.slow_s)
        return True

    def failure(self, program, folder, chosen):
        """The name of the first of the chosen tests that fails in this copy of it; None where all pass."""
        # Where slow tests are chosen they stand behind no minus, or are not all behind it.
        is_slow = any(name not in chosen.partition("-")[2].split(":") for name in self.left_out)
        limit_s = 3 * (self.usual_s + (self.slowest_s if is_slow else 0)) + 30
        status, output = finished([program, f"--gtest_filter={chosen}", "--gtest_fail_fast", "--gtest_brief=1"], limit_s,
                                  cwd=self.tree.build, env=surroundings(folder))
        if status == 0:
            return None
        failed = re.search(r"\[  FAILED  \] (\S+)", output)
        how = "takes too long" if status is None else f"ends with {status}"
        return failed[1].rstrip(",") if failed else f"{self.name}, which {how}"

    def quick(self, source, beside):
        """The filter of the tests that are not slow, or that name the source, or of suites beside it and not so slow."""
        def is_kept(name):
            suite = name.split(".")[0].split("/")[-1]  # a prefix is that of the parameters
            is_beside = suite in beside and self.times[name] <= SLOW_BESIDE * self.slow_s
            return is_beside or any(word in name for word in names_of(source))
        return "-" + ":".join(name for name in self.left_out if not is_kept(name))


def names_of(source):
    """Under which tests know a source: its own, and of a kernel that of its folder."""
    return {source.stem, source.parent.name} if source.suffix == ".inl" else {source.stem}


def suites_beside(source, folders):
    """The suites of tests that include the header of a source or have its name: they are the first to notice a change."""
    suites = set()
    for folder in folders:
        for test in sorted((ROOT / folder).glob("*.cpp")):
            text = test.read_text()
            if any(f"/{name}.hpp" in text or name in test.stem for name in names_of(source)):
                suites |= set(re.findall(r"^(?:TEST|TEST_F|TEST_P|RC_GTEST_PROP)\((\w+)", text, re.MULTILINE))
    return sorted(suites)


class CommandTests:
    """Tests of the command, run as ctest would, with a program of their own."""

    def __init__(self, tree):
        listed = json.loads(run(["ctest", "--test-dir", tree.build, "--show-only=json-v1", "-L", "cli"]).stdout)
        self.tree, self.tests = tree, {}
        for test in listed["tests"]:
            variables = {}
            for row in test.get("properties", []):
                if row["name"] == "ENVIRONMENT":
                    variables = dict(word.split("=", 1) for word in row["value"])
            self.tests[test["name"]] = (test["command"], variables)

    def failure(self, program, folder, pattern, limit_s=600):
        """The first test whose name matches that fails with this program; the fixture is made with it, too."""
        names = ["cli.fixture", *sorted(name for name in self.tests if re.search(pattern, name) and name != "cli.fixture")]
        for name in names:
            arguments, variables = self.tests[name]
            work, moved = variables["GDTSLAM_CLI_WORK"], str(folder / "work")
            changed = {key: value.replace(work, moved) for key, value in variables.items()}
            env = {**os.environ, "TMPDIR": str(folder), **changed, "GDTSLAM": str(program)}
            pathlib.Path(moved).mkdir(parents=True, exist_ok=True)
            status, _ = finished(arguments, limit_s, cwd=self.tree.build, env=env)
            if status not in (0, 77):
                return name if status is not None else f"{name}, which takes too long"
        return None


def placed_program(tree, objects, folder, modules):
    """The program gdtslam with these objects, where it finds its modules, of which the named ones are linked with them, too,
    and its assets."""
    (folder / "bin").mkdir()
    (folder / "share").mkdir()
    (folder / "share/gdtslam").symlink_to(ROOT / "assets")
    program = tree.link("bin/gdtslam", objects, folder / "bin/gdtslam")
    for real in sorted(tree.build.glob("lib/**/gdtslam/*.so")):
        copy = folder / real.relative_to(tree.build)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if real.stem in modules:
            tree.link(str(real.relative_to(tree.build)), objects, copy)
        else:
            copy.symlink_to(real)
    return program


def removed(folder):
    shutil.rmtree(folder, ignore_errors=True)
