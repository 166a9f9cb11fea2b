"""What bombs are made with and measured by: small files that stand for gigabytes or for hours."""

import ctypes
import re
import resource
import struct
import zlib
from typing import NamedTuple

import cli_support as cli

MB = 1 << 20
PIPED = 32 * MB  # what comes through a pipe


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
    is_error = text.count("\n") == 1 and text.startswith("gdtslam: error: ")
    if is_error == (bomb.code == 0) or not re.search(bomb.pattern, text):
        faults.append("not the line expected")
    if megabytes > bomb.most_mb:
        faults.append(f"{megabytes} MB and not {bomb.most_mb}")
    if cpu_s > bomb.most_s:
        faults.append(f"{cpu_s:.1f} s of CPU and not {bomb.most_s}")
    return faults
