"""Runs the code of docs/howto/python.md, and holds what it prints and draws against the page; the program of
docs/howto/c.md is examples/c/map.c. With GDTSLAM_UPDATE_GOLDENS=1 outputs and pictures are written into the page."""
import contextlib
import io
import os
import re
import shutil
import subprocess
import sys

from bindings_support import SAMPLE, SKIPPED, SOURCE, fail, folder

if subprocess.run([sys.executable, "-c", "import numpy"], capture_output=True).returncode != 0:
    print("SKIPPED: no numpy for Python (package python3-numpy)")
    sys.exit(1 if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1" else SKIPPED)

c_page = (SOURCE / "docs/howto/c.md").read_text()
if "```c\n" + (SOURCE / "examples/c/map.c").read_text() + "```" not in c_page:
    fail("docs/howto/c.md shows another program than examples/c/map.c")

PAGE = SOURCE / "docs/howto/python.md"
IMAGES = SOURCE / "docs/images"
is_update = os.environ.get("GDTSLAM_UPDATE_GOLDENS") == "1"
page = PAGE.read_text()
work = folder("page")
shutil.copyfile(SAMPLE, work / "office-start.log.gz")
os.chdir(work)
sys.path.insert(0, str(SOURCE / "python"))
names = {}
differences = []
blocks = list(re.finditer(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```)?", page, re.DOTALL))
if len(blocks) < 6:
    fail(f"only {len(blocks)} blocks of code")
written = page
for block in blocks:
    code, shown = block.groups()
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        exec(compile(code, f"{PAGE.name}: {code.splitlines()[0]}", "exec"), names)  # noqa: S102 - the page's own code
    printed = output.getvalue()
    if printed != (shown or ""):
        differences.append(f"{code}\nprints\n{printed}\nand not\n{shown}")
        if shown is not None:
            written = written.replace(block.group(0), block.group(0).replace(f"```text\n{shown}```", f"```text\n{printed}```"))
for picture in ("map.svg", "distance.svg"):
    golden = IMAGES / f"python-{picture}"
    if f"images/{golden.name}" not in page:
        fail(f"the page does not show {golden.name}")
    if is_update:
        shutil.copyfile(picture, golden)
    elif golden.read_bytes() != (work / picture).read_bytes():
        differences.append(f"{picture} is another picture than {golden}")
if is_update:
    PAGE.write_text(written)
    print(f"wrote {PAGE}")
elif differences:
    fail("\n".join(differences))
