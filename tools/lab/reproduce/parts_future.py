"""What the paper leaves to future work: comparison with 6D SLAM and 3D NDT, on clouds of stops and on drives over ramps."""

import gzip
import math
import resource

import matplotlib
import numpy as np

from part import Part, length_text
from parts_3d import CLOUD, read_ply, surface_errors

# Methods of register, and their options: in the plane as the paper's poses, points and planes in space, NDT in space, and the default.
METHODS = {"planar": ("--dof", "3", "--method", "plane"), "icp6": ("--method", "plane"), "ndt6": ("--method", "ndt"), "default": ()}
NAMES = {"planar": "in the plane", "icp6": "points to planes, 6D", "ndt6": "NDT, 6D", "default": "NDT, then planes, 6D"}
METHOD_COLOURS = {"planar": "#5d646d", "icp6": "#0069a8", "ndt6": "#c2410c", "default": "#00694e"}
MOST_PAIRS = 10
# Drives: scene, options of simulate.
MOVING = (("two-levels", "ramp of 3°, sills, sway", ("--sway", "0.4deg,1cm")), ("office-7f", "flat, no sway", ()))


def rotation(quaternions):
    """Rotation matrices of quaternions x, y, z, w."""
    x, y, z, w = np.asarray(quaternions).T
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)


def read_poses(path):
    """Stamps, positions and rotations of a TUM file."""
    table = np.loadtxt(path, ndmin=2)
    return table[:, 0], table[:, 1:4], rotation(table[:, 4:8])


def find_stops(positions):
    """First and last scan of each time that the robot stood still for two seconds or more."""
    moves = np.flatnonzero(np.linalg.norm(np.diff(positions, axis=0), axis=1) > 1e-6) + 1
    begins, ends = np.r_[0, moves], np.r_[moves, len(positions)]
    return [(first, last - 1) for first, last in zip(begins, ends) if last - first >= 80]


def write_points(path, points):
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
                   "property float z\nend_header\n".encode())
        file.write(np.asarray(points, "<f4").tobytes())


def write_stops(shop, run, truth):
    """Writes the points of each stop in the robot's frame, one of each cube of 3 cm; returns files, planar and true poses."""
    _, positions, turns = read_poses(shop.path(run) / "trajectory.tum")
    _, true_positions, true_turns = read_poses(shop.path(truth))
    cloud = read_ply(shop.path(run) / "cloud.ply", CLOUD)
    stops = []
    for number, (first, last) in enumerate(find_stops(true_positions)):
        seen = cloud[(cloud["scan"] >= first) & (cloud["scan"] <= last)]
        points = (np.column_stack([seen["x"], seen["y"], seen["z"]]) - positions[first]) @ turns[first]
        _, kept = np.unique(np.floor(points / 0.03).astype(int), axis=0, return_index=True)
        if len(kept) < 5000:
            continue
        write_points(shop.path(f"stop{number}.ply"), points[np.sort(kept)])
        stops.append((f"stop{number}.ply", (positions[first], turns[first]), (true_positions[first], true_turns[first])))
    return stops


def relative(a, b):
    """Pose b in a, each a position and a rotation."""
    return a[1].T @ (b[0] - a[0]), a[1].T @ b[1]


def start_text(pose):
    """A planar pose as --start takes it."""
    return f"{pose[0][0]:.6f}m,{pose[0][1]:.6f}m,0m,0deg,0deg,{math.degrees(math.atan2(pose[1][1, 0], pose[1][0, 0])):.6f}deg"


def register(shop, fixed, moved, method, start=None):
    """What register finds, with its CPU time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = shop.json("gdtslam", "register", fixed, moved, *METHODS[method], *(() if start is None else ("--start", start)))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    found["cpu_s"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return found


def errors_of(found, truth):
    """Metres and degrees off the truth."""
    turn = rotation([found["quaternion_xyzw"]])[0].T @ truth[1]
    return (float(np.linalg.norm(np.array(found["position_m"]) - truth[0])),
            math.degrees(math.acos(min(1.0, max(-1.0, (np.trace(turn) - 1.0) / 2.0)))))


def draw_errors(shop, part, errors):
    figure, axes = matplotlib.pyplot.subplots(1, 2, figsize=(11, 3.8), layout="constrained")
    for place, axis in enumerate(axes):
        for row, method in enumerate(METHODS):
            values = [pair[place] * (1000.0 if place == 0 else 1.0) for pair in errors[method]]
            axis.plot(values, [row] * len(values), "o", color=METHOD_COLOURS[method], alpha=0.6)
            axis.plot([np.median(values)] * 2, [row - 0.3, row + 0.3], color=METHOD_COLOURS[method], linewidth=3)
        axis.set_xscale("log")
        axis.xaxis.set_major_formatter("{x:g}")
        axis.set_yticks(range(len(METHODS)), [NAMES[method] for method in METHODS] if place == 0 else [""] * len(METHODS))
        axis.invert_yaxis()
        axis.set_xlabel("position off the truth, mm" if place == 0 else "rotation off the truth, °")
        axis.grid(axis="x", color="#dddddd")
    shop.draw(part, figure, "stops.svg", "Pairs of stops of a swaying robot: each dot a pair, bars the medians.")


def compare_stops(shop, part):
    shop.run("gdtslam", "simulate", "office-3f", "--nod", "stop-and-scan", "--sway", "0.4deg,1cm", "-o", "stops.log", "-q")
    shop.map("stops.log", "stops", "--no-map", "--set", "cloud.voxel=0")
    stops = write_stops(shop, "stops", "stops.truth.tum")
    pairs = list(zip(stops, stops[1:]))[:: max(1, (len(stops) - 1) // MOST_PAIRS)][:MOST_PAIRS]
    errors, times = {method: [] for method in METHODS}, {method: [] for method in METHODS}
    for (fixed, planar_a, true_a), (moved, planar_b, true_b) in pairs:
        truth, start = relative(true_a, true_b), start_text(relative(planar_a, planar_b))
        for method in METHODS:
            found = register(shop, fixed, moved, method, start)
            errors[method].append(errors_of(found, truth))
            times[method].append(found["cpu_s"])
    medians = {method: np.median(np.array(errors[method]), axis=0) for method in METHODS}
    part.table(f"{len(pairs)} pairs of stops of a robot that sways by 0.4° and 1 cm: medians", ["method", "position", "rotation", "CPU time"],
               [[NAMES[method], length_text(medians[method][0]), f"{medians[method][1]:.3f}°", f"{np.median(times[method]):.1f} s"]
                for method in METHODS])
    draw_errors(shop, part, errors)
    part.claim("poses of stops: 6D against planar", "announced", f"{length_text(medians['default'][0])} against {length_text(medians['planar'][0])}",
               medians["default"][0] < 0.2 * medians["planar"][0], "median of the pairs; rule: at most a fifth")


def space_errors(estimate, truth):
    """Root mean square distance of positions after the best rigid alignment in space [Umeyama1991]."""
    stamps, positions, _ = read_poses(estimate)
    true_stamps, true_positions, _ = read_poses(truth)
    matched = true_positions[np.abs(true_stamps[:, None] - stamps[None, ::10]).argmin(axis=0)]
    positions = positions[::10]
    a, b = positions - positions.mean(axis=0), matched - matched.mean(axis=0)
    left, _, right = np.linalg.svd(a.T @ b)
    turn = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    return math.sqrt(np.mean(np.sum((a @ turn - b) ** 2, axis=1)))


def compare_moving(shop, part):
    rows = []
    for scene, what, options in MOVING:
        log = f"future-{scene}"
        shop.run("gdtslam", "simulate", scene, *options, "-o", f"{log}.log", "-q")
        found = []
        for dof in ("3", "6"):
            run = f"{log}-{dof}"
            shop.map(f"{log}.log", run, "--no-map", "--dof", dof)
            distances = shop.json("gdtslam", "evaluate", f"{run}/cloud.ply", "--scene", scene, "--trajectory", f"{run}/trajectory.tum",
                                  "--reference", f"{log}.truth.tum")["distance_m"]
            found.append((distances["mean"], space_errors(shop.path(run) / "trajectory.tum", shop.path(f"{log}.truth.tum"))))
            rows.append([f"{scene}: {what}", dof, length_text(distances["mean"]), length_text(distances["p90"]), length_text(found[-1][1])])
        flat = not options
        part.claim(f"{scene}, poses in space", "announced", f"{length_text(found[1][0])} against {length_text(found[0][0])}",
                   found[1][0] <= (1.02 if flat else 0.5) * found[0][0],
                   f"mean distance of the points to the true surfaces; rule: {'at most 2 % more on a flat floor' if flat else 'at most half'}")
    part.table("Drives, planar and in space", ["drive", "numbers of a pose", "points off the surfaces, mean", "90 %", "positions off the truth, rms"],
               rows)


def real_pairs(folder):
    """Clouds of the pairs of ETH Zurich's apartment (VTK) and of 3DTK (centimetres, left-handed)."""
    pairs = {}
    eth = [folder / f"cloud_{k}.vtk.gz" for k in (0, 1)]
    if all(file.is_file() for file in eth):
        pairs["ETH apartment"] = []
        for file in eth:
            words = gzip.open(file, "rt").read().split()
            place = words.index("POINTS")
            pairs["ETH apartment"].append(np.array(words[place + 3:place + 3 + 3 * int(words[place + 1])], float).reshape(-1, 3))
    tilting = [folder / f"scan00{k}.3d.gz" for k in (0, 1)]
    if all(file.is_file() for file in tilting):
        pairs["3DTK, scans 0 and 1"] = []
        for file in tilting:
            rows = np.loadtxt(file, skiprows=1, usecols=(0, 1, 2)) / 100.0
            ranges = np.linalg.norm(rows, axis=1)
            rows = rows[(ranges > 0.5) & (ranges < 32.0)]
            pairs["3DTK, scans 0 and 1"].append(np.column_stack([rows[:, 2], -rows[:, 0], rows[:, 1]]))
    return pairs


def compare_real(shop, part):
    if shop.data is None:
        return
    rows = []
    for name, clouds in real_pairs(shop.data / "tilt3d").items():
        part.origin = "simulated and real"
        for k, points in enumerate(clouds):
            write_points(shop.path(f"real{k}.ply"), points)
        for method in METHODS:
            found = register(shop, "real0.ply", "real1.ply", method)
            rows.append([name, NAMES[method], f"{100.0 * found['end']['overlap']:.0f} %", length_text(found["end"]["median_m"]), found["verdict"],
                         f"{found['cpu_s']:.1f} s"])
    if rows:
        part.table("Real pairs, from no start: distance to the planes of the other cloud", ["pair", "method", "overlap", "median", "verdict", "CPU time"],
                   rows)


def make_future(shop):
    part = Part("Stops of a swaying robot in the scene office-3f, and drives through two-levels and office-7f, seed 1.")
    compare_stops(shop, part)
    compare_moving(shop, part)
    compare_real(shop, part)
    part.notes.append("The paper names the comparison with 6D SLAM, registration and compression by 3D NDT as future work; it has no numbers.")
    return part
