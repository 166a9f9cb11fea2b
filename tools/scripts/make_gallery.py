#!/usr/bin/env python3
"""Makes the pictures of docs/gallery.md anew: runs the commands that stand there and keeps what the page shows.

  make_gallery.py PROGRAM [FOLDER]    FOLDER takes the pictures [docs/images/gallery]

The public logs are those of the folder slam2d of GDTSLAM_DATA, or of ../shared/data beside the clone. Without them, or
without ffmpeg, nothing is made (exit 69).
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import doc_outputs

PAGE = doc_outputs.ROOT / "docs" / "gallery.md"
PICTURE = re.compile(r"!\[[^\]]*\]\(images/gallery/([^)]+)\)")
LOGS = ("intel.clf.gz", "intel.relations.gz", "fr079.clf.gz", "mit-csail.clf.gz")


def make(program, folder):
    """Runs every block of the page in a folder of its own and copies the pictures; the number of them."""
    with tempfile.TemporaryDirectory(prefix="gdtslam-gallery-") as work:
        arguments = type("Arguments", (), {"program": program, "all": True, "write": False})
        page = doc_outputs.Pages(arguments, pathlib.Path(work))
        missing = set(LOGS) - {log.name for log in page.logs}
        if missing:
            raise FileNotFoundError(f"no {', '.join(sorted(missing))}: set GDTSLAM_DATA")
        text = PAGE.read_text(encoding="utf-8")
        place = page.folder_for("gallery")
        for block in doc_outputs.blocks_of("docs/gallery.md", text):
            for command, _, _ in block.commands:
                code, lines = doc_outputs.run(command, place, page.environment)
                if code != 0:
                    raise ValueError(f"{block.where()}: exit code {code}\n" + "\n".join(lines))
        pictures = PICTURE.findall(text)
        stills = [place / name for name in pictures if name.endswith(".png")]
        subprocess.run([str(doc_outputs.ROOT / "tools/scripts/shrink_png.sh"), *map(str, stills)], check=True)
        folder.mkdir(parents=True, exist_ok=True)
        for name in pictures:
            shutil.copy(place / name, folder / name)
        return len(pictures)


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-"):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else PAGE.parent / "images" / "gallery"
    if not shutil.which("ffmpeg"):
        print("make_gallery: no ffmpeg, which makes films and small pictures; install the package ffmpeg", file=sys.stderr)
        return 69
    try:
        count = make(pathlib.Path(sys.argv[1]).resolve(), folder)
    except FileNotFoundError as problem:
        print(f"make_gallery: {problem}", file=sys.stderr)
        return 69
    except (ValueError, OSError, subprocess.CalledProcessError) as problem:
        print(f"make_gallery: {problem}", file=sys.stderr)
        return 1
    print(f"{count} pictures in {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
