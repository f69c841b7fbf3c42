# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Changes to images that keep their meaning: random ones, and a smaller size."""

from __future__ import annotations

import torch


def shift_images(images: torch.Tensor, offsets: torch.Tensor) -> torch.Tensor:
    """Move each image by whole pixels; what comes in from outside repeats the border.

    Args:
        images: Shape (N, C, H, W), any dtype. All channels of an image, and so all frames of a stack, move alike.
        offsets: Rows and columns [px] by which the window moves down and right, int64, shape (N, 2).

    Returns:
        Images of the same shape and dtype; pixel (i, j) is the old (i + row, j + column).
    """
    height, width = images.shape[-2:]
    rows = (torch.arange(height, device=images.device) + offsets[:, :1]).clamp(0, height - 1)
    columns = (torch.arange(width, device=images.device) + offsets[:, 1:]).clamp(0, width - 1)
    worlds = torch.arange(images.shape[0], device=images.device)[:, None, None]
    return images[worlds, :, rows[:, :, None], columns[:, None, :]].permute(0, 3, 1, 2)


def random_shift(images: torch.Tensor, pixels: int) -> torch.Tensor:
    """Move each image by up to ``pixels`` in both directions (Kostrikov et al. 2021, arXiv:2004.13649).

    Args:
        images: Shape (N, C, H, W), any dtype.
        pixels: Largest shift [px]; 4 suits 84×84 images.
    """
    offsets = torch.randint(-pixels, pixels + 1, (images.shape[0], 2), device=images.device)
    return shift_images(images, offsets)


def jitter_colors(images: torch.Tensor, strength: float) -> torch.Tensor:
    """Change brightness, contrast and saturation of each image at random.

    In this order each is multiplied by a factor of its own between ``1 - strength`` and ``1 + strength``: the values,
    their distance from the image's mean, and their distance from the pixel's gray.

    Args:
        images: uint8, shape (N, 3 K, H, W): RGB images, K of them stacked, which change alike.
        strength: Largest change, in [0, 1).

    Returns:
        uint8 images of the same shape.
    """
    count, channels, height, width = images.shape
    values = images.view(count, channels // 3, 3, height, width).float()
    low, high = 1.0 - strength, 1.0 + strength
    factors = torch.empty(3, count, 1, 1, 1, 1, device=images.device).uniform_(low, high)
    values = values * factors[0]
    mean = values.mean(dim=(1, 2, 3, 4), keepdim=True)
    values = mean + (values - mean) * factors[1]
    gray = values.mean(dim=2, keepdim=True)
    values = gray + (values - gray) * factors[2]
    return values.round_().clamp_(0.0, 255.0).to(torch.uint8).view_as(images)


def shrink_images(images: torch.Tensor, factor: int) -> torch.Tensor:
    """Return images of which each pixel is the mean of a square block, rounded to bytes.

    Args:
        images: uint8, shape (N, C, H, W).
        factor: Edge of the blocks [px]; divides height and width.
    """
    return torch.nn.functional.avg_pool2d(images.float(), factor).round().to(torch.uint8)
