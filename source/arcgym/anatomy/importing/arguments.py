# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Settings of an import from the text of a command line."""

from __future__ import annotations

from arcgym.anatomy.importing.errors import ImportArgumentError

Point = tuple[float, float, float]
"""A position [mm]."""


def parse_point(text: str, option: str) -> Point:
    """Return the position [mm] that ``X,Y,Z`` states.

    Args:
        text: Three numbers with commas between.
        option: Option that it was given for, named in the error.

    Raises:
        ImportArgumentError: There are not three numbers.
    """
    try:
        x, y, z = (float(value) for value in text.split(","))
    except ValueError as error:
        raise ImportArgumentError(f"{option} is '{text}'", "Pass X,Y,Z in millimeters, such as 12,-40,95.") from error
    return x, y, z


def parse_landmark(text: str) -> tuple[str, float | Point]:
    """Return name and place of ``NAME=MM``, an arc length [m], or of ``NAME=X,Y,Z``, a position [mm].

    Raises:
        ImportArgumentError: The text has another form.
    """
    name, _, value = text.partition("=")
    if "," in value:
        return name, parse_point(value, f"--landmark {name}")
    try:
        return name, 1e-3 * float(value)
    except ValueError as error:
        expected = "Pass NAME=MM or NAME=X,Y,Z in millimeters, such as rectosigmoid=150."
        raise ImportArgumentError(f"--landmark is '{text}'", expected) from error
