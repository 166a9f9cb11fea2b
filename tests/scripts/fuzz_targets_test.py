"""Tests of tools/scripts/fuzz_targets.py with a small program in the place of the fuzz program: it prints what libFuzzer
prints, executes as many a second as the name of its target says, and stands still for no time."""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Writes down how it was called. A target `t_N` executes N times in a second; one with a file `broken` in its corpus fails.
PROGRAM = r'''#!%s
import os, pathlib, re, signal, sys, time
if sys.argv[1] == "targets":
    print(os.environ["TARGETS"].replace(" ", "\n"))
    sys.exit(0)
target, options, folders = sys.argv[1], dict(a[1:].split("=", 1) for a in sys.argv[2:] if a[0] == "-"), [a for a in sys.argv[2:] if a[0] != "-"]
with open(os.environ["CALLS"], "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + f" in {os.environ.get('TMPDIR')}\n")
if "set_cover_merge" in options:
    for folder in folders[1:]:
        for file in pathlib.Path(folder).iterdir():
            if file.name not in os.listdir(folders[0]):
                (pathlib.Path(folders[0]) / file.name).write_bytes(file.read_bytes())
    sys.exit(0)
if any(os.path.isfile(folder) for folder in folders):
    sys.exit(os.path.exists(folders[0] + ".slow"))
inputs = sum(len(os.listdir(folder)) for folder in folders)
def end(executed, seconds=1):
    print(f"#{executed}\tDONE   cov: 12 ft: 34 corp: {inputs}/99b lim: 4 exec/s: 0 rss: 30Mb")
    print(f"Done {executed} runs in {seconds} second(s)\nstat::number_of_executed_units: {executed}", flush=True)
if any(os.path.exists(folder + "/broken") for folder in folders):
    print("#4\tNEW    cov: 5 ft: 6 corp: 1/1b\n#16\tpulse  cov: 5 ft: 6 corp: 1/1b\n==1==ERROR: broken")
    sys.exit(77)
rate = int(target[2:])
if any(os.path.exists(folder + "/waits") for folder in folders):
    name = options["artifact_prefix"] + "timeout-0123abcd"
    open(name, "w").close()
    print(f"#8\tpulse  cov: 5 ft: 6 corp: 1/1b\nartifact_prefix='x'; Test unit written to {name}\nSUMMARY: libFuzzer: timeout")
    sys.exit(70)
if options.get("runs") == "0":
    end(inputs)
elif target == "t_1":  # runs until it is told to end
    signal.signal(signal.SIGINT, lambda *_: (end(21), os._exit(72)))
    open(os.environ["CALLS"] + ".begun", "w").close()
    time.sleep(60)
else:
    executed = min(int(options.get("runs", 10**9)), rate * int(options["max_total_time"]))
    end(executed, -(-executed // rate))
''' % sys.executable


class FuzzTargets(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.calls = self.work / "calls"
        self.program = self.work / "gdtslam_fuzz"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)

    def command(self, targets, arguments):
        for name in targets:
            corpus = self.work / "corpus" / name
            corpus.mkdir(parents=True, exist_ok=True)
            (corpus / "written").write_text("by hand")
        return [sys.executable, "-B", str(ROOT / "tools/scripts/fuzz_targets.py"), "--program", str(self.program), "--corpus",
                str(self.work / "corpus"), "--folder", str(self.work / "build"), "-j", "1", *arguments]

    def environment(self, targets, variables):
        clean = {name: value for name, value in os.environ.items() if not name.startswith("GDTSLAM_")}
        return {**clean, "TARGETS": " ".join(targets), "CALLS": str(self.calls), **variables}

    def fuzz(self, targets, *arguments, **variables):
        return subprocess.run(self.command(targets, arguments), env=self.environment(targets, variables), capture_output=True,
                              text=True, check=False)

    def rows(self, done):
        cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in done.stdout.splitlines()[2:]]
        return {row[0]: row[1:] for row in cells}

    def executed(self, done):
        return {name: int(row[0].replace(",", "")) for name, row in self.rows(done).items()}

    def test_each_target_has_its_seconds_and_a_row(self):
        done = self.fuzz(["t_100", "t_2000"], GDTSLAM_FUZZ_S="3")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.executed(done), {"t_100": 300, "t_2000": 6000, "2 targets": 6300})
        self.assertEqual(self.rows(done)["t_100"][2:5], ["12", "34", "1"])
        for call in self.calls.read_text().splitlines():
            for option in ("-timeout=10", "-rss_limit_mb=512", "-print_funcs=0", "-max_total_time=3"):
                self.assertIn(f" {option} ", call)
        if os.access("/dev/shm", os.W_OK):
            self.assertRegex(self.calls.read_text(), " in /dev/shm/")

    def test_what_breaks_fails_and_the_others_run(self):
        (self.work / "corpus/t_5").mkdir(parents=True)
        (self.work / "corpus/t_5/broken").touch()
        done = self.fuzz(["t_5", "t_7"], GDTSLAM_FUZZ_S="1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("t_5: FAILED; run it again by", done.stderr)
        self.assertIn("==1==ERROR: broken", done.stderr)
        self.assertEqual(self.executed(done), {"t_5": 16, "t_7": 7, "2 targets": 23})

    def test_an_input_that_waited_for_a_processor_is_no_finding(self):
        (self.work / "corpus/t_5").mkdir(parents=True)
        (self.work / "corpus/t_5/waits").touch()
        done = self.fuzz(["t_5"], GDTSLAM_FUZZ_S="1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, "^t_5: an input had to wait for a processor; alone it takes 0[.]")
        self.assertEqual(self.executed(done)["t_5"], 8)
        artifact = self.work / "build/runs/t_5/timeout-0123abcd"
        self.assertFalse(artifact.exists())
        pathlib.Path(f"{artifact}.slow").touch()  # alone it fails too
        done = self.fuzz(["t_5"], GDTSLAM_FUZZ_S="1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("t_5: FAILED", done.stderr)
        self.assertTrue(artifact.exists())

    def test_a_total_is_shared_out_and_goes_on(self):
        targets = ["t_2", "t_3000", "t_4000"]
        done = self.fuzz(targets, GDTSLAM_FUZZ_S="1", GDTSLAM_FUZZ_RUNS="1000000")
        executed = self.executed(done)
        self.assertEqual(executed["3 targets"], 1_000_000)
        self.assertLess(executed["t_2"], 1000)
        self.assertGreater(executed["t_3000"], 100_000)
        self.assertGreater(executed["t_4000"], 100_000)
        self.calls.unlink()
        again = self.fuzz(targets, GDTSLAM_FUZZ_S="1", GDTSLAM_FUZZ_RUNS="1000000")
        self.assertEqual(self.executed(again), executed)
        self.assertFalse(self.calls.exists(), "nothing was left to run")
        more = self.fuzz(targets, GDTSLAM_FUZZ_S="1", GDTSLAM_FUZZ_RUNS="1000005")
        self.assertEqual(self.executed(more)["3 targets"], 1_000_005)
        self.assertIn("-runs=5 ", self.calls.read_text())

    def test_what_is_stopped_is_counted(self):
        targets = ["t_1"]
        process = subprocess.Popen(self.command(targets, ()), env=self.environment(targets, {"GDTSLAM_FUZZ_RUNS": "500"}),
                                   stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        for _ in range(600):
            if pathlib.Path(f"{self.calls}.begun").exists():
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGTERM)
        self.assertIn("| t_1 | 21 |", process.stdout.read())
        self.assertEqual(process.wait(60), 1)
        self.assertEqual(json.loads((self.work / "build/long/executed.json").read_text())["t_1"]["executions"], 21)

    def test_a_new_program_does_not_disturb_a_long_run(self):
        self.fuzz(["t_9"], GDTSLAM_FUZZ_S="1", GDTSLAM_FUZZ_RUNS="9")
        self.assertEqual((self.work / "build/long/gdtslam_fuzz").read_text(), PROGRAM)
        self.assertNotEqual((self.work / "build/long/gdtslam_fuzz").stat().st_ino, self.program.stat().st_ino)

    def test_replay_runs_the_corpora_alone(self):
        done = self.fuzz(["t_9"], "--replay")
        self.assertEqual(self.executed(done), {"t_9": 1, "1 targets": 1})
        self.assertNotIn("found", self.calls.read_text())

    def test_what_was_found_goes_into_the_corpus_as_far_as_there_is_room(self):
        found = self.work / "build/long/t_9/found"
        found.mkdir(parents=True)
        sizes = {"a" * 40: 10, "b" * 40: 40_000, "c" * 40: 30_000}
        for name, size in sizes.items():
            (found / name).write_bytes(bytes(size))
        old = self.work / "corpus/t_9" / ("d" * 40)
        old.parent.mkdir(parents=True)
        old.write_text("shorter than all")
        done = self.fuzz(["t_9"], "--minimise")
        self.assertEqual(done.returncode, 0, done.stderr)
        kept = sorted(file.name for file in (self.work / "corpus/t_9").iterdir())
        self.assertEqual(kept, ["a" * 40, "c" * 40, "d" * 40, "written"])  # 70,000 bytes are too many

    def test_a_corpus_of_no_target_is_an_error(self):
        (self.work / "corpus/gone").mkdir(parents=True)
        self.assertIn("is the corpus of no target", self.fuzz(["t_9"]).stderr)
        (self.work / "corpus/gone").rmdir()
        self.assertIn("no target is called t_8", self.fuzz(["t_9"], "t_8").stderr)


class Targets(unittest.TestCase):
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
        self.assertGreater(len(names), 40)
        folders = [folder.name for folder in (ROOT / "tests/fuzz/corpus").iterdir()]
        self.assertEqual(sorted(names), sorted(folders))

    def test_corpora_stay_small(self):
        files = [file for file in (ROOT / "tests/fuzz/corpus").rglob("*") if file.is_file()]
        self.assertLess(sum(file.stat().st_size for file in files), 3 << 20)


if __name__ == "__main__":
    unittest.main()
