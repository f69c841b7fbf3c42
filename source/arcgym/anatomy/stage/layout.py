# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Prim paths, attribute names and schemas of a colon stage; nothing else in ARCGym spells them."""

from __future__ import annotations

ROOT_PATH = "/Colon"
WALL_PATH = "/Colon/Wall"
VISUAL_PATH = "/Colon/Visual"
PROXY_PATH = "/Colon/VisualProxy"
CONTACT_PATH = "/Colon/Contact"
CENTERLINE_PATH = "/Colon/Centerline"
LANDMARKS_PATH = "/Colon/Landmarks"
TISSUE_PATH = "/Colon/Tissue"
MUCOSA_PATH = "/Colon/Mucosa"

ANCHOR = "primvars:arcgym:anchor"
SEGMENT = "primvars:arcgym:segment"
RING = "primvars:arcgym:ring"
LAYER = "primvars:arcgym:layer"
FRAME_NEIGHBORS = "primvars:arcgym:frameNeighbors"
RING_ARC = "arcgym:ringArc"
COLUMNS = "arcgym:columns"

UV = "primvars:st"
TINT = "primvars:arcgym:tint"
SKIN_INDICES = "primvars:arcgym:skinIndices"
SKIN_WEIGHTS = "primvars:arcgym:skinWeights"

RADIUS = "primvars:arcgym:radius"
ARC = "primvars:arcgym:arc"
LANDMARK_ARC = "arcgym:arc"
DETAIL_TEXTURE = "arcgym:detailTexture"
CUSTOM_DATA = "arcgym"

WALL_SCHEMAS = ("PhysicsVolumeDeformableSimAPI", "PhysicsDeformableBodyAPI", "PhysicsCollisionAPI")
"""Applied schemas that make a ``TetMesh`` a volume deformable (AOUSD deformables proposal, as Newton imports it)."""

MATERIAL_SCHEMAS = ("PhysicsMaterialAPI", "PhysicsVolumeDeformableMaterialAPI")
"""Applied schemas of the tissue material bound to the wall for the purpose ``physics``."""
