# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact search between all links and the lumen, world by world."""

from __future__ import annotations

import numpy as np
import torch
import warp as wp

from arcgym.sim.contact import contact_record_kernels
from arcgym.sim.contact import contact_search_kernels as kernels
from arcgym.sim.contact.contact_kernels import ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.simulation_cfg import ContactCfg
from arcgym.sim.wall.wall_topology import PATCH_FACES, LumenTopology

FURTHER_LINKS = 5
"""Links whose share of contacts every world has room for beyond its own: one link may have several times its share."""
GPU_LIST_PARTS = 12
"""Threads a world that list the contacts by vertex on a GPU, where a list waits for memory at every entry."""
MAX_RING_SHIFT = 4
"""Rings that a link may cross in one physics step."""


class ContactSearch:
    """Finds the contacts of every link with the inner wall faces near it, however the wall is gathered or folded.

    Faces are found by distance, through spheres around rings and patches of them. A link's ring (its bin along the
    centreline) is tracked from step to step: faces near it may touch the link from either side, faces elsewhere just
    from the lumen, so that a neighboring loop of the colon, however close, is never mistaken for the link's own.
    """

    def __init__(
        self,
        cfg: ContactCfg,
        surface_offset: float,
        topology: LumenTopology,
        vertex_ring: np.ndarray,
        half_length: np.ndarray,
        radius: np.ndarray,
        num_envs: int,
        device: str,
    ):
        """Allocate the search.

        Args:
            cfg: Contact settings.
            surface_offset: Distance of the lumen from its faces, towards the axis [m].
            topology: Lumen faces of one world.
            vertex_ring: Ring of each wall vertex, shape (V,).
            half_length: Half the length of each link's axis [m], shape (L,).
            radius: Link radii [m], shape (L,).
            num_envs: Worlds, W.
            device: Warp device.
        """
        self.num_envs, self.device = num_envs, device
        self.link_count, self.vertex_count, self.ring_count = len(radius), len(vertex_ring), len(topology.rings)
        self.surface = self._surface(topology, cfg.search_reach)
        self.links = LinkShapes()
        self.links.half_length = wp.array(half_length, dtype=float, device=device)
        self.links.radius = wp.array(radius, dtype=float, device=device)
        self.law = self._law(cfg)
        self.law.wall_radius += surface_offset
        self.friction = wp.full(num_envs, cfg.friction, dtype=float, device=device)
        self.vertex_ring = wp.array(vertex_ring, dtype=int, device=device)
        self.centers = wp.zeros((num_envs, self.ring_count), dtype=wp.vec3, device=device)
        self.ring = wp.full((num_envs, self.link_count), -1, dtype=int, device=device)
        self.ring_distance = wp.zeros((num_envs, self.link_count), dtype=float, device=device)
        self.bounds = kernels.Bounds()
        self.bounds.ring = wp.zeros((self.ring_count, num_envs), dtype=wp.vec4, device=device)
        self.bounds.patch = wp.zeros((len(topology.patch_start) - 1, num_envs), dtype=wp.vec4, device=device)
        self.candidates = self._candidates(cfg.patch_capacity)
        self.debt = wp.zeros((self.num_envs, self.link_count), dtype=wp.vec3, device=device)
        """Impulse over ``dt`` that each link has had from the wall and not yet given back to it [N], shape (W, L)."""
        self.records = self._records(cfg.capacity * (self.link_count + FURTHER_LINKS))
        self.list_parts = 1 if device == "cpu" else GPU_LIST_PARTS
        self.past = contact_record_kernels.PastContacts()
        for name in ("start", "face", "slide"):
            setattr(self.past, name, wp.clone(getattr(self.records, name)))

    def _surface(self, topology: LumenTopology, reach: int) -> kernels.LumenSurface:
        surface = kernels.LumenSurface()
        for name in ("rings", "faces", "neighbors", "patch_start", "ring_patch"):
            setattr(surface, name, wp.array(getattr(topology, name), dtype=int, device=self.device))
        surface.reach = reach
        return surface

    def _law(self, cfg: ContactCfg) -> ContactLaw:
        law = ContactLaw()
        names = ("stiffness", "hardening", "damping", "friction_stiffness", "static_friction", "slip_velocity")
        for name in (*names, "wall_radius", "search_gap"):
            setattr(law, name, getattr(cfg, name))
        return law

    def _candidates(self, patches: int) -> kernels.Candidates:
        shape = (self.num_envs, self.link_count)
        candidates = kernels.Candidates()
        candidates.patch_faces = PATCH_FACES
        candidates.patch = wp.zeros((*shape, patches), dtype=int, device=self.device)
        candidates.patches = wp.zeros(shape, dtype=int, device=self.device)
        candidates.distance = wp.zeros((*shape, patches * PATCH_FACES), dtype=float, device=self.device)
        candidates.count = wp.zeros(shape, dtype=int, device=self.device)
        return candidates

    def _records(self, capacity: int) -> ContactRecords:
        slots = self.num_envs * capacity
        records = ContactRecords()
        records.capacity = capacity
        records.start = wp.zeros((self.num_envs, self.link_count + 1), dtype=int, device=self.device)
        records.dropped = wp.zeros(self.num_envs, dtype=int, device=self.device)
        records.link = wp.full(slots, -1, dtype=int, device=self.device)
        records.face = wp.zeros(slots, dtype=int, device=self.device)
        records.corners = wp.zeros(slots, dtype=wp.vec3i, device=self.device)
        for name in ("distance", "weight"):
            setattr(records, name, wp.zeros(slots, dtype=float, device=self.device))
        for name in ("bary", "direction", "normal", "slide", "owed"):
            setattr(records, name, wp.zeros(slots, dtype=wp.vec3, device=self.device))
        records.vertex_head = wp.full((self.vertex_count, self.num_envs), -1, dtype=int, device=self.device)
        records.vertex_next = wp.full(3 * slots, -1, dtype=int, device=self.device)
        records.ring_head = wp.full((self.ring_count, self.num_envs), -1, dtype=int, device=self.device)
        records.ring_next = wp.full(slots, -1, dtype=int, device=self.device)
        return records

    @property
    def memory(self) -> dict[str, torch.Tensor]:
        """What each world's contacts remember from step to step, as views of shape (N, ...)."""
        records, n = self.records, self.num_envs
        return {
            "contact_start": wp.to_torch(records.start),
            "contact_face": wp.to_torch(records.face).view(n, -1),
            "contact_slide": wp.to_torch(records.slide).view(n, -1),
            "contact_debt": wp.to_torch(self.debt).view(n, -1),
        }

    def update_centers(self, x: wp.array) -> None:
        """Recompute the ring centres from the wall positions ``x`` [m], shape (V, W), vec3."""
        wp.launch(
            kernels.ring_centers,
            (self.num_envs, self.ring_count),
            inputs=[x, self.surface],
            outputs=[self.centers],
            device=self.device,
        )

    def track(self, body_q: wp.array) -> None:
        """Follow each link's ring; links whose ring is -1 are searched along the whole colon.

        Args:
            body_q: Link poses, shape (W*L,), transform.
        """
        wp.launch(
            kernels.track_rings,
            (self.num_envs, self.link_count),
            inputs=[self.centers, body_q, MAX_RING_SHIFT],
            outputs=[self.ring, self.ring_distance],
            device=self.device,
        )

    def detect(self, x: wp.array, body_q: wp.array) -> None:
        """Fill the contact records.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
            body_q: Link poses, shape (W*L,), transform.
        """
        self.update_centers(x)
        self.track(body_q)
        self._select(x, body_q)
        self._locate(x, body_q)
        self._list()

    def _select(self, x: wp.array, body_q: wp.array) -> None:
        """Record the faces near each link, and what friction held where it touched the same face before."""
        for name in ("start", "face", "slide"):
            wp.copy(getattr(self.past, name), getattr(self.records, name))
        worlds, links = self.num_envs, self.link_count
        wp.launch(
            kernels.bound_faces,
            (self.ring_count, worlds),
            inputs=[x, self.surface],
            outputs=[self.bounds],
            device=self.device,
        )
        links_of = (self.links, self.surface)
        wp.launch(
            kernels.find_patches,
            (worlds, links),
            inputs=[body_q, *links_of, self.bounds, self.law, self.ring, self.ring_distance],
            outputs=[self.candidates],
            device=self.device,
        )
        wp.launch(
            kernels.face_distances,
            self.candidates.distance.shape,
            inputs=[x, body_q, *links_of, self.law],
            outputs=[self.candidates],
            device=self.device,
        )
        outputs = [self.candidates, self.records.dropped]
        wp.launch(kernels.count_candidates, (worlds, links), inputs=[], outputs=outputs, device=self.device)
        wp.launch(
            contact_record_kernels.allot_slots,
            worlds,
            inputs=[self.candidates],
            outputs=[self.records],
            device=self.device,
        )
        wp.launch(
            contact_record_kernels.fill_slots,
            (worlds, links + 1),
            inputs=[self.surface, self.candidates, self.past],
            outputs=[self.records],
            device=self.device,
        )

    def _locate(self, x: wp.array, body_q: wp.array) -> None:
        """Find point and normal of each record."""
        links = (self.num_envs, self.link_count)
        wp.launch(
            contact_record_kernels.locate_contacts,
            (self.num_envs, self.records.capacity),
            inputs=[x, body_q, self.links, self.surface],
            outputs=[self.records],
            device=self.device,
        )
        wp.launch(
            contact_record_kernels.use_directions_as_normals,
            links,
            inputs=[self.links],
            outputs=[self.records],
            device=self.device,
        )

    def _list(self) -> None:
        """List the records of each vertex and of each ring."""
        self.records.vertex_head.fill_(-1)
        self.records.ring_head.fill_(-1)
        wp.launch(
            contact_record_kernels.build_contact_lists,
            (self.num_envs, self.list_parts),
            inputs=[self.vertex_ring, self.list_parts],
            outputs=[self.records],
            device=self.device,
        )
