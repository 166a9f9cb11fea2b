# The page as its users meet it: page_test.py GROUP runs one group of tests. Needs GDTSLAM_MAKE_PAGE, the program that
# writes a page, and Chromium for all groups but data.
import math
import os
import random
import re
import struct
import sys
import tempfile
import unittest

import chromium

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from content_policy import faults_of
from page_file import PageFile
from page_input import CEILING, FLOOR, make_page, make_room_page, room, write_cloud, write_map

SKIPPED = 77
HOSTILE = '</script><img src=x onerror="document.title=1"><!-- {{program}} \\u003c & \'"'


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="gdtslam-page-")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)


class DataTest(Case):
    """What lies in the file, read by a decoder of its own."""

    def test_points_come_back(self):
        generator = random.Random(5)
        points = [(generator.uniform(-40, 60), generator.uniform(900, 950), generator.uniform(-1, 3),
                   generator.uniform(-0.4, 1.5), generator.uniform(5e8, 5e8 + 300), k // 7) for k in range(3001)]
        distances = [generator.uniform(0, 0.2) for _ in points]
        write_cloud(self.path("c.ply"), points)
        with open(self.path("d.bin"), "wb") as file:
            file.write(struct.pack(f"<{len(points)}f", *distances))
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"), "--distances", self.path("d.bin"))
        page = PageFile(self.path("c.html"))
        seen = page.points()
        self.assertEqual(len(seen), len(points))
        spans = [max(p[axis] for p in points) - min(p[axis] for p in points) for axis in range(6)]
        for (x, y, z, elevation, stamp, scan), distance, got in zip(points, distances, seen):
            for axis, value in enumerate((x, y, z)):  # half a step, and the float32 of the file
                self.assertAlmostEqual(got[axis], value, delta=0.5001 * spans[axis] / 65535 + 4e-5)
            self.assertAlmostEqual(got[3], stamp, delta=0.5001 * spans[4] / 65535)
            self.assertAlmostEqual(got[4], elevation, delta=0.5001 * spans[3] / 255 + 1e-6)
            self.assertAlmostEqual(got[5], scan, delta=0.5001 * spans[5] / 255)
            self.assertAlmostEqual(got[6], distance, delta=0.5001 * 0.2 / 255)

    def test_levels_of_the_room(self):
        page, points, floor, ceiling = make_room_page(self.folder.name)
        levels = [point[7] for point in PageFile(page).points()]
        self.assertEqual([k for k, level in enumerate(levels) if level == 1],
                         [k for k, p in enumerate(points) if p[2] == FLOOR])
        self.assertEqual([k for k, level in enumerate(levels) if level == 2],
                         [k for k, p in enumerate(points) if p[2] == CEILING])
        about = PageFile(page).description["cloud"]
        self.assertEqual((about["floor"]["points"], about["ceiling"]["points"]), (floor, ceiling))
        self.assertAlmostEqual(about["ceiling"]["height"], CEILING, delta=1e-5)

    def test_stray_points_are_left_out_and_told(self):
        points, _, _ = room()
        stray = [(4e4, 0.0, 1.0, 0.0, 1.0, 1), (0.0, 0.0, -3e5, 0.0, 1.0, 1)]
        write_cloud(self.path("c.ply"), points + stray)
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"))
        about = PageFile(self.path("c.html")).description["cloud"]
        self.assertEqual((about["of"], about["count"]), (len(points) + 2, len(points)))
        self.assertLess(about["most"][0] - about["least"][0], 7.0)

    def test_path_and_map(self):
        page = PageFile(make_room_page(self.folder.name)[0])
        rows = page.path()
        self.assertEqual(len(rows), 101)
        for k, (stamp, x, y, heading) in enumerate(rows):
            for got, expected in ((stamp, 100 + 0.5 * k), (x, 11 + 0.04 * k), (y, -19 + 0.02 * k), (heading, 0.4)):
                self.assertAlmostEqual(got, expected, delta=1e-5)
        self.assertEqual(page.map_cells(), write_map(self.folder.name))

    def test_linkage_closes_where_circles_meet(self):
        make_page(self.path("l.html"), "--linkage", "paper-b")
        page = PageFile(self.path("l.html"))
        about = page.description["linkage"]
        for step, row in enumerate(page.linkage_rows()):
            for got, expected in zip(row, expected_row(about, step)):
                self.assertAlmostEqual(got, expected, delta=2e-7 * 4)

    def test_hostile_words_stay_words(self):
        words = HOSTILE + "\x01\u2028" + os.fsdecode(b"\xff\xc0\x80\xed\xa0\x80")
        make_page(self.path("h.html"), "--linkage", "paper-b", "--title", words, "--fact", words + "=" + words)
        page = PageFile(self.path("h.html"))
        self.assertNotIn("<img", page.text)
        self.assertEqual(len(re.findall("</script", page.text)), len(re.findall("<script", page.text)))
        self.assertTrue(page.description["title"].startswith(HOSTILE))
        self.assertEqual(page.description["title"].count("\ufffd"), 6)

    def test_only_its_own_script_may_run(self):
        make_page(self.path("p.html"), "--linkage", "paper-b", "--title", HOSTILE)
        text = PageFile(self.path("p.html")).text
        self.assertEqual(faults_of(text), [])
        self.assertTrue(faults_of(text.replace("</body>", "<script>document.title = 1</script></body>")))
        self.assertTrue(faults_of(text.replace("<main ", '<main onclick="document.title = 1" ')))


def expected_row(about, step):
    """Joints from the intersection of two circles, in the frame in which the linkage is drawn."""
    phi = 2 * math.pi * step / about["steps"]
    a = complex(math.cos(phi), math.sin(phi)) * about["crank"]
    to_pivot = about["ground"] - a
    length = abs(to_pivot)
    along = (about["coupler"] ** 2 - about["rocker"] ** 2 + length ** 2) / (2 * length)
    across = math.sqrt(about["coupler"] ** 2 - along ** 2)
    b = a + to_pivot / length * complex(along, across)  # on the left: open
    rocker = b - about["ground"]
    turn = complex(math.cos(about["offset"]), math.sin(about["offset"]))
    drawn = [turn * (p if about["sign"] > 0 else p.conjugate()) for p in (a, b, (a + b) / 2, rocker)]
    cosine = abs(((b - a).conjugate() * rocker).real) / (about["coupler"] * about["rocker"])
    angle = math.atan2(drawn[3].imag, drawn[3].real)
    return (*(part for p in drawn[:3] for part in (p.real, p.imag)), angle, math.acos(min(cosine, 1.0)))


def main():
    group = sys.argv[1]
    if group != "data" and chromium.find_program() is None:
        reason = "chromium is not installed, so the page was NOT tested in a browser"
        print(f"SKIPPED: {reason}; GDTSLAM_REQUIRE_BROWSER=1 makes this a failure", flush=True)
        return 1 if os.environ.get("GDTSLAM_REQUIRE_BROWSER") == "1" else SKIPPED
    if group == "data":
        tests = unittest.defaultTestLoader.loadTestsFromTestCase(DataTest)
    else:
        import page_browser_test
        tests = page_browser_test.tests_of(group)
    return 0 if unittest.TextTestRunner(verbosity=2).run(tests).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
