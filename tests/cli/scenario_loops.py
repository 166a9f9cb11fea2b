"""What a run says of its own uncertainty: covariance.csv and graph.g2o."""

import math

from cli_support import RUN, expect, scans_in


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def between(a, b):
    """b in the frame of a; poses are (x, y, theta)."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    cosine, sine = math.cos(a[2]), math.sin(a[2])
    return cosine * dx + sine * dy, -sine * dx + cosine * dy, wrapped(b[2] - a[2])


def log(T):
    """The tangent of a planar pose: the arc that leads to it."""
    x, y, angle = T
    if abs(angle) < 1e-9:
        return x, y, angle
    half = 0.5 * angle
    stretch = half / math.tan(half)
    return stretch * x + half * y, -half * x + stretch * y, angle


def read_g2o(path):
    """Vertices by id and edges (from, to, measured, the upper triangle of the information)."""
    vertices, edges = {}, []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "VERTEX_SE2":
            expect(len(words) == 5, line)
            vertices[int(words[1])] = tuple(map(float, words[2:]))
        else:
            expect(words[0] == "EDGE_SE2" and len(words) == 12, line)
            edges.append((int(words[1]), int(words[2]), tuple(map(float, words[3:6])), tuple(map(float, words[6:]))))
    return vertices, edges


def residual(vertices, edge):
    return log(between(edge[2], between(vertices[edge[0]], vertices[edge[1]])))


def chi2(vertices, edges):
    total = 0.0
    for edge in edges:
        x, y, t = residual(vertices, edge)
        xx, xy, xt, yy, yt, tt = edge[3]
        total += x * (xx * x + 2 * xy * y + 2 * xt * t) + y * (yy * y + 2 * yt * t) + tt * t * t
    return total


def graph_agrees_with_the_report():
    """Residuals of the loops in graph.g2o are those of report.json, and no vertex moved makes the graph fit better."""
    report = scans_in(RUN)
    closures = report["loops"]["closures"]
    vertices, edges = read_g2o(RUN / "graph.g2o")
    expect(len(closures) > 5, f"only {len(closures)} loops")
    expect(all(edge[0] in vertices and edge[1] in vertices for edge in edges), "an edge without its places")
    path, loops = edges[: -len(closures)], edges[-len(closures):]
    steps = list(zip(sorted(vertices), sorted(vertices)[1:]))
    expect([edge[:2] for edge in path] == steps * 2, "the path is not every step by front end and wheels")
    for edge, closure in zip(loops, closures):
        expect(edge[:2] == (closure["from"], closure["to"]), f"{edge[:2]} is not {closure}")
        x, y, angle = residual(vertices, edge)
        expect(abs(math.hypot(x, y) - closure["off_m"]) < 1e-9, f"{math.hypot(x, y)} m, {closure}")
        expect(abs(abs(math.degrees(angle)) - closure["off_deg"]) < 1e-7, f"{math.degrees(angle)} deg, {closure}")
    for _, _, _, (xx, xy, xt, yy, yt, tt) in edges:
        minors = xx, xx * yy - xy * xy, xx * (yy * tt - yt * yt) - xy * (xy * tt - yt * xt) + xt * (xy * yt - yy * xt)
        expect(all(minor > 0.0 for minor in minors), f"information is not positive definite: {minors}")
    least = chi2(vertices, edges)
    for scan in sorted(vertices)[1::5]:
        for step in ((0.01, 0, 0), (-0.01, 0, 0), (0, 0.01, 0), (0, -0.01, 0), (0, 0, 0.005), (0, 0, -0.005)):
            moved = {**vertices, scan: tuple(a + b for a, b in zip(vertices[scan], step))}
            expect(chi2(moved, edges) > least, f"the graph fits better with scan {scan} moved by {step}")


def covariances_belong_to_poses():
    """One row a pose with its stamp; the largest deviation is that of the report."""
    rows = [list(map(float, line.split(","))) for line in (RUN / "covariance.csv").read_text().splitlines()[1:]]
    poses = [line.split() for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expect([f"{row[0]:.9f}" for row in rows] == [pose[0] for pose in poses], "stamps differ")
    worst = max(0.5 * (xx + yy) + math.hypot(0.5 * (xx - yy), xy) for _, xx, xy, _, yy, _, _ in rows)
    expect(abs(math.sqrt(worst) - scans_in(RUN)["uncertain"]["sigma_max_m"]) < 1e-9, f"{math.sqrt(worst)} m")
