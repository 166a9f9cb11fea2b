"""`live` and those around it: senders by sockets and growing files, who die and come back; readers who are slow or hang;
queues; snapshots; a map that stays; lines that a simulated robot sends at its own pace."""

import fcntl
import json
import os
import pty
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import tty

import cli_support as cli
from cli_support import LOG, PROGRAM, RUN, expect, expect_exit, one_error_line
from scenario_continue import lines_of_drive
from scenario_live import mapped_by_pipe

MADE_FILES = ("map.pgm", "trajectory.tum", "keyframes.bin.gz", "graph.g2o")


def started(*arguments, **options):
    options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options}
    return subprocess.Popen([PROGRAM, "live", *map(str, arguments)], **options)


def wait_until(condition, what, seconds=30):
    deadline = time.monotonic() + seconds * cli.SLOWNESS
    while not condition():
        expect(time.monotonic() < deadline, f"waited in vain for {what}")
        time.sleep(0.01)


def expect_same_files(folder, expected, what, names=MADE_FILES):
    for name in names:
        expect((folder / name).read_bytes() == (expected / name).read_bytes(), f"{what}: {name} is another")


def ended(process, code=0):
    """Its output, once it has ended by itself."""
    stdout, stderr = process.communicate(timeout=100 * cli.SLOWNESS)
    expect(process.returncode == code, f"exit {process.returncode}, expected {code}: {stderr}")
    return stdout, stderr


def read_lines(process, count):
    return [process.stdout.readline() for _ in range(count)]


# Sends what it is given on standard input, tells so, and holds the connection until somebody kills it.
SENDER = """
import socket, sys, time
family, address = (socket.AF_UNIX, sys.argv[1]) if len(sys.argv) == 2 else (socket.AF_INET, (sys.argv[1], int(sys.argv[2])))
connection = socket.socket(family)
connection.connect(address)
connection.sendall(sys.stdin.buffer.read())
print("sent", flush=True)
time.sleep(1000)
"""


def send_and_die(address, text):
    """A sender that is killed when it has sent that, its connection open."""
    process = subprocess.Popen([sys.executable, "-S", "-c", SENDER, *map(str, address)], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, text=True)
    process.stdin.write(text)
    process.stdin.close()
    expect(process.stdout.readline() == "sent\n", "the sender could not send")
    process.kill()
    process.wait()


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def live_senders_that_come_back():
    """By a socket of either kind: senders killed in the middle of a line, the next one goes on where it likes; half a line
    is dropped and counted, and the run is that of the whole lines."""
    folder = cli.fresh_folder("live_senders")
    lines = lines_of_drive(60)
    mapped_by_pipe(folder / "map", lines)
    path, port = folder / "laser.socket", free_port()
    half = len(lines) // 2
    for name, listen, address in (("unix", f"unix:{path}", [path]), ("tcp", f"tcp:{port}", ["127.0.0.1", port])):
        process = started("--listen", listen, "-o", folder / name)

        def is_listening():
            with socket.socket(socket.AF_UNIX if name == "unix" else socket.AF_INET) as one:
                return one.connect_ex(str(path) if name == "unix" else ("127.0.0.1", port)) == 0
        wait_until(is_listening, "a socket to listen at")
        send_and_die(address, "".join(lines[:half]) + lines[half][:100])
        send_and_die(address, "".join(lines[half:]))
        poses = [json.loads(line) for line in read_lines(process, 60)]
        expect([pose["scan"] for pose in poses] == list(range(60)), "scans are missing or out of order")
        process.send_signal(signal.SIGTERM)
        _, stderr = ended(process)
        expect("1 half line" in stderr or "half line of a sender that went away" in stderr, stderr)
        expect_same_files(folder / name, folder / "map", name)
    expect(not path.exists(), "the socket is left behind")


def live_listen_mistakes():
    """Addresses that are none, a name that a file has, a port that somebody has: one line, and its exit code."""
    folder = cli.fresh_folder("live_listen")
    (folder / "file").write_text("somebody's\n")
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        for code, *arguments in ((2, "--listen", "laser"), (2, "--listen", "tcp:many"), (2, "--listen", "tcp:localhost:7001"),
                                 (2, "--listen", "unix:" + "x" * 200), (74, "--listen", f"unix:{folder / 'file'}"),
                                 (74, "--listen", f"tcp:{other.getsockname()[1]}"), (74, "--listen", "unix:/nowhere/at/all"),
                                 (74, "--follow", folder / "missing.log"), (74, "--follow", folder),
                                 (2, "--listen", "tcp:7001", "--follow", LOG), (2, LOG, "--follow", LOG),
                                 (2, "--map", RUN, "-o", folder / "run"), (2, "--map", RUN, "--snapshot", "5")):
            process = cli.command("live", *arguments)
            expect_exit(process, code)
            one_error_line(process.stderr)
    expect((folder / "file").read_text() == "somebody's\n", "the file is gone")


def live_lets_the_next_sender_in():
    """A connection that is silent keeps no robot out: after some seconds the one that waits has its turn, and a line says so."""
    folder = cli.fresh_folder("live_silent")
    lines = lines_of_drive(40)
    mapped_by_pipe(folder / "map", lines)
    path = folder / "laser.socket"
    process = started("--listen", f"unix:{path}", "-o", folder / "live")
    wait_until(path.exists, "a socket to listen at")
    with socket.socket(socket.AF_UNIX) as silent, socket.socket(socket.AF_UNIX) as robot:
        wait_until(lambda: silent.connect_ex(str(path)) == 0, "a connection")
        silent.sendall(lines[0][:10].encode())
        robot.connect(str(path))
        robot.sendall("".join(lines).encode())
        expect(all(read_lines(process, 40)), "the robot was not heard")
        process.send_signal(signal.SIGTERM)
        _, stderr = ended(process)
    expect("makes way for the next one" in stderr and "half line of a sender" in stderr, stderr)
    expect_same_files(folder / "live", folder / "map", "after a silent sender")


def live_follows_a_file_that_grows():
    """A file is read as it grows, in pieces of any size. One that is replaced or cut, as logs are rotated, is read on from its
    new beginning, with a remark."""
    folder = cli.fresh_folder("live_follow")
    lines = lines_of_drive(60)
    half = [k for k, line in enumerate(lines) if line.startswith("FLASER")][40] + 1  # the new file is the shorter one
    mapped_by_pipe(folder / "map", lines)
    for how in ("grown", "replaced", "cut"):
        log = folder / f"{how}.log"
        log.write_text("")
        process = started("--follow", log, "-o", folder / how)
        text = "".join(lines if how == "grown" else lines[:half])
        with open(log, "a", encoding="ascii") as file:
            for begin in range(0, len(text), 1777):
                file.write(text[begin:begin + 1777])
                file.flush()
        read_lines(process, 60 if how == "grown" else 41)
        if how == "replaced":
            log.rename(folder / "replaced.log.1")
            time.sleep(0.2)  # for a moment no file has the name
        if how != "grown":
            log.write_text("".join(lines[half:]))
            read_lines(process, 19)
        process.send_signal(signal.SIGTERM)
        _, stderr = ended(process)
        expect(("was replaced or cut" in stderr) == (how != "grown"), stderr)
        expect_same_files(folder / how, folder / "map", how)


def write_at_once(process, text):
    process.stdin.write(text)
    process.stdin.close()


def dropped_of(report):
    return report["warnings"].get("scan dropped, the queue was full", 0) if isinstance(report["warnings"], dict) else sum(
        warning["count"] for warning in report["warnings"] if warning["kind"] == "scan dropped, the queue was full")


def live_queue_drops_the_oldest():
    """--queue 3 and all scans at once: nobody waits, the oldest waiting scan goes, the last one is never lost; every scan is
    mapped or counted, and the run is that of the copy of what was mapped."""
    folder = cli.fresh_folder("live_queue")
    lines = lines_of_drive(300)
    process = cli.command("live", "-o", folder / "live", "--queue", 3, input="".join(lines))
    expect_exit(process, 0)
    poses = [json.loads(line) for line in process.stdout.splitlines()]
    stamps = [float(line.split()[-3]) for line in lines if line.startswith("FLASER")]
    report = json.loads((folder / "live/report.json").read_text())
    found = re.search(r"scan dropped, the queue was full", process.stderr)
    rows = [line for line in (folder / "live/trajectory.tum").read_text().splitlines() if not line.startswith("#")]
    expect(0 < len(rows) < len(stamps) and found, f"{len(rows)} of {len(stamps)} scans: {process.stderr}")
    expect(len(rows) + dropped_of(report) == len(stamps), f"{len(rows)} mapped, {dropped_of(report)} dropped of {len(stamps)}")
    expect(abs(float(rows[-1].split()[0]) - max(float(row.split()[0]) for row in rows)) < 1e-9, "out of order")
    expect(poses[-1]["scan"] == len(rows) - 1, "the last line is not that of the last scan")
    expect_exit(cli.command("map", folder / "live/log-1.jsonl.zst", "-o", folder / "map", "-q"), 0)
    expect_same_files(folder / "live", folder / "map", "what was mapped", ("map.pgm", "trajectory.tum", "graph.g2o"))


def with_small_pipe(*arguments, text):
    """Started with a pipe of one page for its output, and given the text."""
    process = started(*arguments, stdin=subprocess.PIPE)
    fcntl.fcntl(process.stdout, fcntl.F_SETPIPE_SZ, 4096)
    write_at_once(process, text)
    return process


def live_slow_readers():
    """A slow reader gets every line. One that hangs stops nothing: the map is made, what it gets in the end are whole lines,
    and the others are counted."""
    folder = cli.fresh_folder("live_slow")
    lines = lines_of_drive(120)
    mapped_by_pipe(folder / "map", lines)
    slow = with_small_pipe("-o", folder / "slow", text="".join(lines))
    got = []
    for line in slow.stdout:
        got.append(json.loads(line)["scan"])
        time.sleep(0.005)
    expect(got == list(range(120)), f"a slow reader got {len(got)} lines")
    expect(slow.wait(100 * cli.SLOWNESS) == 0, slow.stderr.read())
    hung = with_small_pipe("-o", folder / "hung", "--queue", 200, text="".join(lines))
    wait_until(lambda: (folder / "hung/report.json").exists() and hung.poll() is not None, "the end of the drive", 100)
    stderr = hung.stderr.read()
    got = [json.loads(line)["scan"] for line in hung.stdout.read().splitlines()]
    found = re.search(r"(\d+) lines not read by anybody", stderr)
    expect(found and hung.returncode == 0, stderr)
    expect(len(got) + int(found.group(1)) == 120 and got == sorted(got), f"{len(got)} lines and {found.group(0)}")
    expect_same_files(folder / "hung", folder / "map", "with a reader that hangs")


def live_of_a_terminal_that_falls_silent():
    """A serial port is a terminal: its scans come, then nothing, and one SIGINT is the end of the drive."""
    folder = cli.fresh_folder("live_serial")
    lines = lines_of_drive(60)
    mapped_by_pipe(folder / "map", lines)
    ours, terminal = pty.openpty()
    tty.setraw(terminal)
    process = started(os.ttyname(terminal), "-o", folder / "live")
    text = "".join(lines).encode()
    while text:
        text = text[os.write(ours, text[:1000]):]
    expect([json.loads(line)["scan"] for line in read_lines(process, 60)] == list(range(60)), "scans are missing")
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    ended(process)
    expect_same_files(folder / "live", folder / "map", "from a terminal")
    os.close(terminal)
    os.close(ours)


def live_snapshots():
    """SIGUSR1 saves map and path so far while the pose lines go on; killed, the snapshot and the copy stay, and the run is
    gone on with; ended, the run has taken the snapshot's place."""
    folder = cli.fresh_folder("live_snapshots")
    lines = lines_of_drive(80)
    scans = [k for k, line in enumerate(lines) if line.startswith("FLASER")]
    mapped_by_pipe(folder / "map", lines)
    run = folder / "live"
    process = started("-o", run, stdin=subprocess.PIPE, bufsize=1)

    def feed(first, last):
        process.stdin.write("".join(lines[scans[first - 1] + 1 if first else 0:scans[last - 1] + 1]))
        process.stdin.flush()
        return read_lines(process, last - first)

    def rows():
        try:
            return sum(not line.startswith("#") for line in (run / "snapshot/trajectory.tum").read_text().splitlines())
        except FileNotFoundError:
            return 0
    feed(0, 40)
    process.send_signal(signal.SIGUSR1)
    wait_until(lambda: rows() == 40, "a snapshot of 40 scans")
    feed(40, 80)
    process.send_signal(signal.SIGUSR1)
    wait_until(lambda: rows() == 80, "a snapshot of 80 scans")
    header = (run / "snapshot/map.pgm").read_bytes()[:2]
    expect(header == b"P5" and "map.pgm" in (run / "snapshot/map.yaml").read_text(), "no map in the snapshot")
    expect(sorted(file.name for file in (run / "snapshot").iterdir()) == ["map.pgm", "map.yaml", "trajectory.tum"], "other files")
    process.kill()
    process.communicate()
    expect(rows() == 80, "the snapshot is gone with the process")
    expect_exit(cli.command("map", LOG, "-o", run, "--force", "-q", "--first", 20), 0)
    expect(not (run / "snapshot").exists(), "the snapshot is left beside the run that took its place")
    shutil.rmtree(run)
    process = started("-o", run, "-q", "--snapshot", 0.1, stdin=subprocess.PIPE, bufsize=1)
    feed(0, 80)
    wait_until(lambda: rows() == 80, "a snapshot by the clock")
    process.stdin.close()
    expect(process.wait(100 * cli.SLOWNESS) == 0, process.stderr.read())
    expect(not (run / "snapshot").exists(), "the snapshot is left beside the run")
    expect_same_files(run, folder / "map", "with snapshots")


def live_in_a_map_that_stays():
    """--map: the poses are those of `localize --track`, a line for each scan, before the next one is sent; SIGTERM ends it
    with exit 0, and nothing is written."""
    folder = cli.fresh_folder("live_frozen")
    lines = lines_of_drive(80)
    (folder / "drive.log").write_text("".join(lines))
    expect_exit(cli.command("localize", RUN, folder / "drive.log", "--track", "-o", folder / "track.tum", "-q"), 0)
    wanted = [[float(word) for word in line.split()] for line in (folder / "track.tum").read_text().splitlines()
              if not line.startswith("#")]
    before = sorted(RUN.iterdir())
    process = started("--map", RUN, stdin=subprocess.PIPE, bufsize=1, cwd=folder)
    poses = []
    for line in lines:
        process.stdin.write(line)
        process.stdin.flush()
        if line.startswith("FLASER"):
            poses.append(json.loads(process.stdout.readline()))
    process.send_signal(signal.SIGTERM)
    _, stderr = ended(process)
    expect("80 scans: " in stderr, stderr)
    known = [pose for pose in poses if pose["pose"] is not None]
    expect(len(poses) == 80 and len(known) == len(wanted), f"{len(known)} known of {len(poses)}, tracked {len(wanted)}")
    for pose, row in zip(known, wanted):
        off = max(abs(pose["stamp_s"] - row[0]), abs(pose["pose"][0] - row[1]), abs(pose["pose"][1] - row[2]))
        expect(off < 1e-6 and pose["whereabouts"] in ("found", "tracked", "predicted"), f"{pose} is not {row}")
        c = pose["covariance"]
        expect(0.0 < c[0] < 1.0 and 0.0 < c[3] < 1.0 and c[0] * c[3] > c[1] * c[1] and 0.0 < c[5] < 0.1, f"covariance {c}")
    expect(sorted(RUN.iterdir()) == before and sorted(os.listdir(folder)) == ["drive.log", "track.tum"], "something was written")


def live_of_a_simulated_robot():
    """`simulate -o -` sends what it would write, at the robot's pace where that is asked for; mapped live it is the run of
    `map`."""
    folder = cli.fresh_folder("live_simulated")
    scene = ["corridor", "--seed", 3]
    written = cli.command("simulate", *scene, "-o", folder / "drive.log", "--json")
    if written.returncode == 69:
        cli.skip("this build has no simulator")
    expect_exit(written, 0)
    duration_s = json.loads(written.stdout)["duration_s"]
    expect_exit(cli.command("map", folder / "drive.log", "-o", folder / "map", "-q"), 0)
    pace = duration_s / 3.0  # three seconds
    for name, options in (("fast", []), ("paced", ["--pace", pace])):
        begin = time.monotonic()
        with open(folder / f"{name}.log", "wb") as copy:
            robot = subprocess.Popen([PROGRAM, "simulate", *map(str, scene + options), "-o", "-"], stdout=subprocess.PIPE)
            tee = subprocess.Popen(["tee", copy.name], stdin=robot.stdout, stdout=subprocess.PIPE)
            robot.stdout.close()
            process = started("-o", folder / name, "-q", stdin=tee.stdout)
            tee.stdout.close()
            stdout, _ = ended(process)
            expect(robot.wait() == 0 and tee.wait() == 0, "the robot failed")
        expect((folder / f"{name}.log").read_bytes() == (folder / "drive.log").read_bytes(), f"{name}: other lines")
        expect(stdout.count("\n") == json.loads(written.stdout)["scans"], f"{name}: {stdout.count(chr(10))} lines")
        expect_same_files(folder / name, folder / "map", name, ("map.pgm", "trajectory.tum", "graph.g2o", "keyframes.bin.gz"))
        expect(name == "fast" or time.monotonic() - begin > 2.5, "the robot hurried")
    for arguments in (["--json"], ["--nod", "continuous"], ["--truth-hits"]):
        process = cli.command("simulate", *scene, "-o", "-", *arguments)
        expect(process.returncode == 2, f"{arguments}: exit {process.returncode}")
    expect_exit(cli.command("simulate", *scene, "-o", folder / "x.log", "--pace", 1), 2)
