"""What `gdtslam linkage` writes: table, drawing, linkage files."""

import csv
import io
import json
import math
import re
import struct
import xml.etree.ElementTree as xml
import zlib

import cli_support as cli
from cli_support import command, expect, expect_exit


def by_circles(bars, crank):
    """Rocker and transmission angle of the open linkage, from the two points where two circles meet."""
    ax, ay = bars["crank"] * math.cos(crank), bars["crank"] * math.sin(crank)
    dx, dy = bars["ground"] - ax, -ay
    distance = math.hypot(dx, dy)
    along = (distance**2 + bars["coupler"] ** 2 - bars["rocker"] ** 2) / (2 * distance)
    across = math.sqrt(bars["coupler"] ** 2 - along**2)
    bx = ax + (along * dx - across * dy) / distance
    by = ay + (along * dy + across * dx) / distance
    cosine = (bars["coupler"] ** 2 + bars["rocker"] ** 2 - distance**2) / (2 * bars["coupler"] * bars["rocker"])
    return math.atan2(by, bx - bars["ground"]), math.acos(abs(cosine))


def linkage_table():
    """Every row of the CSV is that of two circles; rates are the differences of the rows."""
    folder = cli.fresh_folder("linkage_table")
    process = command("linkage", "paper-b", "--json", "--csv", folder / "turn.csv", "--step", "0.5deg")
    expect_exit(process, 0)
    cli.validate(process.stdout, "linkage")
    report = json.loads(process.stdout)
    rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(io.StringIO((folder / "turn.csv").read_text()))]
    expect(len(rows) == 721 and rows[0]["crank_deg"] == 0.0 and rows[-1]["crank_deg"] == 360.0, f"{len(rows)} rows")
    for row in rows:
        rocker, transmission = by_circles(report["bars_m"], math.radians(row["crank_deg"]))
        expect(abs(row["rocker_deg"] - math.degrees(rocker)) < 2e-6, f"rocker at {row}")
        expect(abs(row["transmission_deg"] - math.degrees(transmission)) < 2e-6, f"transmission at {row}")
    for before, row, after in zip(rows, rows[1:], rows[2:]):
        expect(abs(row["rocker_rate"] - (after["rocker_deg"] - before["rocker_deg"])) < 1e-3, f"rate at {row}")
    elevations = [row["elevation_deg"] for row in rows]
    lift = report["crank_rocker"]
    expect(abs(min(elevations)) < 1e-3 and abs(max(elevations) - lift["swing_deg"]) < 1e-2, "the elevations' range")
    rising = sum(after > before for before, after in zip(elevations, elevations[1:])) / 720
    expect(abs(360 * rising - lift["lift_deg"]) < 1.5, f"{360 * rising} degrees rise")


def linkage_drawing():
    """The drawing is XML with the bars' names and lengths, twice the same bytes."""
    folder = cli.fresh_folder("linkage_drawing")
    for name in ("one", "two"):
        expect_exit(command("linkage", "paper-a-calibrated", "--svg", folder / f"{name}.svg"), 0)
    first = (folder / "one.svg").read_bytes()
    expect(first == (folder / "two.svg").read_bytes(), "two drawings differ")
    words = xml.fromstring(first).find("{http://www.w3.org/2000/svg}desc").text
    for word in ("paper-a-calibrated", "crank", "3.4822 cm", "8.7625 cm", "8.71 cm", "12.178 cm", "47.2°", "lift 183.1°",
                 "least 52.7°", "Transmission angle"):
        expect(word in words, f"no {word!r} in {words}")
    expect(b"nan" not in first and b"inf" not in first, "a place that is no number")


def png_size(data):
    """Width and height that a PNG's header states; its checksums and its data are right."""
    expect(data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG")
    at, size, pixels = 8, None, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        expect(struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body), f"checksum of {kind}")
        size = struct.unpack(">II", body[:8]) if kind == b"IHDR" else size
        pixels += body if kind == b"IDAT" else b""
        at += 12 + length
    expect(len(zlib.decompress(pixels)) == size[1] * (1 + 4 * size[0]), "the pixels of another size")
    return size


def linkage_pictures():
    """The same drawing by extension: PNG of twice its size, a PDF, and --svg as before."""
    folder = cli.fresh_folder("linkage_pictures")
    expect_exit(command("linkage", "paper-b", "--picture", folder / "b.png"), 0)
    expect(png_size((folder / "b.png").read_bytes()) == (2560, 1600), "not twice the drawing's 1280 by 800")
    for name in ("b.svg", "b.PDF", "again.pdf"):
        expect_exit(command("linkage", "paper-b", "--picture", folder / name), 0)
    expect_exit(command("linkage", "paper-b", "--svg", folder / "old.svg"), 0)
    expect((folder / "old.svg").read_bytes() == (folder / "b.svg").read_bytes(), "--svg draws something else")
    expect((folder / "b.PDF").read_bytes() == (folder / "again.pdf").read_bytes(), "two PDFs differ")
    expect((folder / "b.PDF").read_bytes().startswith(b"%PDF-1."), "no PDF")
    for arguments in (["linkage", "paper-b"], ["calibrate", folder / "missing.log", "-o", folder / "l.yaml"],
                      ["evaluate", folder / "missing.ply", "--boxes"], ["register", folder / "missing.ply", folder / "missing.ply"]):
        process = command(*arguments, "--picture", folder / "b.bmp")
        expect_exit(process, 2)  # before anything is read
        cli.one_error_line(process.stderr)
        expect(".svg, .png or .pdf" in process.stderr and "--picture" in process.stderr, process.stderr)
    expect(sorted(file.name for file in folder.iterdir()) == ["again.pdf", "b.PDF", "b.png", "b.svg", "old.svg"], "other files")


def linkage_design_is_a_linkage():
    """What --design writes is read again, keeps its bars bit for bit, and is drawn."""
    folder = cli.fresh_folder("linkage_design")
    goal = ("--swing", "70deg", "--min-transmission", "30deg", "--time-ratio", "1.15", "--crank", "3..4cm", "--longest", "12cm")
    process = command("linkage", "--design", *goal, "--count", 2, "--json", "-o", folder / "mine.yaml", "--svg", folder / "mine.svg")
    expect_exit(process, 0)
    designs = json.loads(process.stdout)
    expect(len(designs) == 2, f"{len(designs)} designs")
    process = command("linkage", folder / "mine.yaml", "--json")
    expect_exit(process, 0)
    again = json.loads(process.stdout)
    expect(again["bars_m"] == designs[0]["bars_m"], "other bars")
    lift = again["crank_rocker"]
    expect(abs(lift["swing_deg"] - 70) < 1e-6 and abs(lift["time_ratio"] - 1.15) < 1e-6, f"{lift}")
    expect(lift["least_transmission_deg"] >= 30 and max(again["bars_m"].values()) <= 0.12, f"{again}")
    expect(abs(lift["lift_begin"]["elevation_deg"]) < 1e-9, "the lift does not begin at elevation 0")
    xml.fromstring((folder / "mine.svg").read_bytes())


def linkage_design_has_bars_that_are_read():
    """However large the crank is asked for, what -o writes is read again; else one line and no file."""
    folder = cli.fresh_folder("linkage_design_bars")
    for crank in ("1mm", "20cm", "30cm", "20..90cm"):
        expect_exit(command("linkage", "--design", "--crank", crank, "-o", folder / "mine.yaml"), 0)
        expect_exit(command("linkage", folder / "mine.yaml"), 0)
        (folder / "mine.yaml").unlink()
    for goal in (("--crank", "1um"), ("--crank", "2m"), ("--longest", "1.2m")):
        process = command("linkage", "--design", *goal, "-o", folder / "mine.yaml")
        expect_exit(process, 78)
        cli.one_error_line(process.stderr)
        expect(not (folder / "mine.yaml").exists(), f"{goal}: a linkage was written")
    large = ("--min-transmission", "44.6deg")
    process = command("linkage", "--design", "--crank", "30cm", *large)
    expect_exit(process, 78)
    crank_cm = float(re.search("a bar is at most 1 m long: allow a crank of ([0-9.]+) cm", process.stderr)[1])
    expect_exit(command("linkage", "--design", "--crank", f"{0.99 * crank_cm}cm", "--longest", "1m", *large), 0)


def linkage_of_any_class():
    """Linkages that are no crank-rocker are shown with what they are; those that cannot close are refused with line and numbers."""
    folder = cli.fresh_folder("linkage_class")
    expect_exit(command("linkage", "paper-b", "-o", folder / "b.yaml"), 0)
    lines = (folder / "b.yaml").read_text().splitlines()

    def variant(name, **bars):
        text = [next((f"  {bar}: {length}" for bar, length in bars.items() if line.startswith(f"  {bar}:")), line) for line in lines]
        (folder / name).write_text("\n".join(text) + "\n")
        return folder / name

    drag = variant("drag.yaml", crank="6 cm", coupler="5 cm", rocker="7 cm", ground="3 cm")
    process = command("linkage", drag, "--json", "--svg", folder / "drag.svg", "--csv", folder / "drag.csv")
    expect_exit(process, 0)
    report = json.loads(process.stdout)
    cli.validate(process.stdout, "linkage")
    expect(report["class"] == "double crank" and report["crank_rocker"] is None and len(report["remarks"]) == 1, f"{report}")
    stiff = variant("stiff.yaml", crank="5 cm", coupler="4 cm", rocker="5 cm", ground="9 cm")
    process = command("linkage", stiff, "--json", "--svg", folder / "stiff.svg", "--csv", folder / "stiff.csv")
    expect_exit(process, 0)
    expect(json.loads(process.stdout)["class"] == "triple rocker", process.stdout)
    expect(len((folder / "stiff.csv").read_text().splitlines()) == 1 + 2 * 74, "rows where the loop is open: 0 to 73 and 287 to 360 deg")
    for name in ("drag.svg", "stiff.svg"):
        xml.fromstring((folder / name).read_bytes())
    process = command("linkage", variant("open.yaml", ground="25 cm"))
    expect_exit(process, 78)
    cli.one_error_line(process.stderr)
    expect("open.yaml:" in process.stderr and "25 > 3.6 + 8.5 + 8.8 = 20.9 cm" in process.stderr, process.stderr)
