"""Tests of what the page of `live` does by itself with what it hears, for the class of live_test that opens pages."""
import time

RATE = "document.getElementById('rate').textContent"
# A line that brings a sign of life at once and the map 30 s later, on a clock that goes ten times as fast as the wall's.
SLOW_LINE = """(async () => {
  const encoder = new TextEncoder();
  const header = encoder.encode(JSON.stringify({drive: "d", width: 1, height: 1, pixel_m: 1, corner_m: [0, 0], path: []}));
  const blob = await new OffscreenCanvas(1, 1).getContext("2d").canvas.convertToBlob();
  const map = new Uint8Array(4 + header.length + blob.size);
  new DataView(map.buffer).setUint32(0, header.length, true);
  map.set(header, 4);
  map.set(new Uint8Array(await blob.arrayBuffer()), 4 + header.length);
  const now = performance.now.bind(performance);
  performance.now = () => 10 * now();
  window.connections = 0;
  window.WebSocket = class {
    static OPEN = 1;
    constructor() {
      ++window.connections;
      this.open = setTimeout(() => {
        this.readyState = 1;
        this.onopen();
        this.onmessage({data: JSON.stringify({drive: "d", title: "slow"})});
      });
      this.map = setTimeout(() => this.onmessage({data: map.buffer}), 3000);
    }
    close() {
      clearTimeout(this.open);
      clearTimeout(this.map);
    }
  };
  disconnect();
})()"""


class LivePageRules:
    def test_a_map_arrives_though_each_connection_begins_with_a_sign_of_life(self):
        """The page waits 10, 20, then 40 s; and a line that hangs after the map is noticed all the same."""
        browser = self.open()
        browser.value(SLOW_LINE)
        browser.wait_for("/^nothing heard for [0-9]+ s$/.test(state.textContent)")
        browser.wait_for("live.drive === 'd' && live.maps === 1")
        self.assertEqual(browser.value("[connections, patience_s, state.textContent]"), [3, 40, "live"])
        browser.wait_for("patience_s === 80 && state.className === 'gone'")
        self.assertEqual(browser.value("gdtslamLive.errors"), [])

    def test_the_whole_trail_has_one_spacing(self):
        """Of 50 km with a corner, which stays; a robot that stands adds nothing."""
        browser = self.open()
        spacing, distances, to_corner, newest = browser.value("""(() => {
          trail = [];
          for (let k = 0; k <= 100000; ++k) followTrail(k < 50003 ? [k / 2, 0, 0, k] : [25001.5, (k - 50003) / 2, 1.5708, k]);
          const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
          return [trailSpacing_m, trail.slice(1, -1).map((pose, k) => apart(pose, trail[k])),
                  Math.min(...trail.map((pose) => apart(pose, [25001.5, 0]))), trail.at(-1)[3]];
        })()""")
        self.assertTrue(5000 < len(distances) < 20000, len(distances))
        self.assertLess(max(distances), 2 * spacing)
        self.assertLessEqual(sum(distance < spacing for distance in distances), 2)  # at the corner
        self.assertLess(to_corner, spacing / 4)
        self.assertEqual(newest, 100000)
        stood = browser.value("(trail = [], [...Array(1000).keys()].forEach((k) => followTrail([1, 2, k, k])), trail)")
        self.assertEqual(stood, [[1, 2, 0, 0], [1, 2, 999, 999]])

    def test_scans_that_have_stopped_have_no_rate(self):
        """Though the drive gives signs of life; the seconds go on, until a scan comes."""
        browser = self.open()
        self.send(30)
        self.wait_for_all(browser)
        self.assertRegex(browser.value(RATE), r"^[0-9.]+ scans/s$")
        browser.wait_for(f"/^no scan for [0-9]+ s$/.test({RATE})")
        seconds = [browser.value(f"Number({RATE}.split(' ')[3])")]
        time.sleep(3)
        seconds.append(browser.value(f"Number({RATE}.split(' ')[3])"))
        browser.value("takeScan(JSON.stringify(live.scan))")  # the same again, as after a reconnection
        seconds.append(browser.value(f"Number({RATE}.split(' ')[3])"))
        self.assertGreaterEqual(seconds[0], 3)
        self.assertGreaterEqual(seconds[1], seconds[0] + 2)
        self.assertGreaterEqual(seconds[2], seconds[1])
        self.assertEqual(browser.value("state.textContent"), "live")
        self.send(1)
        browser.wait_for(f"/^[0-9.]+ scans.s$/.test({RATE})")

    def test_keys_with_modifiers_are_the_browser_s(self):
        browser = self.open()
        browser.value("""void (window.press = (key, modifiers) => {
          const event = new KeyboardEvent("keydown", {key, cancelable: true, ...modifiers}), before = {...camera};
          canvas.dispatchEvent(event);
          return [event.defaultPrevented, camera.scale / before.scale, camera.x !== before.x];
        })""")
        for modifier in ("ctrlKey", "metaKey", "altKey"):
            for key in ("+", "=", "-", "ArrowLeft", "ArrowRight"):
                self.assertEqual(browser.value(f"press('{key}', {{{modifier}: true}})"), [False, 1, False], (modifier, key))
        self.assertEqual(browser.value("press('ArrowLeft', {})"), [True, 1, True])
        for key, factor in (("+", 1.25), ("=", 1.25), ("-", 0.8)):
            self.assertAlmostEqual(browser.value(f"press('{key}', {{}})")[1], factor, places=9)
