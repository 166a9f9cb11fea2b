#!/usr/bin/env python3
"""Which of the long tests are left out where there is little time: `draw_tests.py BUILD_TREE --share N --revision COMMIT`.

Of the tests with the label `long` in the order of their numbers every N-th stays, beginning with one that the commit decides,
so that others have their turn with another commit. Prints a regular expression for `ctest --exclude-regex` that
matches the others, and nothing where all stay; how many they are goes to standard error."""

import argparse
import json
import re
import subprocess
import sys


def long_tests(tree):
    """Names of the tests with the label `long`, in the order of their numbers."""
    listed = subprocess.run(["ctest", "--test-dir", tree, "--show-only=json-v1"], stdout=subprocess.PIPE, check=True)
    tests = json.loads(listed.stdout)["tests"]
    labels = ({p["name"]: p["value"] for p in test.get("properties", [])}.get("LABELS", []) for test in tests)
    return [test["name"] for test, of_it in zip(tests, labels) if "long" in of_it]


def left_out(names, share, revision):
    """Those that do not have their turn."""
    first = int(revision[:8], 16) % share
    return [name for index, name in enumerate(names) if index % share != first]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tree")
    parser.add_argument("--share", type=int, required=True)
    parser.add_argument("--revision", required=True)
    options = parser.parse_args()
    if options.share < 1 or not re.fullmatch("[0-9a-f]{8,}", options.revision):
        parser.error("--share is a number from 1 on, --revision a commit in hexadecimal digits")
    names = long_tests(options.tree)
    if not names:
        parser.error(f"{options.tree} has no test with the label long")
    out = left_out(names, options.share, options.revision)
    if out:
        print(f"{len(out)} of {len(names)} long tests are left out", file=sys.stderr)
        print("^(" + "|".join(map(re.escape, out)) + ")$")


if __name__ == "__main__":
    main()
