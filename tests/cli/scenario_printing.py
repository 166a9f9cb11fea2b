"""What goes to standard output and error, in a pipe and on a terminal."""

import json
import os
import pty
import re
import subprocess

import cli_support as cli
from cli_support import LOG, OUTPUTS, PROGRAM, command, digests, expect, expect_exit, one_error_line


def quiet_and_silent_in_a_pipe():
    """No progress in a pipe; -q prints nothing at all; --json prints JSON only."""
    folder = cli.fresh_folder("quiet") / "run"
    process = command("map", LOG, "-o", folder, "--first", 300)
    expect_exit(process, 0)
    expect("\r" not in process.stdout + process.stderr and process.stderr == "", f"stderr: {process.stderr!r}")
    process = command("map", LOG, "-o", folder, "--first", 100, "-q")
    expect(process.stdout == "" and process.stderr == "", "-q is not quiet")
    process = command("map", LOG, "-o", folder, "--first", 100, "-q", "--json")
    expect(json.loads(process.stdout) == json.loads((folder / "report.json").read_text()), "--json is not report.json")


def progress_on_a_terminal():
    """On a terminal a line with share, rate and time left is drawn on standard error and wiped at the end."""
    folder = cli.fresh_folder("terminal") / "run"
    ours, theirs = pty.openpty()
    process = subprocess.Popen([PROGRAM, "map", str(LOG), str(LOG), "-o", str(folder)], stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    drawn = b""
    try:
        while chunk := os.read(ours, 4096):
            drawn += chunk
    except OSError:  # the other end is closed
        pass
    expect(process.wait(timeout=60) == 0, "the run failed")
    text = drawn.decode()
    expect(re.search(r"\r\x1b\[K +\d+ %  [\d,]+ scans  [\d,]+/s  .* left", text), f"no progress: {text!r}")
    rest = text.rsplit("\r\x1b[K", 1)[1].splitlines()  # remarks on what was mapped may follow
    expect(all(line.startswith("gdtslam: ") for line in rest), f"the line is not wiped: {rest}")


def closed_standard_output():
    """Standard output that cannot be written is an error, and the run's files are there all the same; a reader that went
    away is none."""
    folder = cli.fresh_folder("closed") / "run"
    with open("/dev/full", "w") as full:
        process = subprocess.run([PROGRAM, "map", LOG, "-o", folder, "--first", "20"], stdout=full, stderr=subprocess.PIPE,
                                 text=True, check=False)
    expect(process.returncode == 74, f"exit {process.returncode}")
    one_error_line(process.stderr)
    expect(sorted(digests(folder)) == OUTPUTS, "the files of the run are missing")
    read_end, write_end = os.pipe()
    os.close(read_end)
    process = subprocess.run([PROGRAM, "config", "show"], stdout=write_end, stderr=subprocess.PIPE, text=True, check=False)
    expect(process.returncode == 0 and process.stderr == "", f"exit {process.returncode}: {process.stderr}")
