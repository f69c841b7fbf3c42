# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Policies that come with ARCGym: which one a task gets, what they hold, and that nothing is written beside them."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from arcgym.cli.play import PlayArguments, _with_pretrained
from arcgym.cli.task import load_cfgs
from arcgym.rl.checkpoint import read_checkpoint
from arcgym.rl.playing import output_folder
from arcgym.rl.pretrained import folder_of, pretrained_checkpoint, robot_of, write_small
from arcgym.rl.small_weights import restore, shrink
from arcgym.utils.errors import UsageError

TASK = "ARC-Rectum-Magnetic-Play"


@pytest.fixture
def shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A policy of the left colon for the magnetic scope, in an installation of its own; the working folder is empty."""
    (tmp_path / "data" / "usd").mkdir(parents=True)
    monkeypatch.setenv("ARCGYM_ASSETS", str(tmp_path / "data" / "usd"))
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "data" / "policies" / "leftcolon-magnetic" / "model.pt"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"")
    return path


@pytest.mark.parametrize("task", ["ARC-Sigmoid-Magnetic", "ARC-LeftColon-Magnetic-Play"])
def test_a_task_gets_the_policy_of_a_journey_of_its_robot(shipped: Path, task: str) -> None:
    assert robot_of(task) == "magnetic" and pretrained_checkpoint(task) == shipped


def test_a_policy_of_the_task_itself_comes_first(shipped: Path) -> None:
    own = shipped.parents[1] / folder_of(TASK) / "model.pt"
    own.parent.mkdir()
    own.write_bytes(b"")
    assert folder_of(TASK) == "rectum-magnetic" and pretrained_checkpoint(TASK) == own
    assert pretrained_checkpoint("ARC-Splenic-Magnetic") == shipped


def test_a_robot_without_a_policy_is_told_which_have_one(shipped: Path) -> None:
    with pytest.raises(
        UsageError, match="for ARC-Sigmoid-Mine, .* of 'mine'; there are some for: leftcolon-magnetic. Train .*-Mine'"
    ):
        pretrained_checkpoint("ARC-Sigmoid-Mine-Play")
    with pytest.raises(UsageError, match="Train one with 'arcgym train --task ARC-Sigmoid-Mine-v1 --agent sac'"):
        pretrained_checkpoint("ARC-Sigmoid-Mine-Play-v1", "sac")


WAY_BACK = ("env.direction=withdrawal", "env.terminations.stuck=null")


@pytest.mark.parametrize(
    "task, overrides",
    [("ARC-Withdrawal-Magnetic-Play", ()), ("ARC-Sigmoid-Magnetic-Play", WAY_BACK)],
)
@pytest.mark.parametrize("asked", [True, False])
def test_a_way_back_does_not_get_the_policy_of_the_way_in(shipped: Path, task: str, overrides, asked: bool) -> None:
    args = PlayArguments(task=task, overrides=overrides, use_pretrained_checkpoint=asked)
    with pytest.raises(UsageError, match="-Magnetic, and those of journeys go the other way; .* for: leftcolon-mag"):
        _with_pretrained(args)


def test_it_plays_where_nothing_was_trained_and_where_it_is_asked_for(shipped: Path) -> None:
    assert _with_pretrained(PlayArguments(task=TASK)).checkpoint == str(shipped)
    _, agent_cfg = load_cfgs(PlayArguments(task=TASK))
    own = Path("logs/rsl_rl") / agent_cfg.experiment_name / "2026-01-01_00-00-00" / "model_5.pt"
    own.parent.mkdir(parents=True)
    own.write_bytes(b"")
    assert _with_pretrained(PlayArguments(task=TASK)).checkpoint is None
    asked = PlayArguments(task=TASK, use_pretrained_checkpoint=True)
    assert _with_pretrained(asked).checkpoint == str(shipped)


def test_two_checkpoints_are_refused(shipped: Path) -> None:
    with pytest.raises(UsageError, match="--use_pretrained_checkpoint and 'best' are two checkpoints"):
        _with_pretrained(PlayArguments(task=TASK, use_pretrained_checkpoint=True, checkpoint="best"))


def test_nothing_is_written_beside_a_shipped_policy(shipped: Path, tmp_path: Path) -> None:
    assert output_folder("rectum", shipped) == Path("logs/rsl_rl/rectum/pretrained")
    assert output_folder("rectum", tmp_path / "run" / "model_5.pt") == tmp_path / "run"
    assert output_folder("rectum", None, "expert") == Path("logs/rsl_rl/rectum/expert")


def test_a_shipped_policy_is_the_actor_alone_with_what_it_took(tmp_path: Path) -> None:
    """1 + 2^-12 lies between the halves 1 and 1 + 2^-10; a counter stays whole."""
    actor = {"mlp.0.bias": torch.tensor([1.0, 1.0 + 2.0**-12, 0.5]), "steps": torch.tensor(70_000)}
    infos = {"transitions": 600, "best_reward": 1.0}
    contents = {"actor_state_dict": actor, "critic_state_dict": {"w": torch.zeros(9)}, "iter": 5, "infos": infos}
    torch.save(contents, tmp_path / "model_5.pt")
    write_small(tmp_path / "model_5.pt", tmp_path / "out" / "model.pt")
    small = read_checkpoint(tmp_path / "out" / "model.pt")
    assert small["infos"] == {"transitions": 600} and "critic_state_dict" not in small
    assert small["actor_state_dict"]["mlp.0.bias"].tolist() == [1.0, 1.0, 0.5]
    assert small["actor_state_dict"]["steps"].item() == 70_000


def test_fewer_levels_make_a_smaller_file(tmp_path: Path) -> None:
    """A row that reaches from -1 to 1 is rounded to 63 levels, a 31st apart, of which each weight is within half."""
    weights = torch.linspace(-1.0, 1.0, 8192)[torch.randperm(8192, generator=torch.Generator().manual_seed(1))]
    torch.save({"actor_state_dict": {"mlp.0.weight": weights[None]}, "infos": {}}, tmp_path / "model_5.pt")
    sizes = {}
    for levels, bound in ((127, 0.5 / 127), (31, 0.5 / 31)):
        write_small(tmp_path / "model_5.pt", out := tmp_path / f"{levels}.pt", levels)
        sizes[levels] = out.stat().st_size
        read = read_checkpoint(out)["actor_state_dict"]["mlp.0.weight"][0]
        assert 0.9 * bound < float((read - weights).abs().max()) < 1.01 * bound
    assert sizes[31] < 0.9 * sizes[127]
    with pytest.raises(ValueError, match="levels is 128, expected 1 to 127"):
        write_small(tmp_path / "model_5.pt", tmp_path / "more.pt", 128)


def test_matrices_are_whole_numbers_with_a_scale_for_each_output(tmp_path: Path) -> None:
    """Off by at most half a level, 1/254 of a row's largest weight."""
    weights = torch.linspace(-1.0, 1.0, 64 * 100).view(64, 4, 5, 5) * torch.logspace(-3, 3, 64).view(64, 1, 1, 1)
    small, scales = shrink({"w": weights})
    assert small["w"].dtype == torch.int8 and scales["w"].shape == (64,)
    back = restore({"actor_state_dict": small, "actor_scales": scales, "infos": {}})["actor_state_dict"]["w"]
    off = (back - weights).abs().flatten(1).amax(1) / weights.abs().flatten(1).amax(1)
    assert off.max() < 1.001 / 254.0
    torch.save({"actor_state_dict": {"w": weights}, "infos": None}, tmp_path / "model_1.pt")
    write_small(tmp_path / "model_1.pt", tmp_path / "model.pt")
    assert read_checkpoint(tmp_path / "model.pt")["actor_state_dict"]["w"].equal(back)
    assert (tmp_path / "model.pt").stat().st_size < 0.5 * (tmp_path / "model_1.pt").stat().st_size


def test_a_row_of_nothing_stays_nothing() -> None:
    small, scales = shrink({"w": torch.zeros(64, 100)})
    assert restore({"actor_state_dict": small, "actor_scales": scales})["actor_state_dict"]["w"].abs().max() == 0.0
