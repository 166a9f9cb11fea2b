"""The whole chain of a nodding laser, from a simulated log with its truth to the cloud and its errors."""

import json
import os

import cli_support as cli
from cli_support import command, digests, expect, expect_exit, mapped, one_error_line, require_vulkan

# Along the corridor of office-7f past an open door, with a turn and a stop: 40 s, eight strokes of the mount.
DRIVE = """gdtslam_trajectory: 1
waypoints:
  - {at: [1.8, 8.0], pause: 2 s}
  - [7.0, 8.0]
  - {at: [9.5, 8.3], pause: 3 s}
"""


def simulated(folder, scene, *arguments, name="drive"):
    """A log with its truth; returns its path."""
    log = folder / f"{name}.log"
    expect_exit(command("simulate", scene, "-o", log, *arguments), 0)
    return log


def moving_log(folder):
    (folder / "drive.yaml").write_text(DRIVE)
    return simulated(folder, "office-7f", "--trajectory", folder / "drive.yaml")


def errors_of(run, log, *arguments):
    """What evaluate says about the cloud of a run, as JSON."""
    process = command("evaluate", run / "cloud.ply", "--trajectory", run / "trajectory.tum", "--reference",
                      log.with_suffix(".truth.tum"), *arguments, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "evaluate_cloud")
    return json.loads(process.stdout)


def nodding_wrong_linkage():
    """A linkage that is not the log's is told by its sweeps, which do not agree; the log's own is not doubted."""
    folder = cli.fresh_folder("nodding_wrong_linkage")
    log = simulated(folder, "three-boxes", "--linkage", "paper-b-calibrated", "--rate", 8)
    doubt = "sweeps that do not agree"
    for linkage, expected in ((log.with_suffix(".linkage.yaml"), {}), ("paper-b", {doubt: 1}), ("paper-a", {doubt: 1})):
        process = command("map", log, "-o", folder / "run", "--force", "--json", "--no-pictures", "--linkage", linkage)
        expect_exit(process, 0)
        expect(json.loads(process.stdout)["warnings"] == expected, f"{linkage}: {process.stderr}")
        expect((f"warning: {doubt} (" in process.stderr) == bool(expected), f"{linkage}: {process.stderr}")


def hits_wait_where_temporary_files_are():
    """In TMPDIR, and where that takes none: one line, and no log that was half made."""
    folder = cli.fresh_folder("hits_wait")
    process = command("simulate", "wall", "--rate", 1, "--truth-hits", "-o", folder / "drive.log", "-q", env={**os.environ, "TMPDIR": str(folder / "none")})
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect(str(folder / "none") in process.stderr, process.stderr)
    expect(not list(folder.iterdir()), f"left {list(folder.iterdir())}")
    (folder / "temporary").mkdir()
    expect_exit(command("simulate", "wall", "--rate", 1, "--truth-hits", "-o", folder / "drive.log", "-q",
                        env={**os.environ, "TMPDIR": str(folder / "temporary")}), 0)
    header, rows = (folder / "drive.truth.ply").read_bytes().split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split(b"\n")[0])
    expect(count > 1000 and len(rows) == 60 * count, f"{count} rows in {len(rows)} bytes")  # six doubles and three words
    expect(not list((folder / "temporary").iterdir()), "temporary files are left")


def cloud_of_a_standing_scanner():
    """Without noise and rounding every point is within 1 mm of its true hit; with 20,000 ticks a turn and millimetres it is
    within the bound that the tool computes for them."""
    folder = cli.fresh_folder("standing_cloud")
    rate = ("--rate", 8, "--truth-hits")
    exact = simulated(folder, "three-boxes", "--exact", *rate, name="exact")
    report = mapped(folder / "exact", "--set", "cloud.voxel=0", log=exact)
    errors = errors_of(folder / "exact", exact, "--hits", folder / "exact.truth.ply")
    process = command("evaluate", folder / "exact", "--reference", exact.with_suffix(".truth.tum"), "--hits",
                      folder / "exact.truth.ply", "--json")
    expect(process.returncode == 0 and json.loads(process.stdout) == errors, f"the run in place of its files: {process}")
    distances = errors["distance_m"]
    expect(errors["hits"] == report["cloud_points"] == distances["count"] > 300_000, f"points and hits: {errors}")
    expect(errors["without_hit"] == 0 and distances["max"] < 1e-3, f"points further than 1 mm from their hits: {errors}")

    coarse = simulated(folder, "three-boxes", "--noise", "0 m", "--resolution", "1 mm", "--ticks", 20000, *rate, name="coarse")
    mapped(folder / "coarse", "--set", "cloud.voxel=0", log=coarse)
    errors = errors_of(folder / "coarse", coarse, "--hits", folder / "coarse.truth.ply",
                       "--linkage", folder / "coarse.linkage.yaml", "--resolution", "1 mm")
    bound = errors["quantisation_bound"]
    expect(bound["beyond"] == 0 and 0.1 < bound["largest_share"] <= 1.0, f"the bound does not hold: {errors}")
    # A tick moves a point at 5 m by 4 mm, a step of the range by 1 mm.
    expect(0.002 < bound["largest_m"] < 0.008, f"the bound: {bound}")
    expect(errors["distance_m"]["max"] > distances["max"], "rounding makes no difference")


def cloud_of_a_thinned_log():
    """The beams of a thinned cloud are found by scan and time; the wrong log is noticed."""
    folder = cli.fresh_folder("thinned_cloud")
    log = simulated(folder, "three-boxes", "--exact", "--rate", 4, "--truth-hits")
    report = mapped(folder / "run", "--set", "cloud.voxel=2 cm", log=log)
    errors = errors_of(folder / "run", log, "--hits", folder / "drive.truth.ply")
    expect(errors["without_hit"] == 0 and errors["distance_m"]["count"] == report["cloud_points"] < errors["hits"] / 2,
           f"the beams of the points: {errors}")
    expect(errors["distance_m"]["max"] < 1e-3, f"{errors}")
    text = (folder / "drive.truth.ply").read_bytes()
    (folder / "cut.ply").write_bytes(text[:-30])
    process = command("evaluate", folder / "run/cloud.ply", "--hits", folder / "cut.ply")
    expect_exit(process, 65)
    cli.one_error_line(process.stderr)
    expect("cut.ply: has " in process.stderr, process.stderr)


def cloud_of_a_moving_scanner():
    """The whole pipeline from ticks and ranges: points and poses within 3 cm in the mean. The paper's interpolations, which do not
    ask the wheels, are worse where the robot speeds up and turns; (14) as printed is worse from the same poses."""
    folder = cli.fresh_folder("moving_cloud")
    log = moving_log(folder)
    means = {}
    for how in ("odometry", "linear", "geodesic", "literal"):
        options = ("--set", "nod.form=literal") if how == "literal" else ("--set", f"nod.interpolation={how}")
        mapped(folder / how, *options, log=log)
        errors = errors_of(folder / how, log, "--scene", "office-7f", "--csv", folder / f"{how}.csv")
        means[how] = errors["distance_m"]["mean"], errors["alignment"]["ate_mean_m"]
        rows = [row.split(",") for row in (folder / f"{how}.csv").read_text().splitlines()]
        expect(rows[0] == ["from_m", "to_m", "points", "share"] and len(rows) == 1002, f"{how}: the histogram's form")
        expect(sum(int(row[2]) for row in rows[1:]) == errors["distance_m"]["count"], f"{how}: the histogram's points")
    expect(max(means["odometry"]) <= 0.03, f"mean distance to the surfaces and ATE: {means}")
    for how in ("linear", "geodesic"):
        expect(means[how][0] > means["odometry"][0] and means[how][1] > means["odometry"][1], f"{how} is no worse: {means}")
    expect(means["literal"][0] > 1.5 * means["odometry"][0], f"(14) as printed makes no difference: {means}")
    expect(means["literal"][1] == means["odometry"][1], f"(14) moves the poses: {means}")
    print(means)


def poses_in_space():
    """Where the robot sways, map --dof 6 brings the points nearer to the surfaces, and its poses have height and tilt; threads change
    no byte; a log that does not tell how the laser nods is refused."""
    folder = cli.fresh_folder("poses_in_space")
    (folder / "drive.yaml").write_text(DRIVE)
    log = simulated(folder, "office-7f", "--trajectory", folder / "drive.yaml", "--sway", "0.8deg,2cm")
    means = {}
    for dof in ("3", "6"):
        report = mapped(folder / dof, "--dof", dof, "--no-map", "--no-pictures", log=log)
        cli.validate(json.dumps(report), "report")
        expect(("space" in report["nodding"]) == (dof == "6"), f"{report['nodding'].keys()}")
        means[dof] = errors_of(folder / dof, log, "--scene", "office-7f")["distance_m"]["mean"]
    expect(means["6"] < 0.7 * means["3"], f"mean distances: {means}")
    heights = [float(row.split()[3]) for row in (folder / "6/trajectory.tum").read_text().splitlines()]
    truth = [float(row.split()[3]) for row in log.with_suffix(".truth.tum").read_text().splitlines()]
    middle = [a - b for a, b in zip(heights, truth)]
    mean = sum(middle) / len(middle)
    rms = (sum((value - mean) ** 2 for value in middle) / len(middle)) ** 0.5
    expect(rms < 0.01, f"heights are {rms} m off the truth")  # they sway by 2 cm
    mapped(folder / "threads", "--dof", "6", "--no-map", "--no-pictures", "--threads", 3, log=log)
    files = [digests(folder / run) for run in ("6", "threads")]
    for file in ("cloud.ply", "trajectory.tum"):
        expect(files[0][file] == files[1][file], f"{file} depends on the threads")
    process = command("map", cli.LOG, "--dof", "6", "-o", folder / "flat")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("does not tell how the laser nods" in process.stderr and not (folder / "flat").exists(), process.stderr)


def cloud_results(report):
    return report["map_sha256"], report["trajectory_sha256"], report["nodding"]["cloud"]["sha256"]


def cloud_same_bytes():
    """Two runs, any number of threads and every instruction set give the same files."""
    folder = cli.fresh_folder("same_cloud")
    log = moving_log(folder)
    devices = json.loads(command("doctor", "--devices", "--json").stdout)
    variants = [v["name"] for v in devices["devices"][0]["isa"] if v["available"]]
    runs = {"first": (), "again": (), "threads": ("--threads", 3), **{isa: ("--isa", isa) for isa in variants}}
    results = {name: cloud_results(mapped(folder / name, *arguments, log=log)) for name, arguments in runs.items()}
    expect(len(set(results.values())) == 1, f"the results differ: {results}")
    files = {name: digests(folder / name)["cloud.ply"] for name in runs}
    expect(len(set(files.values())) == 1, f"the clouds differ: {files}")


def cloud_same_bytes_on_vulkan():
    """A Vulkan device gives the cloud of the CPU, byte for byte, with either matcher."""
    require_vulkan()
    folder = cli.fresh_folder("vulkan_cloud")
    log = moving_log(folder)
    for matcher in ("gauss-newton", "exhaustive"):
        runs = [mapped(folder / f"{matcher}_{device}", "--device", device, "--no-fallback", "--matcher", matcher, log=log, timeout=250)
                for device in ("cpu", "vulkan")]
        expect(runs[1]["device"]["kind"] != runs[0]["device"]["kind"], "both ran on the same kind of device")
        expect(cloud_results(runs[0]) == cloud_results(runs[1]), f"{matcher}: {[cloud_results(run) for run in runs]}")
        files = [digests(folder / f"{matcher}_{device}")["cloud.ply"] for device in ("cpu", "vulkan")]
        expect(files[0] == files[1], f"{matcher}: the clouds differ")
