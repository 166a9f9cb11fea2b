"""What lies in a folder, to be compared: a digest of each file by its name. Of JSON and tables, values that differ between
undisturbed runs, as times do, are left out by their names or columns; dates and seconds of pages are, too."""

import hashlib
import json
import os
import pathlib
import re

PAGES = (".html", ".md")
DATE = rb"\d{4}-\d\d-\d\d \d\d:\d\d UTC"
DATES = re.compile(DATE)
MOMENTS = re.compile(DATE + rb"|\b\d+\.\d s\b|\b\d+:\d\d min\b")


def has_values(path):
    return path.suffix in (".json", ".tsv")


def values_of(path):
    """JSON, or the rows of a table."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".json":
        return [json.loads(text)]
    return [{f"column {number}": field for number, field in enumerate(line.split("\t"))} for line in text.splitlines()]


def without(value, keys, place=""):
    """The value with what has those names, as log/wall_s, taken out."""
    if isinstance(value, dict):
        return {key: without(item, keys, f"{place}/{key}") for key, item in value.items() if f"{place}/{key}" not in keys}
    if isinstance(value, list):
        return [without(item, keys, place) for item in value]
    return value


def digest_of(path, keys):
    if path.is_symlink():
        return f"link to {os.readlink(path)}"
    if path.is_dir():
        return "folder"
    content = path.read_bytes()
    if has_values(path):
        try:
            content = "\n".join(json.dumps(without(value, keys)) for value in values_of(path)).encode()
        except ValueError:
            pass  # compared as it is
        content = DATES.sub(b"", content)
    elif path.suffix in PAGES:
        content = MOMENTS.sub(b"", content)
    return hashlib.sha256(content).hexdigest()


def digests_of(folder, keys=()):
    return {str(path.relative_to(folder)): digest_of(path, keys) for path in sorted(pathlib.Path(folder).rglob("*"))}


def differing(values, place, keys):
    """Adds the names of the values that are not all the same."""
    if all(isinstance(value, dict) and value.keys() == values[0].keys() for value in values):
        for key in values[0]:
            differing([value[key] for value in values], f"{place}/{key}", keys)
    elif all(isinstance(value, list) and len(value) == len(values[0]) for value in values):
        for items in zip(*values):
            differing(list(items), place, keys)
    elif any(value != values[0] for value in values):
        keys.add(place)


def volatile_keys(folders):
    """Names in JSON files whose values differ between runs of the same command, in these folders."""
    keys = set()
    for path in sorted(folders[0].rglob("*")):
        twins = [folder / path.relative_to(folders[0]) for folder in folders]
        if path.is_file() and has_values(path) and all(twin.is_file() for twin in twins):
            for values in zip(*map(values_of, twins)):
                differing(list(values), "", keys)
    return keys


def differences(found, expected):
    """In words: what is missing, what is too much, what is other than expected."""
    words = {"missing": sorted(expected.keys() - found.keys()), "too much": sorted(found.keys() - expected.keys()),
             "other": sorted(name for name in found.keys() & expected.keys() if found[name] != expected[name])}
    return "; ".join(f"{word}: {', '.join(names[:6])}{' ...' if len(names) > 6 else ''}" for word, names in words.items() if names)
