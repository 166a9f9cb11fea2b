"""Interrupts: the scan in hand is finished and what there is is written."""

import fcntl
import os
import pty
import re
import signal
import subprocess
import termios
import time

import cli_support as cli
from cli_support import LOG, PLAIN_OUTPUTS, PROGRAM, digests, expect, expect_exit, finish, one_error_line, scans_in


def start_slow_run(folder, **options):
    """A run that takes long enough to be interrupted: the log over and over through a pipe."""
    return subprocess.Popen([PROGRAM, "map", "-", "-o", str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)


# Mapping begins at once, without a look at the turns of the log's beginning.
AT_ONCE = ("--set", "log.odometry_stamps=log")


def interrupt_writes_what_there_is():
    """SIGINT, SIGTERM or SIGHUP in the middle of a file: the scan in hand is finished, all files are there, exit 130. Of a
    terminal that goes away two SIGHUPs come, from the kernel and from the shell."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        folder = cli.fresh_folder("interrupt") / "run"
        logs = [str(LOG)] * 200
        process = subprocess.Popen([PROGRAM, "map", *logs, "-o", str(folder), *AT_ONCE], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        time.sleep(1.0)
        process.send_signal(number)
        if number == signal.SIGHUP:
            time.sleep(0.05)
            process.send_signal(number)
        done = finish(process)
        expect_exit(done, 130)
        report = scans_in(folder)
        expect(sorted(digests(folder)) == PLAIN_OUTPUTS, "files are missing")
        expect(report["interrupted"] is True and report["scans"] > 0, "the report does not say so")
        poses = [line for line in (folder / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
        expect(len(poses) == report["scans"], f"{len(poses)} poses, {report['scans']} scans")
        expect(f"interrupted after {report['scans']} scans" in done.stderr, done.stderr)


def lost_terminal():
    """The terminal of a run goes away: what there is is written. With nohup it goes on."""
    folder = cli.fresh_folder("lost_terminal") / "run"
    ours, theirs = pty.openpty()

    def take_terminal():
        os.setsid()
        fcntl.ioctl(theirs, termios.TIOCSCTTY, 0)

    process = subprocess.Popen([PROGRAM, "map", *([str(LOG)] * 200), "-o", str(folder), *AT_ONCE], stdin=theirs, stdout=theirs,
                               stderr=theirs, preexec_fn=take_terminal)
    os.close(theirs)
    time.sleep(1.0)
    os.close(ours)
    expect(process.wait(timeout=60 * cli.SLOWNESS) == 130, f"exit {process.returncode}")
    expect(sorted(digests(folder)) == PLAIN_OUTPUTS and scans_in(folder)["interrupted"] is True, "files are missing")
    process = start_slow_run(folder.with_name("nohup"), preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    time.sleep(0.3)
    process.send_signal(signal.SIGHUP)
    stdout, stderr = process.communicate(LOG.read_text(), timeout=60 * cli.SLOWNESS)
    expect(process.returncode == 0, f"exit {process.returncode}: {stderr}")


def interrupt_of_standard_input():
    """SIGINT while the command waits for a pipe that stays open."""
    folder = cli.fresh_folder("interrupt_stdin") / "run"
    process = start_slow_run(folder)
    lines = LOG.read_text().splitlines(keepends=True)[:400]
    process.stdin.write("".join(lines))
    process.stdin.flush()
    time.sleep(1.5 * cli.SLOWNESS)
    expect(process.poll() is None, "the command did not wait for more input")
    process.send_signal(signal.SIGINT)
    done = finish(process)
    expect_exit(done, 130)
    scans = sum(line.startswith("FLASER") for line in lines)
    expect(0 < scans_in(folder)["scans"] <= scans, "no scan was mapped")
    expect(scans_in(folder)["scans"] >= scans - 1, f"{scans_in(folder)['scans']} of {scans} scans")


def interrupt_of_convert():
    """A signal while convert waits for standard input: what came is written, exit 130, one line that says so."""
    folder = cli.fresh_folder("interrupt_convert")
    for output in ("a.csv", "-"):
        with open(folder / "printed.csv", "w", encoding="utf-8") as printed:  # more than a pipe holds
            process = subprocess.Popen([PROGRAM, "convert", "-", "-o", output, "--format", "csv"], stdin=subprocess.PIPE, stdout=printed,
                                       stderr=subprocess.PIPE, text=True, cwd=folder)
        process.stdin.write("".join(LOG.read_text().splitlines(keepends=True)[:200]))
        process.stdin.flush()
        time.sleep(1.0 * cli.SLOWNESS)
        process.send_signal(signal.SIGINT)
        done = finish(process)
        expect_exit(done, 130)
        lines = done.stderr.splitlines()
        expect(len(lines) == 1 and re.fullmatch(r"gdtslam: interrupted after \d+ scans, which were written", lines[0]), done.stderr)
        written = folder / ("printed.csv" if output == "-" else output)
        expect(len(written.read_text().splitlines()) > 50, "what came is not written")


def interrupt_of_a_pipe_without_a_writer():
    """SIGTERM while a named pipe has no writer, or one that writes nothing: exit 130, no folder."""
    folder = cli.fresh_folder("interrupt_pipe")
    os.mkfifo(folder / "pipe")
    for arguments in (("map", folder / "pipe", "-o", folder / "run"), ("doctor", folder / "pipe"), ("live", folder / "pipe", "-o", folder / "run")):
        for has_writer in (False, True):
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            writer = os.open(folder / "pipe", os.O_WRONLY) if has_writer else -1
            time.sleep(0.5 * cli.SLOWNESS)
            expect(process.poll() is None, f"{arguments} did not wait")
            process.send_signal(signal.SIGTERM)
            done = finish(process)
            expect_exit(done, 130)
            one_error_line(done.stderr)
            expect(not (folder / "run").exists(), "a folder was left")
            if has_writer:
                os.close(writer)


def interrupt_of_a_pipe_without_a_reader():
    """A signal while a named pipe that is to be written has no reader, or one that reads nothing: exit 130, one line."""
    folder = cli.fresh_folder("interrupt_output_pipe")
    pipe = folder / "pipe.log"
    os.mkfifo(pipe)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        for has_reader in (False, True):
            reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK) if has_reader else -1
            process = subprocess.Popen([PROGRAM, "convert", str(LOG), "-o", str(pipe)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True)
            time.sleep(1.0 * cli.SLOWNESS)
            expect(process.poll() is None, "it did not wait")
            process.send_signal(number)
            done = finish(process)
            expect_exit(done, 130)
            one_error_line(done.stderr)
            expect(str(pipe) in done.stderr, done.stderr)
            if has_reader:
                os.close(reader)


def interrupt_before_the_first_scan():
    """SIGINT before anything came: exit 130, one line, no folder."""
    for text in ("", "# nothing yet\n", "FLASER 180 1.0 2.0"):
        folder = cli.fresh_folder("interrupt_early") / "run"
        process = start_slow_run(folder)
        process.stdin.write(text)
        process.stdin.flush()
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        done = finish(process)
        expect_exit(done, 130)
        one_error_line(done.stderr)
        expect(not folder.exists(), "a folder was left")


def second_interrupt_ends():
    """A second SIGINT ends the process at once, also where it cannot look at the flag."""
    pipe = cli.fresh_folder("second_interrupt") / "pipe"
    os.mkfifo(pipe)
    ours, terminal = cli.full_terminal()  # to which it cannot say that it was interrupted
    process = subprocess.Popen([PROGRAM, "doctor", str(pipe)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=terminal)
    writer = -1
    deadline = time.monotonic() + 30 * cli.SLOWNESS
    while writer < 0:  # until it reads, with what it does on signals in place
        expect(time.monotonic() < deadline, "nobody reads the pipe")
        try:
            writer = os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)
        except OSError:
            time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    time.sleep(0.5 * cli.SLOWNESS)
    expect(process.poll() is None, f"the first signal ended the process: {process.returncode}")
    process.send_signal(signal.SIGINT)
    process.wait(timeout=10 * cli.SLOWNESS)
    expect(process.returncode == -signal.SIGINT, f"exit {process.returncode}")
    for descriptor in (writer, terminal, ours):
        os.close(descriptor)
