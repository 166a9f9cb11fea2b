"""Tests of tools/scripts/doc_outputs.py on small pages, with a stand-in for gdtslam."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Makes the files that tools/run.sh would, adds up, takes time, and refuses.
STAND_IN = """#!/bin/bash
while (($#)); do
  case $1 in
    simulate) echo "log of $2" >"$4"; exit ;;
    map) if [[ $3 == -o ]]; then mkdir -p "$4" && cp "$2" "$4/cloud.ply"; fi; echo "mapped $2"; exit ;;
    count) shift; wc -l <"$1"; exit ;;
    figures) printf '%s\\n' 'first 1' 'points 12,345 in all' 'took 3 scans/s' 'last 4.50'; exit ;;
    refuse) echo 'gdtslam: error: no such thing' >&2; exit 2 ;;
    *) exit 3 ;;
  esac
done
"""

FIGURES = "first 1\npoints 12,345 in all\ntook 3 scans/s\nlast 4.50"


def console(command, *shown):
    return "\n".join(["```console", f"$ gdtslam {command}", *shown, "```", ""])


class DocOutputs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "tools/scripts").mkdir(parents=True)
        (self.root / "docs").mkdir()
        for name in ("tools/run.sh", "tools/scripts/doc_outputs.py"):
            shutil.copy(ROOT / name, self.root / name)
        self.program = self.root / "stand_in"
        self.program.write_text(STAND_IN)
        self.program.chmod(0o755)
        self.page = self.root / "README.md"

    def run_on(self, text, *options, data="none"):
        self.page.write_text(text)
        return subprocess.run([sys.executable, self.root / "tools/scripts/doc_outputs.py", "--program", self.program,
                               *(options or ("--check",))], capture_output=True, text=True, check=False,
                              env={**os.environ, "GDTSLAM_DATA": str(self.root / data)})

    def passes(self, text, *options, **data):
        done = self.run_on(text, *options, **data)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def fails(self, text, says):
        done = self.run_on(text)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(says, done.stdout + done.stderr)

    def test_a_page_that_shows_what_is_printed(self):
        self.assertIn("1 blocks run, 0 left out, 0 differ", self.passes(console("figures", FIGURES)))

    def test_a_wrong_number_a_missing_line_and_one_too_many(self):
        self.fails(console("figures", FIGURES.replace("12,345", "12,346")), "README.md:1: the output is not what")
        self.fails(console("figures", FIGURES.replace("last 4.50", "")), "+last 4.50")
        self.fails(console("figures", FIGURES + "\nmore"), "-more")

    def test_dots_stand_for_any_number_of_lines(self):
        for shown in (("first 1", "..."), ("...", "last 4.50"), ("first 1", "...", "last 4.50"), ("...",),
                      ("first 1", "...", FIGURES[8:])):
            self.passes(console("figures", *shown))
        for shown in (("...", "first 2", "..."), ("points 12,345 in all", "..."), ("...", "points 12,345 in all"),
                      ("...", "last 4.50", "...", "first 1", "...")):
            self.fails(console("figures", *shown), "differ")

    def test_rates_are_not_compared(self):
        self.passes(console("figures", FIGURES.replace("3 scans/s", "9,999 scans/s")))

    def test_exit_codes(self):
        self.passes(console("refuse", "gdtslam: error: no such thing"))
        self.fails(console("refuse"), "exit code 2")
        self.fails(console("refuse", "something else"), "exit code 2")
        self.fails(console("figures", "gdtslam: error: no such thing"), "exit code 0")
        self.fails("```sh\ngdtslam figures  # fine\ngdtslam unknown\ngdtslam figures\n```\n", "failed: gdtslam unknown")

    def test_the_blocks_of_a_page_share_a_folder_with_the_runs(self):
        self.passes("```sh\ngdtslam map my.log -o mine\n\ngdtslam figures \\\n  >four.txt\n```\n" +
                    console("count four.txt", "4") + console("count mine/cloud.ply", "1") +
                    console("count runs/office-7f/cloud.ply", "1"))

    def test_pages_of_docs_are_read_and_share_nothing(self):
        (self.root / "docs/page.md").write_text(console("count four.txt", "4"))
        self.fails("```sh\ngdtslam figures >four.txt\n```\n", "docs/page.md:1: exit code 1")

    def test_blocks_that_are_left_out_are_named(self):
        text = ("<!-- not run: needs a robot -->\n" + console("unknown") + "<!-- slow: an hour -->\n" + console("refuse") +
                console("count intel.clf.gz", "1"))
        out = self.passes(text)
        self.assertIn("left out (1), not run: needs a robot: README.md:2", out)
        self.assertIn("left out (1), slow: run with --all: README.md:6", out)
        self.assertIn("left out (1), no public logs: set GDTSLAM_DATA: README.md:9", out)
        self.assertEqual(self.run_on(text, "--check", "--all").returncode, 1)
        (self.root / "logs/slam2d").mkdir(parents=True)
        (self.root / "logs/slam2d/intel.clf.gz").write_text("one line\n")
        self.assertIn("1 blocks run, 2 left out", self.passes(text, data="logs"))

    def test_write_makes_the_page_true_and_leaves_true_blocks_alone(self):
        kept = console("figures", FIGURES.replace("3 scans/s", "9 scans/s"))
        self.passes(kept + "Words.\n" + console("figures", "nothing", "of this"), "--write")
        self.assertEqual(self.page.read_text(), kept + "Words.\n" + console("figures", FIGURES))
        done = self.run_on(console("figures", "...", "gone 1", "..."), "--write")
        self.assertEqual(done.returncode, 1, "lines that are left out need somebody who edits the page")


if __name__ == "__main__":
    unittest.main()
