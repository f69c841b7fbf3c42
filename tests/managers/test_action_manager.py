# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch

from arcgym.managers import ActionManager, ActionTerm, ActionTermCfg
from arcgym.utils import configclass
from arcgym.utils.errors import TermError


class Scaled(ActionTerm):
    """Multiplies its entries and keeps them as the asset's command."""

    @property
    def action_dim(self) -> int:
        return self.cfg.size

    @property
    def raw_actions(self) -> torch.Tensor:
        return self._raw

    @property
    def processed_actions(self) -> torch.Tensor:
        return self._raw * self.cfg.scale

    def process_actions(self, actions: torch.Tensor) -> None:
        self._raw = actions

    def apply_actions(self) -> None:
        self._asset.command = self.processed_actions


@configclass
class ScaledCfg(ActionTermCfg):
    class_type = Scaled
    size: int = 1
    scale: float = 1.0


@pytest.fixture
def manager(env) -> ActionManager:
    return ActionManager(
        {"a": ScaledCfg(asset_name="endoscope", size=2, scale=10.0), "b": ScaledCfg(asset_name="colon")}, env
    )


def test_vector_is_split_in_order(env, manager) -> None:
    assert manager.action_term_dim == [2, 1] and manager.total_action_dim == 3
    manager.process_action(torch.tensor([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
    manager.apply_action()
    assert env.scene["endoscope"].command.tolist() == [[10.0, 20.0], [40.0, 50.0]]
    assert env.scene["colon"].command.tolist() == [[3.0], [6.0]]


def test_last_actions_are_kept_and_reset_by_world(manager) -> None:
    for value in (1.0, 2.0):
        manager.process_action(torch.full((2, 3), value))
    manager.reset(torch.tensor([0]))
    assert manager.action[:, 0].tolist() == [0.0, 2.0] and manager.prev_action[:, 0].tolist() == [0.0, 1.0]


def test_errors_name_what_was_expected(env, manager) -> None:
    with pytest.raises(ValueError, match=r"got an action of shape \(2, 2\), expected \(2, 3\)"):
        manager.process_action(torch.zeros(2, 2))
    with pytest.raises(ValueError, match="no asset 'scope'.*Available: colon, endoscope"):
        ActionManager({"a": ScaledCfg(asset_name="scope")}, env)
    with pytest.raises(TermError, match="Term 'a' of ActionManager has class_type .*dict.*expected an ActionTerm"):
        ActionManager({"a": ActionTermCfg(class_type=dict, asset_name="colon")}, env)
