"""How good a deformation is: the paper's measures, and robust ones beside them.

All take triangle soups, non-manifold shapes and triangles without area, and say what they left out. `measure` takes
them all at once, in the paper's units.
"""

from neuralmls.metrics.curvature import Change, curvature_change, laplacian, mean_curvature
from neuralmls.metrics.flips import Flips, flipped_triangles
from neuralmls.metrics.folds import folded_places
from neuralmls.metrics.handles import handle_errors
from neuralmls.metrics.measures import Measures, measure
from neuralmls.metrics.strains import Strain, singular_values, strain
from neuralmls.metrics.volumes import volume, volume_change

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
