#!/usr/bin/env python3
"""Writes the page of JSON outputs from their schemas: json_reference.py SCHEMA_FOLDER. Each field with its type, its unit,
which its name ends in, and its description."""

import json
import pathlib
import sys

# What a name ends in, the longest first, and the unit that it means.
UNITS = (("_rad_per_m", "rad/m"), ("_deg_per_mm", "deg/mm"), ("_deg_per_m", "deg/m"), ("_per_rad", "1/rad"),
         ("_rad_s", "rad/s"), ("_m_s", "m/s"), ("bytes_per_s", "B/s"), ("_per_s", "1/s"), ("_cpu_s", "CPU s"), ("cpu_s", "CPU s"),
         ("_m2", "m2"), ("_ms", "ms"), ("_ns", "ns"), ("_hz", "Hz"), ("_rad", "rad"), ("_deg", "deg"), ("_bytes", "B"),
         ("_cells", "cells"), ("_share", "0 to 1"), ("_m", "m"), ("_s", "s"))


def unit_of(name):
    """ "m" of "offset_m"; empty where a name tells none."""
    return next((unit for ending, unit in UNITS if name == ending or name.endswith(ending)), "")


def resolved(schema, root):
    """The schema itself, or the definition that it refers to, with its own description."""
    if "$ref" not in schema:
        return schema
    return {**root["definitions"][schema["$ref"].rsplit("/", 1)[1]], **{k: v for k, v in schema.items() if k != "$ref"}}


def alternatives(schema, root):
    """The schemas that a value may meet."""
    schema = resolved(schema, root)
    for word in ("anyOf", "oneOf"):
        if word in schema and "properties" not in schema:
            return [part for choice in schema[word] for part in alternatives(choice, root)]
    return [schema]


def type_of(schema, root):
    """ "number, or null", "list of: text", "one of found, given"."""
    names = {"string": "text", "object": "object", "array": "list", "boolean": "true or false", "integer": "whole number"}
    words = []
    for part in alternatives(schema, root):
        if "const" in part:
            words.append(json.dumps(part["const"]))
        elif "enum" in part:
            words.append("one of " + ", ".join("null" if value is None else str(value) for value in part["enum"]))
        else:
            types = part.get("type", "object" if "properties" in part else "any")
            for word in types if isinstance(types, list) else [types]:
                word = names.get(word, word)
                if word == "list" and isinstance(part.get("items"), dict):
                    word = f"list of: {type_of(part['items'], root)}"
                words.append(word)
    return ", or ".join(dict.fromkeys(words))


def rows_of(schema, root, path, is_required=True):
    """A row for each field of an object, those within it after it."""
    rows = []
    for part in alternatives(schema, root):
        if isinstance(part.get("items"), dict):
            rows += rows_of(part["items"], root, path + "[]")
        for name, field in part.get("properties", {}).items():
            place = f"{path}.{name}" if path else name
            optional = "" if name in part.get("required", []) else ", may be absent"
            text = resolved(field, root).get("description", "")
            rows.append((place, type_of(field, root) + optional, unit_of(name), text))
            rows += rows_of(field, root, place)
        if isinstance(part.get("additionalProperties"), dict):
            rows += rows_of(part["additionalProperties"], root, path + ".*")
    return list(dict.fromkeys(rows))


def section_of(file):
    schema = json.loads(file.read_text(encoding="utf-8"))
    description = schema["description"]
    lines = [f"## {schema['title']}", "", description[0].upper() + description[1:] + f". Schema `{file.name}`.", "",
             "| field | type | unit | |", "|---|---|---|---|"]
    for row in rows_of(schema, schema, ""):
        lines.append("| " + " | ".join([f"`{row[0]}`", *(cell.replace("|", "\\|") for cell in row[1:])]) + " |")
    return "\n".join(lines) + "\n"


def page_of(folder):
    files = sorted(pathlib.Path(folder).glob("*.schema.json"))
    titles = [json.loads(file.read_text(encoding="utf-8"))["title"] for file in files]
    intro = ("# JSON outputs\n\nWhat `--json` of each command prints, and the JSON files that commands write. The page is made of\n"
             "the schemas by `tools/scripts/make_reference.sh`; they are installed as `share/gdtslam/schemas/*.schema.json`\n"
             "(JSON Schema draft 7), so that a program can check what it reads. `[]` stands for each entry of a list, `*` for a\n"
             "member of any name. Numbers that are not finite are `null`, a list of numbers is one line, and keys keep their order.\n")
    return intro + "\n" + "\n".join(section_of(file) for _, file in sorted(zip(titles, files)))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("Usage: tools/scripts/json_reference.py SCHEMA_FOLDER")
    print(page_of(sys.argv[1]), end="")
