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
moves the sigmoid by centimeters and the descending colon by millimeters; no published values are known to us."""

MESOCOLON_HEIGHT = {"sigmoid": 0.063, "transverse": 0.074}
"""Height of the mesentery [m]: 6.3 +- 2.6 cm and 7.4 +- 3.6 cm in 35 cadavers (Annals of the Royal College of Surgeons
of England, 2015). A colon that swings about its mesentery's root can move by twice the height to a side and not at
all straight away from it; the height itself stands for all directions as the slack half way along the segment."""

MESENTERY_STRETCHING = 500.0
"""Young's modulus times thickness of a mesentery [N/m]: 0.5 MPa (porcine mesocolon, fascia and peritoneum: 0.09 to 6.9
MPa, White et al., Mechanical characterisation of porcine non-intestinal colorectal tissues) of 1 mm, our choice."""

MESENTERY_ANCHORS = {name: MESENTERY_STRETCHING / height for name, height in MESOCOLON_HEIGHT.items()}
"""Stiffness of a tight mesentery per length of colon, E t / h [N/m^2]: 7.9e3 and 6.8e3."""

HANGING_STIFFNESS = 30.0
"""What draws a colon back within the slack, per length [N/m^2]: a pendulum of the wall's weight, 2 pi 20 mm * 1.5 mm *
1000 kg/m^3 * g = 1.85 N/m, on 63 mm of mesentery."""

ANCHOR_SCALES = {"sparse": 0.5, "default": 1.0, "dense": 1.75}
"""Factor on every anchor spring. The ARCGym paper fixes about 50 % (sparse) and 175 % (dense) of its default number of
vertices; here as much of the stiffness is smeared over the length."""


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
    """Stiffness of the tight attachment per length of colon [N/m^2], by segment."""
    anchor_slack: dict[str, float] = field(default_factory=dict)
    """Way that the colon moves before its attachment gets tight [m], half way along the segment; 0 if not named."""
    anchor_loose: float = HANGING_STIFFNESS
    """Stiffness within the slack, per length of colon [N/m^2]."""


SENSITIVITY_MODULI = {"soft": 0.5e6, "medium": 5.0e6, "stiff": 10.0e6}
"""Young's moduli of the ARCGym paper's material sensitivity [Pa]."""
SENSITIVITY_RATIOS = {"nu045": 0.45, "nu049": 0.49}
"""Poisson's ratios of the ARCGym paper's material sensitivity."""

TISSUE_PRESETS = {
    "paper": TissuePreset(youngs_modulus=5.0e6, poissons_ratio=0.49),
    "in_situ": TissuePreset(
        youngs_modulus=0.5e6,
        poissons_ratio=0.49,
        thickness=1.5e-3,
        anchor_stiffness={**ANCHOR_STIFFNESS, **MESENTERY_ANCHORS},
        anchor_slack=dict(MESOCOLON_HEIGHT),
    ),
    "clinical": TissuePreset(
        youngs_modulus=95.0e3,
        poissons_ratio=0.49,
        thickness=1.5e-3,
        anchor_stiffness={**ANCHOR_STIFFNESS, **MESENTERY_ANCHORS},
        anchor_slack=dict(MESOCOLON_HEIGHT),
    ),
    **{
        f"{hardness}_{name}": TissuePreset(youngs_modulus=modulus, poissons_ratio=ratio)
        for hardness, modulus in SENSITIVITY_MODULI.items()
        for name, ratio in SENSITIVITY_RATIOS.items()
    },
}
"""``paper``: 5 MPa and 0.49, the ARCGym paper (human rectum and sigmoid: 5.18 MPa, Christensen et al. 2015).

``in_situ``: a distended wall of 1.5 mm (under 3 mm in CT), 0.5 MPa, just below the quasi-static moduli of Massalou et
al. (1.76 MPa lengthwise, 0.63 around) since a scope's small strains lie at the foot of their curves, and a mesentery
with slack, so that the sigmoid colon can loop.

``clinical``: as ``in_situ``, with the modulus of a wall that gas has stretched already and stretches further, 95 kPa,
inferred from diameters in CT colonography and ex vivo; it goes with ``WallLawCfg.stiffening`` 1.5 (docs/clinical.md).

``soft_nu045`` ... ``stiff_nu049``: the six settings of the ARCGym paper's material sensitivity, {0.5, 5, 10} MPa x
{0.45, 0.49}, with the anchors of ``paper``."""


def solid_moduli(youngs_modulus: Value, poissons_ratio: Value) -> tuple[Value, Value, Value]:
    """Lamé parameters (mu, lambda) [Pa] of an isotropic solid; the third value is 0."""
    mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    return mu, 2.0 * mu * poissons_ratio / (1.0 - 2.0 * poissons_ratio), 0.0 * mu


def shell_moduli(youngs_modulus: Value, poissons_ratio: Value, thickness: float) -> tuple[Value, Value, Value]:
    """Shear and second Lamé parameter of the membrane in plane stress [N/m] and flexural rigidity [N m].

    mu t = E t / (2 (1 + nu)), lambda t = E t nu / (1 - nu^2), D = E t^3 / (12 (1 - nu^2)) (Timoshenko and
    Woinowsky-Krieger, Theory of Plates and Shells).
    """
    stiffness = youngs_modulus * thickness
    plane = stiffness / (1.0 - poissons_ratio * poissons_ratio)
    shear = stiffness / (2.0 * (1.0 + poissons_ratio))
    return shear, poissons_ratio * plane, plane * (thickness * thickness / 12.0)


def tissue_preset(name: str) -> TissuePreset:
    """Preset by name.

    Raises:
        ValueError: If there is none of that name.
    """
    if name not in TISSUE_PRESETS:
        raise ValueError(f"There is no tissue preset {name!r}; choose from {sorted(TISSUE_PRESETS)}.")
    return TISSUE_PRESETS[name]


def anchor_scale(name: str) -> float:
    """Factor on the anchor springs by name.

    Raises:
        ValueError: If there is none of that name.
    """
    if name not in ANCHOR_SCALES:
        raise ValueError(f"There are no {name!r} anchors; choose from {list(ANCHOR_SCALES)}.")
    return ANCHOR_SCALES[name]
