# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings of the simulation: clocks, solvers, contact."""

from __future__ import annotations

import re
from typing import Literal

from arcgym.sim.loop_friction_cfg import LoopFrictionCfg
from arcgym.sim.weight_cfg import WeightCfg
from arcgym.utils.configclass import configclass
from arcgym.utils.validation import (
    FINITE,
    FieldError,
    Range,
    require,
    require_at_least,
    require_non_negative,
    require_positive,
)


@configclass
class ContactCfg:
    """Contact between the links and the inner wall."""

    stiffness: float = 2000.0
    """Largest stiffness of a contact inside a wall face [N/m]: at 1 N it gives by 0.5 mm. Where a link lies along
    several faces, each has its own. A softer contact lets links tunnel at lower forces; a stiffer one needs a shorter
    ``SimulationCfg.dt``."""
    tissue_share: float = 2.0 / 3.0
    """Stiffness of a contact with soft tissue over E t / (1 - nu^2), up to ``stiffness``: the wall is a shell, which
    has no squeeze of its own through its thickness, and the contact gives in its place. Hertz's secant F / depth = 4/3
    E a / (1 - nu^2) of a sphere (Johnson, Contact Mechanics, section 4.2), its contact radius a as large as the
    thickness t (the tip's under 0.5 N ``in_situ`` is 1.6 mm), shared by two faces. 658 N/m ``in_situ``; ``paper`` has
    the full ``stiffness``. Friction's stiffness is smaller in the same proportion. 0 gives every wall the full one, as
    do walls of ``wall_model="solid"``, which are squeezed themselves."""
    hardening: float = 0.002
    """Depth at which a contact pushes twice as hard as its stiffness says [m]; at three times that depth it pushes
    28 times as hard. So 100 N do not push a link through the wall, while light contacts stay soft. Beyond 1.5 times
    that depth it hardens faster: no wall is squeezed by more than its thickness."""
    damping: float = 0.0
    """Normal damping while approaching [N s/m]. Raise it if a light capsule rattles on the wall."""
    deep_damping: float = 300.0
    """Added to ``damping`` in contacts deeper than ``hardening``, in full at twice that depth [N s/m]: a tip that is
    pushed hard into soft tissue does not flutter through it, and light contacts stay as they are. Of 0, 80, 300 and
    1000 in a soak, 300 is the least with which no link went outside the lumen (docs/clinical.md, a flutter). Lower it
    only to compare."""
    step_damping: float = 1.0
    """Share kept of what the implicit step adds to the normal damping of a link's contact that is faster than 20 mm/s:
    ``dt`` times its stiffness, 4 N s/m. With 0.5 slips come and go more as with smaller steps (docs/physics.md, known
    limits); with less a limp shaft does not stay finite. Keep 1 to compare with published forces."""
    friction: float = 0.1
    """Coulomb coefficient. Lubricated human mucosa has a dynamic minimum near 0.09; randomize it per world with
    the event :func:`arcgym.envs.mdp.randomize_friction`."""
    friction_stiffness: float = 1000.0
    """Stiffness along the wall of a contact that friction holds [N/m]: a contact of 1 N slides after
    ``friction * 1 N / friction_stiffness``, 0.1 mm. Softer, and a shaft that stops springs back visibly; stiffer, and
    it needs a shorter ``SimulationCfg.dt``."""
    static_friction: float = 1.0
    """Static over dynamic friction. 1 for Coulomb's law with one coefficient; above it, contacts that have stopped hold
    by so much more, and stick and slip."""
    slip_velocity: float = 0.001
    """Speed at which friction has fallen from static to dynamic but for 1/e [m/s]; without effect while
    ``static_friction`` is 1."""
    wall_radius: float = 0.0005
    """Thickness that the wall's surface adds to every link [m]."""
    surface: Literal["wall", "rows", "fine"] = "wall"
    """What the links touch: ``wall``, the faces of the simulated wall, a centimeter wide, or ``fine``, the stage's
    contact surface, which has the folds that they leave out and is carried by the wall (docs/physics.md), or ``rows``,
    the rows of that surface with the wall's columns alone: folds go round the lumen. Choose them where folds and tight
    bends matter; they take three times the room for contacts, and stages made before them have none."""
    search_gap: float = 0.002
    """Distance beyond touching within which contacts are kept for the coming step [m]. It must exceed the way
    that link and wall close in one physics step."""
    search_reach: int = 12
    """Rings on either side of a link's own, 13 cm at rest in a colon of the usual length, whose faces hold it off from
    outside, too: a link that was pushed into the wall there is pushed back, and so is the wall of a hairpin's other
    limb where it has come through the link's own. Faces farther along the colon touch a link from the lumen alone, so
    that a loop beside the tube is not taken for its wall. Raise it where rings lie much nearer together than 1 cm.
    With 3, the other limb of a hairpin came through to a link's axis."""
    capacity: int = 40
    """Contacts kept a link, on average over the links of a world, which share them. A link that a gathered wall lies
    around has more than 50, a link outside the anus none; 126 links in all of ``ct_2`` gathered on the shaft had 4067
    altogether, 32 a link, with a ``search_gap`` of 2 mm and 2956 with 1 mm. Contacts that find no room are counted
    (``Simulation.dropped_contacts``), and the environment warns of them when it closes: raise it then. A scope that
    loses them is flung through the wall."""
    patch_capacity: int = 32
    """Patches of six faces looked at near a link, on average over the links of a world, which share them. 126
    links in all of ``ct_2`` gathered on the shaft had 2848 altogether, 23 a link. Raise it with ``capacity``, and where
    a wall has far smaller faces."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_positive(self, "stiffness", "friction_stiffness", unit="N/m")
        require_at_least(self, 1, "static_friction")
        require_positive(self, "hardening", "search_gap", unit="m")
        require_positive(self, "slip_velocity", unit="m/s")
        require_non_negative(self, "damping", "deep_damping", unit="N s/m")
        require(self, "step_damping", Range(0.5, 1.0))
        require_non_negative(self, "friction", "tissue_share")
        require_non_negative(self, "wall_radius", unit="m")
        require_at_least(self, 1, "search_reach", "capacity", "patch_capacity")
        require(self, "surface", ("wall", "rows", "fine"))


@configclass
class WallSolverCfg:
    """Solver of the deformable wall."""

    iterations: int = 1
    """Vertex block descent sweeps a physics step. With the coarse correction one sweep suffices; without, the wall
    needs 20 and still moves too little."""
    coarse_correction: bool = True
    """Solve the rings' affine motion once before the sweeps. Switch it off only to compare."""
    repeats: int = 1
    """Times (coarse correction + sweeps) is repeated. 10 gives a reference for the inner solve."""
    drag: float = 20.0
    """Velocity decay of the wall [1/s], standing for the surrounding fat and fluid."""
    largest_move: float = 0.0005
    """Largest displacement that one coarse correction, and one step of a vertex in a sweep, may make [m]. Both
    overshoot where a soft wall is crumpled: with 10 mm the ``in_situ`` wall blew up. 0.5 mm a step of 1/240 s is still
    120 mm/s, on top of the wall's velocity."""
    largest_speed: float = 0.5
    """Speed up to which inertia carries a vertex on from step to step [m/s]: in 1/240 s by 2 mm, as far as
    ``ContactCfg.search_gap`` looks. 20 N put at once on a link threw the ``in_situ`` wall at 3 m/s; it outran the
    contact, and the link then ran into it. Raise it together with that gap, or with a smaller ``SimulationCfg.dt``,
    where a wall is to swing freely at more."""
    self_contact: bool = True
    """Whether loops of the colon push each other away where they touch. Nothing changes where they do not. Switch it
    off to compare; ``solver="newton"`` does without."""
    self_contact_stiffness: float = 2000.0
    """Penalty stiffness between two rings that touch [N/m]: at 1 N they overlap by 0.5 mm. Beyond 5 mm, 10 N, the push
    no longer grows: loops that are pressed together harder pass through each other."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_at_least(self, 1, "iterations", "repeats")
        require_non_negative(self, "drag", unit="1/s")
        require_positive(self, "largest_move", unit="m")
        require_positive(self, "largest_speed", unit="m/s")
        require_positive(self, "self_contact_stiffness", unit="N/m")


@configclass
class SimulationCfg:
    """Physics of the scope in the colon."""

    dt: float = 1.0 / 240.0
    """Physics step: one wall solve [s]. While the scope moves through its substeps the wall stands still. Smaller
    steps cost in proportion and change pushes by a few percent; with 1/120 s a push through the sigmoid goes another
    way (docs/physics.md). With it change ``ContactCfg.friction_stiffness``, ``ContactCfg.search_gap`` and the task's
    ``decimation``."""
    device: str = "cpu"
    """Device of physics, camera and tensors: ``cpu`` or ``cuda:0``."""
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Acceleration on the scope [m/s^2]. Zero by default: the colon's own weight is part of its rest shape, and
    the scope's is carried by the wall and small against contact forces. ``weight`` weighs both instead."""
    solver: Literal["two_level", "newton"] = "two_level"
    """Wall solver and coupling: ``two_level`` (ring correction + vertex block descent, own coupling loop) or ``newton``
    (plain Newton ``SolverVBD`` under ``SolverCoupledProxy``), a slow reference without the refinements."""
    scope_substeps: int = 4
    """Scope substeps a physics step, at least 1. The scope is solved implicitly and is stable with any number;
    more of them follow fast contacts more closely. On a CPU they cost little beside the wall, on an H200 each takes
    9.2 ms of the 125 of a control step of 1024 worlds (docs/gpu.md). ``solver="newton"`` takes at least 2, steps the
    wall in each as well, and takes as much longer."""
    scope_iterations: int = 10
    """Constraint iterations of MuJoCo a substep, with ``solver="newton"``."""
    mass_scaling: float = 1.0
    """Factor on the scope's real link masses. Inertia hardly matters at 50 mm/s; heavier links damp contact noise."""
    weight: WeightCfg = WeightCfg()
    """Weight of scope, wall and contents along the patient's posture; off by default."""
    loops: LoopFrictionCfg = LoopFrictionCfg()
    """Friction where loops of the colon touch, and bends that do not fold through themselves; off by default."""
    contact: ContactCfg = ContactCfg()
    """Contact law and search."""
    wall: WallSolverCfg = WallSolverCfg()
    """Wall solver."""
    newton_iterations: int = 5
    """Sweeps of plain ``SolverVBD`` a scope substep, with ``solver="newton"``. Use it with ``dt=1/960``."""
    use_graph: bool = True
    """Capture the physics step in a graph and replay it: 2.3 times faster with one world on a CPU core. Switch it off
    to step through kernels in a debugger."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require(self, "dt", Range(0.0, 1.0 / 60.0, above=True), unit="s")
        require(self, "gravity", FINITE, unit="m/s^2")
        require_at_least(self, 1, "scope_substeps", "scope_iterations", "newton_iterations")
        require_positive(self, "mass_scaling")
        if self.weight.enabled and any(self.gravity):
            raise FieldError(
                self, "gravity", f"is {self.gravity}, expected zeros with weight.enabled=true, whose posture says it."
            )
        if self.loops.active and not self.wall.self_contact:
            name = "enabled" if self.loops.enabled else "bends"
            without = {
                "enabled": "loops that pass through each other do not rub",
                "bends": "without it nothing touches",
            }
            raise FieldError(
                self, f"loops.{name}", f"is true, which needs sim.wall.self_contact=true: {without[name]}."
            )
        if not re.fullmatch(r"cpu|cuda(:\d+)?", self.device):
            raise FieldError(self, "device", f"is {self.device!r}, expected 'cpu', 'cuda' or 'cuda:<number>'.")
