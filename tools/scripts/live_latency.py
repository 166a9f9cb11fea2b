#!/usr/bin/env python3
"""Measures how long a robot waits for its pose: from the last byte of a scan's line to the line of its pose.

  live_latency.py [--program GDTSLAM] [--log CARMEN] [--speed FACTOR] [--busy N] [--threads N] [OPTION...]

Lines go through a pipe to `gdtslam live -`, each when the robot would send it, its time going FACTOR times as fast
(default 100), whether or not poses have come for the scans before it; so a scan that waits for others has that in its
figure; the last column leaves these out. Beside it N processes (default 1) keep a core busy each. OPTIONs after -- are
for `live`. Prints a table for docs/benchmarks.md; the log's default is intel.clf.gz in the folder slam2d of GDTSLAM_DATA,
else ../shared/data beside the clone.
"""

import argparse
import gzip
import json
import os
import pathlib
import select
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARES = (("p50", 0.5), ("p99", 0.99), ("p99.9", 0.999))


def stamp_of(line):
    """When the robot sent it, by the last but one number of a line; nothing of a header."""
    words = line.split()
    if words[:1] not in ([b"FLASER"], [b"ODOM"]):
        return None
    return float(words[-1])


def messages(log):
    """Bytes up to and with a scan's line, and the robot's time then."""
    open_log = gzip.open if log.suffix == ".gz" else open
    waiting, parts = b"", []
    with open_log(log, "rb") as file:
        for line in file:
            waiting += line
            if line.startswith(b"FLASER"):
                parts.append((stamp_of(line), waiting))
                waiting = b""
    return parts


def measured(process, parts, speed):
    """Seconds from each scan's last byte to its pose's line, and the lines. Time stands still where the log's does."""
    begin, robot_s, due = time.perf_counter() + 0.5, 0.0, []
    for k, (stamp, _) in enumerate(parts):
        robot_s += min(max(stamp - parts[k - 1][0], 0.0), 1.0) if k > 0 else 0.0
        due.append(begin + robot_s / speed)
    to, back = process.stdin.fileno(), process.stdout.fileno()
    os.set_blocking(to, False)
    sent, taken, lines, unread, left = 0, [], [], b"", b""
    starts = []  # before the write that gives a scan's last byte
    while len(lines) < len(parts):
        now = time.perf_counter()
        if not left and sent < len(parts) and now >= due[sent]:
            left = parts[sent][1]
            sent += 1
        if left:
            try:
                now = time.perf_counter()
                left = left[os.write(to, left):]
                if not left:
                    starts.append(now)
            except BlockingIOError:
                pass
        wait_s = max(due[sent] - time.perf_counter(), 0.0) if sent < len(parts) and not left else 60.0
        ready, _, _ = select.select([back], [to] if left else [], [], wait_s)
        if back not in ready:
            continue
        chunk = os.read(back, 1 << 16)
        now = time.perf_counter()
        if not chunk:
            sys.exit("gdtslam live ended before its poses had come")
        *whole, unread = (unread + chunk).split(b"\n")
        for line in whole:
            taken.append(now - starts[len(lines)])
            lines.append(line)
    alone = [taken[k] for k in range(1, len(taken)) if starts[k] >= starts[k - 1] + taken[k - 1]]
    return taken, alone, lines, time.perf_counter() - begin


def table(log, speed, busy, taken, alone, lines, lasted_s):
    in_order = sorted(taken)
    at = [in_order[min(int(share * len(in_order)), len(in_order) - 1)] for _, share in SHARES] + [in_order[-1]]
    poses = [json.loads(line) for line in lines]
    corrections = sum(a["correction"] != b["correction"] for a, b in zip(poses, poses[1:]))
    names = [name for name, _ in SHARES] + ["largest", "p99 of those that waited for no other"]
    at.append(sorted(alone)[int(0.99 * len(alone))])
    rows = ["| log | scans | a second | loops took effect | " + " | ".join(names) + " |",
            "|---|---|---|---|" + "---|" * len(names),
            f"| {log.name.split('.')[0]}, {speed:g} times the robot's speed, {busy} core{'' if busy == 1 else 's'} busy beside it | "
            f"{len(taken):,} | {len(taken) / lasted_s:,.0f} | {corrections} times | "
            + " | ".join(f"{1e3 * value:.2f} ms" for value in at) + " |"]
    return "\n".join(rows)


def main():
    data = os.environ.get("GDTSLAM_DATA") or ROOT.parent / "shared/data"
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/gdtslam"))
    parser.add_argument("--log", type=pathlib.Path, default=pathlib.Path(data) / "slam2d/intel.clf.gz")
    parser.add_argument("--speed", type=float, default=100.0)
    parser.add_argument("--busy", type=int, default=1)
    parser.add_argument("options", nargs="*")
    chosen = parser.parse_args()
    parts = messages(chosen.log)
    beside = [subprocess.Popen([sys.executable, "-S", "-c", "while True: pass"]) for _ in range(chosen.busy)]
    try:
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.Popen([chosen.program, "live", "-", "-q", "-o", f"{folder}/run", *chosen.options],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            taken, alone, lines, lasted_s = measured(process, parts, chosen.speed)
            process.stdin.close()
            if process.wait() != 0:
                sys.exit(f"gdtslam live ended with {process.returncode}")
    finally:
        for one in beside:
            one.kill()
            one.wait()
    print(table(chosen.log, chosen.speed, chosen.busy, taken, alone, lines, lasted_s))


if __name__ == "__main__":
    main()
