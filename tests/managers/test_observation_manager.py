# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import logging

import pytest
import torch

from arcgym.managers import (
    ConstantNoiseCfg,
    GaussianNoiseCfg,
    ObservationGroupCfg,
    ObservationManager,
    ObservationTermCfg,
    UniformNoiseCfg,
)
from arcgym.managers.buffers import DelayBuffer
from arcgym.utils import configclass
from arcgym.utils.errors import TermError


def column(env) -> torch.Tensor:
    return env.value.unsqueeze(1)


def pair(env) -> torch.Tensor:
    return torch.stack((env.value, -env.value), dim=1)


def image(env) -> torch.Tensor:
    return env.value.to(torch.uint8).view(-1, 1, 1, 1).expand(-1, 3, 4, 4)


def manager_of(env, group: dict | None = None, **terms: ObservationTermCfg) -> ObservationManager:
    return ObservationManager({"policy": ObservationGroupCfg(terms=terms, **(group or {}))}, env)


def run(env, manager: ObservationManager, *values: float) -> list[float]:
    """First entry of world 0 while its value runs through ``values``."""
    out = []
    for value in values:
        env.value = torch.tensor([value, 0.0])
        out.append(manager.compute()["policy"][0].flatten().tolist())
    return out


def test_terms_are_concatenated_in_order(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=column), b=ObservationTermCfg(func=pair))
    assert manager.group_obs_dim == {"policy": (3,)}
    assert manager.compute()["policy"].tolist() == [[1.0, 1.0, -1.0], [3.0, 3.0, -3.0]]


def test_group_is_a_dict_on_request(env) -> None:
    manager = manager_of(
        env, {"concatenate_terms": False}, a=ObservationTermCfg(func=column), b=ObservationTermCfg(func=image)
    )
    obs = manager.compute()["policy"]
    assert obs["a"].shape == (2, 1) and obs["b"].dtype == torch.uint8
    assert manager.active_terms == {"policy": ["a", "b"]}


def test_terms_that_do_not_fit_are_both_named(env) -> None:
    with pytest.raises(
        ValueError, match=r"cannot concatenate 'a' \(1,\) torch.float32 and 'b' \(3, 4, 4\) torch.uint8"
    ):
        manager_of(env, a=ObservationTermCfg(func=column), b=ObservationTermCfg(func=image))


def test_members_of_a_class_are_terms_and_none_switches_off(env) -> None:
    @configclass
    class PolicyCfg(ObservationGroupCfg):
        a = ObservationTermCfg(func=column)
        b = ObservationTermCfg(func=pair)

    @configclass
    class OnlyB(PolicyCfg):
        a = None

    assert ObservationManager({"policy": OnlyB()}, env).active_terms == {"policy": ["b"]}


def test_noise_then_clip_then_scale(env) -> None:
    term = ObservationTermCfg(func=column, noise=ConstantNoiseCfg(bias=1.0), clip=(0.0, 3.0), scale=2.0)
    # World 0: 1 + 1 = 2, times 2. World 1: 3 + 1 = 4, clipped to 3, times 2.
    assert manager_of(env, {"enable_corruption": True}, a=term).compute()["policy"].tolist() == [[4.0], [6.0]]
    assert manager_of(env, {"enable_corruption": False}, a=term).compute()["policy"].tolist() == [[2.0], [6.0]]


def test_noise_statistics(env) -> None:
    value = torch.ones(2, 10000)
    uniform = UniformNoiseCfg(n_min=0.0, n_max=2.0).apply(value, env.random, "uniform")
    assert uniform.min() >= 1.0 and uniform.max() <= 3.0 and uniform.mean().item() == pytest.approx(2.0, abs=0.02)
    normal = GaussianNoiseCfg(mean=1.0, std=0.5, operation="scale").apply(value * 2.0, env.random, "normal")
    assert normal.mean().item() == pytest.approx(2.0, abs=0.03) and normal.std().item() == pytest.approx(1.0, abs=0.03)


def test_fixed_delay_gives_old_values(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=column, delay_min_lag=2, delay_max_lag=2))
    assert run(env, manager, 1, 2, 3, 4, 5) == [[1.0], [1.0], [1.0], [2.0], [3.0]]


def test_delay_comes_before_history(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=column, delay_min_lag=1, delay_max_lag=1, history_length=2))
    assert run(env, manager, 1, 2, 3) == [[1.0, 1.0], [1.0, 1.0], [1.0, 2.0]]


def test_history_is_oldest_first_and_filled_with_the_first_frame(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=column, history_length=3))
    assert run(env, manager, 1, 2, 3, 4) == [[1, 1, 1], [1, 1, 2], [1, 2, 3], [2, 3, 4]]


def test_reset_refills_only_the_worlds_it_names(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=column, history_length=2))
    manager.compute()
    manager.reset(torch.tensor([1]))
    env.value = torch.tensor([5.0, 7.0])
    assert manager.compute()["policy"].tolist() == [[1.0, 5.0], [7.0, 7.0]]


def test_history_of_images_stacks_channels_and_stays_uint8(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=image, history_length=5))
    obs = manager.compute()["policy"]
    assert obs.shape == (2, 15, 4, 4) and obs.dtype == torch.uint8


def test_history_may_be_a_dimension_of_its_own(env) -> None:
    assert manager_of(
        env, a=ObservationTermCfg(func=image, history_length=5, flatten_history_dim=False)
    ).group_obs_dim == {"policy": (5, 3, 4, 4)}


def test_group_history_replaces_that_of_its_terms(env) -> None:
    term = ObservationTermCfg(func=column, history_length=5)
    assert manager_of(env, {"history_length": 2}, a=term).group_obs_dim == {"policy": (2,)}


def test_looking_leaves_no_trace(env) -> None:
    manager = manager_of(env, a=ObservationTermCfg(func=column, history_length=2))
    run(env, manager, 1)
    env.value = torch.tensor([9.0, 9.0])
    assert manager.compute(update_history=False)["policy"][0].tolist() == [1.0, 9.0]
    assert run(env, manager, 2) == [[1.0, 2.0]]


def test_images_take_no_noise(env) -> None:
    with pytest.raises(TermError, match="returned torch.uint8: noise and scale need floating point"):
        manager_of(env, a=ObservationTermCfg(func=image, scale=0.5))


def test_value_per_world_needs_a_dimension(env) -> None:
    with pytest.raises(
        ValueError, match=r"Term 'a' of observation group 'policy' returned shape \(2,\), expected \(2, ...\)"
    ):
        manager_of(env, a=ObservationTermCfg(func=lambda env: env.value))


def test_policies_for_values_that_are_not_finite(env, caplog) -> None:
    managers = {
        policy: manager_of(env, {"nan_policy": policy}, a=ObservationTermCfg(func=column))
        for policy in ("disabled", "sanitize", "warn", "error")
    }
    env.value = torch.tensor([float("nan"), 1.0])
    assert managers["disabled"].compute()["policy"].isnan().any()
    assert managers["sanitize"].compute()["policy"].tolist() == [[0.0], [1.0]]
    with caplog.at_level(logging.WARNING):
        managers["warn"].compute()
    assert "Term 'a' of observation group 'policy' returned values that are not finite" in caplog.text
    with pytest.raises(ValueError, match="not finite"):
        managers["error"].compute()


def test_empty_group_is_refused(env) -> None:
    with pytest.raises(ValueError, match="'policy' has no terms"):
        manager_of(env)


def test_worlds_that_share_a_lag_share_it_after_one_of_them_is_reset(env) -> None:
    """Lags are drawn anew every third step; world 1 begins an episode in between."""
    delay = DelayBuffer((0, 50), 2, "cpu", env.random, per_env=False, update_period=3)
    drawn = set()
    for step in range(12):
        env.random.advance()
        if step in (1, 5):
            delay.reset(torch.tensor([1]))
            delay.append(torch.zeros(2, 1), store=torch.tensor([1]))
        delay.append(torch.zeros(2, 1))
        lag = delay._lag.tolist()
        assert lag[0] == lag[1]
        drawn.add(lag[0])
    assert len(drawn) > 2
