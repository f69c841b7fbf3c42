# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Procedural mucosa: color with submucosal vessels, and fine relief with wetness; periodic and deterministic."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from arcgym.anatomy.mucosa.spec import MucosaSpec
from arcgym.anatomy.mucosa.vessels import draw_vessels

WIDTH, HEIGHT = 1024, 2048
"""Pixels around the lumen and along 0.24 m of colon; about 0.12 mm each at a lumen of 39 mm."""

SLOPE_RANGE = 1.0
"""Slope that the detail texture's red and green encode at 255; 0 encodes its negative, 127.5 a flat wall."""

HEIGHT_RANGE = 0.5
"""Height [mm] that the detail texture's blue encodes from 0 to 255, centered on 0."""

_DETAIL_BITS = np.array([0xFC, 0xFC, 0xF0, 0xF0], np.uint8)
"""Bits kept of slopes, height and wetness: the rest is noise that would double the size of the file."""

_PIXEL = 0.12
"""Size of a pixel [mm]."""


def write_textures(folder: Path, seed: int, look: MucosaSpec | None = None) -> tuple[Path, Path]:
    """Write ``mucosa_albedo.jpg`` (RGB) and ``mucosa_detail.png`` (RGBA) and return their paths."""
    look = look or MucosaSpec()
    albedo, detail = make_textures(seed, look=look)
    if look.width != WIDTH:
        albedo, detail = (_resize(image, look.width) for image in (albedo, detail))
        detail &= _DETAIL_BITS
    paths = folder / "mucosa_albedo.jpg", folder / "mucosa_detail.png"
    Image.fromarray(albedo).save(paths[0], quality=92, subsampling=0)
    Image.fromarray(detail).save(paths[1], compress_level=4)
    return paths


def _resize(image: np.ndarray, width: int) -> np.ndarray:
    """Average each channel over larger pixels; one by one, or Pillow would weight color by the last as by opacity."""
    channels = [Image.fromarray(image[..., k]) for k in range(image.shape[2])]
    return np.stack([np.array(channel.resize((width, 2 * width), Image.Resampling.BOX)) for channel in channels], -1)


def make_textures(
    seed: int, width: int = WIDTH, height: int = HEIGHT, look: MucosaSpec | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Make the two textures.

    Args:
        seed: Pattern; another seed is another patient.
        width: Pixels around the lumen.
        height: Pixels along the colon.
        look: How it looks; its width is left to :func:`write_textures`.

    Returns:
        Albedo, shape (height, width, 3), and detail, shape (height, width, 4), both uint8.
    """
    rng = np.random.default_rng([seed, 7])
    noise = _Noise(rng, height, width)
    trunks = draw_vessels(rng, height, width)
    fine = draw_vessels(rng, height, width, fine=True)
    look = look or MucosaSpec()
    albedo, detail = _albedo(noise, trunks, fine, look), _detail(noise, trunks)
    if look.stool:
        albedo, detail = _soil(noise, albedo, detail, look.stool)
    if look.fluid:
        albedo, detail = _flood(noise, albedo, detail, look.fluid)
    if look.bubbles:
        albedo, detail = _foam(noise, albedo, detail, look.bubbles)
    return albedo, detail


class _Noise:
    """Periodic band-limited noise."""

    def __init__(self, rng: np.random.Generator, height: int, width: int) -> None:
        self.rng, self.shape = rng, (height, width)
        self.frequency = np.hypot(np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None])
        self.frequency[0, 0] = 1.0

    def __call__(self, shortest: float, longest: float, slope: float = 1.0) -> np.ndarray:
        """Return noise of unit variance with wavelengths from ``shortest`` to ``longest`` pixels."""
        f = self.frequency
        within = (f > 1 / longest) & (f < 1 / shortest)
        gain = np.zeros(f.shape)
        gain[within] = f[within] ** -slope
        phase = np.empty(f.shape, complex)
        phase.real = self.rng.normal(size=f.shape)
        phase.imag = self.rng.normal(size=f.shape)
        phase *= gain
        image = np.fft.irfft2(phase, s=self.shape)
        image /= image.std()
        return image


def _albedo(noise: _Noise, trunks: np.ndarray, fine: np.ndarray, look: MucosaSpec) -> np.ndarray:
    """Salmon mucosa with paler and redder patches; vessels show where the mucosa is thin."""
    base, pale, red = np.array([[0.850, 0.470, 0.390], [0.905, 0.610, 0.500], [0.790, 0.340, 0.300]])
    paleness = np.clip(look.paleness + 0.26 * noise(60, 700, 1.3), 0, 1)
    redness = np.clip(look.redness + 0.20 * noise(30, 320, 1.2), 0, 0.7)
    shade = 1.0 + 0.022 * noise(2, 12, 0.4) + 0.02 * noise(14, 60, 0.8)
    thin = 1.0 / (1.0 + np.exp(-1.5 * noise(160, 900)))
    small, large = fine * (look.vessels * 0.42 * thin), trunks * (look.vessels * 0.62 * (0.35 + 0.65 * thin))
    image = np.empty((*thin.shape, 3), np.uint8)
    for k, (few, much) in enumerate(zip([0.66, 0.20, 0.17], [0.55, 0.15, 0.16], strict=True)):
        color = base[k] + paleness * (pale[k] - base[k])
        color += redness * (red[k] - color)
        color *= shade
        color += small * (few - color)
        color += large * (much - color)
        image[..., k] = _bytes(color)
    return image


def _detail(noise: _Noise, trunks: np.ndarray) -> np.ndarray:
    """Relief of undulations, innominate grooves and vessels, and how wet the film on it is."""
    grooves = np.exp(-((noise(5, 12, 0.6) / 0.28) ** 2))
    height = 0.055 * noise(12, 70, 1.1) + 0.008 * noise(4, 10, 0.6) - 0.010 * grooves + 0.03 * trunks
    along = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / (2 * _PIXEL)
    around = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / (2 * _PIXEL)
    wetness = np.clip(0.55 + 0.35 * noise(40, 300), 0.05, 1.0)
    slopes = [0.5 + 0.5 * slope / SLOPE_RANGE for slope in (around, along)]
    detail = np.stack([_bytes(channel) for channel in (*slopes, 0.5 + height / HEIGHT_RANGE, wetness)], -1)
    return detail & _DETAIL_BITS


def _soil(noise: _Noise, albedo: np.ndarray, detail: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Cover a share of the mucosa with patches of turbid film and lumps of stool."""
    patches = noise(45, 420, 1.2) + 0.25 * noise(10, 40, 0.8)
    cover = np.clip((patches - np.quantile(patches, 1.0 - share)) / 0.5, 0.0, 1.0)[..., None]
    lumps = np.clip(0.5 + 0.5 * noise(5, 22, 0.8), 0.0, 1.0)[..., None]
    color = np.array([0.58, 0.37, 0.15]) * (0.70 + 0.45 * lumps)
    opacity = cover * (0.55 + 0.4 * lumps)
    soiled = albedo / 255 + opacity * (color - albedo / 255)
    relief = detail.astype(float)
    relief[..., 3:] *= 1.0 - 0.6 * cover
    return _bytes(soiled), np.rint(relief).astype(np.uint8) & _DETAIL_BITS


def _cover(patches: np.ndarray, share: float, edge: float) -> np.ndarray:
    """Return a mask that is 1 on a share of the pixels, those of the highest patches, with edges of a width."""
    return np.clip((patches - np.quantile(patches, 1.0 - share)) / edge, 0.0, 1.0)[..., None]


def _flood(noise: _Noise, albedo: np.ndarray, detail: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Cover a share of the mucosa with a smooth, shining, turbid film that lets vessels through where it is thin."""
    patches = noise(160, 900, 1.4)
    cover, deep = _cover(patches, share, 0.10), _cover(patches, share, 1.6)
    color = np.array([0.62, 0.56, 0.24])
    film = albedo / 255 + cover * (0.30 + 0.5 * deep) * (color - albedo / 255)
    relief = detail.astype(float)
    relief[..., :2] += cover * (127.5 - relief[..., :2])
    relief[..., 3:] += cover * (255.0 - relief[..., 3:])
    return _bytes(film), np.rint(relief).astype(np.uint8) & _DETAIL_BITS


def _foam(noise: _Noise, albedo: np.ndarray, detail: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Cover a share of the mucosa with bubbles: pale rims, domes that shine."""
    patches = noise(90, 600, 1.3) + 0.2 * noise(12, 40, 0.8)
    cells = noise(9, 22, 0.2)
    cover, rims = _cover(patches, share, 0.05), np.exp(-((cells / 0.35) ** 2))[..., None]
    foam = albedo / 255 + cover * (0.25 + 0.55 * rims) * (np.array([0.93, 0.88, 0.76]) - albedo / 255)
    domes = 0.10 * np.abs(cells)
    slopes = [(np.roll(domes, -1, axis) - np.roll(domes, 1, axis)) / (2 * _PIXEL) for axis in (1, 0)]
    relief = detail.astype(float)
    shape = 127.5 * (1.0 + np.clip(np.stack(slopes, -1) / SLOPE_RANGE, -1.0, 1.0))
    relief[..., :2] += cover * (shape - relief[..., :2])
    relief[..., 3:] += cover * (255.0 - relief[..., 3:])
    return _bytes(foam), np.rint(relief).astype(np.uint8) & _DETAIL_BITS


def _bytes(image: np.ndarray) -> np.ndarray:
    scaled = 255 * image
    return np.clip(np.rint(scaled, out=scaled), 0, 255, out=scaled).astype(np.uint8)
