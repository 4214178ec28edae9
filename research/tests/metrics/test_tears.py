"""What comes apart: laws, made-up shapes that are torn by known widths, and what is no tear."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from neuralmls_research.metrics import Contacts, overstretched
from neuralmls_research.metrics.tears import UNSEEN


def box(low: list[float], high: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """A box of triangles that are small against it."""
    mesh = trimesh.creation.box(bounds=[low, high]).subdivide().subdivide().subdivide()
    return np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64)


@pytest.fixture
def stool() -> tuple[np.ndarray, np.ndarray, int]:
    """A seat, a leg that ends right below it, one in it; how many vertices the seat has. The longest side is 2."""
    meshes = [
        box([-1, 0, -0.5], [1, 0.1, 0.5]),
        box([-0.9, -1, -0.1], [-0.7, -0.01, 0.1]),
        box([0.7, -1, -0.1], [0.9, 0.05, 0.1]),
    ]
    starts = np.cumsum([0] + [len(x) for x, _ in meshes])
    faces = [faces + start for (_, faces), start in zip(meshes, starts, strict=False)]
    return np.concatenate([x for x, _ in meshes]), np.concatenate(faces), int(starts[1])


def test_rigid_motion_and_a_little_stretch_open_nothing(stool):
    x, faces, _ = stool
    contacts = Contacts(x, faces)
    assert contacts.count > 0
    turned = x @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0] + [3, -2, 1]
    assert contacts.opened(turned).opened == 0
    assert contacts.opened(turned).widest < 1e-9
    assert contacts.opened(x * [1, 1.5, 1]).opened == 0


def test_a_seat_that_is_lifted_opens_all_that_touches_its_lower_side(stool):
    x, faces, seat = stool
    lifted = x.copy()
    lifted[:seat] += [0, 0.2, 0]
    found = Contacts(x, faces).opened(lifted)
    assert found.widest == pytest.approx(0.1, abs=0.01)
    assert found.opened > 0.8


def test_one_leg_of_two_that_is_torn_off_opens_about_half(stool):
    x, faces, seat = stool
    torn = x.copy()
    leg = (np.arange(len(x)) >= seat) & (x[:, 0] < 0)
    torn[leg] -= [0, 0.2, 0]
    found = Contacts(x, faces).opened(torn)
    assert 0.2 < found.opened < 0.7
    assert found.widest == pytest.approx(0.1, abs=0.01)


def test_an_opening_that_is_hardly_seen_is_none(stool):
    x, faces, seat = stool
    moved = x.copy()
    moved[:seat] += [0, 2 * UNSEEN * 0.7, 0]
    assert Contacts(x, faces).opened(moved).opened < 0.02


def test_units_and_the_order_of_triangles_do_not_count(stool):
    x, faces, seat = stool
    lifted = x.copy()
    lifted[:seat] += [0, 0.2, 0]
    found = Contacts(x, faces).opened(lifted)
    larger = Contacts(1000 * x, faces).opened(1000 * lifted)
    assert larger.opened == found.opened
    assert larger.widest == pytest.approx(found.widest)
    shuffled = np.random.default_rng(2).permutation(faces)
    assert Contacts(x, shuffled).opened(lifted).opened == pytest.approx(found.opened, abs=0.02)


def test_one_part_has_no_contacts():
    x, faces = box([0, 0, 0], [1, 1, 1])
    contacts = Contacts(x, faces)
    assert contacts.count == 0
    assert contacts.opened(x * [9, 1, 1]).opened == 0
    empty = Contacts(np.zeros((3, 3)), [[0, 1, 2]])
    assert (empty.count, empty.opened(np.ones((3, 3))).widest) == (0, 0)


def test_the_part_that_is_stretched_by_more_than_a_limit():
    x, faces = box([0, 0, 0], [2, 0.1, 0.1])
    pulled = x.copy()
    far = x[:, 0] > 1.5
    pulled[far, 0] += 4 * (x[far, 0] - 1.5)  # a quarter of its length, five times as long
    found = overstretched(x, pulled, faces, 3)
    # By the mean of the areas before and after; of the ends' areas (1 % of all) only those of the boxes' ends differ.
    assert found == pytest.approx((0.25 + 1.25) / (1 + 2), abs=0.02)
    assert overstretched(x, pulled, faces, 5.1) == 0
