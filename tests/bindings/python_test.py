"""The Python package: the bytes of the library, arrays without copies, errors as exceptions."""
import dataclasses
import gc
import hashlib
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import unittest

from bindings_support import SAMPLE, SKIPPED, SOURCE, folder, sample_hashes

sys.path.insert(0, str(SOURCE / "python"))
try:
    import numpy as np
except ImportError:
    print("SKIPPED: no numpy for Python (package python3-numpy)")
    sys.exit(1 if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1" else SKIPPED)
import gdtslam

WORK = folder("python")


def hash_of_poses(trajectory):
    """What report.json calls trajectory_sha256: x, y, theta of each pose as doubles."""
    return hashlib.sha256(np.ascontiguousarray(trajectory[:, 1:]).tobytes()).hexdigest()


class WholeLog(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.steps = []
        cls.made = gdtslam.map(SAMPLE, WORK / "run", progress=lambda step, scans, share: cls.steps.append((step, scans, share)))

    def test_has_the_hashes_that_ship_with_the_log(self):
        self.assertEqual((self.made.map_sha256, self.made.trajectory_sha256), sample_hashes())
        self.assertEqual(hash_of_poses(self.made.trajectory), self.made.trajectory_sha256)
        self.assertEqual(self.made.field.sha256, self.made.map_sha256)
        self.assertEqual(self.made.report["scans"], 350)

    def test_arrays_are_views_that_outlive_what_they_come_of(self):
        run = gdtslam.Run(WORK / "run")
        poses, cells, field = run.trajectory, run.map, run.field
        for array, shape, kind in ((poses, (350, 4), np.float64), (cells, cells.shape, np.uint8), (field, field.shape, np.uint16)):
            self.assertEqual((array.shape, array.dtype), (shape, kind))
            self.assertFalse(array.flags.owndata)
            with self.assertRaises(ValueError):
                array[0, 0] = 1
        before = [array.copy() for array in (poses, cells, field)]
        del run
        gc.collect()
        junk = [np.zeros(size) for size in range(1, 2000)]
        for array, copy in zip((poses, cells, field), before):
            self.assertTrue(np.array_equal(array, copy), len(junk))

    def test_the_map_is_that_of_the_file(self):
        data = (WORK / "run/map.pgm").read_bytes()
        height, width = self.made.map.shape
        pixels = np.frombuffer(data[-width * height :], dtype=np.uint8).reshape(height, width)
        self.assertTrue(np.array_equal(pixels[::-1], self.made.map))
        self.assertLessEqual(set(np.unique(self.made.map)), {gdtslam.OCCUPIED, gdtslam.FREE, gdtslam.UNKNOWN})

    def test_pictures_are_drawn_and_written_by_their_ending(self):
        self.assertTrue(self.made.render("graph", format="svg").startswith(b"<svg "))
        self.assertTrue(self.made._repr_svg_().startswith("<svg "))
        picture = gdtslam.render(WORK / "run", WORK / "map.png", size=(640, 480), title="Office")
        self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual((WORK / "map.png").read_bytes(), picture)
        self.assertEqual([int.from_bytes(picture[k : k + 4], "big") for k in (16, 20)], [640, 480])

    def test_pictures_are_not_written_over_the_runs_own_files(self):
        copy = WORK / "own"
        shutil.copytree(WORK / "run", copy)
        (WORK / "link.svg").symlink_to(copy / "gdt.png")
        before = {path.name: path.read_bytes() for path in copy.iterdir()}
        for file in (copy / "gdt.png", copy / "report.json", copy / "trajectory.tum", copy / "../own/config.yaml",
                     WORK / "link.svg", copy / "tiles/0.png"):
            for run in (copy, gdtslam.Run(copy)):
                with self.assertRaises(gdtslam.UsageError, msg=str(file)) as caught:
                    gdtslam.render(run, file, format="svg")
                self.assertIn("give another file", str(caught.exception))
        self.assertEqual({path.name: path.read_bytes() for path in copy.iterdir()}, before)
        self.assertTrue(gdtslam.render(copy, copy / "mine.svg").startswith(b"<svg "))
        self.assertEqual({path.name for path in copy.iterdir()}, {*before, "mine.svg"})

    def test_a_picture_that_cannot_be_written_leaves_the_old_one(self):
        place = folder("python/pictures")
        (place / "old.svg").write_text("the old one")
        (place / "old.svg").chmod(0o640)
        (place / "link.svg").symlink_to("old.svg")
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        full = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
            with self.assertRaises(OSError):
                gdtslam.render(self.made, place / "old.svg")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            signal.signal(signal.SIGXFSZ, full)
        self.assertEqual((place / "old.svg").read_text(), "the old one")
        picture = gdtslam.render(self.made, place / "link.svg")
        self.assertEqual((place / "old.svg").read_bytes(), picture)
        self.assertEqual((place / "old.svg").stat().st_mode & 0o777, 0o640)
        self.assertTrue((place / "link.svg").is_symlink())
        self.assertEqual(sorted(path.name for path in place.iterdir()), ["link.svg", "old.svg"])
        self.assertEqual(gdtslam.render(self.made, "/dev/null", format="svg"), picture)

    def test_pictures_are_those_of_the_command(self):
        if "GDTSLAM" not in os.environ:
            self.skipTest("no command in this build")
        for view in ("map", "graph", "field", "distance"):
            file = WORK / f"{view}.svg"
            words = ("field", "--as", "distance") if view == "distance" else (view,)
            done = subprocess.run(
                [os.environ["GDTSLAM"], "render", str(WORK / "run"), "--view", *words, "-o", str(file)], capture_output=True, text=True
            )
            if done.returncode == 69:
                self.skipTest(done.stderr)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(self.made.render(view, format="svg"), file.read_bytes(), view)

    def test_scans_are_found_in_it(self):
        scans = list(gdtslam.scans(SAMPLE))
        found = gdtslam.localize(self.made, scans[100])
        self.assertTrue(found.found)
        self.assertLess(np.hypot(*(np.array(found.pose[:2]) - self.made.trajectory[100, 1:3])), 0.03)
        again = gdtslam.localize(WORK / "run/gdt.yaml", scans[100].ranges, first=scans[100].first, step=scans[100].step,
                                 max_range=scans[100].max_range, mount=scans[100].mount, runner_up=False)
        self.assertEqual(found.pose, again.pose)
        self.assertIsNone(again.runner_up)
        self.assertEqual(gdtslam.localize(self.made, [], first=0.0, step=0.01).verdict, "no pose")
        tracker = gdtslam.Localizer(self.made).tracker()
        for scan in scans[:150]:
            tracked = tracker.follow(scan)
        self.assertEqual(tracked.whereabouts, "tracked")
        self.assertEqual(tracked, dataclasses.replace(tracked, covariance=tracked.covariance.copy()))
        self.assertNotEqual(tracked, dataclasses.replace(tracked, covariance=2 * tracked.covariance))
        self.assertLess(np.hypot(*(np.array(tracked.pose[:2]) - self.made.trajectory[149, 1:3])), 0.03)
        self.assertTrue(np.all(np.linalg.eigvalsh(tracked.covariance) > 0.0))


class Live(unittest.TestCase):
    def test_scan_by_scan_gives_the_hashes_of_the_whole_log(self):
        for loops in (False, True):
            mapper = gdtslam.Mapper(loops=loops)
            for scan in gdtslam.scans(SAMPLE):
                match = mapper.process(scan)
            self.assertTrue(match.accepted)
            mapper.close()
            self.assertEqual((mapper.field().sha256, hash_of_poses(mapper.trajectory)), sample_hashes(loops))

    # A post of the robot that a third of the beams sees: hidden by a mask as if it were nothing.
    def test_what_is_masked_is_no_return(self):
        hidden = np.zeros(180, bool)
        hidden[60:120] = True
        ways = {
            "nan": lambda ranges: np.where(hidden, np.nan, ranges),
            "mask": lambda ranges: np.ma.masked_array(ranges, hidden),
            "mask of doubles": lambda ranges: np.ma.masked_array(ranges.astype(float), hidden),
        }
        found = {}
        for name, hide in ways.items():
            mappers = [gdtslam.Mapper(loops=False) for _ in range(2)]
            for scan in list(gdtslam.scans(SAMPLE))[:10]:
                ranges = scan.ranges.copy()
                ranges[hidden] = 1.0
                scan.ranges = hide(ranges)
                match = mappers[0].process(scan)
                other = mappers[1].process(hide(ranges), stamp=scan.stamp, first=scan.first, step=scan.step, odometry=scan.odometry,
                                           max_range=scan.max_range, mount=scan.mount)
                self.assertEqual(match, other, name)
            found[name] = (match, mappers[0].field().sha256)
            self.assertLessEqual(match.points, 120, name)
        self.assertEqual(found["mask"], found["nan"])
        self.assertEqual(found["mask of doubles"], found["nan"])
        metres = gdtslam.Mapper(loops=False).process(np.ma.masked_array([3, 1, 4], [False, True, False]), first=0.0, step=0.1)
        self.assertEqual(metres.points, 2)

    def test_a_field_stays_as_it_was(self):
        mapper = gdtslam.Mapper(loops=False)
        scans = list(gdtslam.scans(SAMPLE))
        mapper.process(scans[0])
        field = mapper.field()
        before = field.copy()
        for scan in scans[1:60]:
            mapper.process(scan)
        later = mapper.field()
        del mapper
        gc.collect()
        self.assertTrue(np.array_equal(field, before))
        self.assertFalse(np.array_equal(later, field))
        self.assertFalse(field.flags.owndata or field.flags.writeable)

    def test_threads_may_share_a_mapper_one_after_the_other(self):
        mapper, reader, problems = gdtslam.Mapper(loops=False), gdtslam.scans(SAMPLE), []

        def work():
            try:
                for scan in reader:
                    mapper.process(scan)
            except gdtslam.Error as problem:
                problems.append(problem)

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((problems, len(mapper.trajectory)), ([], 350))


class Errors(unittest.TestCase):
    def test_have_classes_of_their_own_and_those_of_python(self):
        for kind, parent, provoke in (
            (gdtslam.ConfigError, ValueError, lambda: gdtslam.Mapper({"map.resolution": "5"})),
            (gdtslam.ConfigError, ValueError, lambda: gdtslam.options({"map.resolution": "7,5 cm"})),
            (gdtslam.ConfigError, ValueError, lambda: gdtslam.Mapper({"map.resolutoin": "5 cm"})),
            (gdtslam.FileError, OSError, lambda: gdtslam.map("no/such.log", WORK / "none")),
            (gdtslam.FileError, OSError, lambda: gdtslam.scans("no/such.log")),
            (gdtslam.InputError, ValueError, lambda: gdtslam.Run(WORK)),
            (gdtslam.InputError, ValueError, lambda: gdtslam.Mapper().process(np.zeros((2, 2)), first=0.0, step=0.1)),
            (gdtslam.InputError, ValueError, lambda: gdtslam.Mapper().process([1.0], first=0.0, step=float("nan"))),
            (gdtslam.UsageError, ValueError, lambda: gdtslam.Mapper().process([1.0])),
            (gdtslam.UsageError, ValueError, lambda: gdtslam.Mapper().process([1.0], first=0.0, step=0.1, odometry=(1, 2))),
            (gdtslam.UsageError, ValueError, lambda: gdtslam.map([], WORK / "none")),
            *((gdtslam.UsageError, ValueError, lambda limit=limit: gdtslam.Localizer(WORK / "none", **{limit: 0.0}))
              for limit in ("gap", "max_seconds", "good_fit")),
            (gdtslam.UsageError, ValueError, lambda: gdtslam.map(SAMPLE, WORK / "none", count=0)),
            (gdtslam.UsageError, ValueError, lambda: gdtslam.map(SAMPLE, "", count=5)),
        ):
            with self.assertRaises(kind) as caught:
                provoke()
            self.assertIsInstance(caught.exception, (gdtslam.Error, parent))
            self.assertTrue(str(caught.exception))

    def test_whole_numbers_that_c_has_no_room_for_are_refused(self):
        most = int(re.search(r"kMostThreads = (\d+)", (SOURCE / "engine/c/options.hpp").read_text()).group(1))
        for name, least, largest, provoke in (
            ("count", 1, 2**64 - 1, lambda value: gdtslam.map(SAMPLE, WORK / "none", count=value)),
            ("skip", 0, 2**64 - 1, lambda value: gdtslam.map(SAMPLE, WORK / "none", skip=value)),
            ("threads", 0, most, lambda value: gdtslam.map(SAMPLE, WORK / "none", threads=value)),
            ("threads", 0, most, lambda value: gdtslam.Mapper(threads=value)),
            ("laser", 0, 2**64 - 1, lambda value: gdtslam.Mapper().process(gdtslam.Scan(np.ones(3), 0.0, 0.1, laser=value))),
        ):
            for value in (least - 1, largest + 1, -(2**70)):
                with self.assertRaisesRegex(gdtslam.UsageError, f"{name}: {value} is not from {least} to {largest}"):
                    provoke(value)
            with self.assertRaises(TypeError):
                provoke(1.5)
        self.assertFalse((WORK / "none").exists())
        self.assertEqual(gdtslam.map(SAMPLE, loops=False, pictures=False, skip=np.int64(340), count=2**64 - 1).report["scans"], 10)

    def test_a_nul_does_not_cut_a_text_short(self):
        victim = folder("python/victim")
        for provoke in (
            lambda: gdtslam.map(SAMPLE, f"{victim}\0-not", count=5),
            lambda: gdtslam.map(f"{SAMPLE}\0.log", victim, count=5),
            lambda: gdtslam.map(SAMPLE, victim, linkage="paper-b\0", count=5),
            lambda: gdtslam.Run(f"{victim}\0"),
            lambda: gdtslam.scans([f"{SAMPLE}\0"]),
            lambda: gdtslam.scans(SAMPLE, topics="/scan\0"),
            lambda: gdtslam.options({"map.resolution\0": "5 cm"}),
            lambda: gdtslam.options({"map.resolution": "5 cm\0"}),
            lambda: gdtslam.Localizer(f"{victim}\0"),
        ):
            with self.assertRaisesRegex(gdtslam.UsageError, "holds a NUL"):
                provoke()
        self.assertEqual(list(victim.iterdir()), [])

    def test_interruption_leaves_what_there_is(self):
        with self.assertRaises(gdtslam.Interrupted) as caught:
            gdtslam.map(SAMPLE, WORK / "interrupted", loops=False, progress=lambda step, scans, share: scans == 20)
        self.assertEqual(len(caught.exception.run.trajectory), 20)

    def test_what_the_callers_function_raises_comes_out(self):
        def progress(step, scans, share):
            raise KeyError("the caller's")

        with self.assertRaises(KeyError):
            gdtslam.map(SAMPLE, WORK / "raised", progress=progress)
        mapper = gdtslam.Mapper()
        for scan in gdtslam.scans(SAMPLE):
            mapper.process(scan)
        with self.assertRaises(KeyError):
            mapper.close(progress)

    def test_a_temporary_folder_goes_with_its_run(self):
        run = gdtslam.map(SAMPLE, loops=False, pictures=False, count=20)
        place = run.folder
        self.assertTrue((place / "report.json").exists())
        del run
        gc.collect()
        self.assertFalse(place.exists())

    def test_options_are_those_of_the_command(self):
        self.assertEqual(gdtslam.options({"map.resolution": "5 cm"})["map.resolution"].value, "0.05 m")
        if "GDTSLAM" in os.environ:
            words = subprocess.run([os.environ["GDTSLAM"], "config", "show", "--all"], capture_output=True, text=True, check=True).stdout
            shown = re.findall(r"^([a-z_.]+) += ", words, re.MULTILINE)
            self.assertEqual(list(gdtslam.options()), shown)

    def test_a_library_that_is_not_there_is_named(self):
        env = {**os.environ, "PYTHONPATH": str(SOURCE / "python"), "GDTSLAM_LIBRARY": "/no/such.so"}
        done = subprocess.run([sys.executable, "-c", "import gdtslam"], capture_output=True, text=True, env=env)
        self.assertIn("ImportError: gdtslam: /no/such.so cannot be loaded", done.stderr)


if __name__ == "__main__":
    unittest.main()
