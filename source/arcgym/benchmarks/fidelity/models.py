# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Simulations of the checks: shipped settings, a tube or the shipped colon, a scope."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from arcgym.anatomy import write_colon
from arcgym.assets import ActuatorBaseCfg, BaseDriveCfg, BendingDriveCfg, ColonCfg, EndoscopeCfg, TipPullCfg
from arcgym.assets.colon import Colon
from arcgym.assets.endoscope import Endoscope
from arcgym.assets.endoscope_spec import EndoscopeSpec, proximal_spec
from arcgym.assets.endoscope_stage import write_endoscope
from arcgym.benchmarks.fidelity.rows import Run
from arcgym.benchmarks.fidelity.tubes import Tube, tube_stage
from arcgym.sim import Simulation, SimulationCfg


def shaft_spec(links: int, **changes: Any) -> EndoscopeSpec:
    """Return the shaft links of the shipped colonoscope, without its base link and its bending section."""
    spec = proximal_spec()
    kept = slice(1, 1 + links)
    most = len(spec.link_length) - spec.bending_links - 1
    if links > most:
        raise ValueError(f"links is {links}, expected at most {most}, the links of the shipped shaft.")
    return replace(
        spec,
        link_length=spec.link_length[kept],
        link_radius=spec.link_radius[kept],
        link_mass=spec.link_mass[kept],
        bending_rigidity=spec.bending_rigidity[kept][: links - 1],
        torsional_rigidity=spec.torsional_rigidity[kept][: links - 1],
        hinge_limit=spec.hinge_limit[kept][: links - 1],
        bending_links=0,
        **changes,
    )


def drives(spec: EndoscopeSpec) -> dict[str, ActuatorBaseCfg]:
    """Return the actuators of a scope to write: base and bending section if its base is driven, else a pull."""
    if spec.slide_drive is None or spec.slide_drive.stiffness == 0.0:
        return {"tip": TipPullCfg()}
    bending = {"bending": BendingDriveCfg()} if spec.bending_links else {}
    return {"base": BaseDriveCfg(), **bending}


def build(
    run: Run,
    scope: EndoscopeSpec | EndoscopeCfg,
    tube: Tube | None = None,
    num_envs: int = 1,
    colon: dict[str, Any] | None = None,
    endoscope: dict[str, Any] | None = None,
    **changes: Any,
) -> Simulation:
    """Build worlds with the shipped settings.

    Args:
        run: Device and folder.
        scope: A scope to write, or the configuration of a shipped one.
        tube: A tube to write; the shipped colon by default.
        num_envs: Worlds.
        colon: Changes of ``ColonCfg``.
        endoscope: Changes of ``EndoscopeCfg``.
        changes: Changes of ``SimulationCfg``.
    """
    colon_cfg = ColonCfg(**colon or {})
    if tube is not None:
        path = run.folder / f"tube_{abs(hash(tube))}" / "colon.usda"
        colon_cfg.usd_path = str(path if path.exists() else write_colon(tube_stage(tube), path))
    if isinstance(scope, EndoscopeSpec):
        path = run.folder / f"scope_{len(list(run.folder.glob('scope_*')))}.usda"  # USD keeps a file it has once read
        scope = EndoscopeCfg(usd_path=str(write_endoscope(scope, path)), actuators=drives(scope))
    scope = replace(scope, **endoscope or {})
    return Simulation(SimulationCfg(device=run.device, **changes), Colon(colon_cfg), Endoscope(scope), num_envs)
