"""One panel of a figure as a PyVista scene: a shape, control points, light and camera."""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls.errors import NeuralMLSError
from neuralmls.extras import extra
from neuralmls.figures.camera import VIEW_ANGLE, Camera
from neuralmls.figures.palette import Colour
from neuralmls.figures.quiet import native_silence

Array = NDArray[np.float64]
Colours = NDArray[np.uint8]

CREASE = 30.0  # degrees; faces that meet at a sharper angle are shaded apart
FINER = 2  # drawn so many times larger, to be reduced: smooth edges
BALL = 0.0115  # radius, of the longest side of what is seen
HIDDEN = 0.35  # opacity of a control point where the shape is before it


def pyvista_or_refuse() -> Any:
    """Import PyVista.

    Raises
    ------
    NeuralMLSError
        It is not installed, or this machine has nothing to draw with.
    """
    # Without a display VTK would complain about X before it does without; without a library it would crash.
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", _window_without_display())
    try:
        import pyvista
    except ImportError as error:
        raise NeuralMLSError(f"figures need PyVista, which is not installed: {extra('figures')}") from error
    return pyvista


def _window_without_display() -> str:
    """The kind of VTK's windows for which this machine has the library."""
    for library, window in (("libEGL.so.1", "vtkEGLRenderWindow"), ("libOSMesa.so.8", "vtkOSOpenGLRenderWindow")):
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        return window
    raise NeuralMLSError(
        "figures need a library to draw without a display, and neither libEGL nor libOSMesa is there: "
        "install libegl1 (Debian, Ubuntu) or mesa-libEGL (Fedora)"
    )


class Stage:
    """A scene of things whose longest side is about 1, seen by `camera` in a light that goes with it."""

    def __init__(self, pyvista: Any, width: int, height: int, camera: Camera) -> None:
        self.pyvista = pyvista
        size = (width * FINER, height * FINER)
        with native_silence():
            self.plotter = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
        self.plotter.set_background("white")
        view = self.plotter.camera
        view.position, view.focal_point, view.up = map(tuple, (camera.position, camera.focus, camera.up))
        view.view_angle = VIEW_ANGLE
        toward = camera.position - camera.focus
        toward = toward / np.linalg.norm(toward)
        right = np.cross(camera.up, toward)
        right /= np.linalg.norm(right)
        above = np.cross(toward, right)
        # A key light from above left of the viewer, a weaker one from the right, a rim from behind, a fill.
        for direction, strength in (
            (0.7 * toward - 0.75 * right + 1.1 * above, 0.80),
            (0.8 * toward + 1.0 * right + 0.15 * above, 0.36),
            (-1.0 * toward + 0.3 * right + 0.8 * above, 0.30),
            (toward, 0.28),
        ):
            light = pyvista.Light(position=tuple(camera.focus + direction * 10), light_type="scene light")
            light.focal_point, light.intensity, light.positional = tuple(camera.focus), strength, False
            self.plotter.add_light(light)

    def cloud(self, points: Array, colours: Colours) -> None:
        """Add a point cloud, its points the larger the fewer they are."""
        mesh = self.pyvista.PolyData(points)
        mesh["colours"] = colours
        size = FINER * min(max(1100.0 / len(points) ** 0.5, 2.0), 9.0)
        self._shaded(mesh, style="points", point_size=size, render_points_as_spheres=True)

    def surface(self, points: Array, faces: NDArray[np.int64], colours: Colours) -> None:
        """Add a triangle mesh, smooth except for its creases, darker where it is hollow."""
        points, faces, colours = _joined(points, faces, colours)
        mesh = self.pyvista.PolyData(points, np.insert(faces, 0, 3, axis=1).ravel())
        mesh["colours"] = colours
        mesh = mesh.compute_normals(
            cell_normals=False,
            split_vertices=True,
            feature_angle=CREASE,
            consistent_normals=False,
            non_manifold_traversal=False,
        )
        self._shaded(mesh, smooth_shading=True)
        self.plotter.enable_ssao(radius=0.08, bias=0.004, kernel_size=96, blur=True)

    def _shaded(self, mesh: Any, **look: Any) -> None:
        self.plotter.add_mesh(
            mesh, scalars="colours", rgb=True, ambient=0.22, diffuse=0.85, specular=0.12, specular_power=18, **look
        )

    def balls(self, points: Array, colour: Colour) -> None:
        """Add a ball at each point."""
        ball = self.pyvista.Sphere(radius=BALL, theta_resolution=24, phi_resolution=24)
        self._mark(self.pyvista.PolyData(points).glyph(geom=ball, scale=False, orient=False), colour)

    def arrows(self, starts: Array, ends: Array, colour: Colour) -> None:
        """Add an arrow from each start to its end where these differ."""
        for start, end in zip(starts, ends, strict=True):
            length = float(np.linalg.norm(end - start))
            if length > BALL:
                arrow = self.pyvista.Arrow(
                    start=start,
                    direction=end - start,
                    scale=length,
                    shaft_radius=0.004 / length,
                    tip_radius=0.011 / length,
                    tip_length=min(0.034 / length, 0.6),
                    tip_resolution=32,
                    shaft_resolution=24,
                )
                self._mark(arrow, colour)

    def _mark(self, mesh: Any, colour: Colour) -> None:
        """Add a mark that is seen everywhere: opaque where nothing is before it, shining through elsewhere."""
        look = {"color": colour, "ambient": 0.4, "diffuse": 0.65, "specular": 0.25, "smooth_shading": True}
        self.plotter.add_mesh(mesh, **look)
        ghost = self.plotter.add_mesh(mesh.copy(), opacity=HIDDEN, **look)
        ghost.mapper.SetResolveCoincidentTopologyToPolygonOffset()
        ghost.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0.0, -66000.0)

    def picture(self) -> NDArray[np.uint8]:
        """Draw the scene, (height, width, 3), larger than it is to be shown, and close it.

        Raises
        ------
        NeuralMLSError
            The picture is blank.
        """
        with native_silence():
            self.plotter.camera.reset_clipping_range()
            picture: NDArray[np.uint8] = np.asarray(self.plotter.screenshot(return_img=True))
            self.plotter.close()
        if not picture.size or (picture == picture[0, 0]).all():
            raise NeuralMLSError("the picture came out blank: this machine's graphics driver cannot draw off screen")
        return picture


def _joined(points: Array, faces: NDArray[np.int64], colours: Colours) -> tuple[Array, NDArray[np.int64], Colours]:
    """The same triangles, with corners of the same place and colour made one: soups are then smooth too."""
    rows = np.concatenate([points.astype(np.float32) + 0.0, colours], axis=1, dtype=np.float32)
    keys = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).reshape(-1)
    _, first, index = np.unique(keys, return_index=True, return_inverse=True)
    return points[first], index[faces], colours[first]
