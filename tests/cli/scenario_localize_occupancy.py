"""Scans found in an occupancy map, as ROS map_server reads it, whose distances nobody wrote."""

import json
import math
import shutil

from cli_support import LOG, RUN, command, expect, expect_exit, fresh_folder, one_error_line
from scenario_localize import POSES, localized, poses_of, turned


def localize_in_an_occupancy_map():
    """The run's own map.yaml: scans lie where its distances have them; moved by a part of a cell and far away, the poses
    move along; without walls or with a yaw it is refused in one line."""
    folder = fresh_folder("localize_occupancy")
    shutil.copy(RUN / "map.pgm", folder)
    stated = (RUN / "map.yaml").read_text()
    origin = next(line for line in stated.splitlines() if line.startswith("origin"))
    x, y, _ = json.loads(origin[len("origin:"):])
    dx, dy = 0.0101, -5400000.0037
    (folder / "moved.yaml").write_text(stated.replace(origin, f"origin: [{x + dx!r}, {y + dy!r}, 0.0]"))
    chosen = ("--every", 60, "--picture", folder / "found.svg", "--force")
    plain = localized(*chosen, run=RUN / "map.yaml")
    expect(plain["field"] == {"from": "occupied-cells", "resolution_m": 0.025, "truncation_m": 0.5}, f"{plain['field']}")
    expect(plain["good_fit"] == {"distance_m": 0.05, "usual_m": 0.025, "from": "resolution"}, f"{plain['good_fit']}")
    poses = poses_of(POSES)
    found = [scan for scan in plain["scans"] if scan["verdict"] == "found"]
    expect(len(found) >= 0.8 * len(plain["scans"]), f"{plain['verdicts']}")
    for scan in found:
        _, px, py, theta = poses[scan["scan"]]
        best = scan["best"]
        expect(math.hypot(best["x_m"] - px, best["y_m"] - py) < 0.1 and turned(best["theta_rad"], theta) < math.radians(1.5), f"{scan}")
    moved = localized(*chosen, run=folder / "moved.yaml")
    for one, other in zip(plain["scans"], moved["scans"], strict=True):
        expect(one["verdict"] == other["verdict"], f"{one}, {other}")
        expect(abs(one["best"]["x_m"] + dx - other["best"]["x_m"]) < 1e-6 and abs(one["best"]["y_m"] + dy - other["best"]["y_m"]) < 1e-6, f"{one}, {other}")
    for name, change, words in (("turned", (origin, "origin: [0.0, 0.0, 0.5]"), "origin: a map that is turned (yaw other than 0) cannot be read; turn its picture"),
                                ("bare", ("occupied_thresh: 0.65", "occupied_thresh: 1.0"), "the map has no occupied cell"),
                                ("coarse", ("resolution: 0.025", "resolution: 25.0"), "a resolution of 25 m is not between 0.001 and 1 m")):
        (folder / f"{name}.yaml").write_text(stated.replace(*change))
        process = command("localize", folder / f"{name}.yaml", LOG)
        expect_exit(process, 65)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
