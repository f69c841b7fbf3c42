# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Lumens of generated colons in which a stiff head has no room: widened there, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arcgym.anatomy.generator import head_room
from arcgym.anatomy.generator.generate import draw_colon
from arcgym.anatomy.generator.head_room import NoRoomError, fit_with_room, passage_in_wall, passage_of, widened
from arcgym.anatomy.generator.lumen_field import FieldGrid
from arcgym.anatomy.generator.population import draw_spec
from arcgym.anatomy.validation.passage import HEAD_LENGTH, HEAD_RADIUS, Passage

VOXEL = 0.001
LINE = np.stack([np.zeros(101), np.zeros(101), np.linspace(0.0, 0.2, 101)], 1)
"""Middle of a straight tube, and a point each 2 mm."""
COLON = SimpleNamespace(curve=SimpleNamespace(points=LINE), spec=SimpleNamespace(wall_thickness=0.002))


def tubes(*middles: float, radius: float = 0.005) -> FieldGrid:
    """Return the field of straight tubes along z, 20 cm long, in the plane y = 0 at some x [m]."""
    x, y = (np.arange(-0.015, 0.04, VOXEL), np.arange(-0.015, 0.015, VOXEL))
    way = [np.hypot(x[:, None] - middle, y[None]) for middle in middles]
    disc = radius - np.min(way, axis=0)
    return FieldGrid(np.repeat(disc[:, :, None], 200, 2).astype(np.float32), np.array([-0.015, -0.015, 0.0]), VOXEL)


def passage(room: list[float], arc: list[float]) -> Passage:
    middle = np.array([[0.0, 0.0, s] for s in arc])
    return Passage(np.array(arc), np.array(room), middle, np.tile([0.0, 0.0, 1.0], (len(arc), 1)))


def at(lumen: FieldGrid, *point: float) -> float:
    return float(lumen.values[tuple(np.round((np.array(point) - lumen.origin) / VOXEL).astype(int))])


def test_the_head_is_drawn_where_it_lacks_room_and_nothing_else_changes() -> None:
    """A head at 10 cm, and half-way to the next, reaches with 1 mm more from 7.75 to 12.45 cm, and 7.6 mm aside."""
    before = tubes(0.0)
    after = widened(before, COLON, passage([0.007, 0.005, 0.007], [0.096, 0.100, 0.104]), HEAD_RADIUS + 0.001)
    assert at(before, 0.007, 0.0, 0.10) == pytest.approx(-0.002)
    assert at(after, 0.007, 0.0, 0.10) == pytest.approx(0.0005, abs=2e-4)  # half a voxel at most
    half = 0.5 * HEAD_LENGTH + 0.001
    changed = np.flatnonzero((after.values != before.values).any((0, 1))) * VOXEL
    assert [changed.min(), changed.max()] == pytest.approx([0.100 - half, 0.102 + half], abs=0.003)
    assert (after.values >= before.values).all()


def test_another_loop_keeps_its_wall() -> None:
    """Another tube's lumen begins 12 mm off: of a head of 8.6 mm what is nearer than 5.5 mm to it is left out."""
    before = tubes(0.0, 0.017)
    line = np.concatenate([LINE, LINE[::-1] + [0.017, 0.0, 0.0]])
    colon = SimpleNamespace(curve=SimpleNamespace(points=line), spec=COLON.spec)
    after = widened(before, colon, passage([0.005], [0.10]), 0.0086)
    assert at(after, -0.008, 0.0, 0.10) > 0.0
    assert at(after, 0.006, 0.0, 0.10) > 0.0
    assert at(after, 0.008, 0.0, 0.10) < 0.0


def test_a_colon_with_room_is_the_same_object(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("passage_of", "passage_in_wall"):
        monkeypatch.setattr(head_room, name, lambda fitted: passage([HEAD_RADIUS], [0.1]))
    monkeypatch.setattr(head_room, "fit_surface", lambda *_: pytest.fail("fitted again"))
    fitted = object()
    found, added = fit_with_room(COLON, [], tubes(0.0), fitted)
    assert found is fitted and added == 0.0


def test_a_colon_without_room_is_widened_until_contact_surface_and_wall_have_some(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Heads of 8.1, 8.1 and 8.6 mm leave 0.1, 0.1 and 0.6 mm at 8 mm; values end at half a voxel, 0.5 mm."""
    fits: list[FieldGrid] = []
    fit = lambda surface, lesions, lumen: fits.append(lumen) or len(fits)  # noqa: E731
    monkeypatch.setattr(head_room, "fit_surface", fit)
    contact, wall = {0: 0.0050, 1: 0.0066, 2: 0.0066, 3: 0.0066}, {0: 0.0044, 1: 0.0064, 2: 0.0065, 3: 0.0066}
    monkeypatch.setattr(head_room, "passage_of", lambda fitted: passage([contact[fitted]], [0.1]))
    monkeypatch.setattr(head_room, "passage_in_wall", lambda fitted: passage([wall[fitted]], [0.15]))
    found, added = fit_with_room(COLON, [], tubes(0.0), 0)
    assert found == 3 and added > 0.0
    assert [at(lumen, 0.0, 0.008, 0.15) for lumen in fits] == pytest.approx([1e-4, 1e-4, 5e-4], abs=1e-5)
    assert [at(lumen, 0.0, 0.008, 0.10) for lumen in fits] == pytest.approx([1e-4, 1e-4, 1e-4], abs=1e-5)
    fits.clear()
    contact, wall = contact | {4: 0.0066}, wall | {3: 0.0065, 4: 0.0061}
    with pytest.raises(NoRoomError, match="room for 6.1 mm at 0.150 m, expected 6.6 mm"):
        fit_with_room(COLON, [], tubes(0.0), 0)


@pytest.mark.parametrize("poor", ["passage_of", "passage_in_wall"])
def test_room_in_one_of_both_does_not_do(monkeypatch: pytest.MonkeyPatch, poor: str) -> None:
    rooms = {"passage_of": HEAD_RADIUS, "passage_in_wall": HEAD_RADIUS} | {poor: 0.0065}
    for name, room in rooms.items():
        monkeypatch.setattr(head_room, name, lambda fitted, room=room: passage([room if fitted == 0 else 1.0], [0.1]))
    monkeypatch.setattr(head_room, "fit_surface", lambda *_: 1)
    assert fit_with_room(COLON, [], tubes(0.0), 0)[0] == 1


@pytest.mark.slow
def test_a_patient_of_the_population_without_room_gets_some() -> None:
    before = draw_colon(replace(draw_spec(10060), head_room=False), 0)
    assert passage_of(before.fitted).least < HEAD_RADIUS and before.widened == 0.0
    drawn = draw_colon(draw_spec(10060), 0)
    assert min(passage_of(drawn.fitted).least, passage_in_wall(drawn.fitted).least) >= HEAD_RADIUS
    assert 0.0 < drawn.widened < 10e-6
