# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Contact search between all links and the lumen, world by world."""

from __future__ import annotations

import numpy as np
import torch
import warp as wp

from arcgym.sim.contact import carried_kernels, lumen_kernels, patch_list_kernels
from arcgym.sim.contact import contact_list_kernels as list_kernels
from arcgym.sim.contact import contact_record_kernels as record_kernels
from arcgym.sim.contact import contact_search_kernels as kernels
from arcgym.sim.contact.carried_surface import CarriedSurface
from arcgym.sim.contact.contact_kernels import ContactLaw, ContactRecords, LinkShapes
from arcgym.sim.simulation_cfg import ContactCfg
from arcgym.sim.wall.wall_topology import PATCH_FACES, LumenTopology
from arcgym.utils.side_stream import SideStream
from arcgym.utils.warp_setup import GPU_BLOCK
from arcgym.utils.warp_vote_kernels import LANES

FURTHER_LINKS = 5
"""Links whose share of contacts every world has room for beyond its own: one link may have several times its share."""
GPU_RECORD_THREADS = 256
"""Threads a world that go through its contacts on a GPU, one block: as many as most worlds have contacts."""
CARRIED_ROOM = 3
"""How much more room contacts and patches have on a fine surface."""
MAX_RING_SHIFT = 4
"""Rings that a link may cross in one physics step."""


SPHERE_SLACK = 1.0e-4
"""How far the wall may move until its faces are enclosed anew [m]: the spheres around them are larger by as much."""


class ContactSearch:
    """Finds the contacts of every link with the inner wall faces near it, however the wall is gathered or folded.

    Faces are found by distance, through spheres around rings and patches of them. A link's ring (its bin along the
    centerline) is tracked from step to step: faces near it may touch the link from either side, faces elsewhere just
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
        carried: CarriedSurface | None = None,
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
            carried: Fine surface of the lumen that is touched in place of the wall's faces.
        """
        self.num_envs, self.device, self.carried, self._cfg = num_envs, device, carried, cfg
        self.still = False
        """Whether the walls stand still: no contact moves them, and where they are is looked up on request alone."""
        if carried is not None:
            topology, surface_offset = carried.topology, 0.0
        room = (len(radius) + FURTHER_LINKS) * (1 if carried is None else CARRIED_ROOM)
        self.link_count, self.vertex_count, self.ring_count = len(radius), len(vertex_ring), len(topology.rings)
        self.surface = self._surface(topology, cfg.search_reach, carried)
        self.links = LinkShapes()
        self.links.half_length = wp.array(half_length, dtype=float, device=device)
        self.links.radius = wp.array(radius, dtype=float, device=device)
        self.law = self._law(cfg)
        self.law.wall_radius += surface_offset
        self.moduli = wp.zeros(num_envs, dtype=wp.vec3, device=device)
        """Elastic moduli of each world's wall, from which contacts take their softness, shape (N,), vec3."""
        self.friction = wp.full(num_envs, cfg.friction, dtype=float, device=device)
        """Coulomb coefficient of each world, shape (N,)."""
        self.centers = wp.zeros((num_envs, self.ring_count), dtype=wp.vec3, device=device)
        """Centers of the deformed rings [m], shape (N, R), vec3."""
        self._all_worlds = wp.ones(num_envs, dtype=wp.bool, device=device)
        self.ring = wp.full((num_envs, self.link_count), -1, dtype=int, device=device)
        """Ring that each link lies in, -1 before the first search, shape (N, L)."""
        self._ring_before = wp.clone(self.ring)
        self.ring_distance = wp.zeros((num_envs, self.link_count), dtype=float, device=device)
        """Distance of each link from its ring's center [m], ``FAR`` outside the anus, shape (N, L)."""
        self.bounds = lumen_kernels.Bounds()
        patches, worlds = len(topology.patch_start) - 1, num_envs if wp.get_device(device).is_cuda else 0
        self.bounds.ring = wp.zeros((self.ring_count, num_envs), dtype=wp.vec4, device=device)
        self.bounds.patch = wp.zeros((patches, num_envs), dtype=wp.vec4, device=device)
        self.bounds.ring_of_world = wp.zeros((worlds, self.ring_count), dtype=wp.vec4, device=device)
        self.bounds.patch_of_world = wp.zeros((worlds, patches), dtype=wp.vec4, device=device)
        self._side = SideStream(device)
        rings_apart = np.ptp(vertex_ring[topology.faces], axis=1).max() if carried is None else 1
        self._follows = rings_apart <= 1
        if self._follows:
            self._place = wp.full((self.vertex_count, num_envs), lumen_kernels.FAR, dtype=wp.vec3, device=device)
            self._moved = wp.ones((self.ring_count, num_envs), dtype=int, device=device)
            self._spheres = wp.zeros((self.ring_count, num_envs), dtype=wp.vec4, device=device)
        self.candidates = self._candidates(cfg.patch_capacity * room)
        self.debt = wp.zeros((self.num_envs, self.link_count), dtype=wp.vec3, device=device)
        """Impulse over ``dt`` that each link has had from the wall and not yet given back to it [N], shape (W, L)."""
        self.records = self._records(cfg.capacity * room)
        self._orders = wp.zeros_like(self.records.vertex_next), wp.zeros_like(self.records.ring_next)
        self.past = record_kernels.PastContacts()
        for name in ("start", "face", "slide"):
            setattr(self.past, name, wp.clone(getattr(self.records, name)))

    def _surface(
        self, topology: LumenTopology, reach: int, carried: CarriedSurface | None
    ) -> lumen_kernels.LumenSurface:
        surface = lumen_kernels.LumenSurface()
        for name in ("rings", "faces", "neighbors", "patch_start", "ring_patch", "patch_vertices"):
            setattr(surface, name, wp.array(getattr(topology, name), dtype=int, device=self.device))
        ring = np.repeat(np.arange(self.ring_count), np.diff(topology.ring_start))
        surface.ring = wp.array(ring, dtype=int, device=self.device)
        surface.reach = reach
        surface.carried = int(carried is not None)
        if carried is not None:
            surface.carriers = wp.array(carried.carriers, dtype=wp.vec4i, device=self.device)
            surface.weights = wp.array(carried.weights, dtype=wp.vec4, device=self.device)
        return surface

    def _law(self, cfg: ContactCfg) -> ContactLaw:
        law = ContactLaw()
        names = ("stiffness", "hardening", "damping", "deep_damping", "friction_stiffness", "static_friction")
        for name in (*names, "slip_velocity", "wall_radius", "search_gap"):
            setattr(law, name, getattr(cfg, name))
        law.relief = 1.0 - cfg.step_damping
        return law

    def _candidates(self, capacity: int) -> kernels.Candidates:
        worlds, links = self.num_envs, self.link_count
        candidates = kernels.Candidates()
        candidates.capacity, candidates.patch_faces = capacity, PATCH_FACES
        candidates.rings = wp.zeros((worlds, links), dtype=wp.vec2i, device=self.device)
        candidates.start = wp.zeros((worlds, links + 1), dtype=int, device=self.device)
        candidates.distance = wp.zeros((worlds, capacity, PATCH_FACES), dtype=float, device=self.device)
        candidates.nearest = wp.zeros((worlds, links), dtype=float, device=self.device)
        for name in ("patches", "count"):
            setattr(candidates, name, wp.zeros((worlds, links), dtype=int, device=self.device))
        for name in ("link", "patch", "faces"):
            setattr(candidates, name, wp.zeros((worlds, capacity), dtype=int, device=self.device))
        return candidates

    def _records(self, capacity: int) -> ContactRecords:
        slots = self.num_envs * capacity
        records = ContactRecords()
        records.capacity = capacity
        records.threads = 1 if self.device == "cpu" else GPU_RECORD_THREADS
        records.start = wp.zeros((self.num_envs, self.link_count + 1), dtype=int, device=self.device)
        records.dropped = wp.zeros(self.num_envs, dtype=int, device=self.device)
        for name in ("link", "face", "ring"):
            setattr(records, name, wp.zeros(slots, dtype=int, device=self.device))
        records.corners = wp.zeros(slots, dtype=wp.vec4i, device=self.device)
        records.bary = wp.zeros(slots, dtype=wp.vec4, device=self.device)
        for name in ("distance", "weight"):
            setattr(records, name, wp.zeros(slots, dtype=float, device=self.device))
        for name in ("offset", "point", "point_vel", "normal", "slide", "owed"):
            setattr(records, name, wp.zeros(slots, dtype=wp.vec3, device=self.device))
        records.vertex_head = wp.full((self.vertex_count, self.num_envs), -1, dtype=int, device=self.device)
        records.vertex_next = wp.full(4 * slots, -1, dtype=int, device=self.device)
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

    def shortage(self) -> str | None:
        """Return a warning if contacts found no room since the start, None if all did. It waits for the device."""
        dropped = wp.to_torch(self.records.dropped)
        worlds = int((dropped > 0).sum())
        if worlds == 0:
            return None
        capacity, patch_capacity = self._cfg.capacity, self._cfg.patch_capacity
        return (
            f"{int(dropped.sum())} contacts found no room in {worlds} of {self.num_envs} worlds, whose forces are "
            f"wrong: raise env.sim.contact.capacity ({capacity}) and patch_capacity ({patch_capacity})."
        )

    def soften(self, moduli: wp.array, share: float) -> None:
        """Have contacts give as the tissue of a shell does; without, the wall counts as hard.

        Args:
            moduli: Elastic moduli of each world's shell, read at every search, shape (W,), vec3.
            share: ``ContactCfg.tissue_share``.
        """
        self.moduli, self.law.tissue_share = moduli, share

    def update_centers(self, x: wp.array) -> None:
        """Recompute the ring centers from the wall positions ``x`` [m], shape (V, W), vec3."""
        wp.launch(
            lumen_kernels.ring_centers,
            (self.ring_count, self.num_envs),
            inputs=[x, self.surface],
            outputs=[self.centers],
            device=self.device,
        )

    def track(self, body_q: wp.array, world_mask: wp.array | None = None) -> None:
        """Follow each link's ring; links whose ring is -1 are searched along the whole colon.

        Args:
            body_q: Link poses, shape (W*L,), transform.
            world_mask: Worlds to look at, shape (W,), bool; None for all.
        """
        wp.copy(self._ring_before, self.ring)
        worlds = self._all_worlds if world_mask is None else world_mask
        wp.launch(
            lumen_kernels.track_rings,
            (self.num_envs, self.link_count),
            inputs=[self.centers, body_q, MAX_RING_SHIFT, worlds, self._ring_before],
            outputs=[self.ring, self.ring_distance],
            device=self.device,
        )

    def detect(self, x: wp.array, body_q: wp.array) -> None:
        """Fill the contact records: :meth:`follow`, :meth:`find` and :meth:`order`, one after the other.

        Args:
            x: Wall positions [m], shape (V, W), vec3.
            body_q: Link poses, shape (W*L,), transform.
        """
        self.follow(x, body_q)
        self.find(x, body_q)
        self.order()

    def follow(self, x: wp.array, body_q: wp.array) -> None:
        """Find the ring of every link, and where the faces are; arguments as in :meth:`detect`."""
        if self._follows and not self.still:
            shape, inputs = (self.ring_count, self.num_envs), [x, self.surface, SPHERE_SLACK]
            self._launch(lumen_kernels.follow_rings, shape, inputs, [self.centers, self._place, self._moved])
            with self._side.scope():
                self._begin(x)
            self.track(body_q)
            return
        with self._side.scope():
            self._begin(x)
        if not self.still:
            self.update_centers(x)
        self.track(body_q)

    def find(self, x: wp.array, body_q: wp.array) -> None:
        """Find and record the contacts of the links; arguments as in :meth:`detect`."""
        self._side.join()
        if not self.still and self.carried is not None:
            self._measure_near(x, body_q)
        self._find(body_q)
        self._record(x, self.points, body_q)

    def _begin(self, x: wp.array) -> None:
        """Put by what the last search found, and find where the faces are of a wall that is touched itself."""
        records = self.records
        self._launch(record_kernels.keep_past, (self.num_envs, records.threads), [records], [self.past])
        records.vertex_head.fill_(-1)
        records.ring_head.fill_(-1)
        if not self.still and self._follows and self.carried is None:
            self.points = x
            inputs = [x, self.surface, self._moved, SPHERE_SLACK]
            self._launch(lumen_kernels.bound_moved_faces, (self.ring_count, self.num_envs), inputs, [self.bounds])
        elif not self.still and self.carried is None:
            self.measure_surface(x)

    def measure_surface(self, x: wp.array) -> None:
        """Find where the faces are at the wall positions ``x`` [m], shape (V, W), vec3.

        Where :attr:`still`, :meth:`detect` leaves it to others to call this and :meth:`update_centers`.
        """
        self.points = x if self.carried is None else self.carried.update(x)
        shape, inputs = (self.ring_count, self.num_envs), [self.points, self.surface]
        self._launch(lumen_kernels.bound_faces, shape, inputs, [self.bounds])

    def _measure_near(self, x: wp.array, body_q: wp.array) -> None:
        """Find where the faces of a fine surface are that a link may touch."""
        fine, shape = self.carried, (self.ring_count, self.num_envs)
        assert fine is not None
        of_links = [body_q, self.links, self.law, self.ring_distance, self.centers]
        inputs = [x, self.surface, fine.room, fine.patient, *of_links]
        if self._follows:
            outputs = [self._spheres, fine.near]
            self._launch(carried_kernels.mark_near_followed, shape, [*inputs, self._moved, SPHERE_SLACK], outputs)
        else:
            self._launch(carried_kernels.mark_near_rings, shape, inputs, [fine.near])
        self.points = fine.update_near(x)
        self._launch(carried_kernels.bound_near_faces, shape, [self.points, self.surface, fine.near], [self.bounds])

    def _find(self, body_q: wp.array) -> None:
        """Find the patches near each link."""
        of_links = [body_q, self.links, self.surface, self.bounds, self.law]
        if self.device != "cpu":
            threads = self.records.threads
            inputs = [*of_links, self.ring, self.ring_distance, threads, LANES]
            outputs = [self.candidates, self.records.dropped]
            wp.launch(
                patch_list_kernels.find_patches,
                (self.num_envs, threads),
                inputs=inputs,
                outputs=outputs,
                device=self.device,
                block_dim=threads,
            )
            return
        outputs = [self.candidates, self.records.dropped]
        inputs = [*of_links, self.ring, self.ring_distance]
        self._launch(kernels.list_patches, (self.num_envs,), inputs, outputs)

    def _record(self, x: wp.array, points: wp.array, body_q: wp.array) -> None:
        """Record the faces near each link, and what friction held where it touched the same face before."""
        records = self.records
        of_records = (self.num_envs, records.threads)
        inputs = [points, body_q, self.links, self.surface, self.law]
        wp.launch(
            record_kernels.record_faces,
            of_records,
            inputs=inputs,
            outputs=[self.candidates, records],
            device=self.device,
            block_dim=records.threads,
        )
        near = [self.links, self.surface, self.candidates.nearest, self.past]
        inputs = [x, points, body_q, *near, self.law, self.moduli]
        self._launch(record_kernels.locate_contacts, of_records, inputs, [records])

    def order(self) -> None:
        """Put the lists of contacts by vertex and ring into order, which the wall reads; the scope does not."""
        records = self.records
        if self.still:
            return
        if self.device == "cpu":
            self._launch(list_kernels.sort_vertex_lists, (self.vertex_count, self.num_envs), [], [records])
            self._launch(list_kernels.list_rings, (self.num_envs, 1), [1], [records])
            return
        wp.launch(
            list_kernels.order_lists,
            (self.num_envs, records.threads),
            inputs=[records],
            outputs=list(self._orders),
            device=self.device,
            block_dim=records.threads,
        )

    def _launch(self, kernel: wp.Kernel, shape: tuple[int, ...], inputs: list[object], outputs: list[object]) -> None:
        wp.launch(kernel, shape, inputs=inputs, outputs=outputs, device=self.device, block_dim=GPU_BLOCK)
