"""The map of a run in tiles."""

import json
import re
import shutil

import cli_support as cli
from cli_support import LOG, RUN, command, expect, expect_exit, fresh_folder, mapped, one_error_line, skip


def levels_of(yaml):
    """A map of ours as its origin in cells and rows of grey levels from the top."""
    import zlib

    words = dict(line.split(": ", 1) for line in yaml.read_text().splitlines())
    resolution = float(words["resolution"])
    origin = [round(float(word) / resolution) for word in words["origin"].strip("[]").split(",")[:2]]
    data = (yaml.parent / words["image"]).read_bytes()
    if data.startswith(b"P5"):
        width, height = (int(word) for word in data.split(maxsplit=3)[1:3])
        pixels = data[-width * height:]
        return origin, [pixels[row * width:(row + 1) * width] for row in range(height)]
    width, height = int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    expect(data[24:29] == bytes([8, 0, 0, 0, 0]), "no 8-bit grey PNG")
    packed, at = b"", 8
    while at < len(data):
        size = int.from_bytes(data[at:at + 4], "big")
        packed += data[at + 8:at + 8 + size] if data[at + 4:at + 8] == b"IDAT" else b""
        at += size + 12
    rows = zlib.decompress(packed)
    expect(all(rows[row * (width + 1)] == 0 for row in range(height)), "rows with a filter, which this does not undo")
    return origin, [rows[row * (width + 1) + 1:(row + 1) * (width + 1)] for row in range(height)]


def walls_of(origin, rows):
    """Map cells of the level of walls."""
    return {(origin[0] + match.start(), origin[1] + len(rows) - 1 - y) for y, row in enumerate(rows) for match in re.finditer(b"\0", row)}


def tiles_of_a_run():
    """Every tile is made, again alone with the same bytes; maps of all of them are read; foreign folders stay."""
    folder = fresh_folder("tiles")
    run = folder / "run"
    shutil.copytree(RUN, run)
    process = command("tiles", run)
    expect_exit(process, 0)
    tiles = run / "tiles"
    index = json.loads((tiles / "index.json").read_text())
    expect(len(index["tiles"]) >= 1 and index["tile_cells"] == 2048, process.stdout)
    expect(f"{len(index['tiles'])} tile" in process.stdout, process.stdout)
    files = {path.name: path.read_bytes() for path in tiles.iterdir()}
    expect(len(files) == 4 * len(index["tiles"]) + 1, f"{sorted(files)}")
    first = index["tiles"][0]
    (tiles / f"map_{first['x']}_{first['y']}.png").write_bytes(b"damaged")
    expect_exit(command("tiles", run, "--only", f"{first['x']},{first['y']}", "-q"), 0)
    expect({path.name: path.read_bytes() for path in tiles.iterdir()} == files, "another tile when made alone")
    expect_exit(command("tiles", run, "-q"), 0)
    expect({path.name: path.read_bytes() for path in tiles.iterdir()} == files, "other tiles when made again")
    # A map of the keyframes has walls where that of all scans has them.
    origin, whole = levels_of(run / "map.yaml")
    walls = walls_of(origin, whole)
    found = set()
    for tile in index["tiles"]:
        origin, rows = levels_of(tiles / f"map_{tile['x']}_{tile['y']}.yaml")
        expect(origin == [2048 * tile["x"], 2048 * tile["y"]] and len(rows) == 2048, f"{origin}")
        found |= walls_of(origin, rows)
    near = sum(any((x + dx, y + dy) in walls for dx in (-1, 0, 1) for dy in (-1, 0, 1)) for x, y in found)
    expect(len(found) > 1000 and near > 0.95 * len(found), f"{near} of {len(found)} walls are those of the map")
    for what in ("map", "gdt"):
        process = command("localize", tiles / f"{what}_{first['x']}_{first['y']}.yaml", LOG, "--scan", 3)
        expect(process.returncode in (0, 1), process.stderr)


def tiles_refuses_what_it_cannot_make():
    """One line each; nothing is written."""
    folder = fresh_folder("tiles_refusals")
    run = folder / "run"
    shutil.copytree(RUN, run)
    for words, text in (((run, "--only", "0,0"), "index.json"), ((run, "--only", "a"), "is no tile"), ((folder,), "")):
        process = command("tiles", *words)
        expect(process.returncode in (2, 65, 66), f"{process.returncode} {process.stderr}")
        one_error_line(process.stderr)
        expect(text in process.stderr, process.stderr)
    expect(not (run / "tiles").exists(), "tiles were left")
    (run / "tiles").mkdir()
    (run / "tiles/mine.txt").write_text("mine")
    process = command("tiles", run)
    expect_exit(process, 2)
    one_error_line(process.stderr)
    expect("holds what is no tile" in process.stderr, process.stderr)
    expect((run / "tiles/mine.txt").read_text() == "mine", "a foreign file is gone")
    shutil.rmtree(run / "tiles")
    expect_exit(command("tiles", run, "-q"), 0)
    index = json.loads((run / "tiles/index.json").read_text())
    process = command("tiles", run, "--only", "99,99")
    expect_exit(process, 2)
    one_error_line(process.stderr)
    expect("no tile 99,99" in process.stderr, process.stderr)
    index["keyframes_sha256"] = "0" * 64
    (run / "tiles/index.json").write_text(json.dumps(index))
    process = command("tiles", run, "--only", f"{index['tiles'][0]['x']},{index['tiles'][0]['y']}")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("other keyframes" in process.stderr, process.stderr)
    (run / "tiles/index.json").write_text("{")
    expect_exit(command("tiles", run, "--only", "0,0"), 65)


def tiles_take_their_place_whole():
    """A rename that fails or is not lived through leaves the old tiles, and nothing else stays once tiles are made again."""
    if cli.IS_SANITIZED:
        skip("the library that lets calls fail is not preloaded into a sanitized program")
    folder = fresh_folder("tiles_place")
    run = folder / "run"
    mapped(run, "--first", 40)
    expect_exit(command("tiles", run, "-q"), 0)
    before = {path.name: path.read_bytes() for path in (run / "tiles").iterdir()}
    count = cli.calls_counted("rename", "tiles", run, "-q")
    for failing in (1, count // 2, count):
        for how, code in (("EIO", 74), ("kill-before", -9)):
            process = command("tiles", run, "-q", env=cli.failing_calls("rename", failing, how))
            expect_exit(process, code)
            expect({path.name: path.read_bytes() for path in (run / "tiles").iterdir()} == before, f"rename {failing}, {how}")
    expect_exit(command("tiles", run, "-q"), 0)
    expect({path.name: path.read_bytes() for path in (run / "tiles").iterdir()} == before, "other tiles")
    expect(not list(run.glob(".*")), f"{list(run.glob('.*'))}")


def files_of_others_among_tiles_are_kept():
    """What replaces a run takes its tiles away as a whole: with a file of somebody else among them it ends with 2 before it
    begins."""
    folder = fresh_folder("tiles_foreign")
    run, again = folder / "run", folder / "again"
    mapped(run, "--first", 40)
    mapped(again, "--first", 50)
    expect_exit(command("merge", run, again, "-o", folder / "site", "-q"), 0)
    for place, replace in ((run, ("map", LOG, "--first", 45, "-o", run)), (run, ("edit", again, "--origin", "1,1", "-o", run)),
                           (folder / "site/1", ("merge", run, again, "-o", folder / "site"))):
        expect_exit(command("tiles", place, "-q"), 0)
        (place / "tiles/keepout_0_0.png").write_text("mine")
        before = cli.digests(place)
        process = command(*replace, "--force", "-q")
        expect_exit(process, 2)
        one_error_line(process.stderr)
        expect("that no run wrote" in process.stderr and cli.digests(place) == before, process.stderr)
        expect((place / "tiles/keepout_0_0.png").read_text() == "mine", "it is gone")
        (place / "tiles/keepout_0_0.png").rename(folder / "mine.png")
        expect_exit(command(*replace, "--force", "-q"), 0)
        expect(not (place / "tiles").exists(), "tiles of another run stay")


def tiles_without_an_occupancy_map(folder, log):
    """Those of --no-map have distances alone, also made again; a piece that is cut out can be located in."""
    run, cut = folder / "run", folder / "cut_without"
    index = json.loads((run / "tiles/index.json").read_text())
    names = sorted(file.name for file in (run / "tiles").iterdir())
    expect(index["occupancy"] is False and not (run / "map.pgm").exists(), f"{index}")
    expect("map" not in json.loads((run / "report.json").read_text()), "the report has a map")
    expect(len(names) == 2 * len(index["tiles"]) + 1 and not any(name.startswith("map_") for name in names), f"{names}")
    tile = index["tiles"][0]
    expect_exit(command("tiles", run, "--only", f"{tile['x']},{tile['y']}", "-q"), 0)
    expect(sorted(file.name for file in (run / "tiles").iterdir()) == names, "one made again has more files")
    expect(json.loads((run / "tiles/index.json").read_text()) == index, "the index is another")
    process = command("localize", run, log, "--scan", 3)
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("--crop" in process.stderr and "map_0_0" not in process.stderr, process.stderr)
    expect_exit(command("edit", run, "--crop=-3,-3,3,3", "-o", cut), 0)
    expect((cut / "gdt.png").exists() and not (cut / "map.pgm").exists(), "the piece has a map, or no distances")
    expect_exit(command("localize", cut, log, "--scan", 3), 0)


def map_writes_tiles_where_one_piece_is_too_large():
    """Cells of 5 mm make an office through whose window a wall is seen 64 m away too large for one piece: tiles and a small
    map, or tiles alone without a map; mapped again in one piece they go. How far the laser might have seen is no matter."""
    folder = fresh_folder("map_in_tiles")
    small = ("--first", 40, "--no-loops")
    fine = ("--set", "map.resolution=5 mm", "--set", "map.truncation=40 cm", "--set", "scan.max_range=65 m")
    mapped(folder / "office", *small, *fine)
    expect((folder / "office/gdt.png").exists() and not (folder / "office/tiles").exists(), "an office in tiles")
    lines = [line.split(" ") for line in LOG.read_text().splitlines()]
    for words in lines:
        if words[0] == "FLASER":
            words[2 + int(words[1]) // 2] = "64.00"
    far = folder / "far.log"
    far.write_text("\n".join(" ".join(words) for words in lines) + "\n")
    for arguments in (("--no-map",), ()):
        expect_exit(command("map", far, "-o", folder / "run", "--force", "-q", *small, *fine, *arguments), 0)
        expect((folder / "run/tiles/index.json").exists() and not (folder / "run/gdt.png").exists(), f"{arguments}: one piece")
        if arguments:
            tiles_without_an_occupancy_map(folder, far)
    report = json.loads((folder / "run/report.json").read_text())
    cli.validate((folder / "run/report.json").read_text(), "report")
    expect(report["tiles"] > 4, f"{report['tiles']} tiles")
    expect(not (folder / "run/gdt.png").exists(), "a distance field in one piece too")
    index = json.loads((folder / "run/tiles/index.json").read_text())
    expect(len(index["tiles"]) == report["tiles"] and index["keyframes_sha256"] == report["keyframes_sha256"], f"{index}")
    origin, rows = levels_of(folder / "run/map.yaml")
    expect(len(rows) <= 8192 and any(0 in row for row in rows), "no wall in the small map")
    process = command("localize", folder / "run", far, "--scan", 3)
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("tiles/map_0_0.yaml" in process.stderr, process.stderr)
    process = command("edit", folder / "run", "--crop=-3,-3,3,3", "-o", folder / "cut")
    expect_exit(process, 0)
    expect(process.stderr == "" and (folder / "cut/gdt.png").exists(), process.stderr)
    cut = json.loads((folder / "cut/report.json").read_text())
    expect(cut["map"]["resolution_m"] == 0.005 and "tiles" not in cut, f"the piece is no map in one piece: {cut['map']}")
    origin, rows = levels_of(folder / "cut/map.yaml")
    expect(len(rows) == cut["map"]["height"] and any(0 in row for row in rows), "no wall in the piece")
    mapped(folder / "run", *small)
    expect(not (folder / "run/tiles").exists(), "tiles of an earlier run stay")
    expect((folder / "run/gdt.png").exists(), "no distance field")
