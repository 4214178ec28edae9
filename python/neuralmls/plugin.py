"""What other packages build on, beside the names of `neuralmls` itself: arguments checked, files written whole."""

from neuralmls.arrays import Progress, as_number, as_points, as_triangles, box_around
from neuralmls.extras import RESEARCH
from neuralmls.files import as_path, write_atomically
from neuralmls.settings import Transform

__all__ = [
    "RESEARCH",
    "Progress",
    "Transform",
    "as_number",
    "as_path",
    "as_points",
    "as_triangles",
    "box_around",
    "write_atomically",
]
