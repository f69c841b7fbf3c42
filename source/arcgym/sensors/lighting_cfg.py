# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""How the tip lights the mucosa and how the camera exposes the picture."""

from __future__ import annotations

from arcgym.utils.configclass import configclass
from arcgym.utils.validation import (
    Range,
    require,
    require_ascending,
    require_fraction,
    require_non_negative,
    require_positive,
)


@configclass
class LightingCfg:
    """Tip lights and the wet mucosa they fall on. Positions of the lights are in the endoscope's stage."""

    beam: float = 0.3
    """How much the lights favor the axis: 0 is a bare (Lambertian) diode, 1 falls with the squared cosine."""

    concentration: float | None = None
    """Fall-off of a measured light with the angle from its axis, in place of :attr:`beam`: exp(-c (1 - cos)). None by
    default; 2.77 was measured on a real colonoscope (EndoMapper's calibration; ``env.clinical=[light]``)."""

    lamp: tuple[float, float, float] | None = None
    """Place of one light as bright as both, in the frame of the camera, which looks along -Z with +Y up [m]. None takes
    the two lights of the endoscope's stage."""

    wrap: tuple[float, float, float] = (0.34, 0.16, 0.12)
    """Light scattered under the surface past the terminator, red, green, blue. Raise for a softer, waxier wall."""

    scatter: float = 0.16
    """Light that the lumen throws back after a second bounce, relative to the direct light. Lifts and reddens what
    the lights do not reach; lower it for a darker lumen."""

    bump: float = 0.30
    """Height of the mucosal relief relative to the detail texture. 0 gives a smooth wall."""

    film: float = 0.45
    """How much of the relief shows through the film of mucus that carries the highlights."""

    gloss: float = 0.7
    """Brightness of the highlights; 1 is a continuous film of water (4 % reflected). 0 gives a dry wall."""

    roughness: float = 0.050
    """Width of the highlights (GGX alpha). Raise for matte, lower for pinpoint reflections."""

    min_distance: float = 0.003
    """Distance to a light under which it grows no brighter [m], about the size of the light guide lens."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_fraction(self, "beam", "wrap", "film")
        require_non_negative(self, "scatter", "bump", "gloss")
        require(self, "roughness", Range(0.0, 1.0, above=True))
        require_positive(self, "min_distance", unit="m")
        require(self, "concentration", Range(0.0, 50.0))
        require(self, "lamp", Range(-0.1, 0.1), unit="m")


@configclass
class ExposureCfg:
    """Automatic exposure and the response curve of the camera."""

    automatic: bool = True
    """Whether each picture is exposed for its own mean brightness. False keeps :attr:`gain`."""

    gain: float = 1.2e-3
    """Gain of the fixed exposure. Only used if not automatic."""

    target: float = 0.24
    """Mean of the exposed radiance that automatic exposure aims at. Raise for brighter pictures."""

    gain_range: tuple[float, float] = (2.0e-5, 6.0e-3)
    """Smallest and largest gain. The upper one keeps an empty lumen dark, the lower one burns out at the wall."""

    lag: float = 0.0
    """Share of the last gain (on a logarithmic scale) kept in each new picture, in [0, 1). 0 exposes every picture on
    its own, so that the picture is a function of the state; 0.6 at 10 Hz is like a real video processor."""

    vignette: float = 0.35
    """Darkening towards the edge of the field: 0 none, 1 with the cosine of the angle to the axis."""

    contrast: float = 0.45
    """Strength of the S-curve that darkens shadows and lifts lights: 0 none, 1 full."""

    gamma: float = 2.0
    """Root by which light becomes brightness. 2.2 with no contrast and no vignette is a calibrated endoscope's."""

    shutter: tuple[float, float] | None = None
    """Shortest and longest time that a picture collects light [s], over which what moves is blurred; None, the default,
    for sharp pictures. The time is the longest at :attr:`longest_gain` and falls with the gain: shorter near a wall."""

    longest_gain: float = 5.0e-4
    """Gain from which on the shutter is open longest. Raise it for shorter times, such as with a brighter lamp."""

    def validate_config(self) -> None:
        """Check bounds.

        Raises:
            ValueError: If a value is out of its bounds.
        """
        require_positive(self, "gain", "target", "gain_range")
        require_ascending(self, "gain_range")
        require(self, "lag", Range(0.0, 1.0, below=True))
        require_fraction(self, "vignette", "contrast")
        require(self, "gamma", Range(1.0, 4.0))
        require_positive(self, "longest_gain")
        if self.shutter is not None:
            require(self, "shutter", Range(0.0, 0.2, above=True), unit="s")
            require_ascending(self, "shutter")
