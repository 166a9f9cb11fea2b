"""The shared library and what gdtslam.h says of it. Nothing here is for users of the package."""

from __future__ import annotations

import ctypes
import os
import pathlib
import weakref
from ctypes import c_char_p, c_void_p
from typing import Any, Callable

from ._errors import BY_STATUS, Error, UsageError
from ._header import read_header

HEADER = read_header()
LENIENT, NO_LOOPS, NO_MAP, NO_PICTURES, NO_CLOUD, REPLACE_FOREIGN, NO_RUNNER_UP = (
    HEADER.constants["GDTSLAM_" + name]
    for name in ("LENIENT", "NO_LOOPS", "NO_MAP", "NO_PICTURES", "NO_CLOUD", "REPLACE_FOREIGN", "NO_RUNNER_UP")
)
ALL_PROCESSORS, MOST_THREADS = 0xFFFFFFFF, 1024

Progress, Warn = HEADER["progress"], HEADER["warn"]
CError, COption, CPose, CScan = HEADER["error"], HEADER["option"], HEADER["pose"], HEADER["scan"]
CLogWarning, CReaderRequest, CGridView = HEADER["log_warning"], HEADER["reader_request"], HEADER["grid_view"]
CMapRequest, CPictureRequest = HEADER["map_request"], HEADER["picture_request"]
CMapperRequest, CMatch = HEADER["mapper_request"], HEADER["match"]
CLocalizerRequest, CLocation, CTracked = HEADER["localizer_request"], HEADER["location"], HEADER["tracked"]


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
    for name, (result, arguments) in HEADER.functions.items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, result
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
