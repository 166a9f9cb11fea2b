"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import itertools
import os
import pathlib
import stat

from ._errors import UsageError

_NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
_SERIAL = itertools.count()


def require_not_of_run(file: pathlib.Path, folder: pathlib.Path, names: "set[str]") -> None:
    """Raises UsageError for a file of the run in that folder, by whatever links or `..` it is named."""
    place, run = pathlib.Path(os.path.realpath(file)), pathlib.Path(os.path.realpath(folder))
    if run not in place.parents:
        return
    name = place.relative_to(run).parts[0]
    if name in names or name in ("report.json", "tiles") or name.startswith(".gdtslam-staging-"):
        raise UsageError(f"'{file}' is a file of '{folder}', which is read; give another file")


def write_whole(file: pathlib.Path, data: bytes) -> None:
    """Where writing fails the old file stays as it was. A link is followed; a device or a pipe is written directly."""
    target = os.path.realpath(file)
    try:
        old: "os.stat_result | None" = os.stat(target)
    except FileNotFoundError:
        old = None
    if old is not None and not stat.S_ISREG(old.st_mode):
        file.write_bytes(data)
        return
    folder, name = os.path.split(target)
    temporary = os.path.join(folder, f".{name}.{os.getpid()}-{next(_SERIAL)}.tmp")
    try:
        with open(temporary, "xb", opener=lambda path, _flags: os.open(path, _NEW_FILE, 0o666)) as stream:
            if old is not None:
                with contextlib.suppress(OSError):  # somebody else's: it gets the usual permissions of a new one
                    os.fchmod(stream.fileno(), stat.S_IMODE(old.st_mode))
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
