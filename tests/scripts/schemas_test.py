"""The schemas of JSON outputs: each is one, says what each field is, and the page of them is up to date."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "tests/cli/schemas"
SCRIPT = ROOT / "tools/scripts/json_reference.py"


def fields_of(schema, path=""):
    """(path, schema) of every field, wherever a schema may have one."""
    if not isinstance(schema, dict):
        return
    for name, field in schema.get("properties", {}).items():
        yield f"{path}.{name}", field
        yield from fields_of(field, f"{path}.{name}")
    for name in ("items", "additionalProperties"):
        yield from fields_of(schema.get(name), f"{path}[{name}]")
    for word in ("anyOf", "oneOf", "allOf"):
        for choice in schema.get(word, []):
            yield from fields_of(choice, path)
    for name, part in schema.get("definitions", {}).items():
        yield from fields_of(part, f"{path}#{name}")


class Schemas(unittest.TestCase):
    def setUp(self):
        self.schemas = {file.name: json.loads(file.read_text()) for file in FOLDER.glob("*.schema.json")}
        self.assertGreater(len(self.schemas), 30)

    def test_each_is_a_schema_with_a_title_of_its_own(self):
        import jsonschema
        for schema in self.schemas.values():
            jsonschema.Draft7Validator.check_schema(schema)
        titles = [schema["title"] for schema in self.schemas.values()]
        self.assertEqual(len(titles), len(set(titles)))

    def test_each_says_what_it_and_each_of_its_fields_are(self):
        without = [name for name, schema in self.schemas.items() if not schema.get("description")]
        for name, schema in self.schemas.items():
            for path, field in fields_of(schema):
                text = field.get("description", "") if isinstance(field, dict) else ""
                if not re.match("[A-Z0-9'`]", text) or text.endswith("."):
                    without.append(f"{name}: {path}: {text!r}")
        self.assertEqual(without, [], "a description begins with a capital and has no full stop")

    def test_the_page_is_that_of_the_schemas(self):
        made = subprocess.run([sys.executable, SCRIPT, FOLDER], capture_output=True, text=True, check=True).stdout
        page = (ROOT / "docs/reference/json.md").read_text()
        self.assertEqual(page, made, "run tools/scripts/make_reference.sh")

    def test_the_page_has_a_row_for_each_field(self):
        with tempfile.TemporaryDirectory() as folder:
            schema = {"title": "a", "description": "What it is", "type": "object", "required": ["list"],
                      "definitions": {"point": {"type": "object", "properties": {"x_m": {"type": "number", "description": "X"}}}},
                      "properties": {"list": {"type": "array", "description": "All | of them",
                                              "items": {"anyOf": [{"$ref": "#/definitions/point"}, {"type": "null"}]}},
                                     "kind": {"enum": ["one", None], "description": "Kind"},
                                     "by": {"type": "object", "description": "By name",
                                            "additionalProperties": {"type": "object", "properties": {
                                                "n": {"type": ["integer", "null"], "description": "N"}}}}}}
            (pathlib.Path(folder) / "a.schema.json").write_text(json.dumps(schema))
            page = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=True).stdout
        rows = [line for line in page.splitlines() if line.startswith("| `")]
        self.assertEqual(rows, ["| `list` | list of: object, or null |  | All \\| of them |",
                                "| `list[].x_m` | number, may be absent | m | X |",
                                "| `kind` | one of one, null, may be absent |  | Kind |",
                                "| `by` | object, may be absent |  | By name |",
                                "| `by.*.n` | whole number, or null, may be absent |  | N |"])


if __name__ == "__main__":
    unittest.main()
