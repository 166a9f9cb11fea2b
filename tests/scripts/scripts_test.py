"""Tests of tools/*.sh and tools/scripts. Programs that they call are replaced by small ones in a folder of their own."""

import os
import pathlib
import re
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
            files[-1].write_bytes(text if isinstance(text, bytes) else text.encode())
        return self.run_script(sys.executable, ROOT / "tools/scripts/count_tests.py", *files)

    def test_a_test_that_ctest_could_not_run_is_failed(self):
        done = self.count(CTEST_REPORT)
        self.assertEqual(done.stdout, "1 3 3\n")
        self.assertIn("failed: lost  Unable to find executable", done.stderr)
        self.assertIn("skipped: no_data  no real logs", done.stderr)

    def test_reports_add_up(self):
        self.assertEqual(self.count(CTEST_REPORT, GTEST_REPORT).stdout, "2 4 4\n")

    def test_bytes_that_are_no_text_do_not_hide_a_failure(self):
        report = b'<testsuite><testcase classname="b" name="a" result="completed"><failure>\xff\x01</failure></testcase></testsuite>'
        self.assertEqual(self.count(report).stdout, "0 1 0\n")

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

    def test_failure_to_install_is_told(self):
        self.stand_in("apt-get", "echo E: no network >&2; exit 100")
        done = self.install("build")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no network", done.stderr)

    def test_neither_root_nor_sudo(self):
        self.stand_in("id", "echo 1000")
        done = self.install("build", only_stand_ins=True)
        self.assertEqual(done.returncode, 69)
        self.assertIn("apt-get install --no-install-recommends cmake libfmt-dev", done.stderr)


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


DEVICES = """{ "devices": [],
  "vulkan": { "devices": [
      {
        "device": "vulkan:0",
        "name": "A GPU (fast, new)",
        "kind": "discrete",
        "problem": null
      }
  ] } }"""
SOFTWARE = DEVICES.replace("A GPU (fast, new)", "llvmpipe").replace("discrete", "lavapipe")

REPORT = """{
  "device": {
    "name": "NAME",
    "kind": "discrete"
  },
  "scans": 350,
  "wall_s": SECONDS,
  "cpu_s": 1.5,
  "dispatches": 4080,
  "submissions": 466,
  "map_sha256": "MAP",
  "trajectory_sha256": "abcdef0123456789",
  "stages": {
    "match": 0.5
  }
}"""


class GpuServer(ScriptTest):
    """gpu_server.sh with a gdtslam that computes nothing: what it shows, and that no fault passes."""

    def setUp(self):
        super().setUp()
        (self.work / "assets/logs").mkdir(parents=True)
        (self.work / "assets/logs/office.log.gz").touch()
        for name, text in (("devices", DEVICES), ("report", REPORT)):
            (self.work / name).write_text(text)
        self.gdtslam()

    def gdtslam(self, verify="echo PASS: 0 differences", map_of_gpu="123456789abcdef0"):
        """A gdtslam whose second and later runs of a log are slower than the first."""
        self.stand_in("gdtslam", f'''case "$1 $*" in
          doctor*--json) cat {self.work}/devices ;;
          doctor*) echo "vulkan:0   A GPU (fast, new)" ;;
          verify*) {verify} ;;
          map*)
            while [[ $1 != -o ]]; do shift; done
            echo run >>{self.work}/runs; mkdir "$2"
            name=CPU map=123456789abcdef0
            if [[ $* == *"--device vulkan"* ]]; then name="A GPU (fast, new)" map={map_of_gpu}; fi
            sed "s/NAME/$name/; s/MAP/$map/; s/SECONDS/$(wc -l <{self.work}/runs).25/" {self.work}/report >"$2/report.json" ;;
          --version*) echo gdtslam 1.2.3 ;;
          *) exit 2 ;; esac''')

    def prove(self, *arguments):
        environment = {"PATH": os.environ["PATH"], "GDTSLAM": str(self.programs / "gdtslam"),
                       "GDTSLAM_ASSETS": str(self.work / "assets")}
        done = subprocess.run(["/bin/sh", str(ROOT / "tools/scripts/gpu_server.sh"), "--output", str(self.work / "out"),
                               *arguments], env=environment, capture_output=True, text=True, check=False)
        page = self.work / "out/report.md"
        return done, page.read_text() if page.exists() else ""

    def test_everything_equal(self):
        done, page = self.prove()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(page.splitlines()[0], "# gdtslam 1.2.3 on A GPU (fast, new)")
        self.assertIn("Everything is equal", page)
        # The fastest of three runs each: of the default the first, the fourth and the seventh.
        for matcher, before in (("gauss-newton", 0), ("exhaustive", 9)):
            for device, run in (("cpu, 1 thread: CPU", 1), ("cpu, all threads: CPU", 4), ("vulkan: A GPU (fast, new)", 7)):
                self.assertIn(f"| office.log | {matcher} | {device} | 350 | {before + run}.250 | 0.500 | 1.500 | 4080 | 466 |"
                              " 123456789abc | abcdef012345 |", page)
        self.assertFalse((self.work / "out/runs").exists())

    def test_another_map_on_the_gpu_fails(self):
        self.gdtslam(map_of_gpu="023456789abcdef0")
        done, page = self.prove("--repeat", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("**FAILED**: office.log.gz, gauss-newton: the map or the trajectory is not the same", page)
        self.assertNotIn("Everything is equal", page)

    def test_a_difference_in_verify_fails(self):
        self.gdtslam(verify="echo 'FAIL: 3 differences'; echo 'gdtslam: error: vulkan:0: 3 differences' >&2; exit 1")
        done, page = self.prove("--repeat", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("**FAILED**: verify ended with status 1: gdtslam: error: vulkan:0: 3 differences", page)
        self.assertIn("\nFAIL: 3 differences\n", page)

    def test_a_processor_that_plays_a_gpu_is_no_proof(self):
        (self.work / "devices").write_text(SOFTWARE)
        for arguments in ([], ["--device", "vulkan"]):
            done, _ = self.prove(*arguments)
            self.assertEqual(done.returncode, 69)
            self.assertIn("there is no hardware GPU here that can be used", done.stderr)
            self.assertFalse((self.work / "out").exists())
        done, page = self.prove("--device", "vulkan:0", "--repeat", "1")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(done.stdout.splitlines()[0],
                         "NO GPU: vulkan:0 is no hardware (lavapipe); what follows says nothing of a GPU")
        self.assertTrue(page.splitlines()[0].endswith(", no hardware GPU (lavapipe)"), page.splitlines()[0])


class Variables(unittest.TestCase):
    """What changes the behaviour from the environment can be looked up."""

    def test_each_that_is_read_is_documented(self):
        text = (ROOT / "docs/testing.md").read_text()
        named = set()
        for folder in ("engine", "tools", "tests"):
            for file in (ROOT / folder).rglob("*.[ch]pp"):
                source = file.read_text()
                if any(part.exists() and "getenv" in part.read_text() for part in (file, file.with_suffix(".cpp"))):
                    named.update(re.findall(r'"(GDTSLAM_[A-Z_]+)"', source))
        for file in [*(ROOT / "tools").glob("*.sh"), *(ROOT / "tools/scripts").rglob("*.sh"), *(ROOT / "tools/scripts").rglob("*.py")]:
            found = re.findall(r'\$\{?(GDTSLAM_[A-Z_]+)|environ(?:\.get\(|\[)"(GDTSLAM_[A-Z_]+)"', file.read_text())
            named.update(shell or python for shell, python in found)
        self.assertLessEqual({"GDTSLAM_VULKAN_WAIT_S", "GDTSLAM_JOBS", "GDTSLAM_FUZZ_S"}, named)
        self.assertEqual([name for name in sorted(named) if not re.search(f"`{name}[`=]", text)], [], "not in docs/testing.md")


class FuzzTargets(unittest.TestCase):
    """A target that is in no list is never run, and one that no test replays is run by those alone who fuzz."""

    def test_each_is_run_replayed_and_has_a_corpus(self):
        main = (ROOT / "tests/fuzz/fuzzer_main.cpp").read_text()
        replays = "".join(file.read_text() for file in (ROOT / "tests/unit").rglob("fuzz_corpus_test.cpp"))
        names = []
        for file in (ROOT / "tests/fuzz").glob("*_targets.hpp"):
            text = file.read_text()
            for group in re.findall(r"std::array (k\w+Targets)\{", text):
                self.assertIn(f"({group})", main)
                self.assertIn(f"ValuesIn({group})", replays)
            names += re.findall(r'FuzzTarget\{"(\w+)"', text)
        self.assertGreater(len(names), 20)
        self.assertEqual(sorted(names), sorted(folder.name for folder in (ROOT / "tests/fuzz/corpus").iterdir()))


if __name__ == "__main__":
    unittest.main()
