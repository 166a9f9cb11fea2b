"""Shared by the parts of the report: the content of a part, the commands that make it, and numbers as text."""

import dataclasses
import json
import math
import pathlib
import shlex
import shutil
import subprocess

import matplotlib
import numpy as np

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "font.size": 12})

MATCHERS = {"pso": "PSO", "sce": "SCE", "simpsa": "SIMPSA", "simplex": "Simplex", "gauss-newton": "gauss-newton"}
PAPERS_OWN = ("pso", "sce", "simpsa", "simplex")
COLOURS = {"pso": "#c2410c", "sce": "#0069a8", "simpsa": "#7a3fa0", "simplex": "#00694e", "gauss-newton": "#5d646d"}
REAL_LOGS = {"intel": "Intel Research Lab", "fr079": "Freiburg 079", "mit-csail": "MIT CSAIL"}
ONE_PLACE = "gdtslam_trajectory: 1\nwaypoints:\n  - {{at: [{}], pause: {} s}}\n"
# Simulated drives: the scene, and options of simulate and map. None: it is not mapped.
DRIVES = {
    "office-loop": ("office-loop", (), ()),
    "office-loop-matched": ("office-loop", (), ("--no-loops",)),
    "office-loop-2": ("office-loop", ("--seed", "2"), None),
    "office-loop-3": ("office-loop", ("--seed", "3"), None),
    "one-scan": ("office-loop", ("--laser", "hokuyo-961"), ("--set", "occupancy.min_ends=1", "--first", "1")),
    "three-boxes": ("three-boxes", (), ("--set", "cloud.voxel=0")),
    "at-elevator": ("office-3f", (), ("--set", "cloud.voxel=0")),
    "at-plant": ("office-3f", (), ("--set", "cloud.voxel=0")),
    "office-3f": ("office-3f", ("--truth-hits",), ()),
    "office-7f": ("office-7f", ("--truth-hits",), ()),
    "wall": ("wall", ("--linkage", "paper-b-calibrated"), None),
}
# Positions of the standing robot: at a crossing; with the open elevator ahead and to the left; with a plant ahead.
PLACES = {"one-scan": ("18.9, 6.1", 1), "at-elevator": ("10.5, 4.7", 40), "at-plant": ("18.8, 4.7", 40)}


class Failed(Exception):
    """An error, described in one line."""


@dataclasses.dataclass
class Part:
    source: str
    origin: str = "simulated"
    pictures: list = dataclasses.field(default_factory=list)
    rows: list = dataclasses.field(default_factory=list)
    tables: list = dataclasses.field(default_factory=list)
    notes: list = dataclasses.field(default_factory=list)
    by_hand: list = dataclasses.field(default_factory=list)

    def claim(self, quantity, paper, ours, holds, remark):
        """Adds a row with a verdict: the paper's claim holds here or not."""
        self.rows.append({"quantity": quantity, "paper": paper, "ours": ours, "verdict": "within" if holds else "outside", "remark": remark})

    def state(self, quantity, paper, ours, remark):
        """Adds a row without a verdict."""
        self.rows.append({"quantity": quantity, "paper": paper, "ours": ours, "verdict": "no verdict", "remark": remark})

    def table(self, caption, heads, rows):
        self.tables.append({"caption": caption, "heads": heads, "rows": rows})


class Workshop:
    """Runs the commands in a folder of its own; a part's commands are also the instructions to make it by hand."""

    def __init__(self, programs, folder, device, data):
        self.programs, self.folder, self.device, self.data = programs, folder, device, data
        self.commands, self.drives, self.part_folder = [], {}, None

    def path(self, name):
        return self.folder / name

    def run(self, *words):
        """Runs a command and returns its output. Throws Failed."""
        words = [str(word) for word in words]
        if shlex.join(words) not in self.commands:
            self.commands.append(shlex.join(words))
        done = subprocess.run([self.programs / words[0], *words[1:]], cwd=self.folder, capture_output=True, text=True, check=False,
                              stdin=subprocess.DEVNULL)
        if done.returncode == 130:
            raise KeyboardInterrupt
        if done.returncode != 0:
            raise Failed(f"{shlex.join(words)}: exit {done.returncode}: {(done.stderr.strip().splitlines() or ['no word'])[-1]}")
        return done.stdout

    def json(self, *words):
        return json.loads(self.run(*words, "--json"))

    def map(self, log, run, *words):
        self.run("gdtslam", "map", log, "-o", run, "--no-pictures", "-q", "--device", self.device, *words)

    def drive(self, name):
        """Simulates and maps a drive once: NAME.log, NAME.truth.tum and the run NAME."""
        if name in self.drives:
            self.commands += [command for command in self.drives[name] if command not in self.commands]
            return
        scene, simulation, mapping = DRIVES[name]
        earlier, self.commands = self.commands, []
        if name in PLACES:
            text = ONE_PLACE.format(*PLACES[name])
            self.path(f"{name}.yaml").write_text(text)
            self.commands.append(f"printf {shlex.quote(text.replace(chr(10), chr(92) + 'n'))} > {name}.yaml")
            simulation = (*simulation, "--trajectory", f"{name}.yaml")
        self.run("gdtslam", "simulate", scene, "-o", f"{name}.log", "-q", *simulation)
        if mapping is not None:
            self.map(f"{name}.log", name, *mapping)
        self.drives[name] = self.commands
        self.commands = earlier + self.commands

    def real_logs(self):
        """Names, logs and relations in the folder of real logs."""
        if self.data is None:
            return {}
        for folder in (self.data, self.data / "slam2d"):
            found = {stem: (folder / f"{stem}.clf.gz", folder / f"{stem}.relations.gz") for stem in REAL_LOGS}
            found = {stem: files for stem, files in found.items() if all(file.is_file() for file in files)}
            if found:
                return found
        raise Failed(f"{self.data}: holds none of {', '.join(f'{stem}.clf.gz' for stem in REAL_LOGS)} with its NAME.relations.gz, nor "
                     "does slam2d in it")

    def picture(self, part, file, caption, across=1):
        """Moves a picture into the folder of the part; the page shows `across` pictures side by side."""
        shutil.move(self.path(file), self.part_folder / file)
        part.pictures.append({"file": file, "caption": caption, "across": across})

    def draw(self, part, figure, file, caption, across=1):
        figure.savefig(self.path(file), metadata={"Date": None, "Creator": None})
        matplotlib.pyplot.close(figure)
        self.picture(part, file, caption, across)

    def render(self, part, source, view, file, caption, *words):
        self.run("gdtslam", "render", source, "--view", view, "-o", file, "-q", *words)
        self.picture(part, file, caption)


def read_tum(path):
    """Stamps and poses (x, y, heading), one per row."""
    table = np.loadtxt(path, ndmin=2)
    return table[:, 0], np.column_stack([table[:, 1:3], 2.0 * np.arctan2(table[:, 6], table[:, 7])])


def moved(pose, points):
    """Transforms points from a frame with this pose to its parent."""
    x, y, theta = pose
    turn = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
    return points @ turn.T + (x, y)


def between(first, last):
    """The last pose relative to the first."""
    c, s = math.cos(first[2]), math.sin(first[2])
    x, y = last[0] - first[0], last[1] - first[1]
    turn = last[2] - first[2]
    return np.array([c * x + s * y, c * y - s * x, math.atan2(math.sin(turn), math.cos(turn))])


def length_text(metres):
    """A length in a suitable unit: "4.00 mm", "1.23 cm", "2.50 m"."""
    for unit, scale, below in (("mm", 1000.0, 0.01), ("cm", 100.0, 1.0)):
        if abs(metres) < below:
            return f"{scale * metres:.2f} {unit}"
    return f"{metres:.2f} m"


def cm_text(errors):
    """Mean and deviation in cm, from a command's error summary in metres."""
    return f"{100.0 * errors['mean']:.2f} ± {100.0 * errors['std']:.2f}"


def ranking(names, values):
    """Names in ascending order of their values."""
    return ", ".join(name for _, name in sorted(zip(values, names), key=lambda pair: pair[0]))


def joined(names):
    return " Real: the logs " + ", ".join(names) + "."


def folder_of_scripts():
    return pathlib.Path(__file__).resolve().parent
