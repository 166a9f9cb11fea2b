"""Tests of pages without a cloud, of narrow windows and of what is drawn and said at limits, for the classes of
page_browser_test that open pages."""
import math

import chromium
from page_input import make_page, write_cloud, write_map, write_path


class FlatAndNarrow:
    def test_a_map_without_a_cloud_is_seen_from_above(self):
        """As map.png has it: y up, free lighter than unknown, walls darkest, the path in the colours of time."""
        write_map(self.folder.name)
        write_path(self.path("p.tum"))
        make_page(self.path("m.html"), "--map", self.path("map.yaml"), "--path", self.path("p.tum"))
        browser = self.open(self.path("m.html"))
        browser.value("gdtslam.theme.set(false)")
        state = browser.value("gdtslam.camera.state()")
        self.assertAlmostEqual(state["pitch"], math.pi / 2, places=6)
        self.assertAlmostEqual(state["yaw"], -math.pi / 2, places=6)
        for name in ("grid", "robot", "path"):
            browser.value(f"gdtslam.view.layers.{name} = false")

        def seen(x, y):
            return browser.value(f"""(() => {{
              const {{cloudView, camera, description}} = gdtslam, ratio = cloudView.canvas.width / camera.width;
              const [px, py] = camera.pixelOf([{x} - description.origin[0], {y} - description.origin[1], cloudView.floor]);
              return gdtslam.at(gdtslam.picture(), px * ratio, py * ratio);
            }})()""")
        free, unknown, wall = seen(13.05, -18.05), seen(10.25, -19.65), seen(13.05, -19.95)
        self.assertEqual(free, [255, 255, 255])
        self.assertEqual(unknown, [0xE4, 0xE2, 0xDB])
        self.assertLess(sum(wall), 200)
        browser.value("gdtslam.view.layers.path = true")
        first, last = seen(11.02, -18.99), seen(14.98, -17.01)
        self.assertGreater(first[2], first[0] + 60)  # blue, then orange
        self.assertGreater(last[0], last[2] + 60)

    def test_drives_are_apart(self):
        """No line leads from a drive to the next, whose clock begins while the first one lasts: one is played after the other."""
        def line(stamp, x, y):
            return f"{stamp} {x} {y} 0 0 0 0 1\n"
        with open(self.path("p.tum"), "w", encoding="ascii") as file:
            file.write("".join(line(100 + k, k, 0) for k in range(11)) + "".join(line(105 + k, k, 30) for k in range(6)))
        make_page(self.path("p.html"), "--path", self.path("p.tum"), "--drive", "11")
        browser = self.open(self.path("p.html"))
        corners = browser.value("Array.from(gdtslam.cloudView.path.corners())")
        stretches = [(corners[k + 1], corners[k + 5]) for k in range(0, len(corners), 48)]
        self.assertEqual(stretches, [(0, 0)] * 10 + [(30, 30)] * 5)
        self.assertEqual(browser.value("document.getElementById('layer-path').parentElement.textContent"), "Path15.0 m")
        self.assertEqual(browser.value("gdtslam.timeline.value.textContent"), "15.0 of 15.0 s")
        for seconds, place in ((0, (0, 0)), (4.5, (4.5, 0)), (9.75, (9.75, 0)), (10.5, (0.5, 30)), (15, (5, 30))):
            pose = browser.value(f"gdtslam.cloudView.path.poseAt({100 + seconds})")
            self.assertAlmostEqual(pose["x"], place[0], places=4)
            self.assertAlmostEqual(pose["y"], place[1], places=4)
        self.assert_quiet(browser)

    def test_the_first_view_fits_any_window(self):
        """Until somebody looks elsewhere, all of a wide map is in the picture, also when the window becomes another."""
        points = [(x, y, 0.0, 0.0, 0.0, 0) for x in (0.0, 40.0) for y in (0.0, 3.0) for _ in range(3)]
        write_cloud(self.path("w.ply"), points)
        make_page(self.path("w.html"), "--cloud", self.path("w.ply"))
        browser = self.open(self.path("w.html"), width=1600)

        def corners():
            width, height = browser.box("#scene")[2:]
            seen = browser.value(f"{[list(p[:3]) for p in points[::3]]}.map((p) => gdtslam.camera.pixelOf(p))")
            return width, height, seen

        for size in ((1600, 800), (700, 800), (1280, 800), (1280, 500)):
            browser.resize(*size)
            browser.settle()
            width, height, seen = corners()
            for x, y, _ in seen:
                self.assertTrue(0 < x < width and 0 < y < height, (size, x, y))
        browser.wheel(400, 300, 240)
        browser.settle()
        moved = browser.value("gdtslam.camera.state()")
        browser.resize(900, 700)
        browser.settle()
        self.assertEqual(browser.value("gdtslam.camera.state()"), moved)
        self.assert_quiet(browser)


class NarrowLinkage:
    def test_stands_still_for_those_who_prefer_it(self):
        make_page(self.path("l.html"), "--linkage", "paper-b")
        browser = self.open_plain(self.path("l.html"))
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
        browser.open(self.path("l.html"))
        first = browser.value("gdtslam.linkageView.step")
        browser.settle()
        self.assertEqual(browser.value("gdtslam.linkageView.step"), first)
        self.assertEqual(browser.value("document.getElementById('crank-play').textContent"), "Play")
        browser.value("document.getElementById('crank-play').click()")
        browser.wait_for(f"gdtslam.linkageView.step > {first} + 5")

