"""A run's map turned, cropped, cleaned, georeferenced, and all of it once more: every output in one frame."""

import json
import math
import shutil

import cli_support as cli
from cli_support import LOG, RUN, SOURCE, TRUTH, command, expect, expect_exit, fresh_folder, mapped, one_error_line, scans_in
from scenario_keyframes import read_keyframes


def edited(run, folder, *arguments):
    """Edits; returns edits.json, checked against its table and that of the report."""
    process = command("edit", run, "-o", folder, "--json", *arguments)
    expect_exit(process, 0)
    cli.validate(process.stdout, "edits")
    expect(process.stdout == (folder / "edits.json").read_text(), "another edits.json")
    cli.validate((folder / "report.json").read_text(), "report")
    return json.loads(process.stdout)


def moved(pose, point):
    """T * point or T * pose, in floats of Python."""
    x, y, theta = pose
    turned = [x + math.cos(theta) * point[0] - math.sin(theta) * point[1], y + math.sin(theta) * point[0] + math.cos(theta) * point[1]]
    return turned + [math.remainder(theta + angle, 2 * math.pi) for angle in point[2:3]]


def inverse(pose):
    x, y, theta = pose
    return [-math.cos(theta) * x - math.sin(theta) * y, math.sin(theta) * x - math.cos(theta) * y, -theta]


def poses_in(path):
    """Of a TUM file: x, y, theta."""
    poses = []
    for line in path.read_text().splitlines():
        if not line.startswith("#"):
            _, x, y, _, _, _, qz, qw = map(float, line.split()[:8])
            poses.append([x, y, 2 * math.atan2(qz, qw)])
    return poses


def is_same_pose(a, b, within=1e-7):
    return math.hypot(a[0] - b[0], a[1] - b[1]) < within and abs(math.remainder(a[2] - b[2], 2 * math.pi)) < within


class Picture:
    """map.pgm with the frame that map.yaml states; nothing of the program reads it."""

    def __init__(self, folder):
        lines = dict(line.split(": ", 1) for line in (folder / "map.yaml").read_text().splitlines())
        self.step = float(lines["resolution"])
        self.x, self.y = (float(word) for word in lines["origin"].strip("[]").split(",")[:2])
        data = (folder / "map.pgm").read_bytes()
        header = data.split(b"\n", 3) if data.split(b"\n", 2)[1].count(b" ") else data.split(b"\n", 4)
        self.width, self.height = (int(word) for word in header[1].split())
        self.pixels = data[len(data) - self.width * self.height:]

    def at(self, x, y):
        column, row = math.floor((x - self.x) / self.step), math.floor((y - self.y) / self.step)
        if not (0 <= column < self.width and 0 <= row < self.height):
            return 205
        return self.pixels[(self.height - 1 - row) * self.width + column]

    def centres(self, level):
        for k, pixel in enumerate(self.pixels):
            if pixel == level:
                yield self.x + (k % self.width + 0.5) * self.step, self.y + (self.height - 1 - k // self.width + 0.5) * self.step

    def has_near(self, x, y, level, cells):
        return any(self.at(x + i * self.step, y + j * self.step) == level
                   for i in range(-cells, cells + 1) for j in range(-cells, cells + 1))


def expect_frame(run, folder, pose):
    """Everything in `folder` lies as in `run`, with `pose` as the origin."""
    change = inverse(pose)
    before, after = poses_in(run / "trajectory.tum"), poses_in(folder / "trajectory.tum")
    expect(len(before) == len(after), "another number of poses")
    expect(all(is_same_pose(moved(change, a), b, 1e-6) for a, b in zip(before, after)), "trajectory.tum is elsewhere")
    kept, kept_after = (read_keyframes(path / "keyframes.bin.gz") for path in (run, folder))
    for (scan, stamp, was, sure, laser, ranges), other in zip(kept[2], kept_after[2]):
        expect(is_same_pose(moved(change, was), other[2]), f"keyframe {scan} is elsewhere")
        expect((scan, stamp, laser, ranges) == (other[0], other[1], other[4], other[5]), f"keyframe {scan} is another")
        xx, xy, xt, yy, yt, tt = sure
        c, s = math.cos(change[2]), math.sin(change[2])
        turned = (c * c * xx - 2 * c * s * xy + s * s * yy, c * s * (xx - yy) + (c * c - s * s) * xy, c * xt - s * yt,
                  s * s * xx + 2 * c * s * xy + c * c * yy, s * xt + c * yt, tt)
        expect(all(math.isclose(a, b, rel_tol=1e-6, abs_tol=1e-12) for a, b in zip(turned, other[3])),
               f"the covariance of keyframe {scan} is another")
    graphs = [[line.split() for line in (path / "graph.g2o").read_text().splitlines()] for path in (run, folder)]
    expect([line for line in graphs[0] if line[0] == "EDGE_SE2"] == [line for line in graphs[1] if line[0] == "EDGE_SE2"], "edges changed")
    for a, b in zip(*graphs):
        if a[0] == "VERTEX_SE2":
            expect(is_same_pose(moved(change, list(map(float, a[2:]))), list(map(float, b[2:]))), f"place {a[1]} is elsewhere")
    old, new = Picture(run), Picture(folder)
    for here, there, change_back in ((old, new, change), (new, old, pose)):
        walls = [moved(change_back, point) for point in here.centres(0)]
        near = sum(there.has_near(x, y, 0, 2) for x, y in walls)
        expect(near >= 0.98 * len(walls) > 0, f"{near} of {len(walls)} cells of walls lie where they should")
    report = scans_in(folder)
    expect(report["map"]["origin_m"] == [new.x, new.y] and report["map"]["width"] == new.width, f"{report['map']}")
    expect(report["gdt"] != scans_in(run)["gdt"], "the distance field has the old frame")


def edit_turns_along_walls():
    """A quarter of the walls' directions is known from the scene; whatever turns the run before."""
    folder = fresh_folder("edit_rotate")
    truth = poses_in(TRUTH)[0][2]
    for angle in (0.0, 17.3, -41.0):
        turned = RUN
        if angle:
            turned = folder / f"by{angle}"
            edited(RUN, turned, "--origin", f"0.3,-1.2,{angle}")
            expect_frame(RUN, turned, [0.3, -1.2, math.radians(angle)])
        straight = folder / f"straight{angle}"
        edits = edited(turned, straight, "--rotate-to-walls")
        # Of the new x axis in the scene, whose walls stand square: a whole number of quarter turns.
        x_axis = math.degrees(truth) + angle + math.degrees(edits["steps"][-1]["origin"][2])
        off = math.remainder(x_axis, 90.0)
        expect(abs(off) < 0.1, f"{off} degrees off the walls")
        expect(edits["steps"][-1]["walls_share"] > 0.3, str(edits["steps"]))
        expect(abs(edits["steps"][-1]["origin"][2]) <= math.radians(45.0001), "turned by more than needed")
    found = command("localize", straight, LOG, "--every", 300, "--json")
    expect_exit(found, 0)
    expect(all(scan["verdict"] != "poor-fit" for scan in json.loads(found.stdout)["scans"]), found.stdout)
    expect_exit(command("doctor", "--after", straight), 0)


def edit_again_after_the_next_session():
    """All steps of two edits, on the run that went on: the same frame, erased again, and new scans in it."""
    folder = fresh_folder("edit_again")
    scans = scans_in(RUN)["scans"]
    mapped(folder / "first", "--first", 2 * scans // 3)
    edited(folder / "first", folder / "a", "--rotate-to-walls", "--origin", "0.5,0.25")
    walls = list(Picture(folder / "a").centres(0))
    x, y = walls[len(walls) // 3]
    edits = edited(folder / "a", folder / "b", "--erase", f"{x - 0.3},{y - 0.3} {x + 0.3},{y - 0.3} {x},{y + 0.3}",
                   "--origin", "1,1,30")
    expect([step["step"] for step in edits["steps"]] == ["frame", "frame", "erase"], str(edits["steps"]))
    mapped(folder / "second")
    edited(folder / "second", folder / "c", "--again", folder / "b/edits.json")
    again = json.loads((folder / "c/edits.json").read_text())
    expect(again["steps"] == edits["steps"] and again["T_edited_run"] == edits["T_edited_run"], "other steps")
    start = [poses_in(folder / name / "trajectory.tum")[0] for name in ("b", "c")]
    expect(is_same_pose(*start, 0.05), f"{start}")
    mapped(folder / "other", "--skip", 20, "--first", 100)
    process = command("edit", folder / "other", "-o", folder / "d", "--again", folder / "b/edits.json")
    expect_exit(process, 65)
    expect("another frame" in process.stderr, process.stderr)
    process = command("edit", folder / "a", "-o", folder / "d", "--again", folder / "b/edits.json")
    expect_exit(process, 65)
    expect("was edited already" in process.stderr, process.stderr)
    expect_exit(command("map", LOG, "-o", folder / "c", "--force", "--first", 100, "-q"), 0)
    expect(not (folder / "c/edits.json").exists(), "edits of another map stay")


def edit_of_a_site():
    """A merged site, its sessions too; and an edited run is merged like any other."""
    folder = fresh_folder("edit_site")
    scans = scans_in(RUN)["scans"]
    mapped(folder / "early", "--first", 6 * scans // 10)
    mapped(folder / "late", "--skip", 4 * scans // 10)
    expect_exit(command("merge", folder / "early", folder / "late", "-o", folder / "site", "-q"), 0)
    edited(folder / "site/1", folder / "turned", "--origin", "1,-2,33")
    expect_frame(folder / "site/1", folder / "turned", [1, -2, math.radians(33)])
    paths = [poses_in(folder / "turned" / f"session-{k}.tum") for k in (1, 2)]
    whole = poses_in(folder / "turned/trajectory.tum")
    expect(paths[0] + paths[1] == whole, "the sessions are not the trajectory")
    edited(folder / "early", folder / "early_turned", "--origin", "1,-2,33")
    # Some of its keyframes see nothing of what is left.
    edited(folder / "early", folder / "early_part", "--crop", "1,-2,2.5,8")
    empty = sum(not any(ranges) for *_, ranges in read_keyframes(folder / "early_part/keyframes.bin.gz")[2])
    expect(empty > 0, "every keyframe sees the part that is left")
    expect_exit(command("merge", folder / "early_part", folder / "late", "-o", folder / "parts", "-q"), 0)
    expect_exit(command("merge", folder / "early_turned", folder / "late", "-o", folder / "joined", "-q"), 0)
    joined = json.loads((folder / "joined/merge.json").read_text())
    expect(len(joined["sites"]) == 1, "an edited run is not joined")
    start = [poses_in(path / "trajectory.tum")[0] for path in (folder / "early_turned", folder / "joined/1")]
    expect(is_same_pose(*start, 0.05), f"{start}")


def edit_mistakes():
    """Each with one line and what to do; nothing is written."""
    folder = fresh_folder("edit_mistakes")
    mapped(folder / "few", "--first", 60)
    expect_exit(command("map", SOURCE / "assets/logs/nodding-start.log.gz", "-o", folder / "nods", "--no-cloud", "-q"), 0)
    mapped(folder / "bare", "--first", 60, "--no-map")
    shutil.copytree(folder / "few", folder / "cut")
    (folder / "cut/graph.g2o").unlink()
    shutil.copytree(folder / "cut", folder / "older")
    cli.without_told_files(folder / "older")
    (folder / "steps.json").write_text('{"format": 1, "run": "x", "begins_at_s": 0, "steps": [{"step": "paint"}]}')
    (folder / "no.json").write_text("{")
    (folder / "corners.txt").write_text("1,1\n2,2\nthree\n")
    (folder / "points.txt").write_text("1,1=2,2,3\n")
    point = ("--georeference", "0,0=100,100")
    for run, words, code, text in (
            ("few", (), 2, "nothing is to be done"), ("few", ("--origin", "1"), 2, '--origin: "1" is not'),
            ("few", ("--origin", "50000,0"), 2, "from its origin"), ("few", ("--crop", "1,1,1,4"), 2, "no area"),
            ("few", ("--crop", "900,900,901,901"), 65, "leaves nothing of the map"),
            ("few", ("--crop", "0.2,0.2,0.5,0.5"), 65, "leave nothing that was seen"),
            ("few", ("--erase", "-99,-99 99,-99 99,99 -99,99"), 65, "leave nothing that was seen"),
            ("few", ("--erase", "1,1 2,2"), 2, "three corners"), ("few", ("--erase", folder / "corners.txt"), 65, 'corners.txt:3: has "three"'),
            ("few", ("--north-up",), 2, "nothing says where north is"), ("few", point, 65, "give two or more"),
            ("few", (*point, "--georeference", "10,0=100,130"), 65, "contradict each other"),
            ("few", ("--georeference", "1,1"), 2, "is not a point"), ("few", ("--georeference", folder / "points.txt"), 65, "points.txt:1"),
            ("few", ("--again", folder / "steps.json"), 65, '"paint", which this program does not know'),
            ("few", ("--again", folder / "no.json"), 65, "is no JSON text"), ("few", ("--again", folder / "none"), 74, "none"),
            ("nods", ("--rotate-to-walls",), 65, "laser that nods"), ("bare", ("--world-file",), 65, "--no-map"),
            ("cut", ("--origin", "1,1"), 65, "graph.g2o: is missing in this run"),
            ("older", ("--origin", "1,1"), 74, "graph.g2o: cannot be opened"), ("none", ("--origin", "1,1"), 65, "is no folder of a run")):
        process = command("edit", folder / run, "-o", folder / "out", *words)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(text in process.stderr, process.stderr)
        expect(not (folder / "out").exists(), f"{text}: something was written")
    process = command("edit", folder / "few", "-o", folder / "few", "--force", "--origin", "1,1")
    expect_exit(process, 2)
    expect("is the run itself" in process.stderr, process.stderr)
    edited(folder / "bare", folder / "out", "--origin", "1,1")
    expect(not (folder / "out/map.pgm").exists() and "map" not in scans_in(folder / "out"), "a map that the run has not")
    (folder / "foreign").mkdir()
    (folder / "foreign/map.png").write_text("mine")
    process = command("edit", folder / "few", "-o", folder / "foreign", "--world-file")
    expect_exit(process, 2)
    expect("exists; give another name" in process.stderr and (folder / "foreign/map.png").read_text() == "mine", process.stderr)
