# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Reasons to doubt an import: what it made may be no colon, or not the whole one."""

from __future__ import annotations

from typing import Any

from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.orientation import MIRRORED

LARGEST_CUT = 0.15
"""Largest share of the lumen that may be cut off as not being colon."""

CALIBER_SHARE = 0.70
"""Caliber of a cut branch over the colon's from which it may be a loop of the colon."""

LEAST_LENGTH = 60
"""Length of a cut branch from which it may be a loop of the colon [mm]."""

LEAST_LIKENESS = 0.60
"""Least likeness to a typical course. Five generated and two real colons have 0.77 and more, read from the wrong end
0.48 and less."""

KEEP = "--keep-doubtful makes the folder all the same, for looking at."
"""What to do about an import that was refused for its doubts."""


def path_doubts(report: dict[str, Any]) -> list[str]:
    """Return what speaks against the lumen and the path that were found, each with what to pass.

    Args:
        report: Figures of :class:`arcgym.anatomy.importing.lumen.Lumen`.
    """
    doubts = []
    cleaning, orientation = report["cleaning"], report["orientation"]
    cut = [piece for piece in cleaning["cut"] if "caliber_mm" in piece]
    gone = sum(piece["volume_ml"] for piece in cut) + report["lost_ml"]
    share = gone / max(gone + report["volume_ml"], 1e-9)
    if share > LARGEST_CUT:
        largest = max(cut, key=lambda piece: piece["volume_ml"], default={"place_mm": "an unknown place"})
        doubts.append(
            f"{share:.0%} of the lumen was cut off, the largest piece at {largest['place_mm']} mm: "
            "loops may touch there. Separate them in the mask, or pass --anus and --cecum"
        )
    wide = [
        piece
        for piece in cut
        if piece["length_mm"] >= LEAST_LENGTH and piece["caliber_mm"] >= CALIBER_SHARE * report["caliber_mm"]
    ]
    if wide:
        piece = max(wide, key=lambda piece: piece["length_mm"])
        others = f" ({len(wide) - 1} more are like it)" if len(wide) > 1 else ""
        doubts.append(
            f"the {piece['kind']} that was cut off at {piece['place_mm']} mm is {piece['length_mm']} mm long and "
            f"{piece['caliber_mm']:.0f} mm wide, as wide as the colon ({report['caliber_mm']:.0f} mm){others}. If it "
            "is colon, separate the loops in the mask or pass --anus and --cecum; if not, remove it from the mask"
        )
    for piece in cleaning["dropped"]:
        if piece["volume_ml"] > LARGEST_CUT * report["volume_ml"]:
            doubts.append(
                f"a piece of {piece['volume_ml']:.0f} ml at {piece['place_mm']} mm was left out. If it is colon, pass "
                "a larger --max-gap; if not, remove it from the mask"
            )
    if orientation["likeness"] < LEAST_LIKENESS:
        doubts.append(
            f"the course is little like a colon's (likeness {orientation['likeness']:.2f}, usually {LEAST_LIKENESS:g} "
            "and more). "
            + (f"{MIRRORED}; if not: pass" if orientation["mirrored"] else "Pass")
            + " --anus and --cecum, --frame for a surface, or --label"
        )
    return doubts


def check_doubts(checks: list[dict[str, Any]]) -> list[str]:
    """Return the checks of the stage that are not kept, each with what to pass.

    Args:
        checks: Name, value, bound and ``ok`` of each check.
    """
    mend = "Look at report.png there, mend the mask, or pass --min-lumen or --wall-thickness"
    return [
        f"check not kept: {check['name']} is {check['value']:.4g}, bound {check['bound']:.4g}. {mend}"
        for check in checks
        if not check["ok"]
    ]


def refuse(doubts: list[str]) -> None:
    """Refuse an import where there are doubts.

    Raises:
        ColonImportError: With all of them.
    """
    if doubts:
        raise ColonImportError("Doubtful: " + ". ".join(doubts), KEEP)
