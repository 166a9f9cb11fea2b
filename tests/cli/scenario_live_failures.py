"""Drives that end by an error: what came by then is mapped, or kept to be gone on with; it does not come again."""

import json
import os
import pty
import resource
import socket
import struct
import subprocess
import tty

import cli_support as cli
from cli_support import LOG, PROGRAM, RUN, expect, expect_exit, one_error_line
from scenario_continue import expect_same_run, lines_of_drive
from scenario_live import mapped_by_pipe

MAP_FILES = ("map.pgm", "trajectory.tum", "keyframes.bin.gz", "graph.g2o")


def small_files(size):
    """No file of the process becomes larger: as on a disk that is full."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def live_that_cannot_write_keeps_what_came():
    """The map has no room: 74, one line, and the log lies beside the folder; it gives the map that would have been."""
    folder = cli.fresh_folder("live_full_disk")
    lines = lines_of_drive(60)
    mapped_by_pipe(folder / "map", lines)
    largest = max((folder / "map" / name).stat().st_size for name in MAP_FILES)
    kept = (folder / "map/log-1.jsonl.zst").stat().st_size
    expect(kept < largest - 2000, f"the log has {kept} bytes, the largest file {largest}")
    for name, command in (("live", ("live", "-")), ("piped", ("map", "-"))):
        run, log = folder / name, folder / f"{name}-left-1.jsonl.zst"
        process = cli.command(*command, "-o", run, "-q", input="".join(lines), preexec_fn=small_files(largest - 1000))
        expect_exit(process, 74)
        one_error_line(process.stderr)
        expect(f"gdtslam map {log}" in process.stderr and not run.exists(), process.stderr)
        expect_exit(cli.command("map", log, "-o", run, "-q"), 0)
        for file in ("map.pgm", "trajectory.tum", "gdt.png"):
            expect((run / file).read_bytes() == (folder / "map" / file).read_bytes(), f"{name}: {file} of what was kept")


def live_that_cannot_print_is_mapped():
    """Standard output is full, or its reader resets the connection: the map is made all the same."""
    folder = cli.fresh_folder("live_no_output")
    lines = lines_of_drive(60)
    mapped_by_pipe(folder / "map", lines)
    with open("/dev/full", "w", encoding="ascii") as full:
        process = subprocess.run([PROGRAM, "live", "-", "-o", folder / "full", "-q"], input="".join(lines), stdout=full,
                                 stderr=subprocess.PIPE, text=True, check=False, timeout=100 * cli.SLOWNESS)
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect_same_run(folder / "full", folder / "map", "with a standard output that is full")
    reader, writer = connected()
    process = subprocess.Popen([PROGRAM, "live", "-", "-o", folder / "reset", "-q"], stdin=subprocess.PIPE, stdout=writer,
                               stderr=subprocess.PIPE, text=True)
    writer.close()
    process.stdin.write("".join(lines[:40]))
    process.stdin.flush()
    reader.recv(1)
    reset(reader)
    _, stderr = process.communicate("".join(lines[40:]), timeout=60 * cli.SLOWNESS)
    expect(process.returncode == 0, stderr)
    expect_same_run(folder / "reset", folder / "map", "with a reader that was reset")


def connected():
    with socket.create_server(("127.0.0.1", 0)) as listening:
        ours = socket.create_connection(listening.getsockname())
        return ours, listening.accept()[0]


def reset(connection):
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


def live_input_that_fails_is_mapped():
    """A connection that is reset, a terminal that hangs up: 74, one line, and the map of what came."""
    folder = cli.fresh_folder("live_input_fails")
    text = "".join(lines_of_drive(60)).encode()
    for name in ("reset", "hangup"):
        if name == "reset":
            ours, source = connected()
            send, leave = ours.sendall, lambda: reset(ours)
        else:
            ours, source = pty.openpty()
            tty.setraw(source)
            send, leave = lambda data: [os.write(ours, data[at:at + 1000]) for at in range(0, len(data), 1000)], lambda: os.close(ours)
        process = subprocess.Popen([PROGRAM, "live", "-", "-o", folder / name, "-q"], stdin=source, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, start_new_session=True)
        os.close(source) if name == "hangup" else source.close()
        send(text)
        poses = [process.stdout.readline() for _ in range(60)]
        expect(all(poses), f"{name}: a pose is missing")
        leave()
        _, stderr = process.communicate(timeout=60 * cli.SLOWNESS)
        is_end = name == "hangup" and process.returncode == 0  # the kernel may tell of the end of the file instead
        expect(is_end or process.returncode == 74, f"{name}: exit {process.returncode}: {stderr}")
        if not is_end:
            one_error_line(stderr)
            expect("the log broke off" in stderr, stderr)
        rows = [line for line in (folder / name / "trajectory.tum").read_text().splitlines() if not line.startswith("#")]
        expect(len(rows) == 60, f"{name}: {len(rows)} poses")


def live_of_a_recording_without_what_was_named():
    """That it has not that topic shows at its end: what was mapped is written all the same."""
    folder = cli.fresh_folder("live_of_a_recording_without_what_was_named")
    expect_exit(cli.command("convert", LOG, "-o", folder / "log.mcap", "-q"), 0)
    process = subprocess.run([PROGRAM, "live", "-", "-o", folder / "drive", "-q", "--odom", "/odmo"],
                             stdin=(folder / "log.mcap").open("rb"), capture_output=True, text=True, check=False)
    expect_exit(process, 2)
    expect("not in the log: " in process.stderr and "no odometry in topic \"/odmo\"" in process.stderr, process.stderr)
    report = json.loads((folder / "drive/report.json").read_text())
    expect(report["scans"] == len(process.stdout.splitlines()) > 100, f"{report['scans']} {process.stderr}")
    process = subprocess.run(f"{PROGRAM} live - --map {RUN} -q --odom /odmo < {folder}/log.mcap | (sleep 2; cat)", shell=True,
                             capture_output=True, text=True, check=False)
    expect(len(process.stdout.splitlines()) == report["scans"], f"{len(process.stdout.splitlines())} poses: {process.stderr}")
    expect("no odometry in topic \"/odmo\"" in process.stderr, process.stderr)
