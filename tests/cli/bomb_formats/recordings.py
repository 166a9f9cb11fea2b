"""Bombs of recordings: MCAP, ROS bags, databases of ROS 2, and messages in them."""

import bz2
import sqlite3
import struct

from bomb_formats.bomb import MB, Bomb, log_of, packed_by_zstd

NEWLINES = 16 * MB

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


def mcap_message(kind, cdr):
    """A file of one message of that kind."""
    schema = mcap_record(0x03, struct.pack("<H", 1) + mcap_text(kind) + mcap_text(b"ros2msg") + mcap_text(b""))
    channel = mcap_record(0x04, struct.pack("<HH", 1, 1) + mcap_text(b"/a") + mcap_text(b"cdr") + struct.pack("<I", 0))
    return mcap(schema, channel, mcap_record(0x05, struct.pack("<HIQQ", 1, 0, 10**9, 10**9) + cdr))


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


TOPICS = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)"
MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)"
ONE_TOPIC = "INSERT INTO topics VALUES (1, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr', '')"


def sqlite_of(folder, *statements):
    """A database of a ROS 2 bag by these statements, each alone or with the rows that it is for."""
    path = folder / "bag_0.db3"
    with sqlite3.connect(path) as database:
        for statement in statements:
            if isinstance(statement, tuple):
                database.executemany(*statement)
            else:
                database.execute(statement)
    database.close()
    return ["map", path, "-o", folder / "run", "-q"]


def sqlite_cycle(folder):
    """Every page of the free list names the first one as the next, and every overflow page itself."""
    rows = [(k, k * 10**8, cdr_scan() + bytes(9000)) for k in range(200)]
    arguments = sqlite_of(folder, TOPICS, MESSAGES, ONE_TOPIC, ("INSERT INTO messages VALUES (?, 1, ?, ?)", rows),
                          "DELETE FROM messages WHERE id > 100")
    data, page = bytearray(arguments[1].read_bytes()), 4096
    first = struct.unpack_from(">I", data, 32)[0]
    struct.pack_into(">I", data, (first - 1) * page, first)
    for number in range(3, len(data) // page + 1):
        at = (number - 1) * page
        if data[at] == 0 and number != first:  # no page of a tree: an overflow page, whose first bytes are the next one
            struct.pack_into(">I", data, at, number)
    arguments[1].write_bytes(data)
    return arguments


def sqlite_views(folder):
    """What is read is a view that multiplies."""
    return sqlite_of(folder, TOPICS, ONE_TOPIC,
                     "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
                     "SELECT id, 1 AS topic_id, id AS timestamp, zeroblob(1000000000) AS data FROM n")


def lz4_frame(blocks):
    """A frame of so many blocks of 4 MiB of zeros each, made by hand: a literal, then one match as long as the block."""
    length = 4 * MB - 1 - 5
    extra, last = divmod(length - 4 - 15, 255)
    block = b"\x1f\0\x01\0" + b"\xff" * extra + bytes([last]) + b"\x50" + bytes(5)
    # Version 1, independent blocks, of at most 4 MiB; the byte behind is a checksum of these two, by xxHash.
    return b"\x04\x22\x4d\x18\x60\x70\x73" + (struct.pack("<I", len(block)) + block) * blocks + bytes(4)


def many_mcap_channels(count):
    schema = mcap_record(0x03, struct.pack("<H", 1) + mcap_text(b"sensor_msgs/msg/LaserScan") + mcap_text(b"ros2msg") + mcap_text(b""))
    channels = [mcap_record(0x04, struct.pack("<HH", k % 65536, 1) + mcap_text(b"/scan%d" % k) + mcap_text(b"cdr") + struct.pack("<I", 0))
                for k in range(count)]
    return mcap(schema, *channels)


def cdr_of_many(count):
    """The header of a message, then a list of so many that are not there."""
    return b"\0\1\0\0" + struct.pack("<I", count)


def sqlite_of_many_topics(folder):
    rows = [(k, f"/scan{k}") for k in range(300_000)]
    return sqlite_of(folder, TOPICS, MESSAGES, ("INSERT INTO topics VALUES (?, ?, 'sensor_msgs/msg/LaserScan', 'cdr', '')", rows))


def sqlite_of_zeros(folder):
    """A message of 512 MB, whose pages lie in a hole of the file: nothing on the disk."""
    return sqlite_of(folder, TOPICS, MESSAGES, ONE_TOPIC, "INSERT INTO messages VALUES (1, 1, 1, zeroblob(536870912))")


def sqlite_that_computes(folder):
    """Each row that is read would compute for hours."""
    return sqlite_of(folder, TOPICS, "CREATE TABLE messages(id INTEGER PRIMARY KEY, timestamp INTEGER, data BLOB)",
                     "INSERT INTO messages VALUES (1, 1, x'')",
                     "ALTER TABLE messages ADD COLUMN topic_id INTEGER GENERATED ALWAYS AS "
                     f"(hex(zeroblob(8000000 + id)) GLOB '*{'0' * 20_000}1') VIRTUAL")


def packed_sqlite(blocks):
    """A database, then so many blocks of zstd of 4 bytes each, which stand for 128 KiB."""
    with sqlite3.connect(":memory:") as database:
        database.execute(TOPICS)
        database.execute(MESSAGES)
        plain = database.serialize()

    def block(kind, size, content):
        return struct.pack("<I", kind << 1 | size << 3)[:3] + content

    return b"\x28\xb5\x2f\xfd" + bytes([0, 17 << 3]) + block(0, len(plain), plain) + block(1, 128 << 10, b"\0") * blocks


def ros2_folder_of_aliases(folder):
    (folder / "metadata.yaml").write_text("a: &a [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"b{k}: &b{k} [{', '.join(['*a' if k == 0 else f'*b{k - 1}'] * 10)}]\n" for k in range(10)) + "rosbag2_bagfile_information: *b9\n")
    (folder / "bag_0.mcap").write_bytes(mcap())
    return ["map", folder, "-o", folder / "run", "-q"]


def ros2_folder_of_files(folder):
    names = ", ".join(["bag_0.mcap"] * 50_000)
    (folder / "metadata.yaml").write_text(f"rosbag2_bagfile_information: {{version: 5, storage_identifier: mcap, relative_file_paths: [{names}]}}\n")
    (folder / "bag_0.mcap").write_bytes(mcap())
    return ["map", folder, "-o", folder / "run", "-q"]


BOMBS = [
    Bomb("MCAP chunk of zstd that states 4 EiB", log_of("log.mcap", lambda: mcap(mcap_chunk(b"zstd", 1 << 62, packed_by_zstd(bytes(NEWLINES))))), 65, "log.mcap"),
    Bomb("MCAP record of 4 EiB in zstd of zeros", log_of("log.mcap", lambda: mcap(mcap_chunk(b"zstd", 4 * NEWLINES, packed_by_zstd(mcap_record(0x05, bytes(22), 1 << 62) + bytes(4 * NEWLINES - 31))))), 65, "log.mcap", 300),
    Bomb("MCAP chunk longer than the file", log_of("log.mcap", lambda: mcap(mcap_chunk(b"", 1 << 62, bytes(100), 1 << 62))), 65, "log.mcap"),
    Bomb("CDR of 4,000,000,000 beams", log_of("log.mcap", lambda: mcap_message(b"sensor_msgs/msg/LaserScan", cdr_scan(beams=0xFFFFFFF0))), 65, "log.mcap"),
    Bomb("bag chunk of bzip2 that states 4 GiB", log_of("log.bag", lambda: ros1_bag(bag_chunk(b"bz2", 0xFFFFFFFF, bz2.compress(bytes(NEWLINES))))), 65, "log.bag"),
    Bomb("bag record of 4 GiB", log_of("log.bag", lambda: ros1_bag(bag_record([(b"op", b"\x02")], b"", 0xFFFFFFFF))), 65, "log.bag"),
    Bomb("SQLite pages in circles", sqlite_cycle, 65, "bag_0.db3"),
    Bomb("SQLite view without an end", sqlite_views, 65, "bag_0.db3"),
    Bomb("MCAP chunk of lz4 of zeros", log_of("log.mcap", lambda: mcap(mcap_chunk(b"lz4", 1 << 30, lz4_frame(64)))), 65, "log.mcap"),
    Bomb("MCAP of 60,000 channels", log_of("log.mcap", lambda: many_mcap_channels(60_000)), 65, "log.mcap", 200),
    Bomb("MCAP chunks of zstd, 60,000 of nothing", log_of("log.mcap", lambda: mcap(*[mcap_chunk(b"zstd", 0, packed_by_zstd(b""))] * 60_000)), 65, "log.mcap"),
    Bomb("CDR of 4,000,000,000 transforms", log_of("log.mcap", lambda: mcap_message(b"tf2_msgs/msg/TFMessage", cdr_of_many(0xFFFFFFF0))), 65, "log.mcap"),
    Bomb("SQLite of 300,000 topics", sqlite_of_many_topics, 65, "bag_0.db3", 200),
    Bomb("SQLite message of 512 MB of zeros", sqlite_of_zeros, 65, "bag_0.db3"),
    Bomb("SQLite that computes its rows", sqlite_that_computes, 65, "bag_0.db3: has a computed column"),
    Bomb("SQLite of 3 GiB of zeros in zstd", log_of("bag_0.db3.zst", lambda: packed_sqlite(24_576)), 65, "as no measured data do", 300),
    Bomb("ROS 2 folder of aliases", ros2_folder_of_aliases, 65, "metadata.yaml|ros_2_folder"),
    Bomb("ROS 2 folder that names a file 50,000 times", ros2_folder_of_files, 65, "ros_2_folder", 100, 10),
]
