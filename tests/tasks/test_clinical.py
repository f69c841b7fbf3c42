# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""``env.clinical``: what it switches on, and what it leaves alone."""

from __future__ import annotations

from typing import Any

import pytest

from arcgym.assets.materials import tissue_preset
from arcgym.utils.coerce import to_plain
from arcgym.utils.configclass import validate
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry
from arcgym_tasks.navigation.clinical import CAMERA, EFFECTS, make_clinical

ALL = "env.clinical=[all]"


def configured(*overrides: str, task: str = "ARC-Sigmoid-Proximal") -> Any:
    cfg = load_cfg_from_registry(task, "env_cfg_entry_point")
    apply_overrides({"env": cfg}, list(overrides))
    validate(cfg)
    cfg.resolve()
    validate(cfg)
    return cfg


def switches(cfg: Any) -> list[bool]:
    """Return whether each of :data:`EFFECTS` is on."""
    colon, sim, scope = cfg.scene.colon, cfg.sim, cfg.scene.endoscope
    law, camera = colon.wall_law, cfg.scene.camera
    return [
        colon.material == "clinical" and law.stiffening == 1.5 and law.thickness_by_diameter,
        law.relaxation,
        colon.gas.enabled and cfg.metrics.max_lumen_pressure is not None,
        colon.gas.tense,
        sim.weight.enabled,
        scope.grading.active and scope.actuators["bending"].play > 0.0 and scope.actuators["bending"].lag > 0.0,
        sim.contact.friction == 0.12 and sim.contact.static_friction == 1.4,
        colon.abdomen.enabled,
        colon.mesentery.enabled,
        sim.loops.enabled,
        camera.latency == 0.08,
        camera.exposure.shutter == (1 / 200, 1 / 60) and camera.exposure.lag == 0.6,
        camera.lighting.concentration == 2.77 and camera.lighting.lamp is not None and camera.exposure.gamma == 2.2,
        camera.preparation.scores == (2, 3, 3) and cfg.events.preparation is not None,
    ]


def test_nothing_is_on_by_default() -> None:
    assert switches(configured()) == [False] * len(EFFECTS)


def test_all_of_them() -> None:
    assert switches(configured(ALL)) == [True] * len(EFFECTS)


@pytest.mark.parametrize("effect", EFFECTS)
def test_one_of_them_alone(effect: str) -> None:
    brought = ("gas",) if effect == "tension" else ()
    assert switches(configured(f"env.clinical=[{effect}]")) == [name in (effect, *brought) for name in EFFECTS]


def test_what_is_written_down_are_effects_not_groups() -> None:
    assert configured(ALL).clinical == EFFECTS
    assert configured("env.clinical=[camera,gas]").clinical == ("gas", *CAMERA)


def test_a_group_of_them() -> None:
    assert switches(configured("env.clinical=[camera]")) == [name in CAMERA for name in EFFECTS]


def test_a_replay_which_has_no_events_takes_all() -> None:
    cfg = load_cfg_from_registry("ARC-Sigmoid-Proximal", "env_cfg_entry_point")
    cfg.events, cfg.clinical = None, ("all",)
    make_clinical(cfg)
    assert cfg.scene.camera.preparation.scores == (2, 3, 3)


def test_again_it_changes_nothing_more() -> None:
    cfg = configured(ALL)
    before = to_plain(cfg)
    make_clinical(cfg)
    assert to_plain(cfg) == before


def test_what_was_given_stands() -> None:
    cfg = configured(
        ALL,
        "env.gas=commanded",
        "env.scene.colon.material=in_situ",
        "env.sim.contact.friction=0.3",
        "env.scene.endoscope.grading.passive_length=0.2",
    )
    assert cfg.gas == "commanded" and cfg.actions.gas is not None
    assert cfg.scene.colon.material == "in_situ" and cfg.scene.colon.wall_law.stiffening is None
    assert cfg.sim.contact.friction == 0.3 and cfg.scene.endoscope.grading.passive_length == 0.2


@pytest.mark.parametrize("task", ["ARC-Sigmoid-Capsule", "ARC-Sigmoid-Magnetic"])
def test_robots_without_wheels_keep_their_shaft(task: str) -> None:
    cfg = configured(ALL, task=task)
    assert not cfg.scene.endoscope.grading.active and cfg.sim.weight.enabled


def test_its_contact_is_as_stiff_as_in_situ() -> None:
    soft, firm = configured(ALL), configured("env.clinical=[tissue]", "env.scene.colon.material=in_situ")
    assert soft.sim.contact.tissue_share * 95.0e3 == pytest.approx(firm.sim.contact.tissue_share * 0.5e6, rel=0.01)
    assert firm.sim.contact.tissue_share == pytest.approx(2 / 3)
    assert configured(ALL, "env.sim.contact.tissue_share=1.0").sim.contact.tissue_share == 1.0


def test_the_tissue_is_softer_than_in_situ_and_held_alike() -> None:
    soft, firm = tissue_preset("clinical"), tissue_preset("in_situ")
    assert soft.youngs_modulus == 95.0e3 and soft.anchor_slack == firm.anchor_slack
    assert soft.anchor_stiffness == firm.anchor_stiffness


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("env.clinical=[gass]", "clinical is 'gass'"),
        ("env.scene.colon.wall_model=solid", r"needs env\.scene\.colon\.wall_model=shell"),
        ("env.sim.solver=newton", r"needs env\.sim\.solver=two_level"),
    ],
)
def test_what_it_needs_is_said(override: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        configured(ALL, override)
