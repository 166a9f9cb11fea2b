#!/usr/bin/env python3
"""What an hour of a robot costs by beams and scan rate: `fleet_sizing.py PROGRAM -o FOLDER [--laps N] [--robots N] [--write]`.

For each of three lasers and four rates, a drive through the sample office is simulated and mapped by one thread, as
`gdtslam fleet` maps it: CPU seconds, memory, and bytes read, written and kept, all for an hour of the robot. One drive of
one laser at 10 Hz goes on for --long-laps, to show what grows. Then what a year of --robots robots costs, from those two,
with the arithmetic. Tables as Markdown; --write puts them into docs/benchmarks.md. FOLDER keeps the figures, and what it
has is not made again. Some six minutes of CPU time at first."""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/scripts"))

from benchmarks import with_table  # noqa: E402

LASERS = (("sick-lms", 180), ("sick-361", 361), ("hokuyo-961", 961))
RATES_HZ = (5, 10, 20, 40)
MIDDLE = ("sick-361", 10)
# What a merge, tiles, localize and doctor need once the log has been mapped.
KEPT = ("keyframes.bin.gz", "graph.g2o", "covariance.csv", "trajectory.tum", "config.yaml", "report.json")
TABLES = ("fleet", "fleet-year")  # of docs/benchmarks.md
WAY_BACK = ["  - [5.1, 6.1]"]  # from the end of a lap to its beginning
HOURS_A_DAY = 8
DAYS_A_YEAR = 365


def run(*command):
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)


def trajectory(laps):
    lines = (ROOT / "assets/scenes/office-loop.yaml").read_text().partition("\nwaypoints:\n")[2].splitlines()
    lap = [line for line in lines if line.lstrip().startswith("-")]
    return "\n".join(["gdtslam_trajectory: 1", "waypoints:", *lap, *((WAY_BACK + lap) * (laps - 1))]) + "\n"


def duration_h(log):
    """Of the truth beside a log: from its first to its last row."""
    rows = [line for line in log.with_suffix(".truth.tum").read_text().splitlines() if line and line[0] != "#"]
    return (float(rows[-1].split()[0]) - float(rows[0].split()[0])) / 3600.0


def measured(program, folder, laser, rate_hz, laps):
    """Figures of one drive, in a file of FOLDER."""
    kept = folder / f"{laser}-{rate_hz}-{laps}.json"
    if kept.exists():
        return json.loads(kept.read_text())
    path, log, plain, out = (folder / f"{laps}.yaml", folder / "drive.mcap", folder / "plain.mcap", folder / "run")
    path.write_text(trajectory(laps))
    run(program, "simulate", "office-loop", "-o", log, "--laser", laser, "--rate", rate_hz, "--trajectory", path, "--force", "--quiet")
    run(program, "convert", log, "-o", plain, "--compression", "none", "--force", "--quiet")
    mapping = subprocess.Popen([program, "map", log, "-o", out, "--force", "--device", "cpu", "--threads", "1", "--quiet"])
    _, status, usage = os.wait4(mapping.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"fleet_sizing.py: mapping {log} ended with {os.waitstatus_to_exitcode(status)}")
    report = json.loads((out / "report.json").read_text())
    sizes = {file.name: file.stat().st_size for file in out.iterdir()}
    figures = {"hours": duration_h(log), "scans": report["scans"], "keyframes": report["keyframes"],
               "cpu_s": usage.ru_utime + usage.ru_stime, "memory_mb": 1024.0 * usage.ru_maxrss / 1e6,
               "plain_bytes": plain.stat().st_size, "packed_bytes": log.stat().st_size, "written_bytes": sum(sizes.values()),
               "kept_bytes": sum(sizes.get(name, 0) for name in KEPT)}
    kept.write_text(json.dumps(figures))
    for file in (log, plain, *out.iterdir()):
        file.unlink()
    return figures


def hourly(figures):
    """The same for an hour of the robot; memory is not summed."""
    rates = {name: figures[name] / figures["hours"] for name in figures if name not in ("hours", "memory_mb")}
    return {**rates, "hours": figures["hours"], "memory_mb": figures["memory_mb"]}


def row(beams, rate_hz, figures):
    f = hourly(figures)
    return (f"| {beams} | {rate_hz} Hz | {f['hours']:.2f} h | {f['scans']:,.0f} | {f['cpu_s']:.0f} s | {f['memory_mb']:.0f} MB | "
            f"{f['plain_bytes'] / 1e6:.0f} MB | {f['packed_bytes'] / 1e6:.0f} MB | {f['written_bytes'] / 1e6:.1f} MB | "
            f"{f['kept_bytes'] / 1e6:.1f} MB |")


def sizing_table(rows):
    return "\n".join(["| beams | rate | drive | scans an hour | CPU time an hour | memory | read, as recorded | read, packed | "
                      "written | of that kept |", "|---|---|---|---|---|---|---|---|---|---|", *rows])


def year_table(robots, drives):
    """What robots * a year take, line by line with its arithmetic: a column for each kind of drive."""
    hours = robots * HOURS_A_DAY * DAYS_A_YEAR
    hourlies = [hourly(figures) for figures in drives]
    heads = " | ".join(f"in drives of {60 * figures['hours']:.0f} min" for figures in drives)
    lines = [f"| | | {heads} |", "|---|---" + "|---" * len(drives) + "|"]

    def add(what, sum_, value_of):
        lines.append(f"| {what} | {sum_} | " + " | ".join(value_of(f) for f in hourlies) + " |")

    core_hours = lambda f: hours * f["cpu_s"] / 3600.0
    add("robot-hours H", f"{robots} robots × {HOURS_A_DAY} h × {DAYS_A_YEAR} days", lambda f: f"{hours:,} h")
    add("CPU time an hour C", "from the table above", lambda f: f"{f['cpu_s']:.0f} s")
    add("computing", "H × C / 3,600", lambda f: f"{core_hours(f):,.0f} core-hours")
    add("on one machine of 16 cores", "H × C / 3,600 / 16 / 24", lambda f: f"{core_hours(f) / 16 / 24:.1f} days")
    add("on ten of them", "H × C / 3,600 / 160", lambda f: f"{core_hours(f) / 160:.0f} hours")
    for what, name in (("read, as recorded", "plain_bytes"), ("read, packed", "packed_bytes"), ("written", "written_bytes"),
                       ("of that kept", "kept_bytes")):
        add(what, "H × MB an hour", lambda f, name=name: f"{hours:,} × {f[name] / 1e6:.1f} MB = {hours * f[name] / 1e12:.1f} TB")
    add("one day of them on one machine of 16 cores", f"{robots} × {HOURS_A_DAY} × C / 16",
        lambda f: f"{robots * HOURS_A_DAY * f['cpu_s'] / 16 / 60:.0f} min")
    return "\n".join(lines)


def machine():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    name = re.search(r"model name\s*: (.*)", text)
    return f"{name[1] if name else 'unknown processor'}, {os.cpu_count()} cores"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--laps", type=int, default=3, help="of the office in a drive, some five minutes each")
    parser.add_argument("--long-laps", type=int, default=13, help="of the one long drive")
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--write", action="store_true", help="write the tables of docs/benchmarks.md")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    rows, drives = [], []
    for laser, beams in LASERS:
        for rate_hz in RATES_HZ:
            figures = measured(options.program, options.output, laser, rate_hz, options.laps)
            rows.append(row(beams, rate_hz, figures))
            if (laser, rate_hz) != MIDDLE:
                continue
            drives = [figures, measured(options.program, options.output, laser, rate_hz, options.long_laps)]
            rows.append(row(beams, rate_hz, drives[1]))
    version = subprocess.run([options.program, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    made = f"\n\nMade by `tools/scripts/fleet_sizing.py`: {version.splitlines()[0]}, {machine()}."
    page = ROOT / "docs/benchmarks.md"
    for name, text in zip(TABLES, (sizing_table(rows) + made, year_table(options.robots, drives) + made)):
        if options.write:
            page.write_text(with_table(page.read_text(), name, text))
        else:
            print(f"## {name}\n\n{text}\n")


if __name__ == "__main__":
    main()
