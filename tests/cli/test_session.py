"""Sessions of the editor: `neuralmls deform` takes up what was set there."""

from __future__ import annotations

import json

import numpy as np
import pytest

import neuralmls as nm

DEFORM = ("deform", "shape.obj", "--points", "session.json")
SETTINGS = {
    "kind": "neural",
    "neural": {"width": 64, "seed": 3, "steps": None},
    "classic": {"alpha": 2, "epsilon": 0.01},
    "transform": "similarity",
    "temperature": 0.7,
    "adherence": 0.5,
    "mirror": None,
}


@pytest.fixture
def session(here):
    """Write a session file with settings, those of the example but for what is given."""

    def write(**settings):
        points = [
            {"name": "foot", "position": [0.5, 0, 0.5]},
            {"name": "side", "position": [1, 1, 0.5]},
            {"name": "top", "position": [0.5, 2, 0.5], "target": [0.75, 2.5, 0.5]},
        ]
        document = {"format": "neuralmls-control-points", "version": 1, "control_points": points}
        document["editor"] = {"settings": {**SETTINGS, **settings}, "pairs": []}
        (here / "session.json").write_text(json.dumps(document))

    write()
    return write


def expected(adherence=0.5, transform="similarity", temperature=0.7):
    shape, points = nm.read("shape.obj"), nm.ControlPoints.read("session.json")
    weights = nm.NeuralWeights.fit(points.sources, bounds=shape.bounds, width=64, seed=3)
    deformer = nm.Deformer(shape.positions, weights, transform=transform)
    return deformer.deform(points.targets, temperature, adherence=adherence)


def test_what_is_set_in_the_editor_holds(run, session):
    told = json.loads(run(*DEFORM, "-o", "out.obj", "--json").out)
    assert (told["handles"], told["transform"], told["temperature"]) == (0.5, "similarity", 0.7)
    assert (told["weights"]["kind"], told["weights"]["seed"], told["session"]) == ("neural", 3, "session.json")
    np.testing.assert_allclose(nm.read("out.obj").positions, expected(), rtol=0, atol=1e-6)
    assert "settings of session.json" in run(*DEFORM, "-o", "out.obj", "--force").out


def test_options_go_before_it(run, session):
    options = ("--handles", "soft", "--transform", "rigid", "--temperature", "1.0")  # a default, but said
    told = json.loads(run(*DEFORM, "-o", "out.obj", "--json", *options).out)
    assert (told["handles"], told["transform"], told["temperature"]) == ("soft", "rigid", 1)
    np.testing.assert_allclose(nm.read("out.obj").positions, expected(0.0, "rigid", 1.0), rtol=0, atol=1e-6)
    options = ("--handles", "exact", "--seed", "4", "--relax", "0.5")
    told = json.loads(run(*DEFORM, "-o", "exact.obj", "--json", *options).out)
    assert (told["handles"], told["weights"]["seed"], told["relax"]) == ("exact", 4, 0.5)


def test_classic_weights_are_inverse_distance_ones(run, session):
    session(kind="classic")
    told = json.loads(run(*DEFORM, "-o", "out.obj", "--json").out)
    assert told["weights"] == {"kind": "inverse-distance", "alpha": 2.0, "epsilon": 0.01}
    # Weights of another kind have nothing of the session's but what they share.
    told = json.loads(run(*DEFORM, "-o", "other.obj", "--json", "--weights", "neural", "--width", "32").out)
    assert (told["weights"]["kind"], told["weights"]["seed"]) == ("neural", 0)


def test_what_an_older_session_does_not_say_is_as_by_default(run, session, here):
    document = json.loads((here / "session.json").read_text())
    document["editor"] = {"settings": {"neural": {"width": 64}}}
    (here / "session.json").write_text(json.dumps(document))
    told = json.loads(run(*DEFORM, "-o", "out.obj", "--json").out)
    assert (told["handles"], told["transform"], told["temperature"]) == ("auto", "rigid", 1)
    assert told["relax"] == 0


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ({"temperature": -1}, "temperature: expected a number above 0, found -1"),
        ({"adherence": 1.5}, "adherence: expected a number of at least 0 and at most 1, found 1.5"),
        ({"transform": "melt"}, "transform: expected rigid or similarity or affine, found 'melt'"),
        ({"kind": ["neural"]}, "kind: expected neural or classic, found ['neural']"),
        ({"neural": {"width": 0}}, "width: expected"),
    ],
)
def test_settings_that_no_editor_writes_are_refused_in_a_sentence(run, session, here, setting, words):
    session(**setting)
    ran = run(*DEFORM, "-o", "out.obj")
    assert ran.code != 0
    assert ran.err.count("\n") == 1
    assert f"session.json: editor.settings: {words}" in ran.err
    assert not (here / "out.obj").exists()
