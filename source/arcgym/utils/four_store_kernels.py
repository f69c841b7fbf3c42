# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Four numbers in one access to the memory of a GPU, where struct and vector take one each."""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    const float4 four = *(const float4*)(fours.data + at);
    return wp::vec_t<4, float>(four.x, four.y, four.z, four.w);
#endif
    return fours.data[at];
""")
def load_four(fours: wp.array[wp.vec4], at: int) -> wp.vec4:
    """Return ``fours[at]``."""
    ...


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    *(float4*)(fours.data + at) = make_float4(value[0], value[1], value[2], value[3]);
#else
    fours.data[at] = value;
#endif
""")
def store_four(fours: wp.array[wp.vec4], at: int, value: wp.vec4):
    """Write ``fours[at]``."""
    ...


@wp.func
def joined(vector: wp.vec3, last: float) -> wp.vec4:
    """Return a vector with one number more."""
    return wp.vec4(vector[0], vector[1], vector[2], last)


@wp.func
def leading(four: wp.vec4) -> wp.vec3:
    """Return the first three of four numbers."""
    return wp.vec3(four[0], four[1], four[2])
