"""Tests of tools/scripts/benchmarks.py with a stand-in for gdtslam."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "tools/scripts/benchmarks.py"
sys.path.insert(0, str(SCRIPT.parent))
import benchmarks  # noqa: E402  (its folder is no package)

ROW = {"run_name": "cpu/scan/scan/10 points/process_time", "real_time": 2500.0, "cpu_time": 12.34, "time_unit": "ms", "label": "candidate",
       "items_per_second": 2e9}
ANSWER = {"context": {"cpu": "a CPU, avx2"}, "benchmarks": [
    ROW, {**ROW, "aggregate_name": "mean", "cpu_time": 99.0}, {**ROW, "aggregate_name": "median"}]}
PAGE = "# Page\n\nBefore.\n\n<!-- made: kernels -->\nold\n<!-- made -->\n\nBehind.\n"


class Benchmarks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.page = self.folder / "page.md"
        self.page.write_text(PAGE)
        self.program = self.folder / "gdtslam"
        self.answer(f"cat <<'END'\n{json.dumps(ANSWER)}\nEND")

    def answer(self, what):
        for program in (self.program, self.folder / "gdtslam-lab"):
            program.write_text(f"#!/bin/sh\nif [ \"$1\" = --version ]; then echo gdtslam 9; exit; fi\n{what}\n")
            program.chmod(0o755)

    def make(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, "--program", self.program, "--page", self.page, *arguments],
                              capture_output=True, text=True, check=False)

    def test_the_table_takes_the_place_of_the_old_one(self):
        process = self.make("kernels", "--write")
        self.assertEqual((process.returncode, process.stderr), (0, ""))
        before, made, behind = self.page.read_text().replace("<!-- made -->\n", "<!-- made: kernels -->\n").split("<!-- made: kernels -->\n")
        self.assertEqual((before, behind), ("# Page\n\nBefore.\n\n", "\nBehind.\n"))
        self.assertIn("| `scan` | 10 points | 12.3 ms | 2 G candidates/s |  |\n", made)
        self.assertNotIn("old", made)
        self.assertIn("gdtslam 9, a CPU, avx2", made)

    def test_what_fails_is_told_and_nothing_is_written(self):
        self.answer("echo 'gdtslam: error: no memory' >&2; exit 69")
        process = self.make("kernels", "--write")
        self.assertEqual(process.returncode, 1)
        self.assertIn("exit 69: gdtslam: error: no memory", process.stderr)
        self.assertEqual(self.page.read_text(), PAGE)

    def test_every_table_has_its_place_in_the_page(self):
        for name in benchmarks.Benchmarks("", pathlib.Path(), pathlib.Path()).names():
            text = benchmarks.PAGES.get(name, benchmarks.PAGE).read_text()
            self.assertIn("| a |", benchmarks.with_table(text, name, "| a |"))
        marks = benchmarks.re.findall(r"<!-- made: (\S+) -->", benchmarks.PAGE.read_text())
        names = set(benchmarks.Benchmarks("", pathlib.Path(), pathlib.Path()).names()) - {"results"}
        self.assertEqual(sorted(marks), sorted(names))

    def test_shares_of_limits(self):
        """Of the copy next in size, of the most loads a second, of no limit for a scan."""
        def row(name, unit, cpu_us, rate, **counters):
            return benchmarks.Row({"run_name": name, "real_time": 0.0, "cpu_time": cpu_us, "time_unit": "us", "label": unit,
                                   "items_per_second": rate, **counters})
        limits = [row("cpu/limit/copy/small", "byte", 1.0, 2e9), row("cpu/limit/copy/large", "byte", 1000.0, 1e9),
                  row("cpu/limit/load/a", "load", 1.0, 4e9), row("cpu/limit/gather/a", "load", 1.0, 5e9),
                  row("vulkan:0/limit/copy/large", "byte", 10.0, 1e11)]
        share = benchmarks.share_of_limit
        self.assertEqual(share(row("cpu/kernel/a/b", "cell", 4000.0, 1e6, bytes=2e6), limits), "copy 0.50")
        self.assertEqual(share(row("cpu/kernel/a/b", "cell", 4.0, 1e6, bytes=2e3), limits), "copy 0.25")
        self.assertEqual(share(row("cpu/kernel/a/b", "look-up", 4.0, 1e9), limits), "load 0.20")
        self.assertEqual(share(row("cpu/scan/a/b", "candidate", 4.0, 1e9), limits), "")


if __name__ == "__main__":
    unittest.main()
