"""The clouds of a nodding laser, standing and moving."""

import json

from experiment.drives import print_row, print_table, run

NOD_VARIANTS = {
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
MOST_STANDING_M = 0.001
MOST_MOVING_M = 0.03


class Nodding:
    def __init__(self, program, folder):
        self.program, self.folder, self.missed = program, folder, []

    def simulate(self, scene, seed, *arguments):
        log = self.folder / f"{scene}.log"
        run(self.program, "simulate", scene, "-o", log, "--force", "--seed", seed, *arguments)
        return log

    def errors(self, log, options, *arguments):
        """Maps the log, and compares its cloud and path with the truth."""
        out = self.folder / "run"
        run(self.program, "map", log, "-o", out, "--force", "-q", *options)
        return json.loads(run(self.program, "evaluate", out / "cloud.ply", "--trajectory", out / "trajectory.tum",
                                  "--reference", log.with_suffix(".truth.tum"), *arguments, "--json"))

    def expect(self, condition, what):
        if not condition:
            self.missed.append(what)

    def standing(self):
        """Each point of three-boxes against the true hit of its own beam."""
        print_table("log", "points", "mean", "largest", "quantisation bound, largest", "worst point, of its own bound")
        for name, (options, resolution) in STANDING.items():
            log = self.simulate("three-boxes", 1, "--truth-hits", *options)
            bound = ["--linkage", log.with_suffix(".linkage.yaml"), "--resolution", resolution] if resolution else []
            errors = self.errors(log, ["--set", "cloud.voxel=0"], "--hits", log.with_suffix(".truth.ply"), *bound)
            distances, check = errors["distance_m"], errors["quantisation_bound"]
            told = (f"{1e3 * check['largest_m']:.3f} mm", f"{100.0 * check['largest_share']:.0f} %") if check else ("-", "-")
            print_row(name, f"{distances['count']:,}", f"{1e3 * distances['mean']:.3f} mm", f"{1e3 * distances['max']:.3f} mm", *told)
            if options == ["--exact"]:
                self.expect(distances["max"] <= MOST_STANDING_M, f"{name}: {1e3 * distances['max']:.3f} mm")
            if check:
                self.expect(check["beyond"] == 0, f"{name}: {check['beyond']} points beyond the bound")

    def moving(self, seeds):
        """The clouds of the office scenes against the true surfaces."""
        print_table("log", "variant", "points", "mean, cm", "rms", "median", "90 %", "largest", "beyond 3, 10 cm", "ATE, cm")
        default = next(iter(NOD_VARIANTS))
        stops = ["--nod", "stop-and-scan"]
        for scene, seed, mode in [("office-7f", seed, []) for seed in range(1, seeds + 1)] + [("office-3f", 1, []), ("office-7f", 1, stops)]:
            log = self.simulate(scene, seed, *mode)
            label = f"{scene}, seed {seed}" + (", stop and scan" if mode else "")
            for name, options in NOD_VARIANTS.items():
                if name != default and (seed != 1 or mode):
                    continue
                errors = self.errors(log, options, "--scene", scene)
                distances, ate_m = errors["distance_m"], errors["alignment"]["ate_mean_m"]
                beyond = {limit["limit_m"]: 100.0 * limit["share"] for limit in distances["beyond"]}
                print_row(label, name, f"{distances['count']:,}", *(f"{100.0 * distances[key]:.2f}" for key in ("mean", "rms", "median", "p90", "max")),
                          f"{beyond[0.03]:.1f} %, {beyond[0.1]:.2f} %", f"{100.0 * ate_m:.2f}")
                if name == default:
                    self.expect(distances["mean"] <= MOST_MOVING_M and ate_m <= MOST_MOVING_M,
                                f"{label}: mean {100.0 * distances['mean']:.2f} cm, ATE {100.0 * ate_m:.2f} cm")


def nodding(chosen):
    """Points of a standing scanner to the true hits of their beams, and those of a moving one to the nearest true surfaces."""
    figures = Nodding(chosen.program, chosen.folder)
    figures.standing()
    print()
    figures.moving(chosen.seeds)
    print("\nEvery target is met." if not figures.missed else "\nMissed: " + "; ".join(figures.missed))
    return not figures.missed
