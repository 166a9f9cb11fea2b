"""gdtslam render on runs that are alike but for one thing: a mount without a linkage, two runs of one log, an open cloud."""

import json
import math
import re
import shutil
import struct

import cli_support as cli
from cli_support import RUN, TRUTH, expect
from nodding_log import Drive, stamp_of, ticks_of
from scenario_merge import parts_of_the_log
from scenario_nodding_faults import elevation_of
from scenario_render import Png, refused, rendered, require_viewer, views_of, words_of


def render_tilting_laser():
    """A log that tells the elevation itself has no linkage: none is offered, drawn or written into the page."""
    require_viewer()
    drive = Drive("render_tilting_laser")
    drive.map("crank", drive.lines)
    angle = elevation_of(drive.linkage.read_text())
    drive.map("tilt", drive.edited(lambda line: f"TILT {angle(ticks_of(line)):.9f} {stamp_of(line):.6f} robot 0"))
    crank, tilt = drive.folder / "crank", drive.folder / "tilt"
    expect(views_of(tilt)[0] == views_of(crank)[0] - {"scene"}, f"views of a tilting laser: {views_of(tilt)}")
    refused(2, tilt, "--view", "scene", "-o", drive.folder / "a.svg", says="--linkage NAME|FILE")
    svg, page, scan = drive.folder / "a.svg", drive.folder / "a.html", ("--view", "scan", "--time", "2s:6s")
    for run, has_linkage in ((crank, True), (tilt, False)):
        expect(("The mount" in words_of(svg, run, *scan)) == has_linkage, f"{run}: the mount's close view")
        rendered(run, "-o", page)
        expect(('"linkage":{' in page.read_text()) == has_linkage, f"{run}: the linkage in the page")


def render_site():
    """A merged site has its graph, but no replay of one drive: it is not listed, and whoever asks hears what there is. Its page
    begins each drive anew."""
    require_viewer()
    folder = cli.fresh_folder("render_site")
    early, late, _, part = parts_of_the_log(folder)
    cli.expect_exit(cli.command("merge", early, late, "-o", folder / "sites", "-q"), 0)
    site = folder / "sites/1"
    views = ["map", "graph", "field", "trajectory"]
    expect(views_of(site) == (set(views), {"still": "map"}), f"{views_of(site)}")
    for name, *arguments in (("a.png", "--view", "loops"), ("a.mp4", "--view", "loops"), ("a.mp4",)):
        refused(2, site, *arguments, "-o", folder / name, says=f"its views {'are ' if arguments else ''}{', '.join(views)}")
    rendered(site, "--view", "graph", "-o", folder / "a.png")
    rendered(site, "-o", folder / "a.html")
    about = json.loads(re.search(r'id="description">(.*?)</script>', (folder / "a.html").read_text(), re.S)[1])
    path, facts = about["path"], dict(about["facts"])
    expect(path["drives"] == [part] and f"{path['length']:.1f} m" == facts["Path"], f"{path}, {facts}")
    rows = [float(line.split()[0]) for line in (site / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    driven_s = rows[part - 1] - rows[0] + rows[-1] - rows[part]
    expect(abs(path["last"] - path["first"] - driven_s) < 1e-3, f"{path}, {driven_s} s")


def render_errors_of_runs_of_one_log():
    """Runs of one log have one name; plots of both tell them apart by their folders, and by their paths where those are alike."""
    require_viewer()
    folder = cli.fresh_folder("render_errors_of_runs_of_one_log")
    for name in ("coarse", "fine", "other/fine"):
        shutil.copytree(RUN, folder / name)
    for kind in ("cdf", "box", "time"):
        words = words_of(folder / "e.svg", folder / "coarse", folder / "fine", "--reference", TRUTH, "--view", "errors", "--as", kind)
        expect("coarse" in words and "fine" in words, f"{kind}: {words}")
        words = words_of(folder / "e.svg", "fine", "other/fine", "--reference", TRUTH, "--view", "errors", "--as", kind, cwd=folder)
        expect("other/fine" in words, f"{kind}: {words}")


def render_open_clouds_whole():
    """Nine tenths of the points lie on a small dense patch, the rest on an open ring around it: no view cuts the ring."""
    require_viewer()
    folder = cli.fresh_folder("render_open_clouds_whole")
    near = [(0.02 * (k % 60), 0.02 * (k // 60), 1.0) for k in range(3600)]
    far = [(0.6 + 12 * math.cos(0.015 * k), 0.6 + 9 * math.sin(0.015 * k), 0.03 * (k % 90)) for k in range(420)]
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(near + far)}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    (folder / "open.ply").write_bytes(head.encode() + b"".join(struct.pack("<fff", *place) for place in near + far))
    for place in ("iso", "top", "front", "side"):
        rendered(folder / "open.ply", "--from", place, "--hide", "caption", "--size", "320x200", "-o", folder / "a.png")
        picture = Png(folder / "a.png")
        ground = picture.pixel(0, 0)
        edge = [picture.pixel(x, y) for x in range(320) for y in (0, 1, 198, 199)]
        edge += [picture.pixel(x, y) for y in range(200) for x in (0, 1, 318, 319)]
        expect(set(edge) == {ground}, f"{place}: points at the picture's edge")


def render_of_a_million_points():
    """Walls of a million points: a still takes at most 250 MB, and all of them are drawn; of three million as many as the
    picture has pixels."""
    require_viewer()
    if cli.IS_SANITIZED:
        cli.skip("a sanitized program needs memory of its own")
    folder = cli.fresh_folder("render_of_a_million_points")
    for millions in (1, 3):
        side = 1000
        rows = [struct.pack("<3f", 0.01 * (k % side), 0.0, 0.0025 * (k // side)) for k in range(side * side)]
        walls = b"".join(rows) + b"".join(
            struct.pack("<3f", 0.01 * (k % side), 3.0 * wall, 0.0025 * (k // side)) for wall in range(1, millions) for k in range(side * side))
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex {millions * side * side}\n"
        (folder / "walls.ply").write_bytes((header + "".join(f"property float {a}\n" for a in "xyz")).encode() + b"end_header\n" + walls)
        code, text, megabytes, _ = cli.measured("render", folder / "walls.ply", "--hide", "none", "--json", "--force", "-o", folder / "a.png")
        expect(code == 0, text)
        result = json.loads(text)
        expect(megabytes <= 250, f"a still of {millions} million points takes {megabytes} MB")
        pixels = result["size_px"][0] * result["size_px"][1]
        expect(result["points_of"] == millions * side * side, f"{result}")
        expect(result["points"] == side * side if millions == 1 else pixels / 2 <= result["points"] <= pixels, f"{result}")
    shutil.rmtree(folder)
