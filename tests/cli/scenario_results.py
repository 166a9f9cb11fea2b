"""Results against the truth, and files against each other."""

import json
import math
import resource
import subprocess

import cli_support as cli
from cli_support import DATA, LOG, PROGRAM, RUN, SOURCE, TRUTH, command, expect, expect_exit, mapped, results, scans_in, skip


def accuracy_of_the_sample():
    """The simulated drive is mapped to two centimetres; a wrong merge rule is not (so this test can fail)."""
    process = command("evaluate", RUN / "trajectory.tum", "--reference", TRUTH, "--json")
    expect_exit(process, 0)
    report = json.loads(process.stdout)
    expect(report["unmatched"] == 0, f"{report['unmatched']} poses have no truth")
    expect(report["ate"]["translation_m"]["rmse"] < 0.02, f"ATE {report['ate']['translation_m']}")
    expect(report["ate"]["rotation_deg"]["rmse"] < 0.5, f"ATE {report['ate']['rotation_deg']}")
    folder = cli.fresh_folder("wrong_merge")
    error_m = {}
    for rule in ("working", "literal"):
        mapped(folder / rule, "--no-loops", "--first", 400, "--set", f"merge.rule={rule}", "--set", "search.when=never")
        process = command("evaluate", folder / rule / "trajectory.tum", "--reference", TRUTH, "--json")
        error_m[rule] = json.loads(process.stdout)["ate"]["translation_m"]["rmse"]
    expect(error_m["working"] < 0.04 and error_m["literal"] > 0.2, f"errors {error_m}")


def nothing_measured_is_no_perfect_fit():
    """Of one scan nothing was laid on another: the report has null, the text no millimetres, and readers take it."""
    folder = cli.fresh_folder("nothing_measured") / "run"
    process = command("map", cli.LOG, "--first", 1, "-o", folder)
    expect_exit(process, 0)
    expect("loops: 0 of 0 hold; no scan was laid on another" in process.stdout and " mm" not in process.stdout, process.stdout)
    text = (folder / "report.json").read_text()
    cli.validate(text, "report")
    loops = json.loads(text)["loops"]
    expect(loops["pairs"] == 0 and loops["rms_m"] is None, f"{loops}")
    expect_exit(command("doctor", "--after", folder), 0)


def report_adds_up():
    """report.json agrees with the other files of the run."""
    report = scans_in(RUN)
    cli.validate((RUN / "report.json").read_text(), "report")
    poses = [line for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expect(len(poses) == report["scans"], "scans and poses")
    expect(report["matched"] + report["doubtful"] >= report["scans"], "matched and doubtful scans")
    expect(len(report["doubtful_scans"]) == report["doubtful"], "doubtful scans are listed")
    matches = report["matches"]
    expect(sum(matches.values()) == report["scans"], f"{matches} of {report['scans']} scans")
    expect(matches["weak"] + matches["refused"] == report["doubtful"], f"{matches}, {report['doubtful']} doubtful")
    expect(sum(s["to"] - s["from"] + 1 for s in report["uncertain"]["stretches"]) == report["uncertain"]["scans"],
           "scans of uncertain stretches")
    # Well above the cells' rounding (25 mm a cell) and well below the 300 mm at which a match is refused.
    expect(0.001 < report["match_median_m"] < report["match_p99_m"] < 0.2, f"{report['match_median_m']}, {report['match_p99_m']}")
    path_m = 0.0
    last = None
    for line in poses:
        _, x, y = (float(word) for word in line.split()[:3])
        if last is not None:
            path_m += ((x - last[0]) ** 2 + (y - last[1]) ** 2) ** 0.5
        last = (x, y)
    expect(abs(path_m - report["path_m"]) < 1e-4 * report["scans"], f"path {path_m}, report {report['path_m']}")
    with open(RUN / "map.pgm", "rb") as pgm:
        header = pgm.read(64).split()
        expect([int(header[1]), int(header[2])] == [report["map"]["width"], report["map"]["height"]], f"map.pgm {header[:3]}")
    cells = (RUN / "map.pgm").read_bytes()[-report["map"]["width"] * report["map"]["height"]:]
    expect(set(cells) == {0, 205, 254}, f"levels of map.pgm: {sorted(set(cells))}")
    expect(cells.count(0) > 1000 and cells.count(254) > 10 * cells.count(0), "the map is no building")
    stages = report["stages"]
    expect(abs(sum(stages.values()) - report["cpu_s"]) < 0.05 * report["cpu_s"], f"stages {stages} of {report['cpu_s']} s")
    expect(stages["other"] < 0.2 * report["cpu_s"] + 0.02, f"nobody knows what took {stages['other']} of {report['cpu_s']} s")


def cpu_time_is_that_of_the_process():
    """cpu_s is what the kernel counted for the whole process, but for its start; with two threads too."""
    folder = cli.fresh_folder("cpu_time")
    for threads in (1, 2):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        report = mapped(folder / str(threads), "--threads", threads)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        expect(spent_s - 0.5 < report["cpu_s"] < spent_s + 0.05, f"{threads} threads: {report['cpu_s']} of {spent_s} s")
        stages = report["stages"]
        expect(abs(sum(stages.values()) - report["cpu_s"]) < 0.05 * report["cpu_s"], f"{threads} threads: {stages}")


def without_the_occupancy_map():
    """--no-map leaves out map and pictures, old ones too; the rest is the same, and what wants the map says so."""
    folder = cli.fresh_folder("no_map")
    whole = mapped(folder / "run", "--first", 200)
    with_map = cli.digests(folder / "run")
    report = mapped(folder / "run", "--first", 200, "--no-map")
    without = cli.digests(folder / "run")
    cli.validate((folder / "run" / "report.json").read_text(), "report")
    expect(results(report) == results(whole), "another result without the map")
    left_out = {"map.pgm", "map.yaml", cli.OVERVIEW, cli.OVERVIEW.replace("overview", "graph")}
    expect(set(with_map) - set(without) == left_out and set(without) <= set(with_map), f"{sorted(without)}")
    for name in ("trajectory.tum", "gdt.png", "gdt.yaml", "config.yaml"):
        expect(with_map[name] == without[name], f"another {name}")
    expect("map" not in report and "write_map" not in report["stages"], "the report tells of a map")
    process = command("doctor", "--after", folder / "run", "--picture", folder / "graph.svg")
    expect_exit(process, 65)
    expect("it was mapped with --no-map" in process.stderr, process.stderr)
    expect_exit(command("doctor", "--after", folder / "run"), 0)


def config_round_trip():
    """The configuration that a run wrote, and that `config show --all --yaml` prints, give the same run again."""
    folder = cli.fresh_folder("config")
    sets = ["--set", "map.resolution=8 cm", "--set", "merge.kappa=0.75", "--set", "occupancy.min_ends=3"]
    first = mapped(folder / "a", "--first", 100, *sets)
    again = mapped(folder / "b", "--first", 100, "-c", folder / "a" / "config.yaml")
    expect(results(first) == results(again), "another result with the configuration of the run")
    for name in ("config.yaml", "map.pgm", "map.yaml"):
        expect((folder / "a" / name).read_bytes() == (folder / "b" / name).read_bytes(), f"another {name}")
    shown = command("config", "show", "--all", "--yaml", *sets).stdout
    expect(shown == (folder / "a" / "config.yaml").read_text(), "config show --all --yaml differs from the run's")
    try:
        import jsonschema
        import yaml
    except ImportError:
        return
    schema = json.loads(command("config", "schema").stdout)
    jsonschema.validate(yaml.safe_load(shown), schema)
    wrong = yaml.safe_load(shown)
    wrong["map"]["resolutoin"] = 1
    expect(not jsonschema.Draft7Validator(schema).is_valid(wrong), "the schema lets an unknown key pass")


def stated_laser():
    """Options state the mount and the bearings of a log that is wrong about both: a laser that hangs upside down and off
    the axis of a robot that turns on the spot. The truth is the drive's; without the options the robot seems to move."""
    folder = cli.fresh_folder("stated_laser")
    headings = [math.radians(2.0 * k) for k in range(40)]
    text = ""
    for k, heading in enumerate(headings):
        ahead, left = 0.3, 0.1
        x = 3.0 + ahead * math.cos(heading) - left * math.sin(heading)
        y = 2.0 + ahead * math.sin(heading) + left * math.cos(heading)
        robot = (3.0, 2.0, heading)
        text += cli.flaser(cli.room_ranges(x, y, heading)[::-1], robot, robot, 100.0 + 0.2 * k)
    (folder / "wrong.log").write_text(text)
    mount = ("log.mount=stated", "log.mount_x=30 cm", "log.mount_y=10 cm")
    bearings = ("log.bearings=stated", "log.first_bearing=89 deg", "log.bearing_step=-1 deg")
    strayed = {}
    for name, sets in (("neither", ()), ("bearings", bearings), ("both", (*mount, *bearings))):
        mapped(folder / name, *(word for one in sets for word in ("--set", one)), log=folder / "wrong.log")
        poses = [[float(word) for word in line.split()] for line in (folder / name / "trajectory.tum").read_text().splitlines()
                 if line[0] != "#"]
        expect(len(poses) == len(headings), f"{name}: {len(poses)} poses")
        far_m = max(math.dist(pose[1:3], poses[0][1:3]) for pose in poses)
        turned = [2.0 * (math.atan2(pose[6], pose[7]) - math.atan2(poses[0][6], poses[0][7])) for pose in poses]
        strayed[name] = far_m, max(abs(a - b) for a, b in zip(turned, headings))
    expect(strayed["both"][0] < 0.03 and strayed["both"][1] < math.radians(1.0), f"stated: {strayed}")
    expect(strayed["bearings"][0] > 0.1, f"without the mount: {strayed}")
    expect(max(strayed["neither"]) > 0.1, f"without both: {strayed}")
    process = command("map", folder / "wrong.log", "-o", folder / "none", "--set", "log.mount_x=30 cm")
    expect_exit(process, 78)
    expect("count only with log.mount: stated" in process.stderr, process.stderr)


def ablation_table():
    """The table has a row for each variant, with the variant's assignments."""
    folder = cli.fresh_folder("ablation")
    process = command("ablation", LOG, "--relations", DATA / "drive.relations", "-o", folder / "table.md", "--first", 120)
    expect_exit(process, 0)
    table = (folder / "table.md").read_text()
    rows = [line for line in table.splitlines() if line.startswith("| ")][1:]
    expect(len(rows) >= 8, f"{len(rows)} rows")
    for words in ("merge.rule=literal", "merge.kappa=1", "keyframe.every_scan=true", "match.matcher=exhaustive", "match.cost=squared"):
        expect(any(f"`{words}`" in row for row in rows), f"no row for {words}")
    expect(all(row.count("|") == 9 for row in rows), "a row has another number of columns")
    expect("|---|" in process.stdout and table.startswith(process.stdout), f"printed, without its header: {process.stdout}")
    process = command("ablation", LOG, "--relations", DATA / "drive.relations", "-o", folder / "own.md", "--first", 50,
                      "--variant", "merge.kappa=0.25  merge.threshold=0.1m", "-q")
    expect_exit(process, 0)
    expect("`merge.kappa=0.25` `merge.threshold=0.1m`" in (folder / "own.md").read_text(), "own variant")


def reference_pages():
    """docs/reference is what the command says of itself."""
    if "Not in this build" in command("--help").stdout:
        skip("this build leaves commands out")
    page = (SOURCE / "docs/matchers.md").read_text()
    for name in json.loads(command("config", "schema").stdout)["properties"]["match"]["properties"]["matcher"]["enum"]:
        expect(f"`{name}`" in page, f"docs/matchers.md has no {name}")
    process = subprocess.run([SOURCE / "tools/scripts/make_reference.sh", "--check", PROGRAM], capture_output=True,
                             text=True, check=False)
    expect(process.returncode == 0, process.stdout + process.stderr)
