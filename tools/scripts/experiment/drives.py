"""Long drives through worlds made from a seed: the error of the path, loops that are wrong, and what is listed as uncertain."""

import bisect
import json
import math
import random
import subprocess
import sys

WRONG_M = 0.5  # a loop that is farther off, and by more than chance, is another place
WRONG_RAD = 0.1
WRONG_CHI2 = 25.0
OFF_M = 0.3  # a pose that is farther off is a bad one
AGAIN_M = 2.0  # a place this near an earlier one
AGAIN_AFTER_M = 20.0  # of path

TRACK_WIDTH_M = 0.5
ROBOT = """
robot:
  laser: {preset: sick-lms, range_resolution: 1 mm, max_range: %s m, no_return: 81.91 m}
  wheels: {slip: 3 cm, track_width: %g m, left_scale: %.5f, right_scale: %.5f}
  motion: {speed: 1.2 m/s, acceleration: 1 m/s^2, turn_rate: 60 deg/s, corner_cut: 50 cm}
recording: {scan_rate: 5 Hz, odometry_rate: 10 Hz}
"""


class World:
    """Walls as closed polylines, boxes along them, and the corners that a drive may go between."""

    def __init__(self, max_range_m):
        self.walls, self.boxes = [], []
        self.corners, self.ways = [], {}
        self.max_range_m = max_range_m
        self.distance_scale, self.turn_rad_per_m = 1.0, -0.02 / TRACK_WIDTH_M  # of the wheels
        self.delay_s = 0.0  # of the odometry

    def rectangle(self, x0, y0, x1, y1):
        self.walls.append(f"  - {{points: [[{x0:g}, {y0:g}], [{x1:g}, {y0:g}], [{x1:g}, {y1:g}], [{x0:g}, {y1:g}]], closed: true}}")

    def box(self, x, y, width, depth, yaw_deg=0.0):
        self.boxes.append(f"  - {{centre: [{x:.3f}, {y:.3f}], size: [{width:.3f}, {depth:.3f}], height: 2 m, yaw: {yaw_deg:.2f} deg}}")

    def corner(self, x, y):
        self.corners.append((x, y))
        self.ways[len(self.corners) - 1] = []
        return len(self.corners) - 1

    def way(self, a, b):
        self.ways[a].append(b)
        self.ways[b].append(a)

    def drive(self, rng, length_m):
        """Corners of a drive that turns back only where it has to."""
        here, last, path, driven = 0, None, [0], 0.0
        while driven < length_m:
            onward = [c for c in self.ways[here] if c != last] or self.ways[here]
            last, here = here, rng.choice(onward)
            driven += math.dist(self.corners[last], self.corners[here])
            path.append(here)
        return [self.corners[c] for c in path]

    def scene(self, name, waypoints):
        points = "".join(f"  - [{x:g}, {y:g}]\n" for x, y in waypoints)
        boxes = "boxes:\n" + "\n".join(self.boxes) if self.boxes else ""
        return (f"gdtslam_scene: 1\nname: {name}\nwalls:\n" + "\n".join(self.walls) + "\n" + boxes +
                ROBOT % (f"{self.max_range_m:g}", TRACK_WIDTH_M, self.distance_scale - 0.5 * TRACK_WIDTH_M * self.turn_rad_per_m,
                         self.distance_scale + 0.5 * TRACK_WIDTH_M * self.turn_rad_per_m) + "waypoints:\n" + points)


def blocks(columns, rows, width_m, depth_m, wide_m, max_range_m=20.0):
    """Corridors around blocks, as streets are."""
    world = World(max_range_m)
    world.rectangle(0, 0, columns * (width_m + wide_m) + wide_m, rows * (depth_m + wide_m) + wide_m)
    grid = {}
    for j in range(rows + 1):
        for i in range(columns + 1):
            grid[i, j] = world.corner(i * (width_m + wide_m) + wide_m / 2, j * (depth_m + wide_m) + wide_m / 2)
            if i > 0:
                world.way(grid[i - 1, j], grid[i, j])
            if j > 0:
                world.way(grid[i, j - 1], grid[i, j])
    for j in range(rows):
        for i in range(columns):
            x, y = i * (width_m + wide_m) + wide_m, j * (depth_m + wide_m) + wide_m
            world.rectangle(x, y, x + width_m, y + depth_m)
    return world


def along_blocks(world, columns, rows, width_m, depth_m, wide_m, place):
    """Calls place(x, y, dx, dy) for each wall of a block: its beginning and direction, the corridor to its right."""
    for j in range(rows):
        for i in range(columns):
            x, y = i * (width_m + wide_m) + wide_m, j * (depth_m + wide_m) + wide_m
            place(x, y, 1, 0, width_m)
            place(x + width_m, y, 0, 1, depth_m)
            place(x + width_m, y + depth_m, -1, 0, width_m)
            place(x, y + depth_m, 0, -1, depth_m)


def corridors(rng):
    """Loops of 300 m with pillars at the walls, each at a place of its own."""
    size = (2, 2, 90.0, 60.0, 2.4)
    world = blocks(*size)

    def pillars(x, y, dx, dy, length_m):
        at = rng.uniform(2.0, 7.0)
        while at < length_m - 1.0:
            world.box(x + dx * at + dy * 0.1, y + dy * at - dx * 0.1, rng.uniform(0.2, 0.5), rng.uniform(0.2, 0.5))
            at += rng.uniform(3.0, 10.0)

    along_blocks(world, *size, pillars)
    return world


def doors(rng):
    """Doors that repeat every 8.5 m along loops of 300 m: the way along them is known at the corners only."""
    size = (2, 1, 85.0, 59.5, 2.4)
    world = blocks(*size)

    def frames(x, y, dx, dy, length_m):
        at = 4.25
        while at < length_m:
            for side in (-0.5, 0.5):
                world.box(x + dx * (at + side) + dy * 0.05, y + dy * (at + side) - dx * 0.05, 0.15, 0.15)
            at += 8.5

    along_blocks(world, *size, frames)
    world.box(1.0, 0.3, 0.4, 0.4, rng.uniform(0, 90))
    return world


def wings(rng):
    """Four wings that look alike on a corridor: 30 m deep, with the same rooms' doors."""
    size = (5, 1, 15.0, 30.0, 2.4)
    world = blocks(*size)

    def frames(x, y, dx, dy, length_m):
        at = 2.5
        while at < length_m:
            world.box(x + dx * at + dy * 0.1, y + dy * at - dx * 0.1, 0.2, 0.2)
            at += 5.0

    along_blocks(world, *size, frames)
    for _ in range(6):
        world.box(rng.uniform(5, 85), 0.15, 0.3, 0.3)
    return world


def yard(rng):
    """80 by 60 m with few walls and twelve things that stand about; the laser sees 30 m."""
    world = World(30.0)
    world.rectangle(0, 0, 80, 60)
    xs, ys = (8.0, 24.0, 40.0, 56.0, 72.0), (8.0, 22.0, 38.0, 52.0)
    grid = {(i, j): world.corner(x, y) for i, x in enumerate(xs) for j, y in enumerate(ys)}
    for (i, j), corner in grid.items():
        for next_corner in ((i + 1, j), (i, j + 1)):
            if next_corner in grid:
                world.way(corner, grid[next_corner])
    cells = [(x, y) for x in (16.0, 32.0, 48.0, 64.0) for y in (15.0, 30.0, 45.0)]
    for x, y in cells:
        world.box(x + rng.uniform(-3, 3), y + rng.uniform(-3, 3), rng.uniform(0.5, 4), rng.uniform(0.5, 4), rng.uniform(0, 90))
    return world


def repeats(rng):
    """Two loops of 300 m whose long corridors have niches every 7 m and every 3.4 m and nothing else; each is passed some three
    times, with wheels off by up to 3 % and 5 degrees a metre and odometry stamped up to 0.6 s early or late."""
    size = (2, 1, 91.0, 59.5, 2.4)
    world = blocks(*size)
    columns, _, width_m, depth_m, wide_m = size
    for i in range(columns):
        x = i * (width_m + wide_m) + wide_m
        for y, out, period_m in ((wide_m, -1, 7.0), (wide_m + depth_m, 1, 3.4)):  # posts stand between niches, on both sides
            at = 0.5 * period_m
            while at < width_m - 0.5:
                world.box(x + at, y + out * 0.1, 1.2, 0.2)
                world.box(x + at, y + out * (wide_m - 0.1), 1.2, 0.2)
                at += period_m
    for i in range(columns + 1):
        x, at = i * (width_m + wide_m), wide_m + rng.uniform(2.0, 7.0)
        while at < wide_m + depth_m - 1.0:
            world.box(x + rng.choice((0.1, wide_m - 0.1)), at, rng.uniform(0.2, 0.5), rng.uniform(0.2, 1.5))
            at += rng.uniform(3.0, 10.0)
    world.distance_scale = 1.0 + rng.uniform(-0.03, 0.03)
    world.turn_rad_per_m = math.radians(rng.uniform(-5.0, 5.0))
    world.delay_s = rng.uniform(-0.6, 0.6)
    return world


def twins(rng):
    """Two wings with the same rooms, furniture and all, at the ends of a hall that is like nothing else: 62 by 18 m."""
    world = World(20.0)
    world.rectangle(0, 0, 62, 18)
    rooms, doors_m, wide_m = 4, 1.2, 6.0
    hall = [world.corner(x, 9) for x in (25.2, 31, 36.8)]
    sides = [world.corner(31, 3), world.corner(31, 15)]
    for a, b in ((hall[0], hall[1]), (hall[1], hall[2]), (hall[1], sides[0]), (hall[1], sides[1])):
        world.way(a, b)
    for x0, ends in ((0.0, (None, hall[0])), (38.0, (hall[2], None))):
        same = random.Random("furniture")
        before = ends[0]
        for k in range(rooms):
            middle = x0 + wide_m * (k + 0.5)
            here = world.corner(middle, 9)
            if before is not None:
                world.way(before, here)
            before = here
            for low, high, door_y in ((0.0, 8.0, 8.0), (10.0, 18.0, 10.0)):
                room = world.corner(middle, 0.5 * (low + high))
                world.way(here, room)
                half = 0.5 * (wide_m - doors_m)
                world.box(middle - 0.5 * (half + doors_m), door_y, half, 0.1)
                world.box(middle + 0.5 * (half + doors_m), door_y, half, 0.1)
                for side in (-1, 1):
                    for depth_m in (2.0, 5.5):
                        world.box(middle + side * same.uniform(1.6, 2.3), low + depth_m + same.uniform(-0.8, 0.8),
                                  same.uniform(0.4, 1.2), same.uniform(0.4, 1.4), same.uniform(0, 90))
        if ends[1] is not None:
            world.way(before, ends[1])
        for k in range(rooms + 1):
            for y in (4.0, 14.0):
                world.box(x0 + wide_m * k, y, 0.1, 8.0)
    for x in (27.2, 34.8):
        for y in (2.8, 6.0, 12.0, 15.2):
            world.box(x + rng.uniform(-1.2, 1.2), y + rng.uniform(-1.0, 1.0), rng.uniform(0.3, 1.6), rng.uniform(0.3, 1.2),
                      rng.uniform(0, 90))
    return world


WORLDS = {"corridors": corridors, "doors": doors, "wings": wings, "yard": yard, "repeats": repeats, "twins": twins}


def run(*command):
    """Runs a command and returns what it printed."""
    process = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {process.returncode}: {process.stderr.strip()}")
    return process.stdout


def poses_of(path):
    poses = []
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            value = [float(word) for word in line.split()]
            poses.append((value[1], value[2], 2.0 * math.atan2(value[6], value[7])))
    return poses


def between(a, b):
    dx, dy, c, s = b[0] - a[0], b[1] - a[1], math.cos(a[2]), math.sin(a[2])
    return (c * dx + s * dy, -s * dx + c * dy, math.remainder(b[2] - a[2], 2.0 * math.pi))


def errors_of(poses, truth):
    """Distances once the poses are laid over the truth."""
    n = len(truth)
    ax, ay = sum(p[0] for p in poses) / n, sum(p[1] for p in poses) / n
    bx, by = sum(p[0] for p in truth) / n, sum(p[1] for p in truth) / n
    pairs = [(p[0] - ax, p[1] - ay, t[0] - bx, t[1] - by) for p, t in zip(poses, truth)]
    turn = math.atan2(sum(x * v - y * u for x, y, u, v in pairs), sum(x * u + y * v for x, y, u, v in pairs))
    c, s = math.cos(turn), math.sin(turn)
    return [math.hypot(c * x - s * y - u, s * x + c * y - v) for x, y, u, v in pairs]


def loops_of(folder):
    """(from, to, measured pose, its information, weight) of each loop; the file has the information times the weight."""
    closures = json.loads((folder / "report.json").read_text())["loops"]["closures"]
    weights = {(c["from"], c["to"]): c["weight"] for c in closures}
    loops = []
    for line in (folder / "graph.g2o").read_text().splitlines():
        word = line.split()
        if word and word[0] == "EDGE_SE2" and (int(word[1]), int(word[2])) in weights:
            pair = int(word[1]), int(word[2])
            weight = weights[pair]
            information = [float(value) / max(weight, 1e-9) for value in word[6:12]]
            loops.append((*pair, tuple(map(float, word[3:6])), information, weight))
    return loops


def is_wrong(off, information):
    """Whether a loop says that the robot was where it was not; along a bare corridor it may say nothing."""
    (x, y, turn), (xx, xy, xt, yy, yt, tt) = off, information
    chi2 = xx * x * x + yy * y * y + tt * turn * turn + 2.0 * (xy * x * y + xt * x * turn + yt * y * turn)
    return chi2 > WRONG_CHI2 and (math.hypot(x, y) > WRONG_M or abs(turn) > WRONG_RAD)


def places_of(folder):
    return [int(line.split()[1]) for line in (folder / "graph.g2o").read_text().splitlines() if line.startswith("VERTEX_SE2")]


def passed_again(places, truth):
    """The places that lie near an earlier one."""
    path_m = [0.0]
    for a, b in zip(truth, truth[1:]):
        path_m.append(path_m[-1] + math.dist(a[:2], b[:2]))
    return [here for k, here in enumerate(places)
            if any(math.dist(truth[here][:2], truth[there][:2]) < AGAIN_M and path_m[here] - path_m[there] > AGAIN_AFTER_M
                   for there in places[:k])]


def figures(folder, truth):
    errors = errors_of(poses_of(folder / "trajectory.tum"), truth)
    listed = set()
    for stretch in json.loads((folder / "report.json").read_text())["uncertain"]["stretches"]:
        listed.update(range(stretch["from"], stretch["to"] + 1))
    wrong, closed = 0, set()
    loops = loops_of(folder)
    for a, b, measured, information, weight in loops:
        if weight <= 0.25:
            continue
        closed.add(b)
        wrong += is_wrong(between(between(truth[a], truth[b]), measured), information)
    again = passed_again(places_of(folder), truth)
    bad = [i for i, error in enumerate(errors) if error > OFF_M]
    return {"ate": sum(errors) / len(errors), "largest": max(errors), "loops": len(loops), "wrong": wrong,
            "again": len(again), "closed": len(closed & set(again)), "bad": len(bad), "scans": len(errors),
            "bad_listed": len(listed & set(bad)), "good_listed": len(listed - set(bad))}


def delay_odometry(log, delay_s):
    """Each line of a CARMEN log gets the odometry that was true delay_s before it."""
    lines = log.read_text().splitlines()
    track = []  # (time, x, y, heading)
    at = {"ODOM": 1, "FLASER": -6}  # where the odometry begins; before a scan's is its laser's pose, the same
    for line in lines:
        word = line.split()
        if word and word[0] in at:
            track.append((float(word[-1]), *map(float, word[at[word[0]]:][:3])))
    times = [pose[0] for pose in track]
    written = []
    for line in lines:
        word = line.split()
        if word and word[0] in at:
            time = float(word[-1]) - delay_s
            k = min(max(bisect.bisect_right(times, time), 1), len(track) - 1)
            (t0, *a), (t1, *b) = track[k - 1], track[k]
            part = min(max((time - t0) / max(t1 - t0, 1e-9), 0.0), 1.0)
            first = len(word) + at[word[0]] if at[word[0]] < 0 else at[word[0]]
            heading = a[2] + part * math.remainder(b[2] - a[2], 2.0 * math.pi)
            pose = [f"{a[0] + part * (b[0] - a[0]):.6f}", f"{a[1] + part * (b[1] - a[1]):.6f}", f"{heading:.6f}"]
            word[first:first + 3] = pose
            if word[0] == "FLASER":
                word[first - 3:first] = pose
        written.append(" ".join(word) if word else line)
    log.write_text("\n".join(written) + "\n")


def drive(program, folder, name, seed, length_m, options):
    rng = random.Random(f"{name} {seed}")
    world = WORLDS[name](rng)
    scene, log, out = folder / f"{name}.yaml", folder / f"{name}.log", folder / f"{name}-{seed}"
    scene.write_text(world.scene(name, world.drive(rng, length_m)))
    run(program, "simulate", scene, "-o", log, "--seed", seed, "--force", "--quiet")
    if world.delay_s != 0.0:
        delay_odometry(log, world.delay_s)
    run(program, "map", log, "-o", out, "--no-pictures", "--quiet", "--force", *options)
    return figures(out, poses_of(folder / f"{name}.truth.tum"))


def print_table(*columns):
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|", flush=True)


def print_row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def drives(chosen):
    """Each world and drive is made from its seed, simulated and mapped: the error of the path, loops that are believed and wrong,
    how many of the places that were passed again have a loop, and whether the uncertain scans are listed. It fails if a wrong
    loop is believed. A kilometre takes some 20 s."""
    wrong = 0
    print_table("world", "seed", "ATE mean, largest", "loops, wrong and believed", "places again, with a loop", "scans off, listed",
                "others listed")
    for name in chosen.worlds.split(","):
        for seed in range(1, chosen.seeds + 1):
            f = drive(chosen.program, chosen.folder, name, seed, 1000.0 * chosen.km, chosen.mapping)
            wrong += f["wrong"]
            print_row(name, seed, f"{f['ate']:.3f} m, {f['largest']:.2f} m", f"{f['loops']}, {f['wrong']}", f"{f['again']}, {f['closed']}",
                      f"{f['bad']}, {f['bad_listed']}", f"{f['good_listed']} of {f['scans'] - f['bad']}")
    return wrong == 0
