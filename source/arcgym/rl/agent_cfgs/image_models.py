# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of image models with augmentation or memory."""

from __future__ import annotations

from arcgym.rl.model_cfg import RslRlCnnModelCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import Range, require, require_at_least


@configclass
class AugmentedCnnModelCfg(RslRlCnnModelCfg):
    """CNN whose images change at random while it learns."""

    class_name: str = "arcgym.rl.networks.augmented_cnn:AugmentedCnnModel"
    """Model class."""

    shift: int = 4
    """Largest random shift [px]; 0 switches it off. A twentieth of the image's edge is usual."""

    color_jitter: float = 0.0
    """Largest random change of brightness, contrast and saturation, as a factor's distance from one; the frames of a
    stack change alike, and each must be RGB. 0 switches it off; 0.2 makes a policy less of one lamp and one mucosa."""

    shrink: int = 1
    """Edge of the square blocks of pixels that are averaged into one before the encoder; must divide the image. Soft
    actor-critic stores images of that size, which makes its memory smaller by the square. Fit ``cnn_cfg`` to it."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        super().validate_config()
        require_at_least(self, 0, "shift", unit="px")
        require(self, "color_jitter", Range(0.0, 1.0, below=True))
        require_at_least(self, 1, "shrink", unit="px")


@configclass
class RecurrentCnnModelCfg(AugmentedCnnModelCfg):
    """CNN and recurrent layer. Give it single frames rather than a stack: it remembers by itself."""

    class_name: str = "arcgym.rl.networks.recurrent_cnn:RecurrentCnnModel"
    """Model class."""

    shift: int = 0
    """Largest random shift [px], drawn anew for every step of a sequence."""

    rnn_type: str = "lstm"
    """``lstm`` or ``gru``; a GRU has three quarters of the weights."""

    rnn_hidden_dim: int = 256
    """Width of the hidden state."""

    rnn_num_layers: int = 1
    """Recurrent layers."""

    skip_connection: bool = False
    """Whether the MLP reads the features of the CNN too, and behind them the recurrent layer's output. Switch it on to
    start from a policy without memory (``agent.init_policy``), with that one's ``hidden_dims`` and ``cnn_cfg``: it acts
    as that one does until it has learnt what to remember."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds or a name is unknown.
        """
        super().validate_config()
        require(self, "rnn_type", ("lstm", "gru"))
        require_at_least(self, 1, "rnn_hidden_dim", "rnn_num_layers")
