# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Tissue presets: elasticity of the wall and of what holds it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

import torch

Value = TypeVar("Value", float, torch.Tensor)
"""A number, or one for each world."""

ANCHOR_STIFFNESS = {
    "rectum": 2.0e4,
    "sigmoid": 600.0,
    "descending": 2.0e4,
    "splenic": 4.0e3,
    "transverse": 1.0e3,
    "hepatic": 4.0e3,
    "ascending": 2.0e4,
    "cecum": 4.0e3,
}
"""Stiffness of the attachment per length of colon [N/m^2], spread over each ring's outer vertices: retroperitoneal
segments are held, the sigmoid and the transverse colon hang in their mesentery. Chosen so that a scripted insertion
moves the sigmoid by centimetres and the descending colon by millimetres; no published values are known to us."""


@dataclass(frozen=True)
class TissuePreset:
    """Elasticity of the wall and its attachments; ``None`` keeps the value of the colon's stage."""

    youngs_modulus: float | None = None
    """Young's modulus [Pa]."""
    poissons_ratio: float | None = None
    """Poisson's ratio."""
    density: float | None = None
    """Mass density [kg/m^3]."""
    thickness: float | None = None
    """Thickness of the wall [m], where it is a shell."""
    anchor_stiffness: dict[str, float] = field(default_factory=lambda: dict(ANCHOR_STIFFNESS))
    """Attachment stiffness per length of colon [N/m^2], by segment."""


TISSUE_PRESETS = {
    "paper": TissuePreset(youngs_modulus=5.0e6, poissons_ratio=0.49),
    "in_situ": TissuePreset(youngs_modulus=0.7e6, poissons_ratio=0.45),
}
"""``paper``: 5 MPa and 0.49, the ARCGym paper (human rectum and sigmoid: 5.18 MPa, Christensen et al. 2015).
``in_situ``: 0.7 MPa, between the quasi-static moduli of Massalou et al. (1.76 lengthwise, 0.63 around)."""


def solid_moduli(youngs_modulus: Value, poissons_ratio: Value) -> tuple[Value, Value, Value]:
    """Lamé parameters (mu, lambda) [Pa] of an isotropic solid; the third value is 0."""
    mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    return mu, 2.0 * mu * poissons_ratio / (1.0 - 2.0 * poissons_ratio), 0.0 * mu


def shell_moduli(youngs_modulus: Value, poissons_ratio: Value, thickness: float) -> tuple[Value, Value, Value]:
    """Shear and second Lamé parameter of the membrane in plane stress [N/m] and flexural rigidity [N m].

    mu t = E t / (2 (1 + nu)), lambda t = E t nu / (1 - nu^2), D = E t^3 / (12 (1 - nu^2)) (Timoshenko and
    Woinowsky-Krieger, Theory of Plates and Shells).
    """
    plane = youngs_modulus * thickness / (1.0 - poissons_ratio * poissons_ratio)
    shear = youngs_modulus * thickness / (2.0 * (1.0 + poissons_ratio))
    return shear, poissons_ratio * plane, plane * (thickness * thickness / 12.0)


def tissue_preset(name: str) -> TissuePreset:
    """Preset by name.

    Raises:
        ValueError: If there is none of that name.
    """
    if name not in TISSUE_PRESETS:
        raise ValueError(f"There is no tissue preset {name!r}; choose from {sorted(TISSUE_PRESETS)}.")
    return TISSUE_PRESETS[name]
