"""Reads MCAP files by their published page with struct and zlib alone, to check what gdtslam writes: every count, length, offset and checksum. zstd is unpacked by its library through ctypes."""

import ctypes
import struct
import zlib


class Bytes:
    """Little-endian values one after the other."""

    def __init__(self, data, begin=0):
        self.data, self.at = data, begin

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    def raw(self, count):
        assert self.at + count <= len(self.data), "the data end too early"
        self.at += count
        return self.data[self.at - count : self.at]

    def block(self):
        return self.raw(self.take("I"))

    def left(self):
        return len(self.data) - self.at


def unpacked_zstd(data, size):
    library = ctypes.CDLL("libzstd.so.1")
    library.ZSTD_decompress.restype = ctypes.c_size_t
    target = ctypes.create_string_buffer(size)
    count = library.ZSTD_decompress(target, ctypes.c_size_t(size), data, ctypes.c_size_t(len(data)))
    assert count == size, f"zstd gave {count} bytes, {size} were stated"
    return target.raw


def mcap_records(data, begin, end):
    cursor = Bytes(data, begin)
    while cursor.at < end:
        at = cursor.at
        opcode = cursor.take("B")
        yield at, opcode, Bytes(cursor.raw(cursor.take("Q")))


def mcap_messages(data):
    """[(topic, type, time in ns, bytes)] of a whole MCAP file, with its summary checked against what is there."""
    magic = b"\x89MCAP0\r\n"
    assert data[:8] == magic and data[-8:] == magic
    schemas, channels, messages, chunks, indexed = {}, {}, [], {}, 0
    summary = {}
    for at, opcode, body in mcap_records(data, 8, len(data) - 8):
        if opcode == 0x01:
            assert body.block() == b"ros2"
        elif opcode == 0x06:
            first, last, size, checksum = body.take("QQQI")
            packing, packed = body.block(), body.raw(body.take("Q"))
            plain = unpacked_zstd(packed, size) if packing == b"zstd" else packed
            assert packing in (b"", b"zstd") and len(plain) == size and zlib.crc32(plain) == checksum
            chunks[at] = (first, last, len(packed), size)
            here = {}
            for offset, inner, content in mcap_records(plain, 0, len(plain)):
                if inner == 0x03:
                    number, name, encoding, text = content.take("H"), content.block(), content.block(), content.block()
                    assert encoding == b"ros2msg" and b"builtin_interfaces/Time stamp" in text or b"Int32" in name
                    schemas[number] = name.decode()
                elif inner == 0x04:
                    number, schema, topic, encoding = content.take("H"), content.take("H"), content.block(), content.block()
                    assert encoding == b"cdr"
                    channels[number] = (topic.decode(), schemas[schema])
                else:
                    assert inner == 0x05
                    number, _, log_time, _ = content.take("HIQQ")
                    assert first <= log_time <= last
                    messages.append((*channels[number], log_time, content.raw(content.left())))
                    here.setdefault(number, []).append((log_time, offset))
        elif opcode == 0x07:
            number, rows = body.take("H"), body.block()
            assert [struct.unpack_from("<QQ", rows, k) for k in range(0, len(rows), 16)] == here[number]
            indexed += len(rows) // 16
        elif opcode == 0x0F:
            assert body.take("I") == zlib.crc32(data[:at]), "checksum of the data"
            summary["begin"] = len(data[:at]) + 9 + 4
        elif opcode == 0x0B:
            count, of_schemas, of_channels, _, _, of_chunks, first, last = body.take("QHIIIIQQ")
            assert (count, of_schemas, of_channels, of_chunks) == (len(messages), len(schemas), len(channels), len(chunks))
            assert (first, last) == (min(m[2] for m in messages), max(m[2] for m in messages))
        elif opcode == 0x08:
            first, last, begin, length = body.take("QQQQ")
            places = body.block()
            index_length, packing, packed, size = body.take("Q"), body.block(), *body.take("QQ")
            assert chunks.pop(begin) == (first, last, packed, size)
            for k in range(0, len(places), 10):
                number, place = struct.unpack_from("<HQ", places, k)
                assert data[place] == 0x07 and begin + length <= place < begin + length + index_length
        elif opcode == 0x0E:
            group, begin, length = body.take("BQQ")
            assert data[begin] == group and length > 0
        elif opcode == 0x02:
            begin, _, checksum = body.take("QQI")
            assert begin == summary["begin"]
            assert zlib.crc32(data[begin : at + 9 + 16]) == checksum, "checksum of the summary"
    assert not chunks and indexed == len(messages)
    return messages


def bag_record(cursor):
    fields = {}
    header = Bytes(cursor.block())
    while header.left():
        name, value = header.block().split(b"=", 1)
        fields[name.decode()] = value
    return fields, cursor.block()


def whole(data):
    return int.from_bytes(data, "little")


def cdr_scan(data):
    """A LaserScan in CDR: stamp in ns, frame, its seven numbers, ranges."""
    assert data[:4] == b"\0\1\0\0"
    body = Bytes(data[4:])
    seconds, nanoseconds = body.take("II")
    frame = body.block()
    body.at += -body.at % 4
    numbers = body.take("7f")
    ranges = body.take(f"{body.take('I')}f")
    assert body.take("I") == 0 and body.left() == 0 and frame.endswith(b"\0")
    return seconds * 10**9 + nanoseconds, frame[:-1].decode(), numbers, ranges


def cdr_pose(data):
    """An Odometry in CDR: stamp in ns, the two frames, x, y and the quaternion's z and w."""
    body = Bytes(data[4:])
    seconds, nanoseconds = body.take("II")
    frame = body.block()
    body.at += -body.at % 4
    child = body.block()
    body.at += -body.at % 8
    x, y, _, _, _, z, w = body.take("7d")
    body.take("36d")
    body.take("6d")
    body.take("36d")
    assert body.left() == 0
    return seconds * 10**9 + nanoseconds, frame[:-1].decode(), child[:-1].decode(), x, y, z, w


def cdr_header(body):
    """Stamp in ns and frame."""
    seconds, nanoseconds = body.take("II")
    return seconds * 10**9 + nanoseconds, body.block()[:-1].decode()


def cdr_stamped_pose(data):
    """A PoseStamped in CDR: stamp in ns, frame, x, y and the quaternion's z and w."""
    body = Bytes(data[4:])
    stamp_ns, frame = cdr_header(body)
    body.at += -body.at % 8
    x, y, _, _, _, z, w = body.take("7d")
    assert body.left() == 0
    return stamp_ns, frame, x, y, z, w


def cdr_grid(data):
    """An OccupancyGrid in CDR: width, height, cells from the lower left one on."""
    body = Bytes(data[4:])
    cdr_header(body)
    body.at += -body.at % 4
    _, _, _, width, height = body.take("IIfII")
    body.at += -body.at % 8
    body.take("7d")
    cells = struct.unpack(f"<{width * height}b", body.block())
    assert body.left() == 0
    return width, height, cells
