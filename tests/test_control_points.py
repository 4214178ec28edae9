"""Control points: what is accepted, what is refused and with which sentence, and the files that hold them."""

import json
import math
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from neuralmls import Orientation
from neuralmls.control_points import ControlPoints
from neuralmls.errors import ArgumentError, ControlPointError, FileError, NeuralMLSError

DOCS = Path(__file__).parent.parent / "docs"
SCHEMA = json.loads((DOCS / "session.schema.json").read_text(encoding="utf-8"))
SEAT = {"name": "seat", "position": [0, 0.45, 0]}
BACK = {"name": "back", "position": [0, 0.95, -0.2], "target": [0, 0.9, -0.4]}


def document(*entries: object, **changes: object) -> dict[str, object]:
    return {"format": "neuralmls-control-points", "version": 1, "control_points": list(entries)} | changes


def written(folder: Path, text: str, ending: str = "json") -> Path:
    path = folder / f"points.{ending}"
    path.write_text(text, encoding="utf-8")
    return path


def refusal(path: Path) -> str:
    with pytest.raises(NeuralMLSError) as caught:
        ControlPoints.read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message


def test_targets_default_to_sources_and_names_to_numbers() -> None:
    points = ControlPoints([[0, 0], [1, 0]])
    assert points.names == ("p1", "p2")
    assert points.targets.tolist() == points.sources.tolist() == [[0, 0], [1, 0]]


def test_nothing_can_be_changed_from_outside() -> None:
    sources = np.zeros((1, 3))
    points = ControlPoints(sources)
    sources[:] = 7.0
    assert points.sources.tolist() == [[0, 0, 0]]
    with pytest.raises(ValueError, match="read-only"):
        points.targets[0] = 1.0
    with pytest.raises(AttributeError):
        points.names = ("other",)  # type: ignore[misc]


@pytest.mark.parametrize("ending", ["json", "csv"])
@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_round_trip_gives_the_same_numbers_bit_for_bit(tmp_path: Path, ending: str, d: int) -> None:
    rng = np.random.default_rng(d)
    sources = rng.standard_normal((40, d)) * 10.0 ** rng.integers(-300, 300, (40, 1))
    sources[0, 0], sources[1, 0] = -0.0, math.nextafter(500_000.0, 0.0)
    names = [f'p "{i}", é\n' if i == 3 and ending == "json" else f"p {i}, é" for i in range(40)]
    points = ControlPoints(sources, sources[::-1], names)
    path = tmp_path / f"points.{ending}"
    points.write(path)
    back = ControlPoints.read(path)
    assert back.names == points.names
    assert back.sources.tobytes() == points.sources.tobytes()
    assert back.targets.tobytes() == points.targets.tobytes()
    if ending == "json":
        jsonschema.validate(json.loads(path.read_text(encoding="utf-8")), SCHEMA)


def test_the_documented_examples_are_read_and_valid(tmp_path: Path) -> None:
    page = (DOCS / "control-points.md").read_text(encoding="utf-8")
    examples = re.findall(r"```(json|csv)\n(.*?)```", page, flags=re.DOTALL)
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    read = []
    for ending, text in examples:
        if ending == "json":
            jsonschema.validate(json.loads(text), SCHEMA)
        read.append(ControlPoints.read(written(tmp_path, text, ending)))
    whole, held, table = read
    for points, oriented in ((whole, (Orientation((0, 1, 0), 40),)), (table, ())):
        assert points.names[:2] == ("seat", "back-top")
        assert points.sources[:2].tolist() == [[0, 0.45, 0], [0, 0.95, -0.2]]
        assert points.targets[:2].tolist() == [[0, 0.45, 0], [0, 0.9, -0.4]]
        assert points.orientations[2:] == oriented
    assert (held.locked.tolist(), held.groups) == ([True, False, False], (None, "seat", "seat"))


def test_unknown_keys_are_passed_over(tmp_path: Path) -> None:
    text = json.dumps(document(SEAT | {"colour": "red"}, BACK, author={"name": "me"}))
    jsonschema.validate(json.loads(text), SCHEMA)
    assert len(ControlPoints.read(written(tmp_path, text))) == 2


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ([SEAT], "expected a JSON object, found a list"),
        (document(SEAT, format="gltf"), 'format: expected "neuralmls-control-points", found "gltf"'),
        ({"control_points": [SEAT]}, "format: .* found nothing"),
        (document(SEAT, version=3), "version: expected 1 or 2, found 3"),
        (document(SEAT, version=True), "version: expected 1 or 2, found true"),
        (document(), r"control_points: expected a list with at least one control point, found \[\]"),
        (document(control_points={"seat": [0, 0, 0]}), "control_points: expected a list"),
        (document(SEAT, 3), r"control_points\[1\]: expected an object .* found a number"),
        (document({"position": [0, 0, 0]}), r"control_points\[0\].name: .* found nothing"),
        (
            document({"name": " ", "position": [0, 0, 0]}),
            r"control_points\[0\].name: expected a text that is not empty",
        ),
        (
            document({"name": "seat"}),
            r"control_points\[0\].position: expected a list of 1 to 3 numbers, found nothing",
        ),
        (
            document(SEAT, {"name": "back", "position": [1, 2]}),
            r"control_points\[1\].position: .* 3 numbers, found \[1, 2\]",
        ),
        (
            document(SEAT | {"position": [0, 1, 2, 3]}),
            r"control_points\[0\].position: expected a list of 1 to 3 numbers",
        ),
        (document(SEAT | {"position": [0, "1", 2]}), r'control_points\[0\].position: .* found \[0, "1", 2\]'),
        (document(SEAT | {"position": [0, True, 2]}), r"control_points\[0\].position"),
        (
            document(SEAT | {"target": None}),
            r"control_points\[0\].target: expected a list of 3 numbers, found null",
        ),
        (
            document(SEAT | {"target": [1, 2]}),
            r"control_points\[0\].target: expected a list of 3 numbers, found \[1, 2\]",
        ),
    ],
)
def test_json_of_the_wrong_structure_is_refused_by_us_and_by_the_schema(
    tmp_path: Path, content: object, says: str
) -> None:
    assert re.search(says, refusal(written(tmp_path, json.dumps(content))))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(content, SCHEMA)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (document(SEAT, SEAT | {"position": [1, 1, 1]}), "the name 'seat' is given to more than one"),
        (
            document(SEAT, BACK, BACK | {"name": "b2"}),
            r"'back' and 'b2' are at the same place, \(0, 0.95, -0.2\)",
        ),
        (document(SEAT | {"position": [0, math.nan, 0]}), "the position of 'seat' is not finite"),
        (
            document(SEAT | {"target": [0, math.inf, 0]}),
            r"the target of 'seat' is not finite: \(0.0, inf, 0.0\)",
        ),
        (document(SEAT | {"name": "\ud800"}), "surrogate"),
    ],
)
def test_unusable_control_points_are_refused_by_name(tmp_path: Path, content: object, says: str) -> None:
    path = written(tmp_path, json.dumps(content))
    assert re.search(says, refusal(path))
    with pytest.raises(ControlPointError):
        ControlPoints.read(path)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "the file is empty"),
        (" \n\n", "the file is empty"),
        ('{"format": \n oops}', "line 2, column 2: not JSON"),
        ('{"format": "neuralmls-control-points", "version": 1, "control_points": [', "not JSON"),
        ("[" * 200_000, "not JSON that can be read"),
        (json.dumps(document(SEAT | {"position": [10**400, 0, 0]})), "a number is too large"),
        (json.dumps(document(SEAT)).replace("0.45", "9" * 5000), "not JSON that can be read"),
    ],
)
def test_text_that_is_no_json_is_refused_with_its_place(tmp_path: Path, text: str, says: str) -> None:
    assert says in refusal(written(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("\n", "the file is empty"),
        ("name,x,y,z\n", "no control points below the header"),
        ("seat,high,1,2\n", "line 1: expected the header name,x,y,z"),
        ("name,x,z\nseat,0,1\n", "line 1: expected the header"),
        ("name,x,x\nseat,0,1\n", "line 1: the column 'x' is there twice"),
        ("name,x,source_x\nseat,0,1\n", "line 1: expected the header"),
        ("name,x,y,target_x\nseat,0,1,2\n", "line 1: expected all of the columns target_x,target_y or none"),
        ("name,x,y\nseat,0,1,2\n", "line 2: expected 3 columns as in the header, found 4"),
        ("name,x,y\n\n,0,1\n", "line 3: the control point has no name"),
        ("name,x,y\nseat,0\n", "line 2: expected a number for y of 'seat', found nothing"),
        ("name,x,y\nseat,0,1_000\n", "line 2: expected a number for y of 'seat', found 1_000"),
        ("name,x,y\nseat,0,top\n", "line 2: expected a number for y of 'seat', found top"),
        ("name,x,y\nseat,0,nan\n", "there are no control points: landmark 'seat' is left out: its position is nan"),
        ("name,x,y\nseat,0,inf\n", "the position of 'seat' is not finite"),
        ("name,x,target_x\na,0,1\nb,1,\nc,2,3\nc,4,4\n", "the name 'c' is given to more than one"),
        (
            "name,x,y,target_x,target_y\na,0,1,5,\n",
            "line 2: expected a number for target_y of 'a', found nothing",
        ),
        ('name,x\n"seat,0\n', "not CSV"),
    ],
)
def test_csv_is_refused_with_its_line(tmp_path: Path, text: str, says: str) -> None:
    assert says in refusal(written(tmp_path, text, "csv"))


def test_csv_as_spreadsheets_write_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "points.CSV"
    path.write_bytes(
        b"\xef\xbb\xbfNote,Name,source_x, source_y,target_x,target_y\r\n"
        b'x,"seat, left",1, 2,,\r\n\r\n,back,3,4,5e0,-6\r\n'
    )
    points = ControlPoints.read(path)
    assert points.names == ("seat, left", "back")
    assert points.sources.tolist() == [[1, 2], [3, 4]]
    assert points.targets.tolist() == [[1, 2], [5, -6]]


def test_files_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    assert "there is no such file" in refusal(tmp_path / "none.json")
    (tmp_path / "latin.csv").write_bytes(b"name,x\ncaf\xe9,1\n")
    assert "byte 10: expected UTF-8 text, found 0xe9" in refusal(tmp_path / "latin.csv")
    (tmp_path / "folder.json").mkdir()
    assert "cannot read" in refusal(tmp_path / "folder.json")


def test_writing_leaves_nothing_half_done(tmp_path: Path) -> None:
    points = ControlPoints([[0.0, 0.0]])
    with pytest.raises(FileError, match="there is no folder"):
        points.write(tmp_path / "none" / "points.json")
    with pytest.raises(FileError, match=r"ends in \.json or \.csv"):
        points.write(tmp_path / "points.yaml")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(FileError, match="this is a folder"):
        points.write(tmp_path / "folder.csv")
    old = written(tmp_path, "old")
    old.chmod(0o640)
    link = tmp_path / "link.json"
    link.symlink_to(old)
    points.write(link)
    assert link.is_symlink()
    assert len(ControlPoints.read(old)) == 1
    assert old.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.csv", "link.json", "points.json"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_full_disk_is_one_sentence() -> None:
    from neuralmls.files import write_atomically

    with pytest.raises(FileError, match="cannot write: No space left on device"):
        write_atomically("/dev/full", b"points")


@pytest.mark.parametrize(
    ("sources", "options", "says"),
    [
        ([], {}, "no control points"),
        (np.zeros((0, 3)), {}, "no control points"),
        ([[0, 0, 0, 0]], {}, "d = 1, 2 or 3"),
        ([0, 1, 2], {}, "d = 1, 2 or 3"),
        ([[0, 0], [1]], {}, "table of numbers"),
        ([["a"]], {}, "table of numbers"),
        ([[0, 0]], {"targets": [[0, 0, 0]]}, "as many targets as sources"),
        ([[0, 0]], {"names": ["a", "b"]}, "a name for each of 1"),
        ([[0, 0], [1, 1]], {"names": ["a", "a"]}, "'a' is given to more than one"),
        ([[0, 0], [-0.0, 0]], {"names": ["a", "b"]}, "'a' and 'b' are at the same place"),
        ([[0, np.nan]], {"names": ["a"]}, "position of 'a' is not finite"),
    ],
)
def test_bad_control_points_are_refused(sources: object, options: dict[str, object], says: str) -> None:
    with pytest.raises(ControlPointError, match=says):
        ControlPoints(sources, **options)  # type: ignore[arg-type]


def test_moved_adds_to_the_targets_of_the_named_only() -> None:
    points = ControlPoints([[0, 0], [1, 0]], [[0, 1], [1, 1]], ["seat", "back"])
    moved = points.moved({"back": (0.5, -1)})
    assert moved.targets.tolist() == [[0, 1], [1.5, 0]]
    assert moved.sources.tolist() == points.sources.tolist()
    assert points.targets.tolist() == [[0, 1], [1, 1]]


def test_moving_an_unknown_control_point_names_the_nearest() -> None:
    points = ControlPoints([[0, 0], [1, 0]], names=["seat", "back"])
    with pytest.raises(ArgumentError, match="no control point 'bakc'; the nearest name is 'back'"):
        points.moved({"bakc": (0, 0)})
    with pytest.raises(ArgumentError, match="'seat' needs 2 finite numbers"):
        points.moved({"seat": (0, 0, 0)})
    with pytest.raises(ArgumentError, match="'seat' needs 2 finite numbers"):
        points.moved({"seat": (0, math.nan)})
    with pytest.raises(ArgumentError, match="'seat' needs 2 finite numbers to move by, found 'up'"):
        points.moved({"seat": "up"})  # type: ignore[dict-item]


def test_control_points_far_outside_are_named() -> None:
    box = [[0, 0, 0], [1, 2, 1]]
    near = ControlPoints([[0.5, 1, 0.5], [0, -1, 0]], [[0.5, 9, 0.5], [0, -1, 0]])
    assert near.check(box) == []
    far = ControlPoints([[500, 1000, 500], [0, 1, 0]], [[500, 1000, 500], [0, 4000, 0]], ["seat", "back"])
    position, target = far.check(box)
    assert "position of 'seat' lies" in position
    assert "longest side is 2:" in position
    assert "target of 'seat' and 'back' lies" in target
    assert "3998 units" in target
    with pytest.raises(ControlPointError, match="3 coordinates each, but the shape has 2"):
        far.check([[0, 0], [1, 1]])


TURNED = {"name": "arm", "position": [1, 0, 0], "rotation": {"axis": [0, 2, 0], "degrees": 90}, "scale": 1.5}


def test_a_turned_control_point_is_read_as_a_person_writes_it(tmp_path: Path) -> None:
    jsonschema.validate(document(SEAT, TURNED), SCHEMA)
    points = ControlPoints.read(written(tmp_path, json.dumps(document(SEAT, TURNED))))
    assert points.rotations is not None
    assert points.scales is not None
    assert np.isnan(points.rotations[0]).all()
    assert np.isnan(points.scales[0])
    assert np.allclose(points.rotations[1], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-15)
    assert points.scales[1] == 1.5
    held = ControlPoints.read(written(tmp_path, json.dumps(document({"name": "a", "position": [0, 0, 0], "scale": 2}))))
    assert held.rotations is not None
    assert held.rotations[0].tolist() == np.eye(3).tolist()


def test_without_turns_there_are_no_rotations_and_files_are_as_before(tmp_path: Path) -> None:
    points = ControlPoints.read(written(tmp_path, json.dumps(document(SEAT, BACK))))
    assert points.rotations is None
    assert points.scales is None
    assert not points.is_oriented
    points.write(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_text() == (
        '{\n  "format": "neuralmls-control-points",\n  "version": 2,\n  "control_points": [\n'
        '    {"name": "seat", "position": [0, 0.45, 0], "target": [0, 0.45, 0]},\n'
        '    {"name": "back", "position": [0, 0.95, -0.2], "target": [0, 0.9, -0.4]}\n  ]\n}\n'
    )


@pytest.mark.parametrize("d", [1, 2, 3])
def test_turns_come_back_bit_for_bit(tmp_path: Path, d: int) -> None:
    rng = np.random.default_rng(d)
    axes = rng.normal(size=(5, 3))
    turns = [
        Orientation(
            tuple(axis.tolist()) if d == 3 else (0.0, 0.0, 1.0),
            float(rng.uniform(-400, 400)) if d > 1 else 0.0,
            float(scale),
        )
        for axis, scale in zip(axes, rng.uniform(0.1, 3, 5), strict=True)
    ]
    points = ControlPoints(rng.normal(size=(6, d)), orientations=[*turns, None])
    points.write(tmp_path / "turned.json")
    jsonschema.validate(json.loads((tmp_path / "turned.json").read_text()), SCHEMA)
    again = ControlPoints.read(tmp_path / "turned.json")
    assert again.orientations == points.orientations
    assert again.rotations is not None
    assert points.rotations is not None
    assert again.rotations.tobytes() == points.rotations.tobytes()


def test_csv_that_would_lose_a_turn_is_refused(tmp_path: Path) -> None:
    points = ControlPoints([[0, 0, 0]], orientations=[Orientation((0, 0, 1), 10)])
    with pytest.raises(FileError, match="holds no rotations"):
        points.write(tmp_path / "points.csv")
    assert not (tmp_path / "points.csv").exists()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rotation": 40}, ("rotation", "axis and degrees", "40")),
        ({"rotation": {"degrees": 40}}, ("rotation.axis", "3 numbers", "nothing")),
        ({"rotation": {"axis": [0, 1], "degrees": 40}}, ("rotation.axis", "3 numbers")),
        ({"rotation": {"axis": [0, 0, 0], "degrees": 40}}, ("axis", "not all 0")),
        ({"rotation": {"axis": [0, 1, 0]}}, ("rotation.degrees", "nothing")),
        ({"rotation": {"axis": [0, 1, 0], "degrees": True}}, ("rotation.degrees", "true")),
        ({"scale": 0}, ("scale", "above 0", "0")),
        ({"scale": "2"}, ("scale", "number", '"2"')),
    ],
)
def test_a_turn_that_is_none_is_refused_by_its_place(
    tmp_path: Path, changes: dict[str, object], words: tuple[str, ...]
) -> None:
    message = refusal(written(tmp_path, json.dumps(document(SEAT, TURNED | changes))))
    assert "control_points[1]" in message
    for word in words:
        assert word in message


def test_turns_add_up_and_unknown_names_are_refused() -> None:
    points = ControlPoints([[0, 0, 0], [1, 0, 0]], names=["a", "b"]).oriented({"a": Orientation((0, 0, 1), 30)})
    again = points.oriented({"a": Orientation((0, 0, 1), 45)}).moved({"b": [0, 1, 0]})
    assert again.orientations[1] is None
    assert again.orientations[0] is not None
    assert again.orientations[0].degrees == pytest.approx(75)
    assert again.orientations[0].axis == pytest.approx((0, 0, 1))
    with pytest.raises(ArgumentError, match="nearest name is 'a'"):
        points.oriented({"aa": Orientation((0, 0, 1), 30)})
    with pytest.raises(ArgumentError, match="'p1' is in the plane"):
        ControlPoints([[0, 0]]).oriented({"p1": Orientation((1, 0, 0), 30)})
    with pytest.raises(ControlPointError, match="'p1' has 2 coordinates"):
        ControlPoints([[0, 0]], orientations=[Orientation((1, 0, 0), 30)])


def test_any_rotation_is_a_turn() -> None:
    rng = np.random.default_rng(0)
    for degrees in (0, 1e-13, 1e-6, 30, 90, 179.999999, 180, -180, 720, *rng.uniform(-360, 360, 20)):
        for axis in ((1, 0, 0), (0, -1, 0), (0, 0, 1e-200), (1e200, 1e200, 0), tuple(rng.normal(size=3))):
            matrix = Orientation(axis, degrees).matrix
            assert np.abs(matrix.T @ matrix - np.eye(3)).max() < 4e-15
            assert np.abs(Orientation.of(matrix).matrix - matrix).max() < 1e-14
    for matrix, words in (
        (np.diag([1.0, 1.0, -1.0]), "determinant is -1"),
        (2 * np.eye(3), "not orthonormal"),
        (np.full((2, 2), np.nan), "not finite"),
        (np.ones((2, 3)), "shape"),
    ):
        with pytest.raises(ArgumentError, match=words):
            Orientation.of(matrix)
