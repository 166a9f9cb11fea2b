"""A robot followed in a map that stays as it is: `localize --track` against the simulator, by arithmetic of this file."""

import csv
import json
import math

import cli_support as cli
from cli_support import LOG, RUN, command, expect, expect_exit, fresh_folder, one_error_line
from scenario_localize import POSES, poses_of, turned, without_times

COLUMNS = ("scan,stamp_s,whereabouts,ambiguous,x_m,y_m,theta_rad,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2,explained,"
           "mean_distance_m,reference_x_m,reference_y_m,reference_theta_rad,known_share").split(",")


def tracked(folder, *arguments, run=RUN, log=LOG):
    """The JSON report, checked against its table, and the rows of the table."""
    process = command("localize", run, log, "--track", "--table", folder / "track.csv", "--json", *arguments)
    expect_exit(process, 0)
    cli.validate(process.stdout, "localize_track")
    with open(folder / "track.csv", newline="", encoding="ascii") as file:
        table = csv.DictReader(file)
        rows = list(table)
    expect(table.fieldnames == COLUMNS, f"{table.fieldnames}")
    return json.loads(process.stdout), rows


def off(row):
    """Metres and radians from the reference."""
    return (math.hypot(float(row["x_m"]) - float(row["reference_x_m"]), float(row["y_m"]) - float(row["reference_y_m"])),
            turned(float(row["theta_rad"]), float(row["reference_theta_rad"])))


def is_within(row):
    return row["whereabouts"] != "unknown" and off(row)[0] <= 0.1 and off(row)[1] <= math.radians(1.0)


def squared_sigmas(row):
    """The error in standard deviations of the row's covariance, by Cramer's rule."""
    v = [float(row["x_m"]) - float(row["reference_x_m"]), float(row["y_m"]) - float(row["reference_y_m"]),
         (float(row["theta_rad"]) - float(row["reference_theta_rad"]) + math.pi) % (2.0 * math.pi) - math.pi]
    xx, xy, xt, yy, yt, tt = (float(row[name]) for name in COLUMNS[7:13])
    m = [[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]]

    def det(a):
        return (a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
                + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]))

    whole = det(m)
    expect(xx > 0 and yy > 0 and tt > 0 and whole > 0, f"no covariance: {row}")
    solved = [det([[v[i] if j == k else m[i][j] for j in range(3)] for i in range(3)]) / whole for k in range(3)]
    return sum(a * b for a, b in zip(v, solved, strict=True))


def track_follows_the_simulated_drive():
    """The start is found by itself, every scan is followed from there to where the map's own run has it, and the figures
    are those of the table."""
    folder = fresh_folder("track")
    report, rows = tracked(folder, "--reference", POSES, "-o", folder / "track.tum")
    poses = poses_of(POSES)
    expect(len(rows) == len(poses) == report["scans"], f"{len(rows)} rows, {len(poses)} poses, {report['scans']}")
    for row, (stamp, x, y, theta) in zip(rows, poses, strict=True):
        expect(abs(float(row["stamp_s"]) - stamp) < 1e-6, f"{row}")
        expect(abs(float(row["reference_x_m"]) - x) < 1e-5 and abs(float(row["reference_y_m"]) - y) < 1e-5, f"{row}, {x}, {y}")
        expect(turned(float(row["reference_theta_rad"]), theta) < 1e-6, f"{row}, {theta}")
    counts = {name: sum(row["whereabouts"] == name for row in rows) for name in ("unknown", "found", "tracked", "predicted")}
    expect(counts == report["whereabouts"], f"{counts}, {report['whereabouts']}")
    expect(counts["unknown"] == 0 and counts["tracked"] > 0.85 * len(rows), f"{counts}")
    expect(report["ambiguous"] == sum(row["ambiguous"] == "1" for row in rows), f"{report['ambiguous']}")
    least = 1.0 - report["good_fit"]["distance_m"] / report["field"]["truncation_m"]
    mapped = [row for row in rows if float(row["known_share"]) >= least]
    within = report["errors"]["within"]
    expect(within["of"] == len(mapped) and within["count"] == sum(is_within(row) for row in mapped), f"{within}")
    expect(within["share"] >= 0.98, f"{report['errors']}")
    right = [squared_sigmas(row) for row in mapped if is_within(row) and row["whereabouts"] != "predicted"]
    stated = report["errors"]["squared_sigmas"]
    expect(stated["count"] == len(right) and abs(stated["mean"] - sum(right) / len(right)) < 0.05 * stated["mean"], f"{stated}")
    known = [row for row in rows if row["whereabouts"] != "unknown"]
    for row, (stamp, x, y, theta) in zip(known, poses_of(folder / "track.tum"), strict=True):
        expect(abs(float(row["stamp_s"]) - stamp) < 1e-6 and abs(float(row["x_m"]) - x) < 1e-5, f"{row}, {x}")
        expect(abs(float(row["y_m"]) - y) < 1e-5 and turned(float(row["theta_rad"]), theta) < 1e-6, f"{row}, {y}, {theta}")
    again, _ = tracked(folder, "--reference", POSES, "--threads", 3)
    expect(without_times(again) == without_times(report), "another number of threads, another drive")


def track_refuses_what_does_not_go_together():
    """Options of single scans, a log of another place, a reference of another log."""
    folder = fresh_folder("track_refused")
    for words, code, arguments in (("--every excludes --track", 2, ("--every", 5)), ("--random excludes --track", 2, ("--random", 5)),
                                   ("--no-runner-up excludes --track", 2, ("--no-runner-up",)),
                                   ("has no scan 99999", 65, ("--scan", 99999)),
                                   ("none of its 3 poses has the stamp of a scan that was followed", 65, ("--reference", cli.DATA / "far.tum"))):
        process = command("localize", RUN, LOG, "--track", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
    process = command("localize", RUN, LOG, "--table", folder / "t.csv")
    expect_exit(process, 2)
    expect("--table requires --track" in process.stderr, process.stderr)
    process = command("localize", RUN, cli.DATA / "no_return.log", "--track", "-q")
    expect_exit(process, 65)
    expect("the robot was found at none of its scans" in process.stderr, process.stderr)
