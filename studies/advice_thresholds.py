"""What `Map.advise` looks at, on displacements that people made: `python -m studies.advice_thresholds FOLDER`.

The thresholds of `crates/core/src/advice.rs` lie beyond the greatest of these, so that they are silent where nothing is
torn. FOLDER is that of `studies.exact_handles`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import neuralmls as nm
from studies.exact_handles import OURS, PAPER, TRAININGS, cases

MOVED = 0.01  # of the longest side, as the core has it


def main() -> None:
    """Print a line a case, soft and exact, with the weights of the paper and with ours."""
    print("| case | stops short by, of the longest move | folded part | greatest stretch | spacings away |")
    print("|---|---|---|---|---|")
    for found in cases(Path(sys.argv[1])):
        longest = np.linalg.norm(found.q - found.p, axis=1).max()
        for training in (PAPER, OURS):
            weights = nm.NeuralWeights.fit(found.p, bounds=found.shape.bounds, **TRAININGS[training])
            points, side = nm.ControlPoints(found.p, found.q), np.ptp(found.shape.bounds, axis=0).max()
            for handles in ("soft", "exact"):
                map = nm.Map.of(nm.Session(points, handles=handles), weights)
                look = map.look(found.shape)
                moves = np.linalg.norm(look.positions - look.places, axis=1) > MOVED * side
                short = map.report().distance_to_target.max() / longest
                print(f"| {found.title}, {training.partition(':')[0]}, {handles} handles | {short:.3f} ", end="")
                folded, far = (look.determinants <= 0).mean(), look.spacings[moves].max()
                print(f"| {folded:.4f} | {look.stretches.max():.2f} | {far:.2f} |")


if __name__ == "__main__":
    main()
