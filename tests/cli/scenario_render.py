"""gdtslam render from the outside: what each input can be drawn as, and files that other programs open."""

import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import xml.etree.ElementTree as xml
import zlib

import cli_support as cli
from cli_support import RUN, TRUTH, command, digests, expect, expect_exit, one_error_line, skip, without_told_files
from nodding_log import Drive, points_of


def require_viewer():
    if os.environ.get("GDTSLAM_VIEWER") != "1":
        process = command("render", RUN)
        expect_exit(process, 69)
        one_error_line(process.stderr)
        expect("GDTSLAM_BUILD_VIEWER=ON" in process.stderr, process.stderr)
        skip("the viewer is not built in")


def require_ffmpeg():
    for program in ("ffmpeg", "ffprobe"):
        if subprocess.run([program, "-version"], capture_output=True, check=False).returncode != 0:
            skip(f"{program} is not installed")


def rendered(*arguments, **options):
    """Renders; returns what it says it wrote."""
    process = command("render", *arguments, "--force", "--json", **options)
    expect_exit(process, 0)
    expect(process.stderr == "", f"stderr is not empty: {process.stderr}")
    cli.validate(process.stdout, "render")
    return json.loads(process.stdout)


def refused(code, *arguments, says="", **options):
    """Renders to no avail: the exit code, one line, and nothing new in the folder."""
    process = command("render", *arguments, **options)
    expect_exit(process, code)
    one_error_line(process.stderr)
    for part in [says] if isinstance(says, str) else says:
        expect(part in process.stderr, f"{part!r} is not in {process.stderr!r}")
    return process


class Png:
    """A PNG file taken apart: RGBA, RGB or grey pixels of 8 bits."""

    def __init__(self, path):
        data = path.read_bytes()
        expect(data[:8] == b"\x89PNG\r\n\x1a\n", f"{path} is no PNG")
        at, packed, self.kinds = 8, b"", []
        while at < len(data):
            (size,) = struct.unpack(">I", data[at:at + 4])
            kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + size]
            expect(struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + body), f"{path}: checksum of {kind}")
            self.kinds.append(kind)
            if kind == b"IHDR":
                self.width, self.height, depth, colour = struct.unpack(">IIBB", body[:10])
                expect(depth == 8 and colour in (0, 2, 6), f"{path}: depth {depth}, colour type {colour}")
                self.channels = {0: 1, 2: 3, 6: 4}[colour]
            packed += body if kind == b"IDAT" else b""
            at += 12 + size
        expect(self.kinds[-1] == b"IEND", f"{path} is cut")
        self.rows = self.unfiltered(zlib.decompress(packed))

    def unfiltered(self, raw):
        """The rows, each filter of the format undone."""
        stride, n = self.width * self.channels, self.channels
        expect(len(raw) == self.height * (stride + 1), "another number of bytes than pixels")
        rows, before = [], bytearray(stride)
        for y in range(self.height):
            kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
            for k in range(stride if kind else 0):
                left, up, corner = (row[k - n], before[k], before[k - n]) if k >= n else (0, before[k], 0)
                guess = left + up - corner
                paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
                row[k] = (row[k] + (left, up, (left + up) // 2, paeth)[kind - 1]) & 255
            rows.append(row)
            before = row
        return rows

    def pixel(self, x, y):
        return tuple(self.rows[y][self.channels * x:self.channels * (x + 1)])

    def colours(self):
        return {bytes(row[k:k + self.channels]) for row in self.rows for k in range(0, len(row), self.channels)}


def nodding_run(name):
    """A small run with a cloud."""
    drive = Drive(name)
    expect_exit(command("map", drive.log, "-o", drive.folder / "run", "-q", "--no-pictures"), 0)
    return drive


def views_of(*inputs):
    process = command("render", *inputs, "--list-views", "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "render_views")
    rows = json.loads(process.stdout)
    table = command("render", *inputs, "--list-views").stdout
    for row in rows:
        expect(row["available"] == (row["missing"] is None), f"{row}")
        name = row["view"] + (f" --as {row['as']}" if row["as"] else "")
        expect((re.search(rf"^{name} ", table, re.M) is not None) == row["available"], f"{name} in\n{table}")
    return {row["view"] for row in rows if row["available"]}, {row["default"]: row["view"] for row in rows if row["default"]}


def render_views_of_each_input():
    """--list-views of every kind of input; the default view of each gives a picture without any option."""
    require_viewer()
    drive = nodding_run("render_views")
    run = drive.folder / "run"
    flat, cloud, scene, path = {"map", "field", "trajectory"}, {"cloud"}, {"scene"}, {"trajectory"}
    nodding = flat | cloud | scene | {"scan", "graph", "loops"}
    cases = [
        ([RUN], flat | {"graph", "loops"}, {"still": "map", "film": "loops"}),
        ([run], nodding, {"both": "cloud"}),
        ([run / "cloud.ply"], cloud, {"both": "cloud"}),
        (["paper-a"], scene, {"both": "scene"}),
        ([drive.linkage], scene, {"both": "scene"}),
        ([run / "map.yaml"], {"map"}, {"still": "map"}),
        ([run / "gdt.yaml"], {"field"}, {"still": "field"}),
        ([RUN / "trajectory.tum"], path, {"still": "trajectory"}),
        ([RUN / "trajectory.tum", "--reference", TRUTH], path | {"errors"}, {"still": "errors"}),
    ]
    for inputs, views, defaults in cases:
        expect(views_of(*inputs) == (views, defaults), f"{inputs}: {views_of(*inputs)}, expected {views}, {defaults}")
    for number, (inputs, _, defaults) in enumerate(cases):
        folder = cli.fresh_folder(f"render_views/default{number}")
        said = rendered(*map(str, inputs), cwd=folder)
        expect((files := sorted(digests(folder))) == [said["file"]] and f"-{defaults.get('still', defaults.get('both'))}" in said["file"], f"{inputs}: {said}, {files}")
        png = (folder / said["file"]).read_bytes()
        expect(list(struct.unpack(">II", png[16:24])) == said["size_px"] and len(png) == said["bytes"], f"{inputs}: {said}")


def render_pngs():
    """Any size; background, floor, ceiling and path as asked for; the same bytes again."""
    require_viewer()
    drive = nodding_run("render_pngs")
    run, png = drive.folder / "run", drive.folder / "a.png"
    for size in ("1x1", "37x21", "160x100"):
        said = rendered(run, "-o", png, "--size", size)
        picture = Png(png)
        expect(f"{picture.width}x{picture.height}" == size and said["size_px"] == [picture.width, picture.height], f"{said}")
    first = png.read_bytes()
    rendered(run, "-o", png, "--size", "160x100")
    expect(png.read_bytes() == first, "the same picture has other bytes")
    small = ("--size", "160x100", "--hide", "caption")
    rendered(run, "-o", png, *small)
    expect(len(Png(png).colours()) > 200, "a picture of a cloud has many colours")
    expect(Png(png).pixel(0, 0)[:3] == (0x14, 0x17, 0x1C), f"the dark background: {Png(png).pixel(0, 0)}")
    rendered(run, "-o", png, *small, "--background", "light")
    expect(min(Png(png).pixel(0, 0)[:3]) > 200, f"the light background: {Png(png).pixel(0, 0)}")
    rendered(run, "-o", png, *small, "--background", "none")
    alphas = [Png(png).pixel(x, 50)[3] for x in range(160)]
    expect(alphas[0] == 0 and max(alphas) == 255, f"no background: {sorted(set(alphas))}")
    everything = rendered(run, "-o", png, "--size", "160x100", "--hide", "none")["points"]
    without_ceiling = rendered(run, "-o", png, *small)["points"]
    walls = rendered(run, "-o", png, "--size", "160x100", "--hide", "caption,floor")["points"]
    expect(everything > without_ceiling > walls > 0, f"{everything}, {without_ceiling}, {walls} points")
    expect(rendered(run, "-o", png, *small, "--points", 2000)["points"] <= 2000, "thinned")
    colours = set()
    for colour in ("height", "elevation", "time", "scan", "plain"):
        rendered(run, "-o", png, *small, "--colour", colour)
        colours.add(png.read_bytes())
    rendered(run, "-o", png, *small, "--reference", run / "cloud.ply")  # distances, all 0
    colours.add(png.read_bytes())
    expect(len(colours) == 6, "two colours of the points give one picture")


def boxes_of(text):
    """Width and height of a drawing in SVG."""
    root = xml.fromstring(text)
    expect(root.tag == "{http://www.w3.org/2000/svg}svg", f"{root.tag}")
    return float(root.get("width")), float(root.get("height")), root


def render_drawings():
    """SVG as XML and PDF by its structure, of a plot, a drawing, a map and a scene."""
    require_viewer()
    drive = nodding_run("render_drawings")
    run, folder = drive.folder / "run", drive.folder
    for view in ("map", "cloud", "trajectory"):
        said = rendered(run, "--view", view, "-o", folder / "a.svg")
        width, height, root = boxes_of((folder / "a.svg").read_text())
        expect([round(width), round(height)] == said["size_px"], f"{view}: {width}x{height}, {said}")
        images = root.findall(".//{http://www.w3.org/2000/svg}image")
        expect((view in ("map", "cloud")) == bool(images), f"{view}: {len(images)} pictures inside")
        rendered(run, "--view", view, "-o", folder / "a.pdf")
        pdf = (folder / "a.pdf").read_bytes()
        expect(pdf.startswith(b"%PDF-1.") and pdf.rstrip().endswith(b"%%EOF"), f"{view}: no whole PDF")
        expect(len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf)) == 1, f"{view}: one page")
    rendered(RUN, RUN / "trajectory.tum", "--reference", TRUTH, "--view", "errors", "--as", "cdf", "-o", folder / "e.svg")
    words = "".join(xml.fromstring((folder / "e.svg").read_text()).itertext())
    mean = json.loads(command("evaluate", RUN / "trajectory.tum", "--reference", TRUTH, "--json").stdout)["ate"]["translation_m"]
    expect("office" in words and "trajectory" in words and f"{mean['median']:.3g}" in words, f"{mean['median']:.3g} in {words}")


def words_of(*arguments, **options):
    """Everything that is written in a picture."""
    svg = arguments[0] if isinstance(arguments[0], pathlib.Path) else pathlib.Path(arguments[0])
    rendered(*arguments[1:], "-o", svg, **options)
    return " ".join(xml.fromstring(svg.read_text()).itertext())


def render_figures():
    """Numbers in captions, pages and on the terminal are those of the picture: points that are drawn, the path's length."""
    require_viewer()
    drive = nodding_run("render_figures")
    run, svg = drive.folder / "run", drive.folder / "a.svg"
    report = json.loads((run / "report.json").read_text())
    places = [tuple(map(float, line.split()[1:3])) for line in (run / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    path = f"{sum(math.dist(a, b) for a, b in zip(places, places[1:])):.1f} m"
    for more in ((), ("--points", 5000), ("--from", "front", "--hide", "floor"), ("--hide", "none")):
        said = rendered(run, *more, "-o", svg)
        whole = report["cloud_points"]
        expect(said["points_of"] == whole and said["points"] <= whole, f"{said}, {whole} in the report")
        count = f"{said['points']:,} of {whole:,} points" if said["points"] < whole else f"{whole:,} points"
        words = words_of(svg, run, *more)
        expect(f"{count}, {path} of path" in words, f"{more}: {count!r}, {path!r} is not in {words}")
        text = command("render", run, *more, "-o", svg, "--force").stdout
        expect(f" {count}," in text, f"{count!r} is not in {text}")
    said = rendered(run, "--view", "scan", "--time", "2s:6s", "-o", svg)
    expect(said["points"] <= said["points_of"] < 0.5 * report["cloud_points"], f"{said}")
    page = drive.folder / "a.html"
    said = rendered(run, "-o", page, "--points", 5000)
    count = f"{said['points']:,} of {report['cloud_points']:,}"
    expect(f"{count} points, {path} of path" in page.read_text() and f'"{count}"' in page.read_text(), f"{count}, {path} in the page")
    words = words_of(svg, RUN, "--view", "map")
    expect(f"{len(json.loads((RUN / 'report.json').read_text())['keyframe_scans']):,} keyframes" in words, words)
    standing = "".join(f"{k} 0 0.001 0 0 0 0 1\n" for k in range(len(places)))
    without_told_files(run)
    (run / "trajectory.tum").write_text(standing)
    expect("of path" not in words_of(svg, run, "--view", "cloud"), "a robot that stands has a path")


def render_clouds_of_others():
    """A cloud without a run, a run without its trajectory, points that are no places."""
    require_viewer()
    drive = nodding_run("render_clouds_of_others")
    run, folder = drive.folder / "run", drive.folder / "only-a-cloud"
    folder.mkdir()
    shutil.copy(run / "cloud.ply", folder)
    expect(views_of(folder)[0] == {"cloud"}, f"{views_of(folder)}")
    rendered(folder, "-o", drive.folder / "a.png", "--size", "64x48")
    (run / "trajectory.tum").unlink()
    process = command("render", run, "-o", drive.folder / "b.png", "--size", "64x48")
    expect_exit(process, 65)
    expect("trajectory.tum: is missing in this run" in process.stderr, process.stderr)
    without_told_files(run)
    process = command("render", run, "-o", drive.folder / "b.png", "--size", "64x48")
    expect_exit(process, 0)
    expect("has no trajectory.tum" in process.stderr, process.stderr)
    refused(2, run, "-q", "--from", "robot", "-o", drive.folder / "f.png", says="no trajectory")
    head = "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    strays = "nan 0 0\n1e30 0 0\n"
    good = "".join(f"{x} {y} 0.5\n" for x in range(4) for y in range(3))
    cloud = drive.folder / "strays.ply"
    cloud.write_text(head.format(14) + good + strays)
    process = command("render", cloud, "-o", drive.folder / "c.png", "--size", "64x48", "--json")
    expect_exit(process, 0)
    expect("strays.ply: 2 points are left out, not finite or more than 1000 km" in process.stderr and json.loads(process.stdout)["points"] == 12, process.stderr)
    cloud.write_text(head.format(2) + strays)
    refused(65, cloud, "-o", drive.folder / "d.png", says=("strays.ply", "1000 km"))


def render_models():
    """Clouds and pages for other programs: every point is there, without floor and ceiling if that is asked for."""
    require_viewer()
    drive = nodding_run("render_models")
    run, folder = drive.folder / "run", drive.folder
    said = rendered(run, "-o", folder / "w.ply", "--hide", "floor,ceiling")
    heights = [place[2] for place in points_of(folder / "w.ply")]
    expect(len(heights) == said["points"], f"{said}")
    expect(-0.01 < min(heights) and max(heights) < 2.41 and sum(0.06 < z < 2.34 for z in heights) > 0.98 * len(heights), "no floor, no ceiling")
    expect(rendered(run, "-o", folder / "w.png", "--from", "front", "--hide", "floor,ceiling")["points"] == len(heights), "as pictures")
    said = rendered(run, "-o", folder / "a.ply", "--points", 500)
    again = command("render", folder / "a.ply", "-o", folder / "b.pcd", "--json")
    expect_exit(again, 0)
    expect(0 < said["points"] <= 500 and json.loads(again.stdout)["points"] == said["points"], f"{said}")
    page = rendered(run, "-o", folder / "a.html")
    text = (folder / "a.html").read_text()
    expect(page["points"] > 1000 and text.lower().startswith("<!doctype html>"), "a page")
    expect(not re.search(r"""(src|href)\s*=\s*["']?(https?:)?//""", text), "the page loads something from elsewhere")


def probe(path):
    """Codec, size, rate and counted frames of a film."""
    process = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                              "stream=codec_name,width,height,r_frame_rate,nb_read_frames", "-of", "json", str(path)],
                             capture_output=True, text=True, check=True)
    stream = json.loads(process.stdout)["streams"][0]
    return stream["codec_name"], stream["width"], stream["height"], stream["r_frame_rate"], int(stream["nb_read_frames"])


def render_films():
    """MP4 and GIF by ffprobe, frames in a folder and by a pattern; a turn of the linkage begins as it ends."""
    require_viewer()
    require_ffmpeg()
    drive = nodding_run("render_films")
    run, folder = drive.folder / "run", drive.folder
    small = ("--size", "160x90")
    said = rendered("paper-b", "-o", folder / "b.mp4", *small, "--seconds", "0.5s", "--fps", 24)
    expect(probe(folder / "b.mp4") == ("h264", 160, 90, "24/1", 12) and said["frames"] == 12, f"{probe(folder / 'b.mp4')}, {said}")
    rendered(run, "-o", folder / "o.gif", *small, "--seconds", "0.5s", "--fps", 10)
    expect(probe(folder / "o.gif") == ("gif", 160, 90, "10/1", 5), f"{probe(folder / 'o.gif')}")
    for view in (("--from", "robot"), ("--view", "scan")):
        rendered(run, "-o", folder / "v.mp4", *view, *small, "--seconds", "0.24s")
        expect(probe(folder / "v.mp4")[1:] == (160, 90, "25/1", 6), f"{view}: {probe(folder / 'v.mp4')}")
    said = rendered(run, "-o", f"{folder}/frames/", *small, "--seconds", "0.3s", "--fps", 10)
    frames = sorted((folder / "frames").iterdir())
    expect([path.name for path in frames] == [f"frame-000{k}.png" for k in (1, 2, 3)], f"{frames}")
    expect(said["bytes"] == sum(path.stat().st_size for path in frames), f"{said}")
    expect(len({path.read_bytes() for path in frames}) == 3, "the frames are one picture")
    refused(2, run, "-o", folder / "t.mp4", "--from", "top", says="--from iso")


def render_loops():
    """The film of loops closing: the same bytes again, counts as in the report, a still end; before and after as a still."""
    require_viewer()
    folder = cli.fresh_folder("render_loops")
    small = ("--size", "320x200")
    said = rendered(RUN, "-o", f"{folder}/a/", *small, "--seconds", "8s", "--fps", 5)
    expect(said["view"] == "loops" and said["frames"] == 40, f"{said}")
    frames = [path.read_bytes() for path in sorted((folder / "a").iterdir())]
    expect(len(set(frames[:30])) == 30, "frames of the drive are the same picture")
    expect(len(set(frames[-5:])) == 1 and frames[-6] != frames[-5], "the last second does not stand still")
    rendered(RUN, "-o", f"{folder}/b/", *small, "--seconds", "8s", "--fps", 5)
    expect([path.read_bytes() for path in sorted((folder / "b").iterdir())] == frames, "the same film has other bytes")
    rendered(RUN, "-o", f"{folder}/c/", "--view", "loops", *small, "--seconds", "0.04s")
    expect(len(list((folder / "c").iterdir())) == 1, "a film of one frame")
    said = rendered(RUN, "-o", folder / "a.png", "--view", "loops")
    expect(Png(folder / "a.png").width == 1600 == said["size_px"][0], f"{said}")
    report = json.loads((RUN / "report.json").read_text())
    found, on = report["loops"]["found"], report["loops"]["on"]
    words = words_of(folder / "a.svg", RUN, "--view", "loops")
    expect((f"{found} loops, all on" if on == found else f"{on} of {found} loops on") in words, f"{words}")
    expect("as it was driven" in words and "With loops" in words and f"{report['path_m']:.0f} m" in words, f"{words}")
    refused(2, RUN, "--view", "loops", "--hide", "path", "-o", folder / "b.png", says="--hide path")
