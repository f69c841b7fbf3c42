# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""All that a start state depends on, as hashes."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from arcgym.utils.coerce import to_plain

if TYPE_CHECKING:
    from arcgym.assets import Colon, Endoscope
    from arcgym.sim import SimulationCfg

FORMAT = 1
"""Raise it when drives or files change, and older files are made anew."""
NOT_IN_STATE = ("class_type", "usd_path", "num_patients", "gas", "expert", "device", "use_graph")
"""Fields of configurations that change no state, or whose content is hashed instead of their name. States are of
the pressure at which the colon was imaged, at which gas does nothing to a wall but for its tension."""

EFFECTS = ("wall_law", "weight", "grading", "abdomen", "mesentery", "loops")
"""Fields that change no state while they are not ``active``."""
OF_DRIVES = ("play", "lag")
"""Fields of drives that change no state while they are zero."""
OF_PARTS: dict[str, dict[str, float]] = {"contact": {"step_damping": 1.0}, "loops": {"bends": False}}
"""Fields of contact and loops that change no state while they have this value."""
OF_MOTION = {"contact": "deep_damping"}
"""Fields that act on what moves alone: what is at rest with one value is at rest with any."""


@dataclass(frozen=True)
class StateKey:
    """Hashes of the parts that start states depend on."""

    colon: str
    """Rest mesh of the wall, its attachment and the centerline."""
    tissue: str
    """Material, thickness and anchors of the wall."""
    robot: str
    """Links, joints, rigidities, introducer and actuators."""
    expert: str
    """Class that drives; at which speed does not matter."""
    solver: str
    """Settings of the simulation but for the device."""

    @property
    def digest(self) -> str:
        """Hash of all parts, 16 hexadecimal digits."""
        return _digest(dataclasses.asdict(self))

    def changed(self, other: dict[str, str]) -> list[str]:
        """Return the names of the parts that differ in another key, given as a dict."""
        return [name for name, value in dataclasses.asdict(self).items() if other.get(name) != value]


def state_key(colon: Colon, endoscope: Endoscope, sim: SimulationCfg, patient: int = 0) -> StateKey:
    """Return the key of the start states of a robot in a colon.

    Args:
        colon: The colon.
        endoscope: The robot.
        sim: Settings of the simulation.
        patient: Which of the colon's patients.
    """
    one = colon.patients[patient]
    wall, line = one.wall, one.centerline
    mesh = {name: getattr(wall, name) for name in ("points", "ring", "layer", "segment", "anchor", "ring_arc")}
    mesh |= {f"line_{name}": getattr(line, name) for name in ("points", "arc", "segment")}
    if one.contact is not None:
        mesh["contact"] = one.contact.points
    stage = {f.name: getattr(endoscope.stage, f.name) for f in dataclasses.fields(endoscope.stage)}
    stage = {name: value for name, value in stage.items() if name not in ("path", "name", "camera", "lights")}
    return StateKey(
        colon=_digest(mesh),
        tissue=_digest({"cfg": settings_of(colon.cfg), "preset": colon.tissue, "thickness": colon.thickness}),
        robot=_digest({"cfg": settings_of(endoscope.cfg), "stage": stage}),
        expert=_digest({"class": endoscope.cfg.expert, "format": FORMAT}),
        solver=_digest(settings_of(sim)),
    )


def settings_of(cfg: Any) -> dict[str, Any]:
    """Return the settings of a configuration that states depend on."""
    off = [name for name in EFFECTS if hasattr(cfg, name) and not getattr(cfg, name).active]
    kept = {name: value for name, value in to_plain(cfg).items() if name not in (*NOT_IN_STATE, *off)}
    gas = getattr(cfg, "gas", None)
    if gas is not None and gas.tense:
        kept["tension"] = gas.imaging_pressure - gas.abdominal_pressure
    for drive in kept.get("actuators", {}).values():
        for name in OF_DRIVES:
            if drive.get(name) == 0.0:
                del drive[name]
    for part, fields in OF_PARTS.items():
        own = kept.get(part, {})
        for name, value in fields.items():
            if own.get(name) == value:
                del own[name]
    for part, name in OF_MOTION.items():
        kept.get(part, {}).pop(name, None)
    return kept


def _digest(value: Any) -> str:
    digest = hashlib.sha256()
    _feed(digest, value)
    return digest.hexdigest()[:16]


def _feed(digest: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        _feed(digest, {field.name: getattr(value, field.name) for field in dataclasses.fields(value)})
    elif isinstance(value, dict):
        for name in sorted(value):
            digest.update(str(name).encode())
            _feed(digest, value[name])
    else:
        digest.update(json.dumps(to_plain(value), sort_keys=True).encode())
