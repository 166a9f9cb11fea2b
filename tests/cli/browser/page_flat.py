"""Tests of pages without a cloud and of narrow windows, for the classes of page_browser_test that open pages."""
import math
import struct

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

    def test_a_cloud_without_times_leaves_the_time_to_the_path(self):
        write_cloud(self.path("c.ply"), [(10.0 + x, -20.0 + y, 0.1 * y, 0.0, 0.0, 0) for x in range(6) for y in range(6)])
        write_path(self.path("p.tum"))
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"), "--path", self.path("p.tum"))
        browser = self.open(self.path("c.html"))
        self.assertEqual(browser.value("gdtslam.timeline.value.textContent"), "50.0 of 50.0 s")
        browser.value("gdtslam.timeline.set(0.5)")
        pose = browser.value("gdtslam.cloudView.path.poseAt(gdtslam.cloudView.path.about.first + 25)")
        self.assertAlmostEqual(pose["x"], 3.0, places=3)  # half-way from 1 m to 5 m
        self.assertEqual(browser.value("gdtslam.pointsShown()"), 36)
        self.assert_quiet(browser)

    def test_a_clock_that_steps_back(self):
        """Time goes on, the path is all there, and the cloud, whose stamps are those of the log, is shown whole."""
        with open(self.path("p.tum"), "w", encoding="ascii") as file:
            for k in range(21):
                file.write(f"{100 + k if k <= 10 else 40 + k} {k} 0 0 0 0 0 1\n")
        points = [(float(x), float(y), 0.1 * y, 0.0, 100.0 + x if x <= 10 else 40.0 + x, 0) for x in range(21) for y in range(6)]
        write_cloud(self.path("c.ply"), points)
        for name, options in (("p", ()), ("pc", ("--cloud", self.path("c.ply")))):
            make_page(self.path(name + ".html"), "--path", self.path("p.tum"), *options)
            browser = self.open(self.path(name + ".html"))
            self.assertEqual(browser.value("gdtslam.timeline.value.textContent"), "19.0 of 19.0 s")
            for seconds, x in ((0, 0), (4.5, 4.5), (9.75, 9.75), (10.5, 11.5), (19, 20)):
                self.assertAlmostEqual(browser.value(f"gdtslam.cloudView.path.poseAt({100 + seconds}).x"), x, places=4)
            self.assert_quiet(browser)
        browser.value("gdtslam.timeline.set(0.25)")
        self.assertEqual(browser.value("gdtslam.pointsShown()"), len(points))

    def test_a_robot_that_stood_is_in_the_picture(self):
        """A path on one spot, and a point alone, have no extent that a camera could fit."""
        with open(self.path("p.tum"), "w", encoding="ascii") as file:
            file.write("".join(f"{100 + k} 3 4 0 0 0 0 1\n" for k in range(5)))
        write_cloud(self.path("c.ply"), [(1.0, 2.0, 3.0, 0.0, 5.0, 0)])
        make_page(self.path("p.html"), "--path", self.path("p.tum"))
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"))
        for name, layer, least in (("p", "robot", 2000), ("c", "cloud", 1)):
            browser = self.open(self.path(name + ".html"))
            self.assertTrue(browser.value("(({target, yaw, pitch, distance}) => [...target, yaw, pitch, distance].every(Number.isFinite))"
                                          "(gdtslam.camera.state())"))
            browser.value("void (window.kept = gdtslam.picture())")
            browser.value(f"gdtslam.view.layers.{layer} = false")
            self.assertGreaterEqual(browser.value("gdtslam.differing(window.kept, gdtslam.picture())"), least, name)
            self.assert_quiet(browser)
        browser = self.open(self.path("p.html"))
        for dx, dy in ((0.25, 0.2), (-0.25, -0.2)):
            x, y, _ = browser.value(f"gdtslam.camera.pixelOf([{dx}, {dy}, 0])")
            width, height = browser.box("#scene")[2:]
            self.assertTrue(0 < x < width and 0 < y < height, (x, y))

    def test_what_is_read_of_a_point_is_no_finer_than_it_is_known(self):
        """Of 300 m and 1000 s in 16 bits, of 180° and 5 m in 8; a distance that was not found is at least the largest."""
        points = [(3.0 * k, 0.0, 0.0, math.radians(1.8 * k), 10.0 * k, 0) for k in range(101)]
        distances = [0.05 * k for k in range(101)]
        distances[40] = math.nan
        write_cloud(self.path("c.ply"), points)
        with open(self.path("d.bin"), "wb") as file:
            file.write(struct.pack(f"<{len(points)}f", *distances))
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"), "--distances", self.path("d.bin"))
        browser = self.open(self.path("c.html"))
        rows = {}
        for k in (20, 40, 100):
            browser.value(f"""(() => {{
              const {{points}} = gdtslam.cloudView, {{step, count}} = points.about, [part] = points.elements;
              const at = [...Array(count).keys()].find((k) => k * step % count === {k});
              gdtslam.picks.set([points.at(part, at)]);
            }})()""")
            rows[k] = dict(browser.value("[...document.querySelectorAll('#readout tr')].map((row) => [...row.children].map((c) => c.textContent))"))
        self.assertEqual(rows[20], {"x": "60.00 m", "y": "0.00 m", "z": "0.00 m", "time": "200.0 s", "elevation": "36°", "distance": "1.0 m"})
        self.assertEqual(rows[40]["distance"], "at least 5.0 m")
        self.assertEqual(rows[100]["distance"], "at least 5.0 m")
        self.assert_quiet(browser)

    def test_a_tab_that_was_hidden_goes_on_where_it_was(self):
        write_path(self.path("p.tum"))
        make_page(self.path("p.html"), "--path", self.path("p.tum"))
        browser = self.open(self.path("p.html"))
        browser.value("""(() => {
          const {timeline} = gdtslam, now = performance.now();
          timeline.set(0.1);
          timeline.speed.value = '1';
          Object.assign(timeline, {isPlaying: true, last: now - 60000});
          timeline.step(now);
          timeline.toggle();
        })()""")
        self.assertAlmostEqual(browser.value("gdtslam.view.until"), 0.1 + 0.25 / 50, delta=1e-6)

    def test_lines_are_as_wide_as_the_picture_is_fine(self):
        """The picture has at most two pixels to one of CSS, on a finer screen, too."""
        write_path(self.path("p.tum"))
        make_page(self.path("p.html"), "--path", self.path("p.tum"))
        browser = self.open(self.path("p.html"))
        for scale, ratio in ((1, 1), (2, 2), (4, 2)):
            browser.resize(1000, 700, scale)
            browser.settle()
            width = browser.value("""(() => {
              const {path} = gdtslam.cloudView, {use} = path.program;
              let width = 0;
              path.program.use = (values) => { width = values.width; use.call(path.program, values); };
              gdtslam.cloudView.draw(1);
              path.program.use = use;
              return width;
            })()""")
            self.assertAlmostEqual(width, 2.4 * ratio, places=6)

    def test_on_a_telephone_time_has_a_slider(self):
        browser = self.open_room(width=390, height=844)
        self.assertGreater(browser.value("document.getElementById('time').getBoundingClientRect().width"), 300)
        edges = browser.value("[...document.querySelectorAll('#timeline > *')].map(e => e.getBoundingClientRect().right)")
        self.assertLessEqual(max(edges), 390)

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

    def test_words_stand_apart_on_a_telephone(self):
        browser = self.open_linkage()
        browser.resize(390, 844)
        browser.settle()
        for canvas in ("mechanism", "plot", "transmission-plot"):
            box = browser.box("#" + canvas)
            self.assertGreater(box[2], 300, canvas)
            self.assertGreater(box[3], 170, canvas)
        # Each word that is drawn, with its place: none over another.
        overlaps = browser.value("""(() => {
          const found = [], proto = CanvasRenderingContext2D.prototype, plain = proto.fillText;
          proto.fillText = function(text, x, y) {
            const width = this.measureText(text).width;
            const left = x - (this.textAlign === 'right' ? width : this.textAlign === 'center' ? width / 2 : 0);
            found.push({canvas: this.canvas.id, text, left, right: left + width, y, size: parseFloat(/[0-9.]+px/.exec(this.font)[0])});
            plain.call(this, text, x, y);
          };
          gdtslam.linkageView.draw();
          proto.fillText = plain;
          const over = (a, b) => a.canvas === b.canvas && a.left < b.right && b.left < a.right && Math.abs(a.y - b.y) < 0.8 * Math.min(a.size, b.size);
          return found.flatMap((a, k) => found.slice(k + 1).filter((b) => over(a, b)).map((b) => `${a.text} over ${b.text}`));
        })()""")
        self.assertEqual(overlaps, [])
