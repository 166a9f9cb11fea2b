"""Scenes and meshes that are made to harm: one stated outcome each, in little time and memory. scenario_bombs.py has what
unpacks and multiplies."""

import os
import re
import signal
import struct
import subprocess
import time

import cli_support as cli
from cli_support import command, expect, expect_exit, one_error_line

HEAD = "gdtslam_scene: 1\n"
BOX = "{centre: [0, 0], size: [1, 1], height: 1}"
PLACE = "waypoints: [{at: [0, 0], pause: 1 s}]\n"
FEW_MB = 256


def refused(name, code, pattern, most_mb, *arguments, most_s=5.0):
    """One run and its one line; the largest resident size is that of this process alone."""
    code_found, stderr, megabytes, cpu_s = cli.measured(*arguments, timeout=60)
    print(f"{name}: exit {code_found}, {cpu_s:.2f} s CPU, {megabytes} MB: {stderr.strip()[:300]}")
    expect(code_found == code, f"{name}: exit {code_found}: {stderr}")
    one_error_line(stderr)
    expect(re.search(pattern, stderr), f"{name}: {stderr}")
    if not cli.IS_SANITIZED:  # a sanitized program needs more time and memory
        expect(cpu_s < most_s, f"{name}: took {cpu_s:.2f} s of CPU")
        expect(megabytes < most_mb, f"{name}: took {megabytes} MB")


def scene_refused(name, lines, code, pattern, most_mb=FEW_MB):
    folder = cli.fresh_folder(f"hostile_scenes/{name}")
    (folder / "scene.yaml").write_text(HEAD + lines + PLACE)
    refused(name, code, pattern, most_mb, "simulate", folder / "scene.yaml", "-o", folder / "drive.log")
    expect(not list(folder.glob("drive*")), f"{name}: something was written")


def hostile_scenes():
    """Small scenes that multiply, and files that are too long."""
    many = f"{{centre: [0, 0], size: [1, 1], height: 1, repeat: {{count: 60000, step: [0, 0]}}}}"
    spread = "repeat: {count: 60000, step: [0, 0]}"
    scene_refused("places", f"objects: [{{name: a, boxes: [{many}]}}]\nplace: [{{object: a, at: [0, 0], {spread}}}]\n", 78,
                  "more than 200000 parts")
    scene_refused("number", f"floor: {'0' * 1_000_000}\n", 78, "scene.yaml:2: floor: a (number|text) of more than")
    scene_refused("recursion", "walls: &a [*a]\n", 78, "scene.yaml:2: ")
    scene_refused("values", "walls: [" + "[]," * 5_000_000 + "]\n", 78, "more than 1000000 values")
    scene_refused("long", "#" * (16 << 20) + "\n", 78, "scene.yaml: is longer than")
    folder = cli.fresh_folder("hostile_scenes/linkage")
    (folder / "long.yaml").write_text("#" * ((1 << 20) + 1))
    refused("long linkage", 78, "long.yaml: is longer than", FEW_MB, "simulate", "three-boxes", "-o", folder / "drive.log",
            "--linkage", folder / "long.yaml")


def hostile_meshes():
    """Meshes of any bytes end at once in one line; a scene opens nothing but what lies beside it."""
    folder = cli.fresh_folder("hostile_meshes")
    ply = b"ply\nformat binary_little_endian 1.0\n"
    corners = b"element vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"
    meshes = {"list.ply": ply + corners + b"element face 4000000000\n"
                          b"property list uint uint vertex_indices\nend_header\n\0\0\0\xff\xff\xff\xff",
              "header.ply": b"ply\nformat ascii 1.0\n" + b"comment\n" * 200_000,
              "cut.stl": b"\0" * 80 + struct.pack("<I", 4) + b"\0" * 66,
              "corner.ply": ply.replace(b"binary_little_endian", b"ascii") + corners
                            + b"element face 1\nproperty list uint uint vertex_indices\nend_header\n0 0 0\n3 0 0 4000000000\n",
              "binary.ply": bytes(range(256)) * 1000, "empty.ply": b""}
    for name, content in meshes.items():
        (folder / name).write_bytes(content)
        (folder / "scene.yaml").write_text(f"{HEAD}meshes: [{{file: {name}}}]\n{PLACE}")
        refused(name, 65, re.escape(name), FEW_MB, "simulate", folder / "scene.yaml", "-o", folder / "drive.log", most_s=1.0)

    outside = cli.fresh_folder("hostile_meshes_outside")
    (outside / "secret.stl").write_text("solid\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\n")
    (folder / "link.stl").symlink_to(outside / "secret.stl")
    (folder / "linked").symlink_to(outside)
    os.mkfifo(folder / "pipe.stl")
    (folder / "folder.stl").mkdir()
    for name, pattern in ((outside / "secret.stl", "absolute name"), ("../hostile_meshes_outside/secret.stl", "leads out"),
                          ("link.stl", "leads out"), ("linked/secret.stl", "leads out"), ("pipe.stl", "no regular file"),
                          ("folder.stl", "no regular file"), ("/dev/zero", "absolute name")):
        scene = f"{HEAD}meshes: [{{file: {name}}}]\n{PLACE}"
        (folder / "scene.yaml").write_text(scene)
        refused(name, 78, rf"scene.yaml:2: meshes\[0\].file: .*{pattern}", FEW_MB, "simulate", folder / "scene.yaml", "-o",
                folder / "drive.log")
        (folder / "scene.yaml").write_text(f"{HEAD}boxes: [{BOX}]\nrobot: {{nodding: {{linkage: {name}}}}}\n{PLACE}")
        refused(f"linkage {name}", 78, f"scene.yaml:3: robot.nodding.linkage: .*{pattern}", FEW_MB, "simulate",
                folder / "scene.yaml", "-o", folder / "drive.log")


def interrupted_reading_is_no_fault():
    """A signal while a scene comes from a pipe ends the command, and is no fault of the file (exit 65 or 74)."""
    folder = cli.fresh_folder("interrupted_reading")
    os.mkfifo(folder / "scene.yaml")
    with subprocess.Popen([cli.PROGRAM, "simulate", folder / "scene.yaml", "-o", folder / "drive.log"], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        with open(folder / "scene.yaml", "w", encoding="utf-8") as pipe:
            pipe.write(HEAD + f"boxes: [{BOX.replace('[0, 0]', '[3, 0]')}]\n")
            pipe.flush()
            time.sleep(0.3)
            process.send_signal(signal.SIGINT)
            process = cli.finish(process)
    expect_exit(process, 130)
    one_error_line(process.stderr)


def scenes_of_the_documentation():
    """Every scene that docs/simulation.md shows can be driven."""
    folder = cli.fresh_folder("documented_scenes")
    blocks = re.findall(r"^```yaml\n(.*?)^```", (cli.SOURCE / "docs/simulation.md").read_text(), re.MULTILINE | re.DOTALL)
    scenes = [block for block in blocks if "gdtslam_scene:" in block]
    expect(scenes, "docs/simulation.md shows no scene")
    for number, scene in enumerate(scenes):
        (folder / f"{number}.yaml").write_text(scene)
        process = command("simulate", folder / f"{number}.yaml", "-o", folder / f"{number}.log")
        expect_exit(process, 0)
        expect((folder / f"{number}.log").read_text().count("FLASER") > 0, "a log without scans")
