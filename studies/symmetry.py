"""Whether symmetry is found, however a shape is turned and sampled: `python studies/symmetry.py DATA`.

Fifteen shapes of the data, each three times turned and moved at random, its faces in another order so that other
places of them are sampled. Told are the verdicts, how far the plane is from that of the shape as it is (turned along),
at most, and how much processor time a call takes, at least.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

import neuralmls as nm

TIMES = 3
SHAPES = {
    "organic/human/human_neutral.obj": "symmetric",
    "organic/spot/spot_low_resolution.obj": "symmetric",
    "organic/penguin/penguin.obj": "nearly",  # its head is turned
    "organic/fish/fish_low_resolution.obj": "symmetric",
    "organic/armadillo.obj": "no",
    "organic/bunny/bunny.obj": "no",
    "organic/hand/hand_closed.obj": "no",
    "manufactured/oakChair/oakChair.obj": "symmetric",
    "manufactured/plasticChair/plasticChair.obj": "symmetric",
    "manufactured/smart-car/smart-car.obj": "symmetric",
    "manufactured/VW-new-beetle/VW-new-beetle.obj": "symmetric",
    "shapenet/ShapeNetPlane1/model.obj": "symmetric",
    "shapenet/ShapeNetPlane2/model.obj": "symmetric",
    "shapenet/ShapeNetChair1/model.obj": "symmetric",
    "shapenet/ShapeNetChair3/model.obj": "symmetric",
}


def main(data: Path) -> None:
    """Run the study and print what came out."""
    rng = np.random.default_rng(0)
    for name, expected in SHAPES.items():
        shape = nm.read(data / name)
        x, faces = shape.positions, shape.faces
        side = np.ptp(x, axis=0).max()
        own = nm.symmetry(x, faces)
        verdicts, degrees, offsets, seconds = [own[0].verdict], [0.0], [0.0], []
        for _ in range(TIMES):
            turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
            shift = side * rng.normal(size=3)
            start = time.process_time()
            found = nm.symmetry(x @ turn.T + shift, rng.permutation(faces))
            seconds.append(time.process_time() - start)
            verdicts.append(found[0].verdict)
            # Of planes that are as good, any may be the first.
            off = []
            for plane in own:
                normal = turn @ plane.normal
                facing = np.sign(normal @ found[0].normal)
                angle = np.degrees(2 * np.arcsin(min(1, np.linalg.norm(normal * facing - found[0].normal) / 2)))
                middle = turn @ ((x.max(axis=0) + x.min(axis=0)) / 2) + shift
                before, after = (
                    facing * (plane.offset + normal @ shift - normal @ middle),
                    found[0].offset - middle @ found[0].normal,
                )
                off.append((float(angle), float(abs(before - after) / side)))
            degrees.append(min(off)[0])
            offsets.append(100 * min(off)[1])
        found_so = ", ".join(sorted(set(verdicts)))
        wrong = "" if set(verdicts) == {expected} else f", EXPECTED {expected}"
        met = f"score {own[0].score:.2f}, {100 * own[0].matched:.1f} % matched"
        off_by = f"{max(degrees):.3f} degrees, {max(offsets):.3f} % of the side"
        print(f"{name}: {found_so}{wrong}, {met}, {off_by}, {1000 * min(seconds):.0f} ms", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
