"""Structs, constants and functions for ctypes, read from gdtslam.h, so that nothing of it stands here twice."""

from __future__ import annotations

import ctypes
import pathlib
import re
from ctypes import POINTER, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any

NUMBERS = {"double": c_double, "int32_t": c_int32, "uint32_t": c_uint32, "uint64_t": c_uint64, "size_t": c_size_t}
NAME = r"gdtslam_\w+"


class Struct(ctypes.Structure):
    """A struct of the header; one that begins with its size has it set, and the rest is 0."""

    def __init__(self, *members: Any, **named: Any) -> None:
        if self._fields_[0][0] == "size":
            named = {"size": ctypes.sizeof(type(self)), **named}
        super().__init__(*members, **named)


class Header:
    """What the text of the header declares."""

    def __init__(self, text: str, array_lengths: "dict[str, int] | None" = None) -> None:
        """array_lengths: of members "struct.member" that are longer here than in the header."""
        text = re.sub(r"/\*.*?\*/|^#.*?(?<!\\)$", "", text, flags=re.DOTALL | re.MULTILINE)
        self._lengths = array_lengths or {}
        self._types: "dict[str, Any]" = {**NUMBERS, "gdtslam_status": c_int32}
        self.constants = {name: int(value) for name, value in re.findall(r"(GDTSLAM_\w+) = (\d+)", text)}
        self.functions: "dict[str, tuple[Any, list[Any]]]" = {}
        pattern = rf"typedef struct {NAME} \{{(.*?)\}} ({NAME});|typedef (\w+) \(\*({NAME})\)\((.*?)\);|GDTSLAM_API ([^;(]*?)({NAME})\((.*?)\);"
        for found in re.finditer(pattern, text, re.DOTALL):
            members, struct, result, callback, parameters, returned, function, arguments = found.groups()
            if struct:
                fields = [self._member(struct, line) for line in filter(None, map(str.strip, members.split(";")))]
                self._types[struct] = type(struct, (Struct,), {"_fields_": fields})
            elif callback:
                self._types[callback] = ctypes.CFUNCTYPE(self._type(result), *map(self._parameter, parameters.split(",")))
            else:
                taken = [] if arguments.strip() == "void" else [self._parameter(argument) for argument in arguments.split(",")]
                self.functions[function] = self._type(returned), taken

    def __getitem__(self, name: str) -> Any:
        """The struct or callback "scan" of gdtslam_scan."""
        return self._types["gdtslam_" + name]

    def _type(self, text: str) -> Any:
        words = text.replace("const", "").split()
        base, stars = "".join(words).rstrip("*"), "".join(words).count("*")
        if stars == 0:
            return None if base == "void" else self._types[base]
        if base == "char":
            return c_char_p if stars == 1 else POINTER(c_char_p)
        if stars == 2:
            return POINTER(c_void_p)
        # Structs and numbers that are filled in; what is opaque, and arrays of numbers, are addresses.
        return POINTER(self._types[base]) if base in self._types else c_void_p

    def _parameter(self, text: str) -> Any:
        return self._type(re.sub(r"\w+\s*$", "", text.strip()))

    def _member(self, struct: str, text: str) -> "tuple[str, Any]":
        found = re.fullmatch(r"(.*?)(\w+)(?:\[(\d+)\])?", text, re.DOTALL)
        assert found is not None, text
        type_text, name, length = found.groups()
        if length is None:
            return name, self._type(type_text)
        element = ctypes.c_char if type_text.strip() == "char" else self._type(type_text)
        return name, element * self._lengths.get(f"{struct}.{name}", int(length))


def read_header() -> Header:
    """Beside this file, where it is installed; else in the sources of the project."""
    here = pathlib.Path(__file__).resolve().parent
    places = (here / "gdtslam.h", here.parents[1] / "engine/c/include/gdtslam.h")
    file = next((place for place in places if place.is_file()), places[0])
    # A path may be longer than the text that the header leaves for an error: the library fills what size says.
    return Header(file.read_text(encoding="utf-8"), {"gdtslam_error.text": 4084})
