# Drives Chromium by the DevTools protocol through pipes (descriptors 3 and 4, messages end in NUL): no other package is
# needed. WebGL 2 runs on SwiftShader, so no graphics processor is needed either.
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1",
    "--host-resolver-rules=MAP * ~NOTFOUND"]


def find_program():
    """The browser's path, or None. CHROMIUM names one."""
    named = os.environ.get("CHROMIUM")
    return named or next((path for path in map(shutil.which, PROGRAMS) if path), None)


class ProtocolError(Exception):
    pass


class Browser:
    """One browser with one page. Requests, console errors and exceptions of the page are collected."""

    def __init__(self, width=1280, height=800, flags=()):
        self.folder = tempfile.TemporaryDirectory(prefix="gdtslam-browser-", ignore_cleanup_errors=True)
        to_browser, self.write_end = os.pipe()
        self.read_end, from_browser = os.pipe()
        self.log = open(os.path.join(self.folder.name, "browser.log"), "wb")

        def place_pipes():  # the browser reads 3 and writes 4
            first, second = os.dup(to_browser), os.dup(from_browser)
            os.dup2(first, 3)
            os.dup2(second, 4)
            os.set_inheritable(3, True)
            os.set_inheritable(4, True)

        environment = {**os.environ, "HOME": self.folder.name}
        environment.pop("DISPLAY", None)
        self.process = subprocess.Popen(
            [find_program(), *FLAGS, *flags, f"--user-data-dir={self.folder.name}/profile",
             f"--window-size={width},{height}", "about:blank"],
            preexec_fn=place_pipes, close_fds=False, env=environment, stdin=subprocess.DEVNULL, stdout=self.log,
            stderr=self.log)
        os.close(to_browser)
        os.close(from_browser)
        self.unread = b""
        self.last_id = 0
        self.session = None
        self.requests = []
        self.errors = []
        self.attach(width, height)

    def attach(self, width, height):
        deadline = time.time() + 30
        while True:
            pages = [t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page"]
            if pages:
                break
            if time.time() > deadline:
                raise ProtocolError("the browser shows no page")
            time.sleep(0.05)
        target = pages[0]["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(domain + ".enable")
        self.resize(width, height)

    def resize(self, width, height, scale=1):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale,
                  mobile=False)

    def call(self, method, timeout_s=120, **parameters):
        self.last_id += 1
        message = {"id": self.last_id, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        deadline = time.time() + timeout_s
        while True:
            answer = self.receive(deadline, method)
            if answer.get("id") == message["id"]:
                if "error" in answer:
                    raise ProtocolError(f"{method}: {answer['error']}")
                return answer["result"]

    def receive(self, deadline, awaited):
        while b"\0" not in self.unread:
            ready = select.select([self.read_end], [], [], max(deadline - time.time(), 0))[0]
            chunk = os.read(self.read_end, 1 << 20) if ready else b""
            if not chunk:
                raise ProtocolError(f"the browser {'ended' if ready else 'does not answer'}: {awaited}")
            self.unread += chunk
        text, self.unread = self.unread.split(b"\0", 1)
        message = json.loads(text)
        self.note(message)
        return message

    def note(self, message):
        method, parameters = message.get("method"), message.get("params", {})
        if method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in parameters["args"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.errors.append(parameters["entry"]["text"])

    def open(self, path, timeout_s=120):
        """Opens a file and waits until the page says that it is ready."""
        self.requests.clear()
        self.errors.clear()
        self.call("Page.navigate", url="file://" + os.path.abspath(path))
        self.wait_for("window.gdtslam && (gdtslam.ready || gdtslam.errors.length > 0)", timeout_s)

    def value(self, expression, timeout_s=120):
        """What an expression is on the page; a promise is awaited."""
        result = self.call("Runtime.evaluate", timeout_s, expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise ProtocolError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait_for(self, expression, timeout_s=30):
        deadline = time.time() + timeout_s
        while not self.value(f"Boolean({expression})"):
            if time.time() > deadline:
                raise ProtocolError(f"waited {timeout_s} s in vain for {expression}; errors: {self.errors}")
            time.sleep(0.05)

    def settle(self):
        """Waits until two frames have been drawn and nothing moves any more."""
        self.value("new Promise((done) => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(done)),"
                   " 260))")

    def screenshot(self, path=None):
        png = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        if path:
            with open(path, "wb") as file:
                file.write(png)
        return png

    def mouse(self, kind, x, y, button="none", clicks=0, modifiers=0, **more):
        buttons = {"none": 0, "left": 1, "right": 2, "middle": 4}[button] if kind != "mouseReleased" else 0
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=clicks,
                  modifiers=modifiers, **more)

    def drag(self, start, end, button="left", steps=8, modifiers=0):
        self.mouse("mouseMoved", *start)
        self.mouse("mousePressed", *start, button=button, clicks=1, modifiers=modifiers)
        for k in range(1, steps + 1):
            at = [a + (b - a) * k / steps for a, b in zip(start, end)]
            self.mouse("mouseMoved", *at, button=button, modifiers=modifiers)
        self.mouse("mouseReleased", *end, button=button, clicks=1, modifiers=modifiers)

    def click(self, x, y, clicks=1):
        self.mouse("mouseMoved", x, y)
        for k in range(1, clicks + 1):
            self.mouse("mousePressed", x, y, button="left", clicks=k)
            self.mouse("mouseReleased", x, y, button="left", clicks=k)

    def wheel(self, x, y, delta):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=delta)

    def key(self, key, text=""):
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=text or (key if len(key) == 1 else ""))
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key)

    def box(self, selector):
        """x, y, width, height of an element in the window."""
        return self.value(f"(({{x, y, width, height}}) => [x, y, width, height])"
                          f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())")

    def close(self):
        try:
            self.session = None
            self.call("Browser.close", 10)
        except (ProtocolError, OSError):
            self.process.kill()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        for end in (self.read_end, self.write_end):
            os.close(end)
        self.log.close()
        self.folder.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
