"""The published schema of session files against the files of tests/sessions."""

import json
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).parent.parent
SCHEMA = json.loads((ROOT / "docs" / "session.schema.json").read_text(encoding="utf-8"))
SESSIONS = ROOT / "tests" / "sessions"
TABLE = json.loads((SESSIONS / "table.json").read_text(encoding="utf-8"))

# What a schema cannot say, or does not see: names and numbers, and what is no JSON though Python reads it.
BEYOND = (
    "is not finite",
    "is given to",
    "same place",
    "mirror image",
    "frame: ",
    "not all 0",
    "too large",
    "there twice",
    "not JSON",
    "surrogate",
)


def documents(key: str) -> dict[str, object]:
    """The JSON files that are read, or are refused for what a schema can see."""
    found = {}
    for entry in TABLE:
        name = entry["files"][0]
        if len(entry["files"]) > 1 or key not in entry or not name.startswith(("json/", "broken/")):
            continue
        if key == "error" and any(words in entry["error"]["sentence"] for words in BEYOND):
            continue
        try:
            found[name] = json.loads((SESSIONS / name).read_text(encoding="utf-8-sig"))
        except (ValueError, RecursionError):
            continue  # no JSON
    return found


READ, REFUSED = documents("read"), documents("error")


def test_the_schema_is_one() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", READ)
def test_files_that_are_read_are_valid(name: str) -> None:
    jsonschema.validate(READ[name], SCHEMA)


@pytest.mark.parametrize("name", REFUSED)
def test_files_of_the_wrong_structure_are_invalid(name: str) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(REFUSED[name], SCHEMA)
