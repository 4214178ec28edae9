"""What coincides stays together: body, shirt, badge, landmarks; by one run, a saved map, a session's own frame."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import neuralmls as nm
from neuralmls.cli import main
from tests.together import FILES, apart, control_points, write

KINDS = ("neural", "shape-aware", "inverse-distance")
PROGRAM = "import sys; from neuralmls.cli import main; sys.exit(main())"
WORST = 1e-6  # of the greatest motion


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("together")
    write(folder)
    control_points().write(folder / "pose.json")
    return folder


@pytest.fixture(scope="module", params=KINDS)
def one_run(request: pytest.FixtureRequest, folder: Path) -> tuple[str, Path]:
    """All files deformed by one command, with weights of each kind."""
    kind, out = request.param, folder / f"{request.param}-one-run"
    shapes = [str(folder / name) for name in FILES]
    options = ["--points", str(folder / "pose.json"), "--weights", kind, "-o", f"{out}/", "-q"]
    assert main(["deform", *shapes, *options]) == 0
    return kind, out


def process(*arguments: object) -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", PROGRAM, *map(str, arguments)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def check(folder: Path, out: Path, what: str) -> None:
    before = {name: nm.read(folder / name).positions for name in FILES}
    after = {name: nm.read(out / name).positions for name in FILES}
    found = apart(before, after)
    print(f"{what}: {found:.2g} of the greatest motion")
    assert found <= WORST


def test_in_one_run(one_run, folder):
    kind, out = one_run
    check(folder, out, f"{kind}, in one run")


def test_by_a_saved_map_in_other_processes_one_by_one(one_run, folder):
    kind, together = one_run
    out = folder / f"{kind}-saved"
    out.mkdir()
    saved = out / "pose.map"
    process(
        "fit",
        *(folder / name for name in FILES),
        "--points",
        folder / "pose.json",
        "--weights",
        kind,
        "-o",
        saved,
        "-q",
    )
    for name in FILES:
        process("deform", folder / name, "--map", saved, "-o", out / name, "-q")
        assert (out / name).read_bytes() == (together / name).read_bytes()
    check(folder, out, f"{kind}, by a saved map")


@pytest.mark.parametrize("kind", ["neural", "inverse-distance"])
def test_by_a_session_with_a_frame_on_each_file_alone(kind, folder):
    out = folder / f"{kind}-alone"
    out.mkdir()
    frame = [[-0.7, -0.1, -0.5], [0.7, 2.0, 0.5]]
    nm.Session(control_points(), weights=kind, frame=frame).write(out / "session.json")
    for name in FILES:
        options = ["--points", str(out / "session.json"), "-o", str(out / name), "-q"]
        assert main(["deform", str(folder / name), *options]) == 0
    check(folder, out, f"{kind}, each file alone in the session's frame")


def test_further_columns_of_landmarks_are_kept(one_run, folder):
    _, out = one_run
    before, after = ((path / "landmarks.csv").read_text().splitlines() for path in (folder, out))
    assert len(after) == len(before)
    assert after[0] == before[0]
    for old, new in zip(before[1:], after[1:], strict=True):
        (name, *old_xyz, side, how), (new_name, *new_xyz, new_side, new_how) = old.split(","), new.split(",")
        assert (name, side, how) == (new_name, new_side, new_how)
        assert old_xyz != new_xyz


def test_without_a_frame_each_file_alone_is_another_map(folder):
    """What the frame is for: trained in each file's own box, they come apart."""
    session = nm.Session.read(folder / "pose.json")
    before = {name: nm.read(folder / name).positions for name in FILES}
    after = {name: session.fit(x).at(x) for name, x in before.items()}
    assert apart(before, after) > 1e-3
    assert json.loads((folder / "pose.json").read_text()).get("frame") is None
