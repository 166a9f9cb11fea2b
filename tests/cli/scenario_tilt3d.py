"""Two real scans of a tilting laser, where the data are there: the command gives back the points that their makers gave."""

import gzip
import math
import os
import pathlib
import struct

from cli_support import SOURCE, command, expect, expect_exit, fresh_folder, scans_in, skip

STEP_DEG = 0.5
NO_RETURN_M = 32.0
TOLERANCE_M = 0.01


def data_folder():
    root = pathlib.Path(os.environ.get("GDTSLAM_DATA", SOURCE / ".." / "shared" / "data"))
    folder = root / "tilt3d"
    if not folder.is_dir():
        expect(os.environ.get("CI") != "true" or not root.is_dir(), f"CI=true and no tilt3d in {root}")
        skip(f"no data in {folder}")
    return folder


def slices_of(path):
    """Elevation in degrees and ranges in metres of each slice."""
    with gzip.open(path, "rt") as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    return [(float(row[0]), [float(value) for value in row[1:]]) for row in rows]


def points_of(path):
    """The makers' points, x right, y up, z forward in centimetres, as x forward, y left, z up in metres."""
    with gzip.open(path, "rt") as file:
        rows = [[float(value) for value in line.split()] for line in file]
    return [(z / 100, -x / 100, y / 100) for x, y, z in rows]


def write_log(path, slices):
    """One scan each 0.1 s, the elevation told at its stamp; the robot stands."""
    with open(path, "w", encoding="ascii") as file:
        for k, (elevation_deg, ranges) in enumerate(slices):
            stamp = f"{0.1 * k:.6f}"
            file.write(f"TILT {math.radians(elevation_deg):.9f} {stamp} h {stamp}\n")
            file.write(f"ROBOTLASER1 0 {-math.pi / 2:.12f} {math.pi:.12f} {math.radians(STEP_DEG):.12f} {NO_RETURN_M} 0.01 0 "
                       f"{len(ranges)} {' '.join(f'{r:.4f}' for r in ranges)} 0 0 0 0 0 0 0 0 0 0 0 0 {stamp} h {stamp}\n")


def cloud_of(path):
    data = path.read_bytes()
    header, body = data.split(b"end_header\n", 1)
    expect(b"format binary_little_endian" in header, "the cloud is no binary PLY")
    return [row[:3] for row in struct.iter_unpack("<ffffdI", body)]


def compare(name, folder):
    work = fresh_folder(f"tilt3d_{name}")
    slices = slices_of(folder / f"{name}.slices.txt.gz")
    write_log(work / "tilt.log", slices)
    (work / "mount.yaml").write_text("gdtslam_linkage: 1\npreset: paper-b\nmount: {height: 0 m}\nlaser: {mirror_rate: 0 Hz}\n")
    process = command("map", work / "tilt.log", "-o", work / "run", "--linkage", work / "mount.yaml", "--set",
                      "cloud.voxel=0 m", "--set", "scan.min_range=1 cm")
    expect_exit(process, 0)
    found = cloud_of(work / "run/cloud.ply")
    told = points_of(folder / f"{name}.3d.gz")
    expect(len(told) == sum(len(ranges) for _, ranges in slices), "slices and points of the data differ in number")
    flat = [r for _, ranges in slices for r in ranges]
    expected = [point for point, r in zip(told, flat) if 0.01 <= r < NO_RETURN_M]
    expect(len(found) == len(expected), f"{len(found)} points, {len(expected)} expected")
    worst = max(math.dist(a, b) for a, b in zip(found, expected))
    expect(worst <= TOLERANCE_M, f"{name}: a point is {100 * worst:.2f} cm off")
    expect(scans_in(work / "run")["nodding"]["told_by"] == "TILT", "not told by TILT")
    print(f"{name}: {len(found)} points, the worst {1000 * worst:.2f} mm off")


def tilting_laser_of_others():
    folder = data_folder()
    for name in ("scan000", "scan001"):
        compare(name, folder)
