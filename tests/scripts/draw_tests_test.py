#!/usr/bin/env python3
"""Tests of tools/scripts/draw_tests.py, with a tree of tests that do nothing, as ctest reads it."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class DrawTests(unittest.TestCase):
    """Long tests have their turn one after another, and short ones always."""

    def setUp(self):
        self.tree = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.tree)
        self.names = [f"long.{index}" for index in range(10)]
        lines = ["add_test(short true)", "add_test(longer.5 true)"]
        for name in self.names:
            lines += [f"add_test({name} true)", f'set_tests_properties({name} PROPERTIES LABELS "cli;long")']
        (self.tree / "CTestTestfile.cmake").write_text("\n".join(lines))

    def draw(self, *arguments):
        return subprocess.run([sys.executable, ROOT / "tools/scripts/draw_tests.py", self.tree, *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)

    def run_by_ctest(self, expression):
        without = ["--exclude-regex", expression] if expression else []
        shown = subprocess.run(["ctest", "--test-dir", self.tree, "-N", *without], stdout=subprocess.PIPE, text=True, check=True)
        return re.findall(r"Test +#\d+: (\S+)", shown.stdout)

    def test_each_has_its_turn_once_in_as_many_commits(self):
        turns = []
        for revision in ("00000000", "00000001", "00000002aa"):
            ran = self.run_by_ctest(self.draw("--share", "3", "--revision", revision).stdout.strip())
            self.assertLessEqual({"short", "longer.5"}, set(ran))
            turns += [name for name in ran if name.startswith("long.")]
            self.assertIn(len(ran) - 2, (3, 4))
        self.assertEqual(sorted(turns), self.names)

    def test_all_of_them(self):
        drawn = self.draw("--share", "1", "--revision", "0123abcd")
        self.assertEqual((drawn.returncode, drawn.stdout), (0, ""))

    def test_wrong_arguments_and_a_tree_without_long_tests(self):
        self.assertEqual(self.draw("--share", "0", "--revision", "00000000").returncode, 2)
        self.assertEqual(self.draw("--share", "3", "--revision", "HEAD").returncode, 2)
        (self.tree / "CTestTestfile.cmake").write_text("add_test(short true)")
        self.assertEqual(self.draw("--share", "3", "--revision", "00000000").returncode, 2)

    def test_those_of_googletest_that_are_named_long_are_there(self):
        names = re.findall(r"\b([A-Z]\w+)\.(\w+)", (ROOT / "tests/long_tests.cmake").read_text().partition("foreach(")[2])
        sources = "".join(path.read_text() for path in (ROOT / "tests/unit").rglob("*.cpp"))
        missing = [f"{suite}.{name}" for suite, name in names if not re.search(rf"^TEST(_F)?\({suite},\s+{name}\)", sources, re.MULTILINE)]
        self.assertTrue(names)
        self.assertEqual(missing, [])


if __name__ == "__main__":
    unittest.main()
