"""The page of `live` from the side of those who should not have it: who may ask, and what the page may do."""

import http.client
import json
import re
import socket
import subprocess

import cli_support as cli
from cli_support import PROGRAM, RUN, expect
from content_policy import faults_of
from scenario_render import Png

UPGRADE = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
           "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Protocol": "gdtslam-live"}
# Longer than many a buffer for a header; a host may have 253 letters.
LONG = ".".join(["a" * 63] * 3 + ["b" * 61])


class Page:
    """A drive with a page; nothing is sent."""

    def __init__(self, folder, address):
        self.drive = subprocess.Popen([PROGRAM, "live", "-", "-o", str(folder / "run"), "--page", address],
                                      stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        line = self.drive.stderr.readline()
        found = re.search(r"http://(\S+):(\d+)/", line)
        expect(found, f"no page: {line!r}")
        self.host, self.port = found.group(1), int(found.group(2))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        alive = self.drive.poll() is None
        self.drive.kill()
        self.drive.communicate()
        expect(alive, "the drive did not outlive its visitors")

    def ask(self, host, path="/", method="GET", **headers):
        """Status (None: the connection was closed), headers and text."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20 * cli.SLOWNESS)
        try:
            connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            for name, value in {"Host": host, **headers}.items():
                if value is not None:
                    connection.putheader(name, value)
            connection.endheaders()
            answer = connection.getresponse()
            return answer.status, dict((k.lower(), v) for k, v in answer.getheaders()), answer.read() if answer.status == 200 else b""
        except (http.client.HTTPException, ConnectionError):
            return None, {}, b""
        finally:
            connection.close()

    def upgrade(self, host, origin):
        return self.ask(host, **UPGRADE, **({} if origin is None else {"Origin": origin}))[0]


def live_page_is_for_this_host():
    """Pages of other sites get neither page nor websocket, by whatever name and however long it is; ours do."""
    with Page(cli.fresh_folder("live_page"), "0") as page:
        ours, port = f"127.0.0.1:{page.port}", page.port
        expect(page.host == "127.0.0.1", page.host)
        for host in (ours, f"localhost:{port}"):
            expect(page.ask(host)[0] == 200, host)
            expect(page.upgrade(host, f"http://{host}") == 101, f"a websocket of {host}")
        for host in (f"evil.example:{port}", f"127.0.0.1.evil.example:{port}", f"localhost.evil.example:{port}", "", None,
                     f"{LONG}:{port}", f"192.168.1.7:{port}", f"{socket.gethostname()}:{port}", f"127.0.0.1@evil.example:{port}"):
            expect(page.ask(host)[0] != 200, f"the page for {host}")
            expect(page.upgrade(host, f"http://{host}") != 101, f"a websocket for {host}")
            expect(page.upgrade(host, None) != 101, f"a websocket for {host} without origin")
        for origin in ("http://evil.example", "null", "file://", f"https://{ours}", f"http://{ours}.evil.example", f"http://{LONG}:{port}",
                       f"http://{LONG}", "http://" + "a" * 2000, f"http://{ours}, http://evil.example", f"http://127.0.0.1:{port + 1}"):
            expect(page.upgrade(ours, origin) != 101, f"a websocket for a page of {origin}")
            expect(page.ask(ours, Origin=origin)[0] != 200, f"the page for a page of {origin}")
        for path in ("/etc/passwd", "/../../etc/passwd", "//evil.example/", "/%2e%2e/", "/?a"):
            status, _, text = page.ask(ours, path)
            expect(status != 200 or text == page.ask(ours)[2], f"{path}: {status}")


def live_page_for_others():
    """At an address that others reach: by an address in numbers or this host's own name, by no name of another domain."""
    with Page(cli.fresh_folder("live_page_others"), "0.0.0.0:0") as page:
        own = socket.gethostname()
        for host in ("127.0.0.1", "localhost", "192.168.1.7", "[fd00::1]", own, f"{own}.local"):
            host = f"{host}:{page.port}"
            expect(page.ask(host)[0] == 200, f"no page for {host}")
            expect(page.upgrade(host, f"http://{host}") == 101, f"no websocket for {host}")
        for host in ("evil.example", f"{own}.evil.example", "1.2.3.4.evil.example", "[fd00::1", "1.2.3", LONG):
            host = f"{host}:{page.port}"
            expect(page.ask(host)[0] != 200, f"the page for {host}")
            expect(page.upgrade(host, f"http://{host}") != 101, f"a websocket for {host}")


def map_shown(port, picture):
    """Of the first message of bytes that a watcher gets: its header; and the image, into that file."""
    with socket.create_connection(("127.0.0.1", port), timeout=20 * cli.SLOWNESS) as connection:
        ask = "".join(f"{name}: {value}\r\n" for name, value in {"Host": f"127.0.0.1:{port}", **UPGRADE}.items())
        connection.sendall(f"GET / HTTP/1.1\r\n{ask}\r\n".encode())
        stream = connection.makefile("rb")
        expect(b" 101 " in stream.readline(), "no websocket")
        while stream.readline() != b"\r\n":
            pass
        message = b""
        while True:  # frames of RFC 6455
            first, length = stream.read(2)
            if length >= 126:
                length = int.from_bytes(stream.read(2 if length == 126 else 8), "big")
            body = stream.read(length)
            kind = first & 15 or kind  # 0 goes on with the message before
            message = message + body if first & 15 == 0 else body
            if first & 128 and kind == 2:
                break
    header = 4 + int.from_bytes(message[:4], "little")
    picture.write_bytes(message[header:])
    return json.loads(message[4:header])


def live_page_shows_the_map_that_is_followed():
    """The page of a drive in a run shows floor and walls of that run's occupancy map; in a field of distances, walls."""
    folder = cli.fresh_folder("live_page_map")
    width, height = map(int, (RUN / "map.pgm").read_bytes().split(b"\n", 2)[1].split())
    cells = (RUN / "map.pgm").read_bytes()[-width * height:]  # 0 occupied, 254 free, 205 unknown
    for map_of, also in ((RUN, b"\xff\x80"), (RUN / "map.yaml", b"\xff\x80"), (RUN / "gdt.yaml", b"\x80")):
        drive = subprocess.Popen([PROGRAM, "live", "-", "--map", str(map_of), "--page", "0"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, text=True)
        try:
            port = int(re.search(r"http://\S+:(\d+)/", drive.stderr.readline()).group(1))
            header = map_shown(port, folder / "shown.png")
        finally:
            drive.kill()
            drive.communicate()
        shown = b"".join(Png(folder / "shown.png").rows)
        expect(len(shown) == header["width"] * header["height"] and set(shown) <= {0, *also}, f"{map_of}: {header}, {set(shown)}")
        if map_of != RUN / "gdt.yaml":
            expect(shown == cells.replace(b"\xfe", b"\xff").replace(b"\xcd", b"\x80"), f"{map_of}: another map")
        walls, seen = shown.count(b"\x00"), cells.count(b"\x00")
        expect(0.2 * seen < walls < 2.0 * seen, f"{map_of}: {walls} cells of walls, {seen} in map.pgm")


def live_page_policy():
    """The page runs its own script only, is shown in no other page, and its bytes are for no other site."""
    with Page(cli.fresh_folder("live_page_policy"), "0") as page:
        status, headers, text = page.ask(f"127.0.0.1:{page.port}")
        expect(status == 200, f"{status}")
        policy = headers.get("content-security-policy", "")
        faults = faults_of(text.decode(), policy)
        expect(not faults, f"{faults}")
        for rule in ("frame-ancestors 'none'", "base-uri 'none'", "form-action 'none'", "connect-src 'self'"):
            expect(rule in policy, f"no {rule} in {policy}")
        for name, value in (("x-content-type-options", "nosniff"), ("cross-origin-resource-policy", "same-origin"),
                            ("referrer-policy", "no-referrer"), ("cache-control", "no-store")):
            expect(headers.get(name) == value, f"{name}: {headers.get(name)}")
        expect("access-control-allow-origin" not in headers, f"{headers}")


def live_page_bears_rude_visitors():
    """Connections that say nothing, half a request, endless headers and bytes that are none: the page and the drive go on."""
    with Page(cli.fresh_folder("live_page_rude"), "0") as page:
        ours = f"127.0.0.1:{page.port}"
        held = []
        for text in [b""] * 60 + [b"GET / HTT", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)),
                                  b"GET / HTTP/1.1\r\nHost: " + b"a" * 100000, b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 5000]:
            connection = socket.create_connection(("127.0.0.1", page.port), timeout=20 * cli.SLOWNESS)
            held.append(connection)
            try:
                connection.sendall(text)
            except ConnectionError:
                pass
        expect(page.ask(ours)[0] == 200, "no page beside 64 rude visitors")
        for connection in held:
            connection.close()
