"""The Python package reading pipes whose sender falls silent, and the signals that come while it waits."""
import gzip
import os
import signal
import sys
import threading
import time
import unittest

from bindings_support import SAMPLE, SKIPPED, SOURCE, folder

sys.path.insert(0, str(SOURCE / "python"))
try:
    import numpy  # noqa: F401
except ImportError:
    print("SKIPPED: no numpy for Python (package python3-numpy)")
    sys.exit(1 if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1" else SKIPPED)
import gdtslam

WORK = folder("pipes")
SHORT = {"loops": False, "pictures": False}
LINES = gzip.decompress(SAMPLE.read_bytes()).splitlines(keepends=True)[:240]
SILENCE_S = 0.3  # in which whoever reads has come to wait


class Stopped(Exception):
    pass


class Pipe(unittest.TestCase):
    def setUp(self):
        self.pipe = WORK / self.id()
        os.mkfifo(self.pipe)
        self.log = WORK / "log"
        self.log.write_bytes(b"".join(LINES))
        self.done = threading.Event()
        self.addCleanup(self.done.set)
        signal.alarm(120)  # ends one that hangs
        self.addCleanup(signal.alarm, 0)

    def handle(self, number, handler):
        self.addCleanup(signal.signal, number, signal.signal(number, handler))

    def in_thread(self, work):
        thread = threading.Thread(target=work)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.done.set)  # before that

    def send_half(self, then):
        """Half the lines, and the rest once `then` has returned something true; the end when the test is over, too."""

        def send():
            with open(self.pipe, "wb") as pipe:
                pipe.write(b"".join(LINES[: len(LINES) // 2]))
                pipe.flush()
                if then():
                    pipe.write(b"".join(LINES[len(LINES) // 2 :]))
                else:
                    self.done.wait()

        self.in_thread(send)

    def interrupt(self):
        time.sleep(SILENCE_S)
        os.kill(os.getpid(), signal.SIGINT)

    def count_signals(self, count, note=lambda: None):
        """What sends signals to whoever waits, until their handler has returned so often."""
        seen = []

        def tick(number, frame):
            if len(seen) < count:
                note()
            seen.append(number)

        self.handle(signal.SIGUSR1, tick)

        def until_seen():
            time.sleep(SILENCE_S)
            while len(seen) < count and not self.done.is_set():
                os.kill(os.getpid(), signal.SIGUSR1)
                time.sleep(0.02)
            return True

        return until_seen


class Scans(Pipe):
    def test_ctrl_c_ends_the_wait_for_a_writer(self):
        self.in_thread(self.interrupt)
        with self.assertRaises(KeyboardInterrupt):
            gdtslam.scans(self.pipe)
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)

    def test_ctrl_c_ends_the_wait_for_the_next_scan(self):
        self.send_half(self.interrupt)
        scans, given = gdtslam.scans(self.pipe), []
        with self.assertRaises(KeyboardInterrupt):
            for scan in scans:
                given.append(scan)
        self.assertEqual(given, list(gdtslam.scans(self.log))[: len(given)])
        self.assertGreater(len(given), 10)
        with self.assertRaises(gdtslam.Interrupted) as caught:
            next(scans)
        self.assertEqual(caught.exception.status, 130)
        self.assertEqual(scans.warnings, [])

    def test_what_any_handler_raises_comes_out(self):
        def stop(number, frame):
            raise Stopped

        self.handle(signal.SIGALRM, stop)
        self.send_half(lambda: False)
        scans = gdtslam.scans(self.pipe)
        signal.setitimer(signal.ITIMER_REAL, SILENCE_S, SILENCE_S)
        with self.assertRaises(Stopped):
            list(scans)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        self.assertIs(signal.getsignal(signal.SIGALRM), stop)

    def test_reading_goes_on_behind_handlers_that_return(self):
        made, shares, problems = [], [], []

        def note():
            if not made:
                return
            shares.append(made[0].progress)
            try:
                next(made[0])
            except RuntimeError as problem:
                problems.append(str(problem))

        self.send_half(self.count_signals(3, note))
        made.append(gdtslam.scans(self.pipe))
        self.assertEqual(list(made[0]), list(gdtslam.scans(self.log)))
        self.assertEqual(set(shares), {None})
        self.assertEqual(len(problems), len(shares))
        self.assertIn("a scan is being read", problems[0])


class Map(Pipe):
    def test_ctrl_c_ends_it_with_what_there_is(self):
        self.send_half(self.interrupt)
        with self.assertRaises(KeyboardInterrupt):
            gdtslam.map(self.pipe, WORK / "part", **SHORT)
        report = gdtslam.Run(WORK / "part").report
        self.assertTrue(report["interrupted"])
        self.assertGreater(report["scans"], 10)


if __name__ == "__main__":
    unittest.main()
