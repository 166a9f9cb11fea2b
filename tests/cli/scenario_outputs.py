"""What a command writes replaces nothing that it reads."""

import cli_support as cli
from cli_support import command, digests, expect, expect_exit, mapped, one_error_line


def refused(folder, words, *arguments, code=2):
    """Ends so, with one line that has the words, and leaves all files in the folder as they are."""
    before = digests(folder)
    process = command(*arguments)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(words in process.stderr, process.stderr)
    expect(digests(folder) == before, f"{arguments} changed {[name for name in before if digests(folder).get(name) != before[name]]}")


def logs_of_a_run_are_not_mapped_into_it():
    """The copy of its log that a run keeps is not mapped, nor followed live, into that run, by whatever name it is called."""
    folder = cli.fresh_folder("logs_of_a_run")
    run, link, elsewhere = folder / "run", folder / "link", folder / "elsewhere"
    mapped(run)
    link.symlink_to(run / "log-1.copy")
    (folder / "to_run").symlink_to(run)
    words = "is a file of the run folder that would be written; map it again with gdtslam map --continue"
    for log in (run / "log-1.copy", folder / "elsewhere" / ".." / "run" / "log-1.copy", link):
        for more in (("--first", 10), ("--no-copy",), ("--force",)):
            refused(folder, words, "map", log, "-o", folder / "to_run", "-q", *more)
    for more in ((run / "log-1.copy",), ("--follow", run / "log-1.copy"), (run / "log-1.copy", "--no-copy")):
        refused(folder, words, "live", "-o", run, "-q", *more)
    expect_exit(command("map", run / "log-1.copy", "-o", elsewhere, "--first", 10, "-q"), 0)
    expect_exit(command("map", run / "log-1.copy", "-o", elsewhere, "--first", 12, "-q"), 0)
    copy = (run / "log-1.copy").read_bytes()
    expect_exit(command("map", "--continue", run, "-q"), 0)
    expect((run / "log-1.copy").read_bytes() == copy, "another copy after --continue")
    expect_exit(command("map", "--continue", run, run / "log-1.copy", "-q"), 0)
    expect((run / "log-1.copy").read_bytes() == copy and (run / "log-2.copy").exists(), "the copies of a log that came twice")
