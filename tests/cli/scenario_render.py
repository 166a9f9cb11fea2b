"""gdtslam render from the outside: what each input can be drawn as, and files that other programs open."""

import base64
import json
import os
import re
import struct
import subprocess
import xml.etree.ElementTree as xml
import zlib

import cli_support as cli
from cli_support import LOG, RUN, TRUTH, command, digests, expect, expect_exit, one_error_line, skip
from nodding_log import Drive


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
    process = command("render", *arguments, "--json", **options)
    expect_exit(process, 0)
    expect(process.stderr == "", f"stderr is not empty: {process.stderr}")
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
    """A PNG file taken apart: RGBA or RGB pixels of 8 bits."""

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
                expect(depth == 8 and colour in (2, 6), f"{path}: depth {depth}, colour type {colour}")
                self.channels = 3 if colour == 2 else 4
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
    rows = json.loads(process.stdout)
    table = command("render", *inputs, "--list-views").stdout
    for row in rows:
        expect(row["available"] == (row["missing"] is None), f"{row}")
        expect((re.search(rf"^{row['view']} ", table, re.M) is not None) == row["available"], f"{row['view']} in\n{table}")
    return {row["view"] for row in rows if row["available"]}, {row["default"]: row["view"] for row in rows if row["default"]}


def render_views_of_each_input():
    """--list-views of every kind of input; the default view of each gives a picture without any option."""
    require_viewer()
    drive = nodding_run("render_views")
    run = drive.folder / "run"
    flat = {"map", "field", "distance", "cells"}
    solid = {"iso", "top", "front", "side", "orbit", "elevation"}
    errors = {"errors-box", "errors-cdf", "errors-time"}
    linkage = {"scene", "drawing"}
    cases = [
        ([RUN], flat, {"still": "map"}),
        ([run], flat | solid | linkage | {"follow", "scan"}, {"still": "iso", "film": "orbit"}),
        ([run / "cloud.ply"], solid, {"still": "iso", "film": "orbit"}),
        (["paper-a"], linkage, {"still": "scene"}),
        ([drive.linkage], linkage, {"still": "scene"}),
        ([run / "map.yaml"], {"map"}, {"still": "map"}),
        ([run / "gdt.yaml"], {"field", "distance", "cells"}, {"still": "field"}),
        ([LOG], flat, {"still": "map"}),
        ([drive.log], flat | solid | linkage | {"follow", "scan"}, {"still": "iso", "film": "orbit"}),
        ([RUN / "trajectory.tum", "--reference", TRUTH], errors, {"still": "errors-box"}),
    ]
    for inputs, views, defaults in cases:
        expect(views_of(*inputs) == (views, defaults), f"{inputs}: {views_of(*inputs)}, expected {views}, {defaults}")
    for number, (inputs, _, defaults) in enumerate(cases):
        folder = cli.fresh_folder(f"render_views/default{number}")
        said = rendered(*map(str, inputs), cwd=folder)
        files = sorted(digests(folder))
        expect(files == [said["file"]] and said["file"].endswith(f"-{defaults['still']}.png"), f"{inputs}: {said}, {files}")
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
    small = ("--size", "160x100", "--no-caption")
    rendered(run, "-o", png, *small)
    expect(len(Png(png).colours()) > 200, "a picture of a cloud has many colours")
    expect(Png(png).pixel(0, 0)[:3] == (0x14, 0x17, 0x1C), f"the dark background: {Png(png).pixel(0, 0)}")
    rendered(run, "-o", png, *small, "--light")
    expect(min(Png(png).pixel(0, 0)[:3]) > 200, f"the light background: {Png(png).pixel(0, 0)}")
    rendered(run, "-o", png, *small, "--transparent")
    alphas = [Png(png).pixel(x, 50)[3] for x in range(160)]
    expect(alphas[0] == 0 and max(alphas) == 255, f"no background: {sorted(set(alphas))}")
    everything = rendered(run, "-o", png, *small, "--with-ceiling")["points"]
    without_ceiling = rendered(run, "-o", png, *small)["points"]
    walls = rendered(run, "-o", png, *small, "--no-floor")["points"]
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
    for view in ("map", "cells", "drawing", "iso", "elevation"):
        said = rendered(run, "--view", view, "-o", folder / "a.svg")
        width, height, root = boxes_of((folder / "a.svg").read_text())
        expect([round(width), round(height)] == said["size_px"], f"{view}: {width}x{height}, {said}")
        images = root.findall(".//{http://www.w3.org/2000/svg}image")
        expect((view in ("map", "iso")) == bool(images), f"{view}: {len(images)} pictures inside")
        rendered(run, "--view", view, "-o", folder / "a.pdf")
        pdf = (folder / "a.pdf").read_bytes()
        expect(pdf.startswith(b"%PDF-1.") and pdf.rstrip().endswith(b"%%EOF"), f"{view}: no whole PDF")
        expect(len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf)) == 1, f"{view}: one page")
    rendered(RUN, RUN / "trajectory.tum", "--reference", TRUTH, "--view", "errors-cdf", "-o", folder / "e.svg")
    words = "".join(xml.fromstring((folder / "e.svg").read_text()).itertext())
    mean = json.loads(command("evaluate", RUN / "trajectory.tum", "--reference", TRUTH, "--json").stdout)["ate"]["translation_m"]
    expect("office" in words and "trajectory" in words and f"{mean['median']:.3g}" in words, f"{mean['median']:.3g} in {words}")


def render_models():
    """glTF, VTP and PLY: every reference within bounds, every point there, by parsers of Python's own."""
    require_viewer()
    drive = nodding_run("render_models")
    run, folder = drive.folder / "run", drive.folder
    said = rendered(run, "-o", folder / "a.gltf")
    gltf = json.loads((folder / "a.gltf").read_text())
    head, data = gltf["buffers"][0]["uri"].split(",")
    expect(head == "data:application/octet-stream;base64", head)
    data = base64.b64decode(data, validate=True)
    expect(len(data) == gltf["buffers"][0]["byteLength"], f"{len(data)} bytes")
    places = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    view = gltf["bufferViews"][places["bufferView"]]
    expect(places["count"] == said["points"] and view["byteLength"] == 12 * places["count"], f"{places}, {view}")
    points = list(struct.iter_unpack("<3f", data[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]))
    for axis in range(3):
        values = [point[axis] for point in points]
        expect(min(values) == places["min"][axis] and max(values) == places["max"][axis], f"bounds of axis {axis}")
    height = places["max"][1] - places["min"][1]
    expect(2.2 < height < 2.7, f"the room is 2.4 m high, and y is up: {height}")
    said = rendered(run, "-o", folder / "a.vtp", "--no-floor", "--no-ceiling")
    piece = xml.parse(folder / "a.vtp").getroot().find("PolyData/Piece")
    array = base64.b64decode(piece.find("Points/DataArray").text)
    (size,) = struct.unpack("<Q", array[:8])
    expect(int(piece.get("NumberOfPoints")) == said["points"] and size == 12 * said["points"] == len(array) - 8, f"{said}")
    heights = [place[2] for place in struct.iter_unpack("<3f", array[8:])]
    expect(-0.01 < min(heights) and max(heights) < 2.41 and sum(0.06 < z < 2.34 for z in heights) > 0.98 * len(heights), "no floor, no ceiling")
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
    said = rendered("paper-b", "-o", folder / "b.mp4", *small, "--frames", 12, "--fps", 24)
    expect(probe(folder / "b.mp4") == ("h264", 160, 90, "24/1", 12) and said["frames"] == 12, f"{probe(folder / 'b.mp4')}, {said}")
    rendered(run, "-o", folder / "o.gif", *small, "--seconds", "0.5s", "--fps", 10)
    expect(probe(folder / "o.gif") == ("gif", 160, 90, "10/1", 5), f"{probe(folder / 'o.gif')}")
    for view in ("follow", "scan"):
        rendered(run, "-o", folder / "v.mp4", "--view", view, *small, "--frames", 6)
        expect(probe(folder / "v.mp4")[1:] == (160, 90, "25/1", 6), f"{view}: {probe(folder / 'v.mp4')}")
    said = rendered(run, "-o", f"{folder}/frames/", "--view", "orbit", *small, "--frames", 3)
    frames = sorted((folder / "frames").iterdir())
    expect([path.name for path in frames] == [f"frame-000{k}.png" for k in (1, 2, 3)], f"{frames}")
    expect(said["bytes"] == sum(path.stat().st_size for path in frames), f"{said}")
    expect(len({path.read_bytes() for path in frames}) == 3, "the frames are one picture")
    rendered("paper-b", "-o", f"{folder}/f%02d.png", *small, "--frames", 2, "--no-caption")
    expect((Png(folder / "f01.png").width, Png(folder / "f02.png").height) == (160, 90), "frames by a pattern")


def render_log():
    """A log is mapped first: into a folder that goes, or into --run, whose files are those of map."""
    require_viewer()
    folder = cli.fresh_folder("render_log")
    (folder / "tmp").mkdir()
    environment = {**os.environ, "TMPDIR": str(folder / "tmp")}
    rendered(LOG, "-o", folder / "a.png", "--size", "200x100", env=environment)
    expect(Png(folder / "a.png").width == 200 and not list((folder / "tmp").iterdir()), "the temporary run is still there")
    rendered(LOG, "-o", folder / "b.png", "--size", "200x100", "--run", folder / "kept")
    expect((folder / "a.png").read_bytes() == (folder / "b.png").read_bytes(), "another picture")
    expect(sorted(digests(folder / "kept")) == cli.OUTPUTS, f"{sorted(digests(folder / 'kept'))}")
    refused(65, cli.DATA / "malformed.log", "-o", folder / "c.png", says="malformed.log:3", env=environment)
    refused(2, RUN, "--run", folder / "x", says="--run is for logs")
    expect(not (folder / "c.png").exists() and not list((folder / "tmp").iterdir()), "something is left")
