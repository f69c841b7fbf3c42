# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The page that tells what a data set is, made from its files."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py

from arcgym.managers.recorder_files import episode_paths, open_recording
from arcgym.sensors.truth_images import FOLD_DEPTH, LABELS

LIMITS = f"""\
- Pictures are drawn from the policy's surface of the colon with the lights of the endoscope's stage, and the scope's
  shaft, where a tip that is bent back sees it. Fluid and stool are in them if the task has them. How real they look
  was not measured.
- Labels: {", ".join(f"{number} {name}" for number, name in enumerate(LABELS))}. Polyps and diverticula are those that
  the stage marks; a fold is what stands out into the lumen by {FOLD_DEPTH:.0%} of its radius at rest, a choice.
- Depth is the distance along the ray, in units of 10 µm, and `images/rays` the direction of each pixel: the lens is a
  fisheye with the angle from the center proportional to the distance in the picture.
- The scripted expert sees the centerline: its actions cannot be chosen from the pictures alone in every place.
"""


@dataclass
class _Patient:
    episodes: int = 0
    steps: int = 0
    seconds: float = 0.0
    successes: int = 0
    size: int = 0
    sha256: str = ""


@dataclass
class _Contents:
    patients: dict[str, _Patient] = field(default_factory=lambda: defaultdict(_Patient))
    arrays: dict[str, str] = field(default_factory=dict)
    facts: dict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))


def write_card(folder: Path, agent: str) -> Path:
    """Write ``README.md`` of a data set.

    Args:
        folder: Folder with one folder a patient.
        agent: What chose the actions, in words.
    """
    contents = _read(folder)
    path = folder / "README.md"
    path.write_text(_page(folder.name, agent, contents))
    return path


def _read(folder: Path) -> _Contents:
    contents = _Contents()
    for below in sorted(path for path in folder.iterdir() if path.is_dir()):
        for file in episode_paths(below):
            with open_recording(file) as opened:
                for demo in opened["data"].values():
                    name = str(json.loads(demo.attrs["info"]).get("patient", below.name))
                    _add(contents, name, demo)
            contents.patients[name].size += file.stat().st_size
    return contents


def _add(contents: _Contents, name: str, demo: h5py.Group) -> None:
    info, facts = json.loads(demo.attrs["info"]), json.loads(demo.attrs["provenance"])
    patient = contents.patients[name]
    patient.episodes += 1
    patient.steps += info["length"]
    patient.seconds += info["length"] * info["step_dt"]
    patient.successes += bool(info["success"])
    patient.sha256 = facts["stages"].get("colon", {}).get("sha256", "")
    for key in ("task", "device_name", "settings", "step_dt"):
        contents.facts[key][str(facts.get(key))] += 1
    for key, version in facts["versions"].items():
        contents.facts[f"version of {key}"][version] += 1
    if not contents.arrays:
        demo.visititems(lambda path, item: contents.arrays.update(_row(path, item)))


def _row(path: str, item: Any) -> dict[str, str]:
    if not isinstance(item, h5py.Dataset) or path.startswith(("initial_state/", "final_state/", "world_settings/")):
        return {}
    is_step = item.maxshape[:1] == (None,)
    shape = ", ".join(["T", *map(str, item.shape[1:])] if is_step else map(str, item.shape))
    return {path: f"{item.dtype} ({shape})"}


def _page(name: str, agent: str, contents: _Contents) -> str:
    rows = [
        f"| {key} | {one.episodes} | {one.steps} | {one.seconds:.0f} | {one.successes} | {one.size / 1e6:.1f} "
        f"| `{one.sha256}` |"
        for key, one in contents.patients.items()
    ]
    total = sum(one.episodes for one in contents.patients.values())
    arrays = [f"| `{key}` | {text} |" for key, text in sorted(contents.arrays.items())]
    facts = [f"| {key} | {', '.join(sorted(values))} |" for key, values in contents.facts.items()]
    parts = [
        f"# {name}",
        f"{total} episodes simulated with ARCGym; actions by: {agent}.",
        "| Patient | Episodes | Steps | Simulated s | Successes | MB | Stage |\n|---|---|---|---|---|---|---|\n"
        + "\n".join(rows),
        "## Made with",
        "| | |\n|---|---|\n" + "\n".join(facts),
        "Every file holds its settings, seed and hashes; `arcgym replay FILE` makes an episode again and checks it.",
        "## Arrays",
        "T control steps. States at either end and what events had drawn are there too.",
        "| Name | Type and shape |\n|---|---|\n" + "\n".join(arrays),
        "```python\nfrom arcgym.managers import load_episodes\n\n"
        'for episode in load_episodes("PATIENT"):\n    print(episode.info, episode.data["actions"].shape)\n```',
        "## Limits",
        LIMITS.strip(),
        "## Licence",
        "That of the colons' stages, whose metadata names it; nothing in the data set is of a person unless a stage is "
        "an import.",
    ]
    return "\n\n".join(parts).rstrip() + "\n"
