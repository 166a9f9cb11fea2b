# Files that pages are made of: a room whose surfaces are known, its path and map.
import math
import os
import struct
import subprocess

FLOOR, CEILING = 0.0, 2.5
WIDTH, DEPTH = 6.0, 4.0


def room():
    """(points, count on the floor, count on the ceiling); a point is (x, y, z, elevation, stamp, scan)."""
    places = []
    floor = [(0.1 * i, 0.1 * j, FLOOR) for i in range(61) for j in range(41)]
    ceiling = [(0.15 * i, 0.15 * j, CEILING) for i in range(41) for j in range(27)]
    places += floor + ceiling
    for k in range(1, 22):  # walls between 0.2 and 2.3 m
        z = 0.1 + 0.1 * k
        places += [(0.1 * i, y, z) for i in range(61) for y in (0.0, DEPTH)]
        places += [(x, 0.1 * j, z) for j in range(1, 40) for x in (0.0, WIDTH)]
    points = [(x + 10.0, y - 20.0, z, math.radians(90.0 * (k % 181) / 180.0), 100.0 + 0.01 * k, k // 50)
              for k, (x, y, z) in enumerate(places)]
    return points, len(floor), len(ceiling)


def write_cloud(path, points):
    columns = ["float x", "float y", "float z", "float elevation", "double time", "uint scan"]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}",
              *("property " + column for column in columns), "end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode())
        for point in points:
            file.write(struct.pack("<4fdI", *point))


def write_path(path, count=101):
    with open(path, "w", encoding="ascii") as file:
        for k in range(count):
            heading = 0.4
            file.write(f"{100.0 + 0.5 * k:.6f} {11.0 + 0.04 * k:.6f} {-19.0 + 0.02 * k:.6f} 0 "
                       f"0 0 {math.sin(heading / 2):.9f} {math.cos(heading / 2):.9f}\n")


def write_map(folder, width=61, height=41):
    """Free inside, occupied at the rim, one cell unknown at (2, 3); answers the states by rows from below."""
    states = [[2 if x in (0, width - 1) or y in (0, height - 1) else 1 for x in range(width)] for y in range(height)]
    states[3][2] = 0
    grey = {0: 205, 1: 254, 2: 0}
    with open(os.path.join(folder, "map.pgm"), "wb") as file:
        file.write(b"P5\n%d %d\n255\n" % (width, height))
        for row in reversed(states):
            file.write(bytes(grey[state] for state in row))
    with open(os.path.join(folder, "map.yaml"), "w", encoding="ascii") as file:
        file.write("image: map.pgm\nmode: trinary\nresolution: 0.1\norigin: [10.0, -20.0, 0.0]\nnegate: 0\n"
                   "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return [state for row in states for state in row]


def make_page(path, *options):
    subprocess.run([os.environ["GDTSLAM_MAKE_PAGE"], path, *options], check=True)


def make_room_page(folder, *options):
    """The page of the room with path, map and linkage; the other options after that."""
    points, floor, ceiling = room()
    cloud, trajectory, page = (os.path.join(folder, name) for name in ("room.ply", "room.tum", "room.html"))
    write_cloud(cloud, points)
    write_path(trajectory)
    write_map(folder)
    make_page(page, "--title", "Room", "--subtitle", "Four walls", "--cloud", cloud, "--path", trajectory, "--map",
              os.path.join(folder, "map.yaml"), "--linkage", "paper-b", "--fact", "Points=many", *options)
    return page, points, floor, ceiling
