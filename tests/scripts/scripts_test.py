"""Tests of tools/*.sh and tools/scripts. Programs that they call are replaced by small ones in a folder of their own."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

CTEST_REPORT = """<testsuite name="x">
<testcase name="good" classname="good" status="run"/>
<testcase name="bad" classname="bad" status="fail"><failure message=""/></testcase>
<testcase name="lost" classname="lost" status="notrun"><skipped message="Unable to find executable"/></testcase>
<testcase name="after" classname="after" status="notrun"><skipped message="Fixture dependency failed"/></testcase>
<testcase name="no_data" classname="no_data" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
<system-out>x.cpp:4: Skipped
no real logs
[  SKIPPED ] no_data</system-out></testcase>
<testcase name="code" classname="code" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>
<testcase name="off" classname="off" status="disabled"/>
</testsuite>"""

GTEST_REPORT = """<testsuites><testsuite name="A">
<testcase name="good" status="run" result="completed" classname="A"/>
<testcase name="bad" status="run" result="completed" classname="A"><failure message="x"/></testcase>
<testcase name="skip" status="run" result="skipped" classname="A"><skipped message="no data"/></testcase>
</testsuite></testsuites>"""


class ScriptTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.programs = self.work / "programs"
        self.programs.mkdir()

    def stand_in(self, name, script):
        """A program of that name which comes first in PATH."""
        path = self.programs / name
        path.write_text("#!/bin/bash\n" + script + "\n")
        path.chmod(0o755)

    def run_script(self, *command, only_stand_ins=False):
        path = str(self.programs) if only_stand_ins else f"{self.programs}:{os.environ['PATH']}"
        return subprocess.run([str(c) for c in command], env={"PATH": path, "HOME": str(self.work)},
                              capture_output=True, text=True, check=False)


class CountTests(ScriptTest):
    def count(self, *texts):
        files = []
        for text in texts:
            files.append(self.work / f"{len(files)}.xml")
            files[-1].write_text(text)
        return self.run_script(sys.executable, ROOT / "tools/scripts/count_tests.py", *files)

    def test_a_test_that_ctest_could_not_run_is_failed(self):
        done = self.count(CTEST_REPORT)
        self.assertEqual(done.stdout, "1 3 3\n")
        self.assertIn("failed: lost  Unable to find executable", done.stderr)
        self.assertIn("skipped: no_data  no real logs", done.stderr)

    def test_reports_add_up(self):
        self.assertEqual(self.count(CTEST_REPORT, GTEST_REPORT).stdout, "2 4 4\n")

    def test_a_report_cut_off_is_an_error(self):
        self.assertNotEqual(self.count(CTEST_REPORT[:200]).returncode, 0)


class InstallPackages(ScriptTest):
    """The packages cmake and libfmt-dev are missing; apt-get writes down how it was called and installs them."""

    def setUp(self):
        super().setUp()
        self.calls = self.work / "calls"
        self.stand_in("dpkg-query", f'''case "${{@: -1}}" in
          cmake | libfmt-dev) [[ -f {self.work}/installed ]] && echo installed || {{ echo not-installed; exit 1; }} ;;
          *) echo installed ;; esac''')
        self.stand_in("apt-get", f'echo "apt-get $*" >>{self.calls}; [[ $* == *install* ]] && touch {self.work}/installed')
        self.stand_in("id", "echo 0")

    def install(self, *arguments, **options):
        return self.run_script("/bin/bash", ROOT / "tools/install-packages.sh", *arguments, **options)

    def test_only_what_is_missing_is_installed(self):
        done = self.install("build")
        self.assertEqual(done.returncode, 0, done.stderr)
        calls = self.calls.read_text().splitlines()
        self.assertEqual(len(calls), 1)
        self.assertTrue(calls[0].endswith("install -y --no-install-recommends cmake libfmt-dev"), calls[0])

    def test_nothing_is_called_when_all_are_there(self):
        (self.work / "installed").touch()
        done = self.install("all")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(self.calls.exists())

    def test_stale_package_lists_are_renewed(self):
        self.stand_in("apt-get", f'''echo "apt-get $*" >>{self.calls}
          if [[ $* == *update* ]]; then touch {self.work}/fresh; exit 0; fi
          [[ -f {self.work}/fresh ]] && touch {self.work}/installed''')
        done = self.install("build")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.calls.read_text().splitlines()), 3)

    def test_failure_to_install_is_told(self):
        self.stand_in("apt-get", "echo E: no network >&2; exit 100")
        done = self.install("build")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no network", done.stderr)

    def test_sudo_is_used_by_an_ordinary_user(self):
        self.stand_in("id", "echo 1000")
        self.stand_in("sudo", f'echo sudo >>{self.calls}; exec "$@"')
        self.assertEqual(self.install("build").returncode, 0)
        self.assertEqual(self.calls.read_text().splitlines()[0], "sudo")

    def test_neither_root_nor_sudo(self):
        self.stand_in("id", "echo 1000")
        done = self.install("build", only_stand_ins=True)
        self.assertEqual(done.returncode, 69)
        self.assertIn("apt-get install --no-install-recommends cmake libfmt-dev", done.stderr)

    def test_another_system(self):
        (self.programs / "dpkg-query").unlink()
        done = self.install("build", only_stand_ins=True)
        self.assertEqual(done.returncode, 69)
        self.assertIn("no Debian system", done.stderr)

    def listed(self, group):
        done = self.install(group, "--list")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(self.calls.exists())
        return [line.split()[0] for line in done.stdout.splitlines()]

    def test_what_is_needed_to_build_has_no_driver(self):
        drivers = set(self.listed("vulkan"))
        self.assertIn("mesa-vulkan-drivers", drivers)
        self.assertFalse(drivers & set(self.listed("build")))
        self.assertLess(drivers, set(self.listed("test")))

    def test_all_is_every_group_and_nothing_twice(self):
        everything = self.listed("all")
        self.assertEqual(len(everything), len(set(everything)))
        self.assertEqual(set(everything), set(self.listed("build")) | set(self.listed("test")))

    def test_wrong_argument(self):
        self.assertEqual(self.install("everything").returncode, 2)


class RunAndTest(ScriptTest):
    """run.sh and test.sh in a copy of tools/, where no package is missing and the build breaks."""

    def setUp(self):
        super().setUp()
        shutil.copytree(ROOT / "tools", self.work / "tree/tools", ignore=shutil.ignore_patterns("src", "__pycache__"))
        self.stand_in("dpkg-query", "echo installed")
        self.stand_in("cmake", "echo this build is broken; exit 1")

    def test_test_sh_counts_a_run_that_breaks_off_as_failed(self):
        done = self.run_script(self.work / "tree/tools/test.sh")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout.splitlines()[-1], "0 passed, 1 failed, 0 skipped")
        self.assertIn("this build is broken", done.stdout)

    def test_run_sh_says_where_it_failed(self):
        done = self.run_script(self.work / "tree/tools/run.sh")
        self.assertEqual(done.returncode, 1)
        self.assertIn("failed in step 2, Build", done.stderr)
        self.assertNotIn("Done.", done.stdout)

    def test_a_build_tree_of_another_place_is_begun_anew(self):
        cache = self.work / "tree/build/release/CMakeCache.txt"
        cache.parent.mkdir(parents=True)
        cache.write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere\nCMAKE_GENERATOR:INTERNAL=Ninja\n")
        done = self.run_script(self.work / "tree/tools/run.sh")
        self.assertIn("starting it anew", done.stdout)
        self.assertFalse(cache.exists())

    def test_wrong_arguments(self):
        for script in ("run.sh", "test.sh"):
            self.assertEqual(self.run_script(self.work / "tree/tools" / script, "--fast").returncode, 2, script)
            self.assertEqual(self.run_script(self.work / "tree/tools" / script, "--help").returncode, 0, script)


if __name__ == "__main__":
    unittest.main()
