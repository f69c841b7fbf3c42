# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Selection of a scene entity and of parts of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import torch

from arcgym.anatomy.segments import SEGMENTS
from arcgym.utils import MISSING, configclass
from arcgym.utils.string import did_you_mean, resolve_matching_names

if TYPE_CHECKING:
    from arcgym.scene import InteractiveScene

Ids = Sequence[int] | torch.Tensor | slice
"""Indices along a dimension of an entity's data; ``slice(None)`` selects everything."""

_NAMED_PARTS = ("joint", "body")
"""Kinds of parts selected by name: fields ``<kind>_names``, ``<kind>_ids``, and ``entity.<kind>_names``."""


@configclass
class SceneEntityCfg:
    """Names an entity of the scene and, if wanted, some of its joints, bodies or wall nodes.

    Managers call :meth:`resolve` once; term functions then index with the ids:
    ``env.scene[cfg.name].data.joint_pos[:, cfg.joint_ids]``.
    """

    name: str = MISSING
    """Name of the entity in the scene, e.g. ``"endoscope"``."""

    joint_names: str | list[str] | None = None
    """Regular expressions over joint names; None selects by ``joint_ids``."""

    joint_ids: Ids = slice(None)
    """Joint indices; found from ``joint_names`` where those are given."""

    body_names: str | list[str] | None = None
    """Regular expressions over link names; None selects by ``body_ids``."""

    body_ids: Ids = slice(None)
    """Link indices; found from ``body_names`` where those are given."""

    segments: str | list[str] | None = None
    """Regular expressions over anatomical segments, e.g. ``["sigmoid"]``; None selects by ``node_ids``."""

    node_ids: Ids = slice(None)
    """Wall node indices; found from ``segments`` where those are given."""

    preserve_order: bool = False
    """Whether named parts come in the order they are named instead of the entity's own."""

    def resolve(self, scene: InteractiveScene) -> None:
        """Find the ids of everything given by name, on the scene's device.

        Raises:
            ValueError: If the entity or a part does not exist, with those that do, or names and ids are both given.
        """
        if self.name not in scene.keys():  # noqa: SIM118 - a scene is not a dict
            raise ValueError(f"The scene has no entity '{self.name}'. {did_you_mean(self.name, scene.keys())}")
        entity = scene[self.name]
        for kind in _NAMED_PARTS:
            patterns = getattr(self, f"{kind}_names")
            if patterns is not None:
                self._check_unset(f"{kind}_names", f"{kind}_ids")
                setattr(self, f"{kind}_ids", self._find(entity, kind, patterns, scene.device))
        if self.segments is not None:
            self._check_unset("segments", "node_ids")
            self.node_ids = self._find_nodes(entity, scene.device)

    def _find(self, entity: Any, kind: str, patterns: str | list[str], device: str) -> Ids:
        names = getattr(entity, f"{kind}_names", None)
        if names is None:
            raise ValueError(f"The entity '{self.name}' ({type(entity).__name__}) has no {kind}_names to select from.")
        try:
            ids, _ = resolve_matching_names(patterns, names, self.preserve_order)
        except ValueError as error:
            raise ValueError(f"{kind}_names of the entity '{self.name}': {error}") from error
        return slice(None) if ids == list(range(len(names))) else torch.tensor(ids, device=device)

    def _find_nodes(self, entity: Any, device: str) -> torch.Tensor:
        walls = [patient.wall for patient in getattr(entity, "patients", ())]
        if not walls:
            raise ValueError(f"The entity '{self.name}' ({type(entity).__name__}) has no wall: segments need a colon.")
        try:
            ids, names = resolve_matching_names(self.segments or [], SEGMENTS)
        except ValueError as error:
            raise ValueError(f"segments of the entity '{self.name}': {error}") from error
        if any((wall.segment != walls[0].segment).any() for wall in walls):
            raise ValueError(f"The patients of '{self.name}' have {names} at different nodes: choose nodes by world.")
        node_segment = torch.as_tensor(walls[0].segment)
        nodes = torch.isin(node_segment, torch.tensor(ids)).nonzero().flatten()
        if len(nodes) == 0:
            raise ValueError(f"The wall of '{self.name}' has no nodes in the segments {names}.")
        return nodes.to(device)

    def _check_unset(self, names: str, ids: str) -> None:
        if getattr(self, ids) != slice(None):
            raise ValueError(f"The entity '{self.name}' is given both {names} and {ids}: give one of them.")
