# Reads a page as make_page writes it, without any of its code; the layout is that of viewer/scene/cloud/page.cpp and
# engine/drawing/page/page_writer.hpp.
import base64
import json
import re
import struct


class PageFile:
    def __init__(self, path):
        with open(path, encoding="utf-8", errors="strict") as file:
            self.text = file.read()
        self.description = json.loads(self.element("description"))

    def element(self, name):
        found = re.findall(r'<script type="[a-z/]+" id="%s">(.*?)</script>' % re.escape(name), self.text, re.S)
        if len(found) != 1:
            raise ValueError(f"{len(found)} elements {name}")
        return found[0]

    def bytes_of(self, name):
        return base64.b64decode(self.element(name), validate=True)

    def points(self):
        """(x, y, z, stamp, elevation, scan, distance, level) of each point in the order of the cloud's kept points; the
        level is a code, the others are what their 8 or 16 bits stand for."""
        about = self.description["cloud"]
        data = b"".join(self.bytes_of(f"points-{k}") for k in range(about["elements"]))
        count = about["count"]
        out = [None] * count

        def value(quantity, share):
            span = about.get(quantity)
            return span and span["least"] + share * (span["most"] - span["least"])

        for k, (x, y, z, t, e, s, d, level) in enumerate(struct.iter_unpack("<4H4B", data)):
            place = [low + w / 65535 * (high - low) for low, high, w in zip(about["least"], about["most"], (x, y, z))]
            out[k * about["step"] % count] = (*place, value("time", t / 65535), value("elevation", e / 255),
                                              value("scan", s / 255), value("distance", d / 255), level)
        return out

    def path(self):
        x, y, _ = self.description["origin"]
        first = self.description["path"]["first"]
        poses = struct.iter_unpack("<4f", self.bytes_of("path"))
        return [(first + t, px + x, py + y, heading) for px, py, heading, t in poses]

    def map_cells(self):
        """0 unknown, 1 free, 2 occupied; the lower left cell first."""
        about = self.description["map"]
        packed = self.bytes_of("map")
        return [packed[k >> 2] >> 2 * (k & 3) & 3 for k in range(about["width"] * about["height"])]

    def linkage_rows(self):
        """(ax, ay, bx, by, mx, my, elevation, transmission) of each step of the crank."""
        return list(struct.iter_unpack("<8f", self.bytes_of("linkage")))
