# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Variants of the navigation tasks that are harder: spoilt pictures, other light, late pictures, other bodies."""

from __future__ import annotations

import pytest

from arcgym.utils.coerce import to_plain
from arcgym.utils.configclass import validate
from arcgym.utils.hydra import apply_overrides
from arcgym.utils.registry import load_cfg_from_registry
from arcgym_tasks.navigation.robustness import NONE, VARIANTS


def test_every_variant_changes_the_task() -> None:
    """Each configuration differs from the plain one, and from the other strengths of its kind."""
    seen = []
    for variant in (NONE, *VARIANTS):
        cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
        cfg.scene.colon.usd_path = ["population:20000", "population:20001"]
        cfg.robustness = variant
        validate(cfg)
        cfg.resolve()
        plain = to_plain(cfg)
        cfg.resolve()  # a configuration that was recorded is resolved again
        assert to_plain(cfg) == plain
        assert plain.pop("robustness") == variant
        assert plain not in seen
        seen.append(plain)
    assert len(seen) == 40 and seen[-1]["scene"]["colon"]["usd_path"][1] == "population:20001*0.7"


def test_less_gas_is_given_to_every_patient_that_a_text_names() -> None:
    cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
    cfg.scene.colon.usd_path, cfg.robustness = "population:20000,20001*0.9", "collapsed_2"
    cfg.resolve()
    assert cfg.scene.colon.usd_path == "population:20000*0.8,20001*0.8"


def test_pictures_that_were_added_are_spoilt_and_delayed_as_well() -> None:
    """A picture of now beside the policy's own is late in ``delay_3``; one of 2 s ago stays of 2 s ago."""
    for variant in ("blur_3", "delay_3"):
        cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
        apply_overrides({"env": cfg}, [
            "env.observations.policy.terms={now: {func: 'arcgym.envs.mdp.observations:rgb'}, "
            "old: {func: 'arcgym.envs.mdp.observations:rgb', delay_min_lag: 20, delay_max_lag: 20}}"
        ])  # fmt: skip
        cfg.robustness = variant
        cfg.resolve()
        policy = cfg.observations.policy
        terms = [policy.rgb, *policy.terms.values()]
        if variant == "blur_3":
            assert [term.params["amount"] for term in terms] == [0.04] * 3
        else:
            assert [(term.delay_min_lag, term.delay_max_lag) for term in terms] == [(4, 4), (4, 4), (20, 20)]


def test_a_variant_that_does_not_exist_or_fit_is_refused() -> None:
    cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
    cfg.robustness = "blur_4"
    with pytest.raises(ValueError, match="robustness is 'blur_4'.*blur_1"):
        validate(cfg)
    cfg.robustness = "collapsed_1"
    with pytest.raises(ValueError, match="colon_1/colon.usda is a stage"):
        cfg.resolve()
    cfg.robustness, cfg.observations.policy.rgb = "blur_1", None
    with pytest.raises(ValueError, match="changes the pictures of env.observations.policy, which has none"):
        cfg.resolve()


def test_friction_is_multiplied_and_set_where_it_is_not_drawn() -> None:
    cfg = load_cfg_from_registry("ARC-LeftColon-Magnetic", "env_cfg_entry_point")
    cfg.robustness = "sticky_1"
    cfg.resolve()
    assert cfg.events.friction.params == {"friction": (0.05, 0.15), "factor": 2.0}
    play = load_cfg_from_registry("ARC-LeftColon-Magnetic-Play", "env_cfg_entry_point")
    play.robustness = "sticky_1"
    play.resolve()
    assert play.events.friction.params == {"friction": (play.sim.contact.friction,) * 2, "factor": 2.0}
