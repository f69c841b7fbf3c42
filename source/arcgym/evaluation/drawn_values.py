# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What events have drawn for the bodies of each world, for the rows of trials."""

from __future__ import annotations

from typing import Any

import torch


def drawn_values(env: Any) -> list[dict[str, float]]:
    """Return the values of every world by column, N long.

    ``friction`` between scope and wall; ``wall_stiffness`` and ``anchor_stiffness``: shear stiffness of the wall over
    the configured one, and factor on the anchors.

    Args:
        env: Environment with a colon.
    """
    sim, colon = env.sim, env.scene["colon"]
    configured = colon.moduli(*colon.elasticity())[0]
    columns: dict[str, torch.Tensor] = {
        "friction": sim.friction,
        "wall_stiffness": sim.moduli[:, 0].double() / configured,
        "anchor_stiffness": sim.anchor_scale,
    }
    values = {name: column.flatten().tolist() for name, column in columns.items()}
    return [{name: values[name][world] for name in values} for world in range(env.num_envs)]
