"""Figures 3, 4 and 7 of the paper: distance transforms, and a floor with a loop."""

import json
import math
import re

import matplotlib.image
import matplotlib.pyplot as plt
import numpy as np

from part import REAL_LOGS, Part, between, joined, length_text, read_tum

# Figure 3(b) as printed, the upper row first; its zeros are the obstacles of figure 3(a).
PRINTED = np.array([[int(digit) for digit in row] for row in (
    "4323432334", "3212321223", "2101210123", "2101210123", "2101210123", "2101110123", "2100000123", "3211111223", "4322222234",
    "5433333334")])[::-1]
CELL_M = 0.1  # of the map that is made of them


def obstacles():
    return np.argwhere(PRINTED == 0)[:, ::-1]  # x, y


def least_distances(metric):
    """Distance of each cell to the nearest obstacle, by definition."""
    cells = np.stack(np.meshgrid(np.arange(10), np.arange(10)), axis=-1)
    return metric(cells[:, :, None, :] - obstacles()).min(axis=2)


def euclidean(offsets):
    return np.hypot(offsets[..., 0], offsets[..., 1])


def city_block(offsets):
    return np.abs(offsets).sum(axis=-1)


def map_of_cells(shop):
    """The distances, in cells, of the map of one scan whose beams end in the middles of the obstacles."""
    eye, step = np.array([0.47, 0.83]), math.radians(0.05)
    ranges = np.zeros(7200)  # 0: no return
    for offset in (obstacles() + 0.5) * CELL_M - eye:
        ranges[round((math.atan2(offset[1], offset[0]) + math.pi) / step) % len(ranges)] = math.hypot(*offset)
    head = f"ROBOTLASER1 0 {-math.pi:.9f} {2.0 * math.pi - step:.9f} {step:.9f} 5.0 0.01 0 {len(ranges)} "
    shop.path("cells.log").write_text(head + " ".join(f"{value:.5f}" for value in ranges) +
                                      f" 0 {eye[0]} {eye[1]} 0 0 0 0 0 0 0 0 0 0.0 simulated 0.0\n")
    shop.map("cells.log", "cells", "--no-loops", "--set", "map.resolution=10cm", "--set", "map.truncation=3.2m", "--set",
             "scan.min_points=3", "--set", "scan.min_range=1cm")
    text = shop.path("cells/gdt.yaml").read_text()
    origin, scale = json.loads(re.search(r"origin: (\[.*?\])", text)[1]), int(re.search(r"scale: (\d+)", text)[1])
    levels = np.rint(matplotlib.image.imread(shop.path("cells/gdt.png")) * 65535.0)[::-1]
    x, y = (round(-origin[k] / CELL_M) for k in (0, 1))
    return levels[y:y + 10, x:x + 10] / scale / 256.0


def sheet(title, words, text_of, paper_of):
    """Squares with one word each."""
    figure, axes = plt.subplots(figsize=(6.2, 6.8))
    figure.subplots_adjust(0.04, 0.03, 0.96, 0.86)
    figure.text(0.04, 0.94, title, size=17, weight="bold")
    figure.text(0.04, 0.89, words, size=11.5, color="#5d646d")
    for (y, x), value in np.ndenumerate(PRINTED):
        is_obstacle = value == 0
        axes.add_patch(plt.Rectangle((x, y), 1, 1, facecolor="#22262b" if is_obstacle else paper_of(x, y), edgecolor="#dedbd2"))
        axes.text(x + 0.5, y + 0.48, "0" if is_obstacle else text_of(x, y), ha="center", va="center", size=14,
                  color="white" if is_obstacle else "#22262b")
    axes.set(xlim=(0, 10), ylim=(0, 10))
    axes.axis("off")
    return figure


def make_cells(shop):
    field = map_of_cells(shop)
    true, blocks = least_distances(euclidean), least_distances(city_block)
    agreeing = np.floor(true + 0.5) == PRINTED
    part = Part("From the obstacles that figure 3(a) prints, mapped from one scan whose beams end in them.", origin="computed")
    colours = plt.get_cmap("Blues")
    for file, caption, figure in (
            ("before.svg", "(a) The obstacles of figure 3(a).",
             sheet("Before the transform", "Obstacles hold 0, all other cells infinity", lambda x, y: "∞", lambda x, y: "white")),
            ("after.svg", "(b) Their distance transform, equation (1) with the root taken: exact to 1/256 cell.",
             sheet("After: the exact distance", "Euclidean, in cells, to one decimal", lambda x, y: f"{field[y, x]:.1f}",
                   lambda x, y: colours(0.6 - 0.1 * field[y, x]))),
            ("printed.svg", "(b) of the paper, for comparison. Marked: not the Euclidean distance, rounded.",
             sheet("As the paper prints it", "Marked: not the Euclidean distance, rounded", lambda x, y: str(PRINTED[y, x]),
                   lambda x, y: "white" if agreeing[y, x] else "#ffdcc4"))):
        shop.draw(part, figure, file, caption, 3)
    wrong = int((np.abs(field - true) > 0.5 / 256.0).sum())
    part.claim("cells off the Euclidean distance", "", f"{wrong} of 100", wrong == 0,
               "the paper states the Euclidean distance; held against the minimum over all obstacles, to half of 1/256 cell")
    part.claim("print = Euclidean, rounded", "100 of 100 (claimed)", f"{int(agreeing.sum())} of 100", False,
               "what is printed is not what equation (1) and the text say")
    part.state("print = city block", "", f"{int((blocks == PRINTED).sum())} of 100",
               "the metric that comes nearest to the print; it is no reference for either")
    part.notes.append("Equation (1) as printed is a minimum over all cells and so zero everywhere; \"(i, j) an obstacle\" is added. It is a "
                      "square, while (8) compares it with metres: maps hold the distance.")
    return part


def make_local_scan(shop):
    shop.drive("one-scan")
    part = Part("One scan of 961 beams over 240° at a crossing of the scene office-loop, seed 1.")
    look = ("--size", "1190x680", "--no-path", "--title")
    shop.render(part, "one-scan", "map", "scan.png", "(a) What one scan tells: walls, free space, unknown.", *look, "One scan")
    shop.render(part, "one-scan", "field", "field.png", "(b) Its distance transform as intensity: bright near obstacles, as in the paper.",
                *look, "Its distance transform")
    part.notes.append("A picture to be compared by eye: the paper gives no number for it.")
    return part


def end_error(first, last, truth):
    """Error of the end relative to the start, in metres and degrees."""
    error = between(between(truth[0], truth[-1]), between(first, last))
    return math.hypot(*error[:2]), math.degrees(abs(error[2]))


def end_text(error):
    return f"{length_text(error[0])}, {error[1]:.2f}°"


def add_loop_rows(part, shop):
    stamps, truth = read_tum(shop.path("office-loop-matched.truth.tum"))
    away = np.hypot(*(truth[:, :2] - truth[0, :2]).T)
    back = int(np.argmax(away)) + int(np.argmin(away[np.argmax(away):]))  # the drive may go on from there
    truth, until_s = truth[:back + 1], stamps[back] + 1e-3
    length_m = float(np.hypot(*np.diff(truth[:, :2], axis=0).T).sum())

    def end_of(run):
        stamps, path = read_tum(shop.path(f"{run}/trajectory.tum"))
        path = path[stamps <= until_s]
        return end_error(path[0], path[-1], truth)

    def all_poses(run):
        ate = shop.json("gdtslam", "evaluate", f"{run}/trajectory.tum", "--reference", "office-loop-matched.truth.tum")["ate"]["translation_m"]
        return f"{length_text(ate['mean'])} mean, {length_text(ate['max'])} at most"

    end = end_of("office-loop-matched")
    part.claim(f"back at the start after {length_m:.0f} m of path", "start and end coincide", end_text(end), end[0] < 0.001 * length_m,
               "off the truth, seen from the start; rule: at most 0.1 % of the path. As in the paper no loop closure is done (--no-loops). "
               "The drive goes on from there")
    part.state("the same with loops closed, as is the default", "", end_text(end_of("office-loop")), "beyond the paper, whose system closes none")
    lines = (line.split() for line in shop.path("office-loop-matched.log").read_text().splitlines() if line.startswith("ODOM "))
    wheels = [[float(word) for word in line[1:4]] for line in lines if float(line[7]) <= until_s]
    part.state("the same by the wheels alone", "", end_text(end_error(wheels[0], wheels[-1], truth)), "what matching corrects")
    part.state("error of all poses (ATE)", "", all_poses("office-loop-matched"),
               "best rigid alignment with the true path; the paper had no truth to compare with")
    part.state("the same with loops closed", "", all_poses("office-loop"), "")


def make_loop(shop):
    shop.drive("office-loop-matched")
    shop.drive("office-loop")
    part = Part("A drive through the scene office-loop, seed 1, an office floor with a loop of corridors like the paper’s 7F.")
    look = ("--size", "1190x820", "--title")
    shop.render(part, "office-loop-matched", "map", "map.png", "(a) Occupancy map with the robot’s path in the colours of time.", *look,
                "2D map and path")
    shop.render(part, "office-loop-matched", "field", "field.png", "(b) The global distance transform as intensity, with the path.", *look,
                "GDT and path")
    add_loop_rows(part, shop)
    for number, (stem, (log, relations)) in enumerate(shop.real_logs().items()):
        name = REAL_LOGS[stem]
        shop.map(log, stem)
        errors = shop.json("gdtslam", "evaluate", f"{stem}/trajectory.tum", "--relations", relations)
        shop.render(part, stem, "map", f"{stem}-map.png", f"Real log, {name}: occupancy map and path.", *look, f"{name} (real)")
        if number == 0:  # one is enough to see
            shop.render(part, stem, "field", f"{stem}-field.png", f"Real log, {name}: distance transform as intensity.", *look, f"{name} (real)")
        found = errors["all"]
        part.state(f"{name} (real): error of verified relations", "",
                   f"{length_text(found['translation_m']['mean'])} and {found['rotation_deg']['mean']:.2f}° mean",
                   f"{found['translation_m']['count']:,} relations of [Kuemmerle2009], with loops closed; those of loops alone "
                   f"{length_text(errors['loops']['translation_m']['mean'])}. Not a log of the paper’s")
        part.origin = "simulated and real"
    if shop.real_logs():
        part.source += joined(REAL_LOGS[stem] for stem in shop.real_logs())
    return part
