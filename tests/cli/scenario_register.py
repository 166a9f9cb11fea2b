"""`gdtslam register` beside PCL's registrations on a pair of simulated clouds whose true pose is known, and its pictures."""

import json
import math
import random
import re
import shutil
import struct
import subprocess
import xml.etree.ElementTree as xml

import cli_support as cli
from cli_support import command, expect, expect_exit
from nodding_log import SCENE
from scenario_linkage import png_size

# Two stops in the room of nodding_log.
ROOM = SCENE.replace("linkage: paper-b,", "linkage: paper-b, mode: stop-and-scan, stop_every: 5 m,")
ROOM = ROOM.replace("[[0, 0], {at: [2.4, 0.3], speed: 0.15}]", "[[0, 0], [0.3, 0], [0.7, 0.07]]")
SCANS = 80  # of each stop that are used
CUBE = 0.05  # m, with one point each: PCL's ICP would lay the dense points near a scanner on those near the other
NOISE = 0.005  # of each coordinate, m, one standard deviation
# Frame of the second cloud in that of the first: 13 cm and 3.4 degrees, from where PCL's programs come to rest at the truth.
TRUTH = (0.11, -0.06, 0.03, 0.01, -0.005, 0.0278, math.sqrt(1 - 0.01**2 - 0.005**2 - 0.0278**2))
PCL = {"pcl_icp": ("-d", "0.1", "-i", "200"), "pcl_ndt3d": ("-r", "1", "-i", "200", "-f", "0.05", "-t", "0.0001")}


def matrix_of(x, y, z, qx, qy, qz, qw):
    """The pose as four rows."""
    return [[1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw), x],
            [2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw), y],
            [2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy), z], [0, 0, 0, 1]]


def into_frame(T, points):
    """Points of the frame that T's is given in, in the frame of T."""
    for point in points:
        offset = [point[k] - T[k][3] for k in range(3)]
        yield [sum(T[k][i] * offset[k] for k in range(3)) for i in range(3)]


def distance(A, B):
    """Metres and degrees between two poses. The sine keeps small angles of matrices with six digits, a cosine does not."""
    R = [[sum(A[k][i] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    sine = math.hypot(R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]) / 2
    return math.dist([row[3] for row in A], [row[3] for row in B]), math.degrees(math.asin(min(1.0, sine)))


def simulated_stops(folder):
    """The points that the laser hits from the first and the last stop, in the room's frame, with noise."""
    (folder / "room.yaml").write_text(ROOM)
    expect_exit(command("simulate", folder / "room.yaml", "-o", folder / "room.log", "--truth-hits"), 0)
    rows = list(struct.iter_unpack("<6d3I", (folder / "room.truth.ply").read_bytes().split(b"end_header\n", 1)[1]))
    noise = random.Random(1)
    last = rows[-1][6]
    for is_of_stop in (lambda scan: scan < SCANS, lambda scan: scan > last - SCANS):
        cubes = {tuple(math.floor(value / CUBE) for value in row[:3]): row for row in rows if is_of_stop(row[6])}
        yield [[value + noise.gauss(0, NOISE) for value in row[:3]] for row in cubes.values()]


def write_cloud(path, points):
    points = list(points)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n" + "".join(f"property float {a}\n" for a in "xyz")
    path.write_bytes((header + "end_header\n").encode() + b"".join(struct.pack("<3f", *point) for point in points))


def found_by_pcl(program, folder):
    """The last matrix that the program prints. It writes the moved cloud over its file, so it gets a folder of its own."""
    place = folder / program
    place.mkdir()
    for name in ("a.ply", "b.ply"):
        expect_exit(command("convert", folder / name, "-o", (place / name).with_suffix(".pcd"), "-q"), 0)
    done = subprocess.run([program, *PCL[program], "a.pcd", "b.pcd"], capture_output=True, text=True, cwd=place, check=False,
                          timeout=60 * cli.SLOWNESS)
    number = r"\s*(-?[\d.]+(?:e[+-]?\d+)?)"
    rows = re.findall(rf"^{4 * number}\s*$", done.stdout + "\n" + done.stderr, re.MULTILINE)
    expect(len(rows) >= 4, f"{program} printed no matrix: {done.stdout} {done.stderr}")
    return [[float(value) for value in row] for row in rows[-4:]]


def register_beside_pcl():
    """Not farther from the truth than the better of PCL's ICP and normal distributions, which come to the same pose."""
    missing = [program for program in PCL if not shutil.which(program)]
    if missing:  # GDTSLAM_REQUIRE_PROGRAMS does not ask for it: PCL brings VTK and Qt
        cli.skip(f"skipped: there is no {' and no '.join(missing)} (Debian's package pcl-tools)")
    folder = cli.fresh_folder("register_beside_pcl")
    first, last = simulated_stops(folder)
    truth = matrix_of(*TRUTH)
    write_cloud(folder / "a.ply", first)
    write_cloud(folder / "b.ply", into_frame(truth, last))
    process = command("register", folder / "a.ply", folder / "b.ply", "--json")
    expect_exit(process, 0)
    report = json.loads(process.stdout)
    ours = matrix_of(*report["position_m"], *report["quaternion_xyzw"])
    errors = {"gdtslam": distance(ours, truth)}
    for program in PCL:
        theirs = found_by_pcl(program, folder)
        errors[program] = distance(theirs, truth)
        apart_m, apart_deg = distance(theirs, ours)
        expect(apart_m < 0.03 and apart_deg < 0.5, f"{program} is {apart_m} m and {apart_deg} degrees from ours: {errors}")
    for name, (error_m, error_deg) in errors.items():
        print(f"{name}: {1000 * error_m:.1f} mm, {error_deg:.3f} deg off the truth")
    expect(report["verdict"] == "registered", f"{report}")
    for k, margin in enumerate((0.0005, 0.02)):
        expect(errors["gdtslam"][k] <= min(errors[program][k] for program in PCL) + margin, f"PCL is nearer to the truth: {errors}")


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
