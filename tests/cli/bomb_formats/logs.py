"""Bombs of text logs, of what packs them, and of tables."""

import bz2
import gzip
import lzma
import os
import struct
import threading
import zlib

import cli_support as cli
from bomb_formats.bomb import MB, PIPED, Bomb, gzipped, log_of, of, packed_by_zstd

NEWLINES = 16 * MB


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


def dense_gzip_name():
    """A header whose file name has no end."""
    return b"\x1f\x8b\x08\x08\0\0\0\0\0\xff" + b"x" * NEWLINES


def zstd_frame_of_window(exponent):
    """A frame that wants a window of 2^exponent bytes and states no size, of one run of a byte."""
    block = struct.pack("<I", 1 | 1 << 1 | (128 << 10) << 3)[:3] + b"\n"  # the last one, of type RLE
    return b"\x28\xb5\x2f\xfd" + bytes([0, (exponent - 10) << 3]) + block


def skippable_zstd_frames():
    return (b"\x50\x2a\x4d\x18" + struct.pack("<I", 0)) * 500_000 + b"\x50\x2a\x4d\x18" + struct.pack("<I", 0xFFFFFFFF)


def empty_members():
    """A million streams of gzip without a byte in them."""
    return (b"\x1f\x8b\x08\0\0\0\0\0\0\xff\x03\0" + bytes(8)) * 1_000_000


BOMBS = [
    Bomb("newlines through a pipe", piped_newlines, 65, "pipe.log", 100, 2 + 4 * PIPED / (1024 * MB)),
    Bomb("gzip of zeros as a log", log_of("log.gz", lambda: gzipped(b"", bytes(MB), NEWLINES // MB)), 65, "log.gz"),
    Bomb("gzip of newlines", log_of("log.gz", lambda: gzipped(b"", b"\n" * MB, NEWLINES // MB)), 65, "log.gz"),
    Bomb("gzip of 1,000,000 empty streams", log_of("log.gz", empty_members), 65, "log.gz"),
    Bomb("gzip whose name has no end", log_of("log.gz", dense_gzip_name), 65, "log.gz"),
    Bomb("bzip2 of 300,000 empty streams", log_of("log.bz2", lambda: bz2.compress(b"") * 300_000), 65, "log.bz2", 100, 10),
    Bomb("xz of newlines", log_of("log.xz", lambda: lzma.compress(b"\n" * NEWLINES, preset=0)), 65, "log.xz"),
    Bomb("xz with a dictionary of 1.5 GiB", log_of("log.xz", lambda: lzma.compress(b"\n", filters=[{"id": lzma.FILTER_LZMA2, "dict_size": 3 << 29, "preset": 0}])), 65, "128 MiB"),
    Bomb("zstd with a window of 2 GiB", log_of("log.zst", lambda: zstd_frame_of_window(31)), 65, "log.zst"),
    Bomb("zstd with a window of 128 MiB", log_of("log.zst", lambda: zstd_frame_of_window(27)), 65, "log.zst", 200),
    Bomb("zstd frames to be skipped", log_of("log.zst", skippable_zstd_frames), 65, "log.zst"),
    Bomb("CARMEN line of 16 MB", log_of("log.log", lambda: b"FLASER " + b"1" * NEWLINES + b"\n"), 65, "log.log:1"),
    Bomb("CARMEN of 300,000 kinds", log_of("log.log", lambda: b"".join(b"K%d 1\n" % k for k in range(300_000))), 65, "log.log"),
    Bomb("CSV of 500,000 columns", log_of("log.csv", lambda: b",".join(b"r%d" % k for k in range(500_000)) + b"\n"), 65, "log.csv"),
    Bomb("CSV of newlines", log_of("log.csv", lambda: b"stamp,ranges\n" + b"\n" * NEWLINES), 65, "log.csv"),
    Bomb("JSON lines of newlines", log_of("log.jsonl", lambda: b"{}\n" + b"\n" * NEWLINES), 65, "log.jsonl"),
    Bomb("trajectory in gzip", of("evaluate", "bomb.tum.gz", lambda: gzipped(b"", b"0 0 0 0 0 0 0 1\n" * 65_536, 120), "--reference", cli.TRUTH), 65, "would take", 1000, 10),
]
