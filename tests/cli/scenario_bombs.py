"""Small files of every format that stand for gigabytes or for hours: each ends in one line, and is held against the most
memory and CPU time that docs/formats.md allows. tools/scripts/bombs.py prints what each took."""

import bz2
import ctypes
import gzip
import lzma
import os
import re
import resource
import sqlite3
import struct
import threading
import zlib
from typing import NamedTuple

import cli_support as cli
from cli_support import expect, one_error_line

MB = 1 << 20
HEAD = "gdtslam_scene: 1\n"
PLACE = "waypoints: [{at: [0, 0], pause: 1 s}]\n"


class Bomb(NamedTuple):
    """A file, what reads it, and what that comes to. `most_mb` is of the whole process, `most_s` of its CPU."""
    name: str
    make: object  # called with the folder; returns the arguments of the command, the first path among them the bomb
    code: int
    pattern: str
    most_mb: int = 100
    most_s: float = 3.0


def packed_by_zstd(data):
    library = ctypes.CDLL("libzstd.so.1")
    for function in (library.ZSTD_compressBound, library.ZSTD_compress):
        function.restype = ctypes.c_size_t
    bound = library.ZSTD_compressBound(ctypes.c_size_t(len(data)))
    target = ctypes.create_string_buffer(bound)
    size = library.ZSTD_compress(target, ctypes.c_size_t(bound), data, ctypes.c_size_t(len(data)), 1)
    return target.raw[:size]


def deflated(head, piece, times, tail=b""):
    """A raw deflate stream of the head, the piece so many times and the tail, made in no time: blocks that refer to none
    before can be repeated."""

    def block(data):
        packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
        return packer.compress(data) + packer.flush(zlib.Z_FULL_FLUSH)

    return block(head) + block(piece) * times + block(tail) + b"\x03\0"


def gzipped(head, piece, times):
    checksum = zlib.crc32(head)
    for _ in range(times):
        checksum = zlib.crc32(piece, checksum)
    size = len(head) + times * len(piece)
    return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + deflated(head, piece, times) + struct.pack("<II", checksum, size & 0xFFFFFFFF)


def of(command, name, content, *options):
    """The arguments for a file that the command reads."""

    def make(folder):
        (folder / name).write_bytes(content() if callable(content) else content)
        return [command, folder / name, *options]

    return make


def log_of(name, content):
    def make(folder):
        (folder / name).write_bytes(content())
        return ["map", folder / name, "-o", folder / "run", "-q"]

    return make


# ---- YAML: configurations, scenes, descriptions of maps ---------------------------------------------------------------


def configuration(text):
    def make(folder):
        (folder / "config.yaml").write_text(text())
        return ["config", "show", "--config", folder / "config.yaml"]

    return make


def scene(text):
    def make(folder):
        (folder / "scene.yaml").write_text(HEAD + text() + PLACE)
        return ["simulate", folder / "scene.yaml", "-o", folder / "drive.log"]

    return make


def laughs():
    """Ten lists, each of ten of the one before."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 11)]
    return "\n".join(lines) + "\n"


def many_keys():
    return "".join(f"k{k}: 1\n" for k in range(90_000))


def repeats():
    row = "{from: 0, width: 1 mm, repeat: {count: 200000, step: 0.002}}"
    return f"walls: [{{points: [[0, 0], [900, 0]], windows: [{', '.join([row] * 300)}]}}]\n"


def aliased_walls():
    points = ", ".join(f"[{k % 100}, {k // 100}]" for k in range(5000))
    return f"walls: [&w {{points: [{points}]}}, {', '.join(['*w'] * 5000)}]\n"


# ---- JSON -------------------------------------------------------------------------------------------------------------


def run_with_report(text):
    def make(folder):
        (folder / "report.json").write_bytes(text())
        return ["evaluate", folder, "--reference", cli.TRUTH]

    return make


def one_object(keys):
    return b"{" + b",".join(b'"k%d":0' % k for k in range(keys)) + b"}"


# ---- Clouds, meshes, trajectories -------------------------------------------------------------------------------------


def lzf_zeros(triples):
    """LZF data of 3 + 264 * triples zeros: three literals, then runs of 264 bytes three bytes back."""
    return b"\x02\0\0\0" + b"\xe0\xff\x02" * triples


def pcd_bomb(triples):
    size = 3 + 264 * triples
    packed = lzf_zeros(triples)
    header = ("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nCOUNT 1 1 1\n"
              f"WIDTH {size // 3}\nHEIGHT 1\nPOINTS {size // 3}\nDATA binary_compressed\n").encode()
    return header + struct.pack("<II", len(packed), size) + packed


PLY = b"ply\nformat binary_little_endian 1.0\n"
CORNERS = b"element vertex 4000000000\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"


def ply_zeros(points):
    """In gzip; points are a multiple of a million, 1 << 20."""
    return gzipped(PLY + CORNERS.replace(b"4000000000", b"%d" % points) + b"end_header\n", bytes(3 * MB), points // MB)


# ---- Pictures ---------------------------------------------------------------------------------------------------------

MAP_YAML = "image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
FIELD_YAML = ("version: 2\nimage: gdt.png\nresolution: 0.05\norigin: [0, 0, 0]\nunit: 0.0000030517578125\nscale: 64\n"
              "cap: 64000\n")


def png(width, height, depth, rows):
    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    header = struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def zlib_zeros(count):
    checksum = count % 65521 << 16 | 1  # Adler-32 of zeros
    return b"\x78\xda" + deflated(b"", bytes(MB), count // MB, bytes(count % MB)) + struct.pack(">I", checksum)


def map_with(name, image):
    def make(folder):
        (folder / name).write_bytes(image())
        (folder / "map.yaml").write_text(MAP_YAML.format(name))
        return ["localize", folder / "map.yaml", cli.LOG, "--scan", 1]

    return make


def field_with(image):
    def make(folder):
        (folder / "gdt.png").write_bytes(image())
        (folder / "gdt.yaml").write_text(FIELD_YAML)
        return ["localize", folder / "gdt.yaml", cli.LOG, "--scan", 1]

    return make


# ---- Recordings -------------------------------------------------------------------------------------------------------

MCAP_MAGIC = b"\x89MCAP0\r\n"


def mcap_record(opcode, content, size=None):
    return struct.pack("<BQ", opcode, len(content) if size is None else size) + content


def mcap_text(text):
    return struct.pack("<I", len(text)) + text


def mcap_chunk(packing, stated, packed, size=None):
    head = struct.pack("<QQQI", 0, 0, stated, 0) + mcap_text(packing) + struct.pack("<Q", len(packed) if size is None else size)
    return mcap_record(0x06, head + packed)


def mcap(*records):
    return MCAP_MAGIC + mcap_record(0x01, mcap_text(b"ros2") + mcap_text(b"")) + b"".join(records)


def mcap_scan(cdr):
    """A file of one message of that content in a topic of scans."""
    schema = mcap_record(0x03, struct.pack("<H", 1) + mcap_text(b"sensor_msgs/msg/LaserScan") + mcap_text(b"ros2msg") + mcap_text(b""))
    channel = mcap_record(0x04, struct.pack("<HH", 1, 1) + mcap_text(b"/scan") + mcap_text(b"cdr") + struct.pack("<I", 0))
    message = mcap_record(0x05, struct.pack("<HIQQ", 1, 0, 10**9, 10**9) + cdr)
    return mcap(schema, channel, message)


def cdr_scan(name_length=2, beams=2):
    stamp = struct.pack("<iI", 1, 0)
    head = b"\0\1\0\0" + stamp + struct.pack("<I", name_length) + b"a\0\0\0"
    return head + struct.pack("<7f", 0, 1, 1, 0, 0, 0, 30) + struct.pack("<I", beams) + struct.pack("<2f", 1, 1)


def bag_record(fields, content, size=None):
    head = b"".join(struct.pack("<I", len(key) + 1 + len(value)) + key + b"=" + value for key, value in fields)
    return struct.pack("<I", len(head)) + head + struct.pack("<I", len(content) if size is None else size) + content


def ros1_bag(*records):
    head = bag_record([(b"op", b"\x03"), (b"index_pos", bytes(8)), (b"conn_count", bytes(4)), (b"chunk_count", bytes(4))], b"")
    return b"#ROSBAG V2.0\n" + head + b"".join(records)


def bag_chunk(packing, stated, packed):
    return bag_record([(b"op", b"\x05"), (b"compression", packing), (b"size", struct.pack("<I", stated))], packed)


def sqlite_bag(folder, change, rows=200):
    """A database of a ROS 2 bag, whose bytes are then changed."""
    path = folder / "bag_0.db3"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)")
        database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        database.execute("INSERT INTO topics VALUES (1, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr', '')")
        database.executemany("INSERT INTO messages VALUES (?, 1, ?, ?)", [(k, k * 10**8, cdr_scan() + bytes(9000)) for k in range(rows)])
        database.execute("DELETE FROM messages WHERE id > ?", (rows // 2,))
    database.close()
    data = bytearray(path.read_bytes())
    path.write_bytes(bytes(change(data)))
    return ["map", path, "-o", folder / "run", "-q"]


def sqlite_cycle(data):
    """Every page of the free list names the first one as the next, and every overflow page itself."""
    page = 4096
    first = struct.unpack_from(">I", data, 32)[0]
    struct.pack_into(">I", data, (first - 1) * page, first)
    for number in range(3, len(data) // page + 1):
        at = (number - 1) * page
        if data[at] == 0 and number != first:  # no page of a tree: an overflow page, whose first bytes are the next one
            struct.pack_into(">I", data, at, number)
    return data


def sqlite_views(folder):
    """What is read is a view that multiplies."""
    path = folder / "bag_0.db3"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)")
        database.execute("INSERT INTO topics VALUES (1, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr', '')")
        database.execute("CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
                         "SELECT id, 1 AS topic_id, id AS timestamp, zeroblob(1000000000) AS data FROM n")
    database.close()
    return ["map", path, "-o", folder / "run", "-q"]


# ---- Text logs --------------------------------------------------------------------------------------------------------

NEWLINES = 16 * MB
# What comes through a pipe; tools/scripts/bombs.py sends more.
PIPED = int(os.environ.get("GDTSLAM_BOMB_MB", "32")) * MB


def piped_newlines(folder):
    """Nothing but line ends through a named pipe, which has no size."""
    pipe = folder / "pipe.log"
    os.mkfifo(pipe)

    def send():
        with open(pipe, "wb", buffering=0) as target:
            try:
                for _ in range(PIPED // MB):
                    target.write(b"\n" * MB)
            except BrokenPipeError:
                pass  # who reads may stop; the exit code and the line are what is asked for

    threading.Thread(target=send, daemon=True).start()
    return ["map", pipe, "-o", folder / "run", "-q"]


def json_line(depth):
    return b'{"stamp":' + b"[" * depth + b"]" * depth + b"}\n"


BOMBS = [
    Bomb("YAML aliases of aliases", configuration(laughs), 78, "config.yaml"),
    Bomb("YAML of 90,000 keys", configuration(many_keys), 78, "config.yaml", 400),
    Bomb("YAML nested 30,000 deep", configuration(lambda: "a: " + "[" * 30_000 + "]" * 30_000 + "\n"), 78, "nested too deeply"),
    Bomb("scene of repeats", scene(repeats), 78, "more than 200000 parts", 200),
    Bomb("scene of aliases", scene(aliased_walls), 78, "more than 200000 parts", 200),
    Bomb("JSON nested 1,000,000 deep", run_with_report(lambda: b"[" * 1_000_000), 65, "nested deeper"),
    Bomb("JSON of 4,000,000 values", run_with_report(lambda: b"[" + b"0," * 4_000_000 + b"0]"), 65, "more than the"),
    Bomb("JSON object of 300,000 keys", run_with_report(lambda: one_object(300_000)), 65, "report.json"),
    Bomb("JSON line nested 100,000 deep", log_of("log.jsonl", lambda: json_line(100_000)), 65, "log.jsonl:1"),
    Bomb("PLY of zeros in gzip", of("measure", "bomb.ply.gz", lambda: ply_zeros(28 * MB), "--planes"), 65, "store the file unpacked", 1000, 10),
    Bomb("PLY of 4,000,000,000 points", of("measure", "bomb.ply", lambda: PLY + CORNERS + b"end_header\n\0\0\0", "--planes"), 65, "bomb.ply"),
    Bomb("PCD of zeros by LZF", of("measure", "bomb.pcd", lambda: pcd_bomb(2_600_000), "--planes"), 65, "store the file unpacked", 1000, 10),
    Bomb("PCD of zeros by LZF in gzip", of("measure", "bomb.pcd.gz", lambda: gzip.compress(pcd_bomb(2_600_000)), "--planes"), 65, "store the file unpacked", 1000, 10),
    Bomb("trajectory in gzip", of("evaluate", "bomb.tum.gz", lambda: gzipped(b"", b"0 0 0 0 0 0 0 1\n" * 65_536, 120), "--reference", cli.TRUTH), 65, "would take", 1000, 10),
    Bomb("PGM of zeros in gzip", map_with("map.pgm.gz", lambda: gzipped(b"P5\n20480 20480\n255\n", bytes(MB), 400)), 65, "would take", 600, 10),
    Bomb("PNG of 2,000,000,000 x 2,000,000,000", map_with("map.png", lambda: png(2_000_000_000, 2_000_000_000, 8, zlib_zeros(1000))), 65, "map.png"),
    Bomb("PNG map of zeros", map_with("map.png", lambda: png(30_000, 30_000, 8, zlib_zeros(30_001 * 30_000))), 65, "would take"),
    Bomb("PNG field of zeros", field_with(lambda: png(20_000, 20_000, 16, zlib_zeros(40_001 * 20_000))), 65, "would take"),
    Bomb("newlines through a pipe", piped_newlines, 65, "pipe.log", 100, 5 * PIPED / (32 * MB)),
    Bomb("gzip of zeros as a log", log_of("log.gz", lambda: gzipped(b"", bytes(MB), NEWLINES // MB)), 65, "log.gz"),
    Bomb("gzip of newlines", log_of("log.gz", lambda: gzipped(b"", b"\n" * MB, NEWLINES // MB)), 65, "log.gz"),
    Bomb("bzip2 of newlines", log_of("log.bz2", lambda: bz2.compress(b"\n" * NEWLINES)), 65, "log.bz2"),
    Bomb("xz of newlines", log_of("log.xz", lambda: lzma.compress(b"\n" * NEWLINES, preset=0)), 65, "log.xz"),
    Bomb("xz with a dictionary of 1.5 GiB", log_of("log.xz", lambda: lzma.compress(b"\n", filters=[{"id": lzma.FILTER_LZMA2, "dict_size": 3 << 29, "preset": 0}])), 65, "128 MiB"),
    Bomb("zstd of newlines", log_of("log.zst", lambda: packed_by_zstd(b"\n" * NEWLINES)), 65, "log.zst"),
    Bomb("MCAP chunk of zstd that states 4 EiB", log_of("log.mcap", lambda: mcap(mcap_chunk(b"zstd", 1 << 62, packed_by_zstd(bytes(NEWLINES))))), 65, "log.mcap"),
    Bomb("MCAP chunk of zstd that states 1 byte", log_of("log.mcap", lambda: mcap(mcap_chunk(b"zstd", 1, packed_by_zstd(bytes(NEWLINES))))), 65, "log.mcap"),
    Bomb("MCAP record of 4 EiB in zstd of zeros", log_of("log.mcap", lambda: mcap(mcap_chunk(b"zstd", 4 * NEWLINES, packed_by_zstd(mcap_record(0x05, bytes(22), 1 << 62) + bytes(4 * NEWLINES - 31))))), 65, "log.mcap", 300),
    Bomb("MCAP chunk longer than the file", log_of("log.mcap", lambda: mcap(mcap_chunk(b"", 1 << 62, bytes(100), 1 << 62))), 65, "log.mcap"),
    Bomb("CDR text of 4 GiB", log_of("log.mcap", lambda: mcap_scan(cdr_scan(name_length=0xFFFFFFFF))), 65, "log.mcap"),
    Bomb("CDR of 4,000,000,000 beams", log_of("log.mcap", lambda: mcap_scan(cdr_scan(beams=0xFFFFFFF0))), 65, "log.mcap"),
    Bomb("bag chunk of bzip2 that states 4 GiB", log_of("log.bag", lambda: ros1_bag(bag_chunk(b"bz2", 0xFFFFFFFF, bz2.compress(bytes(NEWLINES))))), 65, "log.bag"),
    Bomb("bag record of 4 GiB", log_of("log.bag", lambda: ros1_bag(bag_record([(b"op", b"\x02")], b"", 0xFFFFFFFF))), 65, "log.bag"),
    Bomb("SQLite pages in circles", lambda folder: sqlite_bag(folder, sqlite_cycle), 65, "bag_0.db3"),
    Bomb("SQLite view without an end", sqlite_views, 65, "bag_0.db3"),
]


def limit_cpu():
    """What computes for ever is ended by its CPU time, however busy the machine is."""
    resource.setrlimit(resource.RLIMIT_CPU, (60, 60))


def detonate(bomb):
    """Exit code, what was printed, MB, CPU seconds, and the bytes of the largest file."""
    folder = cli.fresh_folder("bombs/" + re.sub("[^a-z0-9]+", "_", bomb.name.lower()))
    arguments = bomb.make(folder)
    size = max((file.stat().st_size for file in folder.rglob("*") if file.is_file()), default=PIPED)
    measured = cli.measured(*arguments, timeout=600, preexec_fn=limit_cpu, env=cli.environment(TMPDIR=str(folder)))
    return *measured, size


def faults_of(bomb, code, text, megabytes, cpu_s):
    """What is not as promised."""
    faults = []
    if code != bomb.code:
        faults.append(f"exit {code} and not {bomb.code}")
    if text.count("\n") != 1 or not text.startswith("gdtslam: error: ") or not re.search(bomb.pattern, text):
        faults.append("not the one line expected")
    if megabytes > bomb.most_mb:
        faults.append(f"{megabytes} MB and not {bomb.most_mb}")
    if cpu_s > bomb.most_s:
        faults.append(f"{cpu_s:.1f} s of CPU and not {bomb.most_s}")
    return faults


def bombs():
    """Each bomb: exit code, one line, peak memory, CPU seconds."""
    if "FAILING_CALLS" not in os.environ:
        cli.skip("a sanitized program needs more time and memory")
    failed = []
    for bomb in BOMBS:
        code, text, megabytes, cpu_s, size = detonate(bomb)
        faults = faults_of(bomb, code, text, megabytes, cpu_s)
        print(f"{bomb.name}: {size} bytes, {megabytes} MB, {cpu_s:.2f} s, exit {code}: {text.strip()[:300]}")
        failed += [f"{bomb.name}: {fault}" for fault in faults]
    expect(not failed, "\n".join(failed))
