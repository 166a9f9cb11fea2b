"""What the experiments share: tables, commands, poses."""

import math
import os
import pathlib
import subprocess
import sys

from long_drives import poses_of

ROOT = pathlib.Path(__file__).resolve().parents[3]


def print_table(*columns):
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|", flush=True)


def print_row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def printed(*command):
    """What a command prints."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def peak_of(*command):
    """What a command prints, and the most bytes of memory that it held."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, text=True)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {process.returncode}")
    return text, 1024.0 * usage.ru_maxrss


def times(a, b):
    """The product of two poses (x, y, heading)."""
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], math.remainder(a[2] + b[2], 2.0 * math.pi)


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]


def stamped_poses(path):
    """(stamp, pose) of each row."""
    lines = [line.split() for line in path.read_text().splitlines() if line and not line.startswith("#")]
    return [(float(words[0]), pose) for words, pose in zip(lines, poses_of(path))]
