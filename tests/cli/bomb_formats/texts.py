"""Bombs of YAML and JSON: configurations, scenes, descriptions of maps; reports, plans, edits, indices of tiles."""

import json

import cli_support as cli
from bomb_formats.bomb import MB, Bomb, log_of

HEAD = "gdtslam_scene: 1\n"
PLACE = "waypoints: [{at: [0, 0], pause: 1 s}]\n"


def configuration(text):
    def make(folder):
        (folder / "config.yaml").write_text(text())
        return ["config", "show", "--config", folder / "config.yaml"]

    return make


def scene(text):
    def make(folder):
        (folder / "scene.yaml").write_text(HEAD + text() + PLACE)
        return ["simulate", folder / "scene.yaml", "-o", folder / "drive.log"]

    return make


def laughs(kind="[{}]"):
    """Ten lists, each of ten of the one before."""
    lines = ["a0: &a0 " + kind.format(", ".join(["x"] * 10))]
    lines += [f"a{k}: &a{k} {kind.format(', '.join([f'*a{k - 1}'] * 10))}" for k in range(1, 11)]
    return "\n".join(lines) + "\n"


def many_keys():
    return "".join(f"k{k}: 1\n" for k in range(90_000))


def repeats():
    row = "{from: 0, width: 1 mm, repeat: {count: 200000, step: 0.002}}"
    return f"walls: [{{points: [[0, 0], [900, 0]], windows: [{', '.join([row] * 300)}]}}]\n"


def day_long(folder):
    """A robot that stands for a day and scans as often as any laser."""
    (folder / "scene.yaml").write_text("gdtslam_scene: 1\nboxes: [{centre: [3, 0], size: [1, 9], height: 2 m}]\n"
                                       "recording: {scan_rate: 9999 Hz, odometry_rate: 1 Hz}\n"
                                       "waypoints: [{at: [0, 0], pause: 86400 s}]\n")
    return ["simulate", folder / "scene.yaml", "-o", folder / "drive.log"]


def aliased_walls():
    points = ", ".join(f"[{k % 100}, {k // 100}]" for k in range(5000))
    return f"walls: [&w {{points: [{points}]}}, {', '.join(['*w'] * 5000)}]\n"


def aliased_waypoints(folder):
    """A path of ten million places."""
    hundred = ", ".join(["{at: [0, 0]}"] * 100)
    (folder / "path.yaml").write_text(f"a: &a [{hundred}]\nwaypoints: [{', '.join(['*a'] * 100_000)}]\n")
    return ["simulate", "wall", "--trajectory", folder / "path.yaml", "-o", folder / "drive.log"]


def run_with_report(text):
    def make(folder):
        (folder / "report.json").write_bytes(text())
        return ["evaluate", folder, "--reference", cli.TRUTH]

    return make


def json_line(depth):
    return b'{"stamp":' + b"[" * depth + b"]" * depth + b"}\n"


BOMBS = [
    Bomb("YAML aliases of aliases", configuration(laughs), 78, "config.yaml"),
    Bomb("YAML of 90,000 keys", configuration(many_keys), 78, "config.yaml", 400),
    Bomb("YAML nested 30,000 deep", configuration(lambda: "a: " + "[" * 30_000 + "]" * 30_000 + "\n"), 78, "nested too deeply"),
    Bomb("YAML of 300,000 documents", configuration(lambda: "---\n" * 250_000), 78, "config.yaml"),
    Bomb("scene of repeats", scene(repeats), 78, "more than 200000 parts", 200),
    Bomb("scene of aliases", scene(aliased_walls), 78, "more than 200000 parts", 200),
    Bomb("scene of a day at 10,000 scans a second", day_long, 78, "scene.yaml: .* 864000000 records"),
    Bomb("waypoints of aliases", aliased_waypoints, 78, "path.yaml", 200),
    Bomb("JSON nested 1,000,000 deep", run_with_report(lambda: b"[" * 1_000_000), 65, "nested deeper"),
    Bomb("JSON of 4,000,000 values", run_with_report(lambda: b"[" + b"0," * 4_000_000 + b"0]"), 65, "more than the"),
    Bomb("JSON text of 60 MB", run_with_report(lambda: b'{"version":"' + b"x" * (60 * MB) + b'"}'), 65, "text of more than"),
    Bomb("JSON line nested 100,000 deep", log_of("log.jsonl", lambda: json_line(100_000)), 65, "log.jsonl:1"),
]
