# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Random changes to images that keep their meaning."""

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
