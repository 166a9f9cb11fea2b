"""The rows of `gdtslam-lab bench`, and the limits of the machine beside the kernels."""

import json
import subprocess
import sys

from cli_support import (DATA, IS_SANITIZED, LOG, PROGRAM, SOURCE, command, expect, expect_exit, fresh_folder,
                         skip)

SAMPLE = SOURCE / "assets/logs/office-start.log.gz"
QUICK = ("--benchmark_format=json", "--benchmark_min_time=0.01")


def _rows(*arguments):
    """By name and variant, or by the variant of the groups that have several names of one variant."""
    process = command("bench", *arguments, *QUICK, timeout=250)
    expect_exit(process, 0)
    expect(process.stderr == "" or "DEBUG" in process.stderr, process.stderr)
    return {tuple(entry["run_name"].split("/")[1:4]): entry for entry in json.loads(process.stdout)["benchmarks"]}


def _fails(exit_code, words, *arguments):
    process = command("bench", *arguments)
    expect_exit(process, exit_code)
    errors = [line for line in process.stderr.splitlines() if line.startswith("gdtslam: error: ")]
    expect(len(errors) == 1 and words in errors[0], process.stderr)


def bench_limits():
    """The machine's limits are slower with each larger table."""
    if IS_SANITIZED:
        skip("a sanitized program looks at every access, which hides the caches")
    rows = _rows("/limit/")
    for name in ("copy", "load"):
        rates = [row["items_per_second"] for (_, of, _), row in rows.items() if of == name]
        expect(len(rates) == (6 if name == "copy" else 3) and rates[0] > 3.0 * rates[-1] > 0.0, f"{name}: {rates}")


def bench_rows():
    """Rows of each group: what they count fits what is known, and peers stand beside what they are compared with."""
    ((kernel, row),) = _rows("smallest_values").items()
    expect(kernel[:2] == ("kernel", "smallest_values") and row["label"] == "value" and row["items_per_second"] > 0.0, f"{row}")
    logs = _rows("/log/", "--megabytes", 0.2)
    expect(len(logs) == 21 and all(row["bytes_per_second"] > 0.0 for row in logs.values()), f"{logs}")
    expect(logs["log", "read", "CARMEN, gzip"]["bytes"] == logs["log", "read", "CARMEN, none"]["bytes"], f"{logs}")
    certified = _rows("/certified/(search/.*40 deg|prepare)", "--log", SAMPLE)
    search = certified["certified", "search", "+-1 m, 40 deg"]
    expect(search["iterations"] == 100 and search["proven_share"] == search["known_share"] == 1.0, f"{search}")
    expect(certified["certified", "prepare", "map"]["map_bytes"] > 0, f"{certified}")


def bench_mistakes():
    """What cannot be measured ends with one line of why."""
    _fails(2, "no row's name matches 'no_such_kernel'", "no_such_kernel")
    _fails(2, "unexpected argument '--samples'", "gdt", "--samples")
    _fails(2, "are for a --log", "gdt", "--set", "map.resolution=5cm")
    _fails(2, "are for a --log", "live", "--no-loops")
    _fails(2, "are for a --log", "live", "--topic", "/scan")
    _fails(2, "--speed", "live", "--speed", "-1")
    _fails(2, "--megabytes", "log", "--megabytes", 0)
    _fails(78, "map.resolution", "live", "--log", LOG, "--set", "map.resolution=0m")
    for rows in ("/live/", "/certified/prepare"):
        _fails(74, "none.log", rows, "--log", "none.log")
        _fails(65, "no_scan.log: holds no laser scan", rows, "--log", DATA / "no_scan.log")
    _fails(2, "has no topics: leave out --topic", "/live/", "--log", LOG, "--topic", "/scan")


def bench_live_adds_up():
    """The parts of a log hold each scan and keyframe once, with loops and without; a city that a script makes is driven through
    all its streets."""
    for loops in ((), ("--no-loops",)):
        (live,) = _rows("/live/", "--log", SAMPLE, "--speed", 0, *loops).values()
        parts = [{key: live[f"part{number}_{key}"] for key in ("first", "scans", "keyframes", "keyframe_cpu_s")} for number in range(10)]
        expect([part["first"] for part in parts] == [sum(p["scans"] for p in parts[:k]) for k in range(len(parts))], f"{parts}")
        expect(sum(part["scans"] for part in parts) == live["scans"] == 350, f"{parts}")
        expect(sum(part["keyframes"] for part in parts) == live["keyframes"] > 0, f"{parts}")
        cpu_s = sum(part["keyframes"] * part["keyframe_cpu_s"] for part in parts)
        expect(0.0 < cpu_s < 1.5e-6 * live["real_time"], f"{cpu_s}: {live}")
        expect(live["largest_s"] >= live["p999_s"] >= live["median_s"] > 0.0, f"{live}")
        expect(("corrections" in live) == (not loops), f"{live}")


def city_of_a_script():
    """What `experiments.py city` writes is a scene that can be driven, with as many scans as asked for, and a map without doubt."""
    folder = fresh_folder("city")
    script = SOURCE / "tools/scripts/experiments.py"
    words = [sys.executable, "-B", script, "city", PROGRAM, "-o", folder, "--side", "130", "--blocks", "2", "--scans", "200",
             "--set", "map.resolution=10cm"]
    made = subprocess.run(words, capture_output=True, text=True, check=False)
    expect(made.returncode in (0, 1) and "| memory, bytes |" in made.stdout and made.stderr == "", made.stdout + made.stderr)
    truth = [line.split() for line in (folder / "city.truth.tum").read_text().splitlines() if line[0] != "#"]
    expect(200 <= len(truth) < 300, f"{len(truth)} scans")
    seen = {(round(float(word[1]) / 58 * 2), round(float(word[2]) / 58 * 2)) for word in truth}
    streets = {(x, y) for x in range(5) for y in range(5) if (x + y) % 2 == 1}  # the middles of all streets between crossings
    expect(streets <= seen, f"not driven: {sorted(streets - seen)}")
