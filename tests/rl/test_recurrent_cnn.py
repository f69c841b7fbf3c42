# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch
from pixel_tasks import RememberTheSide, mean_reward
from rsl_rl.utils import split_and_pad_trajectories
from small_agents import ENCODER, roll_and_update, runner_cfg, with_memory
from tensordict import TensorDict

from arcgym.evaluation.batched_policy import BatchedPolicy
from arcgym.rl import GaussianDistributionCfg, OnPolicyRunner, export_policy_as_jit, export_policy_as_onnx
from arcgym.rl.agent_cfgs.image_models import RecurrentCnnModelCfg
from arcgym.rl.networks.augmented_cnn import AugmentedCnnModel
from arcgym.rl.networks.recurrent_cnn import RecurrentCnnModel
from arcgym.utils.threads import one_thread

CNN = {"output_channels": [4], "kernel_size": 4, "stride": 2}
KINDS = pytest.mark.parametrize("kind, layers", [("lstm", 1), ("gru", 2)])
GROUPS = pytest.mark.parametrize("groups", [("policy",), ("policy", "proprio")])
SKIP = pytest.mark.parametrize("skip", [False, True])


def make_obs(*batch: int) -> TensorDict:
    torch.manual_seed(0)
    images = torch.randint(0, 256, (*batch, 1, 12, 12), dtype=torch.uint8)
    return TensorDict({"policy": images, "proprio": torch.randn(*batch, 3)}, batch_size=batch)


def make_model(
    kind: str = "lstm", layers: int = 1, groups=("policy", "proprio"), skip: bool = False
) -> RecurrentCnnModel:
    torch.manual_seed(1)
    recurrent = {"rnn_type": kind, "rnn_hidden_dim": 5, "rnn_num_layers": layers, "skip_connection": skip}
    return RecurrentCnnModel(make_obs(2), {"actor": list(groups)}, "actor", 2, [8], cnn_cfg=CNN, **recurrent)


@KINDS
@SKIP
def test_learning_on_padded_pieces_equals_acting(kind, layers, skip):
    """Three worlds, four steps; world 1 is done after its second, so its memory starts again there."""
    model, obs = make_model(kind, layers, skip=skip), make_obs(4, 3)
    dones = torch.zeros(4, 3, 1, dtype=torch.uint8)
    dones[1, 1] = 1
    acted = []
    with torch.inference_mode():
        for step in range(4):
            acted.append(model(obs[step]))
            model.reset(dones[step, :, 0])
    pieces, masks = split_and_pad_trajectories(obs, dones)
    zeros = torch.zeros(layers, masks.shape[1], 5)
    learned = model(pieces, masks=masks, hidden_state=(zeros, zeros) if kind == "lstm" else zeros)
    torch.testing.assert_close(learned, torch.stack(acted))


def test_skip_connection_puts_what_is_remembered_behind_the_features():
    """Images of 12 px give four maps of 5 x 5, with three vectors 103 features; the memory has 5 numbers.

    World 0 is done after its second of three steps: six steps in pieces of two, one and three.
    """
    model, obs = make_model("gru", skip=True), make_obs(3, 2)
    dones = torch.zeros(3, 2, 1, dtype=torch.uint8)
    dones[1, 0] = 1
    features = torch.stack([AugmentedCnnModel.get_latent(model, obs[step]) for step in range(3)])
    acted = []
    with torch.no_grad():
        for step in range(3):
            acted.append(model.get_latent(obs[step]))
            model.reset(dones[step, :, 0])
    pieces, masks = split_and_pad_trajectories(obs, dones)
    assert masks.sum(0).tolist() == [2, 1, 3]
    learned = model.get_latent(pieces, masks, torch.zeros(1, 3, 5))
    assert learned.shape == (3, 2, 103 + 5)
    torch.testing.assert_close(learned, torch.stack(acted))
    torch.testing.assert_close(learned[..., :103], features)


def test_reset_forgets_only_the_worlds_that_are_done():
    model, obs = make_model(), make_obs(2)
    with torch.no_grad():
        first = model(obs)
        model.reset(torch.tensor([1, 0]))
        again = model(obs)
    torch.testing.assert_close(again[0], first[0])
    assert not torch.allclose(again[1], first[1])


def test_each_batch_of_an_evaluation_forgets_its_own_worlds():
    """Three worlds in batches of two: world 2 is alone in the second, and its episode ends."""
    model, obs = make_model(skip=True), make_obs(3)
    policy = BatchedPolicy(model, 3, batch=2)
    with torch.no_grad():
        first = policy(obs)
        policy.reset(torch.tensor([0, 0, 1]))
        again = policy(obs)
    torch.testing.assert_close(again[2], first[2])
    assert not torch.allclose(again[0], first[0]) and not torch.allclose(again[1], first[1])


@KINDS
@GROUPS
@SKIP
def test_jit_equals_the_policy(tmp_path, kind, layers, groups, skip):
    model, obs = make_model(kind, layers, groups, skip).eval(), make_obs(3, 4)
    policy = torch.jit.load(export_policy_as_jit(model, tmp_path))
    vectors = obs["proprio"] if "proprio" in groups else torch.zeros(3, 4, 0)
    with torch.no_grad():
        expected = torch.stack([model(obs[step]) for step in range(3)])
        got = torch.stack([policy(vectors[step], [obs["policy"][step]]) for step in range(3)])
        torch.testing.assert_close(got, expected)
        policy.reset()
        torch.testing.assert_close(policy(vectors[0], [obs["policy"][0]]), expected[0])


@KINDS
@GROUPS
@SKIP
def test_onnx_equals_the_policy(tmp_path, kind, layers, groups, skip):
    reference = pytest.importorskip("onnx.reference")
    model, obs = make_model(kind, layers, groups, skip).eval(), make_obs(3, 4)
    session = reference.ReferenceEvaluator(str(export_policy_as_onnx(model, tmp_path)))
    state = torch.zeros(4, *model.as_onnx().state_shape).numpy()
    for step in range(3):
        inputs = {"policy": obs["policy"][step].numpy(), "state_in": state}
        inputs |= {"obs": obs["proprio"][step].numpy()} if "proprio" in groups else {}
        actions, state = session.run(None, inputs)
        with torch.no_grad():
            torch.testing.assert_close(torch.from_numpy(actions), model(obs[step]), rtol=1e-4, atol=1e-5)


def test_image_critic_without_memory_beside_a_recurrent_actor():
    """Two environments' rollouts of three steps: the critic's values are those of the single images."""
    obs = make_obs(3, 2)
    critic = AugmentedCnnModel(make_obs(2), {"critic": ["policy"]}, "critic", 1, [8], cnn_cfg=CNN)
    pieces, masks = split_and_pad_trajectories(obs, torch.zeros(3, 2, 1, dtype=torch.uint8))
    values = critic(pieces, masks=masks)
    torch.testing.assert_close(values, torch.stack([critic(obs[step]) for step in range(3)]))


def test_unknown_layer_is_refused():
    with pytest.raises(ValueError, match="'rnn', expected one of: lstm, gru"):
        make_model("rnn")


@pytest.mark.parametrize("kind", ["lstm", "gru"])
@one_thread()
def test_remembers_the_side(kind):
    torch.manual_seed(0)
    actor = RecurrentCnnModelCfg(
        hidden_dims=[16],
        cnn_cfg=ENCODER,
        rnn_type=kind,
        rnn_hidden_dim=16,
        distribution_cfg=GaussianDistributionCfg(init_std=0.6),
    )
    cfg = runner_cfg(actor=actor, num_steps_per_env=10)
    runner = OnPolicyRunner(RememberTheSide(128), cfg.to_dict(), device="cpu")
    runner.learn(25)
    policy = runner.get_inference_policy()
    policy.reset()
    assert mean_reward(RememberTheSide(64, seed=1), policy, 50) > 0.7


@one_thread()
def test_without_memory_the_side_is_lost():
    torch.manual_seed(0)
    runner = OnPolicyRunner(RememberTheSide(128), runner_cfg(num_steps_per_env=10).to_dict(), device="cpu")
    runner.learn(15)
    assert abs(mean_reward(RememberTheSide(64, seed=1), runner.get_inference_policy(), 50)) < 0.15


@one_thread()
def test_probabilities_of_what_was_done_are_those_it_was_done_with() -> None:
    """Nothing has learnt, so that all ratios are one and the mean advantage is nought: two worlds a mini-batch."""
    torch.manual_seed(1)
    algorithm = runner_cfg().algorithm.replace(learning_rate=1e-12, num_mini_batches=2, num_learning_epochs=1)
    runner = OnPolicyRunner(
        RememberTheSide(4), runner_cfg(actor=with_memory(), algorithm=algorithm).to_dict(), device="cpu"
    )
    assert [roll_and_update(runner)["surrogate"] for _ in range(3)] == pytest.approx([0.0] * 3, abs=1e-5)
