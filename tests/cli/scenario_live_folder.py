"""The folder of `live`, and the name it listens at: what others have there stays, and one that cannot be had shows before
the first scan comes."""

import os
import shutil
import signal
import socket
import subprocess

import cli_support as cli
from cli_support import LOG, expect, expect_exit, one_error_line
from scenario_continue import lines_of_drive
from scenario_live_inputs import ended, read_lines, started, wait_until


def contents(folder):
    return {file.relative_to(folder): file.read_bytes() if file.is_file() else None for file in folder.rglob("*")}


def feed(process, lines):
    process.stdin.write("".join(lines))
    process.stdin.flush()
    read_lines(process, sum(line.startswith("FLASER") for line in lines))


def with_snapshot(run, lines, *options):
    """A drive that goes on, and has saved one."""
    process = started("-o", run, *options, stdin=subprocess.PIPE, bufsize=1)
    feed(process, lines)
    process.send_signal(signal.SIGUSR1)
    wait_until((run / "snapshot").exists, "a snapshot")
    return process


def live_keeps_snapshots_of_others():
    """A folder of that name is a snapshot only where it holds the files of one and nothing else; all else stays as it is,
    whatever options are given, and the drive is refused."""
    folder = cli.fresh_folder("live_foreign_snapshot")
    snapshot = folder / "run/snapshot"
    names = ("map.yaml", "map.pgm", "trajectory.tum")
    for also in (("notes",), names[:2], (*names, "notes")):
        shutil.rmtree(snapshot, ignore_errors=True)
        snapshot.mkdir(parents=True)
        for name in also:
            (snapshot / name).write_text("mine\n")
        before = contents(folder)
        for option in (("--force",), ("--force", "--snapshot", 1)):
            process = cli.command("live", LOG, "-o", folder / "run", "-q", *option)
            expect_exit(process, 2)
            one_error_line(process.stderr)
            expect("is no snapshot of a drive" in process.stderr, process.stderr)
            expect(contents(folder) == before, f"what somebody had in the folder has changed: {sorted(contents(folder))}")
    elsewhere = folder / "elsewhere"
    snapshot.rename(elsewhere)
    (elsewhere / "notes").unlink()
    snapshot.symlink_to(elsewhere)
    expect_exit(cli.command("live", LOG, "-o", folder / "run", "--force", "-q"), 2)
    expect(len(contents(elsewhere)) == 3, "a link was followed")
    snapshot.unlink()


def live_of_a_folder_that_cannot_be_had():
    """Somebody else's, a file, one where nothing can be written: known before a sender comes; the other drive loses nothing."""
    folder = cli.fresh_folder("live_taken")
    run, path = folder / "run", folder / "laser.socket"
    lines = lines_of_drive(40)
    (folder / "file").write_text("mine\n")
    other = with_snapshot(run, lines)
    snapshot = contents(run / "snapshot")
    for code, output in ((2, run), (74, folder / "file"), (74, "/proc/self/nothing")):
        for source in (("--listen", f"unix:{path}"), ("--follow", LOG), ("--queue", 9, LOG), (LOG,)):
            process = cli.command("live", *source, "-o", output, "--force", "-q", timeout=30 * cli.SLOWNESS)
            expect_exit(process, code)
            one_error_line(process.stderr)
            expect(contents(run / "snapshot") == snapshot, "the snapshot of a drive that goes on has changed")
    expect(not path.exists(), "the socket is left behind")
    ended(other)
    expect((run / "report.json").exists() and not (run / "snapshot").exists(), "the drive that went on has not ended well")


def live_at_sockets_of_others():
    """Only a socket that nobody has any more is replaced, and only its own name is removed at the end."""
    folder = cli.fresh_folder("live_sockets")
    path = folder / "laser.socket"

    def live(code, said):
        before = os.lstat(path).st_ino
        process = cli.command("live", "--listen", f"unix:{path}", "-o", folder / "run", "-q", timeout=30 * cli.SLOWNESS)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(said in process.stderr, process.stderr)
        expect(os.lstat(path).st_ino == before, "the socket of another process is gone")

    for kind, backlog in ((socket.SOCK_DGRAM, None), (socket.SOCK_SEQPACKET, 1), (socket.SOCK_STREAM, 1), (socket.SOCK_STREAM, 0)):
        with socket.socket(socket.AF_UNIX, kind) as other:
            other.bind(str(path))
            if backlog is not None:
                other.listen(backlog)
            waiting = socket.socket(socket.AF_UNIX, kind)
            if backlog == 0:
                waiting.connect(str(path))  # one more has no place
            live(74, "a process does so")
            waiting.close()
        if kind != socket.SOCK_STREAM or backlog != 0:
            path.unlink()
    dead = os.lstat(path)
    process = started("--listen", f"unix:{path}", "-o", folder / "run", "-q")
    wait_until(lambda: path.exists() and os.lstat(path).st_ctime_ns != dead.st_ctime_ns, "a socket in place of the dead one")
    wait_until((folder / ".run.gdtslam-new").exists, "a drive that waits")
    path.unlink()
    with socket.socket(socket.AF_UNIX) as other:
        other.bind(str(path))
        process.send_signal(signal.SIGTERM)
        ended(process, 130)
        expect(path.exists(), "the socket of another process is gone")
