"""How large a run is, and what its machine can do."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.machine import Limits
from benchmarks.rivals import installed


@dataclass(frozen=True)
class Setting:
    """A full run, or a quick one at small sizes that shows that all of it works: its times mean nothing."""

    limits: Limits
    quick: bool

    @property
    def rounds(self) -> int:
        """Turns of each contender."""
        return 1 if self.quick else 7

    def size(self, full: int) -> int:
        """So many points, or a hundredth."""
        return full // 100 if self.quick else full

    def has(self, rival: str) -> bool:
        """Whether a rival takes part."""
        return installed(rival)

    def bar(self, value: float) -> float | None:
        """A bar is for the full size."""
        return None if self.quick else value
