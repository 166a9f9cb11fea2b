"""Figures 11 to 15 and A of the paper: the linkage, boxes, surroundings and floors in 3D, the calibration."""

import itertools
import math
import re

import numpy as np

from part import Part, length_text, moved

READINGS = ("paper-a", "paper-b", "paper-c")
# Widths, the paper's measurements and the heights in the scene, the widest first; centimetres.
BOXES = ((58.29, 57.5, 80.0), (34.35, 34.8, 70.0), (25.2, 24.8, 60.0))
# A placed average of 250 ranges of the paper's protocol; its own curve is read off figure A by eye.
DELTAS_CM = (0.4034, -0.1178, -0.3218, 0.2625, -0.09, 0.07, -0.1709)
CLOUD = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("elevation", "<f4"), ("time", "<f8"), ("scan", "<u4")])
HITS = np.dtype([(name, "<f8") for name in ("x", "y", "z", "elevation", "time", "range")] +
                [(name, "<u4") for name in ("scan", "beam", "triangle")])


def make_linkages(shop):
    part = Part("From the lengths that the paper’s appendix prints.", origin="computed")
    shop.render(part, "paper-b", "scene", "scene.png", "The mount as reading paper-b has it: four bars and the laser on the rocker.", "--size",
                "1600x900")
    rows = []
    for name in READINGS:
        nominal = shop.json("gdtslam", "linkage", name, "--picture", f"{name}.svg")
        shop.picture(part, f"{name}.svg", f"Reading {name}: positions over the lift with the dead points, elevation and transmission angle "
                                          "over one turn of the crank.")
        calibrated = shop.json("gdtslam", "linkage", name, "--calibrated")["crank_rocker"]
        turn = nominal["crank_rocker"]

        def both(*keys, unit="", digits=1):
            pair = []
            for value in (turn, calibrated):
                for key in keys:
                    value = value[key]
                pair.append(f"{value:.{digits}f}")
            return " / ".join(pair) + unit

        rows.append([name, ", ".join(f"{100.0 * nominal['bars_m'][bar]:.1f}" for bar in ("crank", "coupler", "rocker", "ground")) + " cm",
                     both("swing_deg", unit="°"), both("lift_begin", "elevation_deg", unit="°"), both("lift_end", "elevation_deg", unit="°"),
                     both("time_ratio", digits=2), both("least_transmission_deg", unit="°"), both("most_rocker_rate", digits=2)])
        if name == "paper-b":
            chosen = nominal
    part.table("The readings with the paper’s lengths, nominal / calibrated; elevations at the two dead points",
               ["reading", "crank, coupler, rocker, ground", "swing", "from", "to", "slow / quick stroke", "least transmission",
                "most rocker per crank"], rows)
    turn = chosen["crank_rocker"]
    part.claim("a link turns all the way (Grashof)", "s + l < p + q",
               f"{100.0 * chosen['shortest_and_longest_m']:.1f} < {100.0 * chosen['other_two_m']:.1f} cm", chosen["class"] == "crank-rocker",
               "reading paper-b, nominal lengths")
    part.claim("swing of the laser", "0° to 90°", f"{turn['swing_deg']:.1f}°", 85.0 <= turn["swing_deg"] <= 95.0,
               "rule: at most 5° from the paper’s 90°; reading paper-b")
    part.claim("lifts slowly, returns quickly", "yes", f"{turn['time_ratio']:.2f} times as long up as down", turn["time_ratio"] > 1.0,
               "reading paper-b")
    part.state("least transmission angle", "", f"{turn['least_transmission_deg']:.1f}°",
               "below 30° a joint transmits poorly: the paper’s lengths are mechanically weak")
    part.notes.append("Figure and appendix number the links differently: with the lengths of the appendix, (L3, L12, L5, L4) of the text is no "
                      "crank-rocker, whatever L12 means. Three readings are; paper-b fits what is said of the motion best and is the default, "
                      "though nothing establishes it.")
    return part


def add_size_row(part, quantity, paper, found, true_cm, paper_mm, rule):
    if found is None:
        return part.claim(quantity, paper, "not found", False, rule)
    off_mm = abs(1000.0 * found["value_m"] - 10.0 * true_cm)
    return part.claim(quantity, paper, f"{100.0 * found['value_m']:.2f} ± {100.0 * found['sigma_m']:.2f} cm", off_mm <= paper_mm,
                      f"off by {off_mm:.2f} mm; {rule}")


def add_box_rows(part, measured):
    """Adds the widths, and for boxes measured in 3D the heights: only heights depend on the linkage. Boxes are matched by the
    nearest width, which excludes pieces of wall beside them."""
    for true_cm, paper_cm, height_cm in BOXES:
        near = [box for box in measured["boxes"] if abs(100.0 * box["width"]["value_m"] - true_cm) <= 4.0]
        box = min(near, key=lambda box: abs(100.0 * box["width"]["value_m"] - true_cm), default={"width": None, "height": None})
        paper_mm = 10.0 * abs(paper_cm - true_cm)
        name = f"of the box of {true_cm} cm, {'projected' if measured['projection'] else '3D'}"
        rule = f"rule: not more than the paper’s width, {paper_mm:.1f} mm"
        add_size_row(part, f"width {name}", f"{paper_cm} cm", box["width"], true_cm, paper_mm, rule)
        if not measured["projection"]:
            add_size_row(part, f"height ({height_cm:.0f} cm) {name}", f"width off by {paper_mm:.1f} mm", box["height"], height_cm, paper_mm, rule)


def make_boxes(shop):
    shop.drive("three-boxes")
    part = Part("The scene three-boxes, seed 1: boxes of the paper’s true widths before the standing scanner.")
    shop.render(part, "three-boxes/cloud.ply", "cloud", "cloud.png",
                "(b) The 3D map of the three boxes before the far wall, from beside the scanner.", "--size", "1600x1000", "--no-path", "--title",
                "Three boxes", "--from=-0.5,-0.6,1.35,1.9,0,0.62,48")
    measure = ("gdtslam", "evaluate", "three-boxes/cloud.ply", "--boxes", "--picture")
    solid = shop.json(*measure, "solid.svg")
    shop.picture(part, "solid.svg", "Measured in the 3D map, seen from above: faces and where they end.")
    projected = shop.json(*measure, "projection.svg", "--projection")
    shop.picture(part, "projection.svg", "(c) Measured in the projection to the floor.")
    add_box_rows(part, solid)
    add_box_rows(part, projected)
    part.notes.append("The simulated laser has 1 cm of noise and none of the biases of a real one (dark surfaces, grazing beams, a warm-up); "
                      "the paper’s errors of 4 to 8 mm contain those.")
    return part


def surface_errors(shop, drive, scene, *words):
    return shop.json("gdtslam", "evaluate", f"{drive}/cloud.ply", "--scene", scene, "--trajectory", f"{drive}/trajectory.tum", "--reference",
                     f"{drive}.truth.tum", *words)


def add_surface_row(part, quantity, errors):
    part.state(quantity, "", f"{length_text(errors['distance_m']['mean'])} mean, {length_text(errors['distance_m']['p90'])} for 90 %",
               "of all points to the scene’s true surfaces; the paper shows pictures only")


def make_standing(shop):
    part = Part("The scanner stands at two places of the scene office-3f, seed 1, which has an open elevator and plants.")
    for drive, what, where, camera in (
            ("at-elevator", "an open elevator", "the open elevator is the recess in the wall on the left", "-4.2,-2.2,3.6,3.2,0.9,0.7,46"),
            ("at-plant", "a plant", "the plant stands before the wall ahead", "-3.6,-0.2,2.6,3,-0.4,0.8,46")):
        shop.drive(drive)
        shop.render(part, drive, "cloud", f"{drive}.png",
                    f"The scanner stands in the corridor; {where}. Without the ceiling; what hides behind walls stays empty.", "--size",
                    "1600x860", "--title", f"From one place: {what}", f"--from={camera}")
        errors = surface_errors(shop, drive, "office-3f", "--no-align")
        part.state(f"points, {what} ahead", "", f"{errors['distance_m']['count']:,}", "every beam that returned, in 40 s")
        add_surface_row(part, f"distance to surfaces, {what} ahead", errors)
    part.notes.append("As in the paper, one place is not enough: walls hide most of the floor. Figures 14 and 15 are the remedy.")
    return part


def read_ply(path, record):
    with open(path, "rb") as file:
        head = b""
        while not head.endswith(b"end_header\n"):
            head += file.readline()
        return np.fromfile(file, record, int(re.search(rb"element vertex (\d+)", head)[1]))


def read_map(folder):
    """Rows of cells, the lowest first, True if occupied; resolution and lower left corner."""
    text = (folder / "map.yaml").read_text()
    origin = [float(word) for word in re.search(r"origin: \[(.*?)\]", text)[1].split(",")]
    with open(folder / "map.pgm", "rb") as file:
        words = []
        while len(words) < 4:
            words += file.readline().split(b"#")[0].split()
        width, height = int(words[1]), int(words[2])
        cells = np.fromfile(file, np.uint8, width * height).reshape(height, width)[::-1]
    return cells == 0, float(re.search(r"resolution: ([\d.]+)", text)[1]), origin[:2]


def share_near(cells, others, reach):
    """Share of the cells (x, y) with one of the others within reach."""
    if len(cells) == 0 or len(others) == 0:
        return 0.0
    low = np.minimum(cells.min(axis=0), others.min(axis=0)) - reach
    size = np.maximum(cells.max(axis=0), others.max(axis=0)) - low + reach + 1
    near = np.zeros(size, bool)
    for step in itertools.product(range(-reach, reach + 1), repeat=2):
        near[tuple((others - low + step).T)] = True
    return float(near[tuple((cells - low).T)].mean())


def contour_shares(occupied, resolution_m, origin_m, cloud, truth):
    """Agreement to 5 cm in the plane between a 2D map, the 3D map from raised scans and the truth, as three shares: occupied cells near
    a raised point; cells over which raised points span 1 m of height, near an occupied one; cells with true surfaces near a raised
    point. Points of level scans repeat the 2D map and are ignored."""
    reach = math.ceil(0.05 / resolution_m)

    def cells_of(points):
        return np.floor((points - np.asarray(origin_m)) / resolution_m).astype(int)

    raised = cloud[np.abs(cloud["elevation"]) >= 0.035]
    seen, place = np.unique(cells_of(np.column_stack([raised["x"], raised["y"]])), axis=0, return_inverse=True)
    low, high = np.full(len(seen), np.inf), np.full(len(seen), -np.inf)
    np.minimum.at(low, place.ravel(), raised["z"])
    np.maximum.at(high, place.ravel(), raised["z"])
    walls = seen[high - low >= 1.0]  # lintels and furniture span less
    in_map = np.argwhere(occupied)[:, ::-1]
    surfaces = np.unique(cells_of(truth), axis=0) if len(truth) else np.zeros((0, 2), int)
    return share_near(in_map, seen, reach), share_near(walls, in_map, reach), share_near(surfaces, seen, reach)


def true_contour(shop, drive, alignment):
    """True hits of level beams, in the map's frame."""
    path = shop.path(f"{drive}.truth.ply")
    hits = read_ply(path, HITS)
    path.unlink()  # half a gigabyte
    level = hits[np.abs(hits["elevation"]) < 0.02]
    theta = alignment["theta_rad"]
    return moved((0.0, 0.0, -theta), np.column_stack([level["x"] - alignment["x_m"], level["y"] - alignment["y_m"]]))


def make_floor(shop, drive, floor):
    shop.drive(drive)
    part = Part(f"The scene {drive}, seed 1, a floor like that of the figure, drawn by us; the laser nods on the linkage paper-b while the "
                "robot drives.")
    shop.render(part, drive, "map", "map.png", "(a) 2D map of the horizontal scans, with the path.", "--size", "1190x640", "--title",
                f"{floor}: 2D map")
    shop.render(part, drive, "cloud", "top.png", "From above, floor and ceiling taken away.", "--from", "top", "--size", "1190x640", "--hide",
                "floor", "--title", f"{floor} from above")
    shop.render(part, drive, "cloud", "iso.png", "(b) The 3D map, floor and ceiling taken away as planes that were found in it; colours by height.",
                "--size", "1800x1000", "--hide", "floor", "--title", f"{floor} in 3D")
    errors = surface_errors(shop, drive, drive)
    cloud = read_ply(shop.path(f"{drive}/cloud.ply"), CLOUD)
    report = (shop.path(drive) / "report.json").read_text()
    scans, path_m = int(re.search(r'"scans": (\d+)', report)[1]), float(re.search(r'"path_m": ([\d.]+)', report)[1])
    part.state("points in the map", "", f"{len(cloud):,}", f"thinned, from {scans:,} scans along {path_m:.0f} m")
    add_surface_row(part, "distance to surfaces", errors)
    alignment = errors["alignment"]
    part.state("error of the robot’s path (ATE)", "",
               f"{length_text(alignment['ate_mean_m'])} mean, {length_text(alignment['ate_max_m'])} at most",
               "best rigid alignment with the true path")
    shares = contour_shares(*read_map(shop.path(drive)), cloud, true_contour(shop, drive, alignment))
    for share, quantity, what in zip(shares, (
            "walls of the 2D map that the 3D map has", "walls of the 3D map that the 2D map has", "true walls in sight that the 3D map has"), (
            "occupied cells with points of raised scans within 5 cm",
            "cells over which points of raised scans span 1 m of height, with an occupied one within 5 cm",
            "what level beams truly meet, with points of raised scans within 5 cm")):
        part.claim(quantity, "contours almost the same", f"{100.0 * share:.1f} %", share >= 0.9, what + "; rule: 90 % and more")
    return part


def make_floor_3f(shop):
    return make_floor(shop, "office-3f", "3F")


def make_floor_7f(shop):
    return make_floor(shop, "office-7f", "7F")


class Elevations:
    """Elevation over the encoder's ticks, radians, by the table of a linkage."""

    def __init__(self, shop, linkage, zero_rad, ticks_per_turn, table):
        shop.run("gdtslam", "linkage", linkage, "--csv", table, "--step", "0.1deg")
        rows = np.loadtxt(shop.path(table), delimiter=",", skiprows=1)
        self.crank_rad, self.elevation_rad = np.radians(rows[:, 0]), np.radians(rows[:, 2])
        self.zero_rad, self.ticks_per_turn = zero_rad, ticks_per_turn

    def at(self, ticks):
        crank_rad = self.zero_rad + 2.0 * math.pi * np.asarray(ticks) / self.ticks_per_turn
        return np.interp(crank_rad, self.crank_rad, self.elevation_rad, period=2.0 * math.pi)


def ranges_of_stops(path):
    """Ticks at which the crank stood, with the mean range of the forward beam."""
    ticks, sums = 0, {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split(None, 12)
            if words[0] == "ENCODER":
                ticks = int(words[1])
            elif words[0] == "ROBOTLASER1" and float(words[9]) < float(words[5]):
                count, total = sums.get(ticks, (0, 0.0))
                sums[ticks] = count + 1, total + float(words[9])
    stood = {ticks: total / count for ticks, (count, total) in sums.items() if count >= 200}
    return np.array(list(stood)), np.array(list(stood.values()))


def make_calibration(shop):
    shop.drive("wall")
    found = shop.json("gdtslam", "calibrate", "wall.log", "-o", "found.yaml", "--start", "paper-b", "--picture", "ranges.svg")
    parameters = {parameter["name"]: parameter for parameter in found["parameters"]}
    part = Part("The scene wall, seed 1, with the paper’s protocol: the crank stops each 1.8° for 250 scans. The mount has the lengths that "
                "the paper found; the calibration starts from the nominal ones.")
    shop.picture(part, "ranges.svg", "Ranges to the wall over the encoder and what is left of them over the elevation, before and after.")
    rows = []
    for number, (bar, paper_cm) in enumerate(zip(found["paper_bars"], DELTAS_CM), 1):
        row = [f"L{number}", bar["place"] if bar["in_loop"] else "not in the loop", f"{paper_cm:+.4f}"]
        if bar["in_loop"]:
            sigma = "free" if bar["sigma_m"] is None else f"{100.0 * bar['sigma_m']:.4f}"
            row += [f"{100.0 * bar['value_m']:+.4f}", sigma, f"{100.0 * parameters[bar['place']]['data_share']:.0f} %"]
        else:
            row += ["in the elevation offset", "", ""]
        rows.append(row)
    part.table("Corrections of the seven lengths, cm. The simulated mount has the paper’s, so they are the truth here.",
               ["length", "bar", "paper = truth", "found", "sigma", "told by the ranges"], rows)
    text = shop.path("wall.linkage.yaml").read_text()
    turn, zero = int(re.search(r"ticks_per_turn: (\d+)", text)[1]), float(re.search(r"zero: ([-\d.e]+) rad", text)[1])
    truth = Elevations(shop, "wall.linkage.yaml", zero, turn, "truth.csv")
    start = Elevations(shop, "paper-b", parameters["zero"]["start"], turn, "start.csv")
    after = Elevations(shop, "found.yaml", parameters["zero"]["estimate"], turn, "found.csv")
    ticks, ranges = ranges_of_stops(shop.path("wall.log"))
    most_rad = math.radians(60.0)

    def miss_m(model, distance_m):
        used = model.at(ticks) <= most_rad
        return float(np.sqrt(np.mean((ranges[used] * np.cos(model.at(ticks)[used]) - distance_m) ** 2)))

    def off_deg(model):
        every = np.arange(0, turn, 20)
        every = every[truth.at(every) <= most_rad]
        return math.degrees(float(np.sqrt(np.mean((model.at(every) - truth.at(every)) ** 2))))

    wall = parameters["distance.wall"]
    misses = miss_m(start, wall["start"]), miss_m(after, wall["estimate"])
    part.state("wall’s distance by the ranges, scatter before", "curves differ (figure A(a))", f"{length_text(misses[0])} rms",
               "with the nominal lengths, up to 60°; the paper shows curves only")
    part.claim("the same after the calibration", "best fit (figure A(b))", f"{length_text(misses[1])} rms", misses[1] < 0.5 * misses[0],
               "rule: at most half of before; what is left is the noise of the averages")
    part.claim("elevation, off the truth", "", f"{off_deg(start):.3f}° before, {off_deg(after):.3f}° after", off_deg(after) < 0.1 * off_deg(start),
               f"rms up to 60°; the calibration itself states {math.degrees(found['elevation_sigma_rad']):.3f}°; rule: a tenth of before")
    part.notes.append("The lengths need not be found, the elevation is what counts. (A1) as printed, R_m(0) cos θ, is neither the range nor "
                      "the distance over the floor; what is fitted is r cos θ = d.")
    part.notes += [remark[:1].upper() + remark[1:].rstrip(".") + "." for remark in found["remarks"]]
    return part
