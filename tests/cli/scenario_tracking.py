"""A robot followed in a map that stays as it is: `localize --track` against the simulator, by arithmetic of this file."""

import csv
import json
import math

import cli_support as cli
from cli_support import LOG, RUN, command, expect, expect_exit, fresh_folder
from scenario_localize import POSES, poses_of, turned, without_times

COLUMNS = ("scan,stamp_s,whereabouts,ambiguous,x_m,y_m,theta_rad,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2,explained,"
           "mean_distance_m").split(",")


def tracked(folder, *arguments, run=RUN, log=LOG):
    """The JSON report, checked against its table, and the rows of the table."""
    process = command("localize", run, log, "--track", "--table", folder / "track.csv", "--force", "--json", *arguments)
    expect_exit(process, 0)
    cli.validate(process.stdout, "localize_track")
    with open(folder / "track.csv", newline="", encoding="ascii") as file:
        table = csv.DictReader(file)
        rows = list(table)
    expect(table.fieldnames == COLUMNS, f"{table.fieldnames}")
    return json.loads(process.stdout), rows


def track_follows_the_simulated_drive():
    """The start is found by itself, every scan is followed from there to where the map's own run has it, and the figures
    are those of the table."""
    folder = fresh_folder("track")
    report, rows = tracked(folder, "-o", folder / "track.tum", "--picture", folder / "track.svg")
    poses = poses_of(POSES)
    expect(len(rows) == len(poses) == report["scans"], f"{len(rows)} rows, {len(poses)} poses, {report['scans']}")
    right = 0
    for row, (stamp, x, y, theta) in zip(rows, poses, strict=True):
        expect(abs(float(row["stamp_s"]) - stamp) < 1e-6 and row["whereabouts"] != "unknown", f"{row}")
        expect(float(row["xx_m2"]) > 0 and float(row["yy_m2"]) > 0 and float(row["tt_rad2"]) > 0, f"no covariance: {row}")
        off_m = math.hypot(float(row["x_m"]) - x, float(row["y_m"]) - y)
        right += off_m <= 0.1 and turned(float(row["theta_rad"]), theta) <= math.radians(1.0)
    counts = {name: sum(row["whereabouts"] == name for row in rows) for name in ("unknown", "found", "tracked", "predicted")}
    expect(counts == report["whereabouts"] and counts["tracked"] > 0.85 * len(rows), f"{counts}, {report['whereabouts']}")
    expect(report["ambiguous"] == sum(row["ambiguous"] == "1" for row in rows), f"{report['ambiguous']}")
    expect(right >= 0.97 * len(rows), f"{right} of {len(rows)} are right")
    process = command("evaluate", folder / "track.csv", "--reference", RUN, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "evaluate_poses")
    judgement = json.loads(process.stdout)
    expect(abs(judgement["within"]["count"] - right) <= 1 and judgement["within"]["of"] == len(rows), f"{judgement['within']}")
    expect(judgement["stated"]["pose"]["count"] == judgement["within"]["count"], f"{judgement['stated']}")
    for row, (stamp, x, y, theta) in zip(rows, poses_of(folder / "track.tum"), strict=True):
        expect(abs(float(row["stamp_s"]) - stamp) < 1e-6 and abs(float(row["x_m"]) - x) < 1e-5, f"{row}, {x}")
        expect(abs(float(row["y_m"]) - y) < 1e-5 and turned(float(row["theta_rad"]), theta) < 1e-6, f"{row}, {y}, {theta}")
    again, _ = tracked(folder, "--threads", 3)
    expect(without_times(again) == without_times(report), "another number of threads, another drive")
