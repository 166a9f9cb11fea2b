#!/usr/bin/env python3
"""Prints 'passed failed skipped' over JUnit files as ctest and GoogleTest write them; names each test that did not pass
on stderr, a skipped one with its reason."""

import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def read_report(path):
    """The root of a report; bytes in messages that XML does not allow become '?'."""
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    return ElementTree.fromstring(re.sub(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", text))


def outcome_of(case):
    """The outcome of one test case, 'passed', 'failed' or 'skipped', and the reason where there is one."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed", ""
    skipped = case.find("skipped")
    if case.get("result") is not None:  # GoogleTest
        reason = skipped.get("message", "") if skipped is not None else case.get("result")
        return ("passed" if case.get("result") == "completed" else "skipped"), reason
    # ctest. A test whose program is missing or whose fixture failed is marked as skipped too, but ctest counts it as
    # failed, and so does this script.
    if skipped is not None or case.get("status") in ("notrun", "disabled"):
        reason = skipped.get("message", "") if skipped is not None else ""
        if reason.startswith("SKIP_"):
            return "skipped", skip_reason(case.findtext("system-out") or "")
        return ("skipped" if case.get("status") == "disabled" else "failed"), reason
    return ("passed" if case.get("status") == "run" else "failed"), ""


def skip_reason(output):
    """What GoogleTest printed after 'Skipped', or the last line of another program."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    for number, line in enumerate(lines[:-1]):
        if line.endswith(": Skipped"):
            return lines[number + 1]
    return lines[-1] if lines else ""


def main():
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for path in sys.argv[1:]:
        for case in read_report(path).iter("testcase"):
            outcome, reason = outcome_of(case)
            counts[outcome] += 1
            if outcome != "passed":
                name = ".".join(dict.fromkeys((case.get("classname"), case.get("name"))))
                print(f"{outcome}: {name}  {' '.join(reason.split())}".rstrip(), file=sys.stderr)
    print(counts["passed"], counts["failed"], counts["skipped"])


if __name__ == "__main__":
    main()
