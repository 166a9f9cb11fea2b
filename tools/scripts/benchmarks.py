#!/usr/bin/env python3
"""Measures what docs/benchmarks.md shows in tables and writes them into the page.

  benchmarks.py [--program GDTSLAM] [--data FOLDER] [--write] [NAME...]

Without --write the tables are printed. A table stands in the page between the lines '<!-- made: NAME -->' and
'<!-- made -->'; what is said around it is written by hand. Without a NAME all are made, some five minutes of one core, best
while the machine does nothing else. The public logs are looked for in the folder slam2d of --data (default: GDTSLAM_DATA, else
../shared/data beside the clone). Two tables of one program tell how much is chance: run it twice.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/benchmarks.md"
LOGS = {"Intel": "intel", "Freiburg 079": "fr079", "MIT CSAIL": "mit-csail"}
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

    def table_runs(self):
        rows = []
        logs = {name: self.log(stem) for name, stem in LOGS.items()}
        logs["office-7f, 3D"] = self.folder / "office-7f.log"
        self.run("simulate", "office-7f", "-o", logs["office-7f, 3D"], "--seed", 1, "-q")
        for name, log in logs.items():
            for loops in ("--no-loops", None):
                text, cpu_s, megabytes = self.run("map", log, "-o", self.folder / "run", "--threads", 1, "--json",
                                                  *([loops] if loops else []))
                report = json.loads(text)
                stages = report["stages"]
                known = [stages.get(stage, 0.0) for stage in STAGES]
                rows.append([name + (f", `{loops}`" if loops else ""), f"{report['scans']:,}", f"{cpu_s:.2f} s",
                             f"{megabytes:.0f} MB", f"{report['scans_per_core_s']:,.0f}",
                             *(f"{seconds:.2f} s" for seconds in known), f"{sum(stages.values()) - sum(known):.2f} s"])
        return table(["log", "scans", "CPU", "memory", "scans a core-second, mapper", "read", "match", "mapper, other", "loops",
                      "all other stages"], rows)

    def table_live(self):
        rows = []
        for name, stem in LOGS.items():
            for words in ((), ("--no-loops", "--speed", 0)):
                live = self.json("bench", "live", "--log", self.log(stem), *words)
                times = [live["median_s"], live["p99_s"], live["p999_s"], live["largest"]["all_s"], live["cpu"]["p999_s"],
                         live["cpu"]["largest_s"]]
                row = [name + (", `--no-loops`" if words else ""), *(f"{1e3 * seconds:.2f} ms" for seconds in times),
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
            if row["group"] in ("cloud", "viewer"):
                continue
            share = next((f"{kind} {row[key]:.2f}" for kind, key in (("copy", "copy_ratio"), ("load", "load_ratio"))
                          if row[key] is not None), "")
            peer = f"{row['times_opencv']:.1f}" if row["times_opencv"] is not None and row["group"] != "peer" else ""
            rows.append([f"`{row['name']}`", row["variant"], time_text(row["cpu_s"]), f"{1e-9 * row['rate']:.3g} G {row['unit']}s/s",
                         share, peer])
        return table(["row", "case", "CPU time", "rate", "of limit", "times OpenCV"], rows)

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
        version = self.run("--version")[0].strip()
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
    parser.add_argument("--page", type=pathlib.Path, default=PAGE, help=argparse.SUPPRESS)
    parser.add_argument("--write", action="store_true", help="write the tables into the page")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        benchmarks = Benchmarks(options.program, pathlib.Path(options.data), pathlib.Path(folder))
        unknown = sorted(set(options.names) - set(benchmarks.names()))
        if unknown:
            parser.error(f"there is no table {unknown[0]}; there are {', '.join(benchmarks.names())}")
        text = options.page.read_text()
        for name in options.names or benchmarks.names():
            made = getattr(benchmarks, "table_" + name)() + "\n\nMade by `tools/scripts/benchmarks.py`: " + benchmarks.machine() + "."
            try:
                text = with_table(text, name, made)
            except ValueError as error:
                sys.exit(f"benchmarks.py: {options.page}: {error}")
            if options.write:
                options.page.write_text(text)
            else:
                print(f"## {name}\n\n{made}\n")


if __name__ == "__main__":
    main()
