"""Files of a run: written whole or not at all, old ones kept or replaced."""

import json
import os
import re
import resource
import signal

import cli_support as cli
from cli_support import DATA, LOG, OUTPUTS, RUN, command, digests, expect, expect_exit, mapped, one_error_line, skip


def fixture():
    """The drive and the map that the other tests start from."""
    cli.WORK.mkdir(parents=True, exist_ok=True)
    process = command("simulate", "office-loop", "-o", LOG, "--force", "--seed", 3, "--rate", 5, "--json")
    expect_exit(process, 0)
    cli.write_data()
    mapped(RUN)
    expect(sorted(digests(RUN)) == OUTPUTS, f"the run folder holds {sorted(digests(RUN))}")


def old_run(name):
    """A folder with an earlier run, to be kept or replaced."""
    folder = cli.fresh_folder(name) / "run"
    mapped(folder, "--first", 40)
    return folder, digests(folder)


def overview_without_a_font():
    """The picture of a map needs letters: without any font the run has none, says so, and is whole otherwise."""
    folder, before = old_run("overview_without_a_font")
    expect(cli.OVERVIEW in before, f"the run folder holds {sorted(before)}")
    bare = cli.environment_without_fonts(folder.parent)
    mapped(folder, "--first", 50, env=bare)
    expect(not any(name.startswith("overview.") for name in digests(folder)), f"{sorted(digests(folder))}")
    warnings = json.loads((folder / "report.json").read_text())["warnings"]
    expect("no picture overview" in warnings, f"{warnings}")
    mapped(folder, "--first", 50)
    names = [name for name in digests(folder) if name.startswith("overview.")]
    expect(names == [cli.OVERVIEW], f"with fonts again: {names}")


def every_write_fails():
    """Whichever write or sync fails because the disk is full: exit 74, one line, the old files byte for byte. The last sync is that
    of the folder above, after the exchange: the new run lies there whole."""
    if cli.IS_SANITIZED:
        skip("the library that fills the disk is not preloaded into a sanitized program")
    folder, before = old_run("every_write_fails")
    arguments = ("map", LOG, "--force", "--first", 15, "-q")
    count = cli.calls_counted("write,sync", *arguments, "-o", folder.parent / "counted")
    expect(count >= 2 * len(OUTPUTS), f"only {count} writes were seen")
    for failing in range(1, count + 1):
        process = command(*arguments, "-o", folder, env=cli.full_disk(failing))
        expect_exit(process, 74)
        one_error_line(process.stderr)
        expect("No space left on device" in process.stderr, process.stderr)
        if failing < count:
            expect(digests(folder) == before, f"the folder changed when write {failing} failed")
    expect_exit(command("evaluate", folder, "--reference", folder), 0)  # refuses a run that is not whole
    fresh = folder.parent / "fresh"
    expect_exit(command(*arguments, "-o", fresh, env=cli.full_disk()), 74)
    expect(not fresh.exists(), "a folder that was made for a run that failed is still there")


def file_size_limit():
    """A limit of the file size (ulimit -f): exit 74, the old files byte for byte. SIGXFSZ must not end the process first."""
    folder, before = old_run("file_size_limit")

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)

    process = command("map", LOG, "-o", folder, "--force", "--first", 50, "-q", preexec_fn=limit)
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect("File too large" in process.stderr, process.stderr)
    expect(digests(folder) == before, "the folder changed")


def killed_at_a_rename():
    """Killed before whichever rename: the folder holds the old run or the new one, and nothing else."""
    if cli.IS_SANITIZED:
        skip("the library that kills the process is not preloaded into a sanitized program")
    coarse = ("--first", 15, "--set", "map.resolution=10 cm")
    without_report = lambda files: {name: digest for name, digest in files.items() if name != "report.json"}
    new = cli.fresh_folder("killed_new") / "run"
    mapped(new, *coarse)
    new_files = without_report(digests(new))
    folder, old = old_run("killed_at_a_rename")
    for number in range(1, 1000):
        process = command("map", LOG, "-o", folder, "--force", "-q", *coarse, env=cli.failing_calls("rename", number, "kill-before"))
        if process.returncode == 0:
            break
        expect(process.returncode == -signal.SIGKILL, f"exit {process.returncode}: {process.stderr}")
        expect(digests(folder) == old, f"not the old run after rename {number}")
    expect(number >= len(OUTPUTS), f"only {number} renames were seen")
    expect(without_report(digests(folder)) == new_files, "not the new run")
    expect([path.name for path in folder.parent.iterdir()] == ["run"], f"{list(folder.parent.iterdir())}")


def foreign_files_are_kept():
    """A file that no run wrote: exit 2 and nothing is touched, before the log is mapped; --force removes it. A folder stays with
    --force too."""
    for name in ("map.yaml", "report.json", "merge.json", "notes.txt"):
        folder = cli.fresh_folder("foreign_files") / "run"
        folder.mkdir()
        (folder / name).write_text("{}")
        before = digests(folder)
        process = command("map", LOG, "-o", folder, "--first", 10)
        expect_exit(process, 2)
        one_error_line(process.stderr)
        expect("exists" in process.stderr and "--force" in process.stderr, process.stderr)
        expect(digests(folder) == before, f"{name}: the folder changed")
        mapped(folder, "--first", 10)
        expect(sorted(digests(folder)) == OUTPUTS, f"{name}: {sorted(digests(folder))}")
        mapped(folder, "--first", 12)
    (folder / "photos").mkdir()
    (folder / "photos/a.jpg").write_text("mine")
    process = command("map", LOG, "-o", folder, "--first", 10, "--force")
    expect_exit(process, 2)
    one_error_line(process.stderr)
    expect("photos that no run wrote" in process.stderr and (folder / "photos/a.jpg").exists(), process.stderr)


def unwritable_output():
    """An output below a regular file: exit 74. A table whose name a folder has: exit 2 before the work. Nothing is lost."""
    folder, before = old_run("unwritable_output")
    process = command("map", LOG, "-o", folder / "map.pgm" / "below", "-q")
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect(digests(folder) == before, "the folder changed")
    process = command("ablation", LOG, "--relations", DATA / "drive.relations", "-o", folder, "--first", 12, "--variant",
                      "merge.kappa=1", "-q")
    expect_exit(process, 2)
    one_error_line(process.stderr)
    expect("is a folder" in process.stderr, process.stderr)
    expect(digests(folder) == before, "the folder changed")


def default_folder_and_latest():
    """Without -o: runs/<log>-<UTC time>, and runs/latest points to it."""
    folder = cli.fresh_folder("default_folder")
    (folder / "drive.log").symlink_to(LOG)
    for _ in range(2):
        expect_exit(command("map", "drive.log", "--first", 10, "-q", cwd=folder), 0)
    runs = sorted(path.name for path in (folder / "runs").iterdir())
    expect(len(runs) == 3 and runs[2] == "latest", f"runs holds {runs}")
    expect(all(re.fullmatch(r"drive-\d{8}T\d{6}Z(-2)?", name) for name in runs[:2]), f"runs holds {runs}")
    expect(os.readlink(folder / "runs/latest") == runs[1], "latest does not point to the last run")
    expect(sorted(digests(folder / "runs" / runs[1])) == OUTPUTS, "the folder is not complete")
