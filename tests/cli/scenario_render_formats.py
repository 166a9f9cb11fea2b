"""gdtslam render: what other programs open (.glb), paths alone and over the truth, and the pictures that map leaves."""

import json
import math
import struct
import xml.etree.ElementTree as xml

import cli_support as cli
from cli_support import RUN, TRUTH, command, expect, expect_exit
from nodding_log import Drive
from scenario_render import nodding_run, refused, rendered, require_viewer, words_of


def render_pictures_of_map():
    """What `map` leaves in the run folder is what `render` draws of it: flat pictures byte by byte. The path through a cloud is a
    tube around poses that the file of the trajectory rounds, so that single pixels may differ."""
    require_viewer()
    drive = Drive("render_pictures_of_map")
    run = drive.folder / "run"
    expect_exit(command("map", drive.log, "-o", run, "-q"), 0)
    for view, kept in (("map", "overview.png"), ("graph", "graph.png")):
        rendered(run, "--view", view, "-o", drive.folder / "a.png")
        expect((drive.folder / "a.png").read_bytes() == (run / kept).read_bytes(), f"{kept} is not the view {view}")


class Glb:
    """A .glb by section 4.4 of glTF 2.0, every reference followed: what is not as the format wants it is refused."""

    SIZES = {5123: 2, 5125: 4, 5126: 4}
    COUNTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}

    def __init__(self, path):
        data = path.read_bytes()
        magic, version, length = struct.unpack("<4sII", data[:12])
        expect((magic, version, length) == (b"glTF", 2, len(data)), f"{path}: {magic}, {version}, {length} of {len(data)} bytes")
        chunks, at = [], 12
        while at < len(data):
            size, kind = struct.unpack("<I4s", data[at:at + 8])
            expect(size % 4 == 0 and at + 8 + size <= len(data), f"{path}: a chunk of {size} bytes at {at}")
            chunks.append((kind, data[at + 8:at + 8 + size]))
            at += 8 + size
        expect([kind for kind, _ in chunks] == [b"JSON", b"BIN\0"], f"{path}: chunks {[kind for kind, _ in chunks]}")
        self.json, self.bytes = json.loads(chunks[0][1].decode("utf-8")), chunks[1][1]
        expect(self.json["asset"]["version"] == "2.0" and len(self.json["buffers"]) == 1, f"{path}: {self.json['asset']}")
        expect("uri" not in self.json["buffers"][0] and 0 <= len(self.bytes) - self.json["buffers"][0]["byteLength"] < 4, f"{path}: the buffer")
        used = set()
        for node in self.nodes_below(self.json["scenes"][self.json["scene"]]["nodes"]):
            expect(node not in used, f"{path}: node {node} hangs in two places")
            used.add(node)
        expect(used == set(range(len(self.json["nodes"]))), f"{path}: nodes in no scene")
        for mesh in self.json["meshes"]:
            for primitive in mesh["primitives"]:
                self.check_primitive(primitive)
        for animation in self.json.get("animations", []):
            for channel in animation["channels"]:
                self.check_channel(animation["samplers"][channel["sampler"]], channel["target"])

    def nodes_below(self, nodes):
        for node in nodes:
            yield node
            yield from self.nodes_below(self.json["nodes"][node].get("children", []))

    def values(self, number):
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        size, count = self.SIZES[accessor["componentType"]], self.COUNTS[accessor["type"]]
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        expect(begin % size == 0 and size * count * accessor["count"] <= view["byteLength"], f"accessor {number}: {accessor}, {view}")
        expect(view.get("byteOffset", 0) + view["byteLength"] <= self.json["buffers"][view["buffer"]]["byteLength"], f"view {view}")
        kind = {5123: "H", 5125: "I", 5126: "f"}[accessor["componentType"]]
        rows = list(struct.iter_unpack(f"<{count}{kind}", self.bytes[begin:begin + size * count * accessor["count"]]))
        for name, pick in (("min", min), ("max", max)):
            if name in accessor:
                expect([pick(column) for column in zip(*rows)] == accessor[name], f"accessor {number}: {name} {accessor[name]}")
        return rows

    def check_primitive(self, primitive):
        expect("min" in self.json["accessors"][primitive["attributes"]["POSITION"]], "places without bounds")
        counts = {name: len(self.values(number)) for name, number in primitive["attributes"].items()}
        expect(len(set(counts.values())) == 1, f"{counts}")
        expect(primitive["material"] < len(self.json["materials"]), "no such material")
        if "NORMAL" in primitive["attributes"]:
            for normal in self.values(primitive["attributes"]["NORMAL"]):
                expect(abs(math.hypot(*normal) - 1.0) < 1e-4, f"a normal of length {math.hypot(*normal)}")
        if "indices" in primitive:
            corners = [index for (index,) in self.values(primitive["indices"])]
            expect(len(corners) % 3 == 0 and max(corners) < counts["POSITION"], "triangles of places that are not there")

    def check_channel(self, sampler, target):
        times = [time for (time,) in self.values(sampler["input"])]
        expect(times[0] >= 0 and all(a < b for a, b in zip(times, times[1:])), f"times {times}")
        expect("min" in self.json["accessors"][sampler["input"]], "times without bounds")
        values = self.values(sampler["output"])
        expect(len(values) == len(times) and target["node"] < len(self.json["nodes"]), f"{target}")
        if target["path"] == "rotation":
            expect(all(abs(math.hypot(*value) - 1.0) < 1e-5 for value in values), "a rotation that is none")


def render_glb():
    """A .glb of a cloud has every point; that of a linkage its parts, turning as the four bars allow."""
    require_viewer()
    drive = nodding_run("render_glb")
    run, folder = drive.folder / "run", drive.folder
    said = rendered(run, "-o", folder / "a.glb", "--points", 3000)
    places = Glb(folder / "a.glb").values(0)
    expect(len(places) == said["points"], f"{said}")
    height = max(place[1] for place in places) - min(place[1] for place in places)
    expect(2.2 < height < 2.7, f"the room is 2.4 m high, and y is up: {height}")
    rendered("paper-b", "-o", folder / "b.glb")
    linkage = Glb(folder / "b.glb")
    parts = {node["name"]: k for k, node in enumerate(linkage.json["nodes"])}
    expect({"ground", "crank", "coupler", "rocker", "laser", "fan"} < set(parts), f"{parts}")
    animation = linkage.json["animations"][0]
    tracks = {(channel["target"]["node"], channel["target"]["path"]): linkage.values(animation["samplers"][channel["sampler"]]["output"])
              for channel in animation["channels"]}
    expect((parts["ground"], "rotation") not in tracks, "the ground turns")

    def end(part, length, k):
        """Where a bar ends: it lies along the x of its part, and turns about y."""
        x, y, z, w = tracks[parts[part], "rotation"][k]
        place = tracks[parts[part], "translation"][k]
        along = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
        return [p + length * a for p, a in zip(place, along)]
    sizes = {name: float(value) for name, value in json.loads(command("linkage", "paper-b", "--json").stdout)["bars_m"].items()}
    for k in range(len(tracks[parts["crank"], "rotation"])):
        crank, coupler, rocker = (end(part, sizes[part], k) for part in ("crank", "coupler", "rocker"))
        expect(math.dist(crank, tracks[parts["coupler"], "translation"][k]) < 1e-5, f"crank and coupler come apart at {k}")
        expect(math.dist(coupler, rocker) < 1e-5, f"coupler and rocker come apart at {k}")
    refused(2, "paper-b", "-o", folder / "c.glb", "--colour", "time", says="--colour")


def render_trajectories():
    """A path alone, over the truth, coloured by its error: words, colours and figures are those of `evaluate`."""
    require_viewer()
    folder = cli.fresh_folder("render_trajectories")
    path, svg = RUN / "trajectory.tum", folder / "a.svg"
    rendered(path, "-o", svg)
    words = " ".join(xml.fromstring(svg.read_text()).itertext())
    expect("start" in words and "end, after" in words and "m of path" in words, words)
    looks = set()
    for colours in ((), ("--colour-map", "lagoon"), ("--colour-map", "ember")):
        rendered(path, "-o", folder / "a.png", "--size", "300x200", *colours)
        looks.add((folder / "a.png").read_bytes())
        rendered(RUN, "--view", "map", "-o", folder / "a.png", "--size", "300x200", *colours)
        looks.add((folder / "a.png").read_bytes())
    expect(len(looks) == 6, "a path has the same colours with another map")
    truth = words_of(svg, path, "--view", "trajectory", "--reference", TRUTH)
    expect("truth" in truth and "trajectory" in truth, truth)
    both = words_of(svg, RUN, path, "--view", "trajectory", "--reference", TRUTH)
    expect("2 paths" in both and "office" in both, both)
    said = json.loads(command("evaluate", path, "--reference", TRUTH, "--json").stdout)["ate"]["translation_m"]
    words = words_of(svg, path, "--view", "errors", "--as", "path", "--reference", TRUTH)
    expect("Position error (m)" in words and f"RMSE {said['rmse']:#.3g} m" in words and f"largest {said['max']:#.3g} m" in words, f"{said}: {words}")
    said = json.loads(command("evaluate", TRUTH, "--reference", RUN, "--json").stdout)["ate"]["translation_m"]
    words = words_of(svg, TRUTH, "--view", "errors", "--as", "path", "--reference", RUN)
    expect(f"RMSE {said['rmse']:#.3g} m" in words and f"largest {said['max']:#.3g} m" in words, f"against a run: {said}: {words}")
    truth = words_of(svg, TRUTH, "--view", "trajectory", "--reference", RUN)
    expect("truth" in truth, f"over a run: {truth}")
    words = words_of(svg, path, "--view", "errors", "--as", "path", "--reference", TRUTH, "--range", "0m:5cm")
    expect("0.05" in words.split(), words)
    refused(2, path, "--view", "errors", "--as", "path", "-o", svg, "--force", says="true trajectory (--reference FILE)")
    refused(2, RUN, "--colour-map", "rainbow", "-o", svg, "--force", says=("lagoon", "tide"))
    refused(2, path, "--view", "trajectory", "--reference", TRUTH, "--colour-map", "ember", "-o", svg, "--force", says="--colour-map")
