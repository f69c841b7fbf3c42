# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Configurations of networks for rsl_rl 5.5: encoders, distributions of actions, models."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import FINITE, FieldError, require, require_ascending, require_at_least, require_positive

ACTIVATIONS = (
    "elu",
    "selu",
    "relu",
    "crelu",
    "lrelu",
    "tanh",
    "sigmoid",
    "softplus",
    "gelu",
    "swish",
    "mish",
    "identity",
)
"""Activations that rsl_rl resolves."""


@configclass
class CnnCfg:
    """Convolutional encoder of one image group, layer by layer.

    A sequence has one entry per layer; a single value holds for all layers.
    """

    output_channels: list[int] = [32, 64, 64]
    """Channels after each layer; the length sets the number of layers."""

    kernel_size: list[int] | int = [8, 4, 3]
    """Kernel edge [px]. The default is the Nature-DQN encoder (Mnih et al. 2015), made for 84×84 images."""

    stride: list[int] | int = [4, 2, 1]
    """Stride [px]. Lower it for images under 64 px, where the last layer would have nothing left to see."""

    dilation: list[int] | int = 1
    """Spacing between kernel elements [px]."""

    padding: str = "none"
    """One of ``none``, ``zeros``, ``reflect``, ``replicate``, ``circular``."""

    norm: list[str] | str = "none"
    """One of ``none``, ``batch``, ``layer``. ``batch`` ties the worlds of a batch together; prefer ``layer``."""

    activation: str = "elu"
    """Activation after each layer: any name that rsl_rl resolves (``elu``, ``relu``, ``tanh``, ...)."""

    max_pool: list[bool] | bool = False
    """Whether a 3×3 max pool of stride 2 follows the layer."""

    global_pool: str = "none"
    """One of ``none``, ``max``, ``avg``: pools the last layer to one value a channel. Loses where the lumen is."""

    def validate_config(self) -> None:
        """Check sizes and names, and that each sequence has an entry for every layer.

        Raises:
            FieldError: A value is out of range.
        """
        require_at_least(self, 1, "output_channels", "kernel_size", "stride", "dilation")
        require(self, "padding", ("none", "zeros", "reflect", "replicate", "circular"))
        require(self, "norm", ("none", "batch", "layer"))
        require(self, "activation", ACTIVATIONS)
        require(self, "global_pool", ("none", "max", "avg"))
        layers = len(self.output_channels)
        for name in ("kernel_size", "stride", "dilation", "norm", "max_pool"):
            value = getattr(self, name)
            if isinstance(value, list) and len(value) != layers:
                raise FieldError(self, name, f"has {len(value)} entries, expected {layers}, as output_channels has.")


@configclass
class GaussianDistributionCfg:
    """Normal action distribution with a standard deviation that does not depend on the observation."""

    class_name: str = "GaussianDistribution"
    """Distribution class, resolved by rsl_rl."""

    init_std: float = 1.0
    """Initial standard deviation in units of the raw action, which the action terms scale from [-1, 1]. Lower it where
    a policy jitters at first. One from ``init_policy`` brings its own, which ``std_range`` bounds."""

    std_type: str = "scalar"
    """``scalar`` learns the standard deviation, ``log`` its logarithm, which cannot become negative."""

    std_range: list[float] | None = None
    """Lowest and highest standard deviation; None leaves rsl_rl's wide default. Raise the lowest for a policy that
    stops exploring."""

    learn_std: bool = True
    """Whether the standard deviation is learnt. Turn off for a fixed exploration noise."""

    def validate_config(self) -> None:
        """Check numbers and names.

        Raises:
            FieldError: A value is out of range.
        """
        require_positive(self, "init_std", "std_range")
        require_ascending(self, "std_range")
        require(self, "std_type", ("scalar", "log"))


@configclass
class BetaDistributionCfg:
    """Beta action distribution: actions never leave ``action_range``. Suits steering wheels with hard stops."""

    class_name: str = "BetaDistribution"
    """Distribution class, resolved by rsl_rl."""

    action_range: list[float] = [-1.0, 1.0]
    """Lowest and highest raw action."""

    def validate_config(self) -> None:
        """Check that the range is one.

        Raises:
            FieldError: A value is out of range.
        """
        require(self, "action_range", FINITE)
        require_ascending(self, "action_range")


@configclass
class RslRlMlpModelCfg:
    """Multi-layer perceptron on the concatenated vector groups of an observation set."""

    class_name: str = "MLPModel"
    """Model class: a name in rsl_rl or ``module:Class``."""

    hidden_dims: list[int] = [256, 128]
    """Width of each hidden layer; at least one. Narrow them for a CPU."""

    activation: str = "elu"
    """Activation between layers."""

    obs_normalization: bool = False
    """Whether vector observations are scaled by their running mean and deviation. Needs a vector group."""

    distribution_cfg: GaussianDistributionCfg | BetaDistributionCfg | None = None
    """Distribution over actions; None for a critic."""

    def validate_config(self) -> None:
        """Check widths and names.

        Raises:
            FieldError: A value is out of range.
        """
        require_at_least(self, 1, "hidden_dims")
        require(self, "activation", ACTIVATIONS)
        if not self.hidden_dims:
            raise FieldError(self, "hidden_dims", "is empty, expected one width or more.")


@configclass
class RslRlCnnModelCfg(RslRlMlpModelCfg):
    """CNN on the uint8 image groups of an observation set, joined with its vector groups before the MLP."""

    class_name: str = "arcgym.rl.models:ByteCnnModel"
    """Model class. The default keeps images as bytes in the rollout, a quarter of the memory of floats."""

    cnn_cfg: CnnCfg = CnnCfg()
    """Encoder, one copy for each image group."""
