# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
# mypy: ignore-errors
"""Volume of the lumen and state of the gas in it. R rings, V wall vertices, P patients, W worlds.

The gas is ideal and stays at body temperature: its amount, pressure times volume, changes by flow alone. It is stiff
(1.5 l give by 1 ml at 67 Pa), far stiffer than the wall, so that a pressure computed from the volume at the start of a
step would swing: it is solved for together with the wall, see ``gas_rings``.
"""

import warp as wp

from arcgym.utils import warp_setup  # noqa: F401

SMALLEST_VOLUME = wp.constant(1.0e-6)
"""Least volume of a lumen that is reckoned with [m^3]: a wall that is broken has none."""
SHUT_SHARE = wp.constant(0.4)
"""Share of the least opening under which a prop gets no stiffer, so that the physics step bears it."""


@wp.struct
class LumenRings:
    """Faces that close a lumen: the wall's by ring, those of each ring followed by its lids'."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    face: wp.array[wp.vec3i]  # vertices, normals outwards, shape (F,)
    start: wp.array[int]  # first face of each ring, shape (R + 1,)
    lid: wp.array[int]  # first face of each ring that is a lid, shape (R,)
    inverse_slice: wp.array2d[float]  # 1 over ``slice_volume`` when imaged [1/m^3], 0 if it is none, shape (R, P)


@wp.struct
class GasLaw:
    """Settings of the gas, see ``GasCfg``."""

    ambient: float  # [Pa]
    imaged: float  # pressure across the wall when it was imaged [Pa]
    leak_opening: float  # [Pa]
    suction_depth: float  # [Pa]
    least_opening: float
    prop_pressure: float  # [Pa]


@wp.struct
class GasState:
    """Gas of each world, shape (W,) each."""

    amount: wp.array[float]  # absolute pressure times volume [J]; 0 is to be filled at ``start``
    pressure: wp.array[float]  # above ambient [Pa]
    mean: wp.array[float]  # mean of the control step, in the middle of one its sum [Pa]
    peak: wp.array[float]  # highest of the control step [Pa]
    volume: wp.array[float]  # of the lumen [m^3]
    flow: wp.array[float]  # of gas into the lumen, at ambient pressure [m^3/s]
    abdominal: wp.array[float]  # [Pa]
    start: wp.array[float]  # pressure to fill at [Pa]
    leak: wp.array[float]  # conductance of the anus [m^3/(s Pa)]


@wp.struct
class GasLoads:
    """What the gas does to the wall; F triangles in the shell's order."""

    patient: wp.array[int]  # patient of each world, shape (W,)
    push: wp.array[float]  # pressure outwards beyond that of the image, or of the abdomen inwards [Pa], shape (W,)
    draw: wp.array[float]  # pressure that is missing to bear the tension that the wall had then [Pa], shape (W,)
    tense: int  # whether the wall keeps its tension where the gas bears it
    share: wp.array[float]  # of that tension that the gas bears, 0 to 1, shape (W,)
    hold: wp.array2d[wp.vec3]  # what else holds each vertex then [N], shape (V, W)
    prop: wp.array2d[float]  # pressure of opposite sides on each other [Pa], shape (R, W)
    ring: wp.array[int]  # of each triangle, shape (F,)
    tie: wp.array2d[wp.vec2]  # of each corner's edges to the next two: force over length, over ``draw`` [m], (3*F, P)


@wp.func
def slice_volume(x: wp.array2d[wp.vec3], lumen: LumenRings, r: int, w: int) -> float:
    """Return 4/3 of the volume between a ring's faces and their middle line [m^3]; zero for a flat slice."""
    middle = wp.vec3(0.0)
    count = float(0.0)
    for f in range(lumen.start[r], lumen.lid[r]):
        face = lumen.face[f]
        middle += x[face[0], w] + x[face[1], w] + x[face[2], w]
        count += 3.0
    middle = middle / wp.max(count, 1.0)
    total = float(0.0)
    for f in range(lumen.start[r], lumen.lid[r]):
        face = lumen.face[f]
        a = x[face[0], w] - middle
        b = x[face[1], w] - middle
        c = x[face[2], w] - middle
        total += wp.dot(a, wp.cross(b, c)) / 3.0
    return total


@wp.func
def prop_share(opening: float) -> float:
    """Return how hard opposite sides prop each other, 1 at half the least opening, by the ``opening`` over the least.

    1 / opening - 1, and its tangent where the lumen is nearly shut.
    """
    kept = wp.max(opening, SHUT_SHARE)
    return wp.max(1.0 / kept - 1.0 + (kept - opening) / (kept * kept), 0.0)


@wp.func
def measure_slice(
    x: wp.array2d[wp.vec3],
    lumen: LumenRings,
    law: GasLaw,
    volume: wp.array2d[float],
    prop: wp.array2d[float],
    r: int,
    w: int,
):
    """Measure the part of ring ``r`` of the volume of world ``w``, and how hard its opposite sides prop each other.

    Args:
        x: Wall positions [m], shape (V, W).
        lumen: Lumen of all patients.
        law: Settings.
        volume: Part of the lumen's volume, between the ring's faces and the origin [m^3], shape (R, W); written.
        prop: Pressure of opposite sides on each other [Pa], shape (R, W); written.
        r: Ring.
        w: World.
    """
    total = float(0.0)
    for f in range(lumen.start[r], lumen.start[r + 1]):
        face = lumen.face[f]
        total += wp.dot(x[face[0], w], wp.cross(x[face[1], w], x[face[2], w])) / 6.0
    volume[r, w] = total
    p = lumen.patient[w]
    inverse = lumen.inverse_slice[r, p]
    push = float(0.0)
    if inverse > 0.0 and law.least_opening > 0.0:
        push = law.prop_pressure * prop_share(slice_volume(x, lumen, r, w) * inverse / law.least_opening)
    prop[r, w] = push


@wp.kernel
def measure_slices(
    x: wp.array2d[wp.vec3],
    lumen: LumenRings,
    law: GasLaw,
    volume: wp.array2d[float],
    prop: wp.array2d[float],
):
    """Measure the slice of every ring, see :func:`measure_slice`. Launch (R, W)."""
    r, w = wp.tid()
    measure_slice(x, lumen, law, volume, prop, r, w)


@wp.func
def total_volume(volume: wp.array2d[float], w: int) -> float:
    """Return the volume of the lumen of world ``w`` [m^3] from its rings' parts, shape (R, W)."""
    total = float(0.0)
    for r in range(volume.shape[0]):
        total += volume[r, w]
    return wp.max(total, SMALLEST_VOLUME)


@wp.func
def set_loads(law: GasLaw, gas: GasState, loads: GasLoads, w: int):
    """Write what the pressure does to the wall of world ``w``."""
    across = gas.pressure[w] - gas.abdominal[w]
    loads.push[w] = wp.max(across - law.imaged, 0.0) + wp.min(across, 0.0)
    loads.draw[w] = wp.clamp(law.imaged - across, 0.0, law.imaged)
    if loads.tense == 1:
        loads.push[w] = across
        loads.draw[w] = law.imaged
        loads.share[w] = wp.clamp(across / wp.max(law.imaged, 1.0), 0.0, 1.0)


@wp.func
def add_flow(law: GasLaw, dt: float, gas: GasState, w: int):
    """Let gas flow in and out of world ``w`` for a step of ``dt`` [s]; the amount is changed."""
    pressure = gas.pressure[w]
    flow = gas.flow[w]
    if flow < 0.0:
        left = pressure - gas.abdominal[w] + law.suction_depth
        flow *= wp.clamp(2.0 * left / law.suction_depth, 0.0, 1.0)
    lost = gas.leak[w] * wp.max(pressure - law.leak_opening, 0.0)
    gas.amount[w] = gas.amount[w] + dt * (law.ambient * flow - (law.ambient + pressure) * lost)


@wp.func
def note_pressure(gas: GasState, w: int):
    """Take the pressure at the end of a step into mean and peak of the control step of world ``w``."""
    pressure = gas.pressure[w]
    gas.mean[w] = gas.mean[w] + pressure
    gas.peak[w] = wp.max(gas.peak[w], pressure)


@wp.kernel
def fit_rigid(volume: wp.array2d[float], law: GasLaw, dt: float, gas: GasState, loads: GasLoads):
    """Make a step of lumens whose walls do not move. Launch (W,).

    Args:
        volume: Parts of the volume [m^3], shape (R, W).
        law: Settings.
        dt: Step [s].
        gas: State; changed in place.
        loads: Loads of the pressure; written.
    """
    w = wp.tid()
    add_flow(law, dt, gas, w)
    here = total_volume(volume, w)
    gas.volume[w] = here
    gas.pressure[w] = gas.amount[w] / here - law.ambient
    set_loads(law, gas, loads, w)
    note_pressure(gas, w)


@wp.kernel
def fill_gas(volume: wp.array2d[float], mask: wp.array[wp.bool], law: GasLaw, gas: GasState, loads: GasLoads):
    """Fill lumens that have no amount of gas yet at their start pressure. Launch (W,).

    Args:
        volume: Parts of the volume [m^3], shape (R, W).
        mask: Worlds whose state was written, shape (W,); the others stay as they are.
        law: Settings.
        gas: State; changed in place.
        loads: Loads of the pressure; written.
    """
    w = wp.tid()
    if not mask[w]:
        return
    here = total_volume(volume, w)
    if gas.amount[w] <= 0.0:
        gas.pressure[w] = gas.start[w]
        gas.amount[w] = (law.ambient + gas.start[w]) * here
    gas.mean[w] = gas.pressure[w]
    gas.peak[w] = gas.pressure[w]
    gas.volume[w] = here
    set_loads(law, gas, loads, w)
