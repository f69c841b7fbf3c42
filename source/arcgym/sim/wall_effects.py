# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Effects on the wall that are off by default: gas, weight, a law of its own and what lies around it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import warp as wp

from arcgym.anatomy.shell import ShellMesh
from arcgym.assets.wall_law_cfg import WallLawCfg
from arcgym.sim.contact.loop_friction import LoopFriction
from arcgym.sim.wall.abdomen import Abdomen
from arcgym.sim.wall.lumen_gas import LumenGas
from arcgym.sim.wall.mesentery import Mesentery
from arcgym.sim.wall.ring_modes import RingModes
from arcgym.sim.wall.surroundings import Surroundings
from arcgym.sim.wall.wall_parameters import WallParameters
from arcgym.sim.wall.wall_topology import LumenTopology
from arcgym.sim.wall.wall_weight import WallWeight

if TYPE_CHECKING:
    from arcgym.sim.simulation import Simulation


class WallEffects(NamedTuple):
    """Effects on the wall; None for each that is off."""

    gas: LumenGas | None
    """Gas in the lumen."""
    weight: WallWeight | None
    """Weight of the walls and their contents."""
    law: WallLawCfg | None
    """How the walls stiffen and relax."""
    surroundings: Surroundings | None
    """Abdomen, mesenteries and loops around the colon."""


def wall_effects(
    sim: Simulation, walls: Sequence[WallParameters], modes: Sequence[RingModes], lumen: LumenTopology
) -> WallEffects:
    """Return the effects on the walls.

    Args:
        sim: Simulation with colon, patients and actuation.
        walls: Wall of each patient.
        modes: Its ring modes.
        lumen: Faces of the lumen.

    Raises:
        ValueError: If one is on that ``SimulationCfg.solver`` does not have.
    """
    gas, weight = _gas(sim, walls, modes, lumen), _weight(sim, walls)
    return WallEffects(gas, weight, _law(sim), _surroundings(sim, walls, modes))


def _gas(
    sim: Simulation, walls: Sequence[WallParameters], modes: Sequence[RingModes], lumen: LumenTopology
) -> LumenGas | None:
    gas, wall = sim.colon.cfg.gas, sim.colon.wall
    if not gas.enabled:
        return None
    sim.require_two_level("has no gas in the lumen", "set env.scene.colon.gas.enabled=false")
    if not sim.cfg.wall.coarse_correction:
        raise ValueError("Gas needs the coarse correction: set env.sim.wall.coarse_correction=true.")
    assert isinstance(wall, ShellMesh)  # as ColonCfg checks
    return LumenGas(gas, lumen, walls, modes, wall.triangles, sim.patient, sim.cfg.dt, sim.device)


def _weight(sim: Simulation, walls: Sequence[WallParameters]) -> WallWeight | None:
    if not sim.cfg.weight.enabled:
        return None
    sim.require_two_level("has a wall without weight", "set env.sim.weight.enabled=false")
    arcs = [patient.wall.ring_arc for patient in sim.colon.patients]
    return WallWeight(sim.cfg.weight, walls, arcs, sim.actuation.gravity, sim.device)


def _law(sim: Simulation) -> WallLawCfg | None:
    law = sim.colon.cfg.wall_law
    if not law.active:
        return None
    sim.require_two_level("has the plain law of the wall", "leave env.scene.colon.wall_law as it is by default")
    return law


def _surroundings(sim: Simulation, walls: Sequence[WallParameters], modes: Sequence[RingModes]) -> Surroundings | None:
    cfg, device = sim.colon.cfg, sim.device
    if not (cfg.abdomen.enabled or cfg.mesentery.enabled or sim.cfg.loops.active):
        return None
    members = wp.array(modes[0].members, dtype=int, device=device)
    abdomen = _abdomen(sim, walls, members) if cfg.abdomen.enabled else None
    mesentery = _mesentery(sim, members) if cfg.mesentery.enabled else None
    friction = _friction(sim) if sim.cfg.loops.enabled else None
    bends = _bends(sim)
    return Surroundings(walls[0].ring, members, sim.num_envs, device, abdomen, mesentery, friction, bends)


def _abdomen(sim: Simulation, walls: Sequence[WallParameters], members: wp.array) -> Abdomen:
    sim.require_two_level("has no abdomen around the colon", "set env.scene.colon.abdomen.enabled=false")
    wall = sim.colon.wall
    assert isinstance(wall, ShellMesh)  # as ColonCfg checks
    return Abdomen(sim.colon.cfg.abdomen, walls, wall.triangles, members, sim.patient, sim.device)


def _mesentery(sim: Simulation, members: wp.array) -> Mesentery:
    sim.require_two_level("has no mesenteries", "set env.scene.colon.mesentery.enabled=false")
    meshes = [patient.wall for patient in sim.colon.patients]
    return Mesentery(sim.colon.cfg.mesentery, meshes, members, sim.patient, sim.device)


def _friction(sim: Simulation) -> LoopFriction:
    sim.require_two_level("has loops that pass through each other", "set env.sim.loops.enabled=false")
    return LoopFriction(sim.cfg.loops, sim.colon.num_rings, sim.num_envs, sim.device)


def _bends(sim: Simulation) -> bool:
    if sim.cfg.loops.bends:
        sim.require_two_level("has bends whose walls pass through each other", "set env.sim.loops.bends=false")
    return sim.cfg.loops.bends
