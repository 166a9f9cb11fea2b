"""Tests of pages without a cloud, of narrow windows and of what is drawn and said at limits, for the classes of
page_browser_test that open pages."""
import math
import struct

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

    def test_nothing_is_clipped_from_any_side(self):
        """Not the points that lie far from the middle of the cloud, nor a map that is larger than it."""
        room = [(0.4 * x, 0.4 * y, 0.4 * z, 0.0, 0.0, 0) for x in range(11) for y in range(11) for z in range(11)] * 3
        corners = [(x, y, z) for x in (-3.9, 7.9) for y in (-3.9, 7.9) for z in (-3.9, 7.9)]
        stray = corners[::7]  # two that are opposite
        write_cloud(self.path("c.ply"), room + [(*corner, 0.0, 0.0, 0) for corner in stray])
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"))
        write_map(self.folder.name)
        make_page(self.path("m.html"), "--cloud", self.path("c.ply"), "--map", self.path("map.yaml"))
        for name, places in (("c", stray), ("m", [*stray, (10, -20, 0), (13, -20, 0)])):
            browser = self.open(self.path(name + ".html"))
            self.assertLess(browser.value("gdtslam.camera.most[0] - gdtslam.camera.least[0]"), 4.1)
            hidden = browser.value(f"""(() => {{
              const {{camera, description}} = gdtslam, hidden = [];
              for (const distance of [0.05, 4, 14, 40]) {{
                for (let yaw = 0; yaw < 6.28; yaw += 0.2) {{
                  for (const pitch of [-1.5, -0.6, 0, 0.6, 1.5]) {{
                    Object.assign(camera, {{yaw, pitch, distance}});
                    const [near, far] = camera.planes(), eye = camera.eye(), {{back}} = camera.axes();
                    for (const place of {[list(place) for place in places]}) {{
                      const depth = [0, 1, 2].reduce((sum, k) => sum - back[k] * (place[k] - description.origin[k] - eye[k]), 0);
                      if (depth > 0.05 && (depth < near || depth > far)) hidden.push([place, yaw, pitch, distance]);
                    }}
                    if (near >= distance) hidden.push(["target", near, distance]);
                  }}
                }}
              }}
              return hidden;
            }})()""")
            self.assertEqual(hidden, [])
            self.assert_quiet(browser)

    def test_a_colour_bar_of_one_large_value_is_drawn(self):
        """Its steps are at least as far apart as its digits can tell."""
        browser = self.open_room()
        for value in (0, 1.8e6, 5e8, 1.7e9, -1.7e9):
            browser.value(f"gdtslam.overlay.drawBar(18, 500, 300, {{name: 'Scan', unit: ''}}, [{value}, {value}], () => 'red')", 20)
        texts = browser.value("""(() => {
          const {overlay} = gdtslam, texts = [];
          overlay.words = (text) => texts.push(text);
          overlay.drawBar(18, 500, 300, {name: 'Height', unit: 'm'}, [0, 4], () => 'red');
          delete overlay.words;
          return texts;
        })()""")
        self.assertEqual(texts, ["Height (m)", "0", "1", "2", "3", "4"])
        self.assert_quiet(browser)

    def test_sliders_say_what_is_written_beside_them(self):
        browser = self.open_room()
        browser.value("""(() => {
          gdtslam.timeline.set(0.25);
          for (const [id, value] of [["scale-low", 0.2], ["point-size", 1], ["shading", 0.5], ["crank-speed", 1]]) {
            document.getElementById(id).value = value;
            document.getElementById(id).dispatchEvent(new Event("input"));
          }
        })()""")
        said = dict(browser.value("""[...document.querySelectorAll("input[type=range]")].map((slider) =>
            [slider.id, [slider.getAttribute("aria-valuetext"), document.querySelector(`output[for=${slider.id}]`).textContent]])"""))
        self.assertEqual(set(said), {"time", "scale-low", "scale-high", "point-size", "shading", "crank-speed"})
        for name, (spoken, written) in said.items():
            self.assertEqual(spoken, written, name)
        self.assertEqual((said["point-size"][0], said["shading"][0], said["crank-speed"][0]), ("× 2.00", "50 %", "30.0 rpm"))
        self.assertRegex(said["time"][0], r"^[0-9.]+ of [0-9.]+ s$")

    def test_help_lists_the_keys_that_do_something(self):
        write_map(self.folder.name)
        make_page(self.path("m.html"), "--map", self.path("map.yaml"))
        make_page(self.path("l.html"), "--linkage", "paper-b")
        listed = "[...document.querySelectorAll('#help-body th')].map((cell) => cell.textContent)"
        of_points = {"Click", "M", "C", "L", "[  ]", "Esc"}
        of_scene = {"Left drag, one finger", "Wheel, pinch", "Double click", "Arrows", "+  −", "1  2  3  4", "F"}
        of_page = {"S", "T", "H", "Enter", "?"}
        with_cloud = set(self.open_room().value(listed))
        self.assertLessEqual(of_points | of_scene | of_page | {"Space", "Drag the crank or the mark"}, with_cloud)
        flat = set(self.open(self.path("m.html")).value(listed))
        self.assertLessEqual(of_scene | of_page, flat)
        self.assertEqual(flat & (of_points | {"Space"}), set())
        with chromium.Browser() as browser:
            browser.open(self.path("l.html"))
            linkage = set(browser.value(listed))
        self.assertEqual(linkage, of_page | {"Space", "Left, right", "Drag the crank or the mark"})


class NarrowLinkage:
    def test_the_swept_sector_is_the_short_one(self):
        """Also where it crosses the direction in which angles begin again."""
        browser = self.open_linkage()
        browser.value("gdtslam.linkageView.draw()")
        for first, second, inside, outside in ((170, -170, 180, 0), (-150, 120, 165, 0), (-20, 40, 10, 180), (40, -20, 10, 180)):
            seen = browser.value(f"""(() => {{
              const drawing = gdtslam.linkageView.mechanism, context = drawing.canvas.getContext("2d"), {{fill}} = context;
              const pivot = drawing.at(drawing.linkage.rockerPivot), reach = drawing.beam * drawing.scale / 2;
              let seen = null;
              context.fill = () => {{
                seen = [{inside}, {outside}].map((angle) => context.isPointInPath(pivot[0] + reach * Math.cos(angle * Math.PI / 180),
                                                                                pivot[1] - reach * Math.sin(angle * Math.PI / 180)));
              }};
              drawing.drawSector(context, {first} * Math.PI / 180, {second} * Math.PI / 180, 0.1);
              context.fill = fill;
              return seen;
            }})()""")
            self.assertEqual(seen, [True, False], (first, second))

    def test_a_saved_linkage_has_the_ground_of_the_page(self):
        browser = self.open_linkage()
        for is_dark in ("true", "false"):
            corner, ground, size = browser.value(f"""(() => {{
              gdtslam.theme.set({is_dark});
              let saved = null;
              const {{toBlob}} = HTMLCanvasElement.prototype;
              HTMLCanvasElement.prototype.toBlob = function() {{ saved = this; }};
              document.getElementById("save").click();
              HTMLCanvasElement.prototype.toBlob = toBlob;
              const {{backgroundColor}} = getComputedStyle(document.getElementById("linkage-stage"));
              return [[...saved.getContext("2d").getImageData(1, 1, 1, 1).data], backgroundColor, [saved.width, saved.height]];
            }})()""")
            self.assertEqual(f"rgb({corner[0]}, {corner[1]}, {corner[2]})", ground)
            self.assertEqual(corner[3], 255)
            self.assertEqual(size, [round(side) for side in browser.box("#mechanism")[2:]])

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
