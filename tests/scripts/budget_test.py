#!/usr/bin/env python3
"""The size of the project stays within budget.json.

A commit that makes the project larger raises a number there and says why in its message. A number that is more than 3 % above
what is counted is lowered, so that what a commit saves is not spent unseen by the next one.

Usage: budget_test.py [PROGRAM]; without the program its commands and settings are not counted.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRODUCT = ("engine", "calib", "viewer", "tools", "shaders", "python")
SLACK = 0.03


def files(*folders):
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--", *folders], capture_output=True, text=True, check=True)
    return [path for name in listed.stdout.split("\0") if name and (path := ROOT / name).is_file()]


def lines(paths):
    """Counts the lines of those paths that are text, as git has it: no zero byte in the first 8,000."""
    return sum(data.count(b"\n") for data in (path.read_bytes() for path in paths) if b"\0" not in data[:8000])


def count_sources():
    tests = [path for path in files("tests") if "corpus" not in path.parts]
    pages = [path for path in files() if path.suffix == ".md" and path.relative_to(ROOT).parts[0] not in ("tests", *PRODUCT)]
    headers = [path for path in files("engine", "calib", "viewer") if "include" in path.parts and path.suffix in (".hpp", ".h")]
    return {"product_lines": lines(files(*PRODUCT)), "test_lines": lines(tests), "documentation_lines": lines(pages),
            "public_headers": len(headers)}


def output(program, *arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout


def count_surface(program):
    commands = re.findall(r"^  ([a-z]+) ", output(program, "--help").partition("Examples:")[0], re.MULTILINE)
    settings = re.findall(r"^[a-z_.]+ += ", output(program, "config", "show"), re.MULTILINE)
    if "map" not in commands or not settings:
        raise SystemExit("budget_test.py: the lists of `gdtslam --help` and `config show` are not as this test reads them")
    return {"commands": len([name for name in commands if name != "help"]), "settings_shown": len(settings)}


def check(counted, budget):
    """Lists what is wrong with the budget, given what was counted."""
    wrong = []
    for name, number in counted.items():
        if number > budget[name]:
            wrong.append(f"{name}: {number}, the budget is {budget[name]}. Delete something, or raise the number in "
                         "tests/scripts/budget.json and say why in the commit.")
        elif budget[name] > number * (1 + SLACK):
            wrong.append(f"{name}: {number}, the budget of {budget[name]} is more than 3 % above. Lower it in "
                         "tests/scripts/budget.json.")
    return wrong


def main(arguments):
    budget = json.loads((ROOT / "tests" / "scripts" / "budget.json").read_text())
    counted = count_sources() | (count_surface(arguments[0]) if arguments else {})
    assert check({"commands": 17}, {"commands": 16}) and check({"commands": 15}, {"commands": 16})
    assert not check({"commands": 16}, {"commands": 16})
    for name, number in counted.items():
        print(f"{name}: {number} of {budget[name]}")
    wrong = check(counted, budget)
    print(*wrong, sep="\n", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
