"""The elastic finish: a frame of a drag on a fine mesh, its nodes alone and with all points."""

from __future__ import annotations

import numpy as np

import neuralmls as nm
from benchmarks.definitions.million import mesh
from benchmarks.measure import Contender, interleaved
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

SECONDS = 15e-3  # of the nodes, so that a drag is live
ARRIVED = 1e-6  # of the longest side


def run(setting: Setting) -> Outcome:
    """The nodes are solved for at every frame, whatever the shape; then each point follows its nearest."""
    x, faces = mesh(setting.size(50_000))
    p = nm.farthest_points(x, faces, 12)
    side = float(np.ptp(x, axis=0).max())
    q = p + 0.1 * side * np.sin(2 * np.pi * p[:, [1, 2, 0]] / side)
    session = nm.Session(nm.ControlPoints(p, q), weights="inverse-distance", handles="exact", relax=1.0)
    map = session.fit(x, faces=faces)
    off = float(np.linalg.norm(map.at(p) - q, axis=1).max()) / side
    checked = [check("12 control points arrive", off, ARRIVED)]
    bound, at_one = map.bind(x), map.bind(p[:1])
    ours = [Contender("nodes", lambda _: map.frame(at_one)), Contender("all", lambda _: map.frame(bound))]
    seconds = interleaved(ours, setting.rounds)
    rows = [
        Row("relax, a frame at 500 nodes", seconds["nodes"], bar=setting.bar(SECONDS)),
        Row(f"relax, a frame of {len(x):,} points", seconds["all"]),
    ]
    return Outcome("elastic finish", rows, checked, [])
