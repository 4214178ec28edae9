"""Where an experiment finds its data, and where it puts its pictures."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from neuralmls.errors import FileError
from neuralmls_research.experiments.naming import power

SEEDS = (0, 1, 2, 3)


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
    seeds : tuple of int
        The networks that everything trained is trained as: a verdict holds for all of them. Pictures show the first.
    """

    folder: Path
    data: Path | None = None
    golden: Path | None = None
    quick: bool = False
    seeds: tuple[int, ...] = SEEDS

    @classmethod
    def of(cls, folder: Path, seeds: tuple[int, ...] = SEEDS) -> Lab:
        """The lab of `$NEURALMLS_DATA` and `$NEURALMLS_GOLDEN`, or of the folder `golden` beside the data.

        Raises
        ------
        FileError
            One of them is set, and is no folder.
        """
        data, golden = _folder("NEURALMLS_DATA"), _folder("NEURALMLS_GOLDEN")
        if data is not None and golden is None and (data.resolve().parent / "golden").is_dir():
            golden = data.resolve().parent / "golden"
        return cls(folder, data, golden, seeds=seeds)

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
        """Neurons in a hidden layer: the paper's."""
        return 64 if self.quick else 1024


def _folder(variable: str) -> Path | None:
    """The folder that an environment variable names, or None where it names none."""
    name = os.environ.get(variable)
    if name and not Path(name).is_dir():
        raise FileError(f"${variable}: there is no folder '{name}'")
    return Path(name) if name else None


def classic_title(alpha: float) -> str:
    """What classic weights 1/d^(2 alpha) are called wherever they are drawn.

    Examples
    --------
    >>> classic_title(0.5)
    'classic, alpha 0.5 (1/d)'
    >>> classic_title(1.0)
    'classic, alpha 1 (1/d^2)'
    """
    return f"classic, alpha {alpha:g} ({power(alpha)})"
