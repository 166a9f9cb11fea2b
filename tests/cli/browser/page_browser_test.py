# Groups of tests that open a page in Chromium: scene, controls, linkage, robust.
import base64
import math
import os
import unittest

import chromium
from page_file import PageFile
from page_flat import FlatPages
from page_input import make_page, make_room_page, write_cloud
from page_test import HOSTILE, Case, expected_row

# The scene's pixels as an array that stays on the page: gdtslam.picture() draws all points and reads them.
READ_PICTURE = """gdtslam.picture = () => {
  const {cloudView} = gdtslam, gl = cloudView.gl, {width, height} = cloudView.canvas;
  cloudView.draw(1);
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
};
gdtslam.at = (pixels, x, y) => {
  const {width, height} = gdtslam.cloudView.canvas, k = 4 * (width * (height - 1 - Math.round(y)) + Math.round(x));
  return Array.from(pixels.subarray(k, k + 3));
};
gdtslam.differing = (a, b) => {
  let count = 0;
  for (let k = 0; k < a.length; k += 4) {
    if (Math.abs(a[k] - b[k]) + Math.abs(a[k + 1] - b[k + 1]) + Math.abs(a[k + 2] - b[k + 2]) > 12) ++count;
  }
  return count;
};
"""


class BrowserCase(Case):
    def open(self, path, width=1200, height=800, flags=()):
        browser = chromium.Browser(width, height, flags)
        self.addCleanup(browser.close)
        browser.open(path)
        browser.value(READ_PICTURE + "0")
        browser.settle()
        return browser

    def open_room(self, *options, **window):
        self.page, self.points, self.floor, self.ceiling = make_room_page(self.folder.name, *options)
        return self.open(self.page, **window)

    def assert_quiet(self, browser):
        self.assertEqual(browser.errors, [])
        self.assertEqual(browser.value("gdtslam.errors"), [])
        # The page itself, and what it makes of its own bytes.
        self.assertEqual([url for url in browser.requests if not url.startswith(("file://", "data:", "blob:"))], [])
        self.assertEqual(len([url for url in browser.requests if url.startswith("file://")]), 1)


def state_of(browser):
    return browser.value("gdtslam.camera.state()")


def keep_picture(browser):
    browser.value("void (window.kept = gdtslam.picture())")


def pixels_changed(browser):
    return browser.value("gdtslam.differing(window.kept, gdtslam.picture())")


class SceneTest(BrowserCase):
    def test_opens_without_errors_or_requests(self):
        browser = self.open_room()
        self.assert_quiet(browser)
        self.assertEqual(browser.value("document.title"), "Room")
        self.assertEqual(browser.value("document.getElementById('title').textContent"), "Room")
        keep_picture(browser)
        browser.value("gdtslam.view.layers.cloud = false")
        self.assertGreater(pixels_changed(browser), 50000)  # the cloud fills much of the 900 x 690 pixels

    def test_a_point_is_where_the_camera_says(self):
        points = [(x, y, z, 0.0, 0.0, 0) for x in (0.0, 4.0) for y in (0.0, 3.0) for z in (0.0, 2.0) for _ in range(3)]
        write_cloud(self.path("c.ply"), points)
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"))
        browser = self.open(self.path("c.html"))
        browser.value("Object.assign(gdtslam.view.layers, {floor: true, ceiling: true, grid: false})")
        state = state_of(browser)
        width, height = browser.value("[gdtslam.camera.width, gdtslam.camera.height]")
        browser.value("void (window.kept = gdtslam.picture())")
        background = browser.value("gdtslam.at(window.kept, 2, 2)")
        cy, sy, cp, sp = (f(state[a]) for a in ("yaw", "pitch") for f in (math.cos, math.sin))
        back, right, up = (cp * cy, cp * sy, sp), (-sy, cy, 0.0), (-sp * cy, -sp * sy, cp)
        slope = math.tan(0.35) / min(width, height)
        seen = []
        for point in {p[:3] for p in points}:
            away = [p - t for p, t in zip(point, state["target"])]
            x, y, z = (sum(a * b for a, b in zip(axis, away)) for axis in (right, up, back))
            seen.append((width / 2 + x / (state["distance"] - z) / slope / 2,
                         height / 2 - y / (state["distance"] - z) / slope / 2))
            self.assertNotEqual(browser.value(f"gdtslam.at(window.kept, {seen[-1][0]}, {seen[-1][1]})"), background)
        for x, y in ((x, y) for x in range(5, int(width), 40) for y in range(5, int(height), 40)):
            if min(math.dist((x, y), at) for at in seen) > 25:
                self.assertEqual(browser.value(f"gdtslam.at(window.kept, {x}, {y})"), background, (x, y))

    def test_floor_and_ceiling_go_and_come(self):
        browser = self.open_room()
        self.assertEqual(browser.value("gdtslam.pointsShown()"), len(self.points) - self.ceiling)
        keep_picture(browser)
        browser.value("document.getElementById('layer-floor').click()")
        self.assertEqual(browser.value("gdtslam.pointsShown()"), len(self.points) - self.ceiling - self.floor)
        self.assertGreater(pixels_changed(browser), 5000)
        browser.value("document.getElementById('layer-ceiling').click()")
        self.assertEqual(browser.value("gdtslam.pointsShown()"), len(self.points) - self.floor)

    def test_colours_are_those_of_the_map(self):
        corners = [(x, y, z) for x in (0.0, 4.0) for y in (0.0, 3.0) for z in (0.0, 2.0)]
        points = [(*corner, 0.3 * k, 7.0 * (k * 3 % 8), k * 5 % 8) for k, corner in enumerate(corners)]
        write_cloud(self.path("c.ply"), points)
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"))
        browser = self.open(self.path("c.html"))
        about = PageFile(self.path("c.html")).description
        maps = [base64.b64decode(one["colours"]) for one in about["colour_maps"]]
        browser.value("Object.assign(gdtslam.view.layers, {floor: true, ceiling: true, grid: false})")
        browser.value("gdtslam.view.shading = 0")
        seen = [browser.value(f"gdtslam.camera.pixelOf({list(corner)})") for corner in corners]
        for quantity, column, low, high, index in (("height", 2, -1.0, 2.5, 0), ("elevation", 3, 0.2, 1.5, 1),
                                                   ("time", 4, 0.0, 60.0, 2), ("scan", 5, 1.0, 9.0, 3)):
            browser.value(f"gdtslam.view.quantity = '{quantity}', gdtslam.view.colourMap.{quantity} = {index},"
                          f"gdtslam.view.scale.{quantity} = [{low}, {high}]")
            browser.value("void (window.kept = gdtslam.picture())")
            for point, (x, y, _) in zip(points, seen):
                entry = round(255 * min(max((point[column] - low) / (high - low), 0), 1))
                near = [maps[index][3 * k:3 * k + 3] for k in range(max(entry - 1, 0), min(entry + 2, 256))]
                self.assertIn(bytes(browser.value(f"gdtslam.at(window.kept, {x}, {y})")), near, (quantity, point))

    def test_the_cloud_appears_as_measured(self):
        browser = self.open_room()
        first = [p[4] for p in self.points]
        for share in (0.25, 0.6):
            browser.value(f"gdtslam.timeline.set({share})")
            stamp = min(first) + share * (max(max(first), 150.0) - min(first))
            expected = sum(1 for p in self.points if p[4] <= stamp and p[2] < 2.45)
            self.assertAlmostEqual(browser.value("gdtslam.pointsShown()"), expected, delta=2)
        pose = browser.value("gdtslam.cloudView.path.poseAt(100 + 0.5 * 20.5)")
        origin = PageFile(self.page).description["origin"]
        self.assertAlmostEqual(pose["x"] + origin[0], 11 + 0.04 * 20.5, delta=1e-4)
        self.assertAlmostEqual(pose["y"] + origin[1], -19 + 0.02 * 20.5, delta=1e-4)
        browser.value("gdtslam.timeline.set(0); document.getElementById('play').click()")
        browser.wait_for("gdtslam.view.until > 0.005", 60)


class ControlsTest(FlatPages, BrowserCase):
    def test_left_drag_turns_as_far_as_it_goes(self):
        browser = self.open_room()
        before, picture = state_of(browser), browser.screenshot()
        browser.drag((400, 400), (500, 350))
        browser.settle()
        after = state_of(browser)
        turned = (before["yaw"] - after["yaw"] + math.pi) % (2 * math.pi) - math.pi
        self.assertAlmostEqual(turned, math.radians(30), places=6)  # 100 pixels
        self.assertAlmostEqual(before["pitch"] - after["pitch"], math.radians(15), places=6)
        self.assertEqual((after["distance"], after["target"]), (before["distance"], before["target"]))
        self.assertNotEqual(browser.screenshot(), picture)
        self.assert_quiet(browser)

    def test_wheel_zooms_towards_the_cursor(self):
        browser = self.open_room()
        left, top, _, _ = browser.box("#scene")
        before = state_of(browser)
        browser.wheel(500, 500, -200)
        browser.wait_for("gdtslam.pointer.anchor")
        after = state_of(browser)
        self.assertAlmostEqual(after["distance"] / before["distance"], math.exp(-200 * 0.0016), places=6)
        seen = browser.value("gdtslam.camera.pixelOf(gdtslam.pointer.anchor)")
        self.assertAlmostEqual(seen[0], 500 - left, delta=14)
        self.assertAlmostEqual(seen[1], 500 - top, delta=14)

    def test_picked_points_and_their_distance(self):
        browser = self.open_room()
        left, top, _, _ = browser.box("#scene")

        def click_on(point):
            x, y, _ = browser.value(f"gdtslam.camera.pixelOf([{point[0]} - 10, {point[1]} + 20, {point[2]}])")
            browser.click(left + x, top + y)
            return browser.value("gdtslam.picks.points.at(-1).position")
        browser.value("gdtslam.cloudView.flyTo(gdtslam.cloudView.fitted({yaw: -Math.PI / 2, pitch: Math.PI / 2}))")
        browser.wait_for("!gdtslam.cloudView.flight")
        one, other = (13.0, -18.0, 0.0), (15.0, -17.0, 0.0)
        self.assertLess(math.dist(click_on(one), (3.0, 2.0, 0.0)), 0.003)
        text = browser.value("document.getElementById('readout').innerText")
        for word in ("13.000 m", "−18.000 m", "0.000 m", "elevation"):
            self.assertIn(word, text)
        browser.value("document.getElementById('measure').click()")
        click_on(one)
        click_on(other)
        self.assertIn("Distance 2.236 m", browser.value("document.getElementById('readout').innerText"))
        self.assert_quiet(browser)

    def test_keys_and_presets(self):
        browser = self.open_room()
        before = state_of(browser)
        browser.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowLeft")
        self.assertAlmostEqual(state_of(browser)["yaw"] - before["yaw"], math.radians(9), places=6)
        for key, yaw, pitch in (("1", -90, 90), ("4", 0, math.degrees(0.04))):
            browser.key(key)
            browser.wait_for("gdtslam.cloudView.flight === null")
            self.assertAlmostEqual(math.degrees(state_of(browser)["yaw"]), yaw, places=4)
            self.assertAlmostEqual(math.degrees(state_of(browser)["pitch"]), pitch, places=4)
        browser.key("t")
        self.assertTrue(browser.value("gdtslam.theme.isDark()"))
        browser.key("?")
        self.assertTrue(browser.value("document.getElementById('help').open"))
        self.assert_quiet(browser)

    def test_nothing_overlaps_from_small_to_large(self):
        browser = self.open_room()
        for width, height in ((600, 800), (900, 600), (1280, 720), (3840, 2160)):
            browser.resize(width, height)
            browser.value("document.querySelector('[data-stage=both]').click()")
            browser.settle()
            boxes = browser.value("""[...document.querySelectorAll('#top > *, #tools > *, #stages > *, #timeline > *,' +
                '#main > *, #mechanism, #linkage-side > *')].filter((e) => e.getClientRects().length).map((e) => {
                const {left, top, right, bottom} = e.getBoundingClientRect();
                return [e.id || e.textContent, left, top, right, bottom, e.parentElement.id]; })""")
            for k, (name, left, top, right, bottom, parent) in enumerate(boxes):
                self.assertGreater(right - left, 1, name)
                self.assertLessEqual(right, width + 0.5, (name, width))
                for other, l2, t2, r2, b2, parent2 in boxes[k + 1:]:
                    is_apart = right <= l2 + 0.5 or r2 <= left + 0.5 or bottom <= t2 + 0.5 or b2 <= top + 0.5
                    self.assertTrue(is_apart or parent != parent2, (name, other, width))
        self.assert_quiet(browser)

    def test_picture_is_saved(self):
        browser = self.open_room()
        browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=self.folder.name)
        browser.value("document.getElementById('save').click()")
        for _ in range(100):
            if os.path.exists(self.path("gdtslam.png")):
                break
            browser.settle()
        with open(self.path("gdtslam.png"), "rb") as file:
            head = file.read(24)
        self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n")
        size = [int.from_bytes(head[k:k + 4], "big") for k in (16, 20)]
        self.assertEqual(size, [round(side) for side in browser.box("#scene")[2:]])


class LinkageTest(BrowserCase):
    def open_linkage(self):
        make_page(self.path("l.html"), "--title", "paper-b", "--linkage", "paper-b")
        self.about = PageFile(self.path("l.html")).description["linkage"]
        return self.open_plain(self.path("l.html"))

    def open_plain(self, path):
        browser = chromium.Browser(1000, 700)
        self.addCleanup(browser.close)
        browser.open(path)
        return browser

    def test_plays_and_pauses(self):
        browser = self.open_linkage()
        first = browser.value("gdtslam.linkageView.step")
        browser.wait_for(f"gdtslam.linkageView.step > {first} + 5")
        browser.value("document.getElementById('crank-play').click()")
        stopped = browser.value("gdtslam.linkageView.step")
        picture = browser.screenshot()
        browser.settle()
        self.assertEqual(browser.value("gdtslam.linkageView.step"), stopped)
        browser.value("gdtslam.linkageView.moveTo(400)")
        browser.settle()
        self.assertNotEqual(browser.screenshot(), picture)
        self.assert_quiet(browser)
        self.assertTrue(browser.value("document.getElementById('cloud-stage').hidden"))

    def test_joints_and_numbers_are_the_linkage_s(self):
        browser = self.open_linkage()
        browser.value("gdtslam.linkageView.toggle(false)")
        for step in (0, 17.25, 300.5, 719.9):
            pose = browser.value(f"gdtslam.linkageView.moveTo({step}), gdtslam.linkageView.linkage.at({step})")
            expected = expected_row(self.about, step)
            got = (*pose["a"], *pose["b"], *pose["middle"], pose["elevation"], pose["transmission"])
            for k, (value, reference) in enumerate(zip(got, expected)):
                self.assertAlmostEqual(value, reference, delta=1e-5 if k < 6 else 2e-4)
            shown = browser.value("document.getElementById('value-elevation').textContent")
            self.assertAlmostEqual(float(shown.strip("°").replace("−", "-")), math.degrees(expected[6]), delta=0.06)


class RobustTest(BrowserCase):
    def test_hostile_words_are_shown_as_words(self):
        browser = self.open_room("--title", HOSTILE, "--subtitle", HOSTILE, "--fact", HOSTILE + "=" + HOSTILE)
        self.assertEqual(browser.value("document.title"), HOSTILE)
        self.assertEqual(browser.value("document.getElementById('title').textContent"), HOSTILE)
        self.assertIn(HOSTILE, browser.value("document.getElementById('panel').textContent"))
        self.assertEqual(browser.value("document.images.length"), 0)
        self.assert_quiet(browser)

    def test_says_so_where_there_is_no_webgl(self):
        browser = self.open_room_without_webgl()
        self.assertIn("WebGL 2", browser.value("document.getElementById('message').innerText"))
        self.assertEqual(browser.value("gdtslam.errors"), [])
        browser.value("document.querySelector('[data-stage=linkage]').click()")  # which needs none
        browser.wait_for("gdtslam.linkageView.step > 3")

    def open_room_without_webgl(self):
        page = make_room_page(self.folder.name)[0]
        browser = chromium.Browser(1000, 700, ["--disable-3d-apis"])
        self.addCleanup(browser.close)
        browser.open(page)
        return browser

    def test_path_alone_and_one_point(self):
        make_room_page(self.folder.name)
        make_page(self.path("p.html"), "--path", self.path("room.tum"))
        self.assert_quiet(self.open(self.path("p.html")))
        write_cloud(self.path("c.ply"), [(1.0, 2.0, 3.0, 0.0, 5.0, 0)])
        make_page(self.path("c.html"), "--cloud", self.path("c.ply"))
        browser = self.open(self.path("c.html"))
        self.assert_quiet(browser)
        self.assertEqual(browser.value("gdtslam.pointsShown()"), 1)


def tests_of(group):
    case = {"scene": SceneTest, "controls": ControlsTest, "linkage": LinkageTest, "robust": RobustTest}[group]
    return unittest.defaultTestLoader.loadTestsFromTestCase(case)
