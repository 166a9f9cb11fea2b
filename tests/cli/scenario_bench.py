"""Runs of `bench` held against each other, and the limits of the machine beside the kernels."""

import json
import subprocess
import sys

from cli_support import (IS_SANITIZED, PROGRAM, SOURCE, command, expect, expect_exit, fresh_folder, one_error_line,
                         require_vulkan, skip, validate)


def _bench(*arguments):
    process = command("bench", "smallest_values", "--samples", 5, "--json", *arguments)
    expect_exit(process, 0)
    validate(process.stdout, "bench")
    return json.loads(process.stdout)


def bench_limits():
    """The machine's limits stand before the kernels, slower with each larger table; kernels have their share of one."""
    if IS_SANITIZED:
        skip("a sanitized program looks at every access, which hides the caches")
    rows = json.loads(command("bench", "pose_cost", "--samples", 5, "--json").stdout)["rows"]
    limits = [row for row in rows if row["group"] == "limit"]
    expect(rows[: len(limits)] == limits and len(limits) in (6, 9), f"{[row['name'] for row in rows]}")
    for name in ("copy", "load"):
        rates = [row["rate"] for row in limits if row["name"] == name]
        expect(len(rates) == 3 and rates[0] > 3.0 * rates[2] > 0.0, f"{name}: {rates}")
    most = max(row["rate"] for row in limits if row["unit"] == "load")
    for row in rows[len(limits):]:
        expect(abs(row["load_ratio"] - row["rate"] / most) < 1e-9, f"{row}")


def bench_live_adds_up():
    """The parts of a log hold each scan and keyframe once, with loops and without; the worst scans are in order; a city that a
    script makes is driven through all its streets."""
    for loops in ((), ("--no-loops",)):
        process = command("bench", "live", "--speed", 0, "--json", *loops)
        expect_exit(process, 0)
        validate(process.stdout, "bench_live")
        live = json.loads(process.stdout)
        parts = live["parts"]
        expect([part["first"] for part in parts] == [sum(p["scans"] for p in parts[:k]) for k in range(len(parts))], f"{parts}")
        expect(sum(part["scans"] for part in parts) == live["scans"] == 350, f"{parts}")
        expect(sum(part["keyframes"] for part in parts) == live["keyframes"] > 0, f"{parts}")
        cpu_s = sum(part["keyframes"] * part["keyframe_cpu_s"] + (part["scans"] - part["keyframes"]) * part["scan_cpu_s"]
                    for part in parts)
        expect(0.5 * live["scans"] * live["cpu"]["median_s"] < cpu_s < 1.5 * live["lasted_s"], f"{cpu_s}: {live}")
        worst = [scan["cpu_s"] for scan in live["worst"]]
        expect(len(worst) == 10 and worst == sorted(worst, reverse=True) and worst[0] == live["cpu"]["largest_s"], f"{worst}")
        expect(live["largest"]["all_s"] >= live["p999_s"] >= live["median_s"] > 0.0, f"{live}")
        expect((live["loops"] is None) == bool(loops), f"{live['loops']}")
        expect(live["peak_bytes"] < 1e9, f"{live['peak_bytes']}")


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


def bench_against():
    """An earlier run made twice as slow by hand is beaten twofold; rows of one side are named; --fail-below asks the kernels
    alone, one at least; files that are none are refused."""
    folder = fresh_folder("bench_against")
    before = _bench()
    (folder / "before.json").write_text(json.dumps(before))
    again = _bench("--against", folder / "before.json", "--fail-below", 0.01)["against"]
    expect(again["only_before"] == [] and again["only_now"] == [] and len(again["rows"]) == len(before["rows"]), f"{again}")
    kernel = next(row for row in before["rows"] if row["group"] == "kernel")
    kernel["samples_s"] = [1000.0 * sample for sample in kernel["samples_s"]]
    gone = dict(kernel, name="of_old")
    before["rows"] = [kernel, gone]
    (folder / "slow.json").write_text(json.dumps(before))
    against = _bench("--against", folder / "slow.json", "--fail-below", 100)["against"]
    (row,) = against["rows"]
    expect(row["name"] == "smallest_values" and row["least"] <= row["times_as_fast"] <= row["most"], f"{row}")
    expect(200.0 < row["times_as_fast"] < 5000.0 and row["confidence"] >= 0.95, f"{row}")
    expect([name["name"] for name in against["only_before"]] == ["of_old"], f"{against['only_before']}")
    expect({name["group"] for name in against["only_now"]} == {"limit"}, f"{against['only_now']}")

    other = dict(before, devices=[dict(before["devices"][0], name="Another processor")], rows=[dict(kernel, basis="wall")])
    (folder / "other_basis.json").write_text(json.dumps(other))
    process = command("bench", "smallest_values", "--samples", 5, "--against", folder / "other_basis.json")
    expect_exit(process, 0)
    expect("only in that run: cpu kernel smallest_values" in process.stdout, process.stdout)
    expect("cpu was Another processor" in process.stderr and len(process.stderr.splitlines()) == 1, process.stderr)

    kernel["samples_s"] = [1e-6 * sample for sample in kernel["samples_s"]]
    (folder / "fast.json").write_text(json.dumps(before))
    process = command("bench", "smallest_values", "--samples", 5, "--against", folder / "fast.json", "--fail-below", 0.9)
    expect_exit(process, 1)
    one_error_line(process.stderr)
    expect("1 of 1 rows are less than 0.9 times as fast" in process.stderr and "smallest_values" in process.stderr, process.stderr)
    expect("only in that run: cpu kernel of_old" in process.stdout, process.stdout)

    before["rows"] = [gone]
    (folder / "other.json").write_text(json.dumps(before))
    process = command("bench", "smallest_values", "--samples", 5, "--against", folder / "other.json", "--fail-below", 0.9)
    expect_exit(process, 1)
    one_error_line(process.stderr)
    expect("nothing was compared" in process.stderr and "other.json" in process.stderr, process.stderr)

    for text, words in (("{}", "has no text 'version'"), ("[1", "no JSON"), ('{"version": "1"}', "has no rows"), ("[]", "is no object"),
                        ('{"version": "1", "rows": [{"on": "cpu"}]}', "has no text 'group'"),
                        (json.dumps({"version": "1", "rows": [dict(kernel, samples_s=[])]}), "samples_s in a row"),
                        (json.dumps({"version": "1", "rows": [dict(kernel, samples_s=[0])]}), "no time above 0"),
                        (json.dumps({"version": "1", "rows": [kernel]}), "has no devices"),
                        (json.dumps({"version": "1", "rows": [kernel], "devices": [{"device": "cpu"}]}), "has no text 'name'")):
        (folder / "bad.json").write_text(text)
        process = command("bench", "smallest_values", "--against", folder / "bad.json")
        expect_exit(process, 65)
        one_error_line(process.stderr)
        expect(words in process.stderr and "bench --json" in process.stderr, process.stderr)


def bench_of_too_large_a_size():
    """A square that the device has no buffers for is refused before anything is measured, with the largest one that fits."""
    device = require_vulkan()[0]
    most = device["limits"]["storage_buffer_bytes"]
    if 4 * 8192 * 8192 <= most:
        skip("the device's buffers are large enough for every size")
    for arguments in (("transform",), ("--flood-errors",)):
        process = command("bench", *arguments, "--size", 8192, "--device", device["device"])
        expect_exit(process, 2)
        one_error_line(process.stderr)
        largest = int(process.stderr.split(" or less")[0].split()[-1])
        expect(4 * largest * largest <= most < 4 * (largest + 1) * (largest + 4), process.stderr)
