#!/usr/bin/python3
"""The paper's figures and tables made anew by gdtslam, as one report with the paper's numbers beside ours.

  reproduce.py [--programs FOLDER] -o DIR [--only PARTS] [--data DIR] [--force] [--keep-runs]

Writes DIR/report.html, one file that needs nothing else; DIR/parts has the pictures. Parts that are made stay made until the programs or the scripts change, so an interrupted report goes on where it was (Ctrl-C: exit 130). DIR is new,
empty or of an earlier report. docs/howto/reproduce.md says what is compared with what.
"""

import argparse
import base64
import dataclasses
import datetime
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import sys
import tempfile
import time

import jinja2
import markupsafe

import parts_3d
import parts_future
import parts_maps
import parts_optimizers
from part import Failed, Workshop, folder_of_scripts

MARK = ".gdtslam-reproduce"


@dataclasses.dataclass
class Info:
    """A part of the report: its content here and in the paper, and the function that makes it."""
    id: str
    also: str
    label: str
    title: str
    paper: str
    make: object
    kept: dict = None  # what part.json has of it


PARTS = (
    Info("fig3", "", "Figure 3", "A small distance transform",
         "a grid of ten by ten cells, before and after the distance transform, with the numbers in the cells.", parts_maps.make_cells),
    Info("fig4", "", "Figure 4", "The distance transform of one scan",
         "the points of one scan, and its distance transform as a grey picture that is bright near obstacles.", parts_maps.make_local_scan),
    Info("fig7", "", "Figure 7", "A floor mapped in 2D, with a loop",
         "the map of an office floor with the robot’s path, which ends where it began, and the global distance transform behind it.",
         parts_maps.make_loop),
    Info("fig8", "table1", "Figure 8, table 1", "Four optimizers against the best solution",
         "how far the poses of PSO, SCE, SIMPSA and simplex are from the global solution, scan by scan and in sum.",
         parts_optimizers.make_optimizer_errors),
    Info("fig9", "table2", "Figure 9, table 2", "Four optimizers against the true position",
         "how far the robot’s position is from the ground truth with each optimizer, and the time that each takes.",
         parts_optimizers.make_optimizer_positions),
    Info("fig11", "", "Figure 11", "The crank-rocker linkage",
         "the four-bar linkage that nods the laser: one bar turns all the way round, another swings to and fro.", parts_3d.make_linkages),
    Info("fig12", "", "Figure 12", "Three boxes, measured",
         "three boxes on the floor, their 3D map from one place, and their widths read off its projection to the floor.", parts_3d.make_boxes),
    Info("fig13", "", "Figure 13", "Surroundings from one place",
         "3D maps from two places of a floor, an elevator and a plant among what is seen, and photographs beside them.",
         parts_3d.make_standing),
    Info("fig14", "", "Figure 14", "An office floor in 3D: 3F",
         "the 2D map of the third floor and its 3D map from a moving robot, without floor and ceiling.", parts_3d.make_floor_3f),
    Info("fig15", "", "Figure 15", "An office floor in 3D: 7F", "the same of the seventh floor.", parts_3d.make_floor_7f),
    Info("figA", "", "Figure A", "The linkage calibrated before a wall",
         "ranges to a wall over the encoder, measured and as the linkage has them, before and after its lengths are fitted.",
         parts_3d.make_calibration),
    Info("future", "", "Section 4", "Future work: 6D and NDT",
         "comparison with 6D SLAM, and registration of clouds by 3D NDT, are announced.", parts_future.make_future),
)


def cpu_s():
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


def seconds_text(seconds):
    return f"{seconds:.1f} s" if seconds < 59.95 else f"{round(seconds) // 60}:{round(seconds) % 60:02} min"


def now_text():
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")


def digest_of(files):
    total = hashlib.sha256()
    for file in files:
        total.update(hashlib.sha256(pathlib.Path(file).read_bytes()).digest())
    return total.hexdigest()


def bound(text):
    """Keeps a number in one line with its unit and its deviation."""
    return re.sub(r"(?<=\d) (?=(?:cm|mm|m|s|%)(?:\W|$))|(?<=±) | (?=±)", "\u00a0", text)


class Report:
    def __init__(self, options):
        self.folder, self.options = options.output, options
        self.claim_folder()
        programs = [options.programs / name for name in ("gdtslam", "gdtslam-lab")]
        for program in programs:
            if not os.access(program, os.X_OK):
                raise Failed(f"{program}: there is no such program; build it with -DGDTSLAM_BUILD_LAB=ON, or give --programs FOLDER")
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="work-", dir=self.folder))
        self.shop = Workshop(options.programs.resolve(), self.work, options.device, options.data)
        logs = [file for files in self.shop.real_logs().values() for file in files]
        self.key = digest_of([*programs, *sorted(folder_of_scripts().glob("*.py")), *logs]) + options.device
        for info in PARTS:
            info.kept = self.find(info.id)

    def claim_folder(self):
        """Requires a folder that is new, empty or marked by an earlier report; nothing else is replaced."""
        if self.folder.exists() and not (self.folder / MARK).is_file():
            if not self.folder.is_dir() or any(self.folder.iterdir()):
                raise Failed(f"{self.folder}: was not made by reproduce.py, which would replace what is in it; give another -o DIR")
        (self.folder / "parts").mkdir(parents=True, exist_ok=True)
        (self.folder / MARK).write_text("reproduce.py made this folder.\n")
        for left in (*self.folder.glob("work-*"), *self.folder.glob("parts/*.making")):
            shutil.rmtree(left)

    def find(self, name):
        """The stored part; None if it is incomplete or was made by other programs or scripts."""
        folder = self.folder / "parts" / name
        try:
            kept = json.loads((folder / "part.json").read_text())
            if kept["key"] == self.key and all((folder / picture["file"]).is_file() for picture in kept["part"]["pictures"]):
                return kept
        except (OSError, ValueError, KeyError, TypeError):  # it is made again
            pass
        return None

    def make(self, info):
        place = self.folder / "parts" / info.id
        self.shop.part_folder = place.with_suffix(".making")
        self.shop.part_folder.mkdir()
        self.shop.commands = []
        start_s = cpu_s()
        part = info.make(self.shop)
        part.by_hand = self.shop.commands
        kept = {"key": self.key, "cpu_s": cpu_s() - start_s, "date": now_text(), "part": dataclasses.asdict(part)}
        (self.shop.part_folder / "part.json").write_text(json.dumps(kept, indent=1))
        shutil.rmtree(place, ignore_errors=True)
        self.shop.part_folder.rename(place)
        info.kept = kept
        print(f"{info.label}: made, {kept['cpu_s']:.1f} s of CPU time", flush=True)

    def make_all(self):
        for info in PARTS:
            is_wanted = not self.options.only or info.id in self.options.only
            if is_wanted and (self.options.force or info.kept is None):
                self.make(info)

    def end(self):
        """Cleans up after the last part, also after an error."""
        for left in self.folder.glob("parts/*.making"):
            shutil.rmtree(left)
        if self.options.keep_runs:
            shutil.rmtree(self.folder / "work", ignore_errors=True)
            self.work.rename(self.folder / "work")
        else:
            shutil.rmtree(self.work)

    def facts(self):
        devices = {device["device"]: device["name"] for device in self.shop.json("gdtslam", "doctor", "--devices")["devices"]}
        version = self.shop.run("gdtslam", "--version").splitlines()[0]
        kept = [info.kept for info in PARTS if info.kept]
        verdicts = [row["verdict"] for each in kept for row in each["part"]["rows"]]
        return {"Version": version, "Report written": now_text(), "Processor": f"{devices['cpu']}, {os.cpu_count()} threads",
                "Device": self.options.device,
                "Parts": f"{len(kept)} of {len(PARTS)} made, {seconds_text(sum(each['cpu_s'] for each in kept))} of CPU time",
                "Verdicts": f"{verdicts.count('within')} within, {verdicts.count('outside')} outside, {verdicts.count('no verdict')} without"}

    def image(self, info, picture):
        """A picture as the page embeds it: drawings as SVG without their XML declaration."""
        data = (self.folder / "parts" / info.id / picture["file"]).read_bytes()
        if picture["file"].endswith(".svg"):
            text = data.decode()
            return markupsafe.Markup(text[text.index("<svg"):])
        encoded = base64.b64encode(data).decode()
        return markupsafe.Markup('<img alt="{}" src="data:image/png;base64,{}">').format(picture["caption"], encoded)

    def write(self):
        scripts = folder_of_scripts()
        templates = jinja2.Environment(loader=jinja2.FileSystemLoader(scripts), autoescape=True, trim_blocks=True, lstrip_blocks=True,
                                       keep_trailing_newline=True, undefined=jinja2.StrictUndefined)
        templates.filters.update(bound=bound)
        text = templates.get_template("report.html.jinja").render(
            facts=self.facts(), parts=PARTS, image=self.image, seconds_text=seconds_text, style=(scripts / "report.css").read_text(),
            rows=[(info, row) for info in PARTS if info.kept for row in info.kept["part"]["rows"]])
        new = self.folder / "report.new"
        new.write_text(text, encoding="utf-8")
        new.replace(self.folder / "report.html")


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[3] / "build/release/bin",
                        help="folder with gdtslam and gdtslam-lab (%(default)s)")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="folder of the report; made if need be")
    parser.add_argument("--only", type=lambda text: text.split(","), default=[], help="make these parts only, by commas (see --list)")
    parser.add_argument("--list", action="store_true", help="list the parts")
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("GDTSLAM_DATA"),
                        help="folder of real logs (intel.clf.gz with intel.relations.gz, or slam2d with both), which are added to the "
                             "simulated ones [GDTSLAM_DATA of the environment, else none]")
    parser.add_argument("--device", default="auto", help="of map: auto, cpu, vulkan or vulkan:N (%(default)s)")
    parser.add_argument("--force", action="store_true", help="make parts anew that are made already")
    parser.add_argument("--keep-runs", action="store_true", help="leave the simulated logs and their runs in DIR/work")
    options = parser.parse_args(words)
    names = {name: info.id for info in PARTS for name in (info.id, info.also) if name}
    unknown = [name for name in options.only if name not in names]
    if unknown:
        parser.error(f"--only: there is no part '{unknown[0]}'; there are {', '.join(names)}")
    if options.output is None and not options.list:
        parser.error("say where the report goes: -o DIR")
    options.only = [names[name] for name in options.only]
    options.data = pathlib.Path(options.data).resolve() if options.data else None
    return options


def main(words=None):
    options = arguments_of(words)
    if options.list:
        for info in PARTS:
            print(f"{', '.join(filter(None, (info.id, info.also))):<14} {info.label:<18} {info.title}")
        return 0
    status, start_s = 0, time.monotonic()
    try:
        report = Report(options)
        try:
            report.make_all()
        except KeyboardInterrupt:
            status = 130
            print("reproduce.py: interrupted; the parts that are made are kept, the same command goes on", file=sys.stderr)
        except Failed as error:
            status = 1
            print(f"reproduce.py: error: {error}", file=sys.stderr)
        report.write()
        report.end()
    except (Failed, OSError) as error:
        print(f"reproduce.py: error: {error}", file=sys.stderr)
        return 1
    print(f"{options.output / 'report.html'}\n{time.monotonic() - start_s:.0f} s")
    return status


if __name__ == "__main__":
    sys.exit(main())
