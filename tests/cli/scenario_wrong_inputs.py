"""What is no log, no run or no map is told by what it is, with what to give instead."""

import gzip
import shutil

from cli_support import LOG, RUN, TRUTH, command, expect, expect_exit, fresh_folder, one_error_line


def refused(code, words, *arguments):
    process = command(*arguments)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(words in process.stderr, f"{arguments}: {process.stderr}")


def folders_that_are_no_runs():
    """Exit 65 and what to give."""
    folder = fresh_folder("folders_that_are_no_runs")
    shutil.copytree(RUN, folder / "merged" / "1")
    (folder / "merged" / "merge.json").write_text("{}")
    merged = folder / "merged"
    for words in (("localize", merged, LOG), ("live", LOG, "--map", merged), ("doctor", "--after", merged),
                  ("evaluate", merged, "--reference", TRUTH)):
        refused(65, f"give one of its sites, {folder / 'merged' / '1'}", *words)
    refused(65, "is a file; give the folder of a run", "doctor", "--after", LOG)
    refused(65, "is a file; give the folder of a run", "edit", LOG, "-o", folder / "new")
    refused(65, "is no folder of a run: it is not there", "doctor", "--after", folder / "nowhere")
    for line in (("map", RUN, "-o", folder / "new"), ("doctor", RUN), ("live", RUN, "-o", folder / "new")):
        refused(65, "is a folder of results and no log; gdtslam map --continue maps its logs again", *line)


def lines_that_cannot_be_read_name_a_command_that_skips_them():
    """Commands without --lenient read what 'convert --lenient' wrote."""
    folder = fresh_folder("lines_that_cannot_be_read")
    (folder / "bad.log").write_text("FLASER many 1.0 2.0\n" + LOG.read_text())
    refused(65, "with --lenient, or else with gdtslam convert --lenient", "map", folder / "bad.log", "-o", folder / "run")
    expect_exit(command("convert", folder / "bad.log", "--lenient", "-o", folder / "good.log"), 0)
    expect_exit(command("map", folder / "good.log", "-q", "--first", 5, "-o", folder / "run"), 0)


def live_tells_of_a_laser_that_nods():
    """It takes the laser for level, and says what does not."""
    folder = fresh_folder("live_tells_of_a_laser_that_nods")
    lines = LOG.read_text().splitlines(keepends=True)
    (folder / "nods.log").write_text("ENCODER 5 0.0 robot 0.0\nENCODER 9 0.1 robot 0.1\n" + "".join(lines))
    for line in (("-o", folder / "run", "--no-loops"), ("--map", RUN)):
        for log, nods in ((folder / "nods.log", True), (LOG, False)):
            process = command("live", log, *line, *(() if "--map" in line else ("--force",)))
            expect_exit(process, 0)
            expect(("the laser of this log nods" in process.stderr) == nods, process.stderr)


def files_of_another_kind():
    """What is packed, what holds poses in place of relations, a run's folder in place of a log."""
    folder = fresh_folder("files_of_another_kind")
    (folder / "config.yaml").write_bytes(gzip.compress((RUN / "config.yaml").read_bytes()))
    refused(78, "is a packed file and no YAML; unpack it first", "map", LOG, "--config", folder / "config.yaml", "-o", folder / "new")
    refused(65, "is a trajectory with rows `t x y z qx qy qz qw` and no relations", "evaluate", RUN, "--relations", TRUTH)
    shutil.copytree(RUN, folder / "run")
    before = {file.name: file.read_bytes() for file in (folder / "run").iterdir() if file.is_file()}
    for force in ((), ("--force",)):
        refused(2, "is a folder; give the name of a file", "convert", LOG, "--format", "mcap", *force, "-o", folder / "run")
    expect({file.name: file.read_bytes() for file in (folder / "run").iterdir() if file.is_file()} == before, "the run is another")
