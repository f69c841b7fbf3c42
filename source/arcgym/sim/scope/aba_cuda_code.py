# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CUDA code of the articulated-body algorithm by a warp a world, as text for :mod:`.aba_cuda_kernels`.

``LINKS`` and ``DOFS`` stand for the sizes of a chain, and ``lane`` for the thread's number in its warp. The parts are
the body of one function and share its variables, so that their order is that of the computation.
"""

from __future__ import annotations

from arcgym.sim.scope.aba_cuda_link_code import PREPARE
from arcgym.sim.scope.aba_cuda_move_code import CHAIN_UP, MOVE

READ = """
    using namespace wp;
    constexpr int L = LINKS, D = DOFS, Q = (L + 31) / 32, J = (D + 31) / 32;
    constexpr unsigned ALL = 0xffffffffu;
    __shared__ __align__(16) float joints[D][12];  // see below
    __shared__ float links[L][9];  // arm, drift
    // 32 links of the walk inwards: ll, la, aa, bias force and torque; then accelerations of all links, six a link
    constexpr int OWN = 33, ROOM = 32 * OWN > 6 * L ? 32 * OWN : 6 * L;
    __shared__ float room[ROOM];
    __shared__ short starts[L + 1];  // first joint of each link
    constexpr int DRIFT = 3, FORCE = 27;
    // a joint first: its own axis, then the world's; stop, stop_inertia, drive, drive_inertia; effort, negative if it
    // slides; rate, coordinate; whether it slides
    constexpr int STOP = 3, STOP_INERTIA = 4, DRIVE = 5, INERTIA = 6, EFFORT = 7, V = 8, X = 9, SLIDES = 10;
    // eliminated: axis, offset, six gains, whether it slides, acceleration
    constexpr int OFFSET = 3, GAIN = 4, FOUND = 11;
    constexpr int LL = 3, LA = 9, TORQUE = 18, AA = 21;  // of a load, after its force
    unsigned loaded = 0;  // a bit for each of this lane's links, which are 32 apart
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = lane + 32 * q;
        if (link < L && loads.loaded.data[(long long)world * L + link] != 0) loaded |= 1u << q;
    }
    const bool free_root = chain.free == 1;
    const int first_joint = free_root ? 6 : 0, extra = chain.coords - chain.dofs;
    float* const v_now = joint_qd.data + (long long)world * D;
    float* const x_now = joint_q.data + (long long)world * chain.coords + extra;  // a free root's are elsewhere

    #pragma unroll
    for (int n = 0; n < J; ++n) {
        const int d = lane + 32 * n;
        if (d < D) {
            float* const to = joints[d];
            const vec3 axis = chain.axis.data[d];
            const bool slides = chain.linear.data[d] == 1;
            for (int i = 0; i < 3; ++i) to[i] = axis[i];
            const float v = v_now[d], x = x_now[d], spring = chain.stiffness.data[d];
            const float goal = target.data[(long long)world * chain.coords + extra + d];
            const float damper = fmaxf(chain.damping.data[d] - dt * spring, 0.0f);
            const float beyond = fminf(x - chain.lower.data[d], 0.0f) + fmaxf(x - chain.upper.data[d], 0.0f);
            const float stop_spring = chain.stop_stiffness.data[d], stop_damper = chain.stop_damping.data[d];
            const float stop = joint_f.data[(long long)world * D + d], armature = chain.armature.data[d];
            const float pushed = stop - (stop_spring * (beyond + dt * v) + stop_damper * v);
            to[STOP] = beyond != 0.0f ? pushed : stop;
            to[STOP_INERTIA] = beyond != 0.0f ? armature + dt * (stop_damper + dt * stop_spring) : armature;
            to[DRIVE] = spring * (goal - (x + dt * v)) - damper * v;
            to[INERTIA] = dt * (damper + dt * spring);
            to[EFFORT] = slides ? -1.0f - chain.effort.data[d] : chain.effort.data[d];
            to[V] = v;
            to[X] = x;
            to[SLIDES] = slides ? 1.0f : 0.0f;
        }
    }
    for (int d = lane; d < D; d += 32) {  // once all has been read: no read waits for a write
        *address(work.drive, d, world) = joints[d][DRIVE];
        *address(work.drive_inertia, d, world) = joints[d][INERTIA];
    }
    for (int link = lane; link <= L; link += 32) starts[link] = chain.dof_start.data[link];
"""
"""Prepares the joints in shared memory as :func:`.scope_kernels.prepare_joints`, and looks which links are loaded."""

GATHER = """
    // this lane's column of a link's matrix: two runs of three numbers
    const int column = lane < 6 ? lane : 5, k = column % 3, one = (k + 1) % 3, two = (k + 2) % 3;
    const bool angular = column >= 3;
    const int upper = angular ? 9 + k : 3 * k, stride = angular ? 3 : 1, lower = 9 + 3 * k + (angular ? 9 : 0);
    float m[6], p[6], next[12];
    for (int r = 0; r < 6; ++r) m[r] = p[r] = 0.0f;
    auto load = [&](const float* row) {
        for (int r = 0; r < 3; ++r) {
            next[r] = row[upper + r * stride];
            next[3 + r] = row[lower + r];
        }
        for (int r = 0; r < 6; ++r) next[6 + r] = row[FORCE + r];
    };
    float ahead[8];  // axis, stop, stop_inertia, drive, drive_inertia, effort of the next joint
    auto look = [&](int d) {
        const float4* const joint = (const float4*)joints[d > 0 ? d : 0];
        const float4 near = joint[0], far = joint[1];
        ahead[0] = near.x, ahead[1] = near.y, ahead[2] = near.z, ahead[3] = near.w;
        ahead[4] = far.x, ahead[5] = far.y, ahead[6] = far.z, ahead[7] = far.w;
    };
    auto reciprocal = [](float x) {
        float y;
        asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
        return y;
    };
    for (int base = (L - 1) / 32 * 32; base >= 0; base -= 32) {
        __syncwarp();
        if (base + lane < L) prepare(base + lane, room + OWN * lane);
        __syncwarp();
        const int end = base + 32 < L ? base + 32 : L;
        load(room + OWN * (end - 1 - base));
        int until = starts[end], from = starts[end - 1];  // joints of the link
        look(until - 1);
        for (int link = end - 1; link >= base; --link) {
            for (int r = 0; r < 6; ++r) {
                m[r] += next[r];
                p[r] += next[6 + r];
            }
            load(room + OWN * (link > base ? link - 1 - base : 0));
            if (link == 0 && free_root) break;
            const float* const row = links[link];
            const float arm[3] = {row[0], row[1], row[2]};
            const float a = angular ? row[two] : 0.0f, b = angular ? row[one] : 0.0f;
            float drift[6];
            for (int r = 0; r < 6; ++r) drift[r] = row[DRIFT + r];
            const int first = from;
            from = starts[link > 0 ? link - 1 : 0];
            for (int d = until - 1; d >= first; --d) {
                float* const joint = joints[d];
                const float s[3] = {ahead[0], ahead[1], ahead[2]};
                const bool slides = ahead[EFFORT] < 0.0f;
                const float effort = slides ? -1.0f - ahead[EFFORT] : ahead[EFFORT];
                const float stop = ahead[STOP], stop_inertia = ahead[STOP_INERTIA];
                const float drive = ahead[DRIVE], inertia = ahead[INERTIA];
                look(d - 1);
                float met[3], pushed[3], all[6];
                for (int r = 0; r < 3; ++r) met[r] = slides ? m[r] : m[3 + r];
                for (int r = 0; r < 3; ++r) pushed[r] = slides ? p[r] : p[3 + r];
                const float u = met[0] * s[0] + met[1] * s[1] + met[2] * s[2];
                const float rest = stop - (s[0] * pushed[0] + s[1] * pushed[1] + s[2] * pushed[2]);
                for (int r = 5; r >= 0; --r) all[r] = __shfl_sync(ALL, u, r);
                for (int r = 0; r < 3; ++r) met[r] = slides ? all[r] : all[3 + r];
                const float pivot = s[0] * met[0] + s[1] * met[1] + s[2] * met[2] + stop_inertia;
                const float if_held = reciprocal(pivot + inertia), if_limited = reciprocal(pivot);
                const float at_end = drive - inertia * ((rest + drive) * if_held);
                const bool limited = fabsf(at_end) > effort;
                const float limit = at_end < 0.0f ? -effort : effort, scale = limited ? if_limited : if_held;
                const float offset = scale * (rest + (limited ? limit : drive)), gain = scale * u;
                for (int r = 0; r < 6; ++r) {
                    m[r] -= (all[r] * u) * scale;
                    p[r] += offset * all[r];
                }
                __syncwarp();  // all have read what is overwritten now
                if (lane < 6) joint[GAIN + lane] = gain;
                if (lane == 6) joint[OFFSET] = offset;
                if (lane == 7 && limited) {
                    *address(work.drive, d, world) = limit;
                    *address(work.drive_inertia, d, world) = 0.0f;
                }
            }
            until = first;
            float carried = 0.0f;
            for (int r = 0; r < 6; ++r) carried += m[r] * drift[r];
            for (int r = 0; r < 6; ++r) p[r] += __shfl_sync(ALL, carried, r);
            for (int r = 0; r < 6; ++r) {
                const float left = __shfl_sync(ALL, m[r], one), right = __shfl_sync(ALL, m[r], two);
                m[r] += b * right - a * left;
            }
            m[3] += arm[1] * m[2] - arm[2] * m[1];
            m[4] += arm[2] * m[0] - arm[0] * m[2];
            m[5] += arm[0] * m[1] - arm[1] * m[0];
            p[3] += arm[1] * p[2] - arm[2] * p[1];
            p[4] += arm[2] * p[0] - arm[0] * p[2];
            p[5] += arm[0] * p[1] - arm[1] * p[0];
        }
    }
"""
"""Walks from the tip to the base, 32 links at a time, which the lanes prepare side by side: eliminates the joints of
each link, and carries its matrix on to the one before."""

ACCELERATE = """
    vec3 lin(0.0f, 0.0f, 0.0f), ang(0.0f, 0.0f, 0.0f);
    if (free_root) {
        mat33 whole_ll, whole_la, whole_aa;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                whole_ll.data[i][j] = __shfl_sync(ALL, m[i], j);
                whole_la.data[i][j] = __shfl_sync(ALL, m[i], 3 + j);
                whole_aa.data[i][j] = __shfl_sync(ALL, m[3 + i], 3 + j);
            }
        const vec3 force(p[0], p[1], p[2]), torque(p[3], p[4], p[5]);
        const mat33 inverted = inverse(whole_ll);
        const mat33 coupled = mul(inverted, whole_la);
        const mat33 schur = sub(whole_aa, mul(transpose(whole_la), coupled));
        ang = mul(inverse(schur), sub(mul(force, coupled), torque));
        lin = sub(-mul(inverted, force), mul(coupled, ang));
    }
    __syncwarp();
    float4 coming[3];  // of the next joint: axis and offset; gains; whether it slides
    float link_row[9];  // arm and drift of the next link
    auto look_out = [&](int d) {
        const float4* const joint = (const float4*)joints[d < D ? d : D - 1];
        for (int n = 0; n < 3; ++n) coming[n] = joint[n];
    };
    auto look_at_link = [&](int link) {
        for (int n = 0; n < 9; ++n) link_row[n] = links[link < L ? link : L - 1][n];
    };
    look_out(first_joint);
    look_at_link(0);
    int d = first_joint, until = starts[1];
    for (int link = 0; link < L; ++link) {
        const vec3 arm(link_row[0], link_row[1], link_row[2]);
        const vec3 drift_lin(link_row[3], link_row[4], link_row[5]), drift_ang(link_row[6], link_row[7], link_row[8]);
        const int end = until;
        look_at_link(link + 1);
        until = starts[link + 2 < L ? link + 2 : L];
        if (link > 0 || !free_root) {
            lin = lin + cross(ang, arm) + drift_lin;
            ang = ang + drift_ang;
            for (; d < end; ++d) {
                const float4 first = coming[0], second = coming[1], third = coming[2];
                const float along = third.z, about = 1.0f - along;
                const vec3 axis(first.x, first.y, first.z), slide = along * axis, turn = about * axis;
                const vec3 by_lin(second.x, second.y, second.z), by_ang(second.w, third.x, third.y);
                const float found = first.w - dot(by_lin, lin) - dot(by_ang, ang);
                look_out(d + 1);
                lin = lin + found * slide;
                ang = ang + found * turn;
                if (lane == 0) joints[d][FOUND] = found;
            }
        }
        if (lane == 0)
            for (int r = 0; r < 3; ++r) {
                room[6 * link + r] = lin[r];
                room[6 * link + 3 + r] = ang[r];
            }
    }
    __syncwarp();
"""
"""Walks from the base to the tip: finds the accelerations of all joints and links."""

RECORD = """
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = lane + 32 * q;
        if (link < L) {
            const long long row = (long long)world * L + link;
            const float* const found = room + 6 * link;
            const vec3 omega = spatial_bottom(body_qd.data[row]), lever = *address(work.lever, link, world);
            const vec3 a_lin(found[0], found[1], found[2]), a_ang(found[3], found[4], found[5]);
            const vec3 acc = a_lin + cross(a_ang, lever) + cross(omega, cross(omega, lever));
            if (mean_load.data && loaded >> q & 1) {
                float load[28];
                load_of(link, load);
                const vec3 force(load[0], load[1], load[2]);
                const vec3 given = mul(symmetric(load + LL), acc) + mul(general(load + LA), a_ang);
                mean_load.data[row] = mean_load.data[row] - weight * (force + given);
            }
            *address(work.acc_lin, link, world) = acc;
            *address(work.acc_ang, link, world) = a_ang;
        }
    }
"""
"""Writes the accelerations of all links' centers of mass, and adds up the forces of their loads."""

PARTS = (READ, PREPARE, GATHER, ACCELERATE, RECORD, MOVE, CHAIN_UP)
SOLVE = "\n#if defined(__CUDA_ARCH__)" + "".join(PARTS) + "#endif\n"
"""Body of the function that solves the chain of a world; empty on a CPU."""
