"""How much a turned control point counts: `python -m studies.turned`.

One control point of the sample chair is turned by 40 degrees, all stay where they are. For `u_i` (a power of the
weight) and `rho_i` (times the distance to the nearest control point) of crates/core/src/mls/oriented.rs: the angle that
is missing at the turned control point, and the largest angle at the places of the others; both should be small.
"""

from __future__ import annotations

import numpy as np

import neuralmls as nm
from neuralmls import ControlPoints
from neuralmls.samples import make

TURNED = {"armrest-left": (0, 1, 0), "back-top-left": (1, 0, 0), "back-left-foot": (0, 1, 0)}
DEGREES = 40.0
POWERS, SIZES = (1, 2), (0.5, 1.0, 2.0)
Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def main() -> None:
    """Print the table."""
    sample = make("chair")
    points = ControlPoints(sample.control_points.sources, names=sample.control_points.names)
    weights = nm.NeuralWeights.fit(points.sources, bounds=[sample.vertices.min(0), sample.vertices.max(0)])
    w = nm.softmax(weights.logits(points.sources))
    print("| turned | u | rho | missing there | most elsewhere |\n|---|---|---|---|---|")
    for name, axis in TURNED.items():
        turned = points.oriented({name: nm.Orientation(axis, DEGREES)})
        i = points.names.index(name)
        for power in POWERS:
            for size in SIZES:
                angles = np.degrees(angle(rotations(turned, w, power, size)))
                own, others = DEGREES - angles[i], np.delete(angles, i).max()
                print(f"| {name} | w^{power} | {size:g} | {own:.1f} | {others:.1f} |")
    compiled = nm.Deformer(points.sources, weights).deform(
        points.sources, rotations=turned.rotations, scales=turned.scales, return_maps=True
    )[1]
    assert np.abs(compiled - rotations(turned, w, 2, 1.0)).max() < 1e-5, "the core does something else"


def rotations(points: ControlPoints, w: Array, power: int, size: float) -> Array:
    """The rigid maps (n, 3, 3) at places whose weights are `w` (n, m), by the formulas as they stand."""
    p, q = points.sources, points.targets
    a, b = p - (w @ p)[:, None], q - (w @ q)[:, None]
    c = np.einsum("nm,nmi,nmj->nij", w, a, b)
    given = points.rotations
    assert given is not None
    for i in np.flatnonzero(~np.isnan(given[:, 0, 0])):
        rho = size * np.delete(np.linalg.norm(p - p[i], axis=1), i).min()
        c += (w[:, i] ** power * rho**2)[:, None, None] * given[i].T
    u, _, vt = np.linalg.svd(c)
    sign = np.ones((len(c), 3))
    sign[:, 2] = np.linalg.det(u @ vt)
    found: Array = vt.transpose(0, 2, 1) @ (sign[:, :, None] * u.transpose(0, 2, 1))
    return found


def angle(rotation: Array) -> Array:
    """The angles of rotations (n, 3, 3)."""
    found: Array = np.arccos(np.clip((np.trace(rotation, axis1=1, axis2=2) - 1) / 2, -1, 1))
    return found


if __name__ == "__main__":
    main()
