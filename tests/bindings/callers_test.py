"""The Python package and its caller: his functions, signals that come meanwhile, his threads and forked processes."""
import gzip
import os
import random
import signal
import subprocess
import sys
import threading
import time
import unittest
import warnings


from bindings_support import SAMPLE, SKIPPED, SOURCE, folder, sample_hashes

sys.path.insert(0, str(SOURCE / "python"))
try:
    import numpy as np
except ImportError:
    print("SKIPPED: no numpy for Python (package python3-numpy)")
    sys.exit(1 if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1" else SKIPPED)
import gdtslam

WORK = folder("callers")
SHORT = {"loops": False, "pictures": False}


def send(number):
    os.kill(os.getpid(), number)


class Stopped(Exception):
    pass


class Signals(unittest.TestCase):
    def handle(self, number, handler):
        self.addCleanup(signal.signal, number, signal.signal(number, handler))

    def mapped_with_a_signal(self, seconds, **how):
        """Whether a signal that comes so late raises KeyboardInterrupt, in the map or behind it."""
        sender = threading.Timer(seconds, send, [signal.SIGINT])
        try:
            sender.start()
            gdtslam.map(SAMPLE, WORK / "run", **SHORT, **how)
            sender.join()
            time.sleep(0.01)
        except KeyboardInterrupt:
            return True
        return False

    def test_ctrl_c_is_never_lost(self):
        begin = time.monotonic()
        gdtslam.map(SAMPLE, WORK / "run", **SHORT)
        whole_s = time.monotonic() - begin
        chance = random.Random(7)
        for _ in range(12):
            self.assertTrue(self.mapped_with_a_signal(chance.random() * whole_s))
            self.assertTrue(self.mapped_with_a_signal(chance.random() * whole_s, progress=lambda step, scans, share: None))
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)

    def test_handlers_of_the_caller_are_called_at_once_and_what_they_raise_comes_out(self):
        steps, seen = [], []
        self.handle(signal.SIGUSR1, lambda number, frame: seen.append(len(steps)))

        def progress(step, scans, share):
            steps.append(step)
            if scans == 10:
                send(signal.SIGUSR1)

        run = gdtslam.map(SAMPLE, WORK / "noted", **SHORT, count=30, progress=progress)
        self.assertEqual(run.report["scans"], 30)
        self.assertEqual(seen, [10])

        def stop(number, frame):
            raise Stopped

        self.handle(signal.SIGALRM, stop)
        signal.setitimer(signal.ITIMER_REAL, 0.02)
        with self.assertRaises(Stopped):
            for _ in range(1000):
                gdtslam.map(SAMPLE, WORK / "stopped", **SHORT)
        self.assertIs(signal.getsignal(signal.SIGALRM), stop)

    def test_a_thread_maps_without_them(self):
        made = []
        thread = threading.Thread(target=lambda: made.append(gdtslam.map(SAMPLE, WORK / "thread", **SHORT, count=20)))
        thread.start()
        thread.join()
        self.assertEqual(made[0].report["scans"], 20)


class Closing(unittest.TestCase):
    def mapper(self):
        mapper = gdtslam.Mapper()
        self.scans = list(gdtslam.scans(SAMPLE))
        for scan in self.scans:
            mapper.process(scan)
        return mapper

    def test_its_own_progress_cannot_use_a_mapper(self):
        for use in (
            lambda mapper: mapper.trajectory,
            lambda mapper: mapper.field(),
            lambda mapper: mapper.process(self.scans[0]),
            lambda mapper: mapper.close(),
        ):
            mapper, problems = self.mapper(), []

            def progress(step, scans, share):
                try:
                    use(mapper)
                except RuntimeError as problem:
                    problems.append(str(problem))

            signal.alarm(60)  # ends one that hangs
            mapper.close(progress)
            signal.alarm(0)
            self.assertIn("is being closed", problems[0])
            self.assertEqual(mapper.field().sha256, sample_hashes()[0])


class Warnings(unittest.TestCase):
    def setUp(self):
        self.log = WORK / "bad.log"
        lines = gzip.decompress(SAMPLE.read_bytes()).splitlines(keepends=True)
        self.log.write_bytes(b"".join([*lines[:60], b"FLASER nonsense\n", *lines[60:120]]))
        self.warning = f'warning: malformed line (1 times; first: {self.log}:61: has "nonsense" as its number of beams, which is not a whole number)'

    def test_those_of_a_log_are_told(self):
        told = []
        run = gdtslam.map(self.log, WORK / "bad", **SHORT, lenient=True, warn=told.append)
        self.assertEqual(told, [self.warning])
        self.assertEqual(run.report["warnings"], {"malformed line": 1})
        if "GDTSLAM" in os.environ:
            done = subprocess.run(
                [os.environ["GDTSLAM"], "map", str(self.log), "-o", str(WORK / "command"), "--lenient", "--no-pictures"],
                capture_output=True, text=True, check=True,
            )
            self.assertIn(f"gdtslam: {self.warning}\n", done.stderr)

    def test_what_warn_raises_comes_out(self):
        def warn(text):
            raise Stopped(text)

        with self.assertRaisesRegex(Stopped, "malformed line"):
            gdtslam.map(self.log, WORK / "bad", **SHORT, lenient=True, warn=warn)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(UserWarning, "malformed line"):
                gdtslam.map(self.log, WORK / "bad", **SHORT, lenient=True)


ENDS = """
import sys, threading, time, gdtslam
scans = list(gdtslam.scans(sys.argv[1]))
mapper = gdtslam.Mapper(threads=2)
run = gdtslam.map(sys.argv[1], loops=False, pictures=False, count=20)


def work():
    while True:
        for scan in scans:
            mapper.process(scan)

threading.Thread(target=work, daemon=True).start()
time.sleep(float(sys.argv[2]))
print(run.folder)
"""


class Ends(unittest.TestCase):
    def test_a_daemon_thread_in_the_library_breaks_no_end_of_the_process(self):
        for k in range(8):
            done = subprocess.run(
                [sys.executable, "-c", ENDS, str(SAMPLE), str(0.1 + 0.037 * k)], capture_output=True, text=True,
                env={**os.environ, "PYTHONPATH": str(SOURCE / "python")},
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertFalse(os.path.exists(done.stdout.strip()), "a temporary folder stays")


FORKS = """
import gc, os, signal, sys, gdtslam
sample, lets_go = sys.argv[1], sys.argv[2] == "True"
mapper = gdtslam.Mapper(threads=2)
scans = list(gdtslam.scans(sample))
for scan in scans[:30]:
    mapper.process(scan)
run = gdtslam.map(sample, loops=False, pictures=False, count=20)
child = os.fork()
if child == 0:
    signal.alarm(20)  # ends one that hangs
    try:
        mapper.process(scans[30])
    except RuntimeError as problem:
        print(problem, flush=True)
    if lets_go:
        del mapper, run
        gc.collect()
    sys.exit(7)
print(os.waitpid(child, 0)[1] == 7 << 8)
print((run.folder / "report.json").exists(), len(run.trajectory), run.map.ndim)
mapper.process(scans[30])
print(run.folder)
"""


class Forks(unittest.TestCase):
    # What the child lets go, before its end or at its end, is the parent's.
    def test_a_child_ends_and_leaves_what_its_parent_has(self):
        for lets_go in (False, True):
            done = subprocess.run(
                [sys.executable, "-c", FORKS, str(SAMPLE), str(lets_go)], capture_output=True, text=True,
                env={**os.environ, "PYTHONPATH": str(SOURCE / "python")},
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            problem, *lines, place = done.stdout.splitlines()
            self.assertIn("in the process that made it", problem)
            self.assertEqual(lines, ["True", "True 20 2"], f"lets go: {lets_go}")
            self.assertFalse(os.path.exists(place), "the parent's end takes it away")


if __name__ == "__main__":
    unittest.main()
