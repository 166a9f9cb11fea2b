"""Declarations of gdtslam.h stay as they are stored: programs that were built with an older header go on with the library.

Functions and constants may be added, and members at the end of a struct that begins with its size; what is added on purpose is
stored with GDTSLAM_UPDATE_GOLDENS=1. Anything else takes another number behind .so.
"""
import os
import re

from bindings_support import HEADER, SOURCE, fail

STORED = SOURCE / "tests/bindings/abi.txt"
text = re.sub(r"/\*.*?\*/|^#.*?(?<!\\)$", "", HEADER.read_text(), flags=re.DOTALL | re.MULTILINE)
text = re.sub(r'extern "C" \{|^\}\s*$', "", text, flags=re.MULTILINE)
current = []
for declaration in re.findall(r"(?:\{[^}]*\}|[^;{])+;", text):
    line = " ".join(declaration.split())
    if line.startswith("enum {"):
        current += re.findall(r"GDTSLAM_\w+ = \d+", line)
    else:
        current.append(line)
if len(current) < 100:
    fail(f"only {len(current)} declarations; has the header another form?")
if os.environ.get("GDTSLAM_UPDATE_GOLDENS") == "1":
    STORED.write_text("\n".join(current) + "\n")
stored = STORED.read_text().splitlines()
for line in stored:
    members, end, name = line.rpartition(" }")
    is_extended = "{ size_t size;" in line and any(new.startswith(members) and new.endswith(end + name) for new in current)
    if line not in current and not is_extended:
        fail(f"gone or changed: {line}")
if current != stored:
    fail(f"added: {[line for line in current if line not in stored]}; store it with GDTSLAM_UPDATE_GOLDENS=1")
print(f"{len(stored)} declarations")
