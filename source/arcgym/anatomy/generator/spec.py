# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Specification of a generated colon: the generator's only input."""

from __future__ import annotations

from dataclasses import dataclass, field

from arcgym.anatomy.generator.spec_checks import check_spec
from arcgym.anatomy.grid_shape import GridShape
from arcgym.anatomy.mucosa.spec import MucosaSpec
from arcgym.anatomy.stage.types import TissueMaterial


@dataclass(frozen=True)
class FoldSpec:
    """Semilunar folds of one segment: crescents between two taeniae."""

    spacing: float = 0.026
    """Distance from fold to fold along one of the three rows [m]; 20-60 mm on CT colonography, 25-40 mm on average."""
    depth: float = 0.6
    """Depth as a share of the way from the wall to the chord between two taeniae (1: triangular lumen)."""
    width: float = 0.0024
    """Half thickness of the crest [m]; a fold is two walls thick."""
    stagger: float = 0.6
    """Offset between the three rows as a share of a third of the spacing: 0 closes rings, 1 spreads them evenly."""


@dataclass(frozen=True)
class SegmentSpec:
    """Size and features of one segment."""

    length: float
    """Length along the centerline [m]."""
    start_diameter: float
    """Inner diameter between folds where the segment begins [m]."""
    middle_diameter: float
    """Inner diameter between folds in the middle of the segment [m]."""
    folds: FoldSpec | None = None
    """Semilunar folds; None for the rectum, which has none."""
    diverticula: int = 0
    """Number of diverticula. None occur in the rectum, which has no gaps in its muscle coat."""
    polyps: int = 0
    """Number of polyps of random size and shape; for given ones see :attr:`ColonSpec.polyps`."""
    wide_diverticula: int = 0
    """How many of the diverticula are wide enough to pass for the lumen; the wall that the scope touches has them."""


@dataclass(frozen=True)
class PolypSpec:
    """One polyp to place."""

    segment: str
    """Segment that it grows in."""
    diameter: float
    """Diameter [m]; up to 5 mm is diminutive, 10 mm and more large."""
    paris: str = "Is"
    """Shape by the Paris classification: Ip (stalked), Is (sessile) or IIa (flat elevated)."""


@dataclass(frozen=True)
class CollapseSpec:
    """A stretch that gas does not hold open."""

    segment: str
    """Segment that it lies in."""
    position: float = 0.5
    """Where its middle lies along the segment, from 0 to 1."""
    length: float = 0.08
    """Length [m]."""
    diameter: float = 0.018
    """Inner diameter between folds there [m]; a colonoscope's tip needs 13 mm."""


def default_segments() -> dict[str, SegmentSpec]:
    """Return an average insufflated adult colon of 1.64 m.

    Lengths from CT colonography (Khashab et al., Endoscopy 2009; Hanson et al., AJR 2007; the sum is 1.5-1.9 m),
    distended diameters below the upper bounds of radiology (transverse 6 cm, cecum 9 cm), flexures counted apart:
    the descending, transverse and ascending colon of the literature each hold half of the flexures beside them.
    """
    return {
        "rectum": SegmentSpec(0.150, 0.025, 0.051),
        "sigmoid": SegmentSpec(0.480, 0.034, 0.035, FoldSpec(0.021, 0.65, 0.0026, 0.9)),
        "descending": SegmentSpec(0.220, 0.036, 0.040, FoldSpec(0.026, 0.55, 0.0024, 0.8)),
        "splenic": SegmentSpec(0.110, 0.041, 0.040, FoldSpec(0.026, 0.65, 0.0024, 0.6)),
        "transverse": SegmentSpec(0.370, 0.044, 0.048, FoldSpec(0.030, 0.95, 0.0024, 0.25)),
        "hepatic": SegmentSpec(0.105, 0.046, 0.045, FoldSpec(0.029, 0.80, 0.0024, 0.4)),
        "ascending": SegmentSpec(0.135, 0.051, 0.056, FoldSpec(0.033, 0.95, 0.0026, 0.35)),
        "cecum": SegmentSpec(0.065, 0.062, 0.066, FoldSpec(0.034, 0.65, 0.0030, 0.4)),
    }


@dataclass(frozen=True)
class ColonSpec:
    """One colon to generate; the same spec always gives the same stage."""

    name: str = "colon"
    """Name of the colon and of its folder."""
    patient: str = "generated adult"
    """Patient in words, kept in the stage."""
    seed: int = 0
    """Seed of everything random. Change it for another colon of the same kind."""
    segments: dict[str, SegmentSpec] = field(default_factory=default_segments)
    """Size and features of each segment."""
    posture: str = "supine"
    """``supine`` or ``prone``: the same spec gives the same wall in both, mobile segments lying elsewhere."""
    sigmoid_shape: str = "plain"
    """Course of the sigmoid, a key of :data:`arcgym.anatomy.generator.courses.SIGMOID_SHAPES`."""
    transverse_shape: str = "plain"
    """Course of the transverse colon, a key of :data:`arcgym.anatomy.generator.courses.TRANSVERSE_SHAPES`."""
    inflation: float = 1.0
    """Factor of all diameters: below 1 for colons that hold less gas."""
    collapsed: tuple[CollapseSpec, ...] = ()
    """Stretches that gas does not hold open; about a tenth of the segments on CT colonography."""
    sigmoid_state: str = "relaxed"
    """``relaxed``, ``spastic`` or ``diverticular``, see :mod:`arcgym.anatomy.generator.conditions`."""
    acute_bends: int | None = 10
    """How many places turn by over 90 degrees within 60 mm (:mod:`arcgym.anatomy.bends`), one more or less;
    None leaves what the course gives. CT colonography counts 10.9 +- 2.4 acute flexures (Khashab et al., 2009)."""
    min_bend_radius: float = 0.0145
    """Least radius of the centerline [m], where the lumen is narrow enough. Colons from CT bend at 14-15 mm at least
    and 15-18 at the 5th percentile; a colonoscope's bending section turns on about 25-30 mm."""
    waviness: float = 0.0025
    """Standard deviation of the course's waves between the bends [m]: larger ones turn more in total."""
    transverse_sag: float = 0.10
    """How far the middle of the transverse colon hangs below its ends [m]."""
    left_rise: float = 0.0
    """How much higher than usual the left flexure lies [m]. The descending colon runs straight up the flank: give it
    about the length that the descending colon is longer than 0.215 m, or its borders leave their usual heights."""
    right_rise: float = 0.0
    """How much higher than usual the right flexure lies [m]; likewise for an ascending colon longer than 0.145 m."""
    iliac_fossa: float | None = None
    """Height above the anal verge at which the descending colon ends and the sigmoid begins [m], wherever relaxation
    has moved the course; the lengths of both differ by as much. None leaves the border where the lengths put it."""
    jitter: float = 0.004
    """Standard deviation of the random shift of the course's control points [m]."""
    straight_cecum: bool = True
    """Whether the cecum goes on in the ascending colon's line, turning gently forwards, as most do. If not, its course
    is too short for it: it bends wherever :attr:`jitter` and its neighbors push it, as in the five patients."""
    radius_variation: float = 0.05
    """Relative standard deviation of the lumen radius along the colon."""
    clearance: float = 0.0005
    """Least gap between the walls of two loops [m]; courses keep 7 mm apart, haustra and waves come nearer."""
    polyp_radius: tuple[float, float] = (0.0030, 0.0065)
    """Smallest and largest polyp radius [m] (diminutive to 13 mm)."""
    polyp_list: tuple[PolypSpec, ...] = ()
    """Polyps of given size and shape, besides those that segments ask for."""
    openings: bool = True
    """Whether the cecum has an ileocecal valve and an appendix orifice."""
    mucosa: MucosaSpec = MucosaSpec()
    """Look of the mucosa."""
    wide_neck: tuple[float, float] = (0.0073, 0.0080)
    """Smallest and largest neck radius of diverticula that pass for the lumen [m]: a 13 mm tip fits in."""
    diverticulum_neck: tuple[float, float] = (0.0026, 0.0042)
    """Smallest and largest radius of a diverticulum's neck [m]; sacs are 5-10 mm wide."""
    wall_thickness: float = 0.002
    """Thickness of the simulated wall [m]; a well distended colon wall is thinner than 3 mm on CT."""
    grid: GridShape = GridShape()
    """Rings and sectors of the wall, rows and columns of the surfaces. Change it for studies of the mesh alone: colons
    of different grids cannot be in one batch."""
    min_lumen_radius: float = 0.009
    """Least distance from the centerline to folds [m]; lets a 13 mm scope through everywhere."""
    closed_cecum: bool = True
    """Whether the dome closes the cecum's end all through. If not, a ball stays open round the end of the centerline,
    9 to 24 mm deep, as in the five patients, on whose start states and results it would bear to close it."""
    course: str | None = None
    """A kept course, a key of :data:`arcgym.anatomy.generator.kept_courses.KEPT_COURSES`: those of the five patients,
    which were relaxed by a version that rounded otherwise on every processor. None draws one, as the fields above ask.
    """
    head_room: bool = True
    """Whether a lumen is widened where a scope's stiff head has no room at rest. If not, the scope has to push the wall
    apart, as in the patients of the robustness variants ``collapsed``."""
    material: TissueMaterial = TissueMaterial()
    """Tissue of the wall."""
    visual_refinements: int = 2
    """How often triangles on lesions are split for the fine surface. 2 makes smaller files of many lesions."""
    first_attempt: int = 0
    """Number of the first draw from the seed, as a stage names the one it is of. Change it to skip rejected ones."""
    max_attempts: int = 40
    """How many draws from the seed are tried before the spec is given up; most are rejected by their course in 1 s."""

    def __post_init__(self) -> None:
        """Check every value.

        Raises:
            ValueError: Names the field, its value and what is allowed.
        """
        check_spec(self)
