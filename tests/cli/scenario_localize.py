"""Scans found in a map: against the simulator's truth, by symmetry, faults of maps, logs and references, interrupts."""

import json
import math
import re
import shutil
import signal
import subprocess
import time
import xml.etree.ElementTree as ElementTree

import cli_support as cli
from cli_support import DATA, LOG, PROGRAM, RUN, TRUTH, command, expect, expect_exit, finish, fresh_folder, one_error_line

POSES = RUN / "trajectory.tum"


def localized(*arguments, run=RUN, log=LOG, **options):
    """Localises; returns the JSON report, checked against its table."""
    process = command("localize", run, log, "--json", *arguments, **options)
    expect_exit(process, 0)
    cli.validate(process.stdout, "localize")
    return json.loads(process.stdout)


def poses_of(path):
    """(stamp, x, y, theta) of each row."""
    rows = [list(map(float, line.split())) for line in path.read_text().splitlines() if line[0] != "#"]
    return [(row[0], row[1], row[2], 2.0 * math.atan2(row[6], row[7])) for row in rows]


def turned(a, b):
    return abs((a - b + math.pi) % (2.0 * math.pi) - math.pi)


def without_times(report):
    return {key: value for key, value in report.items() if key != "times"}


def wilson(count, of, z=1.959963984540054):
    """[Wilson1927], from the textbook's form."""
    share = count / of
    centre = share + z * z / (2 * of)
    half = z * math.sqrt(share * (1 - share) / of + z * z / (4 * of * of))
    return (centre - half) / (1 + z * z / of), (centre + half) / (1 + z * z / of)


def judged(table, *arguments):
    """What `evaluate` says of a table, checked against its own."""
    process = command("evaluate", table, "--json", *arguments)
    expect_exit(process, 0)
    cli.validate(process.stdout, "evaluate_poses")
    return json.loads(process.stdout)


def localize_finds_the_simulated_poses():
    """Scans lie where the simulator took them, as this file's own arithmetic and `evaluate` say; what the run merged can be left
    out."""
    folder = fresh_folder("localize")
    report = localized("--every", 10, "-o", folder / "found.tum", "--table", folder / "found.csv", "--picture", folder / "found.svg")
    scans, fit = report["scans"], report["good_fit"]
    expect(report["verdicts"]["no-pose"] == 0 and report["certified"] == len(scans), f"{report['verdicts']}, {report['certified']}")
    expect(0.005 < fit["usual_m"] < 0.025 and fit["distance_m"] == 0.05 and fit["from"] == "resolution", f"two cells: {fit}")
    expect(report["verdicts"]["poor-fit"] <= len(scans) // 20, f"of the mapped building: {report['verdicts']}")
    for scan in scans:
        is_poor = scan["best"]["mean_distance_m"] > fit["distance_m"]
        expect(scan["verdict"] == ("poor-fit" if is_poor else "ambiguous" if scan["ambiguous"] else "found"), f"{scan}")
    counts = [sum(scan["verdict"] == verdict for scan in scans) for verdict in report["verdicts"]]
    expect(counts == list(report["verdicts"].values()), f"{counts}, {report['verdicts']}")
    # Against the run's own poses, which share the map's frame, without any code of ours.
    poses = poses_of(POSES)
    for scan in scans:
        stamp, x, y, theta = poses[scan["scan"]]
        found = scan["best"]
        expect(abs(stamp - scan["stamp_s"]) < 1e-6, f"stamp of scan {scan['scan']}")
        off = math.hypot(found["x_m"] - x, found["y_m"] - y)
        expect(off < 0.15 and turned(found["theta_rad"], theta) < math.radians(2.0), f"{off} m off: {scan}")
    written = poses_of(folder / "found.tum")
    expect(len(written) == len(scans), f"{len(written)} rows")
    for row, scan in zip(written, scans):
        expect(abs(row[1] - scan["best"]["x_m"]) < 1e-8 and turned(row[3], scan["best"]["theta_rad"]) < 1e-8, f"{row}")
    words = "".join(ElementTree.parse(folder / "found.svg").getroot().itertext())
    expect(f"found: {report['verdicts']['found']}" in words, words)
    # The map's own errors count too, and along a corridor both poses fit alike.
    truth = judged(folder / "found.csv", "--trajectory", RUN, "--reference", TRUTH)
    expect(truth["within"]["of"] == len(scans) and truth["within"]["share"] >= 0.9, f"{truth['within']}, {truth['wrong']}")
    expect(truth["distance_m"]["median"] < 0.06 and truth["angle_deg"]["median"] < 0.3, f"errors {truth}")
    merged = set(json.loads((RUN / "report.json").read_text())["keyframe_scans"])
    others = judged(folder / "found.csv", "--reference", RUN, "--leave-out", "0s")
    expect(others["left_out"] == sum(scan["scan"] in merged for scan in scans), f"{others['left_out']} left out")


def evaluate_judges_found_poses():
    """Limits so narrow that some fail: share, interval and each distance are those computed here; scans near merged ones are left
    out."""
    folder = fresh_folder("evaluate_poses")
    report = localized("--every", 40, "--table", folder / "found.csv")
    judgement = judged(folder / "found.csv", "--reference", POSES, "--within", "1cm/0.1deg")
    poses = poses_of(POSES)
    wrong = {row["scan"]: row for row in judgement["wrong"]}
    for scan in report["scans"]:
        _, x, y, theta = poses[scan["scan"]]
        off = math.hypot(scan["best"]["x_m"] - x, scan["best"]["y_m"] - y)
        angle = math.degrees(turned(scan["best"]["theta_rad"], theta))
        expect((scan["scan"] in wrong) == (off > 0.01 or angle > 0.1), f"{off} m, {angle} deg: {scan}")
        if scan["scan"] in wrong:
            row = wrong[scan["scan"]]
            expect(abs(row["distance_m"] - off) < 1e-5 and abs(row["angle_deg"] - angle) < 1e-4, f"{scan}, {row}")
            expect(row["state"] == scan["verdict"], f"{scan}, {row}")
    share, of = judgement["within"], len(report["scans"])
    expect(0 < len(wrong) < of and share["count"] == of - len(wrong) and share["of"] == of, f"the limits try nothing: {share}")
    low, high = wilson(share["count"], of)
    expect(abs(share["low_95"] - low) < 1e-9 and abs(share["high_95"] - high) < 1e-9, f"{share}")
    expect({name: row["of"] for name, row in judgement["states"].items()} ==
           {name: count for name, count in report["verdicts"].items() if count}, f"{judgement['states']}")
    merged = [poses[k][0] for k in json.loads((RUN / "report.json").read_text())["keyframe_scans"]]
    near = sum(min(abs(scan["stamp_s"] - stamp) for stamp in merged) <= 0.35 for scan in report["scans"])
    expect(judged(folder / "found.csv", "--reference", RUN, "--leave-out", "0.35s")["left_out"] == near, f"{near} are near")
    text = command("evaluate", folder / "found.csv", "--reference", POSES, "--within", "1cm/0.1deg")
    expect_exit(text, 0)
    expect(f"{100 * share['share']:.1f} %" in text.stdout and "deg off" in text.stdout, text.stdout)
    (folder / "cut.csv").write_text((folder / "found.csv").read_text()[:-40])
    for arguments, code, words in (
            ((folder / "found.csv",), 2, "nothing to compare with: give --reference"),
            ((folder / "found.csv", "--reference", DATA / "far.tum"), 65, "far.tum: none of its 3 poses has the stamp of one of the "),
            ((folder / "found.csv", "--reference", POSES, "--leave-out", "1s"), 2, "--leave-out needs the run of the map"),
            ((folder / "found.csv", "--reference", POSES, "--within", "10cm"), 2, "--within: '10cm' is not LENGTH/ANGLE"),
            ((folder / "found.csv", "--reference", POSES, "--within", "0m/1deg"), 2, "is out of range"),
            ((POSES, "--reference", POSES, "--within", "1cm/1deg"), 2, "--within and --leave-out are for a table"),
            ((folder / "cut.csv", "--reference", POSES), 65, "cut.csv:")):
        process = command("evaluate", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)


def localize_is_the_same_for_threads():
    """Text, JSON, poses and picture do not depend on the number of threads or the instruction set."""
    folder = fresh_folder("localize_threads")
    results = []
    for number, how in enumerate((("--threads", 1), ("--threads", 2), ("--threads", 0, "--isa", "baseline"))):
        files = ("-o", folder / f"{number}.tum", "--picture", folder / f"{number}.svg", "--table", folder / f"{number}.csv")
        chosen = ("--every", 36)
        report = localized(*chosen, *files, *how)
        text = command("localize", RUN, LOG, *chosen, *how)
        expect_exit(text, 0)
        results.append((without_times(report), text.stdout, *((folder / f"{number}.{kind}").read_bytes() for kind in ("tum", "svg", "csv"))))
    expect(results[0] == results[1], "two threads give something else than one")
    expect(results[0] == results[2], "another instruction set gives something else")


def localize_on_a_device():
    """A Vulkan device gives the CPU's results."""
    cli.require_vulkan()
    chosen = ("--every", 100)
    on_cpu = localized(*chosen, "--device", "cpu")
    on_device = localized(*chosen, "--device", "vulkan")
    expect(without_times(on_cpu) == without_times(on_device), "the device finds something else")
    expect(on_cpu["times"]["device"] != on_device["times"]["device"], "the device was not used")


def _mapped_room(folder):
    """The drive in the empty rectangular room, mapped; and its poses in the room."""
    drive = [(2.0 + 0.02 * k, 1.5 + 0.01 * k, 2.0 * math.pi * k / 80, 100.0 + 0.2 * k) for k in range(80)]  # once around
    log = folder / "room.log"
    log.write_text("".join(cli.room_scan(*pose) for pose in drive))
    expect_exit(command("map", log, "-o", folder / "room", "-q"), 0)
    return log, folder / "room", drive


def localize_tells_what_is_ambiguous():
    """An empty rectangular room looks the same from two places, half a turn apart: each scan is found at one of them and the
    runner-up is the other."""
    folder = fresh_folder("localize_room")
    log, run, drive = _mapped_room(folder)
    report = localized("--every", 10, run=run, log=log)
    x0, y0, theta0, _ = drive[0]
    expect(report["verdicts"]["ambiguous"] == len(report["scans"]), f"{report['verdicts']}")
    for scan in report["scans"]:
        x, y, theta, _ = drive[scan["scan"]]
        places = []
        for a, b, c in ((x, y, theta), (6.0 - x, 4.0 - y, theta + math.pi)):
            dx, dy = a - x0, b - y0
            places.append((math.cos(theta0) * dx + math.sin(theta0) * dy, -math.sin(theta0) * dx + math.cos(theta0) * dy, c - theta0))
        near = [[math.hypot(pose["x_m"] - a, pose["y_m"] - b) < 0.12 and turned(pose["theta_rad"], c) < 0.05 for a, b, c in places]
                for pose in (scan["best"], scan["runner_up"])]
        expect(near in ([[True, False], [False, True]], [[False, True], [True, False]]), f"{near}: {places}, {scan}")
    text = command("localize", run, log, "--scan", 20)
    expect(" s: ambiguous: x " in text.stdout and "; it may be as good\n" in text.stdout, text.stdout)
    drawn = {}
    for name, where in (("room", (run, log)), ("office", (RUN, LOG))):
        drawn[name] = folder / f"{name}.svg"
        expect_exit(command("localize", *where, "--scan", 20, "--picture", drawn[name], "-q"), 0)
        drawn[name] = drawn[name].read_text()
    expect(drawn["room"].count("stroke-dasharray") == 1, "the room's picture has no second pose")
    expect(drawn["office"].count("stroke-dasharray") == 0, "the office's picture has one")


def _hall_scan(x, y, theta, stamp):
    """In a round hall of 5 m radius with pillars, which looks like no office."""
    ranges = []
    for k in range(180):
        dx, dy = math.cos(theta - math.pi / 2 + math.pi * k / 180), math.sin(theta - math.pi / 2 + math.pi * k / 180)
        hits = []
        for cx, cy, radius in ((0.0, 0.0, 5.0), (2.5, 1.5, 0.4), (-3.0, 0.5, 0.7), (-0.5, 3.2, 0.3), (0.4, -3.4, 0.5)):
            along = dx * (cx - x) + dy * (cy - y)
            under_root = along * along + radius * radius - (cx - x) ** 2 - (cy - y) ** 2
            hits += [along + sign * math.sqrt(under_root) for sign in (-1, 1) if under_root >= 0.0]
        ranges.append(min(hit for hit in hits if hit > 0.0))
    return cli.flaser(ranges, (x, y, theta), (x, y, theta), stamp)


def localize_tells_another_building():
    """Scans of another building are a poor fit whatever is proven of them, and --strict says so; a map without a run has a
    limit of two cells, and --poor-fit sets another one."""
    folder = fresh_folder("localize_elsewhere")
    hall_log, hall = folder / "hall.log", folder / "hall"
    drive = [(1.5 * math.cos(0.08 * k), 1.5 * math.sin(0.08 * k), 0.08 * k + math.pi / 2, 100.0 + 0.2 * k) for k in range(80)]
    hall_log.write_text("".join(_hall_scan(*pose) for pose in drive))
    expect_exit(command("map", hall_log, "-o", hall, "-q"), 0)
    own = localized("--every", 8, "--strict", run=hall, log=hall_log)
    expect(own["verdicts"] == {"found": 10, "ambiguous": 0, "poor-fit": 0, "no-pose": 0}, f"{own['verdicts']}")
    few = ("--every", 27, "--no-runner-up")
    for run, log, every in ((RUN, hall_log, 27), (hall, LOG, 300)):
        other = localized("--every", every, "--no-runner-up", run=run, log=log)
        expect(other["certified"] == len(other["scans"]) >= 3, f"{other['certified']} proven")
        expect(other["verdicts"]["poor-fit"] == len(other["scans"]), f"{other['good_fit']}: {[s['best'] for s in other['scans']]}")
    strict = command("localize", RUN, hall_log, *few, "--strict")
    expect_exit(strict, 1)
    one_error_line(strict.stderr)
    expect("--strict: not every scan was found: 0 found, 0 ambiguous, 3 poor fit" in strict.stderr, strict.stderr)
    summary = "3 scans: 0 found, 0 ambiguous, 3 poor fit; 3 proven\n"
    expect(strict.stdout.endswith(f"{summary}a mean distance of more than 50.0 mm is a poor fit: two cells of the map\n"), strict.stdout)
    for name in ("gdt.yaml", "gdt.png"):
        shutil.copy(hall / name, folder)
    alone = localized("--every", 8, run=folder / "gdt.yaml", log=hall_log)
    expect(alone["good_fit"] == {"distance_m": 0.05, "usual_m": 0.025, "from": "resolution"}, f"{alone['good_fit']}")
    expect([scan["best"] for scan in alone["scans"]] == [scan["best"] for scan in own["scans"]], "other poses")
    asked = localized(*few, "--poor-fit", "2m", run=RUN, log=hall_log)
    expect(asked["good_fit"]["distance_m"] == 2.0 and asked["good_fit"]["from"] == "option" and asked["verdicts"]["poor-fit"] == 0, f"{asked['verdicts']}")


def localize_finds_no_scan_of_a_corridor():
    """Bare walls fit an office by chance nearly as well as its own scans do, but not at one place alone: none is found."""
    log = fresh_folder("localize_corridor") / "corridor.log"
    expect_exit(command("simulate", cli.SOURCE / "assets/scenes/corridor.yaml", "-o", log, "-q"), 0)
    report = localized("--every", 40, log=log)
    expect(report["verdicts"]["found"] == 0, f"{[(s['scan'], s['best'], s['runner_up']) for s in report['scans'] if s['verdict'] == 'found']}")
    expect(report["verdicts"]["ambiguous"] > 0, f"no chance fit among them: {report['verdicts']}")


def localize_the_wrong_way_round():
    """A log where the map should be: what was given and what to do."""
    for arguments, code, words in (
            ((LOG, RUN), 2, f"'{RUN}' is a map and '{LOG}' is none; the map comes first: gdtslam localize {RUN} {LOG}"),
            ((LOG, RUN / "gdt.yaml"), 2, "the map comes first"),
            ((LOG, LOG), 65, "office.log: is no map; give the folder that 'gdtslam map -o' wrote, its gdt.yaml, or a map.yaml of map_server"),
            ((RUN, RUN), 65, "is a folder")):
        process = command("localize", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)


def localize_explains_failures():
    """A search that is cut short, scans without returns: each has its reason."""
    folder = fresh_folder("localize_faults")
    process = command("localize", RUN, LOG, "--every", 100, "--max-time", "1us", "--json")
    expect_exit(process, 65)  # not one pose was tried
    cli.validate(process.stdout, "localize")
    short = json.loads(process.stdout)
    expect(short["certified"] == 0 and all(s["best"] is None and s["runner_up"] is None for s in short["scans"]), "not cut short")
    (folder / "mixed.log").write_text(cli.flaser([81.91] * 180, (0, 0, 0), (0, 0, 0), 99.0) + LOG.read_text())
    mixed = localized("--every", 200, "-o", folder / "mixed.tum", log=folder / "mixed.log")
    expect(mixed["scans"][0]["best"] is None and mixed["verdicts"]["no-pose"] == 1, "a scan without returns was found")
    expect(len(poses_of(folder / "mixed.tum")) == len(mixed["scans"]) - 1, "a pose was written for it")
    text = command("localize", RUN, folder / "mixed.log", "--scan", 0)
    expect_exit(text, 65)
    expect("none of the scans could be localised" in text.stderr, text.stderr)


def localize_hostile_maps():
    """Maps and runs that are none, older or broken: one line that names the file."""
    folder = fresh_folder("localize_maps")
    field = (RUN / "gdt.yaml").read_text()

    def refused(name, code, words, *arguments, **files):
        run = folder / name
        shutil.copytree(RUN, run)
        cli.without_told_files(run)  # whose hashes would tell of all that follows
        for file, change in files.items():
            path = run / file.replace("_", ".")
            path.unlink() if change is None else path.write_bytes(change if isinstance(change, bytes) else change.encode())
        process = command("localize", run, LOG, *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr and process.stdout == "", f"{name}: {process.stderr}")

    refused("no_field", 74, "gdt.yaml: cannot be opened", gdt_yaml=None)
    refused("no_yaml", 65, "gdt.yaml", gdt_yaml="version: 2\nimage: [gdt.png\n")
    refused("other_unit", 65, "gdt.yaml", gdt_yaml=field.replace("resolution: 0.025", "resolution: 0.05"))
    refused("cut", 65, "gdt.png", gdt_png=(RUN / "gdt.png").read_bytes()[:4000])
    origin = next(line for line in field.splitlines() if line.startswith("origin"))
    refused("far", 65, "gdt.yaml: the origin lies more than a million cells", gdt_yaml=field.replace(origin, "origin: [1.0e9, 0.0, 0.0]"))
    alone = folder / "alone"
    alone.mkdir()
    for file in ("gdt.yaml", "gdt.png"):
        shutil.copy(RUN / file, alone)
    same = [localized("--scan", 7, run=run)["scans"] for run in (RUN, RUN / "gdt.yaml", alone, alone / "gdt.yaml")]
    expect(all(scans == same[0] for scans in same), "the folder and its gdt.yaml give different poses")


def localize_standard_input_and_warnings():
    """A log from a pipe; malformed lines are counted; a log that nods is said to."""
    process = command("localize", RUN, "-", "--scan", 3, "--json", input=LOG.read_text())
    expect_exit(process, 0)
    expect(json.loads(process.stdout)["scans"] == localized("--scan", 3)["scans"], "the pipe gives something else")
    folder = fresh_folder("localize_warnings")
    lines = LOG.read_text().splitlines(keepends=True)
    (folder / "bad.log").write_text("FLASER many 1.0 2.0\n" + "".join(lines))
    expect_exit(command("localize", RUN, folder / "bad.log"), 65)
    process = command("localize", RUN, folder / "bad.log", "--lenient", "--scan", 3, "--json")
    expect_exit(process, 0)
    expect(json.loads(process.stdout)["warnings"] == {"malformed line": 1}, process.stdout)
    expect("warning: malformed line (1 times; first: " in process.stderr, process.stderr)
    (folder / "nods.log").write_text("ENCODER 5 0.0 robot 0.0\nENCODER 9 0.1 robot 0.1\n" + "".join(lines))
    process = command("localize", RUN, folder / "nods.log", "--scan", 3)
    expect_exit(process, 0)
    expect("the laser of this log nods" in process.stderr, process.stderr)


def localize_interrupt():
    """SIGINT and SIGTERM in the middle: exit 130, what was found is written and said, by one thread and by two."""
    for number, threads in ((signal.SIGINT, 1), (signal.SIGTERM, 2)):
        folder = fresh_folder("localize_interrupt")
        for patience_s in (1.5, 5.0, 15.0, 60.0, 240.0):  # until a machine that is busy has done some scans
            # Into a file: more than a pipe holds may be printed before anyone reads.
            with open(folder / "found.json", "w", encoding="utf-8") as file:
                process = subprocess.Popen([PROGRAM, "localize", str(RUN), str(LOG), "--every", "1", "--json", "--threads", str(threads),
                                            "-o", str(folder / "found.tum"), "--force"], stdout=file, stderr=subprocess.PIPE, text=True)
                time.sleep(patience_s)
                expect(process.poll() is None, "the command had ended before the signal")
                process.send_signal(number)
                done = finish(process)
            expect_exit(done, 130)
            printed = (folder / "found.json").read_text(encoding="utf-8")
            if json.loads(printed)["scans"]:
                break
        cli.validate(printed, "localize")
        report = json.loads(printed)
        total = len(poses_of(POSES))
        expect(report["interrupted"] and 0 < len(report["scans"]) < total, f"{len(report['scans'])} of {total} scans")
        expect([scan["scan"] for scan in report["scans"]] == list(range(len(report["scans"]))), "scans are missing in between")
        expect(len(poses_of(folder / "found.tum")) == sum(scan["best"] is not None for scan in report["scans"]), "poses are missing")
        expect(re.search(rf"interrupted after {len(report['scans'])} scans?\b", done.stderr) is not None, done.stderr)
    process = subprocess.Popen([PROGRAM, "localize", str(RUN), "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    done = finish(process)
    expect_exit(done, 130)
    one_error_line(done.stderr)
