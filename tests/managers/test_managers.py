# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import numpy as np
import pytest
import torch

from arcgym.managers import (
    ActionManager,
    CostManager,
    CostTermCfg,
    CurriculumManager,
    CurriculumTermCfg,
    EventManager,
    EventTermCfg,
    MetricsManager,
    MetricsTermCfg,
    ObservationManager,
    RewardManager,
    RewardTermCfg,
    TerminationManager,
    TerminationTermCfg,
)
from arcgym.utils.errors import TermError


def value(env) -> torch.Tensor:
    return env.value


def above(env, limit: float) -> torch.Tensor:
    return env.value > limit


class TestSuccess:
    def test_terms_that_reach_the_goal_are_marked(self, env) -> None:
        """Values 1 and 3: world 1 is above 2 and has reached the goal; both are above 0, which is none."""
        terms = {
            "late": TerminationTermCfg(func=above, params={"limit": 0.0}, time_out=True),
            "there": TerminationTermCfg(func=above, params={"limit": 2.0}, success=True),
        }
        manager = TerminationManager(terms, env)
        manager.compute()
        assert manager.success.tolist() == [False, True]

    def test_without_such_a_term_no_world_succeeds(self, env) -> None:
        manager = TerminationManager({"low": TerminationTermCfg(func=above, params={"limit": 0.0})}, env)
        manager.compute()
        assert manager.success.tolist() == [False, False]


class TestValuesThatAreNoNumbers:
    def test_a_term_that_begins_with_one_is_refused(self, env) -> None:
        env.value = torch.tensor([1.0, torch.nan])
        for manager, kind in (
            (RewardManager, RewardTermCfg),
            (CostManager, CostTermCfg),
            (MetricsManager, MetricsTermCfg),
        ):
            with pytest.raises(ValueError, match=rf"Term 'a' of {manager.__name__} returned \[1.0, nan\] at the start"):
                manager({"a": kind(func=value)}, env)

    def test_later_ones_count_as_zero_and_are_counted_where_the_state_is_finite(self, env) -> None:
        """Two steps of nan and inf: both worlds' values are broken, and world 1's state is broken as well."""
        manager = RewardManager(
            {"a": RewardTermCfg(func=value), "b": RewardTermCfg(func=lambda env: env.value * 0.0 + 1.0)}, env
        )
        assert manager.non_finite_terms() == {}
        for broken in (torch.nan, torch.inf):
            env.value = torch.tensor([broken, broken])
            env.sim.non_finite = torch.tensor([False, True])
            assert manager.compute(1.0).tolist() == [0.0, 0.0]
        assert manager.non_finite_terms() == {"a": 2, "b": 2}

    def test_an_error_in_a_term_names_the_term(self, env) -> None:
        with pytest.raises(AttributeError) as caught:
            RewardManager({"mine": RewardTermCfg(func=lambda env: env.nothing)}, env)
        assert caught.value.__notes__ == ["in the term 'mine' of RewardManager"]


class TestRewards:
    def test_sum_of_weight_value_and_time(self, env) -> None:
        manager = RewardManager(
            {"a": RewardTermCfg(func=value, weight=2.0), "b": RewardTermCfg(func=value, weight=-1.0)}, env
        )
        assert manager.compute(dt=0.5).tolist() == [0.5, 1.5]
        assert manager.step_parts["a"].tolist() == [1.0, 3.0]

    def test_step_values_are_rates(self, env) -> None:
        manager = RewardManager({"a": RewardTermCfg(func=value, weight=2.0)}, env)
        manager.compute(dt=0.5)
        assert manager.step_values["a"].tolist() == [2.0, 6.0]

    def test_log_is_the_mean_episode_sum_over_the_longest_episode(self, env) -> None:
        manager = RewardManager({"a": RewardTermCfg(func=value)}, env)
        for _ in range(2):
            manager.compute(dt=1.0)
        assert manager.reset(torch.tensor([1]))["Episode_Reward/a"].item() == 6.0 / 2.0
        assert manager.reset()["Episode_Reward/a"].item() == (2.0 + 0.0) / 2.0 / 2.0

    def test_value_that_is_not_finite_counts_as_zero(self, env) -> None:
        manager = RewardManager({"a": RewardTermCfg(func=value)}, env)
        env.value = torch.tensor([float("inf"), float("nan")])
        assert manager.compute(1.0).tolist() == [0.0, 0.0]

    def test_values_that_were_handed_out_stay(self, env) -> None:
        manager = RewardManager({"a": RewardTermCfg(func=value), "off": RewardTermCfg(func=value, weight=0.0)}, env)
        manager.compute(1.0)
        before = manager.step_values
        env.value = torch.tensor([7.0, 7.0])
        manager.compute(1.0)
        assert before["a"].tolist() == [1.0, 3.0] and before["off"].tolist() == [0.0, 0.0]
        assert manager.episode_sums["a"].tolist() == [8.0, 10.0]

    def test_weight_can_be_changed_while_running(self, env) -> None:
        manager = RewardManager({"a": RewardTermCfg(func=value, weight=0.0)}, env)
        assert manager.compute(1.0).tolist() == [0.0, 0.0]
        manager.get_term_cfg("a").weight = 1.0
        assert manager.compute(1.0).tolist() == [1.0, 3.0]
        manager.get_term_cfg("a").weight = np.float64(2.0)
        assert manager.compute(1.0).dtype == torch.float32
        with pytest.raises(ValueError, match="RewardManager has no term 'b'.*Available: a"):
            manager.get_term_cfg("b")


def test_costs_log_their_episode_sum(env) -> None:
    manager = CostManager({"a": CostTermCfg(func=value), "b": CostTermCfg(func=value)}, env)
    assert manager.compute(dt=0.5).tolist() == [1.0, 3.0]
    assert manager.reset()["Episode_Cost/a"].item() == (0.5 + 1.5) / 2


class TestTerminations:
    def test_time_outs_are_kept_apart(self, env) -> None:
        cfg = {
            "lost": TerminationTermCfg(func=above, params={"limit": 2.0}),
            "time": TerminationTermCfg(func=above, params={"limit": 0.0}, time_out=True),
        }
        manager = TerminationManager(dict(reversed(cfg.items())), env)
        assert manager.compute().tolist() == [True, True]
        assert manager.terminated.tolist() == [False, True]
        assert manager.time_outs.tolist() == [True, True]
        assert manager.get_term("lost").tolist() == [False, True]
        logs = manager.reset(torch.tensor([0]))
        assert logs["Episode_Termination/lost"].item() == 0.0 and logs["Episode_Termination/time"].item() == 1.0

    def test_value_must_stay_bool(self, env) -> None:
        manager = TerminationManager({"a": TerminationTermCfg(func=above, params={"limit": 2.0})}, env)
        manager.set_term_cfg("a", TerminationTermCfg(func=value))
        with pytest.raises(TermError, match="Term 'a' of TerminationManager returned torch.float32"):
            manager.compute()

    def test_value_must_be_bool(self, env) -> None:
        with pytest.raises(TermError, match="returned torch.float32, expected torch.bool"):
            TerminationManager({"a": TerminationTermCfg(func=value)}, env)


@pytest.mark.parametrize(("reduce", "expected"), [("mean", 2.0), ("last", -1.0), ("max", 5.0), ("sum", 6.0)])
def test_metrics_reduce_over_the_episode(env, reduce, expected) -> None:
    manager = MetricsManager({"a": MetricsTermCfg(func=value, reduce=reduce)}, env)
    for first in (2.0, 5.0, -1.0):
        env.value = torch.tensor([first, 100.0])
        manager.compute()
    assert manager.reset(torch.tensor([0]))["Episode_Metrics/a"].item() == expected


@pytest.mark.parametrize(("reduce", "expected"), [("mean", 3.0), ("last", 2.0), ("max", 4.0), ("sum", 6.0)])
def test_the_step_in_which_a_state_breaks_is_left_out(env, reduce: str, expected: float) -> None:
    """Steps of 4 and 2, then one whose state is not finite: neither a further zero nor the last value."""
    manager = MetricsManager({"a": MetricsTermCfg(func=value, reduce=reduce)}, env)
    for first, broken in ((4.0, False), (2.0, False), (torch.nan, True)):
        env.value = torch.tensor([first, 1.0])
        env.sim.non_finite = torch.tensor([broken, False])
        manager.compute()
    assert manager.reset(torch.tensor([0]))["Episode_Metrics/a"].item() == expected
    assert manager.get_value("a")[1].item() == (3.0 if reduce == "sum" else 1.0)


def test_metrics_of_all_reductions_side_by_side(env) -> None:
    reductions = ("mean", "max", "sum", "last", "mean")
    cfg = {f"{reduce}_{k}": MetricsTermCfg(func=value, reduce=reduce) for k, reduce in enumerate(reductions)}
    manager = MetricsManager(cfg, env)
    for first in (-2.0, -5.0, -5.0):
        env.value = torch.tensor([first, 1.0])
        manager.compute()
    expected = {"mean_0": -4.0, "max_1": -2.0, "sum_2": -12.0, "last_3": -5.0, "mean_4": -4.0}
    assert {name: manager.get_value(name)[0].item() for name in cfg} == expected
    logs = manager.reset(torch.tensor([0]))
    assert logs == {f"Episode_Metrics/{name}": figure for name, figure in expected.items()}
    assert [manager.get_value(name).tolist() for name in ("max_1", "sum_2")] == [[0.0, 1.0], [0.0, 3.0]]


def test_metric_reduced_otherwise_from_now_on_leaves_the_others_alone(env) -> None:
    cfg = {name: MetricsTermCfg(func=value, reduce=name) for name in ("last", "sum", "mean")}
    manager = MetricsManager(cfg, env)
    manager.compute()
    manager.reset()
    manager.set_term_cfg("last", MetricsTermCfg(func=value, reduce="mean"))
    manager.compute()
    manager.compute()
    assert {name: manager.get_value(name)[1].item() for name in cfg} == {"last": 3.0, "sum": 6.0, "mean": 3.0}


def test_unknown_reduction_is_named(env) -> None:
    with pytest.raises(ValueError, match="Term 'a' of MetricsManager: no reduction 'maxx'. Did you mean 'max'"):
        MetricsManager({"a": MetricsTermCfg(func=value, reduce="maxx")}, env)


def test_metrics_leave_out_worlds_without_a_step(env) -> None:
    manager = MetricsManager({"a": MetricsTermCfg(func=value)}, env)
    manager.compute()
    manager.reset(torch.tensor([0]))
    assert manager.reset()["Episode_Metrics/a"].item() == 3.0


class TestEvents:
    @staticmethod
    def note(env, env_ids, label="") -> None:
        env.events.append((label, env_ids.tolist()))

    def manager(self, env, **kwargs) -> EventManager:
        env.events = []
        return EventManager({"a": EventTermCfg(func=self.note, **kwargs)}, env)

    def test_modes_are_apart(self, env) -> None:
        manager = self.manager(env, mode="startup", params={"label": "start"})
        manager.apply("reset", torch.tensor([0]), global_env_step_count=0)
        assert env.events == []
        manager.apply("startup")
        assert env.events == [("start", [0, 1])]

    def test_interval_comes_when_its_time_is_over(self, env) -> None:
        manager = self.manager(env, mode="interval", interval_range_s=(0.2, 0.2))
        for _ in range(2):
            manager.apply("interval", dt=0.1)
        manager.reset(torch.tensor([1]))
        for _ in range(2):
            manager.apply("interval", dt=0.1)
        assert [ids for _, ids in env.events] == [[0, 1], [0, 1]]

    def test_reset_starts_the_timer_of_its_worlds_again(self, env) -> None:
        manager = self.manager(env, mode="interval", interval_range_s=(0.2, 0.2))
        manager.apply("interval", dt=0.1)
        manager.reset(torch.tensor([1]))
        manager.apply("interval", dt=0.1)
        manager.apply("interval", dt=0.1)
        assert [ids for _, ids in env.events] == [[0], [1]]

    def test_global_timer_takes_all_worlds_and_ignores_resets(self, env) -> None:
        manager = self.manager(env, mode="interval", interval_range_s=(0.2, 0.2), is_global_time=True)
        manager.apply("interval", dt=0.1)
        manager.reset(torch.tensor([1]))
        manager.apply("interval", dt=0.1)
        assert [ids for _, ids in env.events] == [[0, 1]]

    def test_expensive_reset_event_waits(self, env) -> None:
        manager = self.manager(env, mode="reset", min_step_count_between_reset=10)
        for step, ids in ((0, [0, 1]), (5, [0]), (10, [0]), (12, [0, 1])):
            manager.apply("reset", torch.tensor(ids), global_env_step_count=step)
        assert [ids for _, ids in env.events] == [[0, 1], [0], [1]]

    def test_configuration_errors_are_named(self, env) -> None:
        with pytest.raises(ValueError, match="no mode 'resets'. Did you mean 'reset'"):
            self.manager(env, mode="resets")
        with pytest.raises(ValueError, match="interval_range_s must be given"):
            self.manager(env, mode="interval")
        with pytest.raises(TermError, match=r"must take \(env, env_ids, ...\)"):
            EventManager({"a": EventTermCfg(func=value, mode="reset")}, env)


def test_curriculum_logs_what_its_terms_return(env) -> None:
    cfg = {
        "level": CurriculumTermCfg(func=lambda env, env_ids: float(len(env_ids))),
        "parts": CurriculumTermCfg(func=lambda env, env_ids: {"x": 1.0}),
        "silent": CurriculumTermCfg(func=lambda env, env_ids: None),
    }
    manager = CurriculumManager(cfg, env)
    manager.compute(torch.tensor([0, 1]))
    assert manager.reset() == {"Curriculum/level": 2.0, "Curriculum/parts/x": 1.0}


def test_managers_without_terms_are_neutral(env) -> None:
    assert RewardManager(None, env).compute(1.0).tolist() == [0.0, 0.0]
    assert CostManager(None, env).reset() == {}
    assert TerminationManager(None, env).compute().tolist() == [False, False]
    assert MetricsManager(None, env).reset() == {}
    assert ObservationManager(None, env).compute() == {}
    assert CurriculumManager(None, env).reset() == {}
    EventManager(None, env).apply("startup")
    actions = ActionManager(None, env)
    actions.process_action(torch.zeros(2, 0))
    actions.apply_action()


def test_table_lists_the_terms(env) -> None:
    table = str(RewardManager({"progress": RewardTermCfg(func=value, weight=2.5)}, env)).splitlines()
    assert table[0] == "RewardManager (1 terms)"
    assert table[1].split() == ["index", "name", "weight"] and table[3].split() == ["0", "progress", "2.5"]
