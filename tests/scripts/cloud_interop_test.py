"""Reads clouds that gdtslam wrote with a reader of its own, which knows the formats' descriptions only."""

import pathlib
import struct
import subprocess
import sys
import tempfile

PLY_TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
PCD_TYPES = {"F4": "f", "F8": "d", "U1": "B", "U2": "H", "U4": "I", "I1": "b", "I2": "h", "I4": "i"}


def rows_of(body, codes, count):
    layout = struct.Struct("<" + codes)
    assert len(body) == layout.size * count, f"{len(body)} bytes for {count} points of {layout.size}"
    return list(layout.iter_unpack(body))


def read_ply(data):
    header, body = data.split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode("ascii").splitlines()]
    assert lines[:2] == [["ply"], ["format", "binary_little_endian", "1.0"]]
    count = next(int(line[2]) for line in lines if line[:2] == ["element", "vertex"])
    columns = [(line[2], PLY_TYPES[line[1]]) for line in lines if line[0] == "property"]
    return [name for name, _ in columns], rows_of(body, "".join(code for _, code in columns), count)


def read_pcd(data):
    header, body = data.split(b"\nDATA ", 1)
    form, body = body.split(b"\n", 1)
    keys = {line.split()[0]: line.split()[1:] for line in header.decode("ascii").splitlines() if line[0] != "#"}
    assert form == b"binary" and keys["VERSION"] == ["0.7"] and set(keys["COUNT"]) == {"1"}
    count = int(keys["POINTS"][0])
    assert int(keys["WIDTH"][0]) * int(keys["HEIGHT"][0]) == count
    codes = "".join(PCD_TYPES[kind + size] for kind, size in zip(keys["TYPE"], keys["SIZE"]))
    return keys["FIELDS"], rows_of(body, codes, count)


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], folder], check=True)
        expected = [(single(k * 0.1), single(-k / 3), single(k * 1e-3), single(k * 0.01), 976052857.25 + k / 7, k)
                    for k in range(1000)]
        for name, read in [("b.ply", read_ply), ("b.pcd", read_pcd)]:
            columns, rows = read(pathlib.Path(folder, name).read_bytes())
            assert columns == ["x", "y", "z", "elevation", "time", "scan"], columns
            assert [(*(single(v) for v in row[:4]), *row[4:]) for row in rows] == expected, name


main()
