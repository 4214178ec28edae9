"""How good a deformation is: the paper's measures, and robust ones beside them.

All take triangle soups, non-manifold shapes and triangles without area, and say what they left out. `measure` takes
them all at once, in the paper's units. The measures of a surface share their arguments:

`x, y : (n, 3)`, the vertices before and after, in the same units, any; `faces : (f, 3)` integers, the triangles.
What is no such array, or does not fit the others, is an `ArgumentError` that says what was found.
"""

from neuralmls_research.metrics.bends import Bends
from neuralmls_research.metrics.curvature import Change, curvature_change, laplacian, mean_curvature
from neuralmls_research.metrics.flips import Flips, flipped_triangles
from neuralmls_research.metrics.folds import beside, folded_places, jacobians
from neuralmls_research.metrics.handles import handle_errors
from neuralmls_research.metrics.measures import Measures, measure
from neuralmls_research.metrics.strains import Strain, singular_values, strain
from neuralmls_research.metrics.tears import Contacts, Tears, overstretched
from neuralmls_research.metrics.volumes import volume, volume_change

__all__ = [
    "Bends",
    "Change",
    "Contacts",
    "Flips",
    "Measures",
    "Strain",
    "Tears",
    "beside",
    "curvature_change",
    "flipped_triangles",
    "folded_places",
    "handle_errors",
    "jacobians",
    "laplacian",
    "mean_curvature",
    "measure",
    "overstretched",
    "singular_values",
    "strain",
    "volume",
    "volume_change",
]
