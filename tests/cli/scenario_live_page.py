"""The page of `live` from the side of those who should not have it: who may ask, and what the page may do."""

import base64
import http.client
import json
import re
import resource
import socket
import subprocess
import zlib

import cli_support as cli
from cli_support import PROGRAM, RUN, expect
from content_policy import Inline, faults_of
from scenario_continue import expect_same_run, lines_of_drive
from scenario_live import mapped_by_pipe
from scenario_live_inputs import wait_until

# Longer than many a buffer for a header; a host may have 253 letters.
LONG = ".".join(["a" * 63] * 3 + ["b" * 61])


class Page:
    """A drive with a page; nothing is sent."""

    def __init__(self, address, *arguments, **options):
        self.drive = subprocess.Popen([PROGRAM, "live", "-", "--page", address, *map(str, arguments)], stdin=subprocess.PIPE,
                                      stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **options)
        line = self.drive.stderr.readline()
        found = re.search(r"http://(\S+):(\d+)/", line)
        expect(found, f"no page: {line!r}")
        self.host, self.port = found.group(1), int(found.group(2))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        has_failed = self.drive.poll() not in (None, 0)
        self.drive.kill()
        self.drive.wait()
        expect(not has_failed, "the drive did not outlive its visitors")

    def ask(self, host=None, path="/", **headers):
        """Status (None: the connection was closed), headers and bytes."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20 * cli.SLOWNESS)
        try:
            connection.putrequest("GET", path, skip_host=True, skip_accept_encoding=True)
            for name, value in {"Host": host or f"127.0.0.1:{self.port}", **headers}.items():
                connection.putheader(name, value)
            connection.endheaders()
            answer = connection.getresponse()
            return answer.status, dict((k.lower(), v) for k, v in answer.getheaders()), answer.read() if answer.status == 200 else b""
        except (http.client.HTTPException, ConnectionError):
            return None, {}, b""
        finally:
            connection.close()

    def expect_refused(self, **request):
        for path in ("/", "/scan/0", "/map"):
            expect(self.ask(path=path, **request)[0] != 200, f"{path} for {request}")


def live_page_is_for_this_host():
    """Pages of other sites get nothing, by whatever name and however long it is; ours do."""
    with Page("0", "-o", cli.fresh_folder("live_page") / "run") as page:
        ours, port = f"127.0.0.1:{page.port}", page.port
        expect(page.host == "127.0.0.1", page.host)
        for host in (ours, f"localhost:{port}"):
            for path in ("/", "/scan/0"):
                expect(page.ask(host, path)[0] == 200, f"{path} for {host}")
        for host in (f"evil.example:{port}", f"127.0.0.1.evil.example:{port}", f"{LONG}:{port}", f"192.168.1.7:{port}",
                     f"{socket.gethostname()}:{port}", f"127.0.0.1@evil.example:{port}"):
            page.expect_refused(host=host)
        for origin in ("http://evil.example", "null", f"https://{ours}", f"http://{ours}.evil.example", "http://" + "a" * 2000,
                       f"http://{ours}, http://evil.example", f"http://127.0.0.1:{port + 1}"):
            page.expect_refused(Origin=origin)
        for path in ("/etc/passwd", "/../../etc/passwd", "/%2e%2e/", "/map"):
            expect(b"root:" not in page.ask(path=path)[2], path)


def live_page_for_others():
    """At an address that others reach: by an address in numbers or this host's own name, by no name of another domain."""
    with Page("0.0.0.0:0", "-o", cli.fresh_folder("live_page_others") / "run") as page:
        own = socket.gethostname()
        for host in ("127.0.0.1", "localhost", "192.168.1.7", "[fd00::1]", own, f"{own}.local"):
            expect(page.ask(f"{host}:{page.port}")[0] == 200, f"no page for {host}")
        for host in ("evil.example", f"{own}.evil.example", "1.2.3.4.evil.example", "[fd00::1", "1.2.3", LONG):
            page.expect_refused(host=f"{host}:{page.port}")


def live_page_shows_the_map_that_is_followed():
    """The page of a drive in a run shows floor and walls of that run's occupancy map; in a field of distances, walls."""
    width, height = map(int, (RUN / "map.pgm").read_bytes().split(b"\n", 2)[1].split())
    cells = (RUN / "map.pgm").read_bytes()[-width * height:]  # 0 occupied, 254 free, 205 unknown
    for map_of in (RUN, RUN / "map.yaml", RUN / "gdt.yaml"):
        with Page("0", "--map", map_of) as page:
            wait_until(lambda: page.ask(path="/map")[0] == 200, "the map of the page")
            about = json.loads(zlib.decompress(page.ask(path="/map")[2]))
        packed, shape = base64.b64decode(about["elements"]["map"]), about["map"]
        states = [packed[k >> 2] >> 2 * (k & 3) & 3 for k in range(shape["width"] * shape["height"])]
        if map_of == RUN / "gdt.yaml":
            expect(0.2 * cells.count(0) < states.count(2) < 2.0 * cells.count(0), f"{states.count(2)} cells of walls")
            continue
        rows = [cells[k:k + width] for k in range(0, len(cells), width)]
        expect(states == [{0: 2, 254: 1, 205: 0}[cell] for row in reversed(rows) for cell in row], f"{map_of}: another map")


def live_page_policy():
    """The page runs its own script only, is shown in no other page, and its bytes are for no other site."""
    with Page("0", "-o", cli.fresh_folder("live_page_policy") / "run") as page:
        _, headers, text = page.ask()
        faults = faults_of(text.decode())
        expect(not faults, f"{faults}")
        for rule in ("base-uri 'none'", "form-action 'none'", "connect-src 'self'"):
            expect(rule in Inline(text.decode()).policy, f"no {rule}")
        for name, value in (("content-security-policy", "frame-ancestors 'none'"), ("x-content-type-options", "nosniff"),
                            ("cross-origin-resource-policy", "same-origin"), ("referrer-policy", "no-referrer"), ("cache-control", "no-store")):
            expect(headers.get(name) == value, f"{name}: {headers.get(name)}")
        expect("access-control-allow-origin" not in headers, f"{headers}")


def live_page_bears_rude_visitors():
    """Connections that say nothing, half a request, endless headers, bytes that are none, and more of them than the process may
    have descriptors: the drive ends as one without a page."""
    folder = cli.fresh_folder("live_page_rude")
    lines = lines_of_drive(60)
    mapped_by_pipe(folder / "map", lines)
    most = 256
    with Page("0", "-o", folder / "run", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))) as page:
        page.drive.stdin.write("".join(lines[:40]))
        page.drive.stdin.flush()
        held = []

        def visit(text):
            held.append(socket.create_connection(("127.0.0.1", page.port), timeout=20 * cli.SLOWNESS))
            try:
                held[-1].sendall(text)
            except ConnectionError:
                pass
        for text in [b""] * 60 + [b"GET / HTT", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)),
                                  b"GET / HTTP/1.1\r\nHost: " + b"a" * 100000, b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 5000]:
            visit(text)
        expect(page.ask()[0] == 200, "no page beside 64 rude visitors")
        for _ in range(most + 50):
            visit(f"GET /scan/0 HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\n\r\n".encode())
        _, stderr = page.drive.communicate("".join(lines[40:]), timeout=60 * cli.SLOWNESS)
        expect(page.drive.returncode == 0, stderr)
        expect_same_run(folder / "run", folder / "map", "with visitors")
        for connection in held:
            connection.close()
