"""Pictures of `gdtslam register`."""

import re
import xml.etree.ElementTree as xml

import cli_support as cli
from cli_support import command, expect, expect_exit
from scenario_linkage import png_size


def register_pictures():
    """A PNG of twice the drawing's size, an SVG with the numbers of the output, a PDF; the same bytes again."""
    folder = cli.fresh_folder("register_pictures")
    pair = ("register", cli.DATA / "room.ply", cli.DATA / "room_moved.ply")
    for name in ("one.png", "two.png", "one.svg", "one.pdf"):
        process = command(*pair, "--picture", folder / name)
        expect_exit(process, 0)
    size = png_size((folder / "one.png").read_bytes())
    expect(size[0] == 2680 and size[1] > 1000, f"{size}")
    expect((folder / "one.png").read_bytes() == (folder / "two.png").read_bytes(), "two pictures of one pair differ")
    words = xml.parse(folder / "one.svg").find("{http://www.w3.org/2000/svg}desc").text
    expect("registered" in words and "overlap 100 %" in words, words)
    for end, start in re.findall(r"([\d.]+ mm) from the planes \(([\d.]+ mm) at the start\)", process.stdout):
        expect(f"median {start}" in words and f"median {end}" in words, f"{start} and {end} are not in {words}")
    expect((folder / "one.pdf").read_bytes().startswith(b"%PDF-1."), "no PDF")
