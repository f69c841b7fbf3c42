# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What recorder terms take from the endoscope's data."""

from __future__ import annotations

import torch

from arcgym.envs import mdp


def test_forces_are_those_on_tip_and_windows(env) -> None:
    env.scope.window_force_w[1, 2, 0] = 3.0
    env.scope.tip_force_w[0, 1] = 2.0
    name, forces = mdp.PostStepForcesRecorder(mdp.PostStepForcesRecorderCfg(), env).record_post_step()
    assert name == "forces"
    assert set(forces) == {"window", "window_peak", "tip", "tip_peak", "base", "tip_pull"}
    assert (forces["window"][1, 2, 0], forces["tip"][0, 1]) == (3.0, 2.0)


def test_forces_on_links_are_recorded_on_request(env) -> None:
    env.scope.link_force_w[0, 1] = torch.tensor([0.0, 0.0, 4.0])
    _, forces = mdp.PostStepForcesRecorder(mdp.PostStepForcesRecorderCfg(links=True), env).record_post_step()
    assert forces["link"][0, 1, 2] == 4.0 and forces["link_peak"].shape == (2, 3)
