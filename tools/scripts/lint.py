#!/usr/bin/env python3
"""Runs clang-tidy with warnings as errors over every C++ source of the project.

Usage: lint.py BUILD_FOLDER [FILE...]

One process per processor. A file whose text, own headers, compile command and .clang-tidy have not changed since it last
passed is not checked again; the record lies in BUILD_FOLDER/lint. With CI=true the record is ignored.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("engine", "calib", "viewer", "tools", "tests", "examples")
# What only GCC knows, and -Werror: clang's own warnings are for the fuzzing build, which is made by clang.
DROPPED_FLAGS = {"-Werror"}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def own_sources(commands):
    for command in commands:
        path = pathlib.Path(command["directory"], command["file"]).resolve()
        if path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in FOLDERS:
            yield path, command


def arguments_of(command):
    arguments = shlex.split(command["command"])
    if pathlib.Path(arguments[0]).name == "ccache":
        arguments = arguments[1:]
    return [a for a in arguments if a not in DROPPED_FLAGS]


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


def fingerprint(path, arguments, version):
    headers = set()
    own_headers(path, include_folders(arguments), headers)
    digest = hashlib.sha256(version)
    digest.update(" ".join(arguments).encode())
    configs = [ROOT / ".clang-tidy", *(parent / ".clang-tidy" for parent in path.parents if parent != ROOT)]
    for file in [path, *sorted(headers), *configs]:
        if file.is_file():
            digest.update(str(file).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()


def tidy(path, folder):
    started = time.monotonic()
    done = subprocess.run(
        ["clang-tidy", "--quiet", "--warnings-as-errors=*", f"-p={folder}", str(path)],
        capture_output=True, text=True, check=False)
    return path, done.returncode, done.stdout, done.stderr, time.monotonic() - started


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    build = pathlib.Path(sys.argv[1]).resolve()
    wanted = {pathlib.Path(name).resolve() for name in sys.argv[2:]}
    work = build / "lint"
    work.mkdir(exist_ok=True)
    record_file = work / "passed.json"
    record = {}
    if record_file.is_file() and os.environ.get("CI") != "true":
        record = json.loads(record_file.read_text())

    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    database, prints = [], {}
    for path, command in own_sources(json.loads((build / "compile_commands.json").read_text())):
        arguments = arguments_of(command)
        # One source compiled several times (once per instruction set) is checked once, as it is compiled first.
        if path in prints or (wanted and path not in wanted):
            continue
        prints[path] = fingerprint(path, arguments, version)
        database.append({"directory": command["directory"], "file": str(path), "arguments": arguments})
    (work / "compile_commands.json").write_text(json.dumps(database, indent=1))

    changed = [path for path, key in prints.items() if record.get(str(path)) != key]
    print(f"{len(prints)} sources, {len(prints) - len(changed)} unchanged since they passed", flush=True)
    failures = []
    processes = int(os.environ.get("GDTSLAM_JOBS", os.cpu_count() or 1))
    with concurrent.futures.ThreadPoolExecutor(processes) as pool:
        largest_first = sorted(changed, key=lambda path: -path.stat().st_size)
        for job in concurrent.futures.as_completed([pool.submit(tidy, path, work) for path in largest_first]):
            path, status, output, errors, seconds = job.result()
            if status == 0:
                record[str(path)] = prints[path]
                record_file.write_text(json.dumps(record, indent=1))
            else:
                failures.append(path)
                print(f"--- {path.relative_to(ROOT)} ({seconds:.1f} s)\n{output}", flush=True)
                if not output.strip():
                    print(errors, flush=True)
    print(f"{len(changed) - len(failures)} of {len(changed)} checked sources pass")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
