"""The compiled core. Arguments are C-contiguous and checked by the callers in this package."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

_Progress = Callable[[float], None] | None

VERSION: str

class ShapeFile:
    def __new__(cls, data: bytes, extension: str, side_file: Callable[[str], bytes]) -> ShapeFile: ...
    @property
    def format(self) -> str: ...
    @property
    def extensions(self) -> list[str]: ...
    @property
    def facts(self) -> list[tuple[str, str]]: ...
    @property
    def has_normals(self) -> bool: ...
    @property
    def named_files(self) -> list[str]: ...
    def positions(self) -> NDArray[np.float64]: ...
    def bounds(self) -> NDArray[np.float64]: ...
    def round(self, points: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def step(self) -> float: ...
    def missing_files(self, found: set[str]) -> list[str]: ...
    def faces(self) -> NDArray[np.uint32] | None: ...
    def side_files(self, stem: str) -> list[str]: ...
    def write(
        self, positions: NDArray[np.float64], maps: NDArray[np.float64] | None, stem: str | None
    ) -> tuple[bytes, list[tuple[str, str, bytes]]]: ...

def inverse_distance_logits(
    x: NDArray[np.float64],
    p: NDArray[np.float64],
    half: float,
    alpha: float,
    epsilon: float,
    progress: _Progress,
) -> NDArray[np.float32]: ...

class PointTree:
    def __new__(
        cls, x: NDArray[np.float64], centre: Sequence[float], half: float, progress: _Progress
    ) -> PointTree: ...

class Network:
    def __new__(
        cls,
        dim: int,
        centre: Sequence[float],
        half: float,
        frequencies: NDArray[np.float32],
        layers: Sequence[tuple[NDArray[np.float32], NDArray[np.float32]]],
    ) -> Network: ...
    @property
    def dim(self) -> int: ...
    @property
    def centre(self) -> list[float]: ...
    @property
    def half(self) -> float: ...
    @property
    def frequencies(self) -> NDArray[np.float32]: ...
    @property
    def layers(self) -> list[tuple[NDArray[np.float32], NDArray[np.float32]]]: ...
    def logits(self, x: NDArray[np.float64], progress: _Progress) -> NDArray[np.float32]: ...
    def logits_of_tree(self, tree: PointTree, progress: _Progress) -> NDArray[np.float32]: ...

def fit(
    p: NDArray[np.float64],
    centre: Sequence[float],
    half: float,
    width: int,
    steps: int | None,
    rate: float,
    seed: int,
    fourier_sigma: float | None,
    progress: _Progress,
    samples: tuple[NDArray[np.float64], NDArray[np.float32], int] | None = None,
) -> tuple[Network, list[float], float]: ...
def train(
    network: Network, p: NDArray[np.float64], steps: int | None, rate: float, progress: _Progress
) -> tuple[Network, list[float], float]: ...

class Deformer:
    def __new__(
        cls,
        x: NDArray[np.float64],
        p: NDArray[np.float64],
        logits: NDArray[np.float32],
        transform: str,
    ) -> Deformer: ...
    @staticmethod
    def of_network(
        x: NDArray[np.float64],
        p: NDArray[np.float64],
        network: Network,
        tree: PointTree | None,
        transform: str,
        progress: _Progress,
    ) -> Deformer: ...
    def prepare(self, temperature: float) -> None: ...
    def deform(
        self,
        q: NDArray[np.float64],
        turns: NDArray[np.float64] | None,
        temperature: float,
        maps: bool,
        out: NDArray[np.float64] | None,
        progress: _Progress,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]: ...

def farthest_points(
    x: NDArray[np.float64], faces: NDArray[np.uint32], count: int, seed: int
) -> NDArray[np.float64]: ...
def farthest_of(x: NDArray[np.float64], count: int) -> NDArray[np.int64]: ...
def sample_surface(x: NDArray[np.float64], faces: NDArray[np.uint32], count: int, seed: int) -> NDArray[np.float64]: ...

class ExactHandles:
    def __new__(cls, p: NDArray[np.float64], logits: NDArray[np.float32], transform: str) -> ExactHandles: ...
    def aim(
        self, q: NDArray[np.float64], turns: NDArray[np.float64] | None, temperature: float, adherence: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[str, int, float] | None]: ...
    def aim_carefully(
        self, q: NDArray[np.float64], turns: NDArray[np.float64] | None, temperature: float, adherence: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[str, int, float] | None]: ...
    def remedy(
        self, q: NDArray[np.float64], turns: NDArray[np.float64] | None, temperature: float, adherence: float
    ) -> tuple[str, float | None] | None: ...

class Probe:
    def __new__(
        cls,
        p: NDArray[np.float64],
        places: NDArray[np.float64],
        side: float,
        logits: NDArray[np.float32],
        own_logits: NDArray[np.float32],
        transform: str,
        careful: bool,
    ) -> Probe: ...
    @staticmethod
    def points(places: NDArray[np.float64], side: float) -> NDArray[np.float64]: ...
    def advise(
        self, q: NDArray[np.float64], turns: NDArray[np.float64] | None, temperature: float, adherence: float
    ) -> list[tuple[str, float, int, list[int], tuple[float | None, float] | None]]: ...
    def parts(
        self, q: NDArray[np.float64], turns: NDArray[np.float64] | None, temperature: float, adherence: float
    ) -> tuple[float, float]: ...
    def look(
        self, q: NDArray[np.float64], turns: NDArray[np.float64] | None, temperature: float, adherence: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
    def far(self) -> NDArray[np.float64]: ...
