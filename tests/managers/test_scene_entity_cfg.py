# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from arcgym.managers import SceneEntityCfg


def resolved(env, *args, **kwargs) -> SceneEntityCfg:
    cfg = SceneEntityCfg(*args, **kwargs)
    cfg.resolve(env.scene)
    return cfg


def test_everything_is_selected_by_default(env) -> None:
    cfg = resolved(env, "endoscope")
    assert cfg.joint_ids == slice(None) and cfg.body_ids == slice(None) and cfg.node_ids == slice(None)


def test_joints_and_bodies_by_expression(env) -> None:
    cfg = resolved(env, "endoscope", joint_names=["hinge_.*"], body_names="tip")
    assert cfg.joint_ids.tolist() == [2, 3, 4] and cfg.body_ids.tolist() == [2]


def test_selecting_all_names_needs_no_index(env) -> None:
    assert resolved(env, "endoscope", joint_names=".*").joint_ids == slice(None)


def test_order_of_names_is_kept_on_request(env) -> None:
    names = ["hinge_3", "root_roll"]
    assert resolved(env, "endoscope", joint_names=names).joint_ids.tolist() == [1, 4]
    assert resolved(env, "endoscope", joint_names=names, preserve_order=True).joint_ids.tolist() == [4, 1]


def test_segments_select_wall_nodes(env) -> None:
    # Nodes 0..3 lie in rectum, sigmoid, sigmoid, descending.
    assert resolved(env, "colon", segments=["sigmoid"]).node_ids.tolist() == [1, 2]
    assert resolved(env, "colon", segments=["rectum", "descending"]).node_ids.tolist() == [0, 3]


def test_segments_at_different_nodes_in_other_patients_are_refused(env) -> None:
    env.scene["colon"].patients.append(SimpleNamespace(wall=SimpleNamespace(segment=np.array([0, 0, 1, 2]))))
    with pytest.raises(ValueError, match="patients of 'colon' have .*sigmoid.* at different nodes"):
        resolved(env, "colon", segments=["sigmoid"])


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"name": "scope"}, "no entity 'scope'.*Available: colon, endoscope"),
        (
            {"name": "endoscope", "joint_names": "hing_1"},
            "joint_names of the entity 'endoscope'.*Did you mean 'hinge_1'",
        ),
        ({"name": "colon", "joint_names": ".*"}, "has no joint_names"),
        ({"name": "colon", "segments": "sigmoyd"}, "Did you mean 'sigmoid'"),
        ({"name": "colon", "segments": "cecum"}, "no nodes in the segments"),
        ({"name": "endoscope", "segments": "rectum"}, "segments need a colon"),
        ({"name": "colon", "segments": "rectum", "node_ids": [1]}, "both segments and node_ids"),
    ],
)
def test_errors_list_the_alternatives(env, kwargs, message) -> None:
    with pytest.raises(ValueError, match=message):
        resolved(env, **kwargs)
