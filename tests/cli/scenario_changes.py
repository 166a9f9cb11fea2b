"""What changed in a building: `localize --track --changes`, and sites of `merge`. Where things stood and stand now is
known from the scenes, of which the second is the first with some lines changed."""

import csv
import json
import math

import cli_support as cli
from cli_support import SOURCE, command, expect, expect_exit, fresh_folder, mapped, one_error_line

START = (10.0, 6.1)  # of the drive in the scene: the origin of the map, heading along x
# A partition between two rooms with the cabinets along it, 22 to 22.51 by 20.06 to 24.85, is gone; the copier, 0.7 by
# 0.62, moved from 32.9 to 21.6 along the corridor's wall; a box of 1.2 by 0.8 is new.
CHANGED_LINES = (("  - {points: [[22, 20], [22, 25]]}\n", ""),
                 ("  - {object: cabinet, at: [22.3, 21.6], yaw: 90 deg, repeat: {count: 2, step: [0, 1.05]}}\n", ""),
                 ("  - {object: copier, at: [32.9, 5.38]}\n", "  - {object: copier, at: [21.6, 5.38]}\n"),
                 ("  - {centre: [25.2, 8.6], size: [0.4, 0.4], height: 2.8 m}\n",
                  "  - {centre: [25.2, 8.6], size: [0.4, 0.4], height: 2.8 m}\n"
                  "  - {centre: [28.4, 23.6], size: [1.2, 0.8], height: 1.5 m}\n"))
GONE = ((21.94, 20.0, 22.51, 25.0), (32.55, 5.07, 33.25, 5.69))
NEW = ((21.25, 5.07, 21.95, 5.69), (27.8, 23.2, 29.0, 24.0))
# Sides that the drive sees: the edges of these boxes must be told, or most of them.
MUST_BE_NEW = (((21.25, 5.69), (21.95, 5.69)), ((27.8, 23.2), (29.0, 23.2)))
MUST_BE_GONE = (((32.55, 5.69), (33.25, 5.69)), ((21.94, 21.0), (21.94, 24.0)))
NEAR_M = 0.1
LATER_S = 10000.0


def shifted(log, by_s):
    """The log as if it had been taken later."""
    lines = []
    for line in log.read_text().splitlines():
        words = line.split()
        if words[0] in ("ODOM", "FLASER"):
            words[-3], words[-1] = (f"{float(words[k]) + by_s:.6f}" for k in (-3, -1))
        lines.append(" ".join(words))
    return "\n".join(lines) + "\n"


def later_drive(folder, by_s=LATER_S):
    """Through the building as it is now: the log."""
    scene = (SOURCE / "assets/scenes/office-loop.yaml").read_text()
    for before, after in CHANGED_LINES:
        expect(scene.count(before) == 1, f"the scene has no line {before}")
        scene = scene.replace(before, after)
    (folder / "office-now.yaml").write_text(scene)
    expect_exit(command("simulate", folder / "office-now.yaml", "-o", folder / "now.log", "--seed", 5, "--rate", 5, "-q"), 0)
    (folder / "later.log").write_text(shifted(folder / "now.log", by_s))
    return folder / "later.log"


def in_scene(x, y):
    return x + START[0], y + START[1]


def off_box(at, box):
    """Metres outside of it."""
    return math.hypot(max(box[0] - at[0], 0.0, at[0] - box[2]), max(box[1] - at[1], 0.0, at[1] - box[3]))


def expect_cells(cells, boxes, sides, what):
    for at in cells:
        expect(min(off_box(at, box) for box in boxes) < NEAR_M, f"{what} at {at}, where nothing is")
    for (x0, y0), (x1, y1) in sides:
        places = [(x0 + k / 20 * (x1 - x0), y0 + k / 20 * (y1 - y0)) for k in range(1, 20)]
        told = sum(any(math.dist(at, place) < NEAR_M for at in cells) for place in places)
        expect(told >= 0.75 * len(places), f"{what}: {told} of {len(places)} places of {(x0, y0), (x1, y1)}")


def changes_are_where_the_scenes_differ():
    """Every cell that is told lies where something came or went, and what the robot saw of it is told; the robot is
    followed to the end. The same bytes again."""
    folder = fresh_folder("changes")
    log = later_drive(folder)
    picture, again = folder / "changes.png", folder / "again.png"
    process = command("localize", cli.RUN, log, "--track", "--changes", picture, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "localize_track")
    report = json.loads(process.stdout)
    with open(folder / "changes.csv", newline="", encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    for kind, boxes, sides in (("new", NEW, MUST_BE_NEW), ("gone", GONE, MUST_BE_GONE)):
        of_kind = [row for row in rows if row["change"] == kind]
        told = report["changes"][kind]
        expect(told["cells"] == len(of_kind) and told["places"] == max(int(row["place"]) for row in of_kind), f"{told}")
        expect_cells([in_scene(float(row["x_m"]), float(row["y_m"])) for row in of_kind], boxes, sides, kind)
        counted = "ended" if kind == "new" else "passed"
        expect(all(int(row[counted]) >= (2 if kind == "new" else report["changes"]["least_views"]) for row in of_kind), kind)
    known = report["whereabouts"]
    expect(known["tracked"] > 0.95 * report["scans"] and known["unknown"] == 0, f"{known}")
    expect(picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n", "no PNG")
    expect_exit(command("localize", cli.RUN, log, "--track", "--changes", again, "-q", "--threads", 3), 0)
    expect(again.read_bytes() == picture.read_bytes(), "another picture")
    expect((folder / "again.csv").read_bytes() == (folder / "changes.csv").read_bytes(), "another table")


def changes_of_an_unchanged_building():
    """Nothing is told where nothing changed, of another drive with other noise."""
    folder = fresh_folder("changes_none")
    expect_exit(command("simulate", "office-loop", "-o", folder / "again.log", "--seed", 8, "--rate", 5, "-q"), 0)
    process = command("localize", cli.RUN / "map.yaml", folder / "again.log", "--track", "--changes", folder / "none.svg", "--json")
    expect_exit(process, 0)
    changes = json.loads(process.stdout)["changes"]
    expect(changes["views"] > 100 and changes["new"]["cells"] == changes["gone"]["cells"] == 0, f"{changes}")
    expect("nothing new" in (folder / "none.svg").read_text(), "the legend does not say so")


def changes_mistakes():
    """One line each, and what to do."""
    folder = fresh_folder("changes_mistakes")
    mapped(folder / "bare", "--first", 60, "--no-map")
    for words, code, arguments in (("--changes requires --track", 2, (cli.RUN, "--changes", folder / "c.png")),
                                   ("--changes", 2, (cli.RUN, "--track", "--changes", folder / "c.txt")),
                                   ("map the log again without --no-map", 65,
                                    (folder / "bare", "--track", "--changes", folder / "c.png"))):
        process = command("localize", arguments[0], cli.LOG, *arguments[1:])
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
        expect(not (folder / "c.png").exists() and not (folder / "c.csv").exists(), "something was written")


def _map_of(run):
    """(state by cell, resolution, origin): map.pgm by this file's own reading; 0 occupied, 254 free."""
    header = dict(line.split(": ", 1) for line in (run / "map.yaml").read_text().splitlines() if ": " in line)
    resolution = float(header["resolution"].split()[0])
    origin = [float(word) for word in header["origin"].split("#")[0].strip(" []").split(",")]
    data = (run / "map.pgm").read_bytes()
    fields, at = [], 0
    while len(fields) < 4:
        end = at
        while data[end:end + 1] not in (b" ", b"\n", b"\t"):
            end += 1
        if data[at:at + 1] == b"#":
            at = data.index(b"\n", at) + 1
            continue
        fields.append(data[at:end])
        at = end + 1
    width, height = int(fields[1]), int(fields[2])
    return data[at:], width, height, resolution, origin


def occupied_near(run, side):
    """Of places along it: how many have an occupied cell nearby."""
    cells, width, height, resolution, origin = _map_of(run)
    reach = int(NEAR_M / resolution)
    (x0, y0), (x1, y1) = side
    near = 0
    for k in range(1, 20):
        x = int((x0 + k / 20 * (x1 - x0) - START[0] - origin[0]) / resolution)
        y = int((y0 + k / 20 * (y1 - y0) - START[1] - origin[1]) / resolution)
        near += any(cells[(height - 1 - v) * width + u] == 0 for u in range(x - reach, x + reach + 1)
                    for v in range(y - reach, y + reach + 1))
    return near


def merge_changes():
    """The later drive overrules: what is gone is in no map of the site, what is new is; in either order of the runs. By
    stamps that tell no order both places are free."""
    folder = fresh_folder("merge_changes")
    log = later_drive(folder)
    mapped(folder / "later", log=log)
    mapped(folder / "meanwhile", log=folder / "now.log")
    for name, runs in (("site", (cli.RUN, folder / "later")), ("swapped", (folder / "later", cli.RUN)),
                       ("unknown", (cli.RUN, folder / "meanwhile"))):
        process = command("merge", *runs, "-o", folder / name, "--json")
        expect_exit(process, 0)
        cli.validate(process.stdout, "merge")
        expect(len(json.loads(process.stdout)["sites"]) == 1, f"{name}: not joined")
    site = folder / "site/1"
    for file in ("map.pgm", "gdt.png", "keyframes.bin.gz", "changes.png"):
        expect((site / file).read_bytes() == (folder / "swapped/1" / file).read_bytes(), f"{file} depends on the order")
    for side in MUST_BE_GONE:
        expect(occupied_near(cli.RUN, side) >= 15, f"{side} was not in the map")
        expect(occupied_near(site, side) <= 1, f"{side} is in the map of the site")
        expect(occupied_near(folder / "unknown/1", side) <= 1, f"{side} is in the map though nobody knows")
    for side in MUST_BE_NEW:
        expect(occupied_near(site, side) >= 15, f"{side} is not in the map of the site")
        expect(occupied_near(folder / "unknown/1", side) <= 3, f"{side} is in the map though nobody knows")
    changes = json.loads((folder / "site/merge.json").read_text())["sites"][0]["changes"]
    earlier, later = changes["drives"]
    expect(earlier["run"] == str(cli.RUN) and earlier["new"]["cells"] == earlier["gone"]["cells"] == 0, f"{earlier}")
    expect(later["gone"] == changes["gone"] and later["new"] == changes["new"], f"{later}")
    expect(changes["gone"]["places"] == 2 and changes["new"]["places"] == 2, f"{changes}")
    # A scan of the building as it is now fits the distance transform of the site.
    found = command("localize", site, log, "--track", "--json")
    expect_exit(found, 0)
    expect(json.loads(found.stdout)["whereabouts"]["unknown"] == 0, found.stdout)


def merge_of_an_unchanged_building():
    """Nothing is taken out where nothing changed, and there is no picture of changes."""
    folder = fresh_folder("merge_unchanged")
    expect_exit(command("simulate", "office-loop", "-o", folder / "again.log", "--seed", 8, "--rate", 5, "-q"), 0)
    (folder / "later.log").write_text(shifted(folder / "again.log", LATER_S))
    mapped(folder / "later", log=folder / "later.log")
    expect_exit(command("merge", cli.RUN, folder / "later", "-o", folder / "site", "-q"), 0)
    changes = json.loads((folder / "site/merge.json").read_text())["sites"][0]["changes"]
    expect(changes["readings_taken_out"] == 0 and changes["new"]["cells"] == changes["gone"]["cells"] == 0, f"{changes}")
    expect(not (folder / "site/1/changes.png").exists(), "a picture of no changes")
