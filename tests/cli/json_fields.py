"""Compares JSON outputs with docs/reference/json.md: the keys that are written are those of the table of the output."""

import functools
import json
import pathlib
import re

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/reference/json.md"
ABSENT = ", may be absent"
TYPES = {"text": str, "object": dict, "list": list, "true or false": bool, "number": (int, float), "whole number": int,
         "null": type(None)}


@functools.cache
def table_of(output):
    """The types of each field, and whether it may be absent, by its path: "loops.closures[].on"."""
    section = PAGE.read_text().split(f"<!-- {output} -->")[1].split("\n## ")[0]
    fields = {}
    for row in section.split("|---|---|---|---|\n")[1].splitlines():
        if not row:
            continue
        path, words = re.fullmatch(r"\| `(\S+)` \| (.+?) \| .*? \| [A-Z0-9'`](?:.*[^.])? \|", row).groups()
        types, may_be_absent = fields.get(path, ([], False))
        fields[path] = (types + [words.removesuffix(ABSENT)], may_be_absent or words.endswith(ABSENT))
    return fields


def has_type(value, words):
    """Whether the value is one of "number, or null", "one of found, given", or "list of: text"."""
    if words.startswith("one of "):
        return ("null" if value is None else str(value)) in words.removeprefix("one of ").split(", ")
    for word in words.split(", or "):
        kind = TYPES.get(word.partition(" of: ")[0])
        if value == json.loads(word) if kind is None else isinstance(value, kind) and isinstance(value, bool) <= (kind is bool):
            return True
    return False


def children_of(fields, path):
    """The fields of the object at the path, by their names; none where its members may have any name."""
    begin = f"{path}." if path else ""
    return {field[len(begin):]: field for field in fields
            if field.startswith(begin) and not re.search(r"[.\[]", field[len(begin):])}


def faults_of(value, fields, path=""):
    """What the output and its table disagree about."""
    if isinstance(value, list):
        return [fault for entry in value for fault in faults_of(entry, fields, f"{path}[]")]
    if not isinstance(value, dict):
        return []
    known = children_of(fields, path)
    faults = [f"{field} is not written" for name, field in known.items() if name not in value and not fields[field][1]]
    for name, member in value.items():
        field = known.get(name, f"{path}.*")
        if name in known and not any(has_type(member, words) for words in fields[field][0]):
            faults.append(f"{field} is {member!r}, which is not {' or '.join(fields[field][0])}")
        if name not in known and known:
            faults.append(f"{path}.{name} has no row")
        faults += faults_of(member, fields, field)
    return faults
