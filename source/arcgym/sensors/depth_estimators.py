# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Depth of the tip's view for rules and rewards: the simulator's, or an estimate from the color image."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import torch

from arcgym.utils.errors import UsageError


class DepthSource(Protocol):
    """Gives the depth of the latest view of N worlds."""

    def __call__(self) -> torch.Tensor:
        """Return the distance along the ray [m], float32, shape (N, H, W)."""


class SimulatorDepth:
    """The camera's own depth; a real endoscope has none."""

    def __init__(self, env: Any, camera: str = "camera"):
        """Read the scene's sensor ``camera`` of a manager-based environment."""
        self._camera = env.unwrapped.scene[camera]

    def __call__(self) -> torch.Tensor:
        """Return the depth [m], shape (N, H, W)."""
        return self._camera.data.output["depth"]


class EstimatedDepth:
    """Depth estimated from the camera's color image, each frame aligned by itself.

    Monocular networks give inverse depth up to a scale and a shift that differ from frame to frame.
    """

    def __init__(
        self,
        env: Any,
        estimate: Callable[[torch.Tensor], torch.Tensor],
        near: float = 0.003,
        far: float = 0.1,
        align_to_simulator: bool = False,
        camera: str = "camera",
    ):
        """Read the scene's sensor ``camera``.

        Args:
            env: Manager-based environment.
            estimate: Inverse depth, any scale, shape (N, H, W), of uint8 images, shape (N, H, W, 3).
            near: Depth [m] that the nearest pixel of every frame is given.
            far: Depth [m] that the farthest pixel of every frame is given.
            align_to_simulator: Whether scale and shift are fitted to the simulator's depth instead. For studies of the
                network's own error only: a real endoscope cannot do it.
            camera: Name of the sensor.
        """
        self._camera = env.unwrapped.scene[camera]
        self._estimate, self._near, self._far = estimate, near, far
        self._align_to_simulator = align_to_simulator

    def __call__(self) -> torch.Tensor:
        """Return the depth [m], shape (N, H, W)."""
        output = self._camera.data.output
        inverse = self._estimate(output["rgb"]).to(output["rgb"].device, torch.float32)
        if self._align_to_simulator:
            return align_to_reference(inverse, output["depth"])
        return align_to_range(inverse, self._near, self._far)


class TransformersDepth:
    """A network for monocular depth, such as Depth Anything, through the pipeline of ``transformers``.

    Nothing is downloaded: the weights are a folder that the user gives.
    """

    def __init__(self, weights: str | Path, device: str = "cpu", batch_size: int = 16, gives_depth: bool = False):
        """Load the network.

        Args:
            weights: Folder with the network as ``save_pretrained`` of transformers writes it.
            device: Device of the network.
            batch_size: Images at a time.
            gives_depth: Whether the network answers with depth, as the metric variants do, and not with its inverse.

        Raises:
            UsageError: If the folder does not exist.
            UsageError: If transformers is not installed.
        """
        if not Path(weights).is_dir():
            raise UsageError(f"No depth network in '{weights}', expected a folder with config.json and weights.")
        try:
            from transformers import pipeline  # type: ignore[import-not-found]
        except ImportError as error:
            raise UsageError("Depth estimation needs transformers: pip install transformers.") from error
        self._pipeline = pipeline("depth-estimation", model=str(weights), device=device)
        self._batch_size, self._gives_depth = batch_size, gives_depth

    def __call__(self, images: torch.Tensor) -> torch.Tensor:
        """Return inverse depth of any scale, shape (N, H, W), of uint8 images, shape (N, H, W, 3)."""
        from PIL import Image

        pictures = [Image.fromarray(image) for image in images.cpu().numpy()]
        results = self._pipeline(pictures, batch_size=self._batch_size)
        depths = [torch.as_tensor(result["predicted_depth"]).reshape(1, 1, *_edges(result)) for result in results]
        size = images.shape[1:3]
        resized = [torch.nn.functional.interpolate(d, size=tuple(size), mode="bilinear") for d in depths]
        answer = torch.cat(resized)[:, 0].to(images.device)
        return 1.0 / answer.clamp(min=1.0e-6) if self._gives_depth else answer


def align_to_range(inverse: torch.Tensor, near: float, far: float) -> torch.Tensor:
    """Return the depth [m] whose inverse is the estimate, scaled and shifted frame by frame to [1 / far, 1 / near].

    A frame without contrast is at ``near`` everywhere: it shows nothing but wall.

    Args:
        inverse: Inverse depth of any scale, larger is nearer, shape (N, H, W).
        near: Depth of the nearest pixel [m].
        far: Depth of the farthest pixel [m].
    """
    low, high = inverse.amin(dim=(1, 2), keepdim=True), inverse.amax(dim=(1, 2), keepdim=True)
    fraction = torch.where(high > low, (inverse - low) / (high - low).clamp(min=1.0e-12), 1.0)
    return 1.0 / (1.0 / far + fraction * (1.0 / near - 1.0 / far))


def align_to_reference(inverse: torch.Tensor, reference: torch.Tensor, farthest: float = 1.0) -> torch.Tensor:
    """Return the depth [m] after the least-squares scale and shift from the estimate to the inverse reference.

    Args:
        inverse: Inverse depth of any scale, shape (N, H, W).
        reference: True depth [m], same shape.
        farthest: Depth that is given where the fit has none [m].
    """
    target = 1.0 / reference.clamp(min=1.0e-4)
    x, y = inverse.flatten(1), target.flatten(1)
    dx, dy = x - x.mean(dim=1, keepdim=True), y - y.mean(dim=1, keepdim=True)
    slope = (dx * dy).sum(dim=1, keepdim=True) / dx.square().sum(dim=1, keepdim=True).clamp(min=1.0e-12)
    fitted = y.mean(dim=1, keepdim=True) + slope * dx
    return (1.0 / fitted.clamp(min=1.0 / farthest)).view_as(inverse)


def _edges(result: dict[str, Any]) -> tuple[int, int]:
    """Height and width of one result."""
    height, width = result["predicted_depth"].shape[-2:]
    return int(height), int(width)
