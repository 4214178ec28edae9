"""How good a deformation is: the paper's measures, and robust ones beside them.

All take triangle soups, non-manifold shapes and triangles without area, and say what they left out. `measure` takes
them all at once, in the paper's units.
"""

from neuralmls.metrics.curvature import Change, curvature_change, laplacian, mean_curvature
from neuralmls.metrics.handles import handle_errors
from neuralmls.metrics.measures import Measures, measure
from neuralmls.metrics.orientation import Flips, flipped_triangles, folded_places, volume, volume_change
from neuralmls.metrics.strain import Strain, singular_values, strain

__all__ = [
    "Change",
    "Flips",
    "Measures",
    "Strain",
    "curvature_change",
    "flipped_triangles",
    "folded_places",
    "handle_errors",
    "laplacian",
    "mean_curvature",
    "measure",
    "singular_values",
    "strain",
    "volume",
    "volume_change",
]
