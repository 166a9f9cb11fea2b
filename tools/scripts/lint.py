#!/usr/bin/env python3
"""Runs clang-tidy with warnings as errors over every C++ source of the project.

Usage: lint.py [--since REVISION] [--seconds N] BUILD_FOLDER [FILE...]

One process per processor. With --since only sources are checked that changed since that revision (other than by moving, or in
what they include), and for each header of ours that did one source that includes it; all where .clang-tidy changed. With
--seconds no batch begins after that time; the sources that this left out are counted, and where the others pass the exit code
is 77.

clang-tidy spends nearly all its time in the headers of the system. So sources that are compiled with the same arguments are
written one behind the other into one file, a batch, and checked in one go:
  - They are of one target, so what their anonymous namespaces define has names of its own (tests/scripts/unity_test.py).
  - Where a batch does not compile, the sources that the compiler names and the others are two batches.
  - A batch is one main file, so checks that look at main files only see each of its sources.
  - misc-unused-using-decls and misc-unused-alias-decls count uses in the whole file. A source that has a declaration of
    these kinds whose name it does not mention again is checked alone, lest the use in another source hide the finding.
  - Sources with findings in a batch are checked one by one, and what that says is the result; so are all of a batch with
    findings elsewhere, as in a header.
"""

import concurrent.futures
import itertools
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("engine", "calib", "viewer", "tools", "tests", "examples")
# What only GCC knows, and -Werror: clang's own warnings are for the fuzzing build, which is made by clang.
DROPPED_FLAGS = {"-Werror", "-Winvalid-pch", "-fpch-preprocess"}
# Larger ones gain little more and take more memory (20 sources: up to 1 GB).
SOURCES_PER_BATCH = 20
USING = re.compile(r'^\s*using\s+(?:typename\s+)?[\w:]*::(\w+)\s*;|^\s*namespace\s+(\w+)\s*=', re.MULTILINE)
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def single_commands(command):
    """The commands of the sources one by one where CMake compiles several together (CMAKE_UNITY_BUILD), else the command."""
    path = pathlib.Path(command["directory"], command["file"])
    if path.parent.name != "Unity":
        return [command]
    return [{**command, "file": name, "command": command["command"].replace(str(path), name)}
            for name in INCLUDE.findall(path.read_text())]


def own_sources(commands):
    for command in itertools.chain.from_iterable(map(single_commands, commands)):
        path = pathlib.Path(command["directory"], command["file"]).resolve()
        if path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in FOLDERS:
            yield path, command


def arguments_of(command):
    arguments = shlex.split(command["command"])
    if pathlib.Path(arguments[0]).name == "ccache":
        arguments = arguments[1:]
    # A precompiled header of GCC is none of clang's, and it would hide what a source forgets to include.
    return [a for a in arguments if a not in DROPPED_FLAGS and a != "-include" and not a.endswith("cmake_pch.hxx")]


def include_folders(arguments):
    return [pathlib.Path(a[2:]) for a in arguments if a.startswith("-I") and pathlib.Path(a[2:]).is_relative_to(ROOT)]


def own_headers(path, folders, seen):
    """Adds the project's headers that path includes, directly or not, to seen."""
    for name in INCLUDE.findall(path.read_text(errors="replace")):
        for folder in (path.parent, *folders):
            header = folder / name
            if header.is_file() and header not in seen:
                seen.add(header)
                own_headers(header, folders, seen)
                break


def without_includes(text):
    return re.sub(r"^\s*#\s*include\b.*\n", "", text, flags=re.MULTILINE)


def changed_files(revision):
    """What the working tree has other than the revision, but for where a file lies and what it includes."""
    git = ("git", "-C", str(ROOT))
    listed = subprocess.run([*git, "diff", "-M40%", "--name-status", revision], capture_output=True, text=True, check=True).stdout
    changed = set()
    for line in listed.splitlines():
        kind, *names = line.split("\t")
        path = ROOT / names[-1]
        if kind == "D":
            continue
        if kind[0] in "MR" and path.suffix in (".cpp", ".hpp"):
            old = subprocess.run([*git, "show", f"{revision}:{names[0]}"], capture_output=True, text=True, check=True).stdout
            if without_includes(old) == without_includes(path.read_text()):
                continue
        changed.add(path)
    return changed


def touched(sources, changed):
    """The sources that changed, and for each header that did one source that includes it, a changed one where there is."""
    if ROOT / ".clang-tidy" in changed:
        return set(sources)
    wanted = set(sources) & changed
    headers = {path for path in changed if path.suffix == ".hpp"}
    for path in [*sorted(wanted), *sorted(set(sources) - wanted)]:
        if not headers:
            break
        included = set()
        own_headers(path, include_folders(sources[path]), included)
        if headers & included:
            headers -= included
            wanted.add(path)
    return wanted


def tidy(*arguments):
    """Exit status and the text of a run of clang-tidy."""
    command = ["clang-tidy", "--quiet", "--warnings-as-errors=*", *(str(a) for a in arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout if done.stdout.strip() else done.stderr


def shared_arguments(entry):
    """The arguments that a source shares with others: all but those that name it and what is made of it."""
    kept, skipped = [], False
    for argument in entry["arguments"][1:]:
        if not skipped and argument not in ("-o", "-c", entry["file"]):
            kept.append(argument)
        skipped = argument == "-o"
    return tuple(kept)


def settings_folder(path):
    return next(parent for parent in path.parents if parent == ROOT or (parent / ".clang-tidy").is_file())


def may_share(path):
    """Whether each name that the source takes over by a using declaration or as an alias stands in it once more."""
    text = path.read_text(errors="replace")
    names = [first or second for first, second in USING.findall(text)]
    return all(len(re.findall(rf"\b{name}\b", text)) > names.count(name) for name in names)


def have_clashing_headers(folders):
    names = [header.name for folder in folders for header in folder.glob("*.h*")]
    return len(names) != len(set(names))


class Batches:
    """Forms batches of sources and checks them. folder: for the batches; it is emptied first."""

    def __init__(self, folder, entries):
        self.folder = folder
        self.shared = {pathlib.Path(entry["file"]): shared_arguments(entry) for entry in entries}
        self.count = itertools.count()
        shutil.rmtree(folder, ignore_errors=True)
        # The batches lie in a tree like the project's, so that each has the settings of its sources.
        for settings in {ROOT, *(settings_folder(path) for path in self.shared)}:
            self.like(settings).mkdir(parents=True, exist_ok=True)
            if (settings / ".clang-tidy").is_file():
                shutil.copy(settings / ".clang-tidy", self.like(settings))

    def like(self, path):
        return self.folder / path.relative_to(ROOT)

    def form(self, sources):
        """A list of batches, each a list of sources."""
        batches, groups = [], {}
        for path in sorted(sources):
            if may_share(path):
                groups.setdefault((self.shared[path], settings_folder(path), path.suffix), []).append(path)
            else:
                batches.append([path])
        for group in groups.values():
            folders = sorted({path.parent for path in group})
            # What is included by its name alone must be the same header in the batch.
            parts = [group] if not have_clashing_headers(folders) else [
                [path for path in group if path.parent == folder] for folder in folders]
            for part in parts:
                count = math.ceil(len(part) / SOURCES_PER_BATCH)
                batches += [part[len(part) * i // count:len(part) * (i + 1) // count] for i in range(count)]
        return batches

    def check_together(self, sources):
        batch = self.like(settings_folder(sources[0])) / f"batch_{next(self.count)}{sources[0].suffix}"
        batch.write_text("".join(f'#line 1 "{path}"\n{path.read_text()}\n' for path in sources))
        # Files included by their name alone lie beside the source, but not beside the batch.
        beside = [word for folder in sorted({path.parent for path in sources}) for word in ("-iquote", folder)]
        return tidy(batch, "--", "-ferror-limit=0", *self.shared[sources[0]], *beside)

    def check(self, sources):
        """[(source, status, text)]"""
        passed = []
        if len(sources) > 1:
            status, text = self.check_together(sources)
            if status == 0:
                return [(path, 0, "") for path in sources]
            if errors := re.findall(r"^(.+?):\d+:\d+: .*\[clang-diagnostic-error", text, re.MULTILINE):
                # The first compiles as if it were alone. Where no source is named, the first is parted from the others.
                named = [path for path in sources[1:] if str(path) in errors] or sources[1:]
                return self.check([path for path in sources if path not in named]) + self.check(named)
            places = set(re.findall(r"^(.+?):\d+:\d+: (?:warning|error): ", text, re.MULTILINE))
            if places and places <= {str(path) for path in sources}:
                passed = [path for path in sources if str(path) not in places]
        return [(path, 0, "") if path in passed else (path, *tidy(f"-p={self.folder.parent}", path)) for path in sources]


def main():
    words = sys.argv[1:]
    touched_since, end_s = None, math.inf
    while words[:1] in (["--since"], ["--seconds"]) and len(words) > 2:
        if words[0] == "--since":
            touched_since = changed_files(words[1])
        else:
            end_s = time.monotonic() + float(words[1])
        words = words[2:]
    if not words or words[0].startswith("-"):
        sys.exit(__doc__)
    build = pathlib.Path(words[0]).resolve()
    wanted = {pathlib.Path(name).resolve() for name in words[1:]}
    work = build / "lint"
    work.mkdir(exist_ok=True)
    database = {}
    for path, command in own_sources(json.loads((build / "compile_commands.json").read_text())):
        arguments = arguments_of(command)
        # One source compiled several times (once per instruction set) is checked once, as it is compiled first.
        if path not in database and (not wanted or path in wanted):
            database[path] = {"directory": command["directory"], "file": str(path), "arguments": arguments}
    if touched_since is not None:
        wanted = touched({path: entry["arguments"] for path, entry in database.items()}, touched_since)
        database = {path: entry for path, entry in database.items() if path in wanted}
    (work / "compile_commands.json").write_text(json.dumps(list(database.values()), indent=1))
    failures, late = [], []

    def in_time(batch):
        if time.monotonic() < end_s:
            return batches.check(batch)
        late.extend(batch)
        return []

    processes = int(os.environ.get("GDTSLAM_JOBS", os.cpu_count() or 1))
    batches = Batches(work / "batches", database.values())
    # The longest first, so that no process is left with one at the end.
    formed = sorted(batches.form(database), key=lambda batch: -sum(path.stat().st_size for path in batch))
    print(f"{len(database)} to check, in {len(formed)} batches", flush=True)
    with concurrent.futures.ThreadPoolExecutor(processes) as pool:
        for job in concurrent.futures.as_completed([pool.submit(in_time, batch) for batch in formed]):
            for path, status, text in job.result():
                if status != 0:
                    failures.append(path)
                    print(f"--- {path.relative_to(ROOT)}\n{text}", flush=True)
    checked = len(database) - len(late)
    print(f"{checked - len(failures)} of {checked} checked sources pass")
    if late:
        print(f"{len(late)} were left out after the time that was given; tools/soak.sh lint checks all")
    sys.exit(1 if failures else 77 if late else 0)


if __name__ == "__main__":
    main()
