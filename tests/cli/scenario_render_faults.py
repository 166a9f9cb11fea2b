"""gdtslam render where something is missing or wrong: display, OpenGL, ffmpeg, disk, files of a run, options."""

import ctypes
import json
import os
import pathlib
import re
import shutil
import signal
import stat
import subprocess
import time

import cli_support as cli
from cli_support import DATA, LOG, PROGRAM, RUN, TRUTH, command, digests, environment, expect, expect_exit, finish, one_error_line
from scenario_render import Png, nodding_run, refused, rendered, require_ffmpeg, require_viewer

NOWHERE = "/dev/null/none"  # which nobody can make
NO_GL = {"__EGL_VENDOR_LIBRARY_FILENAMES": NOWHERE, "DISPLAY": None}
SMALL = ("--size", "64x48")


def render_without_a_display():
    """DISPLAY unset or wrong, as this user and as one who owns nothing, many times in a row: the same picture each time."""
    require_viewer()
    drive = nodding_run("render_without_a_display")
    times = int(os.environ.get("GDTSLAM_RENDERS", "100"))
    pictures = set()
    for number in range(times):
        rendered(drive.folder / "run", "-o", drive.folder / "a.png", *SMALL, env=environment(DISPLAY=None, WAYLAND_DISPLAY=None))
        pictures.add((drive.folder / "a.png").read_bytes())
        expect(len(pictures) == 1, f"picture {number} differs")
    for elsewhere in ({"DISPLAY": ":7777", "WAYLAND_DISPLAY": "nothing"}, {"DISPLAY": "nowhere.invalid:0"}):
        rendered(drive.folder / "run", "-o", drive.folder / "a.png", *SMALL, env=environment(**elsewhere))
        expect((drive.folder / "a.png").read_bytes() in pictures, f"{elsewhere}: another picture")
    if os.geteuid() != 0 or not shutil.which("setpriv"):
        return
    place = pathlib.Path("/tmp") / f"gdtslam-render-{os.getpid()}"  # the work folder may lie where nobody else may look
    shutil.copytree(drive.folder / "run", place / "run")
    program = cli.installed_copy(place)
    for path in (place, place / "run", *place.rglob("*")):
        path.chmod(path.stat().st_mode | stat.S_IROTH | (stat.S_IXOTH if path.is_dir() or path == program else 0))
    place.chmod(0o777)
    try:
        process = subprocess.run(["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", str(program), "render",
                                  str(place / "run"), "-o", str(place / "b.png"), *SMALL], capture_output=True, text=True, check=False,
                                 env=environment(DISPLAY=None, HOME=NOWHERE, XDG_CACHE_HOME=None, XDG_RUNTIME_DIR=None), timeout=100 * cli.SLOWNESS)
        expect_exit(process, 0)
        expect(process.stderr == "" and (place / "b.png").read_bytes() in pictures, f"another picture: {process.stderr}")
    finally:
        shutil.rmtree(place)


def home_is_not_made():
    """A home folder that is not there is not made, neither by this program nor by the drivers that it loads."""
    require_viewer()
    folder = cli.fresh_folder("home_is_not_made")
    env = environment(HOME=str(folder / "home"), XDG_CACHE_HOME=None)
    rendered("paper-b", "-o", folder / "a.png", "--view", "scene", *SMALL, env=env)
    expect_exit(command("doctor", "--devices", env=env), 0)
    expect_exit(command("map", LOG, "--first", 5, "-o", folder / "run", "-q", env=env), 0)
    if cli.vulkan_devices():
        expect_exit(command("verify", "--device", "vulkan:0", "seed_scatter", "-q", env=env), 0)
    expect(not (folder / "home").exists(), f"a home: {sorted(digests(folder))}")


def render_without_opengl():
    """No driver at all: exit 69 and one line from render, also for films; what needs none is drawn all the same; map
    warns, counts it and is as good without."""
    require_viewer()
    drive = nodding_run("render_without_opengl")
    run = drive.folder / "run"
    for name, *arguments in (("a.png",), ("a.png", "--view", "scene"), ("a.gif",)):
        refused(69, run, "-o", drive.folder / name, *arguments, env=environment(**NO_GL),
                says=("can draw with OpenGL: EGL", "(apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)"))
    expect(not list(drive.folder.glob("a.*")), "something is left")
    rendered(run, "--view", "map", "-o", drive.folder / "map.png", *SMALL, env=environment(**NO_GL))
    process = command("map", drive.log, "-o", drive.folder / "again", "--json", env=environment(**NO_GL))
    expect_exit(process, 0)
    report = json.loads(process.stdout)
    expect(report["warnings"] == {"no picture of the cloud": 1}, f"{report['warnings']}")
    expect("warning: no picture of the cloud" in process.stderr and len(process.stderr.splitlines()) == 1, process.stderr)
    expect(sorted(digests(drive.folder / "again")) == sorted([*cli.NODDING_OUTPUTS, "cloud.ply"]), f"{sorted(digests(drive.folder / 'again'))}")
    process = command("map", drive.log, "-o", drive.folder / "again", "--force", "--json")
    expect(json.loads(process.stdout)["warnings"] == {} and sorted(digests(drive.folder / "again")) == cli.CLOUD_OUTPUTS, process.stderr)
    process = command("map", drive.log, "-o", drive.folder / "again", "--force", "-q", "--no-pictures")
    files = sorted(digests(drive.folder / "again"))
    expect(cli.OVERVIEW not in files and "cloud.png" not in files and "cloud.ply" in files, f"pictures of the run before: {files}")


def fake_ffmpeg(folder, script):
    path = folder / "ffmpeg"
    path.write_text(f"#!/bin/sh\nfor last; do :; done\nout=$last\n{script}\n")
    path.chmod(0o755)
    return path


def children_of(pid):
    """Processes whose parent is this one."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(entry.read_text().rsplit(")", 1)[1].split()[1]) == pid:
                found.append(int(entry.parent.name))
        except (OSError, ValueError):
            continue
    return found


def signal_another_thread(pid, number):
    """What is sent to a process is handled by any thread that does not hold it back, mostly the first: here by another.
    ThreadSanitizer keeps it from a thread that sleeps in a library until it wakes, so there any thread will do."""
    if os.environ["GDTSLAM_CLI_SANITIZER"] == "thread":
        os.kill(pid, number)
        return
    def takes_it(thread):
        held_back = re.search(r"SigBlk:\s*(\w+)", pathlib.Path(f"/proc/{pid}/task/{thread}/status").read_text())[1]
        return not int(held_back, 16) >> (number - 1) & 1
    others = [int(name) for name in os.listdir(f"/proc/{pid}/task") if int(name) != pid and takes_it(name)]
    libc = ctypes.CDLL(None, use_errno=True)
    expect(libc.tgkill(pid, others[0] if others else pid, int(number)) == 0, os.strerror(ctypes.get_errno()))


def render_interrupted_film():
    """SIGINT in the middle of a film, also while ffmpeg takes nothing, and handled by another thread than the one that waits
    for it: exit 130, one line, no file, no process. Frames stay."""
    require_viewer()
    require_ffmpeg()
    folder = cli.fresh_folder("render_interrupted")
    stuck = fake_ffmpeg(folder, "exec sleep 1000")
    for arguments in (("-o", folder / "a.mp4"), ("-o", folder / "stuck.mp4")):
        path = f"{stuck.parent}:{os.environ['PATH']}" if "stuck" in str(arguments) else os.environ["PATH"]
        process = subprocess.Popen([PROGRAM, "render", "paper-b", "--seconds", "200s", *map(str, arguments)], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, env=environment(PATH=path))
        for _ in range(200):
            time.sleep(0.05)
            children = children_of(process.pid)
            if children:
                break
        expect(children, "no ffmpeg was started")
        time.sleep(1.5)
        signal_another_thread(process.pid, signal.SIGINT)
        done = finish(process)
        expect_exit(done, 130)
        one_error_line(done.stderr)
        expect("nothing is written" in done.stderr, done.stderr)
        expect(not any(pathlib.Path(f"/proc/{pid}").exists() for pid in children), "ffmpeg still runs")
        expect(sorted(digests(folder)) == ["ffmpeg"], f"{sorted(digests(folder))}")
    process = subprocess.Popen([PROGRAM, "render", "paper-b", "--seconds", "200s", *SMALL, "-o", f"{folder}/frames/"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    while not (folder / "frames/frame-0003.png").exists():
        expect(process.poll() is None, "it ended early")
        time.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    done = finish(process)
    expect_exit(done, 130)
    frames = sorted((folder / "frames").iterdir())
    expect(f"after {len(frames)} of 5000 frames; they are in" in done.stderr, done.stderr)
    for path in frames[-2:]:
        expect(Png(path).width == 64, f"{path} is no whole picture")


def render_unwritable():
    """Disk full at whichever write, a folder in the way, a folder that is not there, one that is read only: 74, old files kept."""
    require_viewer()
    drive = nodding_run("render_unwritable")
    folder, run = drive.folder / "out", drive.folder / "run"
    folder.mkdir()
    for name in ("a.png", "a.svg", "a.pdf", "a.glb", "a.ply", "a.html"):
        size = SMALL if name[-3:] in ("png", "svg", "pdf") else ()
        view = ("--view", "cloud") if size else ()
        refused(74, run, *view, *size, "-o", folder / "none" / name, says=name)
        (folder / name).write_text("old")
        if not cli.IS_SANITIZED:
            refused(74, run, *view, *size, "-o", folder / name, "--force", says="No space left on device", env=cli.full_disk())
        expect((folder / name).read_text() == "old" and len(digests(folder)) == 1, f"{name}: {sorted(digests(folder))}")
        (folder / name).unlink()
    refused(74, "paper-b", *SMALL, "--seconds", "0.1s", "-o", "/proc/a.mp4", says="a.mp4")
    refused(74, run, *SMALL, "-o", "/proc/a.png", says="a.png")


def render_mistakes():
    """Wrong options: exit 2, one line that says what would fit; nothing is drawn or written."""
    require_viewer()
    folder = cli.fresh_folder("render_mistakes")
    out = ("-o", folder / "a.png")
    cases = [
        ((RUN, "-o", folder / "a.gbl"), "did you mean '.glb'"),
        ((RUN, "-o", folder / "a.mp4", "--view", "map"), "does not move"),
        ((RUN, "--view", "cloud", *out), "has no 3D cloud; its views are map, graph, loops, field, trajectory"),
        ((RUN, "--view", "fild", *out), "did you mean 'field'"),
        (("paper-b", "-o", folder / "a.mp4", "--size", "641x361"), "642x362"),
        (("paper-b", "-o", folder / "a.mp4", "--seconds", "2h", "--fps", 240), "at most 100000 frames"),
        ((RUN, "paper-b", *out), "several inputs"),
        ((RUN, "--fps", 30, *out), "--fps: has no effect"),
    ]
    for arguments, says in cases:
        process = command("render", *arguments)
        expect(process.returncode == 2, f"{arguments}: exit {process.returncode}: {process.stderr}")
        one_error_line(process.stderr)
        expect(says in process.stderr, f"{arguments}: {says!r} is not in {process.stderr!r}")
    (folder / "dir.png").mkdir()
    refused(2, "paper-b", "-o", folder / "dir.png", says="dir.png' is a folder; end it in / for the frames")
    (folder / "dir.png").rmdir()
    said = command("render", RUN / "trajectory.tum", "--list-views").stdout
    expect(said.startswith("trajectory ") and "--reference or --relations FILE" in said and "errors --as path" in said, said)
    for arguments, code, says in [
        (("paper-z", *out), 74, "did you mean 'paper-"),
        ((folder / "none.ply", *out), 74, "no such file"),
        ((DATA / "empty.ply", *out), 65, "has no points"),
        ((LOG, *out), 65, "map it first: gdtslam map"),
        ((DATA / "bad.tum", "--reference", TRUTH, *out), 65, "bad.tum:2"),
        ((RUN, "--reference", DATA / "far.tum", "--view", "errors", "--as", "cdf", *out), 65, "stamps"),
    ]:
        refused(code, *arguments, says=says)
    expect(not list(folder.iterdir()), f"{list(folder.iterdir())}")
