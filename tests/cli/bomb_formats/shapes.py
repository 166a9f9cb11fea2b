"""Bombs of clouds, meshes and pictures."""

import struct
import zlib

import cli_support as cli
from bomb_formats.bomb import MB, Bomb, deflated, gzipped, of
from bomb_formats.texts import scene

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


MAP_YAML = "image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
FIELD_YAML = ("version: 2\nimage: gdt.png\nresolution: 0.05\norigin: [0, 0, 0]\nunit: 0.0000030517578125\nscale: 64\n"
              "cap: 64000\n")


def png_chunk(name, content):
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def png(width, height, depth, rows):
    header = struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header) + png_chunk(b"IDAT", rows) + png_chunk(b"IEND", b"")


def zlib_zeros(count):
    checksum = count % 65521 << 16 | 1  # Adler-32 of zeros
    return b"\x78\xda" + deflated(b"", bytes(MB), count // MB, bytes(count % MB)) + struct.pack(">I", checksum)


def map_with(name, image):
    def make(folder):
        (folder / name).write_bytes(image())
        (folder / "map.yaml").write_text(MAP_YAML.format(name))
        return ["localize", folder / "map.yaml", cli.LOG, "--scan", 1]

    return make


def walls(width, height):
    """Rows of a picture of free cells whose first and last row are occupied."""
    packer = zlib.compressobj(9)
    wall, free = bytes(1 + width), b"\0" + b"\xfe" * width
    rows = [packer.compress(row) for row in (wall, *(free for _ in range(height - 2)), wall)]
    return b"".join(rows) + packer.flush()


def field_with(image):
    def make(folder):
        (folder / "gdt.png").write_bytes(image())
        (folder / "gdt.yaml").write_text(FIELD_YAML)
        return ["localize", folder / "gdt.yaml", cli.LOG, "--scan", 1]

    return make


def mesh(name, content):
    """A scene of one mesh."""
    of_mesh = scene(lambda: f"meshes: [{{file: {name}}}]\n")

    def make(folder):
        (folder / name).write_bytes(content())
        return of_mesh(folder)

    return make


def stl_of(count):
    return bytes(80) + struct.pack("<I", count) + bytes(50)


def ply_of_fans(faces):
    """Faces of 198 corners of three points."""
    face = b"198" + b" 0 1 2" * 66 + b"\n"
    return (b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            b"element face %d\nproperty list uint int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n" % faces + face * faces)


def png_of_chunks(*chunks):
    """A picture of one cell behind chunks that few read."""
    picture = png(1, 1, 8, zlib.compress(b"\0\0"))
    end_of_header = 8 + 25
    return picture[:end_of_header] + b"".join(chunks) + picture[end_of_header:]


def png_text(unpacked):
    return png_chunk(b"zTXt", b"a\0\0" + zlib_zeros(unpacked))


BOMBS = [
    Bomb("PLY of zeros in gzip", of("evaluate", "bomb.ply.gz", lambda: ply_zeros(28 * MB), "--planes"), 65, "store the file unpacked", 1000, 10),
    Bomb("PLY of 4,000,000,000 points", of("evaluate", "bomb.ply", lambda: PLY + CORNERS + b"end_header\n\0\0\0", "--planes"), 65, "bomb.ply"),
    Bomb("PCD of zeros by LZF", of("evaluate", "bomb.pcd", lambda: pcd_bomb(2_600_000), "--planes"), 65, "store the file unpacked", 1000, 10),
    Bomb("PGM of zeros in gzip", map_with("map.pgm.gz", lambda: gzipped(b"P5\n20480 20480\n255\n", bytes(MB), 400)), 65, "would take", 600, 10),
    Bomb("PNG map of zeros", map_with("map.png", lambda: png(30_000, 30_000, 8, zlib_zeros(30_001 * 30_000))), 65, "would take"),
    Bomb("PNG field of zeros", field_with(lambda: png(20_000, 20_000, 16, zlib_zeros(40_001 * 20_000))), 65, "would take"),
    Bomb("PNG map of 15,000 x 15,000 with two walls", map_with("map.png", lambda: png(15_000, 15_000, 8, walls(15_000, 15_000))), 65, "searching in the map would take", 320, 6),
    Bomb("PNG map of 1 x 1,000,000", map_with("map.png", lambda: png(1, 1_000_000, 8, walls(1, 1_000_000))), 65, "searching in the map would take"),
    # Maps that are read: looking for a scan of the simulated drive in their one cell takes 2.6 s.
    Bomb("PNG with a text of 1 GB", map_with("map.png", lambda: png_of_chunks(png_text(1000 * MB))), 0, "scan 1 at", 100, 6),
    Bomb("PNG of 1,000,000 chunks", map_with("map.png", lambda: png_of_chunks(png_chunk(b"tEXt", b"a\0") * 1_000_000)), 0, "scan 1 at", 100, 6),
    Bomb("PGM with comments of 16 MB", map_with("map.pgm", lambda: b"P5\n" + b"#\n" * (8 * MB)), 65, "map.pgm"),
    Bomb("PLY header of 1,000,000 properties", of("evaluate", "bomb.ply", lambda: PLY + CORNERS + b"property uchar a\n" * 1_000_000 + b"end_header\n", "--planes"), 65, "bomb.ply"),
    Bomb("PCD of 4,000,000,000 points", of("evaluate", "bomb.pcd", lambda: b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4000000000\nHEIGHT 1\nPOINTS 4000000000\nDATA binary\n", "--planes"), 65, "bomb.pcd"),
    Bomb("STL of 4,000,000,000 triangles", mesh("bomb.stl", lambda: stl_of(0xFFFFFFFF)), 65, "bomb.stl"),
    Bomb("PLY of 9,800,000 triangles", mesh("bomb.ply", lambda: ply_of_fans(50_000)), 65, "bomb.ply", 1000, 10),
]
