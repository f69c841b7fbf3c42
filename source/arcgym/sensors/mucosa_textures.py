# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Mucosa textures of a stage on the device."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import warp as wp
from PIL import Image

from arcgym.utils import warp_setup  # noqa: F401


class MucosaTextures:
    """Albedo and detail texture with their pyramids of ever smaller copies, tiled in both directions."""

    def __init__(self, color: np.ndarray, detail: np.ndarray, device: str, smooth_levels: bool = False) -> None:
        """Copy both images to the device.

        Args:
            color: Color, square roots of linear light, shape (H, W, 4), uint8.
            detail: Slope along u, slope along v, height, wetness, shape (H, W, 4), uint8.
            device: Warp device.
            smooth_levels: Blend between two levels of the pyramid. Smoother in large pictures, twice the look-ups.
        """
        blend = wp.TextureFilterMode.LINEAR if smooth_levels else wp.TextureFilterMode.CLOSEST
        self.albedo = _make_texture(color, blend, device)
        self.detail = _make_texture(detail, blend, device)
        self.width, self.height = color.shape[1], color.shape[0]


def read_images(albedo: Path, detail: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read the images of :class:`MucosaTextures`.

    Args:
        albedo: Color image in sRGB.
        detail: RGBA image: slope along u, slope along v, height, wetness.

    Raises:
        FileNotFoundError: If one is missing.
    """
    color = _load_rgba(albedo)
    color[..., :3] = _square_root_of_linear(color[..., :3])
    return color, _load_rgba(detail)


def load_textures(files: Sequence[tuple[Path, Path]], device: str) -> list[MucosaTextures]:
    """Load pairs of images, see :func:`read_images`; pairs of the same content share their memory."""
    with ThreadPoolExecutor() as pool:  # pyramids take most of the time, in NumPy, which lets other threads run
        contents = list(pool.map(_content, files))
        distinct = dict(zip(contents, files, strict=True))
        textures = pool.map(lambda pair: MucosaTextures(*read_images(*pair), device), distinct.values())
        loaded = dict(zip(distinct, textures, strict=True))
    return [loaded[content] for content in contents]


def _content(files: tuple[Path, Path]) -> str:
    """Return a hash of both images; of their names where one is missing, for :func:`read_images` to tell."""
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes() if path.is_file() else str(path).encode())
    return digest.hexdigest()


def _load_rgba(path: Path) -> np.ndarray:
    """Read an image, shape (H, W, 4), uint8."""
    if not Path(path).is_file():
        raise FileNotFoundError(f"Texture {path} not found. It belongs beside the colon's stage file.")
    with Image.open(path) as image:
        return np.array(image.convert("RGBA"))


def _square_root_of_linear(srgb: np.ndarray) -> np.ndarray:
    """Bytes of sRGB (IEC 61966-2-1) to bytes of the square root of linear light, which a kernel decodes by squaring."""
    value = np.arange(256) / 255.0
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return np.round(255.0 * np.sqrt(linear)).astype(np.uint8)[srgb]


def _make_texture(image: np.ndarray, blend: wp.TextureFilterMode, device: str) -> wp.Texture2D:
    """Upload an image as a tiled texture with the whole pyramid."""
    return wp.Texture2D(
        np.ascontiguousarray(image),
        filter_mode=wp.TextureFilterMode.LINEAR,
        mip_filter_mode=blend,
        address_mode=wp.TextureAddressMode.WRAP,
        num_mip_levels=0,
        device=device,
    )
