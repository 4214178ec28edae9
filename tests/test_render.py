"""Figures: a PNG with something in it, the same camera for all panels, one sentence where it cannot be."""

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")

from PIL import Image

from neuralmls.control_points import ControlPoints
from neuralmls.errors import ArgumentError, FileError, NeuralMLSError
from neuralmls.figures.camera import VIEW_ANGLE, fitted
from neuralmls.figures.page import png
from neuralmls.figures.palette import heat
from neuralmls.figures.render import Panel, render
from neuralmls.figures.stage import pyvista_or_refuse

TETRAHEDRON = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def drawn(path: Path) -> NDArray[np.int64]:
    picture = np.asarray(Image.open(path).convert("RGB")).astype(np.int64)
    assert picture.std() > 5
    return picture


def share_like(picture: NDArray[np.int64], colour: str) -> float:
    """How much of a picture is clearly red, or clearly blue."""
    red, green, blue = np.moveaxis(picture, -1, 0)
    strong = red > green + blue if colour == "red" else blue > red + green * 0.9
    return float(strong.mean())


@pytest.fixture(scope="module")
def figure(tmp_path_factory: pytest.TempPathFactory) -> NDArray[np.int64]:
    path = tmp_path_factory.mktemp("figure") / "figure.png"
    moved = TETRAHEDRON + [0.0, 0.5, 0.0] * (TETRAHEDRON[:, 1:2] > 0)
    points = ControlPoints(TETRAHEDRON[:3], moved[:3])
    render([Panel("source", TETRAHEDRON, FACES), Panel("result", moved, FACES)], path, control_points=points, width=640)
    return drawn(path)


def test_a_figure_shows_each_panel(figure: NDArray[np.int64]) -> None:
    assert figure.shape[1] == 640
    assert (figure[0, 0] == 255).all()
    for half in (figure[:, :320], figure[:, 320:]):
        assert 0.05 < (half.min(axis=2) < 240).mean() < 0.9


def test_control_points_are_red_at_rest_and_blue_at_their_targets(figure: NDArray[np.int64]) -> None:
    middle = slice(40, figure.shape[0] - 40)  # without titles and legend
    source, result = figure[middle, :320], figure[middle, 320:]
    assert share_like(source, "red") > 1e-4
    assert share_like(result, "red") == 0
    assert share_like(source, "blue") > 1e-4  # the arrow
    assert share_like(result, "blue") > 1e-4


def test_a_heat_map_is_red_where_the_weight_is(tmp_path: Path) -> None:
    weights = np.array([0.0, 1.0, 0.0, 0.0])
    render([Panel("weights", TETRAHEDRON, FACES, weights=weights)], tmp_path / "heat.png", width=300, azimuth=0)
    picture = drawn(tmp_path / "heat.png")
    body = picture[30:-30]
    assert share_like(body[:, 150:], "red") > 5 * share_like(body[:, :150], "red")  # the vertex at x = 1


def test_colours_of_points_are_shown(tmp_path: Path) -> None:
    colours = np.tile([1.0, 0.0, 0.0], (4, 1))
    render([Panel("red", TETRAHEDRON, FACES, colours=colours)], tmp_path / "red.png", width=200)
    assert share_like(drawn(tmp_path / "red.png"), "red") > 0.1


@pytest.mark.parametrize("d", [1, 2, 3])
def test_clouds_of_any_dimension_are_drawn(tmp_path: Path, d: int) -> None:
    cloud = np.random.default_rng(0).random((500, d)) + 5e5
    render([Panel("cloud", cloud)], tmp_path / "cloud.png", width=200)
    assert (drawn(tmp_path / "cloud.png").min(axis=2) < 240).mean() > 0.01


def test_soups_and_degenerate_faces_are_drawn(tmp_path: Path) -> None:
    soup = TETRAHEDRON[FACES].reshape(-1, 3)
    faces = np.concatenate([np.arange(12).reshape(4, 3), [[0, 0, 0], [1, 1, 2]]])
    render([Panel("soup", soup, faces)], tmp_path / "soup.png", width=200)
    assert (drawn(tmp_path / "soup.png").min(axis=2) < 240).mean() > 0.1


def test_faces_without_any_area_are_drawn_as_a_cloud(tmp_path: Path) -> None:
    render([Panel("flat", TETRAHEDRON, [[0, 1, 1], [2, 2, 2]])], tmp_path / "flat.png", width=320)
    drawn(tmp_path / "flat.png")


def test_a_single_place_is_drawn(tmp_path: Path) -> None:
    render([Panel("point", np.zeros((1, 3)))], tmp_path / "point.png", width=200)
    drawn(tmp_path / "point.png")


@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("azimuth", [0.0, 130.0, 250.0])
def test_the_camera_sees_everything_and_no_more(up: str, azimuth: float) -> None:
    points = np.random.default_rng(1).random((100, 3)) * [1.0, 3.0, 2.0] - 7.0
    camera = fitted(points, azimuth=azimuth, elevation=20.0, up=up, aspects=(1.0, 1.0))
    toward = (camera.position - camera.focus) / np.linalg.norm(camera.position - camera.focus)
    right = np.cross(camera.up, toward) / np.linalg.norm(np.cross(camera.up, toward))
    depth = (camera.position - points) @ toward
    seen = np.stack([(points - camera.position) @ axis / depth for axis in (right, np.cross(toward, right))])
    reach = np.abs(seen).max() / np.tan(np.radians(VIEW_ANGLE / 2))
    assert 0.9 < reach < 1.0


def test_heat_goes_from_light_to_dark() -> None:
    brightness = heat(np.linspace(0, 1, 50)).sum(axis=1)
    assert (np.diff(brightness) < 0).all()


def test_nothing_is_printed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    render([Panel("quiet", TETRAHEDRON, FACES)], tmp_path / "quiet.png", width=200)
    assert capfd.readouterr() == ("", "")


def test_what_cannot_be_drawn_is_refused_in_one_sentence(tmp_path: Path) -> None:
    panel = Panel("shape", TETRAHEDRON, FACES)
    with pytest.raises(FileError, match=r"a name that ends in \.png"):
        render([panel], tmp_path / "figure.jpg")
    with pytest.raises(ArgumentError, match="at least one panel"):
        render([], tmp_path / "figure.png")
    with pytest.raises(ArgumentError, match="finite positions"):
        render([Panel("none", np.zeros((0, 3)))], tmp_path / "figure.png")
    with pytest.raises(ArgumentError, match="at least one panel"):
        render([panel] * 30, tmp_path / "figure.png")
    with pytest.raises(ArgumentError, match=r"shape: expected faces \(f, 3\) that name points 0 to 3"):
        render([Panel("shape", TETRAHEDRON, FACES + 1)], tmp_path / "figure.png")
    with pytest.raises(ArgumentError, match=r"shape: expected an array of shape \(4,\), found \(3,\)"):
        render([Panel("shape", TETRAHEDRON, FACES, weights=np.zeros(3))], tmp_path / "figure.png")
    with pytest.raises(FileError, match="there is no folder"):
        render([panel], tmp_path / "none" / "figure.png", width=100)
    assert list(tmp_path.iterdir()) == []


def test_without_pyvista_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(NeuralMLSError, match=r"pip install 'neuralmls\[figures\]'"):
        render([Panel("shape", TETRAHEDRON, FACES)], tmp_path / "figure.png")


def test_without_a_graphics_library_its_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise OSError(name)

    monkeypatch.setattr("neuralmls.figures.stage.ctypes.CDLL", missing)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(NeuralMLSError, match="install libegl1"):
        pyvista_or_refuse()


def test_a_long_title_stays_in_its_panel() -> None:
    picture = np.full((40, 160, 3), 255, dtype=np.uint8)
    drawn = png([picture, picture], ["", "folder/" * 40 + "chair.obj"], 320, columns=2)
    page = np.asarray(Image.open(io.BytesIO(drawn)))
    assert (page[:, :160] == 255).all()
    assert (page[:, 160:] < 128).any()


def test_panels_fill_rows_from_the_left() -> None:
    picture = np.zeros((40, 80, 3), dtype=np.uint8)
    page = np.asarray(Image.open(io.BytesIO(png([picture] * 3, ["", "", ""], 160, columns=2))))
    dark = (page == 0).all(axis=2)
    assert dark[:, :80].sum() == 2 * 40 * 80
    assert dark[:, 80:].sum() == 40 * 80
    assert not dark[page.shape[0] // 2 :, 80:].any()
