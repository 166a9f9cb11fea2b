"""The rows of `gdtslam-lab bench`, and the limits of the machine beside the kernels."""

import json

from cli_support import DATA, SOURCE, command, expect, expect_exit

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


def bench_rows():
    """A row of a kernel has its unit and its rate."""
    ((kernel, row),) = _rows("seed_scatter").items()
    expect(kernel[:2] == ("kernel", "seed_scatter") and row["label"] == "cell" and row["items_per_second"] > 0.0, f"{row}")


def bench_mistakes():
    """What cannot be measured ends with one line of why."""
    _fails(2, "no row's name matches 'no_such_kernel'", "no_such_kernel")
    _fails(2, "unexpected argument '--samples'", "gdt", "--samples")
    _fails(2, "are for a --log", "gdt", "--set", "map.resolution=5cm")
    _fails(65, "no_scan.log: holds no laser scan", "/live/", "--log", DATA / "no_scan.log")


def bench_live_adds_up():
    """The parts of a log hold each scan and keyframe once, with loops and without."""
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
