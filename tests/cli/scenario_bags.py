"""Recordings from end to end: ROS 1 bags, MCAP files and ROS 2 bags, written here by the formats' pages with struct, bz2
and sqlite3, mapped, doctored, piped, cut."""

import bz2
import gzip
import json
import math
import sqlite3
import struct
import subprocess

import cli_support as cli
import recording_reader
from cli_support import command, expect, expect_exit, mapped, one_error_line, results

SCAN, ODOMETRY, TRANSFORM = "sensor_msgs/LaserScan", "nav_msgs/Odometry", "tf2_msgs/TFMessage"


def text(value):
    return struct.pack("<I", len(value)) + value


def fields(**values):
    return b"".join(text(name.encode() + b"=" + value) for name, value in values.items())


def record(data, **header):
    return text(fields(**header)) + text(data)


def stamp(seconds):
    whole = math.floor(seconds)
    return struct.pack("<II", whole, round((seconds - whole) * 1e9))


def connection(number, topic, kind):
    header = fields(topic=topic.encode(), type=kind.encode(), md5sum=b"*", message_definition=b"")
    return record(header, op=b"\x07", conn=struct.pack("<I", number), topic=topic.encode())


def message(number, seconds, data):
    return record(data, op=b"\x02", conn=struct.pack("<I", number), time=stamp(seconds))


def header(seconds, frame):
    return struct.pack("<I", 1) + stamp(seconds) + text(frame.encode())


def scan(seconds, ranges, first=-math.pi / 2, step=math.pi / 180, frame="laser"):
    numbers = struct.pack("<7f", first, -first, step, 0, 0, 0.05, 80.0)
    return header(seconds, frame) + numbers + struct.pack(f"<I{len(ranges)}fI", len(ranges), *ranges, 0)


def pose(x, y, theta):
    return struct.pack("<7d", x, y, 0, 0, 0, math.sin(theta / 2), math.cos(theta / 2))


def odometry(seconds, x, y, theta):
    return header(seconds, "odom") + text(b"base_link") + pose(x, y, theta) + bytes(8 * 78)


def transform(seconds, parent, child, x, y, theta):
    return struct.pack("<I", 1) + header(seconds, parent) + text(child.encode()) + pose(x, y, theta)


def chunk(data, compression="none"):
    packed = bz2.compress(data) if compression == "bz2" else data
    return record(packed, op=b"\x05", compression=compression.encode(), size=struct.pack("<I", len(data)))


def bag(*parts):
    start = record(b" " * 100, op=b"\x03", index_pos=bytes(8), conn_count=bytes(4), chunk_count=bytes(4))
    return b"#ROSBAG V2.0\n" + start + b"".join(parts)


class Cdr:
    """Values aligned to their own size behind the first four bytes, as ROS 2 writes them."""

    def __init__(self):
        self.bytes = b""

    def put(self, kind, *values):
        for value in values:
            size = struct.calcsize(kind)
            self.bytes += bytes(-len(self.bytes) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, value):
        self.put("I", len(value) + 1)
        self.bytes += value.encode() + b"\0"
        return self

    def header(self, seconds, frame):
        whole = math.floor(seconds)
        return self.put("i", whole).put("I", round((seconds - whole) * 1e9)).text(frame)

    def done(self):
        return b"\0\1\0\0" + self.bytes


def cdr_scan(seconds, ranges, first=-math.pi / 2, step=math.pi / 180):
    message = Cdr().header(seconds, "laser").put("f", first, -first, step, 0, 0, 0.05, 80.0).put("I", len(ranges))
    return message.put("f", *ranges).put("I", 0).done()


def cdr_pose(message, x, y, theta):
    return message.put("d", x, y, 0, 0, 0, math.sin(theta / 2), math.cos(theta / 2))


def cdr_odometry(seconds, x, y, theta):
    return cdr_pose(Cdr().header(seconds, "odom").text("base_link"), x, y, theta).put("d", *[0.0] * 78).done()


def cdr_transform(seconds, parent, child, x, y, theta):
    return cdr_pose(Cdr().put("I", 1).header(seconds, parent).text(child), x, y, theta).done()


def ros2_messages():
    """(topic, seconds, bytes) of the drive."""
    rows = [(2, 100.0, cdr_transform(0, "base_link", "laser", 0, 0, 0))]
    for seconds, x, y in drive():
        rows += [(0, seconds, cdr_scan(seconds, cli.room_ranges(x, y, 0.0))), (1, seconds, cdr_odometry(seconds, x, y, 0.0))]
    return rows


ROS2_TOPICS = [("/scan", "sensor_msgs/msg/LaserScan"), ("/odom", "nav_msgs/msg/Odometry"),
               ("/tf_static", "tf2_msgs/msg/TFMessage")]


def mcap(rows):
    def part(kind, content):
        return bytes([kind]) + struct.pack("<Q", len(content)) + content

    data = b"\x89MCAP0\r\n" + part(1, text(b"ros2") + text(b""))
    for number, (topic, kind) in enumerate(ROS2_TOPICS):
        data += part(3, struct.pack("<H", number + 1) + text(kind.encode()) + text(b"") + text(b""))
        data += part(4, struct.pack("<HH", number, number + 1) + text(topic.encode()) + text(b"cdr") + bytes(4))
    for number, seconds, content in rows:
        time = round(seconds * 1e9)
        data += part(5, struct.pack("<HIQQ", number, 0, time, time) + content)
    return data + part(15, bytes(4)) + part(2, bytes(20)) + b"\x89MCAP0\r\n"


def database(file, rows, topics=tuple(ROS2_TOPICS)):
    with sqlite3.connect(file) as bag_file:
        bag_file.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
        bag_file.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        for number, (topic, kind) in enumerate(topics):
            bag_file.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr')", (number, topic, kind))
        for number, seconds, content in rows:
            bag_file.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                             (number, round(seconds * 1e9), content))
    bag_file.close()
    return file


def database_of_log(file, log=cli.LOG):
    """The messages that `convert` writes of a log, as a database of ROS 2."""
    whole = file.with_name(f"{file.name}.mcap")
    expect_exit(command("convert", log, "-o", whole, "-q", "--force"), 0)
    messages = recording_reader.mcap_messages(whole.read_bytes())
    whole.unlink()
    topics = list(dict.fromkeys((topic, kind) for topic, kind, *_ in messages))
    return database(file, [(topics.index((topic, kind)), ns * 1e-9, data) for topic, kind, ns, data in messages], topics)


def drive():
    """Poses of a drive through the room of the cases; headings stay 0, so that a quaternion says them without rounding."""
    return [(100.0 + 0.25 * k, 1.0 + 0.05 * k, 1.5 + 0.02 * k) for k in range(40)]


def drive_records(step=1):
    data = connection(0, "/scan", SCAN) + connection(1, "/odom", ODOMETRY) + connection(2, "/tf_static", TRANSFORM)
    data += message(2, 100.0, transform(0, "base_link", "laser", 0, 0, 0))
    for seconds, x, y in drive()[::step]:
        data += message(0, seconds, scan(seconds, cli.room_ranges(x, y, 0.0))) + message(1, seconds, odometry(seconds, x, y, 0.0))
    return data


STATED = ("--set", "log.bearings=stated", "--set", "log.first_bearing=-90deg", "--set", "log.bearing_step=1deg", "--set",
          "log.max_range=80m")


def carmen_drive(folder):
    """What mapping the drive as a CARMEN log gives."""
    lines = ""
    for seconds, x, y in drive():
        ranges = struct.unpack("<180f", struct.pack("<180f", *cli.room_ranges(x, y, 0.0)))
        words = " ".join(repr(value) for value in ranges)
        lines += f"FLASER 180 {words} {x!r} {y!r} 0 {x!r} {y!r} 0 {seconds!r} robot {seconds!r}\n"
    (folder / "a.log").write_text(lines)
    return results(mapped(folder / "log", *STATED, log=folder / "a.log"))


def bag_is_mapped_as_its_carmen_log():
    """The same numbers in both formats give the same map and poses, byte for byte, packed or not, from a file or a pipe."""
    folder = cli.fresh_folder("bag_is_mapped_as_its_carmen_log")
    expected = carmen_drive(folder)
    data = drive_records()
    bags = {"a.bag": bag(chunk(data)), "b.bag": bag(chunk(data, "bz2")), "c": gzip.compress(bag(chunk(data, "bz2")))}
    for name, content in bags.items():
        (folder / name).write_bytes(content)
        report = mapped(folder / f"run-{name}", *STATED, log=folder / name)
        expect(results(report) == expected, f"{name}: another map or path than of the CARMEN log")
        expect(report["warnings"] == {}, f"{name}: {report['warnings']}")
    process = subprocess.run([cli.PROGRAM, "map", "-", "-o", str(folder / "piped"), "--json", *STATED], input=bags["b.bag"],
                             capture_output=True, check=False)
    expect(process.returncode == 0, process.stderr.decode())
    expect(results(json.loads(process.stdout)) == expected, "another map from the pipe")


def ros2_is_mapped_as_its_carmen_log():
    """Likewise as MCAP, from a file or a pipe, and as a ROS 2 bag: a folder of two files, or one file by itself."""
    folder = cli.fresh_folder("ros2_is_mapped_as_its_carmen_log")
    expected = carmen_drive(folder)
    rows = ros2_messages()
    (folder / "a.mcap").write_bytes(mcap(rows))
    database(folder / "a.db3", rows)
    (folder / "split").mkdir()
    database(folder / "split" / "split_9.db3", rows[:40])
    database(folder / "split" / "split_10.db3", rows[40:])
    (folder / "split" / "metadata.yaml").write_text("rosbag2_bagfile_information: {relative_file_paths: [split_9.db3, split_10.db3]}\n")
    for name in ("a.mcap", "a.db3", "split"):
        report = mapped(folder / f"run-{name}", *STATED, log=folder / name)
        expect(results(report) == expected, f"{name}: another map or path than of the CARMEN log")
        expect(report["warnings"] == {}, f"{name}: {report['warnings']}")
    with open(folder / "a.mcap", "rb") as pipe:
        process = subprocess.run([cli.PROGRAM, "map", "-", "-o", str(folder / "piped"), "--json", *STATED], stdin=pipe,
                                 capture_output=True, check=False)
    expect(process.returncode == 0, process.stderr.decode())
    expect(results(json.loads(process.stdout)) == expected, "another map from the pipe")
    with open(folder / "a.db3", "rb") as pipe:
        process = subprocess.run([cli.PROGRAM, "map", "-", "-o", str(folder / "no")], stdin=pipe, capture_output=True,
                                 text=True, check=False)
    expect_exit(process, 65)
    one_error_line(process.stderr)
    process = command("map", folder / "a.mcap", "--mount", "1,2", "-o", folder / "no")
    expect_exit(process, 2)
    report = mapped(folder / "stated", *STATED, "--mount", "0.5m,0,0", "--odom", "odom", log=folder / "a.mcap")
    expect(results(report) != expected, "the mount that was stated changes nothing")


def bag_faults():
    """Cut, damaged and ambiguous bags: what is read of them, and one line with the right exit code."""
    folder = cli.fresh_folder("bag_faults")
    data = drive_records()
    whole = bag(chunk(data))

    def refused(code, content, *arguments, says=()):
        (folder / "a.bag").write_bytes(content)
        process = command("map", folder / "a.bag", "-o", folder / "run", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(all(part in process.stderr for part in ("a.bag", *says)), process.stderr)
        expect(not (folder / "run").exists(), "something was written")

    (folder / "cut.bag").write_bytes(whole[: len(whole) * 3 // 4])
    report = mapped(folder / "cut", log=folder / "cut.bag")
    expect(report["warnings"]["cut bag"] == 1, f"{report['warnings']}")
    expect(20 < report["scans"] < 40, f"{report['scans']} scans of a cut bag")
    refused(65, whole[:13], says=("LaserScan",))
    refused(65, b"#ROSBAG V1.2\n" + whole[13:], says=("2.0",))
    refused(65, bag(chunk(data, "bz2").replace(b"BZh9", b"BZx9")), says=("--lenient",))
    refused(65, bag(chunk(data).replace(b"=none", b"=zip1")), says=("bz2",))
    refused(65, bag(chunk(connection(0, "/camera", "sensor_msgs/Image") + message(0, 1.0, b"x"))), says=("/camera", "LaserScan"))
    two = data + connection(7, "/rear", SCAN) + message(7, 200.0, scan(200.0, [1.0] * 180))
    refused(2, bag(chunk(two)), says=("/scan", ", 40 at 4.0 Hz)", "/rear", ", 1)", "--topic"))
    refused(2, whole, "--topic", "/rear", says=("/rear", "/scan"))
    (folder / "two.bag").write_bytes(bag(chunk(two)))
    expect(mapped(folder / "two", "--topic", "/scan", log=folder / "two.bag")["scans"] == 40, "scans of one of two topics")
    process = command("doctor", folder / "two.bag", "--topic", "/scan", "--json")
    expect_exit(process, 0)
    found = json.loads(process.stdout)
    expect(found["scans"] == 40, f"{found}")
