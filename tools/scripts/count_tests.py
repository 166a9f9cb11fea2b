#!/usr/bin/env python3
"""Prints 'passed failed skipped' over JUnit files as ctest and GoogleTest write them."""

import sys
import xml.etree.ElementTree as ElementTree


def outcome_of(case):
    """The outcome of one test case: 'passed', 'failed' or 'skipped'."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    # GoogleTest says result="skipped"/"suppressed", ctest a <skipped> child or status="notrun"/"disabled".
    if case.find("skipped") is not None or case.get("result") in ("skipped", "suppressed"):
        return "skipped"
    if case.get("status") == "fail":
        return "failed"
    if case.get("status") in ("notrun", "disabled"):
        return "skipped"
    return "passed"


def main():
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for path in sys.argv[1:]:
        for case in ElementTree.parse(path).getroot().iter("testcase"):
            counts[outcome_of(case)] += 1
    print(counts["passed"], counts["failed"], counts["skipped"])


if __name__ == "__main__":
    main()
