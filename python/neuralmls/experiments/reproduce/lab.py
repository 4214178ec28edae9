"""Where an experiment finds its data, and where it puts its pictures."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Lab:
    """The surroundings of an experiment.

    Attributes
    ----------
    folder : Path
        Where pictures go.
    data, golden : Path or None
        The test data and the published weights of KeypointDeformer, where this machine has them.
    quick : bool
        Whether to run on coarse shapes with small networks: for tests of the code, not of the paper.
    """

    folder: Path
    data: Path | None = None
    golden: Path | None = None
    quick: bool = False

    @classmethod
    def of(cls, folder: Path) -> Lab:
        """The lab of `$NEURALMLS_DATA` and `$NEURALMLS_GOLDEN`, or of the folder `golden` beside the data."""
        data = os.environ.get("NEURALMLS_DATA")
        golden = os.environ.get("NEURALMLS_GOLDEN") or (str(Path(data).parent / "golden") if data else None)
        return cls(folder, _folder(data), _folder(golden))

    def find(self, name: str) -> Path | None:
        """A file of the data folder, or None where it is not there."""
        path = None if self.data is None else self.data / name
        return path if path is not None and path.exists() else None

    def keypoint_weights(self, category: str) -> Path | None:
        """KeypointDeformer's published weights for a category, or None where they are not there."""
        path = None if self.golden is None else self.golden / "kpd" / "weights" / f"kpd_{category}_8kpt.safetensors"
        return path if path is not None and path.exists() else None

    @property
    def width(self) -> int:
        """Neurons a hidden layer: the paper's."""
        return 64 if self.quick else 1024


def _folder(name: str | None) -> Path | None:
    path = Path(name) if name else None
    return path if path is not None and path.is_dir() else None
