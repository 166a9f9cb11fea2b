"""The library shows the functions of gdtslam.h, each with its version, and no symbol else; its name says its ABI."""
import re

from bindings_support import HEADER, LIBRARY, fail, run

declared = set(re.findall(r"^GDTSLAM_API [^;(]*?\b(gdtslam_\w+)\(", HEADER.read_text(), re.MULTILINE))
if len(declared) < 40:
    fail(f"only {len(declared)} functions are declared; has the header another form?")
shown = {}
for line in run("nm", "--dynamic", "--defined-only", "--with-symbol-versions", LIBRARY).splitlines():
    _, kind, name = line.split()
    if kind != "A":  # the node of the versions itself
        base, _, version = name.partition("@@")
        shown[base] = (kind, version)
if set(shown) != declared:
    fail(f"shown and not declared: {set(shown) - declared}; declared and not shown: {declared - set(shown)}")
for name, (kind, version) in shown.items():
    if (kind, version) != ("T", "GDTSLAM_0"):
        fail(f"{name} is shown as {kind} of version '{version}'")
dynamic = run("readelf", "--dynamic", "--wide", LIBRARY)
if "[libgdtslam.so.0]" not in dynamic:
    fail("its name is not libgdtslam.so.0")
print(f"{len(shown)} functions")
