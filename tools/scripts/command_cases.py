"""Commands that write: what lies in the folder before, and the words."""

import bz2
import lzma
import shutil
import signal
import sys
import time

QUICK = ("--set", "log.odometry_stamps=log")
SCANS = 12  # of the log that is mapped; more make more calls of the same places
ROOM = """gdtslam_scene: 1
name: room
floor: 0 m
ceiling: 2.4 m
wall_defaults: {thickness: 10 cm, height: 2.4 m}
walls:
  - {points: [[-1.5, -2.0], [4.5, -2.0], [4.5, 2.0], [-1.5, 2.0]], closed: true}
boxes:
  - {centre: [3.9, 1.2], size: [0.5, 0.8], height: 90 cm}
robot:
  laser: {preset: hokuyo-961, beams: 61, bearing_step: 4 deg, noise: 5 mm, height: 30 cm}
  nodding: {linkage: paper-b, crank_rate: 0.5 Hz, encoder: {rate: 20 Hz}}
recording: {scan_rate: 10 Hz, odometry_rate: 10 Hz}
waypoints: [[0, 0], {at: [0.6, 0.1], speed: 0.15}]
"""


class Case:
    """has_single_files: files that belong together only loosely, each whole; left_by_kill: parts of the names of what a kill
    may leave besides; stays: beginnings of the names of what stays done when a later step fails; leave_unfinished: makes the
    files that tell, then, that what was asked for is not there; varies: names of values that are no result, as those of
    undisturbed runs that differ."""

    def __init__(self, name, prepare, arguments, has_single_files=False, left_by_kill=(), stays=(), leave_unfinished=None,
                 varies=()):
        self.name, self.prepare, self.arguments = name, prepare, [str(word) for word in arguments]
        self.has_single_files, self.left_by_kill, self.stays = has_single_files, left_by_kill, stays
        self.leave_unfinished, self.varies = leave_unfinished, set(varies)

    def is_left_by_kill(self, name):
        return any(part in name for part in self.left_by_kill)

    def may_stay(self, files, old, new, unfinished):
        """Whether what there is besides the old files is what the pages say stays done, or tells that it is not."""
        return bool(self.stays) and old.keys() <= files.keys() and all(
            digest == old.get(name) or (name.startswith(self.stays) and digest in (new.get(name), unfinished.get(name)))
            for name, digest in files.items())


def short_log(folder, run, scans=SCANS, name="drive.log", skip=0):
    """The first scans of a simulated drive, or those behind them."""
    run("simulate", "office-loop", "-o", "whole.log", "--seed", 3, "--rate", 5, "-q", cwd=folder)
    lines = (folder / "whole.log").read_text().splitlines(keepends=True)
    head = [line for line in lines if line.startswith("PARAM")]
    numbers = [number for number, line in enumerate(lines) if line.startswith("FLASER")]
    begin = numbers[skip - 1] + 1 if skip else len(head)
    (folder / name).write_text("".join(head + lines[begin:numbers[skip + scans - 1] + 1]))
    for path in folder.glob("whole.*"):
        path.unlink()


def prepare_map(folder, run):
    short_log(folder, run)


def prepare_packed(folder, run):
    """The same log in every packing that is read."""
    short_log(folder, run)
    plain = (folder / "drive.log").read_bytes()
    (folder / "drive.log.bz2").write_bytes(bz2.compress(plain))
    (folder / "drive.log.xz").write_bytes(lzma.compress(plain))
    run("convert", "drive.log", "-o", "drive.log.gz", "-q", cwd=folder)
    run("convert", "drive.log", "-o", "drive.db3", "-q", cwd=folder)
    for ending, packing in (("bag", "lz4"), ("bag", "bz2"), ("mcap", "lz4"), ("mcap", "zstd")):
        run("convert", "drive.log", "-o", f"{packing}.{ending}", "--compression", packing, "-q", cwd=folder)
    (folder / "drive.log").unlink()


def prepare_over(folder, run):
    """An earlier run, coarser, and a file of somebody else."""
    short_log(folder, run)
    run("map", "drive.log", "-o", "out", "-q", "--first", SCANS - 4, "--set", "map.resolution=10 cm", *QUICK, cwd=folder)
    (folder / "out/notes.txt").write_text("mine")


def prepare_3d(folder, run):
    (folder / "room.yaml").write_text(ROOM)
    run("simulate", "room.yaml", "-o", "drive.log", "-q", cwd=folder)


def prepare_cloud(folder, run):
    prepare_3d(folder, run)
    run("map", "drive.log", "-o", "run", "-q", "--first", 30, "--no-pictures", cwd=folder)
    for path in folder.glob("drive.*"):
        path.unlink()


def prepare_next(folder, run):
    """A run that can be gone on with, and the log of the next drive."""
    short_log(folder, run)
    short_log(folder, run, name="next.log", skip=SCANS)
    run("map", "drive.log", "-o", "out", "-q", *QUICK, cwd=folder)


def prepare_run(folder, run):
    short_log(folder, run)
    run("map", "drive.log", "-o", "run", "-q", *QUICK, cwd=folder)
    (folder / "run/keep-out.png").write_bytes(b"mask")


def prepare_runs(folder, run):
    short_log(folder, run, 60, "one.log")
    short_log(folder, run, 60, "two.log", 30)
    for name in ("one", "two"):
        run("map", f"{name}.log", "-o", name, "-q", "--no-pictures", *QUICK, cwd=folder)
        (folder / f"{name}.log").unlink()


def prepare_atlas(folder, run):
    short_log(folder, run)
    run("fleet", "plan", "drive.log", "-o", "atlas", "--shards", 1, "-q", *QUICK, cwd=folder)


def interrupt_reproduce(folder, start):
    """The report of no part: of a command that is interrupted while it makes its first."""
    process = start("reproduce", "-o", "report", "--only", "fig9", "-q", cwd=folder)
    while process.poll() is None and not (folder / "report/parts").is_dir():
        time.sleep(0.01)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    process.communicate()
    report = folder / "report"
    if process.returncode != 130 or any((report / "parts").iterdir()) or not (report / "report.html").is_file():
        sys.exit(f"reproduce: one that is interrupted ends with {process.returncode}, makes a part or no report")
    shutil.rmtree(report / "work", ignore_errors=True)


def prepare_old_picture(folder, run):
    prepare_run(folder, run)
    (folder / "out.png").write_bytes(b"old")


SMALL = ("--size", "96x64", "-q")
CASES = {case.name: case for case in (
    Case("map", prepare_map, ("map", "drive.log", "-o", "out", "-q", *QUICK)),
    Case("packed", prepare_packed, ("map", "drive.log.gz", "drive.log.bz2", "drive.log.xz", "lz4.bag", "bz2.bag", "lz4.mcap",
                                    "zstd.mcap", "drive.db3", "-o", "out", "-q", "--no-pictures", "--no-map", "--no-loops", *QUICK)),
    Case("map3d", prepare_3d, ("map", "drive.log", "-o", "out", "-q", "--first", 30, "--no-pictures")),
    Case("over", prepare_over, ("map", "drive.log", "-o", "out", "-q", *QUICK)),
    Case("checkpoint", prepare_next, ("map", "--continue", "out", "next.log", "-q")),
    Case("still", prepare_old_picture, ("render", "run", "--view", "map", "-o", "out.png", *SMALL)),
    Case("frames", prepare_cloud, ("render", "run", "--view", "orbit", "--frames", 2, "-o", "frames/", *SMALL), True,
         stays=("frames",)),
    Case("film", prepare_cloud, ("render", "run", "--view", "orbit", "--frames", 2, "-o", "out.mp4", *SMALL)),
    Case("reproduce", lambda folder, run: None, ("reproduce", "-o", "report", "--only", "fig3", "-q"), True,
         stays=("report",), left_by_kill=("report/parts/fig3.making",), leave_unfinished=interrupt_reproduce),
    Case("simulate", lambda folder, run: (folder / "room.yaml").write_text(ROOM),
         ("simulate", "room.yaml", "-o", "drive.mcap", "--truth-hits", "-q"), True),
    Case("compare", prepare_map, ("compare", "drive.log", "--scans", 1, "--matchers", "simplex", "--starts-at", "none", "--picture",
                                  "out.svg", "-q")),
    Case("convert", prepare_map, ("convert", "drive.log", "-o", "drive.mcap", "-q")),
    Case("merge", prepare_runs, ("merge", "one", "two", "-o", "sites", "-q", "--no-pictures"), True, stays=("sites",)),
    Case("edit", prepare_run, ("edit", "run", "--origin", "1,1,90", "-o", "out", "-q")),
    Case("fleet", prepare_atlas, ("fleet", "run", "atlas", "--shard", 1, "-j", 1, "-q"), True, stays=("atlas", "tmp"),
         left_by_kill=("/gdtslam-fleet-", "atlas/staging"),
         varies=("/column 18",)),  # the bytes of the record, whose times have more digits or fewer
)}
