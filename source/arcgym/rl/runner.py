# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""rsl_rl's on-policy runner with checkpoints that survive a kill."""

from __future__ import annotations

import contextlib
import io
import os
import re
import statistics
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from rsl_rl.algorithms import PPO
from rsl_rl.env import VecEnv
from rsl_rl.runners import OnPolicyRunner as RslRlOnPolicyRunner
from rsl_rl.utils.log_writer import LogWriter

from arcgym.rl.checkpoint import read_checkpoint, write_checkpoint
from arcgym.rl.device import join_processes
from arcgym.rl.divergence import check_finite
from arcgym.rl.interrupt import InterruptGuard, TrainingInterrupted
from arcgym.rl.learning_rate import linear_rate, set_learning_rate
from arcgym.rl.params import read_params
from arcgym.rl.patient_writer import PatientWriter
from arcgym.rl.run_clock import BudgetSpent, RunClock
from arcgym.rl.widened import widened, with_memory, with_vectors
from arcgym.utils.errors import UsageError


class OnPolicyRunner(RslRlOnPolicyRunner):
    """On-policy runner that

    * writes checkpoints whole or not at all, and one more on Ctrl-C or SIGTERM; a full disk does not stop it,
    * loads checkpoints as weights only, so that a foreign one runs no code,
    * stops when a loss or a weight is no longer finite, before that is saved, or when its time is over,
    * resumes with the next iteration and with the environment's step counter, so that curricula go on,
    * keeps ``model_best.pt``, the checkpoint with the highest mean episode reward.
    """

    policy_name = "actor"
    """Name of the policy among the algorithm's models and in its checkpoints."""

    def __init__(self, env: VecEnv, train_cfg: dict, log_dir: str | None = None, device: str = "cpu"):
        """Build algorithm and logger; arguments as in rsl_rl."""
        with contextlib.redirect_stdout(io.StringIO()):  # rsl_rl prints every layer
            super().__init__(env, train_cfg, log_dir, device)
        if train_cfg.get("final_learning_rate") is not None and train_cfg["algorithm"].get("schedule") == "adaptive":
            raise UsageError(
                "agent.final_learning_rate is set and agent.algorithm.schedule is 'adaptive', expected 'fixed': "
                "the two would set the learning rate in turns."
            )
        if train_cfg.get("critic_first") and not isinstance(self.alg, PPO):
            raise UsageError(
                f"agent.critic_first is {train_cfg['critic_first']} for {type(self.alg).__name__}, expected 0: PPO "
                "and its relatives alone can leave their policy as it is."
            )
        self.completed_iterations = 0
        self.resumed_at = 0
        self.clock = RunClock(train_cfg.get("max_minutes"), train_cfg.get("max_transitions"))
        self.best_reward = float("-inf")
        self.last_checkpoint: Path | None = None
        self._policy_weights: list[torch.nn.Parameter] = []
        if not train_cfg.get("store_git_diff", False):
            self.logger.git_status_repos.clear()

    def describe_models(self) -> str:
        """Return one line with the kind and the number of weights of each model."""
        models = self._models()
        counts = {name: sum(weight.numel() for weight in model.parameters()) for name, model in models.items()}
        lines = [f"{name} {type(model).__name__}, {counts[name]:,} weights" for name, model in models.items()]
        return f"networks: {'; '.join(lines)}"

    def learn(self, num_learning_iterations: int, init_at_random_ep_len: bool = False) -> None:
        """Run updates; on a signal save a checkpoint and raise :class:`TrainingInterrupted`.

        Args:
            num_learning_iterations: Updates to run, on top of those already done.
            init_at_random_ep_len: Whether the worlds start at random places of their time limit.

        Raises:
            TrainingInterrupted: A signal came; a checkpoint has been saved.
            TrainingDiverged: A loss or a weight is not finite; the checkpoints are from before.
        """
        if self.clock.is_over:
            print(f"nothing is learnt: the run has had {self.clock}, all that agent.{self.clock.limit} gives it")
        if self.cfg.get("critic_first") and not self.cfg.get("init_policy"):
            print(f"note: agent.critic_first={self.cfg['critic_first']} waits for nothing without agent.init_policy")
        if self.cfg.get("init_policy") and self.completed_iterations == 0:
            self._start_from(self.cfg["init_policy"])
        update, log, init_writer = self.alg.update, self.logger.log, self.logger.init_logging_writer
        self.logger.init_logging_writer = lambda: self._init_writer(init_writer)  # type: ignore[method-assign]
        self.logger.log = lambda **values: self._log(log, **values)  # type: ignore[method-assign]
        with InterruptGuard(together=self.is_distributed) as guard:
            self.alg.update = lambda: self._update(update, guard)  # type: ignore[method-assign]
            self.clock.start()
            try:
                super().learn(0 if self.clock.is_over else num_learning_iterations, init_at_random_ep_len)
            except BudgetSpent:
                self._save_last(self.current_learning_iteration)
                print(f"learning ended after {self.clock}, as agent.{self.clock.limit} says")
            except TrainingInterrupted:
                self._save_last(max(self.completed_iterations - 1, 0))
                raise
            finally:
                self.clock.stop()
                self.alg.update, self.logger.log = update, log  # type: ignore[method-assign]
                self.logger.init_logging_writer = init_writer  # type: ignore[method-assign]

    def save(self, path: str, infos: dict | None = None) -> None:
        """Write a checkpoint; see :func:`arcgym.rl.checkpoint.write_checkpoint`."""
        counters = {
            "completed_iterations": self.completed_iterations,
            "common_step_counter": int(self.env.unwrapped.common_step_counter),  # type: ignore[attr-defined]
            "best_reward": self._update_best(path),
            **self.clock.state(),
        }
        checkpoint = {
            **self.alg.save(),
            "iter": self.current_learning_iteration,
            "infos": {**counters, **(infos or {})},
        }
        if write_checkpoint(path, checkpoint):
            self.last_checkpoint = Path(path)
            self.logger.save_model(path, self.current_learning_iteration)

    def load(
        self, path: str, load_cfg: dict | None = None, strict: bool = True, map_location: str | None = None
    ) -> dict:
        """Load a checkpoint and go on from the iteration after it.

        Returns:
            The ``infos`` saved with it.

        Raises:
            UsageError: The file is damaged, holds more than weights, or belongs to other networks.
        """
        contents = read_checkpoint(path, map_location or self.device)
        try:
            self.alg.load(contents, load_cfg, strict)
        except (KeyError, RuntimeError, ValueError) as error:
            raise UsageError(f"{path} {_misfit(error, self.env)}") from error
        if load_cfg is None and self.cfg["algorithm"].get("schedule") != "adaptive":
            set_learning_rate(self.alg, self.cfg["algorithm"]["learning_rate"])  # the checkpoint's may be another one
        infos = contents["infos"] or {}
        self.completed_iterations = int(infos.get("completed_iterations", 0))
        self.current_learning_iteration = self.resumed_at = self.completed_iterations
        self.best_reward = infos.get("best_reward", self.best_reward)
        self.clock.restore(infos)
        self.env.unwrapped.common_step_counter = infos.get("common_step_counter", 0)  # type: ignore[attr-defined]
        return infos

    def _start_from(self, path: str) -> None:
        """Take the policy, and nothing else, from another run's checkpoint: of a distillation, the student."""
        try:
            contents = read_checkpoint(path, self.device)
            own = "student_state_dict" if "student_state_dict" in contents else "actor_state_dict"
            self._check_activation(Path(path).parent)
            policy: Any = self.alg.get_policy()
            wanted = policy.state_dict()
            actor = widened(contents[own], wanted)
            if getattr(policy, "skip_connection", False):
                actor = with_memory(actor, wanted, policy.rnn_hidden_dim)
            else:
                actor = with_vectors(actor, wanted, policy.obs_dim)
            self.alg.load({**contents, f"{self.policy_name}_state_dict": actor}, {self.policy_name: True}, strict=True)
        except (KeyError, RuntimeError, ValueError) as error:
            reason = " ".join(str(error).split())  # torch's has a line for each kind of mismatch
            raise UsageError(f"agent.init_policy={path} does not fit the policy: {reason}") from error
        print(f"policy: starts from {path}, with its deviation")

    def _check_activation(self, run: Path) -> None:
        """Raise if a run's policy has other activations: its weights would fit, and mean something else.

        Raises:
            ValueError: With the two.
        """
        saved = read_params(run)
        then = {} if saved is None else saved.agent.get("student") or saved.agent.get("actor") or {}
        now = self.cfg[self.policy_name]
        for name, old, new in (
            ("activation", then, now),
            ("cnn_cfg.activation", then.get("cnn_cfg") or {}, now.get("cnn_cfg") or {}),
        ):
            if "activation" in old and old["activation"] != new.get("activation", old["activation"]):
                raise ValueError(f"its {name} is {old['activation']}, and here it is {new['activation']}")

    def _update(self, update: Any, guard: InterruptGuard) -> dict[str, float]:
        with guard.hold():
            self._decay()
            self._hold_policy()
            losses: dict[str, float] = {}
            try:
                losses = update()
            finally:  # weights that are NaN also make torch's distributions raise: this names the cause
                weights = {name: list(model.parameters()) for name, model in self._models().items()}
                check_finite(losses, weights, self.completed_iterations)
            self.completed_iterations += 1
        return losses

    @property
    def share_done(self) -> float:
        """Share of the run that is done, by its updates or its clock, whichever is nearer to its end; 1 at the last."""
        updates = self.resumed_at + self.cfg["max_iterations"]
        return min(max(self.completed_iterations / max(updates - 1, 1), self.clock.fraction), 1.0)

    def _decay(self) -> None:
        """Set the learning rate of this iteration where the configuration lets it fall."""
        end = self.cfg.get("final_learning_rate")
        if end is not None:
            set_learning_rate(self.alg, linear_rate(self.cfg["algorithm"]["learning_rate"], end, self.share_done))

    def _hold_policy(self) -> None:
        """Let the critics alone learn in the first ``critic_first`` updates of a policy that another run has learnt."""
        if not self.cfg.get("init_policy") or not self.cfg.get("critic_first"):
            return
        self._policy_weights = self._policy_weights or [
            w for w in self.alg.get_policy().parameters() if w.requires_grad
        ]
        for weight in self._policy_weights:
            weight.requires_grad_(self.completed_iterations >= self.cfg["critic_first"])

    def _configure_multi_gpu(self) -> None:
        """Join the processes of ``torchrun``; rsl_rl knows GPUs alone."""
        if self.device != "cpu" or int(os.environ.get("WORLD_SIZE", "1")) == 1:
            super()._configure_multi_gpu()
            return
        about = self.cfg["multi_gpu"] = join_processes()
        self.is_distributed, self.gpu_world_size = True, about["world_size"]
        self.gpu_local_rank, self.gpu_global_rank = about["local_rank"], about["global_rank"]

    def _models(self) -> dict[str, torch.nn.Module]:
        """Return the algorithm's networks by name."""
        found = {name: value for name, value in vars(self.alg).items() if isinstance(value, torch.nn.Module)}
        return {name.removeprefix("_raw_"): model for name, model in found.items()}

    def _init_writer(self, init_writer: Callable[[], None]) -> None:
        init_writer()
        writer: Any = self.logger.writer
        if writer is not None and not isinstance(writer, LogWriter):
            self.logger.writer = PatientWriter(writer)  # type: ignore[assignment]

    def _log(self, log: Callable[..., None], **values: Any) -> None:
        """Write the curves of an iteration with what the run has taken so far; end the run when its time is over."""
        worlds = self.env.num_envs * self.gpu_world_size
        self.clock.transitions += self.cfg["num_steps_per_env"] * worlds
        if self.logger.writer is not None:
            self.logger.writer.add_scalar("Perf/transitions", self.clock.transitions, values["it"])  # type: ignore
            self.logger.writer.add_scalar("Perf/seconds", self.clock.seconds, values["it"])  # type: ignore
        log(**values)
        if self.clock.is_over:
            raise BudgetSpent

    def _save_last(self, iteration: int) -> None:
        """Save one more checkpoint and close the log."""
        if self.logger.log_dir is not None and not self.logger.disable_logs:
            self.save(str(Path(self.logger.log_dir) / f"model_{iteration}.pt"))
            self.logger.stop_logging_writer()

    def _update_best(self, path: str) -> float:
        """Write ``model_best.pt`` beside ``path`` when the mean episode reward is a new best; return the best."""
        reward = statistics.mean(self.logger.rewbuffer) if self.logger.rewbuffer else float("-inf")
        best = Path(path).with_name("model_best.pt")
        if reward > self.best_reward and Path(path) != best:
            previous, self.best_reward = self.best_reward, reward
            self.save(str(best))
            if self.last_checkpoint != best:
                self.best_reward = previous
        return self.best_reward


def _misfit(error: Exception, env: Any) -> str:
    """Return why a checkpoint cannot be loaded in one line: the first array of another size, or the error's words."""
    reason = str(error.args[0] if error.args else error)
    sizes = r"size mismatch for (\S+): .*?torch.Size\(\[(.*?)\]\).*?torch.Size\(\[(.*?)\]\)"
    found = re.search(sizes, reason, re.DOTALL)
    if found is None:
        return f"does not fit the agent's configuration: {' '.join(reason.split())}"
    name, saved, own = found.groups()
    task = getattr(env.unwrapped.spec, "id", "this task")
    return (
        f"does not fit the agent's configuration: {name} has the size [{saved}], expected [{own}] in {task}. "
        "Is it of a robot with other actions, of other observations or of another network?"
    )
