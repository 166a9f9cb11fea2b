#!/usr/bin/env python3
"""The figures of docs/benchmarks.md about the nodding laser, from simulated logs with their truth: standing and moving.

`nodding_figures.py PROGRAM [-o FOLDER] [--seeds N]` prints the tables as Markdown and what misses its target; the exit code is 1
when something does. It takes some minutes and about 600 MB below FOLDER, which is removed unless it is given."""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

VARIANTS = {
    "`nod.interpolation=odometry`, the default": ["--set", "nod.interpolation=odometry"],
    "`nod.interpolation=linear`": ["--set", "nod.interpolation=linear"],
    "`nod.interpolation=geodesic`": ["--set", "nod.interpolation=geodesic"],
    "`nod.form=literal`, (14) as printed": ["--set", "nod.form=literal"],
}
STANDING = {
    "no noise, no rounding": (["--exact"], None),
    "20,000 ticks, 1 mm": (["--noise", "0 m", "--resolution", "1 mm", "--ticks", "20000"], "1 mm"),
    "20,000 ticks, 1 mm, noise 10 mm": (["--noise", "10 mm", "--resolution", "1 mm", "--ticks", "20000"], None),
}
STOPS = ["--nod", "stop-and-scan"]
MOST_STANDING_M = 0.001
MOST_MOVING_M = 0.03


class Figures:
    def __init__(self, program, folder):
        self.program = program
        self.folder = folder
        self.missed = []

    def run(self, *arguments):
        """Runs the command; returns what it printed as JSON, when it did."""
        process = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        if process.returncode != 0:
            sys.exit(f"{' '.join(map(str, arguments))}: exit {process.returncode}: {process.stderr.strip()}")
        return json.loads(process.stdout) if "--json" in arguments else None

    def simulate(self, scene, seed, *arguments):
        log = self.folder / f"{scene}.log"
        self.run("simulate", scene, "-o", log, "--seed", seed, *arguments)
        return log

    def map(self, log, *arguments):
        return self.run("map", log, "-o", self.folder / "run", "--json", *arguments)

    def errors(self, log, *arguments):
        run = self.folder / "run"
        return self.run("evaluate", run / "cloud.ply", "--trajectory", run / "trajectory.tum",
                        "--reference", log.with_suffix(".truth.tum"), *arguments, "--json")

    def expect(self, condition, what):
        if not condition:
            self.missed.append(what)


def millimetres(metres):
    return f"{1000.0 * metres:.3f}"


def standing(figures):
    """Each point of three-boxes against the true hit of its own beam."""
    print("| log | points | mean | largest | quantisation bound, largest | worst point, of its own bound |")
    print("|---|---|---|---|---|---|")
    for name, (options, resolution) in STANDING.items():
        log = figures.simulate("three-boxes", 1, "--truth-hits", *options)
        figures.map(log, "--set", "cloud.voxel=0")
        bound = ["--linkage", log.with_suffix(".linkage.yaml"), "--resolution", resolution] if resolution else []
        errors = figures.errors(log, "--hits", log.with_suffix(".truth.ply"), *bound)
        distances = errors["distance_m"]
        check = errors["quantisation_bound"]
        told = f"{millimetres(check['largest_m'])} mm | {100.0 * check['largest_share']:.0f} %" if check else "- | -"
        print(f"| {name} | {distances['count']:,} | {millimetres(distances['mean'])} mm | {millimetres(distances['max'])} mm | {told} |",
              flush=True)
        if options == ["--exact"]:
            figures.expect(distances["max"] <= MOST_STANDING_M, f"{name}: {millimetres(distances['max'])} mm")
        if check:
            figures.expect(check["beyond"] == 0, f"{name}: {check['beyond']} points beyond the bound")


def moving_row(figures, scene, label, log, name, options):
    figures.map(log, *options)
    errors = figures.errors(log, "--scene", scene)
    distances = errors["distance_m"]
    beyond = {limit["limit_m"]: 100.0 * limit["share"] for limit in distances["beyond"]}
    ate_m = errors["alignment"]["ate_mean_m"]
    centimetres = [f"{100.0 * value:.2f}" for value in (distances["mean"], distances["rms"], distances["median"], distances["p90"], distances["max"])]
    print(f"| {label} | {name} | {distances['count']:,} | {' | '.join(centimetres)} | {beyond[0.03]:.1f} %, {beyond[0.1]:.2f} % | "
          f"{100.0 * ate_m:.2f} |", flush=True)
    return distances["mean"], ate_m


def moving(figures, seeds):
    """The clouds of the office scenes against the true surfaces."""
    print("| log | variant | points | mean, cm | rms | median | 90 % | largest | beyond 3, 10 cm | ATE, cm |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    default = next(iter(VARIANTS))
    drives = [("office-7f", seed, []) for seed in range(1, seeds + 1)] + [("office-3f", 1, []), ("office-7f", 1, STOPS)]
    for scene, seed, mode in drives:
        log = figures.simulate(scene, seed, *mode)
        label = f"{scene}, seed {seed}" + (", stop and scan" if mode else "")
        for name, options in VARIANTS.items():
            if name == default or (seed == 1 and not mode):
                mean_m, ate_m = moving_row(figures, scene, label, log, name, options)
                if name == default:
                    figures.expect(mean_m <= MOST_MOVING_M and ate_m <= MOST_MOVING_M,
                                   f"{label}: mean {100.0 * mean_m:.2f} cm, ATE {100.0 * ate_m:.2f} cm")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the command gdtslam")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="keep logs and the last run here")
    parser.add_argument("--seeds", type=int, default=3, help="drives through office-7f (default: %(default)s)")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = chosen.output or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        figures = Figures(chosen.program, folder)
        print("Standing, each point to the true hit of its beam:\n")
        standing(figures)
        print("\nMoving, each point to the nearest true surface:\n")
        moving(figures, chosen.seeds)
    print("\nEvery target is met." if not figures.missed else "\nMissed: " + "; ".join(figures.missed))
    sys.exit(1 if figures.missed else 0)


if __name__ == "__main__":
    main()
