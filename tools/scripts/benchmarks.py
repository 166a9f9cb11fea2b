#!/usr/bin/env python3
"""Measures what docs/benchmarks.md and README.md show in tables and writes them into the pages.

  benchmarks.py [--program GDTSLAM] [--data FOLDER] [--write] [NAME...]

Without --write the tables are printed. A table stands in the page between the lines '<!-- made: NAME -->' and
'<!-- made -->'; what is said around it is written by hand. Without a NAME all are made, some six minutes, best
while the machine does nothing else. The public logs are looked for in the folder slam2d of --data (default: GDTSLAM_DATA, else
../shared/data beside the clone). Two tables of one program tell how much is chance: run it twice.
"""

import argparse
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/benchmarks.md"
PAGES = {"results": ROOT / "README.md"}  # of those that stand elsewhere
LOGS = {"Intel": "intel", "Freiburg 079": "fr079", "MIT CSAIL": "mit-csail"}
# Mean and deviation, metres and degrees, as [Hess2016] has them.
CARTOGRAPHER = {"Intel": "0.0229 ± 0.0239 m, 0.453 ± 1.335°", "Freiburg 079": "0.0452 ± 0.0354 m, 0.538 ± 0.718°",
                "MIT CSAIL": "0.0319 ± 0.0363 m, 0.369 ± 0.365°"}
# The stages of report.json that one table shows; the others are summed up.
STAGES = ("read", "match", "mapper_other", "loops")


def table(head, rows):
    """Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def time_text(seconds):
    """Three digits and a unit."""
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}" if seconds < 1000 * scale else f"{seconds / scale:.0f} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


class Benchmarks:
    """Each method whose name begins with table_ makes one."""

    def __init__(self, program, data, folder):
        self.program, self.data, self.folder = program, data, folder
        self.maps = {}
        self.city = ()

    def run(self, *arguments):
        """What the command prints, with its CPU seconds and the most memory in MB that it had."""
        with tempfile.TemporaryFile() as output:
            process = subprocess.Popen([self.program, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=output,
                                       stderr=subprocess.PIPE)
            said = process.stderr.read().decode(errors="replace").strip()
            _, status, usage = os.wait4(process.pid, 0)
            code = process.returncode = os.waitstatus_to_exitcode(status)
            if code != 0:
                sys.exit(f"benchmarks.py: {self.program} {' '.join(map(str, arguments))}: exit {code}: {said}")
            output.seek(0)
            return output.read().decode(), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000

    def json(self, *arguments):
        return json.loads(self.run(*arguments, "--json")[0])

    def log(self, name):
        path = self.data / "slam2d" / f"{name}.clf.gz"
        if not path.exists():
            sys.exit(f"benchmarks.py: there is no {path}; give --data the folder with slam2d/")
        return path

    def mapped(self, name, *words):
        """report.json of a public log's map by one thread, CPU seconds, megabytes, and its errors by the relations; run once."""
        key = (name, *words)
        if key not in self.maps:
            log, folder = self.log(LOGS[name]), self.folder / "run"
            text, cpu_s, megabytes = self.run("map", log, "-o", folder, "--threads", 1, "--json", *words)
            errors = self.json("evaluate", folder / "trajectory.tum", "--relations", self.data / "slam2d" / f"{LOGS[name]}.relations.gz")
            self.maps[key] = json.loads(text), cpu_s, megabytes, errors
        return self.maps[key]

    def table_results(self):
        """The one of README.md."""
        rows = []
        for name in LOGS:
            report, cpu_s, _, errors = self.mapped(name, "--no-loops")
            closed = self.mapped(name)[3]["all"]
            alone, cartographer = errors["all"], CARTOGRAPHER[name].split()
            rows.append([f"{name}, {report['scans']:,} scans",
                         f"**{closed['translation_m']['mean']:.3f} m, {closed['rotation_deg']['mean']:.2f}°**",
                         f"{alone['translation_m']['mean']:.3f} m, {alone['rotation_deg']['mean']:.2f}°",
                         f"{float(cartographer[0]):.3f} m, {float(cartographer[4]):.2f}°", f"{cpu_s:.1f} s",
                         f"{report['scans_per_core_s']:,.0f}"])
        return table(["log", "gdtslam", "`--no-loops`", "Cartographer, published, with loop closure",
                      "CPU time, whole command, `--no-loops`", "scans per core-second, mapper, `--no-loops`"], rows)

    def table_accuracy(self):
        rows = []
        for name in LOGS:
            for words in (("--no-loops",), ()):
                report, _, _, errors = self.mapped(name, *words)
                metres, degrees = errors["all"]["translation_m"], errors["all"]["rotation_deg"]
                parts = [f"{errors[part]['translation_m']['mean']:.4f} m, {errors[part]['rotation_deg']['mean']:.3f}°"
                         for part in ("short", "loops")]
                rows.append([name + (", `--no-loops`" if words else ""),
                             f"**{metres['mean']:.4f} ± {metres['std']:.4f} m, {degrees['mean']:.3f} ± {degrees['std']:.3f}°**",
                             CARTOGRAPHER[name], *parts, f"{metres['max']:.3f} m", f"{report['doubtful']:,}"])
        return table(["log", "gdtslam", "Cartographer, published, with loop closure", "short", "loops", "largest", "doubtful scans"], rows)

    def table_exhaustive(self):
        rows = []
        for name in LOGS:
            for matcher in ("simplex-newton", "exhaustive"):
                words = ("--no-loops",) + (() if matcher == "simplex-newton" else ("--matcher", matcher))
                report, _, _, errors = self.mapped(name, *words)
                error = f"{errors['all']['translation_m']['mean']:.4f} m, {errors['all']['rotation_deg']['mean']:.3f}°"
                rows.append([name, f"`{matcher}`", error, f"{report['scans_per_core_s']:,.0f}", f"{report['windows']:,}",
                             f"{report['keyframes']:,}"])
        return table(["log", "matcher", "mean error", "scans a core-second, mapper", "windows", "keyframes"], rows)

    def table_runs(self):
        rows = []
        runs = {}
        for name in LOGS:
            for words in (("--no-loops",), ()):
                runs[name, words] = self.mapped(name, *words)[:3]
        log = self.folder / "office-7f.log"
        self.run("simulate", "office-7f", "-o", log, "--seed", 1, "-q")
        for words in (("--no-loops",), ()):
            text, cpu_s, megabytes = self.run("map", log, "-o", self.folder / "run", "--threads", 1, "--json", *words)
            runs["office-7f, 3D", words] = json.loads(text), cpu_s, megabytes
        for (name, words), (report, cpu_s, megabytes) in runs.items():
            stages = report["stages"]
            known = [stages.get(stage, 0.0) for stage in STAGES]
            rows.append([name + (", `--no-loops`" if words else ""), f"{report['scans']:,}", f"{cpu_s:.2f} s", f"{megabytes:.0f} MB",
                         f"{report['scans_per_core_s']:,.0f}", *(f"{seconds:.2f} s" for seconds in known),
                         f"{sum(stages.values()) - sum(known):.2f} s"])
        return table(["log", "scans", "CPU", "memory", "scans a core-second, mapper", "read", "match", "mapper, other", "loops",
                      "all other stages"], rows)

    def table_live(self):
        rows = []
        for name, stem in LOGS.items():
            for words in (("--speed", 100), ("--no-loops", "--speed", 0)):
                live = self.json("bench", "live", "--log", self.log(stem), *words)
                times = [live["median_s"], live["p99_s"], live["p999_s"], live["largest"]["all_s"], live["cpu"]["p999_s"],
                         live["cpu"]["largest_s"]]
                row = [name + (", `--no-loops`" if "--no-loops" in words else ""), *(f"{1e3 * seconds:.2f} ms" for seconds in times),
                       str(live["above_50_ms"] or "none")]
                loops = live["loops"]
                rows.append(row + (["", "", ""] if loops is None else
                                   [str(loops["corrections"]), f"{loops['waits']} times" if loops["waits"] else "never",
                                    f"{loops['beside_cpu_s']:.1f} s"]))
        return table(["log", "median", "99 %", "99.9 %", "largest", "99.9 %, CPU", "largest, CPU", "above 50 ms", "corrections",
                      "waited for loops", "CPU beside"], rows)

    def table_kernels(self):
        rows = []
        for row in self.json("bench")["rows"]:
            if row["group"] in ("cloud", "viewer") or row["variant"].startswith("peer: "):
                continue
            share = next((f"{kind} {row[key]:.2f}" for kind, key in (("copy", "copy_ratio"), ("load", "load_ratio"))
                          if row[key] is not None), "")
            peer = f"{row['times_opencv']:.1f}" if row["times_opencv"] is not None and row["group"] != "peer" else ""
            rows.append([f"`{row['name']}`", row["variant"], time_text(row["cpu_s"]), f"{1e-9 * row['rate']:.3g} G {row['unit']}s/s",
                         share, peer])
        return table(["row", "case", "CPU time", "rate", "of limit", "times OpenCV"], rows)

    def table_isa(self):
        rows = {}
        for isa in ("baseline", "avx2", "avx512"):
            for what in ("pose_cost", "pose_simplex", "sweep"):
                for row in self.json("bench", what, "--isa", isa)["rows"]:
                    if row["group"] in ("kernel", "sweep"):
                        rows.setdefault((row["name"], row["variant"], row["unit"]), []).append(1e-6 * row["rate"])
        return table(["row", "case", "SSE2", "AVX2", "AVX-512"],
                     [[f"`{name}`", variant, *(f"{rate:.0f} M {unit}s/s" for rate in rates)]
                      for (name, variant, unit), rates in rows.items() if len(rates) == 3])

    def table_certified(self):
        rows = []
        for row in self.json("bench", "certified", "--log", self.log("intel"), "--lattice", "1 s")["windows"]:
            peer = row["lattice"]
            rows.append([f"Intel, ±{row['half_m']:g} m, {math.degrees(2.0 * row['half_rad']):.0f}°",
                         *(time_text(row[key]) for key in ("cpu_median_s", "cpu_p90_s", "cpu_most_s")),
                         f"{row['median_boxes']:,.0f}", f"{100.0 * row['proven_share']:.0f} %",
                         f"{time_text(peer['cpu_median_s'])} ({peer['scans']} scans)", f"{peer['times_certified']:,.0f} ×"])
        return table(["map, window", "median", "90 %", "largest", "boxes, median", "proven", "lattice", "ratio"], rows)

    def table_clouds(self):
        rows = self.json("bench", "clouds")["rows"]
        peers = {row["name"]: row for row in rows if row["variant"].startswith("peer: ")}
        made = []
        for row in rows:
            if row["group"] != "cloud":
                continue
            peer = peers[row["name"]]
            made.append([f"`{row['name']}`", row["variant"], time_text(row["cpu_s"]), f"{1e-6 * row['rate']:.0f} M points/s",
                         f"`{peer['variant'][len('peer: '):]}` {time_text(peer['cpu_s'])}", f"{peer['cpu_s'] / row['cpu_s']:.1f} ×"])
        return table(["row", "case", "CPU time", "rate", "comparison", "as fast"], made)

    def table_city(self):
        script = ROOT / "tools/scripts/experiments.py"
        process = subprocess.run([sys.executable, script, "city", self.program, "-o", self.folder / "city", *self.city], capture_output=True,
                                 text=True, check=False)
        if process.returncode not in (0, 1) or "|  | measured" not in process.stdout:
            sys.exit(f"benchmarks.py: {script}: exit {process.returncode}: {process.stderr.strip()}")
        live = json.loads((self.folder / "city/live.json").read_text())
        rows = [[f"{part['first']:,} to {part['first'] + part['scans'] - 1:,}", f"{part['keyframes']:,}",
                 time_text(part["keyframe_cpu_s"]), time_text(part["keyframe_merge_s"])] for part in live["parts"]]
        parts = table(["scans", "keyframes", "a keyframe, CPU", "of that local field and merge"], rows)
        return parts + "\n\n" + process.stdout[process.stdout.index("|  | measured"):].strip()

    def table_reading(self):
        rows = []
        for row in self.json("bench", "logs")["rows"]:
            mega = [f"{1e-6 * bytes_:.1f} MB" for bytes_ in (row["file_bytes"], row["bytes"])]
            rate = {key: f"{1e-6 * row['bytes'] / row[key]:,.0f} MB/s" for key in ("read_s", "cat_s", "alone_s")}
            name = row["format"] + ("" if row["packing"] == "none" else f", {row['packing']}")
            memory = "" if row["peak_bytes"] is None else f"{1e-6 * row['peak_bytes']:.0f} MB"
            rows.append([name, *mega, f"**{rate['read_s']}**", rate["cat_s"], f"{row['alone']} {rate['alone_s']}",
                         f"{row['times_alone']:.1f} ×", memory])
        return table(["format", "file", "unpacked", "read", "`cat`", "alone", "of that", "memory"], rows)

    def table_frames(self):
        rows = [[row["variant"] if row["name"] == "cloud_frame" else "linkage: " + row["variant"], time_text(row["cpu_s"]),
                 time_text(row["wall_s"])] for row in self.json("bench", "viewer")["rows"] if row["group"] == "viewer"]
        return table(["frame", "CPU time", "wall time"], rows)

    def machine(self):
        device = self.json("bench", "limit", "--samples", 1)["devices"][0]
        version = self.run("--version")[0].splitlines()[0]
        return f"{version}, {device['name']}, {device['isa']}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the end"

    def names(self):
        return [name[len("table_"):] for name in dir(self) if name.startswith("table_")]


def with_table(text, name, made):
    """The page with that table between its marks. Throws ValueError where there are none or several."""
    pattern = re.compile(rf"(<!-- made: {re.escape(name)} -->\n).*?(<!-- made -->\n)", re.DOTALL)
    if len(pattern.findall(text)) != 1:
        raise ValueError(f"the page has not one place '<!-- made: {name} -->' ... '<!-- made -->'")
    return pattern.sub(lambda place: f"{place[1]}\n{made}\n\n{place[2]}", text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="tables to make (default: all)")
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/gdtslam"), help="the command")
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("GDTSLAM_DATA", ROOT.parent / "shared/data"),
                        help="the folder with slam2d/")
    parser.add_argument("--page", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--write", action="store_true", help="write the tables into the page")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        benchmarks = Benchmarks(options.program, pathlib.Path(options.data), pathlib.Path(folder))
        unknown = sorted(set(options.names) - set(benchmarks.names()))
        if unknown:
            parser.error(f"there is no table {unknown[0]}; there are {', '.join(benchmarks.names())}")
        for name in options.names or benchmarks.names():
            made = getattr(benchmarks, "table_" + name)() + "\n\nMade by `tools/scripts/benchmarks.py`: " + benchmarks.machine() + "."
            page = options.page or PAGES.get(name, PAGE)
            try:
                text = with_table(page.read_text(), name, made)
            except ValueError as error:
                sys.exit(f"benchmarks.py: {page}: {error}")
            if options.write:
                page.write_text(text)
            else:
                print(f"## {name}\n\n{made}\n")


if __name__ == "__main__":
    main()
