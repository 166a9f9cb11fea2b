#!/usr/bin/env python3
"""One run of the command: exit code, standard output and error against regular expressions, JSON against its table.
Called by gdtslam_cli_test of CMakeLists.txt, which says what is allowed where nothing is stated."""

import argparse
import re
import sys

from cli_support import DATA, LOG, RUN, TRUTH, command, expect, expect_exit, fresh_folder, one_error_line, validate


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--name", required=True)
    parser.add_argument("--exit", type=int, default=0)
    parser.add_argument("--stdout")
    parser.add_argument("--stderr")
    parser.add_argument("--schema")
    split = sys.argv.index("--")
    case = parser.parse_args(sys.argv[1:split])
    places = {"{log}": LOG, "{truth}": TRUTH, "{run}": RUN, "{data}": DATA}
    arguments = []
    for argument in sys.argv[split + 1:]:
        for name, path in places.items():
            argument = argument.replace(name, str(path))
        arguments.append(argument)
    process = command(*arguments, cwd=fresh_folder(f"cases/{case.name}"))
    expect_exit(process, case.exit)
    if case.stdout is not None:
        expect(re.search(case.stdout, process.stdout, re.DOTALL), f"stdout does not match {case.stdout!r}:\n{process.stdout}")
    if case.stderr is not None:
        expect(re.search(case.stderr, process.stderr), f"stderr does not match {case.stderr!r}:\n{process.stderr}")
    if case.exit != 0:
        one_error_line(process.stderr)
    elif case.stderr is None:
        expect(process.stderr == "", f"stderr is not empty: {process.stderr}")
    if case.schema is not None:
        validate(process.stdout, case.schema)


if __name__ == "__main__":
    main()
