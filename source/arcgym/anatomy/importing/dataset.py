# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A folder of masks or surfaces, many patients: what to import, what came of it, and how patients are split.

The split depends on nothing but the patient's name, so that it stays when scans are added, and both postures of a
patient are on the same side.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from arcgym.anatomy.importing.errors import ImportArgumentError
from arcgym.anatomy.importing.formats import SURFACE_SUFFIXES, VOLUME_SUFFIXES
from arcgym.anatomy.importing.preflight import made_by_import

SPLIT_VERSION = 1
"""Raised when patients would go to other splits than before."""

METADATA_NAME = "meta-data.json"
"""File that the HQColon release has beside its folders of masks: one JSON object a line (https://osf.io/8tkpm)."""

COLUMNS = (
    *("name", "patient", "split", "posture", "status", "length_mm", "lumen_radius_mm", "bend_radius_mm", "likeness"),
    *("passage_mm", "widened_share", "cut_ml", "windows", "uncertain_mm", "seconds", "problem"),
)
"""Columns of the table."""


@dataclass(frozen=True)
class Scan:
    """A file to import."""

    path: Path
    """Mask or surface."""
    name: str
    """Name of the colon, and of its folder."""
    patient: str
    """Whose it is: scans of one patient are never in two splits."""
    posture: str
    """``supine`` or ``prone``."""
    about: str
    """The patient in words."""


def find_scans(folder: Path, pattern: str = "*", patient: str = "", metadata: Path | None = None) -> list[Scan]:
    """Return the files of a folder that an import can read, by name.

    Args:
        folder: Where to look, subfolders included.
        pattern: File names that are taken, such as ``*air_fluid*``.
        patient: Regular expression whose first group is the patient in a name; empty takes what the metadata say, or
            the name without ``supine``, ``prone`` and what follows.
        metadata: JSON lines with ``nnunet_label_file``, ``subject_id``, ``Position`` and ``Sex``; None looks for the
            file of the HQColon release in the folder and above it.

    Raises:
        ImportArgumentError: The folder holds no such file, two of the same name, or the expression has no group.
    """
    known = _metadata(folder, metadata)
    files = sorted(
        path
        for path in folder.rglob(pattern)
        if path.is_file() and path.name.lower().endswith(VOLUME_SUFFIXES + SURFACE_SUFFIXES)
    )
    if not files:
        suffixes = ", ".join(VOLUME_SUFFIXES + SURFACE_SUFFIXES)
        raise ImportArgumentError(f"{folder} holds no '{pattern}' that ends in {suffixes}", "Pass another folder.")
    rule = _patient_rule(patient)
    scans = [_scan(path, known.get(path.name, {}), rule) for path in files]
    names = [scan.name for scan in scans]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        where = ", ".join(str(scan.path) for scan in scans if scan.name == twice)
        raise ImportArgumentError(f"Two files are called {twice}: {where}", "Pass a narrower --pattern or subfolder.")
    return scans


def _patient_rule(patient: str) -> re.Pattern[str] | None:
    try:
        rule = re.compile(patient) if patient else None
    except re.error as error:
        raise ImportArgumentError(f"--patient is '{patient}': {error}", "Pass a regular expression.") from error
    if rule is not None and rule.groups < 1:
        raise ImportArgumentError(f"--patient is '{patient}'", r"Pass a group for the patient, such as (sub\d+)_.")
    return rule


def _scan(path: Path, known: dict[str, Any], rule: re.Pattern[str] | None) -> Scan:
    suffix = next(
        end for end in sorted(VOLUME_SUFFIXES + SURFACE_SUFFIXES, key=len)[::-1] if path.name.lower().endswith(end)
    )
    name = re.sub(r"[^\w.-]", "_", path.name[: -len(suffix)]).lstrip("_.-")[:64] or "colon"
    match = rule.search(name) if rule else None
    stem = re.split(r"[_.-]*(?:pos[_.-]?)?(?:supine|prone)", name, flags=re.IGNORECASE)[0] or name
    patient = match.group(1) if match else str(known.get("subject_id") or stem)
    position = str(known.get("Position") or name).lower()
    sex = {"F": "female", "M": "male"}.get(str(known.get("Sex")), "")
    return Scan(path, name, patient, "prone" if "prone" in position else "supine", f"{patient} {sex}".strip())


def _metadata(folder: Path, given: Path | None) -> dict[str, dict[str, Any]]:
    """Return what is known of each label file, by its name."""
    places = [given] if given else [folder / METADATA_NAME, folder.resolve().parent / METADATA_NAME]
    path = next((place for place in places if place.is_file()), None)
    if path is None:
        if given:
            raise ImportArgumentError(f"--metadata: {given} does not exist", "Pass the release's meta-data.json.")
        return {}
    try:
        rows = [json.loads(line) for line in path.read_text().splitlines() if line.strip()]
        return {str(row["nnunet_label_file"]): row for row in rows if "nnunet_label_file" in row}
    except (ValueError, TypeError) as error:
        raise ImportArgumentError(f"{path} is not one JSON object a line: {error}", "Pass --metadata.") from error


def split_of(patient: str, shares: tuple[float, float] = (0.8, 0.1)) -> str:
    """Return ``train``, ``validation`` or ``test`` by a hash of the patient's name.

    Args:
        patient: Name of the patient.
        shares: Shares of train and validation; the rest is test.
    """
    number = int.from_bytes(hashlib.sha256(f"{SPLIT_VERSION}:{patient}".encode()).digest()[:8], "big") / 2.0**64
    return "train" if number < shares[0] else "validation" if number < sum(shares) else "test"


def outcome(scan: Scan, out: Path) -> dict[str, Any] | None:
    """Return the row of a scan that was imported or refused before, None of one that is still to do.

    Args:
        scan: The scan.
        out: Folder of the data set.
    """
    row: dict[str, Any] = dict.fromkeys(COLUMNS, "")
    row |= {"name": scan.name, "patient": scan.patient, "split": split_of(scan.patient), "posture": scan.posture}
    report = out / scan.name / "report.json"
    if made_by_import(report):
        return row | _imported(report)
    refused = refusal(scan, out)
    if refused.is_file():
        return row | {"status": "refused", "split": "", "problem": refused.read_text().strip()}
    return None


def refusal(scan: Scan, out: Path) -> Path:
    """Return the file that says why a scan was refused."""
    return out / "refused" / f"{scan.name}.txt"


def _imported(path: Path) -> dict[str, Any]:
    """Return what a report says; a colon that was kept although it is doubtful is in no split.

    Raises:
        ImportArgumentError: The report lacks figures, as one of another version may.
    """
    report = json.loads(path.read_text())
    try:
        row, doubts = _figures(report), report["doubts"]
    except (KeyError, TypeError) as error:
        mend = f"Remove {path.parent}; it is made anew."
        raise ImportArgumentError(f"{path} lacks figures ({error})", mend) from error
    return row | {"status": "doubtful", "split": "", "problem": ". ".join(doubts)} if doubts else row


def _figures(report: dict[str, Any]) -> dict[str, Any]:
    checks = {check["name"]: check["value"] for check in report["checks"]}
    find = lambda text: next((value for name, value in checks.items() if text in name), None)  # noqa: E731
    bend, passage = find("bend radius"), find("stiff head")
    uncertain = [value for value in report.get("landmark_uncertainty_mm", {}).values() if value is not None]
    return {
        "status": "imported",
        "length_mm": round(report["length_mm"]),
        "lumen_radius_mm": report["lumen_radius_mm"]["p50"],
        "bend_radius_mm": "" if bend is None else round(1e3 * bend, 1),
        "likeness": round(report["orientation"]["likeness"], 2),
        "passage_mm": "" if passage is None else round(1e3 * passage, 2),
        "widened_share": report["widened_for_head"]["share"],
        "cut_ml": round(sum(cut["volume_ml"] for cut in report["cleaning"]["cut"]), 1),
        "windows": len(report.get("windows", [])),
        "uncertain_mm": round(max(uncertain, default=0)),
        "seconds": round(sum(report["seconds"].values())),
    }


def table_text(rows: Iterable[dict[str, Any]]) -> str:
    """Return the table as CSV."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def split_text(rows: Iterable[dict[str, Any]]) -> str:
    """Return the split as JSON: version, and the names of the imported colons of each side."""
    sides: dict[str, list[str]] = {"train": [], "validation": [], "test": []}
    for row in rows:
        if row["status"] == "imported":
            sides[row["split"]].append(row["name"])
    return json.dumps({"version": SPLIT_VERSION, **sides}, indent=2) + "\n"
