"""What mutants.py changes in a line, and that a program linked with a mutant runs it. Called with the build folder."""

import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/scripts"))
import mutant_build  # noqa: E402
import mutant_changes  # noqa: E402
import mutant_tests  # noqa: E402

BUILD = pathlib.Path(sys.argv.pop())
SOURCE = pathlib.Path("calib/linkage/four_bar.cpp")
LINE = "  loop.rocker = ((along - length) * ahead + across * left) / bars.rocker_m;"


def changed(line, kind):
    return [mutant.new.strip() for mutant in mutant_changes.mutants_of_line("a.cpp", 1, line, (kind,))]


class Changes(unittest.TestCase):
    def test_each_kind_changes_what_it_says(self):
        for kind, line, expected in (
                ("comparison", "  if (a < b) {", ["if (a <= b) {"]),
                ("sign", "  x += y - z;", ["x -= y - z;", "x += y + z;"]),
                ("sign of an angle", "  f(pose.theta_rad, 2);", ["f(-pose.theta_rad, 2);"]),
                ("one off", "  f(9);", ["f(10);"]),
                ("bound", "  constexpr double k = 1.5;", ["constexpr double k = 3.0;", "constexpr double k = 0.75;"]),
                ("logic", "  return a && b;", ["return a || b;"]),
                ("extremum", "  return std::min(a, b);", ["return std::max(a, b);"]),
                ("condition", "  if (a && b) {", ["if (!(a && b)) {"]),
                ("dropped call", "  folder.sync();", [";"]),
                ("dropped call", "  chosen.reserve(indices.size());", []),
                ("dropped sync", "  if (::fsync(file) != 0) fail();", ["if (0 != 0) fail();"]),
                ("dropped lock", "  const std::lock_guard lock(mutex_);", [";"]),
                ("dropped lock", "  return ::flock(file, LOCK_EX) == 0;", ["return 0 == 0;"])):
            self.assertEqual(changed(line, kind), expected, kind)

    def test_texts_comments_and_types_stay(self):
        for line in ('  fail("a < b, 3 - 2");  // 1.5 < 2', "#include <a>", "  void f(double theta_rad);"):
            self.assertEqual([new for kind in mutant_changes.KINDS if kind != "dropped call" for new in changed(line, kind)], [])


class Links(unittest.TestCase):
    def test_a_program_runs_the_mutant_and_without_a_change_the_source(self):
        line = (ROOT / SOURCE).read_text().splitlines().index(LINE) + 1
        place = LINE.index(" + across") + 1
        tree = mutant_build.Tree(BUILD)
        failures = []
        for text in ("+", "-"):
            mutant = mutant_changes.Mutant(SOURCE, line, "sign", place, place + 1, text, LINE)
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                objects = tree.compile(mutant, folder)
                self.assertIsNotNone(objects)
                program = tree.link("gdtslam_unit_calib_tests", objects, folder / "tests")
                self.assertIsNotNone(program)
                failures.append(mutant_tests.Program(tree, "gdtslam_unit_calib_tests", 9).failure(program, folder / "work", "FourBar.*"))
        self.assertIsNone(failures[0])
        self.assertIn("FourBar.", failures[1])

    def test_what_other_sources_of_an_object_take_from_libraries_stays(self):
        source = pathlib.Path("engine/io/tables/row_records.cpp")
        first = (ROOT / source).read_text().splitlines()[0]
        unchanged = mutant_changes.Mutant(source, 1, "sign", 0, 1, first[0], first)
        tree = mutant_build.Tree(BUILD)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            program = tree.link("gdtslam_property_io_tests", tree.compile(unchanged, folder), folder / "tests")
            tests = mutant_tests.Program(tree, "gdtslam_property_io_tests", 9)  # sums of OpenSSL, by another source
            self.assertIsNone(tests.failure(program, folder / "work", "CloudLaws.*"))

    def test_the_command_passes_its_tests_without_a_change(self):
        tree = mutant_build.Tree(BUILD)
        tests = mutant_tests.CommandTests(tree)
        only_the_fixture = "^$"
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            program = mutant_tests.placed_program(tree, {}, folder, ("calibrate",))
            self.assertIsNone(tests.failure(program, folder / "cli", only_the_fixture))
            self.assertEqual(tests.failure("/bin/false", folder / "other", only_the_fixture), "cli.fixture")


if __name__ == "__main__":
    unittest.main()
