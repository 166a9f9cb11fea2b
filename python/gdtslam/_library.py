"""The shared library and what gdtslam.h says of it. Nothing here is for users of the package."""

from __future__ import annotations

import ctypes
import os
import pathlib
import weakref
from ctypes import POINTER, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any, Callable

from ._errors import BY_STATUS, Error, UsageError

LENIENT, NO_LOOPS, NO_MAP, NO_PICTURES, NO_CLOUD, REPLACE_FOREIGN, NO_RUNNER_UP = 1, 2, 4, 8, 16, 64, 128
ALL_PROCESSORS, MOST_THREADS = 0xFFFFFFFF, 1024

Progress = ctypes.CFUNCTYPE(c_int32, c_void_p, c_char_p, c_uint64, c_double)
Warn = ctypes.CFUNCTYPE(None, c_void_p, c_char_p)


class Struct(ctypes.Structure):
    """A struct that begins with its size, which is set; the rest is 0."""

    def __init__(self, **members: Any) -> None:
        super().__init__(size=ctypes.sizeof(type(self)), **members)


class CPose(ctypes.Structure):
    _fields_ = [("x", c_double), ("y", c_double), ("theta", c_double)]


class CError(Struct):
    _fields_ = [("size", c_size_t), ("status", c_int32), ("text", ctypes.c_char * 4084)]


class COption(Struct):
    _fields_ = [("size", c_size_t), ("path", c_char_p), ("doc", c_char_p), ("value", c_char_p)]


class CScan(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("stamp", c_double),
        ("first", c_double),
        ("step", c_double),
        ("ranges", c_void_p),
        ("range_count", c_size_t),
        ("max_range", c_double),
        ("mount", CPose),
        ("first_beam_after", c_double),
        ("beam_period", c_double),
        ("has_odometry", c_int32),
        ("has_speed", c_int32),
        ("odometry", CPose),
        ("speed", CPose),
        ("laser", c_uint64),
    ]


class CLogWarning(Struct):
    _fields_ = [("size", c_size_t), ("kind", c_char_p), ("first", c_char_p), ("count", c_uint64)]


class CReaderRequest(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("logs", POINTER(c_char_p)),
        ("log_count", c_size_t),
        ("options", c_void_p),
        ("flags", c_uint32),
        ("reserved", c_uint32),
        ("progress", Progress),
        ("user_data", c_void_p),
    ]


class CGridView(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("cells", c_void_p),
        ("row_bytes", c_size_t),
        ("cell_bytes", c_size_t),
        ("width", c_int32),
        ("height", c_int32),
        ("resolution", c_double),
        ("origin_x", c_double),
        ("origin_y", c_double),
        ("cap", c_uint32),
    ]


class CMapRequest(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("logs", POINTER(c_char_p)),
        ("log_count", c_size_t),
        ("folder", c_char_p),
        ("options", c_void_p),
        ("linkage", c_char_p),
        ("flags", c_uint32),
        ("threads", c_uint32),
        ("skip", c_uint64),
        ("scan_count", c_uint64),
        ("progress", Progress),
        ("warn", Warn),
        ("user_data", c_void_p),
    ]


class CPictureRequest(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("view", c_char_p),
        ("format", c_char_p),
        ("width", c_uint32),
        ("height", c_uint32),
        ("title", c_char_p),
        ("colour_map", c_char_p),
    ]


class CMapperRequest(Struct):
    _fields_ = [("size", c_size_t), ("options", c_void_p), ("flags", c_uint32), ("threads", c_uint32)]


class CMatch(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("stamp", c_double),
        ("pose", CPose),
        ("predicted", CPose),
        ("correction", CPose),
        ("mean_distance", c_double),
        ("overlap", c_double),
        ("contradiction", c_double),
        ("points", c_uint32),
        ("doubt", c_int32),
        ("is_accepted", c_int32),
        ("is_keyframe", c_int32),
    ]


class CLocalizerRequest(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("map", c_char_p),
        ("options", c_void_p),
        ("flags", c_uint32),
        ("reserved", c_uint32),
        ("gap", c_double),
        ("max_seconds", c_double),
        ("good_fit", c_double),
    ]


class CLocation(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("verdict", c_int32),
        ("has_runner_up", c_int32),
        ("pose", CPose),
        ("mean_distance", c_double),
        ("proven_gap", c_double),
        ("runner_up", CPose),
        ("runner_up_mean_distance", c_double),
        ("points", c_uint32),
    ]


class CTracked(Struct):
    _fields_ = [
        ("size", c_size_t),
        ("whereabouts", c_int32),
        ("is_ambiguous", c_int32),
        ("pose", CPose),
        ("explained", c_double),
        ("mean_distance", c_double),
        ("covariance", c_double * 6),
    ]


HANDLE = c_void_p
# Of each function that can fail its arguments, without the error at their end.
CALLS: dict[str, list[Any]] = {
    "options_new": [POINTER(HANDLE)],
    "options_set": [HANDLE, c_char_p, c_char_p],
    "options_read": [HANDLE, c_char_p],
    "options_at": [HANDLE, c_size_t, POINTER(COption)],
    "options_add_topic": [HANDLE, c_char_p],
    "options_set_odometry": [HANDLE, c_char_p],
    "options_set_crank": [HANDLE, c_char_p],
    "options_add_mount": [HANDLE, c_char_p, POINTER(CPose)],
    "reader_new": [POINTER(CReaderRequest), POINTER(HANDLE)],
    "reader_next": [HANDLE, POINTER(CScan), POINTER(c_int32)],
    "reader_warning": [HANDLE, c_size_t, POINTER(CLogWarning), POINTER(c_int32)],
    "grid_look": [HANDLE, POINTER(CGridView)],
    "map_logs": [POINTER(CMapRequest), POINTER(HANDLE)],
    "run_open": [c_char_p, POINTER(HANDLE)],
    "run_trajectory": [HANDLE, POINTER(c_void_p), POINTER(c_size_t)],
    "run_map": [HANDLE, POINTER(HANDLE)],
    "run_field": [HANDLE, POINTER(HANDLE)],
    "run_render": [HANDLE, POINTER(CPictureRequest), POINTER(HANDLE)],
    "mapper_new": [POINTER(CMapperRequest), POINTER(HANDLE)],
    "mapper_process": [HANDLE, POINTER(CScan), POINTER(CMatch)],
    "mapper_close": [HANDLE, Progress, c_void_p],
    "mapper_trajectory": [HANDLE, POINTER(c_void_p), POINTER(c_size_t)],
    "mapper_field": [HANDLE, POINTER(HANDLE)],
    "localizer_new": [POINTER(CLocalizerRequest), POINTER(HANDLE)],
    "localizer_find": [HANDLE, POINTER(CScan), POINTER(CLocation)],
    "tracker_new": [HANDLE, POINTER(HANDLE)],
    "tracker_follow": [HANDLE, POINTER(CScan), POINTER(CTracked)],
}
# Of the others arguments and result.
PLAIN: dict[str, tuple[list[Any], Any]] = {
    "version": ([], c_char_p),
    "doubt_name": ([c_int32], c_char_p),
    "options_count": ([HANDLE], c_size_t),
    "reader_progress": ([HANDLE], c_double),
    "grid_sha256": ([HANDLE], c_char_p),
    "run_folder": ([HANDLE], c_char_p),
    "run_map_sha256": ([HANDLE], c_char_p),
    "run_trajectory_sha256": ([HANDLE], c_char_p),
    "run_report": ([HANDLE], c_char_p),
    "bytes_data": ([HANDLE], c_void_p),
    "bytes_count": ([HANDLE], c_size_t),
}
KINDS = ("options", "reader", "grid", "run", "bytes", "mapper", "localizer", "tracker")


def _load() -> ctypes.CDLL:
    named = os.environ.get("GDTSLAM_LIBRARY")
    beside = pathlib.Path(__file__).parent / "lib" / "libgdtslam.so.0"
    file = named or (str(beside) if beside.exists() else "libgdtslam.so.0")
    try:
        library = ctypes.CDLL(file)
    except OSError as problem:
        raise ImportError(
            f"gdtslam: {file} cannot be loaded ({problem}); install the library, or name its file in GDTSLAM_LIBRARY"
        ) from None
    for name, arguments in CALLS.items():
        function = getattr(library, "gdtslam_" + name)
        function.argtypes, function.restype = [*arguments, POINTER(CError)], c_int32
    for name, (arguments, result) in PLAIN.items():
        function = getattr(library, "gdtslam_" + name)
        function.argtypes, function.restype = arguments, result
    for kind in KINDS:
        function = getattr(library, f"gdtslam_{kind}_free")
        function.argtypes, function.restype = [HANDLE], None
    return library


library = _load()


def plain(name: str, *arguments: Any) -> Any:
    """Calls a function that cannot fail."""
    return getattr(library, "gdtslam_" + name)(*arguments)


def call(name: str, *arguments: Any) -> None:
    """Calls a function that can fail; raises what went wrong."""
    error = CError()
    status = getattr(library, "gdtslam_" + name)(*arguments, ctypes.byref(error))
    if status != 0:
        raise BY_STATUS.get(status, Error)(error.text.decode("utf-8", "replace"))


def _in_process(maker: int, function: "Callable[..., Any]", *arguments: Any) -> None:
    if os.getpid() == maker:
        function(*arguments)


def when_gone(owner: Any, function: "Callable[..., Any]", *arguments: Any) -> weakref.finalize:
    """Calls the function when the last reference to the owner is gone, or at the process's end.

    Not in a process that was forked off: the threads of what the library made are not in it, and would be waited for
    for ever, and its files are the other process's.
    """
    return weakref.finalize(owner, _in_process, os.getpid(), function, *arguments)


class Handle:
    """Something that the library made, freed with the last reference to this."""

    def __init__(self, kind: str, pointer: c_void_p) -> None:
        self.pointer = pointer
        # Not at the process's end: a thread may still be in the library with it then.
        when_gone(self, getattr(library, f"gdtslam_{kind}_free"), pointer).atexit = False

    @property
    def _as_parameter_(self) -> c_void_p:
        return self.pointer


def make(kind: str, name: str, *arguments: Any) -> Handle:
    """Calls a function whose last argument is the handle that it gives."""
    pointer = c_void_p()
    call(name, *arguments, ctypes.byref(pointer))
    return Handle(kind, pointer)


def encoded(text: "str | os.PathLike[str] | None") -> "bytes | None":
    """A path or text for the library, for which a NUL is the end of one."""
    if text is None:
        return None
    given = os.fsencode(text)
    if b"\0" in given:
        raise UsageError(f"{text!r} holds a NUL, which no path and no option can")
    return given


def text_list(texts: "list[bytes]") -> Any:
    return (c_char_p * len(texts))(*texts)
