# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""What a file's header says, before its voxels are read: ITK reads a spacing that is no number as 1 mm."""

from __future__ import annotations

import gzip
import re
import struct
from pathlib import Path

import numpy as np

from arcgym.anatomy.importing.errors import ColonImportError

_TEXT = re.compile(
    r"^\s*(ElementSpacing|ElementSize|TransformMatrix|Offset|Origin|Position|Orientation|Rotation)\s*=", re.I
)
_NRRD = re.compile(r"^\s*(spacings|space directions|space origin)\s*:", re.I)
_NO_NUMBER = re.compile(r"[-+]?(nan|inf)", re.I)

_NIFTI = {348: ("f", 76, 252, 256, 280), 540: ("d", 104, 344, 352, 400)}
"""By the size of a NIfTI header: type of its numbers, and where spacing, the codes of both transforms, quaternion and
matrix are (nifti1.h, nifti2.h)."""

_HEADER = 65536
"""Bytes in which a header is looked for."""


def check_header(path: Path, spacing_given: bool) -> None:
    """Check that the spacing and the axes in a volume's header are numbers.

    Args:
        path: Label volume.
        spacing_given: Whether the caller gave the spacing, so that the file's does not matter.

    Raises:
        ColonImportError: One is not finite, or the spacing is not above 0.
    """
    packed = path.name.lower().endswith(".gz")
    try:
        with gzip.open(path, "rb") if packed else path.open("rb") as file:
            head = file.read(_HEADER)
    except (OSError, EOFError):
        return  # a damaged file is named as such when it is read
    if ".nii" in path.name.lower():
        _check_nifti(path, head, spacing_given)
    else:
        _check_text(path, head, spacing_given)


def _check_text(path: Path, head: bytes, spacing_given: bool) -> None:
    for line in head.decode("latin-1").splitlines()[:200]:
        if line.startswith("ElementDataFile") or not line.strip():
            return
        if not (_TEXT.match(line) or _NRRD.match(line)) or (spacing_given and re.match(r"\s*(Element|spacings)", line)):
            continue
        if _NO_NUMBER.search(re.split("[=:]", line, maxsplit=1)[1]):
            raise ColonImportError(f"The header of {path} says '{line.strip()}'", _mend(spacing_given))


def _check_nifti(path: Path, head: bytes, spacing_given: bool) -> None:
    order = next((o for o in "<>" if len(head) > 4 and struct.unpack(o + "i", head[:4])[0] in _NIFTI), None)
    if order is None:
        return
    kind, pixdim, codes, quaternion, matrix = _NIFTI[struct.unpack(order + "i", head[:4])[0]]
    if len(head) < matrix + 12 * struct.calcsize(kind):
        return
    spacing = np.array(struct.unpack_from(f"{order}4{kind}", head, pixdim)[1:])
    if not spacing_given and not (np.isfinite(spacing).all() and (spacing > 0).all()):
        raise ColonImportError(f"The header of {path} has a spacing of {_listed(spacing)} mm", _mend(spacing_given))
    by_quaternion, by_matrix = struct.unpack_from(f"{order}2{'h' if kind == 'f' else 'i'}", head, codes)
    for name, used, where, count in (("matrix", by_matrix, matrix, 12), ("quaternion", by_quaternion, quaternion, 6)):
        values = np.array(struct.unpack_from(f"{order}{count}{kind}", head, where))
        if used > 0 and not np.isfinite(values).all():
            found = f"The header of {path} has axes that are no numbers ({name}: {_listed(values)})"
            raise ColonImportError(found, "Repair the header, or save the mask anew with right axes.")


def _listed(values: np.ndarray) -> str:
    return " x ".join(f"{value:g}" for value in values)


def _mend(spacing_given: bool) -> str:
    return "Repair the header." if spacing_given else "Pass --spacing X Y Z in millimeters, or repair the header."
