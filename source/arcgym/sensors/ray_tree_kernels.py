# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Kernels of the boxes that rays walk through, of all worlds in one launch.

A node is a box around triangles: its lower and its upper corner, each beside a number of 32 bits as Warp's ray queries
read them. An inner node's numbers are its two children; a leaf's are its first triangle, with the highest bit set, and
the one after its last.

W worlds, P patients, F triangles and N nodes of a world, E nodes of it in use.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401
from arcgym.utils.warp_block_kernels import LANES, wait_for_block

MESH_BYTES = 1024
"""Room for Warp's description of a mesh."""


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    const float4 node = reinterpret_cast<const float4*>(nodes.data)[index];
    return wp::vec3(node.x, node.y, node.z);
#else
    const wp::vec4& node = nodes.data[index];
    return wp::vec3(node[0], node[1], node[2]);
#endif
""")
def corner_of(nodes: wp.array[wp.vec4], index: int) -> wp.vec3:
    """Return the corner of a node's box [m]."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    reinterpret_cast<float4*>(nodes.data)[index] = make_float4(corner[0], corner[1], corner[2], __int_as_float(number));
#else
    nodes.data[index] = wp::vec4(corner[0], corner[1], corner[2], 0.0f);
    memcpy(&nodes.data[index][3], &number, sizeof(int));
#endif
""")
def put_node(nodes: wp.array[wp.vec4], index: int, corner: wp.vec3, number: int):
    """Write a corner of a node's box [m] and the number beside it."""
    ...


@wp.func_native(
    """
    static_assert(sizeof(wp::Mesh) <= ROOM, "Warp's description of a mesh has grown");
    wp::Mesh mesh;
    mesh.points = points;
    mesh.indices = indices;
    mesh.num_points = points.shape[0];
    mesh.num_tris = indices.shape[0] / 3;
    mesh.bvh.node_lowers = reinterpret_cast<wp::BVHPackedNodeHalf*>(lowers.data);
    mesh.bvh.node_uppers = reinterpret_cast<wp::BVHPackedNodeHalf*>(uppers.data);
    mesh.bvh.max_nodes = lowers.shape[0];
    mesh.bvh.num_nodes = lowers.shape[0];
    mesh.bvh.primitive_indices = order.data;
    mesh.bvh.num_items = mesh.num_tris;
    mesh.bvh.root = roots.data;
    *reinterpret_cast<wp::Mesh*>(described.data) = mesh;
""".replace("ROOM", str(MESH_BYTES))
)
def describe(
    points: wp.array[wp.vec3],
    indices: wp.array[int],
    lowers: wp.array[wp.vec4],
    uppers: wp.array[wp.vec4],
    order: wp.array[int],
    roots: wp.array[int],
    described: wp.array[wp.uint64],
):
    """Write Warp's description of a mesh, whose address a ray query takes for the mesh."""
    ...


@wp.kernel
def describe_mesh(
    points: wp.array[wp.vec3],
    indices: wp.array[int],
    lowers: wp.array[wp.vec4],
    uppers: wp.array[wp.vec4],
    order: wp.array[int],
    roots: wp.array[int],
    described: wp.array[wp.uint64],
):
    """Describe a mesh and its tree for ray queries. Launch (1,).

    Args:
        points: Vertices of all worlds [m], shape (W*M,).
        indices: Corners of the triangles of all worlds, shape (3*W*F,).
        lowers: Nodes' lower corners, shape (W*N,).
        uppers: Nodes' upper corners, shape (W*N,).
        order: Triangles in the order of the leaves, shape (W*F,).
        roots: Node at which each world's rays start, shape (W,).
        described: Description, of ``MESH_BYTES`` bytes; written.
    """
    describe(points, indices, lowers, uppers, order, roots, described)


@wp.func_native("""
    const wp::BVH& tree = reinterpret_cast<const wp::Mesh*>(mesh)->bvh;
    const wp::BVHPackedNodeHalf lower = tree.node_lowers[index], upper = tree.node_uppers[index];
    return wp::vec3i((int)lower.i, (int)upper.i, (int)lower.b);
""")
def node_numbers(mesh: wp.uint64, index: int) -> wp.vec3i:
    """Return the two numbers of a node of Warp's own tree, and whether it is a leaf."""
    ...


@wp.func_native("return reinterpret_cast<const wp::Mesh*>(mesh)->bvh.primitive_indices[place];")
def triangle_at(mesh: wp.uint64, place: int) -> int:
    """Return the triangle at a place in the order of the leaves of Warp's own tree."""
    ...


@wp.kernel
def read_tree(mesh: wp.uint64, nodes: wp.array[wp.vec3i], order: wp.array[int]):
    """Read the shape of a tree that Warp made of one world on a CPU, whose root is node 0. Launch (2*F,).

    Args:
        mesh: The mesh.
        nodes: Two children and 0, or first and end triangle in their order and 1, shape (2*F - 1,); written, also where
            the tree has no node.
        order: Triangles in the order of the leaves, shape (F,); written.
    """
    i = wp.tid()
    if i < nodes.shape[0]:
        nodes[i] = node_numbers(mesh, i)
    if i < order.shape[0]:
        order[i] = triangle_at(mesh, i)


@wp.kernel
def write_faces(
    faces: wp.array2d[wp.vec3i],
    patient: wp.array[int],
    written: wp.array[int],
    vertices: int,
    lanes: int,
    indices: wp.array[int],
):
    """Give worlds whose patient is another one than before that patient's triangles. Launch (W, lanes).

    Args:
        faces: Triangles of each patient, shape (F, P).
        patient: Patient of each world, shape (W,).
        written: Patient whose triangles each world has, shape (W,).
        vertices: Vertices of a world, M.
        lanes: Threads a world.
        indices: Corners of the triangles of all worlds, shape (3*W*F,); written.
    """
    world, lane = wp.tid()
    p = patient[world]
    if written[world] == p:
        return
    for face in range(lane, faces.shape[0], lanes):
        corner = 3 * (world * faces.shape[0] + face)
        for k in range(3):
            indices[corner + k] = world * vertices + faces[face, p][k]


@wp.kernel(launch_bounds=(LANES, 8))
def fit_boxes(
    points: wp.array[wp.vec3],
    faces: wp.array2d[wp.vec3i],
    patient: wp.array[int],
    nodes: wp.array[wp.vec4i],
    starts: wp.array[int],
    vertices: int,
    size: int,
    lanes: int,
    drawn: wp.array[wp.bool],
    lowers: wp.array[wp.vec4],
    uppers: wp.array[wp.vec4],
):
    """Fit the boxes of the worlds drawn to their triangles, children first. Launch (W, lanes), a block a world.

    Args:
        points: Vertices of all worlds [m], shape (W*M,).
        faces: Triangles of each patient in the order of the leaves, shape (F, P).
        patient: Patient of each world, shape (W,).
        nodes: Number, two children or first and end triangle, and whether it is a leaf, of each node, shape (E,).
        starts: First of the nodes of each batch, then E; the children of a batch's nodes are in batches before.
        vertices: Vertices of a world, M.
        size: Nodes of a world, N.
        lanes: Threads a world, all of a block; 1 on a CPU.
        drawn: Worlds to fit, shape (W,).
        lowers: Nodes' lower corners, shape (W*N,); written.
        uppers: Nodes' upper corners, shape (W*N,); written.
    """
    world, lane = wp.tid()
    if not drawn[world]:
        return
    p = patient[world]
    vertex = world * vertices
    root = world * size
    for batch in range(starts.shape[0] - 1):
        for i in range(starts[batch] + lane, starts[batch + 1], lanes):
            node = nodes[i]
            if node[3] != 0:
                corners = faces[node[1], p]
                a = points[vertex + corners[0]]
                b = points[vertex + corners[1]]
                c = points[vertex + corners[2]]
                lower = wp.min(wp.min(a, b), c)
                upper = wp.max(wp.max(a, b), c)
                for face in range(node[1] + 1, node[2]):
                    corners = faces[face, p]
                    a = points[vertex + corners[0]]
                    b = points[vertex + corners[1]]
                    c = points[vertex + corners[2]]
                    lower = wp.min(lower, wp.min(wp.min(a, b), c))
                    upper = wp.max(upper, wp.max(wp.max(a, b), c))
                first = world * faces.shape[0]
                put_node(lowers, root + node[0], lower, (first + node[1]) | wp.static(-(2**31)))
                put_node(uppers, root + node[0], upper, first + node[2])
            else:
                left = root + node[1]
                right = root + node[2]
                put_node(lowers, root + node[0], wp.min(corner_of(lowers, left), corner_of(lowers, right)), left)
                put_node(uppers, root + node[0], wp.max(corner_of(uppers, left), corner_of(uppers, right)), right)
        wait_for_block()
