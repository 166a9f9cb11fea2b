#!/usr/bin/env python3
"""Measures what docs/benchmarks.md and README.md show in tables and writes them into the pages.

  benchmarks.py [--program GDTSLAM] [--data FOLDER] [--write] [NAME...]

gdtslam-lab is looked for beside the program.

Without --write the tables are printed. A table stands in the page between the lines '<!-- made: NAME -->' and
'<!-- made -->'; what is said around it is written by hand. Without a NAME all are made, some three minutes, best
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


class Row:
    """A row of `gdtslam-lab bench`: the median of its repetitions."""

    def __init__(self, entry):
        self.on, self.group, self.name, self.variant = entry["run_name"].split("/")[:4]
        scale = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[entry["time_unit"]]
        self.wall_s, self.cpu_s = scale * entry["real_time"], scale * entry["cpu_time"]
        self.unit, self.rate, self.counters = entry.get("label"), entry.get("items_per_second"), entry


def rows_of(report):
    """The rows of google-benchmark's JSON; of repeated ones the medians."""
    entries = [entry for entry in report["benchmarks"] if entry.get("aggregate_name", "median") == "median"]
    repeated = {entry["run_name"] for entry in entries if "aggregate_name" in entry}
    return [Row(entry) for entry in entries if "aggregate_name" in entry or entry["run_name"] not in repeated]


def share_of_limit(row, rows):
    """What a row has of what the machine does at most: the time of a copy of as many bytes, by the rate of the copy next to it
    in size, or its look-ups over the most loads a second."""
    limits = [limit for limit in rows if limit.group == "limit" and limit.on == row.on]
    if row.unit == "look-up":
        most = max((limit.rate for limit in limits if limit.unit == "load"), default=None)
        return f"load {row.rate / most:.2f}" if most else ""
    if "bytes" not in row.counters or row.group != "kernel":
        return ""
    traffic = row.counters["bytes"]
    copies = [limit for limit in limits if limit.name == "copy"]
    copy = min(copies, key=lambda limit: abs(math.log(limit.rate * limit.cpu_s / traffic)))
    return f"copy {traffic / copy.rate / row.cpu_s:.2f}"


class Benchmarks:
    """Each method whose name begins with table_ makes one."""

    def __init__(self, program, data, folder):
        self.program, self.data, self.folder = program, data, folder
        self.maps = {}

    def run(self, *arguments, program=None):
        """What the command prints, with its CPU seconds and the most memory in MB that it had."""
        program = program or self.program
        with tempfile.TemporaryFile() as output:
            process = subprocess.Popen([program, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=output,
                                       stderr=subprocess.PIPE)
            said = process.stderr.read().decode(errors="replace").strip()
            _, status, usage = os.wait4(process.pid, 0)
            code = process.returncode = os.waitstatus_to_exitcode(status)
            if code != 0:
                sys.exit(f"benchmarks.py: {program} {' '.join(map(str, arguments))}: exit {code}: {said}")
            output.seek(0)
            return output.read().decode(), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000

    def json(self, *arguments):
        return json.loads(self.run(*arguments, "--json")[0])

    def report(self, *arguments, repeats=7):
        """What `gdtslam-lab bench` measures."""
        repeated = (f"--benchmark_repetitions={repeats}", "--benchmark_min_time=0.02") if repeats > 1 else ()
        lab = pathlib.Path(self.program).with_name("gdtslam-lab")
        return json.loads(self.run("bench", *arguments, "--benchmark_format=json", *repeated, program=lab)[0])

    def rows(self, *arguments, repeats=7):
        return rows_of(self.report(*arguments, repeats=repeats))

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
            text, cpu_s, megabytes = self.run("map", log, "-o", folder, "--force", "--threads", 1, "--json", *words)
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
            for matcher in ("gauss-newton", "exhaustive"):
                words = ("--no-loops",) + (() if matcher == "gauss-newton" else ("--matcher", matcher))
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
            text, cpu_s, megabytes = self.run("map", log, "-o", self.folder / "run", "--force", "--threads", 1, "--json", *words)
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
                live = self.rows("/live/", "--log", self.log(stem), *words, repeats=1)[0].counters
                times = [live[key] for key in ("median_s", "p99_s", "p999_s", "largest_s", "cpu_p999_s", "cpu_largest_s")]
                row = [name + (", `--no-loops`" if "--no-loops" in words else ""), *(f"{1e3 * seconds:.2f} ms" for seconds in times),
                       str(int(live["above_50_ms"]) or "none")]
                rows.append(row + (["", "", ""] if "corrections" not in live else
                                   [f"{live['corrections']:.0f}", f"{live['waits']:.0f} times" if live["waits"] else "never",
                                    f"{live['beside_cpu_s']:.1f} s"]))
        return table(["log", "median", "99 %", "99.9 %", "largest", "99.9 %, CPU", "largest, CPU", "above 50 ms", "corrections",
                      "waited for loops", "CPU beside"], rows)

    def table_kernels(self):
        measured = self.rows("/(limit|kernel|scan|sweep)/")
        rows = [[f"`{row.name}`", row.variant, time_text(row.cpu_s), f"{1e-9 * row.rate:.3g} G {row.unit}s/s", share_of_limit(row, measured)]
                for row in measured]
        return table(["row", "case", "CPU time", "rate", "of limit"], rows)

    def machine(self):
        device = self.report("/limit/copy/16 KiB", repeats=1)["context"]["cpu"]
        version = self.run("--version")[0].splitlines()[0]
        return f"{version}, {device}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the end"

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
