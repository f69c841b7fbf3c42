# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of a colon."""

from __future__ import annotations

from typing import Any, Literal

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets.abdomen_cfg import AbdomenCfg
from arcgym.assets.gas_cfg import GasCfg
from arcgym.assets.mesentery_cfg import MesenteryCfg
from arcgym.assets.wall_law_cfg import WallLawCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.string import did_you_mean
from arcgym.utils.validation import FieldError, Range, require, require_at_least, require_non_negative, require_positive


@configclass
class ColonCfg:
    """A colon and the tissue it is made of."""

    class_type: Any = "arcgym.assets.colon:Colon"
    """Class built from this configuration; change it to add behavior to the asset."""
    usd_path: str | list[str] = "colon_1/colon.usda"
    """Stage of the colon: a path, or one relative to the assets folder (:func:`arcgym.utils.paths.assets_dir`).

    Several patients in one batch: a list of stages, a folder of folders with a ``colon.usda`` each, such as the
    importer's output, or ``population:train``, a split of a population
    (:func:`arcgym.utils.populations.register_population`), ``population:20000`` for one of its patients by seed. All
    need walls of the same grid. World ``w`` begins with patient ``w`` modulo their number."""
    num_patients: int | None = None
    """How many patients to take, from the first; ``None`` takes all. Set it for a split that has more than are wanted:
    a patient takes some MiB on the device."""
    material: str = "paper"
    """Tissue preset: ``paper`` (5 MPa), ``in_situ`` (0.5 MPa, 1.5 mm, a mesentery with slack: the sigmoid colon
    loops), ``clinical`` (the same with 95 kPa, see ``wall_law``) or one of six for sensitivity tables, ``soft_nu045``
    to ``stiff_nu049``, see :mod:`arcgym.assets.materials`."""
    wall_model: Literal["shell", "solid"] = "shell"
    """What the wall is made of: ``shell``, triangles and hinges half way through the wall, or ``solid``, the stage's
    one layer of tetrahedra. Linear tetrahedra lock in bending: pinched, the solid is an order of magnitude too stiff
    (see the row ``wall_ring`` of ``arcgym bench fidelity``); choose it to compare with other tetrahedral
    models."""
    wall_thickness: float | None = None
    """Thickness of a shell [m], over the preset's; ``None`` without a preset's takes the stage's."""
    rigid: bool = False
    """Hold the whole wall still: contact as with a rigid colon, and no cost of the wall. To hold the wall in some
    worlds only, at full cost, use :meth:`arcgym.assets.Colon.write_rigid_to_sim`."""
    youngs_modulus: float | None = None
    """Young's modulus [Pa], over the preset's."""
    poissons_ratio: float | None = None
    """Poisson's ratio, over the preset's."""
    density: float | None = None
    """Mass density [kg/m^3], over the preset's."""
    anchor_stiffness: dict[str, float] = {}
    """Stiffness of the tight attachment per length of colon [N/m^2] for some segments, over the preset's. 0 sets a
    segment free."""
    anchor_slack: dict[str, float] = {}
    """Way that some segments move, half way along, before their attachment gets tight [m], over the preset's. 0 holds
    the segment as a plain spring."""
    anchors: Literal["sparse", "default", "dense"] = "default"
    """Factor on all anchor springs: 0.5, 1 or 1.75. Change it, or randomize it with the event
    :func:`arcgym.envs.mdp.randomize_anchors`, to see how much a policy depends on how firmly the colon is held."""
    gas: GasCfg = GasCfg()
    """Gas in the lumen: pressure, insufflation and collapse; off by default."""
    wall_law: WallLawCfg = WallLawCfg()
    """How a shell stretches: stiffening, thickness by diameter and relaxation; all off by default."""
    abdomen: AbdomenCfg = AbdomenCfg()
    """The abdomen, which stops loops, and a hand that presses on it; off by default."""
    mesentery: MesenteryCfg = MesenteryCfg()
    """Sheets that some segments hang on, in place of their anchors; off by default."""
    mobile_until: float | None = None
    """Arc length [m] beyond which the wall is held still. Saves time where the scope never goes; ``None`` moves
    all, 0 none."""

    def validate_config(self) -> None:
        """Check names and bounds.

        Raises:
            ValueError: If a value is out of its bounds, or a preset or segment is unknown.
        """
        from arcgym.assets.materials import TISSUE_PRESETS

        require(self, "material", TISSUE_PRESETS)
        require_at_least(self, 1, "num_patients")
        require_positive(self, "wall_thickness", unit="m")
        require_non_negative(self, "mobile_until", unit="m")
        require_positive(self, "youngs_modulus", unit="Pa")
        require(self, "poissons_ratio", Range(0.0, 0.5, below=True))
        require_positive(self, "density", unit="kg/m^3")
        require_non_negative(self, "anchor_stiffness", unit="N/m^2")
        require_non_negative(self, "anchor_slack", unit="m")
        if self.wall_model == "solid" and self.wall_thickness is not None:
            text = f"is {self.wall_thickness:g} m, expected none with wall_model='solid': it is as thick as its stage."
            raise FieldError(self, "wall_thickness", text)
        if self.gas.enabled and self.wall_model != "shell":
            raise FieldError(self, "wall_model", "is 'solid', expected 'shell' with gas.enabled=true: switch one off.")
        if self.wall_law.active and self.wall_model != "shell":
            raise FieldError(self, "wall_model", "is 'solid', expected 'shell' with any of wall_law: switch one off.")
        if self.abdomen.enabled and self.wall_model != "shell":
            raise FieldError(
                self, "wall_model", "is 'solid', expected 'shell' with abdomen.enabled=true: switch one off."
            )
        for field in ("anchor_stiffness", "anchor_slack"):
            for segment in getattr(self, field):
                if segment not in SEGMENTS:
                    raise FieldError(self, field, f"names '{segment}'. {did_you_mean(segment, SEGMENTS)}")
