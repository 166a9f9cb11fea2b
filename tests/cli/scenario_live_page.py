"""The page of `live` from the side of those who should not have it: who may ask, and what the page may do."""

import http.client
import re
import socket
import subprocess

import cli_support as cli
from cli_support import PROGRAM, expect
from content_policy import faults_of

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
