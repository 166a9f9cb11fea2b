#!/usr/bin/env python3
"""Memory and time against how far a robot drives, and against the area: `campus_figures.py PROGRAM -o FOLDER [--write]`.

A city of 2 km x 2 km (city.py) is driven through for 1, 5 and 20 km, and cities of other sizes for 12,000 scans each. Every
drive is mapped with `gdtslam map`, with loops and without. Tables as Markdown, and the plot of docs/benchmarks.md with
--write. FOLDER keeps logs and figures, and what it has is not made again. Some 15 minutes of CPU time at first."""

import argparse
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CAMPUS = ("--side", "1994", "--blocks", "4", "--scans", "60000")
SPACING_M = 23778.0 / 60704  # between scans of the campus
LENGTHS_KM = (1, 5, 20)
SIDES = ((125, 2), (250, 4), (500, 4), (1000, 4))  # metres, blocks
AREA_SCANS = 12000
MODES = (("with loops", ()), ("--no-loops", ("--no-loops",)))
COLOURS = {"with loops": "#c2410c", "--no-loops": "#1d4ed8"}


def made_log(program, folder, *words):
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([sys.executable, ROOT / "tools/scripts/city.py", program, "-o", folder, "--only-log", *words],
                   check=True, stdout=subprocess.DEVNULL)
    return folder / "city.log.gz"


def figures_of(program, log, scans, words, folder):
    """Most memory, and of report.json the CPU time and the length; kept in a file."""
    kept = folder.with_suffix(".json")
    if kept.exists():
        return json.loads(kept.read_text())
    process = subprocess.Popen([program, "map", log, "--first", str(scans), "-o", folder, "--no-copy", "--quiet", *words])
    _, status, usage = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"campus_figures.py: mapping {log} ended with {os.waitstatus_to_exitcode(status)}")
    report = json.loads((folder / "report.json").read_text())
    figures = {"scans": report["scans"], "path_km": report["path_m"] / 1000.0, "memory_mb": 1024.0 * usage.ru_maxrss / 1e6,
               "cpu_s": report["cpu_s"], "scan_ms": 1000.0 * report["cpu_s"] / report["scans"], "tiles": report.get("tiles", 0)}
    kept.write_text(json.dumps(figures))
    return figures


def row_of(first, mode, f):
    return (f"| {first} | {mode} | {f['scans']:,} | {f['memory_mb']:.0f} MB | {f['cpu_s']:.1f} s | {f['scan_ms']:.2f} ms | "
            f"{f['tiles'] or 'none'} |")


def panel(x, title, name, unit, series, values_of, most):
    """One of two plots beside each other: `series` has points (x value, label, figures) of each mode."""
    left, top, width, height = x + 66, 46, 292, 190
    points = next(iter(series.values()))
    far = points[-1][0]
    at = lambda value, figure: (left + width * value / far, top + height * (1.0 - figure / most))
    lines = [f'<text x="{left}" y="24" class="title">{title}</text>',
             f'<text x="{left + width}" y="{top + height + 36}" text-anchor="end">{name}</text>']
    for k in range(5):
        y = top + height * (1.0 - k / 4)
        lines.append(f'<path d="M{left} {y:.1f}h{width}" class="grid"/>'
                     f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{most * k / 4:g}{" " + unit if k == 4 else ""}</text>')
    for value, label, _ in points:
        lines.append(f'<text x="{at(value, 0)[0]:.1f}" y="{top + height + 18}" text-anchor="middle">{label}</text>')
    for mode, of_mode in series.items():
        places = [at(value, values_of(figures)) for value, _, figures in of_mode]
        path = " ".join(f"{px:.1f},{py:.1f}" for px, py in places)
        lines.append(f'<polyline points="{path}" fill="none" stroke="{COLOURS[mode]}" stroke-width="2"/>')
        lines += [f'<circle cx="{px:.1f}" cy="{py:.1f}" r="3.5" fill="{COLOURS[mode]}"/>' for px, py in places]
    return lines


def plot(lengths, areas):
    style = ("text{font:12px sans-serif;fill:#334155}.title{font-size:14px;font-weight:bold;fill:#0f172a}"
             ".grid{stroke:#cbd5e1;stroke-width:1}")
    memory = lambda figures: figures["memory_mb"]
    time = lambda figures: figures["scan_ms"]
    of_length = {mode: [(km, f"{km} km", lengths[km, mode]) for km in LENGTHS_KM] for mode, _ in MODES}
    of_area = {mode: [(side, f"{side}", areas[side, mode]) for side, _ in SIDES] for mode, _ in MODES}
    lines = panel(0, "Memory", "driven in a city of 2 km a side", "MB", of_length, memory, 1600)
    lines += panel(380, "CPU time a scan, all in", "driven", "ms", of_length, time, 8)
    lines += panel(760, "Memory, 4.7 km driven", "side of the city, m", "MB", of_area, memory, 1600)
    legend = ""
    for k, (mode, _) in enumerate(MODES):
        legend += f'<circle cx="{62 + 130 * k}" cy="306" r="4" fill="{COLOURS[mode]}"/><text x="{72 + 130 * k}" y="310">{mode}</text>'
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1140 324" width="1140" height="324"><style>{style}</style>'
            f'<rect width="1140" height="324" fill="#ffffff"/>{"".join(lines)}{legend}</svg>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--write", action="store_true", help="write the plot of docs/benchmarks.md")
    options = parser.parse_args()
    lengths, areas = {}, {}
    log = made_log(options.program, options.output / "campus", *CAMPUS)
    lines = ["| driven | | scans | memory | CPU time | a scan | tiles |", "|---|---|---|---|---|---|---|"]
    for km in LENGTHS_KM:
        for mode, words in MODES:
            folder = options.output / f"length_{km}_{len(words)}"
            lengths[km, mode] = figures_of(options.program, log, round(1000 * km / SPACING_M), words, folder)
            lines.append(row_of(f"{km} km", mode, lengths[km, mode]))
    lines += ["", "| side | | scans | memory | CPU time | a scan | tiles |", "|---|---|---|---|---|---|---|"]
    for side, blocks in SIDES:
        log = made_log(options.program, options.output / f"side_{side}", "--side", str(side), "--blocks", str(blocks),
                       "--scans", str(AREA_SCANS))
        for mode, words in MODES:
            folder = options.output / f"area_{side}_{len(words)}"
            areas[side, mode] = figures_of(options.program, log, AREA_SCANS, words, folder)
            lines.append(row_of(f"{side} m", mode, areas[side, mode]))
    print("\n".join(lines))
    if options.write:
        (ROOT / "docs/images/campus.svg").write_text(plot(lengths, areas))


if __name__ == "__main__":
    main()
