"""What a run says of its own uncertainty: covariance.csv, graph.g2o, `evaluate` and `doctor --after`."""

import json
import math
import re
import shutil

import cli_support as cli
from cli_support import LOG, RUN, TRUTH, command, digests, expect, expect_exit, mapped, one_error_line, scans_in


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
    """One row a pose with its stamp; the largest deviation is that of the report; other rows are refused."""
    rows = [list(map(float, line.split(","))) for line in (RUN / "covariance.csv").read_text().splitlines()[1:]]
    poses = [line.split() for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    expect([f"{row[0]:.9f}" for row in rows] == [pose[0] for pose in poses], "stamps differ")
    worst = max(0.5 * (xx + yy) + math.hypot(0.5 * (xx - yy), xy) for _, xx, xy, _, yy, _, _ in rows)
    expect(abs(math.sqrt(worst) - scans_in(RUN)["uncertain"]["sigma_max_m"]) < 1e-9, f"{math.sqrt(worst)} m")
    folder = cli.fresh_folder("covariances") / "run"
    shutil.copytree(RUN, folder)
    cli.without_told_files(folder)  # whose hashes would tell of all that follows
    lines = (RUN / "covariance.csv").read_text().splitlines(keepends=True)
    faults = {"has no header": lines[1:], "rows, but": lines[:-1], "row 1 is of": [lines[0], *lines[2:], lines[1]],
              ":3: the row has \"1,2\", not 7 numbers": [*lines[:2], "1,2\n", *lines[3:]]}
    for says, text in faults.items():
        (folder / "covariance.csv").write_text("".join(text))
        process = command("evaluate", folder, "--reference", TRUTH)
        expect_exit(process, 65)
        one_error_line(process.stderr)
        expect("covariance.csv" in process.stderr and says in process.stderr, process.stderr)


def evaluate_what_is_stated():
    """Shares within the stated deviations, against the truth and relations of it; nothing without closed loops."""
    process = command("evaluate", RUN, "--reference", TRUTH, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "evaluate_reference")
    said = json.loads(process.stdout)
    expect(said["stated"]["pose"]["count"] == said["matched"] == scans_in(RUN)["scans"], f"{said['stated']}")
    alone = json.loads(command("evaluate", RUN / "trajectory.tum", "--reference", TRUTH, "--json").stdout)
    expect({key: value for key, value in said.items() if key != "stated"} == alone, "the errors are others")
    truth = [list(map(float, line.split())) for line in TRUTH.read_text().splitlines() if line[0] != "#"]
    true_pose = {row[0]: (row[1], row[2], 2 * math.atan2(row[6], row[7])) for row in truth}
    stamps = [row[0] for row in truth][::40]
    folder = cli.fresh_folder("stated")
    lines = [f"{a:.9f} {b:.9f} {x:.9f} {y:.9f} 0 0 0 {t:.9f}\n" for a in stamps for b in stamps if a < b
             for x, y, t in [between(true_pose[a], true_pose[b])]]
    (folder / "true.relations").write_text("".join(lines))
    shares = {}
    for noise in ("0/0", "1m/30deg"):
        process = command("evaluate", RUN, "--relations", folder / "true.relations", "--noise", noise, "--json")
        expect_exit(process, 0)
        cli.validate(process.stdout, "evaluate_relations")
        stated = json.loads(process.stdout)["stated"]
        expect(stated["pose"]["count"] == len(lines) and stated["unstated"] == 0, f"{stated}")
        shares[noise] = stated["pose"]["within"]
        expect(shares[noise] == sorted(shares[noise]), f"{shares}")
    expect(shares["1m/30deg"] == [1.0, 1.0, 1.0] and shares["0/0"][2] > 0.5, f"{shares}")
    text = command("evaluate", RUN, "--relations", folder / "true.relations").stdout
    expect("stated " in text and "if it is right    19.9 %    73.9 %    97.1 %\n" in text, text)
    mapped(folder / "plain", "--no-loops", "--first", 60)
    process = command("evaluate", folder / "plain", "--reference", TRUTH)
    expect("stated           nothing: the run closed no loops" in process.stdout, process.stdout)
    text = command("evaluate", RUN, "--reference", TRUTH, "--no-align").stdout
    expect("stated           not compared" in text, text)
    for arguments, says in ((("--noise", "1cm"), "is not LENGTH/ANGLE"), (("--noise=-1cm/1deg",), "out of range"),
                            (("--noise", "1/1"), "needs a unit")):
        process = command("evaluate", RUN, "--reference", TRUTH, *arguments)
        expect_exit(process, 2)
        expect(says in process.stderr, process.stderr)
    process = command("evaluate", RUN / "trajectory.tum", "--reference", TRUTH, "--noise", "1cm/1deg")
    expect_exit(process, 2)
    expect("the run's folder" in process.stderr, process.stderr)


def doctor_of_a_map():
    """`doctor --after`: nothing doubtful in the sample; runs without loops; a report that somebody made."""
    process = command("doctor", "--after", RUN)
    expect_exit(process, 0)
    report = scans_in(RUN)
    expect(f"{report['loops']['found']} found in" in process.stdout, process.stdout)
    expect(process.stderr == "", process.stderr)
    folder = cli.fresh_folder("doctor_after")
    mapped(folder / "plain", "--no-loops", "--first", 60)
    said = command("doctor", "--after", folder / "plain").stdout
    expect("loops            not closed" in said and "map the log without --no-loops" in said, said)
    shutil.copytree(RUN, folder / "made")
    last = report["scans"] - 1
    report["uncertain"]["stretches"] = [{"from": 100, "to": 140, "from_s": 0, "to_s": 0, "sigma_m": 0.4},
                                        {"from": last, "to": last, "from_s": 0, "to_s": 0, "sigma_m": 0.2}]
    report["loops"]["closures"][0].update(on=False, weight=1e-9, off_m=1.5, off_deg=4)
    report["wheels"].update(distance=0.1, distance_sigma=0.01, turn_deg_per_m=0.0)
    report["matches"].update(accepted=report["scans"] - 7, weak=2, refused=5)
    (folder / "made/report.json").write_text(json.dumps(report))
    before = digests(folder / "made")
    arguments = ["doctor", "--after", folder / "made"]
    if cli.OVERVIEW.endswith(".png"):
        arguments += ["--picture", folder / "doubtful.png", "--force"]
    process = command(*arguments, "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "doctor_after")
    said = json.loads(process.stdout)
    expect([note["about"] for note in said["notes"]] == ["scans", "stretch", "stretch", "loop", "wheels"], f"{said['notes']}")
    expect([note["number"] for note in said["notes"]] == [1, 2, 3, 4, 5], f"{said['notes']}")
    expect([note["at_m"] is not None for note in said["notes"]] == [False, True, True, True, False], f"{said['notes']}")
    poses = [list(map(float, line.split())) for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    end = said["notes"][2]
    expect(end["at_m"] == [poses[-1][1], poses[-1][2]], f"{end}")
    expect(said["uncertain"]["scans"] == 42 and said["loops"]["on"] == said["loops"]["found"] - 1, f"{said}")
    text = command(*arguments).stdout
    for words in ("5 of", "scans 100 to 140", "end the drive at a place", "switched off: 1.50 m and 4.0 deg off",
                  "10.0 % too short", "by 1.100"):
        expect(words in text, f"no {words!r} in {text}")
    if cli.OVERVIEW.endswith(".png"):
        expect((folder / "doubtful.png").read_bytes().startswith(b"\x89PNG"), "no picture")
    expect(digests(folder / "made") == before, "the run changed")
    vector = folder / "doubtful.svg"
    expect_exit(command(*arguments[:3], "--picture", vector), 0)
    words = vector.read_text().partition("<desc>")[2].partition("</desc>")[0].splitlines()
    for word in ("2", "3", "4", "not to be trusted", "1 loop switched off"):
        expect(word in words, f"no {word!r} in the picture: {words}")
    expect(any(re.fullmatch(r"3 sigma every \d+ m, \d+ times as large", line) for line in words), f"{words}")
    report["wheels"]["turn"] = "none"
    (folder / "made/report.json").write_text(json.dumps(report))
    process = command(*arguments[:3])
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("'wheels.turn' is not a number" in process.stderr, process.stderr)
    for wrong, says in ((["doctor"], "give a LOG, --after RUN, or --devices"), (["doctor", LOG, "--after", RUN], "excludes"),
                        (["doctor", "--after", RUN, "--topic", "/scan"], "--after"),
                        (["doctor", "--after", RUN, "--picture", "a.txt"], "a.txt")):
        process = command(*wrong)
        expect_exit(process, 2)
        expect(says in process.stderr, process.stderr)
    expect_exit(command("doctor", "--after", folder), 65)
