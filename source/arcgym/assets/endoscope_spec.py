# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What an endoscope is made of: the numbers from which its USD stage is written."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

RootKind = Literal["free", "slide_roll"]

BASE_LINK = 0.200
"""Least length of the base link [m]: the part of the shaft that never enters the anus needs no hinges."""
SHAFT_LINK = 0.0125
"""Length of a shaft link [m]. Every hinge bends both ways, so that the chain follows bends down to a radius of 13 mm;
the scope's cost grows with the number of links."""
TIP_LINK = 0.010
"""Length of a link of the distal section [m]."""
TIP_LINKS = 10
"""Number of distal links: 10 cm, about the actively bending length of a colonoscope (van der Stap 2016, 8 cm)."""
SCOPE_LENGTH = 1.68
"""Length of a scope with a shaft [m]: the working length of the CF-HQ190L. All but the base can be inserted, 1.48 m;
splenic flexures of real colons lie as far as 1.31 m from the anus. With 121 links and 30 twists the chain has 272
degrees of freedom."""
SHAFT_LIMIT = 1.0
"""Largest angle of a shaft's hinge to either side [rad], in proportion less between shorter links: chords of 12.5 mm
then turn on a radius of 12.5 mm / (2 sin 0.5) = 13 mm."""
TWIST_EVERY = 4
"""Every so many hinges one twists: every 50 mm of shaft. Torsion is smooth along the shaft, so it needs fewer."""
TORSIONAL_RIGIDITY = 0.42
"""GJ of a colonoscope's shaft [N m^2/rad]: CF-140S, 68 to 88 N cm^2/deg at 24 C, less 7 % at 37 C (Flexural and
torsional rigidity of colonoscopes)."""
TWIST_LIMIT = 1.0
"""Largest twist of a hinge to either side [rad]; 1 N m turns a shaft hinge by 0.12."""
REST_TIP_HEIGHT = 0.02
"""Height of the tip above the anal verge in the rest pose [m]: in the straight part of the anal canal."""


@dataclass(frozen=True)
class CameraSpec:
    """A camera fixed in the frame of the last link; it looks along its own -Z with +Y up."""

    position: tuple[float, float, float]
    """Origin of the camera in the frame of the last link [m]."""
    quaternion: tuple[float, float, float, float] = (0.0, 1.0, 0.0, 0.0)
    """Orientation (x, y, z, w). The default looks along the link's +Z, image up along the link's +Y."""
    field_of_view: float = math.radians(150.0)
    """Field of view over the image diagonal [rad]. The CF-HQ190L is labeled 170 degrees; labeled values are
    significantly overstated (PMC5480555)."""
    clipping: tuple[float, float] = (0.0005, 0.6)
    """Nearest and farthest visible distance [m]."""


@dataclass(frozen=True)
class DriveSpec:
    """Spring, damper and force limit of one degree of freedom of the root joint."""

    stiffness: float
    """[N/m] for the slide, [N m/rad] for the roll."""
    damping: float
    """[N s/m] for the slide, [N m s/rad] for the roll."""
    max_force: float = math.inf
    """Largest force [N] or torque [N m] the drive exerts; infinite means no limit."""


@dataclass(frozen=True)
class EndoscopeSpec:
    """Geometry, masses and elasticity of an endoscope with L rigid links, base first.

    Hinge i joins link i - 1 to link i. It bends about the X axis (pitch), then about the Y axis it carries (yaw), and
    stands for half of either link: its stiffness is EI / lever, with the lever the mean length of the two. Behind a
    driven base, which is rigid as the hand that holds it, the first hinge stands for half of its second link alone.
    Every fourth hinge also twists about the link's Z axis, and stands for the shaft since the one that twisted last.
    """

    name: str
    """Name of the asset and of its file."""
    root: RootKind
    """Joint of the first link to the world: ``free`` or ``slide_roll`` (along and about the world's Z axis)."""
    link_length: np.ndarray
    """Length of each link [m], shape (L,). A lone link has this length over all, with its round ends."""
    link_radius: np.ndarray
    """Radius of each link [m], shape (L,)."""
    link_mass: np.ndarray
    """Real mass of each link [kg], shape (L,)."""
    bending_rigidity: np.ndarray
    """Bending rigidity EI of the shaft at each hinge [N m^2], shape (L - 1,)."""
    torsional_rigidity: np.ndarray
    """Torsional rigidity GJ of the shaft at each hinge [N m^2/rad], shape (L - 1,)."""
    hinge_limit: np.ndarray
    """Largest pitch and yaw of each hinge to either side [rad], shape (L - 1, 2)."""
    camera: CameraSpec
    """Camera of the tip."""
    lights: np.ndarray
    """Positions of the two lights in the frame of the last link [m], shape (2, 3)."""
    bending_links: int = 0
    """Number of distal links whose hinges the control wheels bend."""
    damping_time: float = 0.01
    """Damping of a hinge divided by its stiffness [s]: a loss factor of 0.14 at 2.2 Hz, the first mode of 0.3 m of
    shaft held at one end (tan delta of polyurethane: 0.05 to 0.2). We know of no measurement on a colonoscope; a fifth
    of it changes the push through a bend by 2 %."""
    armature_time: float = 3.0e-3
    """Armature inertia of a hinge divided by its damping [s]. Without it the inertia about a hinge is so small that
    MuJoCo's joint limits give way; ours does not need it."""
    stop_ratio: float = 20.0
    """Stiffness of a hinge beyond its limit, in multiples of its own stiffness."""
    stop_damping_time: float = 0.011
    """Damping beyond the limit divided by the stiffness there [s]: critical in MuJoCo with the armature above."""
    slide_drive: DriveSpec | None = None
    """Drive of the root along Z; None for a free root."""
    roll_drive: DriveSpec | None = None
    """Drive of the root about Z; None for a free root."""
    sources: dict[str, str] = field(default_factory=dict)
    """Where the numbers come from; written into the stage."""

    @property
    def total_length(self) -> float:
        """Sum of the link lengths [m]."""
        return float(self.link_length.sum())

    @property
    def lever(self) -> np.ndarray:
        """Length of shaft that each hinge stands for [m], shape (L - 1,)."""
        return hinge_levers(self.link_length, self.root)

    @property
    def hinge_stiffness(self) -> np.ndarray:
        """Stiffness EI / lever of each hinge, the same for pitch and yaw [N m/rad], shape (L - 1,)."""
        return self.bending_rigidity / self.lever

    @property
    def hinge_damping(self) -> np.ndarray:
        """Damping of each hinge [N m s/rad], shape (L - 1,)."""
        return self.damping_time * self.hinge_stiffness

    @property
    def hinge_armature(self) -> np.ndarray:
        """Armature inertia of each hinge [kg m^2], shape (L - 1,)."""
        return self.armature_time * self.hinge_damping

    @property
    def twist_stiffness(self) -> np.ndarray:
        """Stiffness of the twist at each hinge [N m/rad], 0 at those that do not twist, shape (L - 1,)."""
        twists = np.array([hinge_twists(hinge) for hinge in range(1, len(self.link_length))], dtype=bool)
        return shared_stiffness(self.lever / self.torsional_rigidity, twists)

    @property
    def stop_stiffness(self) -> np.ndarray:
        """Stiffness of each hinge beyond its limit [N m/rad], shape (L - 1,)."""
        return self.stop_ratio * self.hinge_stiffness


def hinge_levers(link_length: np.ndarray, root: RootKind) -> np.ndarray:
    """Return the length of shaft that each hinge stands for: half of its two links [m], shape (L - 1,).

    A driven base is rigid: of it, the first hinge stands for nothing.
    """
    lever = 0.5 * (link_length[:-1] + link_length[1:])
    if root == "slide_roll":
        lever[:1] = 0.5 * link_length[1:2]
    return lever


def hinge_twists(hinge: int) -> bool:
    """Whether hinge number `hinge`, counted from 1, also twists: every fourth one does."""
    return hinge % TWIST_EVERY == 0


def shared_stiffness(compliance: np.ndarray, twists: np.ndarray) -> np.ndarray:
    """Stiffness of the hinges that twist: each takes over the hinges since the last one, the last also those behind it.

    Args:
        compliance: Twist of the shaft at each hinge by torque [rad/(N m)], shape (H,).
        twists: Whether the hinge twists, shape (H,).

    Returns:
        Stiffness [N m/rad], 0 where the hinge does not twist, shape (H,).
    """
    stiffness = np.zeros(len(compliance))
    twisting = np.flatnonzero(twists)
    if len(twisting):
        carrier = np.minimum(np.searchsorted(twisting, np.arange(len(compliance))), len(twisting) - 1)
        stiffness[twisting] = 1.0 / np.bincount(carrier, compliance)
    return stiffness


def capsule_half_height(length: float, radius: float, num_links: int) -> float:
    """Half height of a link's collision capsule without its round ends [m].

    The capsules of a chain overlap by their round ends, so that the chain has no gaps when it bends; a lone capsule
    has its round ends within its length.
    """
    return 0.5 * length if num_links > 1 else 0.5 * length - radius


def proximal_spec(scope_length: float = SCOPE_LENGTH, shaft_link: float = SHAFT_LINK) -> EndoscopeSpec:
    """Colonoscope pushed and rolled from outside the anus, with a bending section driven by control wheels.

    Args:
        scope_length: Length of the whole scope [m].
        shaft_link: Length of a link of its shaft [m].
    """
    length = _chain_lengths(scope_length, shaft_link)
    links, bent = len(length), TIP_LINKS
    radius = np.full(links, 0.0064)
    radius[-bent:] = 0.0066
    rigidity = np.full(links - 1, 0.025)
    rigidity[-bent:] = 0.012
    limit = np.full((links - 1, 2), _shaft_limit(shaft_link))
    limit[-bent:] = np.radians([180.0, 160.0]) / bent
    camera, lights = _tip_optics(length[-1], radius[-1], links)
    return EndoscopeSpec(
        name="proximal",
        root="slide_roll",
        link_length=length,
        link_radius=radius,
        link_mass=0.2 * length,
        bending_rigidity=rigidity,
        torsional_rigidity=np.full(links - 1, TORSIONAL_RIGIDITY),
        hinge_limit=limit,
        camera=camera,
        lights=lights,
        bending_links=bent,
        slide_drive=DriveSpec(stiffness=2000.0, damping=40.0, max_force=43.0),
        roll_drive=DriveSpec(stiffness=2.0, damping=0.05, max_force=1.0),
        sources={
            "dimensions": "Olympus CF-HQ190L data sheet: 1680 mm, tube 12.8 mm, tip 13.2 mm, angulation 180 up/down, "
            "160 sides",
            "rigidity": "CF-140S, EI 0.026-0.040 N m^2 at 24 C, less 17 % at 37 C (Flexural and torsional rigidity of "
            "colonoscopes); bending section: softer, assumed",
            "torsion": "CF-140S, GJ 0.39-0.50 N m^2/rad at 24 C, less 7 % at 37 C (same source); the bending section's "
            "is assumed to be the same",
            "forces": "Appleyard et al. 2000: peak push 43 N, more than 10 N during 5 % of the time; torque 1.0 N m",
            "mass": "0.2 kg/m, assumed",
        },
    )


def magnetic_spec(scope_length: float = SCOPE_LENGTH, shaft_link: float = SHAFT_LINK) -> EndoscopeSpec:
    """Magnetic flexible endoscope: a head that a magnet outside the body pulls, on a passive soft tether.

    Args:
        scope_length: Length of head and tether [m].
        shaft_link: Length of a link of the tether [m].
    """
    length = _chain_lengths(scope_length, shaft_link)
    links, head = len(length), 3
    radius = np.full(links, 0.004)
    radius[-head:] = 0.0066
    mass = 0.078 * length
    mass[-head:] = 3000.0 * math.pi * radius[-head:] ** 2 * length[-head:]
    rigidity = np.full(links - 1, 0.001)
    rigidity[-(head - 1) :] = 0.025
    camera, lights = _tip_optics(length[-1], radius[-1], links)
    return EndoscopeSpec(
        name="magnetic",
        root="slide_roll",
        link_length=length,
        link_radius=radius,
        link_mass=mass,
        bending_rigidity=rigidity,
        torsional_rigidity=TORSIONAL_RIGIDITY * rigidity / 0.025,
        hinge_limit=np.full((links - 1, 2), _shaft_limit(shaft_link)),
        camera=camera,
        lights=lights,
        slide_drive=DriveSpec(stiffness=0.0, damping=0.5),
        roll_drive=DriveSpec(stiffness=2.0, damping=0.05),
        sources={
            "design": "magnetic flexible endoscope of Martin et al. 2020 (PMC7571595): tether about 6 mm, head about "
            "20 mm; here the head is slimmed to a colonoscope's 13.2 mm, the tether is 8 mm",
            "rigidity": "0.001 N m^2, assumed: a soft polymer tube; at 0.003 a pull of 4 N sticks in the sigmoid colon",
            "torsion": "GJ / EI as of the colonoscope, assumed",
            "mass": "tether: a colonoscope's 0.2 kg/m scaled by area; head: 3000 kg/m^3 with its magnet; both assumed",
        },
    )


def capsule_spec() -> EndoscopeSpec:
    """Untethered capsule of 10 x 20 mm that a magnet outside the body moves."""
    length, radius = np.array([0.020]), np.array([0.005])
    camera, lights = _tip_optics(length[0], radius[0], 1)
    return EndoscopeSpec(
        name="capsule",
        root="free",
        link_length=length,
        link_radius=radius,
        link_mass=np.array([0.005]),
        bending_rigidity=np.empty(0),
        torsional_rigidity=np.empty(0),
        hinge_limit=np.empty((0, 2)),
        camera=camera,
        lights=lights,
        sources={"dimensions": "10 x 20 mm, 5 g: the capsule of the ARCGym paper (RA-L 2026)"},
    )


def endoscope_specs() -> tuple[EndoscopeSpec, ...]:
    """Return the endoscopes that ARCGym ships."""
    return capsule_spec(), magnetic_spec(), proximal_spec()


def _chain_lengths(scope_length: float, shaft_link: float) -> np.ndarray:
    """Link lengths of a scope with a shaft, base first; the base takes what is left by whole links [m], shape (L,)."""
    distal = TIP_LINKS * TIP_LINK
    shaft_links = math.floor((scope_length - BASE_LINK - distal) / shaft_link + 1.0e-6)
    base = scope_length - distal - shaft_links * shaft_link
    return np.array([base] + [shaft_link] * shaft_links + [TIP_LINK] * TIP_LINKS)


def _shaft_limit(shaft_link: float) -> float:
    """Return the largest angle of a hinge between shaft links of a length [rad]."""
    return SHAFT_LIMIT * min(1.0, shaft_link / SHAFT_LINK)


def _tip_optics(
    length: float, radius: float, links: int, recess: float = 0.001, spread: float = 0.0036
) -> tuple[CameraSpec, np.ndarray]:
    """Camera on the axis, `recess` behind the front of the tip, and two lights on its surface at +-`spread` along X.

    The recess keeps the lens on the lumen's side of a wall that the tip dents.
    """
    dome = capsule_half_height(length, radius, links)
    camera = CameraSpec(position=(0.0, 0.0, dome + radius - recess))
    height = dome + math.sqrt(radius**2 - spread**2)
    return camera, np.array([[spread, 0.0, height], [-spread, 0.0, height]])
