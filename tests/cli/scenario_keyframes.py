"""keyframes.bin.gz, read as docs/formats.md describes it and by nothing of the program's: against log, poses and report."""

import gzip
import hashlib
import math
import struct

import cli_support as cli
from cli_support import LOG, RUN, expect, mapped, scans_in


def ranges_mm(data, at, beams):
    """Ranges in whole millimetres, None without a return, and where they end."""
    ranges, last = [], 0
    for _ in range(beams):
        coded, shift = 0, 0
        while True:
            byte, at = data[at], at + 1
            coded, shift = coded | (byte & 127) << shift, shift + 7
            if byte < 128:
                break
        if coded:
            last += -((coded - 1) >> 1) if (coded - 1) & 1 else (coded - 1) >> 1
        ranges.append(last if coded else None)
    return ranges, at


def read_keyframes(path):
    """Hash of the configuration, flag of single precision, keyframes, and the checksum, which is that of the bytes."""
    data = gzip.decompress(path.read_bytes())
    body, digest = data[:-64], data[-64:].decode()
    expect(hashlib.sha256(body).hexdigest() == digest, "the checksum is another")
    expect(body[:20] == b"gdtslam-keyframe\1\0\0\0", f"the file begins with {body[:20]}")
    config, single, count, at = body[20:84].decode(), body[84], struct.unpack_from("<I", body, 85)[0], 89
    keyframes = []
    for _ in range(count):
        scan, flags, stamp, *pose = struct.unpack_from("<IB4d", body, at)
        at += 37
        covariance = struct.unpack_from("<6d", body, at) if flags & 1 else None
        at += 48 if flags & 1 else 0
        laser = struct.unpack_from("<8d", body, at)  # mount, first bearing, step, limit, times of the beams
        at += 64 + (24 if flags & 2 else 0)
        beams, = struct.unpack_from("<I", body, at)
        ranges, at = ranges_mm(body, at + 4, beams)
        keyframes.append((scan, stamp, tuple(pose), covariance, laser, ranges))
    expect(at == len(body), f"{len(body) - at} bytes are left")
    return config, single, keyframes, digest


def log_scans(path):
    """Of each FLASER line of a plain log the ranges, and the laser on the robot: (forward, left, turn)."""
    rows = []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "FLASER":
            beams = int(words[1])
            x, y, theta, robot_x, robot_y, robot_theta = map(float, words[2 + beams:8 + beams])
            cosine, sine = math.cos(robot_theta), math.sin(robot_theta)
            mount = (cosine * (x - robot_x) + sine * (y - robot_y), cosine * (y - robot_y) - sine * (x - robot_x), theta - robot_theta)
            rows.append(([float(word) for word in words[2:2 + beams]], mount))
    return rows


def keyframes_are_those_of_the_log():
    """Ranges are those of the log to half a millimetre, poses and covariances those of the other files, bit for bit."""
    report = scans_in(RUN)
    config, single, keyframes, digest = read_keyframes(RUN / "keyframes.bin.gz")
    expect(digest == report["keyframes_sha256"], "the report has another hash")
    expect(config == hashlib.sha256((RUN / "config.yaml").read_bytes()).hexdigest(), "another configuration")
    expect(single == 1, "a run with loops takes points in single precision")
    expect([keyframe[0] for keyframe in keyframes] == report["keyframe_scans"], "other keyframes than the report's")
    scans = log_scans(LOG)
    poses = [tuple(map(float, line.split())) for line in (RUN / "trajectory.tum").read_text().splitlines() if line[0] != "#"]
    covariances = [tuple(map(float, line.split(","))) for line in (RUN / "covariance.csv").read_text().splitlines()[1:]]
    returns = 0
    for scan, stamp, pose, covariance, laser, ranges in keyframes:
        expect(abs(poses[scan][0] - stamp) < 1e-6, f"scan {scan} has the stamp {stamp}")
        expect(abs(poses[scan][1] - pose[0]) < 1e-6 and abs(poses[scan][2] - pose[1]) < 1e-6, f"scan {scan} is at {pose}")
        expect(covariance == covariances[scan][1:], f"scan {scan} has the covariance {covariance}")
        measured, mount = scans[scan]
        expect(len(ranges) == len(measured), f"scan {scan} has {len(ranges)} beams")
        for kept, range_m in zip(ranges, measured):
            expect(kept is not None and abs(kept - 1000 * range_m) < 0.51, f"scan {scan}: {kept} mm for {range_m} m")
            returns += 1
        expect(max(abs(a - b) for a, b in zip(laser, mount)) < 2e-5, f"scan {scan} has the mount {laser[:3]}, not {mount}")
        expect(abs(laser[3] + math.pi / 2) < 1e-9 and abs(laser[4] - math.pi / 180) < 1e-9, f"scan {scan} has the laser {laser}")
    expect(returns > 10000, f"{returns} ranges")


def keyframes_without_loops():
    """Without loops there is no covariance and the points are double; without a map the same keyframes."""
    folder = cli.fresh_folder("keyframes")
    report = mapped(folder / "plain", "--first", 100, "--no-loops")
    _, single, keyframes, digest = read_keyframes(folder / "plain" / "keyframes.bin.gz")
    expect(single == 0 and all(keyframe[3] is None for keyframe in keyframes), "a covariance without loops")
    expect(len(keyframes) == report["keyframes"], f"{len(keyframes)} keyframes")
    again = mapped(folder / "no_map", "--first", 100, "--no-loops", "--no-map")
    expect(again["keyframes_sha256"] == digest, "other keyframes without a map")
