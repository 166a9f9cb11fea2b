"""The comparison of minimisers: figures that hang together, the same for a seed, pictures and tables."""

import csv
import json
import xml.etree.ElementTree as ElementTree

from cli_support import LOG, command, expect, expect_exit, fresh_folder, validate

METHODS = ("simplex", "gauss-newton", "sce", "certified")
QUICK = ("--first", 200, "--scans", 12, "--matchers", ",".join(METHODS), "--starts-at", "2cm/0.5deg,40cm/10deg")


def _compared(folder, *arguments):
    process = command("compare", LOG, *QUICK, "--json", "--csv", folder / "trials.csv", "--force", *arguments, timeout=250)
    expect_exit(process, 0)
    expect(process.stderr == "", f"stderr {process.stderr!r}")
    validate(process.stdout, "compare")
    with open(folder / "trials.csv", encoding="utf-8") as file:
        return json.loads(process.stdout), list(csv.DictReader(file))


def compare_figures_hang_together():
    """The JSON's figures are those of the trials; on a simulated floor all methods find the solution from 2 cm."""
    folder = fresh_folder("compare")
    report, trials = _compared(folder, "--picture", folder / "basins.svg")
    scans = report["scans"]
    expect(scans["read"] == 200 and 10 <= scans["measured"] <= 13, f"scans {scans}")
    expect(scans["measured"] == scans["counted"] + scans["weak"] + scans["not_certified"], f"scans {scans}")
    expect(len(trials) == scans["measured"] * 3 * len(METHODS), f"{len(trials)} trials")
    expect([level["start"] for level in report["levels"]] == ["prediction", "solution", "solution"], "levels")
    held = [row for row in trials if row["certified"] == "1" and float(row["hold"]) >= scans["weak_below"]]
    for number, level in enumerate(report["levels"]):
        for figures in level["held"]:
            rows = [row for row in held if int(row["level"]) == number and row["method"] == figures["method"]]
            distances = [float(row["distance_m"]) for row in rows]
            expect(figures["distance_m"]["count"] == len(rows), f"count of {figures}")
            expect(abs(figures["distance_m"]["max"] - max(distances)) < 1e-5, f"max of {figures}")
            expect(abs(figures["distance_m"]["mean"] - sum(distances) / len(distances)) < 1e-5, f"mean of {figures}")
            expect(figures["success"]["count"] == sum(row["success"] == "1" for row in rows), f"success of {figures}")
            expect(figures["success"]["low_95"] <= figures["success"]["share"] <= figures["success"]["high_95"], "interval")
    for figures in report["levels"][1]["held"]:
        expect(figures["distance_m"]["mean"] < 0.01, f"mean error from 2 cm {figures}")
    for row in trials:
        expect(float(row["solution_cost_m"]) >= float(row["bound_m"]) - 1e-7, f"a cost below its bound: {row}")
    words = "".join(ElementTree.parse(folder / "basins.svg").getroot().itertext())
    for name in METHODS:
        expect(name in words, f"{name} is not in the picture")


def compare_is_the_same_for_a_seed():
    """Everything but the times depends on log, configuration and seed alone."""
    folder = fresh_folder("compare_seed")
    first, trials = _compared(folder)
    again, same = _compared(folder, "--threads", 2)
    other, moved = _compared(folder, "--seed", 2)
    first.pop("times"), again.pop("times"), other.pop("times")
    expect(first == again, "two runs differ")
    without_times = lambda rows: [{key: value for key, value in row.items() if key != "time_us"} for row in rows]
    expect(without_times(trials) == without_times(same), "the trials of two runs differ")
    expect(without_times(trials) != without_times(moved), "the seed moves no start")
