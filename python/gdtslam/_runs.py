"""Whole logs, and the folder that mapping one gives."""

from __future__ import annotations

import ctypes
import functools
import json
import os
import pathlib
import shutil
import tempfile
from typing import Any, Mapping, Sequence

import numpy as np

from . import _library
from ._arrays import Grid, make_grid, poses_view
from ._callers import Caller, ProgressFunction, WarnFunction
from ._errors import BY_STATUS, Error, Interrupted, UsageError
from ._library import CError, CMapRequest, CPictureRequest, Handle, call, encoded, library, make, plain, when_gone
from ._scans import MOST_WHOLE, Options, Path, log_list, make_options, whole


def _absolute(folder: Path) -> "bytes | None":
    """Of a run, whose files are read later, wherever the process is by then. An empty name stays one."""
    given = encoded(folder)
    return os.path.join(os.getcwdb(), given) if given and not os.path.isabs(given) else given


class Run:
    """The folder of a run of `gdtslam map`. Each part is read when it is asked for, once."""

    def __init__(self, folder: Path) -> None:
        self._keep_folder: Any = None
        self._given = os.fsdecode(folder)
        self._handle = make("run", "run_open", _absolute(folder))

    @classmethod
    def _of(cls, handle: Handle, given: Path, keep_folder: Any) -> "Run":
        run = cls.__new__(cls)
        run._keep_folder = keep_folder  # a temporary one goes with the run
        run._given = os.fsdecode(given)
        run._handle = handle
        return run

    @property
    def folder(self) -> pathlib.Path:
        return pathlib.Path(os.fsdecode(plain("run_folder", self._handle)))

    @property
    def map_sha256(self) -> str:
        """Of the distance field: the same on every machine."""
        return plain("run_map_sha256", self._handle).decode()

    @property
    def trajectory_sha256(self) -> str:
        """Of the poses: the same on every machine."""
        return plain("run_trajectory_sha256", self._handle).decode()

    @functools.cached_property
    def report(self) -> "dict[str, Any]":
        """report.json."""
        return json.loads(plain("run_report", self._handle))

    @functools.cached_property
    def trajectory(self) -> np.ndarray:
        """The robot's poses, one a scan: shape (scans, 4), float64: stamp in s, x and y in m, theta in rad.

        In full where the run was just made; of a run that was opened as trajectory.tum has them, nine decimals.
        """
        poses, count = ctypes.c_void_p(), ctypes.c_size_t()
        call("run_trajectory", self._handle, ctypes.byref(poses), ctypes.byref(count))
        return poses_view(self._handle, poses.value, count.value)

    @functools.cached_property
    def map(self) -> Grid:
        """The occupancy map, shape (height, width), uint8: 0 occupied, 254 free, 205 unknown."""
        return make_grid(make("grid", "run_map", self._handle))

    @functools.cached_property
    def field(self) -> Grid:
        """The distance field, shape (height, width), uint16: 1/256 cell to the nearest obstacle."""
        return make_grid(make("grid", "run_field", self._handle))

    def render(
        self,
        view: str = "map",
        *,
        format: str = "png",
        size: "tuple[int, int] | None" = None,
        title: "str | None" = None,
        colour_map: "str | None" = None,
    ) -> bytes:
        """A picture as the bytes of a file.

        Args:
            view: "map", "graph", "field" or "distance", as `gdtslam render --view` draws them.
            format: "png", "svg" or "pdf".
            size: width and height in pixels; what suits the map where it is None.
            title: the log's name where it is None.
            colour_map: of the field: "glow", "lagoon" and the others of `gdtslam render --help`.
        """
        width, height = size or (0, 0)
        if size is not None and not (0 < width < 1 << 31 and 0 < height < 1 << 31):
            raise UsageError(f"a picture of {width}x{height} pixels cannot be made")
        request = CPictureRequest(
            view=encoded(view),
            format=encoded(format),
            width=width,
            height=height,
            title=encoded(title),
            colour_map=encoded(colour_map),
        )
        made = make("bytes", "run_render", self._handle, ctypes.byref(request))
        return ctypes.string_at(plain("bytes_data", made), plain("bytes_count", made))

    def _repr_svg_(self) -> str:
        return self.render(format="svg").decode()

    def __repr__(self) -> str:
        report = self.report
        return f"<gdtslam.Run {self._given!r}: {report['scans']} scans, map {self.map_sha256[:12]}>"


class TemporaryFolder:
    """A folder that goes with the last reference to this."""

    def __init__(self) -> None:
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="gdtslam-"))
        when_gone(self, shutil.rmtree, self.path, True)  # whatever cannot be removed


def thread_count(threads: "int | None") -> int:
    """As the library counts them: 0 is its default, and the largest number one a processor."""
    if threads is None:
        return 0
    return whole("threads", threads, 0, _library.MOST_THREADS) or _library.ALL_PROCESSORS


def _flags(**wanted: bool) -> int:
    return sum(getattr(_library, name) for name, is_set in wanted.items() if is_set)


def map(  # noqa: A001 - the word of the field, as gdtslam.map
    logs: "Path | Sequence[Path]",
    out: "Path | None" = None,
    *,
    options: Options = None,
    topics: "Sequence[str] | str" = (),
    odometry: "str | None" = None,
    crank: "str | None" = None,
    mount: "Mapping[str, Sequence[float]] | Sequence[float] | None" = None,
    linkage: "Path | None" = None,
    loops: bool = True,
    occupancy: bool = True,
    pictures: bool = True,
    cloud: bool = True,
    lenient: bool = False,
    replace_foreign: bool = False,
    threads: "int | None" = None,
    skip: int = 0,
    count: "int | None" = None,
    progress: "ProgressFunction | None" = None,
    warn: "WarnFunction | None" = None,
) -> Run:
    """Maps a log: what `gdtslam map` does, with the same bytes in the folder.

    Args:
        logs: one file of any format that the command reads, or several, which are mapped as one.
        out: folder of the results; a temporary one, which goes with the run that is returned, where it is None.
        options: {"map.resolution": "5 cm"} or a configuration file; options() lists all.
        topics, odometry, crank, mount: as scans(); the crank's topic of a nodding mount.
        linkage: of a laser that nods: preset or file.
        loops, occupancy, pictures, cloud: False leaves the part out, as --no-loops and the like do.
        lenient: count and skip what is malformed.
        replace_foreign: remove files in the folder that no run wrote; else it is refused.
        threads: of the processor; 0 is one a processor. Results are the same.
        skip, count: scans that are left out at the start, and that are mapped.
        progress: called with the step at work, the scans so far and the share that is done, or None; ends the work
            where it returns something true, which raises Interrupted.
        warn: called with each line that a user should see, what was skipped or mended in the log among them; Python's
            warnings where it is None.
    """
    if out is not None and not os.fspath(out):
        raise UsageError("out: an empty name is no folder; name one, or leave it out for a temporary one")
    temporary = TemporaryFolder() if out is None else None
    folder = temporary.path / "run" if temporary is not None else pathlib.Path(out)  # type: ignore[arg-type]
    whole_path = _absolute(folder)
    paths = log_list(logs)
    options_handle = make_options(options, topics, odometry, crank, mount)
    caller = Caller(progress, warn)
    request = CMapRequest(
        logs=_library.text_list(paths),
        log_count=len(paths),
        folder=whole_path,
        options=options_handle.pointer,
        linkage=encoded(linkage),
        flags=_flags(
            LENIENT=lenient,
            NO_LOOPS=not loops,
            NO_MAP=not occupancy,
            NO_PICTURES=not pictures,
            NO_CLOUD=not cloud,
            REPLACE_FOREIGN=replace_foreign,
        ),
        threads=thread_count(threads),
        skip=whole("skip", skip, 0, MOST_WHOLE),
        scan_count=0 if count is None else whole("count", count, 1, MOST_WHOLE),
        progress=caller.progress,
        warn=caller.warn,
    )
    error, pointer = CError(), ctypes.c_void_p()
    with caller:
        status = library.gdtslam_map_logs(ctypes.byref(request), ctypes.byref(pointer), ctypes.byref(error))
        made = Run._of(Handle("run", pointer), folder, temporary) if pointer else None
    if status == 0 and made is not None:
        return made
    as_given = error.text.replace(whole_path or b"", encoded(folder) or b"")
    problem = BY_STATUS.get(status, Error)(as_given.decode("utf-8", "replace"))
    if isinstance(problem, Interrupted):
        problem.run = made  # type: ignore[assignment]
    raise problem


def _require_not_of_run(file: pathlib.Path, folder: pathlib.Path, names: "set[str]") -> None:
    """Raises UsageError for a file of the run in that folder, by whatever links or `..` it is named."""
    place, run = pathlib.Path(os.path.realpath(file)), pathlib.Path(os.path.realpath(folder))
    if run not in place.parents:
        return
    name = place.relative_to(run).parts[0]
    if name in names or name in ("report.json", "tiles") or name.startswith(".gdtslam-staging-"):
        raise UsageError(f"'{file}' is a file of '{folder}', which is read; give another file")


def _write_whole(file: pathlib.Path, data: bytes) -> None:
    """Where writing fails the old file stays as it was. A link is followed; a device or a pipe is written directly."""
    target = pathlib.Path(os.path.realpath(file))
    if target.exists() and not target.is_file():
        file.write_bytes(data)
        return
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(data)
        if target.exists():
            shutil.copymode(target, temporary)
        temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def render(run: "Run | Path", file: "Path | None" = None, view: str = "map", **how: Any) -> bytes:
    """A picture of a run or of its folder, written to a file by its ending (.png, .svg, .pdf) where one is named.

    The file appears whole or stays as it was. The run's own files are refused: with one of another content the run
    could not be read any more.
    """
    opened = run if isinstance(run, Run) else Run(run)
    if file is None:
        return opened.render(view, **how)
    path = pathlib.Path(file)
    _require_not_of_run(path, opened.folder, {name for name, *_ in opened.report.get("files", ())})
    how.setdefault("format", path.suffix.lstrip(".").lower())
    picture = opened.render(view, **how)
    _write_whole(path, picture)
    return picture
