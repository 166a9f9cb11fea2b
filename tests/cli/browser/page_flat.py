"""Tests of pages without a cloud and of several drives, for the classes of
page_browser_test that open pages."""
import math

from page_input import make_page, write_map, write_path


class FlatPages:
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
