"""Weights that know the shape: a network taught by random walks over it, besides the control points."""

from __future__ import annotations

from numpy.typing import ArrayLike

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_points
from neuralmls.placement import as_indices
from neuralmls.settings import changes_of
from neuralmls.weights.function import NetworkWeights, as_control_points


class ShapeAwareWeights(NetworkWeights):
    """A network whose logits follow the shape: parts near in space but far along the shape move apart."""

    _kind = "shape-aware"

    @classmethod
    def fit(
        cls,
        control_points: ArrayLike,
        x: ArrayLike,
        faces: ArrayLike | None = None,
        *,
        bounds: ArrayLike | None = None,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> ShapeAwareWeights:
        """Train a network to give the weights `w_i ~ h_i^(2.5 s) / E_i^(6 (1 - s))` on a shape.

        `h_i` is the probability that a random walk over the shape meets control point i, or what it holds around it,
        before the others: over its triangles, across parts that touch or overlap, and from a part that touches none to
        its nearest. `E_i` is the straight-line distance. `s` is 1 where a control point governs the shape, less than
        3/4 of the control points' spacing away, measured along the shape; beyond, at a distance D, where the shape says
        less and less, `s = (3/4 spacing / D)^4`, and the nearest in space decide. Weights below e^-8 of the largest
        fall as a power of what they would be: a walk that passes control points is too seldom for a network to learn
        how seldom.

        Between the samples of the surface, and off it, the weights are what the network makes of them, as smooth as the
        paper's. The targets are not needed: one fit serves every drag.

        Parameters
        ----------
        control_points : (m, d), 1 to 1,000 of them, d = 2 or 3
        x : (n, d)
            The shape's points, at least one.
        faces : (f, 3) integers, optional
            Its triangles: any, of any quality, connected or not. Points without a triangle are linked to their nearest.
        bounds : (2, d), optional
            The shape's box, by which coordinates are normalised; that of `x` if not given.
        seed : int, 0 to 2^64 - 1
            The same seed gives the same bytes, whatever the number of threads.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the training.

        Raises
        ------
        ArgumentError
            The points are not finite points or none; two control points are in one place; a face names no point.

        Source
        ------
        The paper's network (Shechter et al. 2022, section 3), taught more: softened labels as in Hinton, Vinyals, Dean,
        "Distilling the knowledge in a neural network", 2015. Harmonic weights: Joshi et al., "Harmonic coordinates for
        character articulation", 2007, there in a cage; distances by Dijkstra's algorithm.

        Examples
        --------
        Two legs side by side: the tip of one is near the control point of the other, but belongs to its own.

        >>> legs = [[0.0, 0], [0, 1], [0.1, 1], [0.1, 0]]
        >>> lines = [[0, 1, 1], [1, 2, 2], [2, 3, 3]]
        >>> p = [[0, 0.1], [0.1, 0.9]]
        >>> ShapeAwareWeights.fit(p, legs, lines).logits([[0.1, 0.3]]).argmax()
        np.int64(1)
        """
        p = as_control_points(control_points)
        points = as_points("x", x, p.shape[1])
        box = None if bounds is None else as_box(bounds, p.shape[1])
        shape = points, as_indices(faces, len(points))
        return cls._of(_core.Weights.fitted(p, box, shape, changes_of(cls._kind, {"seed": seed}), progress))
