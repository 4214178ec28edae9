"""The files of tests/sessions, read as tests/sessions/table.json says (its README has the table's form)."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import pytest

import neuralmls as nm

FOLDER = Path(__file__).parent / "sessions"
TABLE: list[dict[str, Any]] = json.loads((FOLDER / "table.json").read_text(encoding="utf-8"))
KINDS = {"file": nm.FileError, "control point": nm.ControlPointError, "argument": nm.ArgumentError}


def name_of(entry: dict[str, Any]) -> str:
    return "+".join(entry["files"]) + ("-by-order" if entry.get("by_order") else "")


def read(entry: dict[str, Any]) -> nm.Session:
    source, *targets = (FOLDER / name for name in entry["files"])
    return nm.Session.read(source, *targets, by_order=entry.get("by_order", False))


def told(session: nm.Session, again: Path) -> dict[str, Any]:
    """The session in the table's form: what Python's names have, the rest as the session file has it."""
    session.write(again)
    document = json.loads(again.read_text(encoding="utf-8"))
    assert (document.pop("format"), document.pop("version")) == ("neuralmls-control-points", 2)
    points = session.points
    listed = []
    for i, kept in enumerate(document.pop("control_points")):
        one = {"name": points.names[i], "position": points.sources[i].tolist(), "target": points.targets[i].tolist()}
        others = {key: value for key, value in kept.items() if key not in (*one, "weight")}
        if (oriented := points.orientations[i]) is not None:
            one["orientation"] = {"axis": oriented.axis, "degrees": oriented.degrees, "scale": oriented.scale}
            others.pop("scale", None)
            rotation = others.pop("rotation", {})
            unknown = {key: value for key, value in rotation.items() if key not in ("axis", "degrees")}
            others |= {"rotation": unknown} if unknown else {}
        if points.weights[i] != 1:
            one["weight"] = float(points.weights[i])
        one |= {key: others.pop(key) for key in ("locked", "mirror_of", "group") if key in others}
        listed.append(one | ({"others": others} if others else {}))
    if session.has_settings:
        assert same(known(document["settings"], session.settings), session.settings)
    else:
        assert "settings" not in document
    frame = document.get("frame")
    corners = None if frame is None else [frame["min"], frame["max"]]
    assert same(corners, None if session.frame is None else session.frame.tolist())
    return {"points": listed, "keys": document, "notes": list(session.notes)}


def known(document: Any, settings: Any) -> Any:
    """What a file says without the keys of other programs."""
    if not isinstance(document, dict) or not isinstance(settings, dict):
        return document
    return {key: known(document[key], settings[key]) for key in document if key in settings}


def same(a: Any, b: Any) -> bool:
    """Whether two values say the same, numbers bit for bit, however they are written."""
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if any(isinstance(value, (bool, str, type(None))) for value in (a, b)):
        return type(a) is type(b) and bool(a == b)
    if isinstance(a, int) and isinstance(b, int):
        return a == b
    return isinstance(a, (int, float)) and isinstance(b, (int, float)) and bits(a) == bits(b)


def bits(number: float) -> bytes:
    return struct.pack("<d", number)


@pytest.mark.parametrize("entry", [entry for entry in TABLE if "read" in entry], ids=name_of)
def test_every_file_is_read_as_the_table_says_and_writing_it_says_the_same_again(entry, tmp_path):
    session = read(entry)
    found = told(session, tmp_path / "again.json")
    assert same(found, entry["read"]), json.dumps(found, ensure_ascii=False)
    again = nm.Session.read(tmp_path / "again.json")
    assert again.notes == ()
    assert same(told(again, tmp_path / "third.json"), {**entry["read"], "notes": []})
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "third.json").read_bytes()


@pytest.mark.parametrize("entry", [entry for entry in TABLE if "error" in entry], ids=name_of)
def test_every_broken_file_is_refused_as_the_table_says(entry):
    with pytest.raises(nm.NeuralMLSError) as caught:
        read(entry)
    error = entry["error"]
    assert type(caught.value) is KINDS[error["kind"]]
    paths = [str(FOLDER / name) for name in entry["files"]]
    # Of two files, the sentence is about one of them or about both.
    prefixes = [*paths, " and ".join(paths)]
    assert str(caught.value) in [f"{prefix}: {error['sentence']}" for prefix in prefixes]


def test_the_table_holds_enough_of_every_kind():
    assert len({name for entry in TABLE for name in entry["files"]}) >= 60
    assert {entry["error"]["kind"] for entry in TABLE if "error" in entry} <= KINDS.keys()
