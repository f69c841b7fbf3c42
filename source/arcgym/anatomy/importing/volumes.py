# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Read label volumes with SimpleITK and resample the lumen onto a grid along the patient's axes."""

from __future__ import annotations

import gzip
import itertools
import shutil
import tempfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.anatomy.importing.errors import ColonImportError
from arcgym.anatomy.importing.headers import check_header
from arcgym.anatomy.importing.size_limits import check_file_voxels, check_filling, check_voxels
from arcgym.anatomy.voxel_grid import Grid

_PLAUSIBLE_SPACING = (0.2, 6.0)
"""Least and largest voxel spacing of a CT [mm]."""

_MARGIN = 0.006
"""Room that is left round the lumen [m]."""

_MOST_LABELS = 150
"""Number of different values above which a volume is taken for gray values."""

_SAMPLE = 997
"""Every how many voxels these are looked for; a prime."""


def read_volume(
    path: Path, label: int | tuple[int, ...] | None, spacing: tuple[float, ...] | None, voxel: float
) -> Grid:
    """Read a label volume.

    Args:
        path: File with one of :data:`arcgym.anatomy.importing.formats.VOLUME_SUFFIXES`.
        label: Value or values of the colon; None takes everything above 0, if there is one such value only.
        spacing: Voxel spacing [mm] along the file's axes in place of the file's own.
        voxel: Edge of the voxels of the result [m].

    Raises:
        ColonImportError: The file is damaged, empty, has several labels, or impossible spacing.
    """
    check_header(path, spacing is not None)
    image = _read_image(path)
    if image.GetDimension() != 3:
        raise ColonImportError(f"{path} has {image.GetDimension()} dimensions", "Pass a 3-D label volume.")
    if image.GetNumberOfComponentsPerPixel() != 1:
        found = f"{path} has {image.GetNumberOfComponentsPerPixel()} values a voxel"
        raise ColonImportError(found, "Pass a label volume with one value a voxel.")
    if spacing is not None:
        image.SetSpacing([float(value) for value in spacing])
    low, high = _PLAUSIBLE_SPACING
    if not all(low <= value <= high for value in image.GetSpacing()):
        found = " x ".join(f"{value:.4g}" for value in image.GetSpacing())
        raise ColonImportError(
            f"{path} has voxels of {found} mm; a CT has {low} to {high} mm", "Pass --spacing X Y Z in millimeters."
        )
    return _resample(_binarise(image, path, label), voxel)


def _read_image(path: Path) -> Any:
    import SimpleITK as sitk

    name = path.name.lower()
    if name.endswith(".nii.gz"):
        _check_packing(path)
    if not name.endswith(".mha.gz"):
        try:
            _check_memory(path)
            image = sitk.ReadImage(str(path))
            if name.endswith(".nii"):
                _check_size(path, image)
            return image
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1]
            raise ColonImportError(f"{path} cannot be read: {reason}", "Check that the file is complete.") from error
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "volume.mha"
        _check_packing(path)
        with gzip.open(path, "rb") as packed, plain.open("wb") as out:
            shutil.copyfileobj(packed, out)
        return _read_image(plain)


def _check_memory(path: Path) -> None:
    """Look at what the header says before voxels are read: ITK takes all the memory that it asks for."""
    import SimpleITK as sitk

    reader = sitk.ImageFileReader()
    reader.SetFileName(str(path))
    reader.ReadImageInformation()
    check_file_voxels(path, reader.GetSize())


def _check_size(path: Path, image: Any) -> None:
    expected = image.GetNumberOfPixels() * image.GetSizeOfPixelComponent() * image.GetNumberOfComponentsPerPixel()
    found = path.stat().st_size
    if found < expected:
        raise ColonImportError(
            f"{path} cannot be read: it has {found} bytes, its header says more than {expected}",
            "Check that the file is complete.",
        )


def _check_packing(path: Path) -> None:
    """Unpack a file to its end: ITK fills what is missing with zeros and says nothing."""
    try:
        with gzip.open(path, "rb") as packed:
            while packed.read(1 << 24):
                pass
    except (EOFError, OSError, zlib.error) as error:
        raise ColonImportError(f"{path} cannot be unpacked: {error}", "Check that the file is complete.") from error


def _binarise(image: Any, path: Path, label: int | tuple[int, ...] | None) -> Any:
    """Return the lumen as a float image of 0 and 1, cut to its bounding box, in the same physical place."""
    import SimpleITK as sitk

    values = sitk.GetArrayViewFromImage(image)
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise ColonImportError(f"{path} holds NaN or infinite values", "Pass a label volume (integers, 0 outside).")
    lumen = _chosen(values, path, label)
    ranges = [np.flatnonzero(lumen.any(axis=tuple(k for k in range(3) if k != axis))) for axis in (2, 1, 0)]
    start = [max(0, int(r[0]) - 1) for r in ranges]
    stop = [min(size, int(r[-1]) + 2) for r, size in zip(ranges, image.GetSize(), strict=True)]
    part = lumen[start[2] : stop[2], start[1] : stop[1], start[0] : stop[0]].astype(np.float32)
    check_filling(part)
    cut = sitk.GetImageFromArray(part)
    cut.SetSpacing(image.GetSpacing())
    cut.SetDirection(image.GetDirection())
    cut.SetOrigin(image.TransformIndexToPhysicalPoint(start))
    return cut


def _chosen(values: np.ndarray, path: Path, label: int | tuple[int, ...] | None) -> np.ndarray:
    """Return which voxels are the colon's; refuses gray values, several labels and none."""
    sample = np.unique(values.ravel()[::_SAMPLE])
    if len(sample) > _MOST_LABELS:
        raise ColonImportError(
            f"{path} holds more than {_MOST_LABELS} different values from {sample[0]:g} to {sample[-1]:g}: gray values "
            "of a CT, not labels",
            "Pass a segmentation of the colon's lumen: a label volume with 0 outside.",
        )
    found = np.unique(values[values != 0])
    if label is None and len(found) > 1:
        some = ", ".join(f"{value:g}" for value in found[:12])
        raise ColonImportError(
            f"{path} holds {len(found)} labels ({some})",
            "Pass --label with the colon's value, or several (air, fluid).",
        )
    lumen = values != 0 if label is None else np.isin(values, label)
    if not lumen.any():
        what = "no voxel above 0" if label is None else f"no voxel of label {label}, only {found[:12].tolist()}"
        raise ColonImportError(f"{path} is empty: {what}", "Pass a colon segmentation, and --label if it has several.")
    return lumen


def _resample(image: Any, voxel: float) -> Grid:
    """Resample onto axes right, anterior, cranial; ITK's are left, posterior, cranial and in millimeters."""
    import SimpleITK as sitk

    ends = [(0, size - 1) for size in image.GetSize()]
    corners = np.array([image.TransformIndexToPhysicalPoint(c) for c in itertools.product(*ends)])
    step, margin = 1e3 * voxel, 1e3 * _MARGIN
    low = corners.min(0) - margin
    size = np.ceil((corners.max(0) + margin - low) / step).astype(int) + 1
    check_voxels(1e-3 * (corners.max(0) + margin - low), voxel)
    identity = sitk.Transform()
    resampled = sitk.Resample(
        image, size.tolist(), identity, sitk.sitkLinear, low.tolist(), [step] * 3, np.eye(3).ravel().tolist(), 0.0
    )
    values = sitk.GetArrayFromImage(resampled).transpose(2, 1, 0)[::-1, ::-1]
    last = low + step * (size - 1)
    return Grid(np.ascontiguousarray(values), 1e-3 * np.array([-last[0], -last[1], low[2]]), voxel)
