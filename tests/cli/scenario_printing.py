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
    process = command("map", LOG, "-o", folder, "--force", "--first", 100, "-q")
    expect(process.stdout == "" and process.stderr == "", "-q is not quiet")
    process = command("map", LOG, "-o", folder, "--force", "--first", 100, "-q", "--json")
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
    expect(process.wait(timeout=60 * cli.SLOWNESS) == 0, "the run failed")
    text = drawn.decode()
    expect(re.search(r"\r\x1b\[K +\d+ %  [\d,]+ scans  [\d,]+/s  .* left", text), f"no progress: {text!r}")
    for what in ("the occupancy map", "trajectory.tum", "overview.png", "map.pgm", "gdt.png"):
        expect(f"\r\x1b[Kmaking {what}" in text, f"nothing says that {what} is being made: {text!r}")
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


def hostile_names():
    """Escape sequences, line ends and broken UTF-8 in paths, names and values: one line each, nothing that a terminal obeys; letters
    of other alphabets stay."""
    folder = cli.fresh_folder("hostile_names")
    os.chdir(folder)
    hostile = b"\x1b[31mred\nline\xff\xc2\x9b2J b\xc3\xbcro"
    shown = "\\x1b[31mred\\nline\\xff\\xc2\\x9b2J b\u00fcro"
    text = hostile.decode("utf-8", "surrogateescape")
    (folder / "config.yaml").write_bytes(b'map:\n  resolution: "\\e[31mred\\nline"\n')
    (folder / "key.yaml").write_bytes(b'"\\e[31mred\\nline": 1\n')
    (folder / f"{text}.yaml").write_bytes(b"map: [")
    (folder / "linkage.yaml").write_bytes(b'gdtslam_linkage: 1\nname: "\\e[31mred\\nline"\npreset: paper-b\n')

    def bytes_of(code, *arguments):
        process = subprocess.run([PROGRAM, *arguments], capture_output=True, check=False, stdin=subprocess.DEVNULL, timeout=100 * cli.SLOWNESS)
        expect(process.returncode == code, f"{arguments}: exit {process.returncode}: {process.stderr}")
        return process.stdout, process.stderr

    cases = [(74, "map", hostile), (2, hostile), (2, "map", str(LOG), b"--" + hostile), (78, "map", str(LOG), "--set", hostile),
             (78, "map", str(LOG), "--set", b"map.resolution=" + hostile), (78, "map", str(LOG), "--matcher", hostile),
             (78, "map", str(LOG), "-c", "config.yaml"), (78, "map", str(LOG), "-c", "key.yaml"),
             (78, "map", str(LOG), "-c", hostile + b".yaml"), (74, "map", str(LOG), "-c", hostile), (74, "linkage", hostile),
             (74, "map", str(LOG), "-o", b"config.yaml/" + hostile), (2, "map", str(LOG), "--device", hostile),
             (74, "evaluate", hostile, "--reference", hostile), (74, "doctor", hostile)]
    for code, *arguments in cases:
        _, stderr = bytes_of(code, *arguments)
        lines = stderr.decode("utf-8").split("\n")
        expect(len(lines) == 2 and lines[1] == "" and lines[0].startswith("gdtslam: error: "), f"{arguments}: {stderr!r}")
        expect(all(letter.isprintable() for letter in lines[0]), f"{arguments}: {stderr!r}")
    expect(shown in bytes_of(74, "map", hostile)[1].decode("utf-8"), "the name is not shown")
    stdout, stderr = bytes_of(0, "linkage", "linkage.yaml")
    expect(b"\x1b" not in stdout + stderr and stderr == b"", f"linkage: {stdout!r}")
    stdout, stderr = bytes_of(0, "map", str(LOG), "--first", "10", "-o", hostile)
    expect(b"\x1b" not in stdout + stderr and f"results in {shown}\n" in stdout.decode("utf-8"), f"map: {stdout!r}")
    expect((folder / text / "report.json").exists(), "the results are elsewhere")
    (folder / f"{text}.log").symlink_to(LOG)
    stdout, _ = bytes_of(0, "map", hostile + b".log", "--first", "5", "-o", "run", "--json")
    expect("\ufffd" in json.loads(stdout)["log"][0], f"no name: {stdout!r}")
