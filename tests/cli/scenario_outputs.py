"""What a command writes replaces nothing that it reads, and nothing that exists unless --force is given."""

import json
import re
import shutil

import cli_support as cli
import scenario_bags as bags
from cli_support import LOG, RUN, TRUTH, command, digests, expect, expect_exit, mapped, one_error_line


def refused(folder, words, *arguments, code=2):
    """Ends so, with one line that has the words, and leaves all files in the folder as they are."""
    before = digests(folder)
    process = command(*arguments)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(words in process.stderr, process.stderr)
    expect(digests(folder) == before, f"{arguments} changed {[name for name in before if digests(folder).get(name) != before[name]]}")


READ, OF_RUN, TWICE = "is what is read; give another file", "which is read; give another file", "writes; give another file"


def outputs_are_no_inputs():
    """Exit 2 before anything is done where an output is a file that the command reads, by whatever path; all files stay."""
    folder = cli.fresh_folder("outputs_are_no_inputs")
    log, run, config, link = folder / "drive.log", folder / "run", folder / "c.yaml", folder / "link.svg"
    shutil.copy(LOG, log)
    shutil.copytree(RUN, run)
    shutil.copy(cli.DATA / "good.yaml", config)
    shutil.copy(cli.DATA / "drive.relations", folder / "r")
    shutil.copy(cli.DATA / "places.ply", folder / "p.ply")
    link.symlink_to(log)
    expect_exit(command("linkage", "paper-b", "-o", folder / "b.yaml"), 0)
    twisted = folder / "run" / ".." / "drive.log"
    for arguments in (
            ("calibrate", log, "-o", log), ("calibrate", log, "-o", folder / "n.yaml", "--picture", link),
            ("calibrate", log, "-o", folder / "b.yaml", "--start", folder / "b.yaml", "--self"),
            ("evaluate", folder / "p.ply", "--planes", "--csv", folder / "p.ply"),
            ("linkage", folder / "b.yaml", "--csv", folder / "b.yaml"), ("linkage", folder / "b.yaml", "-o", folder / "b.yaml"),
            ("render", folder / "p.ply", "-o", folder / "p.ply", "--points", 2),
            ("evaluate", folder / "p.ply", "--scene", "three-boxes", "--trajectory", run / "trajectory.tum", "--reference", TRUTH,
             "--csv", folder / "p.ply"),
            ("ablation", log, "--relations", folder / "r", "-o", twisted), ("ablation", log, "--relations", folder / "r", "-o", folder / "r"),
            ("map", log, "-o", folder / "new", "--mcap", twisted),
            ("map", log, "-c", config, "-o", folder / "new", "--mcap", config),
            ("localize", run, log, "-c", config, "-o", config), ("compare", log, "-c", config, "--csv", config)):
        refused(folder, READ, *arguments)


def outputs_are_no_files_of_a_run():
    """Nor one of the files of a run folder that is read or written; a name of one's own in that folder is written, and again."""
    folder = cli.fresh_folder("outputs_are_no_files_of_a_run")
    run, to_run = folder / "run", folder / "to_run"
    shutil.copytree(RUN, run)
    to_run.symlink_to(run)
    for option, name in (("-o", "trajectory.tum"), ("--picture", "gdt.png"), ("-o", "cloud.ply"), ("--picture", "tiles/a.png")):
        refused(folder, OF_RUN, "localize", run, LOG, option, to_run / name)
    refused(folder, OF_RUN, "localize", run, LOG, "--track", "--table", run / "report.json")
    refused(folder, READ, "localize", run / "gdt.yaml", LOG, "--picture", run / "gdt.png")
    refused(folder, OF_RUN, "evaluate", run, "--planes", "--csv", run / "cloud.ply")
    refused(folder, OF_RUN, "render", run, "-o", run / "gdt.png")
    refused(folder, OF_RUN, "doctor", "--after", run, "--picture", run / "graph.png")
    for name in ("report.json", "gdt.png"):
        refused(folder, "which is written; give another file", "map", LOG, "-o", run, "--force", "--mcap", to_run / name)
    for name in ("trajectory.tum", "report.json", "overview.png"):  # of a run that is not read
        refused(folder, "which would be damaged; give another file", "linkage", "paper-b", "--csv", to_run / name)
    for force in ((), ("--force",)):
        expect_exit(command("localize", run, LOG, "-q", "-o", to_run / "found.tum", *force), 0)
    other = folder / "other"  # a map of another program, whose picture is called as it likes
    other.mkdir()
    shutil.copy(RUN / "map.pgm", other / "floor.png")
    (other / "m.yaml").write_text((RUN / "map.yaml").read_text().replace("map.pgm", '"floor.png"  # of a scanner'))
    refused(other, READ, "localize", other / "m.yaml", LOG, "--picture", other / "floor.png")
    (other / "m.yaml").rename(other / "m.yml")
    refused(other, READ, "localize", other / "m.yml", LOG, "--picture", other / "floor.png")
    refused(other, READ, "render", other / "m.yml", "-o", other / "floor.png")
    (other / "floor.png").rename(other / "office-map.png")  # what a picture of it is called where no name is given
    (other / "office.yaml").write_text((other / "m.yml").read_text().replace("floor.png", "office-map.png"))
    before = digests(other)
    process = command("render", "office.yaml", cwd=other)
    expect_exit(process, 2)
    expect(READ in process.stderr and digests(other) == before, process.stderr)


def outputs_that_exist_stay():
    """The one rule: every output of every command that exists is refused with 2, before the work, and replaced with --force."""
    folder = cli.fresh_folder("outputs_that_exist")
    log, relations, places = folder / "short.log", cli.DATA / "drive.relations", cli.DATA / "places.ply"
    log.write_text("".join(LOG.read_text().splitlines(keepends=True)[:200]))
    mapped(folder / "first", "--first", 60)
    mapped(folder / "second", "--first", 70)
    run = folder / "first"
    evaluated = ("evaluate", places, "--scene", "three-boxes", "--trajectory", RUN / "trajectory.tum", "--reference", TRUTH)
    files = [  # a command with its output last, and the file that is there
        (("linkage", "paper-b", "-o", "a.yaml"), "a.yaml"), (("linkage", "paper-b", "--csv", "a.csv"), "a.csv"),
        (("linkage", "paper-b", "--picture", "a.svg"), "a.svg"), (("convert", log, "-o", "a.jsonl"), "a.jsonl"),
        (("map", log, "-o", folder / "new", "--mcap", "a.mcap"), "a.mcap"),
        (("doctor", "--after", run, "--picture", "a.svg"), "a.svg"), (("localize", RUN, log, "-o", "a.tum"), "a.tum"),
        (("localize", RUN, log, "--picture", "a.svg"), "a.svg"), (("localize", RUN, log, "--track", "--table", "a.csv"), "a.csv"),
        (("localize", RUN, log, "--track", "--changes", "a.svg"), "a.csv"), (("evaluate", places, "--planes", "--csv", "a.csv"), "a.csv"),
        (("evaluate", places, "--boxes", "--picture", "a.svg"), "a.svg"), ((*evaluated, "--csv", "a.csv"), "a.csv"),
        (("register", cli.DATA / "room.ply", cli.DATA / "room_moved.ply", "-o", "a.ply"), "a.ply"),
        (("register", cli.DATA / "room.ply", cli.DATA / "room_moved.ply", "--picture", "a.png"), "a.png"),
        (("calibrate", log, "-o", "a.yaml"), "a.yaml"), (("calibrate", log, "-o", "b.yaml", "--picture", "a.svg"), "a.svg"),
        (("simulate", "wall", "--rate", 1, "-q", "-o", "a.log"), "a.log"), (("simulate", "wall", "--rate", 1, "-q", "-o", "a.log"), "a.truth.tum"),
        (("verify", "--write-expected", "a.json"), "a.json"), (("render", RUN, "--view", "map", "--size", "64x64", "-o", "a.png"), "a.png"),
        (("render", RUN, "--view", "map", "--size", "64x64"), "office-map.png"), (("render", "paper-b", "-o", "a.mp4"), "a.mp4"),
        (("render", "paper-b", "--size", "64x64", "--seconds", "0.08s", "-o", "./"), "frame-0001.png"),
        (("compare", log, "--csv", "a.csv"), "a.csv"), (("compare", log, "--picture", "a.svg"), "a.svg"),
        (("ablation", log, "--relations", relations, "-o", "a.md"), "a.md")]
    folders = [(("map", log), "notes"), (("live", log), "report.json"), (("edit", run, "--origin", "1,1"), "notes"),
               (("merge", run, folder / "second"), "1")]
    folders = [((*words, "-o", "out"), f"out/{name}") for words, name in folders]
    seldom = ("calibrate", "compare", "ablation", "verify", "evaluate")  # refused only: the work is long or needs other inputs
    seen = set()
    for arguments, name in files + folders:
        text = command(arguments[0], "--help").stdout
        if "--force" not in text:  # not in this build
            expect("Not in this build" in text, f"{arguments[0]} has no --force")
            continue
        seen.add(arguments[0])
        place = cli.fresh_folder("outputs_that_exist_here")
        (place / name).parent.mkdir(exist_ok=True)
        (place / name).write_text("mine")
        process = command(*arguments, cwd=place)
        expect_exit(process, 2)
        one_error_line(process.stderr)
        expect("exists; give another name, or --force to replace it" in process.stderr, f"{arguments}: {process.stderr}")
        expect(digests(place) == digests_of_mine(place, name), f"{arguments}: something was written")
        if arguments[0] not in seldom and "a.mp4" not in arguments:
            expect_exit(command(*arguments, "--force", cwd=place), 0)
            expect(not (place / name).is_file() or (place / name).read_text(errors="replace") != "mine", f"{arguments}: not replaced")
            shutil.rmtree(folder / "new", ignore_errors=True)
    writers = {name for name in re.findall(r"^  (\w+) ", command("--help").stdout, re.MULTILINE)
               if re.search(r"--output|--csv|--picture", command(name, "--help").stdout)}
    expect({"map", "convert"} < writers and writers <= seen, f"not tried: {writers - seen}")
    (folder / "pipe").symlink_to("/dev/null")
    expect_exit(command("linkage", "paper-b", "-o", "/dev/null", "--csv", folder / "pipe"), 0)


def digests_of_mine(place, name):
    """The folder with that file alone in it."""
    alone = cli.fresh_folder("outputs_that_exist_mine")
    (alone / name).parent.mkdir(exist_ok=True)
    (alone / name).write_text("mine")
    return digests(alone)


def outputs_are_not_each_other():
    """Two outputs of one name: exit 2, where one of them replaced the other."""
    folder = cli.fresh_folder("outputs_are_not_each_other")
    (folder / "here").symlink_to(folder)
    for arguments in (("localize", RUN, LOG, "--track", "-o", folder / "t", "--table", folder / "t"),
                      ("localize", RUN, LOG, "--track", "--table", folder / "a.csv", "--changes", folder / "here" / "a.svg"),
                      ("linkage", "paper-b", "--csv", folder / "a", "-o", folder / "here" / "a"),
                      ("linkage", "paper-b", "--picture", folder / "a.svg", "-o", folder / "none" / ".." / "a.svg"),
                      ("compare", LOG, "--csv", folder / "a.svg", "--picture", folder / "a.svg")):
        refused(folder, TWICE, *arguments)
    expect_exit(command("linkage", "paper-b", "--csv", "/dev/null", "-o", "/dev/null"), 0)


def simulate_keeps_what_it_reads():
    """The scene, its meshes and its linkage, the path: none of them becomes the log or a file beside it."""
    folder = cli.fresh_folder("simulate_keeps_what_it_reads")
    scene, named = folder / "my.yaml", folder / "z.yaml"
    shutil.copy(cli.SOURCE / "assets/scenes/three-boxes.yaml", scene)
    for name in ("z.linkage.yaml", "x.linkage.yaml"):
        expect_exit(command("linkage", "paper-b", "-o", folder / name), 0)
    refused(folder, READ, "simulate", scene, "-o", scene)
    refused(folder, READ, "simulate", scene, "-o", folder / "z.log", "--linkage", folder / "z.linkage.yaml")
    text = scene.read_text()
    expect("linkage: paper-b" in text, "the sample names its linkage otherwise")
    named.write_text(text.replace("linkage: paper-b", "linkage: 'x.linkage.yaml'"))
    refused(folder, READ, "simulate", named, "-o", folder / "x.log")
    expect_exit(command("simulate", named, "-o", folder / "y.log", "-q"), 0)


def convert_keeps_what_it_reads():
    """A ROS 2 folder is not converted over itself, by whatever name and with --force; beside it a new name is written."""
    folder = cli.fresh_folder("convert_keeps_what_it_reads")
    bag, link = folder / "bag", folder / "link"
    bag.mkdir()
    bags.database_of_log(bag / "bag_0.db3")
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information:\n  relative_file_paths:\n    - bag_0.db3\n")
    link.symlink_to(bag)
    for output in (bag / "bag_0.db3", link / "bag_0.db3", bag / "metadata.yaml"):
        refused(folder, "read; give another file", "convert", bag, "-o", output, "--force", "--format", "mcap")
    refused(folder, "is a folder; give the name of a file", "convert", bag, "-o", bag, "--force", "--format", "mcap")
    refused(folder, "read; give another file", "map", bag, "-o", folder / "run", "--mcap", bag / "bag_0.db3")
    for _ in range(2):
        expect_exit(command("convert", bag, "-o", bag / "drive.csv", "--force", "-q"), 0)


def convert_counts_what_is_written():
    """Scans whose stamps ROS does not know are not counted as written; where all are such, 65 and no file, or the old one."""
    folder = cli.fresh_folder("convert_counts")
    lines = LOG.read_text().splitlines(keepends=True)
    scans = [k for k, line in enumerate(lines) if line.startswith("FLASER")]

    def log_at(name, few):
        words = [line.split() for line in lines[:scans[60]]]
        for k, row in enumerate(words):
            if row[0] in ("FLASER", "ODOM") and (few is None or k >= scans[few]):
                row[-3] = row[-1] = "1e18"
        (folder / name).write_text("".join(" ".join(row) + "\n" for row in words))
        return folder / name

    some, none = log_at("some.log", 20), log_at("none.log", None)
    process = command("convert", some, "-o", folder / "some.mcap", "--json")
    expect_exit(process, 0)
    expect(json.loads(process.stdout)["scans"] == 20, process.stdout)
    expect("20 scans" in command("convert", some, "-o", folder / "again.mcap").stdout, "the text counts otherwise")
    (folder / "old.mcap").write_text("an old file")
    refused(folder, "can carry none of its 60 scans", "convert", none, "-o", folder / "none.mcap", code=65)
    refused(folder, "can carry none of its 60 scans", "convert", none, "-o", folder / "old.mcap", "--force", code=65)
    expect_exit(command("convert", none, "-o", folder / "none.csv", "-q"), 0)
