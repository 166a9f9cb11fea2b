"""Drives through one site joined by `merge`, compared with the truth."""

import itertools
import json
import math
import random
import time

from experiment.common import print_table, print_row, stamped_poses
from long_drives import WORLDS, between, errors_of, run

WRONG_M = 0.5
WRONG_RAD = math.radians(5.0)
NEAR_M = 2.0
OVERLAP_M = 10.0


def walk(world, rng, length_m):
    """Corners from any corner on, as World.drive() goes."""
    here, last, driven = rng.randrange(len(world.corners)), None, 0.0
    path = [here]
    while driven < length_m:
        onward = [corner for corner in world.ways[here] if corner != last] or world.ways[here]
        last, here = here, rng.choice(onward)
        driven += math.dist(world.corners[last], world.corners[here])
        path.append(here)
    return [world.corners[corner] for corner in path]


class Session:
    def __init__(self, folder, log):
        self.folder = folder
        self.poses = dict(stamped_poses(folder / "trajectory.tum"))
        self.truth = dict(stamped_poses(log.with_suffix(".truth.tum")))


def make_session(program, folder, name, seed, number, metres):
    rng = random.Random(f"{name} {seed} session {number}")
    world = WORLDS[name](random.Random(f"{name} {seed}"))
    scene, log, out = folder / f"{number}.yaml", folder / f"{number}.log", folder / f"run-{number}"
    scene.write_text(world.scene(f"{name}-{number}", walk(world, rng, metres)))
    run(program, "simulate", scene, "-o", log, "--force", "--seed", 1000 * seed + number, "--quiet")
    run(program, "map", log, "-o", out, "--force", "--no-pictures", "--no-map", "--quiet")
    return Session(out, log)


def do_overlap(a, b):
    """Metres of a's true path near b's."""
    cells = {}
    for pose in b.truth.values():
        cells.setdefault((int(pose[0] // NEAR_M), int(pose[1] // NEAR_M)), []).append(pose)

    def is_near(pose):
        x, y = int(pose[0] // NEAR_M), int(pose[1] // NEAR_M)
        return any(math.dist(pose[:2], other[:2]) < NEAR_M for i in (x - 1, x, x + 1) for j in (y - 1, y, y + 1)
                   for other in cells.get((i, j), []))

    path, near_m = list(a.truth.values()), 0.0
    for before, pose in zip(path, path[1:]):
        if is_near(pose):
            near_m += math.dist(before[:2], pose[:2])
    return near_m >= OVERLAP_M


def is_wrong_fix(fix, reference, query):
    """Whether it says otherwise than the truth where the query's robot was, seen from the nearest scan of the other."""
    stamp = min(reference.poses, key=lambda s: math.dist(reference.poses[s][:2], fix["pose"][:2]))
    found = between(reference.poses[stamp], fix["pose"])
    true = between(reference.truth[stamp], query.truth[fix["stamp_s"]])
    off = between(true, found)
    return math.hypot(off[0], off[1]) > WRONG_M or abs(off[2]) > WRONG_RAD


def merge_figures(sessions, merged):
    report = json.loads((merged / "merge.json").read_text())
    by_folder = {str(session.folder): session for session in sessions}
    site_of = {entry["run"]: site["folder"] for site in report["sites"] for entry in site["runs"]}
    found = {"edges": 0, "wrong": 0, "overlap": 0, "joined": 0, "sites": len(report["sites"]), "ate": 0.0}
    for edge in report["edges"]:
        found["edges"] += 1
        found["wrong"] += any(is_wrong_fix(fix, by_folder[edge["in"]], by_folder[edge["run"]]) for fix in edge["fixes"])
    for a, b in itertools.combinations(sessions, 2):
        if do_overlap(a, b) or do_overlap(b, a):
            found["overlap"] += 1
            found["joined"] += site_of[str(a.folder)] == site_of[str(b.folder)]
    for site in report["sites"]:
        poses, truth = [], []
        for entry in site["runs"]:
            path = dict(stamped_poses(merged / entry["trajectory"]))
            session = by_folder[entry["run"]]
            poses += [path[stamp] for stamp in path if stamp in session.truth]
            truth += [session.truth[stamp] for stamp in path if stamp in session.truth]
        found["ate"] = max(found["ate"], sum(errors_of(poses, truth)) / len(poses))
    return found


def sessions(chosen):
    """--sessions drives from corners of a world of long_drives.py, each through a part of it, are mapped and merged. An edge is
    wrong where one of its fixes lies more than 0.5 m or 5 degrees from where the truth has it. Two drives overlap where 10 m of
    one come within 2 m of the other; they are joined where they end in one site."""
    wrong = 0
    print_table("world", "seed", "edges, wrong", "pairs that overlap, in one site", "sites", "ATE mean of the worst site", "merge")
    for name in chosen.worlds.split(","):
        for seed in range(1, chosen.seeds + 1):
            folder = chosen.folder / f"{name}-{seed}"
            folder.mkdir(parents=True, exist_ok=True)
            drives = [make_session(chosen.program, folder, name, seed, number, chosen.metres) for number in range(1, chosen.sessions + 1)]
            began_s = time.monotonic()
            run(chosen.program, "merge", *(drive.folder for drive in drives), "-o", folder / "site", "--force", "--no-map", "--quiet")
            f = merge_figures(drives, folder / "site")
            wrong += f["wrong"]
            print_row(name, seed, f"{f['edges']}, {f['wrong']}", f"{f['overlap']}, {f['joined']}", f["sites"], f"{f['ate']:.3f} m",
                      f"{time.monotonic() - began_s:.0f} s")
    return wrong == 0
