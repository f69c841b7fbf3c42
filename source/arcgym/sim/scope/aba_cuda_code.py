# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CUDA code of the articulated-body algorithm by a warp a world, as text for :mod:`.aba_cuda_kernels`.

``LINKS`` and ``DOFS`` stand for the sizes of a chain, and ``lane`` for the thread's number in its warp. The parts are
the body of one function and share its variables, so that their order is that of the computation.
"""

from __future__ import annotations

READ = """
    using namespace wp;
    constexpr int L = LINKS, D = DOFS, Q = (L + 31) / 32;
    constexpr unsigned ALL = 0xffffffffu;
    __shared__ float joints[D][14];  // axis 0-2, then stop, 4 stop_inertia, 5 drive, 6 drive_inertia, gains, 13 effort
    __shared__ float links[L][15];  // arm 0-2, drift 3-8, bias force
    __shared__ int starts[L + 1];
    constexpr int OFFSET = 3, RATE = 4, DRIVE = 5, INERTIA = 6, GAIN = 7, EFFORT = 13, DRIFT = 3, FORCE = 9;
    const long long worlds = work.ll.shape[1];
    const bool free_root = chain.free == 1;
    const int first_joint = free_root ? 6 : 0;

    for (int d = lane; d < D; d += 32) {
        const long long at = d * worlds + world;
        float* const to = joints[d];
        const vec3 axis = work.axis.data[at];
        for (int k = 0; k < 3; ++k) to[k] = axis[k];
        to[OFFSET] = work.stop.data[at];
        to[RATE] = work.stop_inertia.data[at];
        to[DRIVE] = work.drive.data[at];
        to[INERTIA] = work.drive_inertia.data[at];
        to[EFFORT] = chain.linear.data[d] == 1 ? -1.0f - chain.effort.data[d] : chain.effort.data[d];
    }
    for (int link = lane; link < L; link += 32) {
        const long long at = link * worlds + world;
        float* const to = links[link];
        const vec3 arm = work.arm.data[at], lin = work.drift_lin.data[at], ang = work.drift_ang.data[at];
        const vec3 force = work.force.data[at], torque = work.torque.data[at];
        for (int k = 0; k < 3; ++k) {
            to[k] = arm[k];
            to[DRIFT + k] = lin[k];
            to[DRIFT + 3 + k] = ang[k];
            to[FORCE + k] = force[k];
            to[FORCE + 3 + k] = torque[k];
        }
    }
    for (int link = lane; link <= L; link += 32) starts[link] = chain.dof_start.data[link];

    // this lane's column of a link's matrix: two runs of three numbers
    const int column = lane < 6 ? lane : 5, k = column % 3;
    const bool angular = column >= 3;
    const float* const ll = (const float*)work.ll.data;
    const float* const la = (const float*)work.la.data;
    const float* const aa = (const float*)work.aa.data;
    const float* const upper = angular ? la + k : ll + 3 * k;
    const float* const lower = angular ? aa + 3 * k : la + 3 * k;
    const int upper_stride = angular ? 3 : 1;
    auto load = [&](int link, float* to) {
        const long long at = 9 * (link * worlds + world);
        for (int r = 0; r < 3; ++r) to[r] = upper[at + r * upper_stride];
        for (int r = 0; r < 3; ++r) to[3 + r] = lower[at + r];
    };
"""
"""Copies joints and links to shared memory, and tells each lane where its column of a link's matrix is."""

GATHER = """
    const int one = (k + 1) % 3, two = (k + 2) % 3;
    float m[6], p[6], own[6], next[6];
    for (int r = 0; r < 6; ++r) m[r] = p[r] = 0.0f;
    load(L - 1, next);
    __syncwarp();
    float ahead[8];  // axis, stop, stop_inertia, drive, drive_inertia, effort of the next joint
    auto look = [&](int d) {
        const float* const joint = joints[d > 0 ? d : 0];
        for (int n = 0; n < 7; ++n) ahead[n] = joint[n];
        ahead[7] = joint[EFFORT];
    };
    look(D - 1);
    for (int link = L - 1; link >= 0; --link) {
        for (int r = 0; r < 6; ++r) own[r] = next[r];
        load(link > 0 ? link - 1 : 0, next);
        const float* const row = links[link];
        for (int r = 0; r < 6; ++r) {
            m[r] += own[r];
            p[r] += row[FORCE + r];
        }
        if (link == 0 && free_root) break;
        const float arm[3] = {row[0], row[1], row[2]};
        const float a = angular ? row[two] : 0.0f, b = angular ? row[one] : 0.0f;
        float drift[6];
        for (int r = 0; r < 6; ++r) drift[r] = row[DRIFT + r];
        for (int d = starts[link + 1] - 1; d >= starts[link]; --d) {
            float* const joint = joints[d];
            const float s[3] = {ahead[0], ahead[1], ahead[2]};
            const bool slides = ahead[7] < 0.0f;
            const float effort = slides ? -1.0f - ahead[7] : ahead[7];
            const float stop = ahead[OFFSET], stop_inertia = ahead[RATE];
            float drive = ahead[DRIVE], inertia = ahead[INERTIA];
            look(d - 1);
            const float u = slides ? m[0] * s[0] + m[1] * s[1] + m[2] * s[2] : m[3] * s[0] + m[4] * s[1] + m[5] * s[2];
            float all[6];
            for (int r = 0; r < 6; ++r) all[r] = __shfl_sync(ALL, u, r);
            float pivot, rest;
            if (slides) {
                pivot = s[0] * all[0] + s[1] * all[1] + s[2] * all[2];
                rest = stop - (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]);
            } else {
                pivot = s[0] * all[3] + s[1] * all[4] + s[2] * all[5];
                rest = stop - (s[0] * p[3] + s[1] * p[4] + s[2] * p[5]);
            }
            pivot += stop_inertia;
            float scale = __fdividef(1.0f, pivot + inertia);
            const float at_end = drive - inertia * ((rest + drive) * scale);
            __syncwarp();
            if (fabsf(at_end) > effort) {
                drive = at_end < 0.0f ? -effort : effort;
                inertia = 0.0f;
                scale = __fdividef(1.0f, pivot);
                if (lane == 7) {
                    joint[DRIVE] = drive;
                    joint[INERTIA] = inertia;
                }
            }
            const float offset = scale * (rest + drive), gain = scale * u;
            for (int r = 0; r < 6; ++r) {
                m[r] -= all[r] * gain;
                p[r] += offset * all[r];
            }
            if (lane < 6) joint[GAIN + lane] = gain;
            if (lane == 6) joint[OFFSET] = offset;
        }
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
"""
"""Walks from the tip to the base: eliminates the joints of each link, and carries its matrix on to the one before."""

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
    float coming[11], link_row[9];  // axis, offset, gains and effort of the next joint; arm and drift of the next link
    auto look_out = [&](int d) {
        const float* const joint = joints[d < D ? d : D - 1];
        for (int n = 0; n < 4; ++n) coming[n] = joint[n];
        for (int n = 0; n < 6; ++n) coming[4 + n] = joint[GAIN + n];
        coming[10] = joint[EFFORT];
    };
    auto look_at_link = [&](int link) {
        for (int n = 0; n < 9; ++n) link_row[n] = links[link < L ? link : L - 1][n];
    };
    look_out(first_joint);
    look_at_link(0);
    for (int link = 0; link < L; ++link) {
        float* const row = links[link];
        const vec3 arm(link_row[0], link_row[1], link_row[2]);
        const vec3 drift_lin(link_row[3], link_row[4], link_row[5]), drift_ang(link_row[6], link_row[7], link_row[8]);
        look_at_link(link + 1);
        if (link > 0 || !free_root) {
            lin = lin + cross(ang, arm) + drift_lin;
            ang = ang + drift_ang;
            for (int d = starts[link]; d < starts[link + 1]; ++d) {
                const vec3 axis(coming[0], coming[1], coming[2]);
                const vec3 by_lin(coming[4], coming[5], coming[6]), by_ang(coming[7], coming[8], coming[9]);
                const float found = coming[OFFSET] - dot(by_lin, lin) - dot(by_ang, ang);
                const bool slides = coming[10] < 0.0f;
                look_out(d + 1);
                if (slides) lin = lin + found * axis;
                else ang = ang + found * axis;
                if (lane == 0) joints[d][RATE] = found;
            }
        }
        if (lane == 0)
            for (int r = 0; r < 3; ++r) {
                row[FORCE + r] = lin[r];
                row[FORCE + 3 + r] = ang[r];
            }
    }
    __syncwarp();
"""
"""Walks from the base to the tip: finds the accelerations of all joints and links."""

MOVE = """
    // each lane moves Q links in a row
    const int begin = lane * Q;
    transform poses[Q];
    vec3 spins[Q], rates[Q], places[Q];
    transform so_far(vec3(0.0f, 0.0f, 0.0f), quat(0.0f, 0.0f, 0.0f, 1.0f));
    const transform still = so_far;
    const int coords = chain.coords, extra = chain.coords - chain.dofs;
    vec3 root_lin(0.0f, 0.0f, 0.0f), root_ang(0.0f, 0.0f, 0.0f);
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = begin + q;
        transform local = still;
        spins[q] = rates[q] = places[q] = vec3(0.0f, 0.0f, 0.0f);
        if (link == 0 && free_root) {
            float* const v = joint_qd.data + (long long)world * D;
            float* const x = joint_q.data + (long long)world * coords;
            const float* const found = links[0] + FORCE;
            root_lin = vec3(v[0], v[1], v[2]) + dt * vec3(found[0], found[1], found[2]);
            root_ang = vec3(v[3], v[4], v[5]) + dt * vec3(found[3], found[4], found[5]);
            const transform before = body_q.data[(long long)world * L];
            const float turn = length(root_ang) * dt;
            quat rot = before.q;
            if (turn > 0.0f) rot = normalize(mul(quat_from_axis_angle(normalize(root_ang), turn), rot));
            const vec3 com = transform_point(before, chain.com.data[0]) + dt * root_lin;
            local = transform(com - quat_rotate(rot, chain.com.data[0]), rot);
            for (int i = 0; i < 3; ++i) {
                v[i] = root_lin[i];
                v[3 + i] = root_ang[i];
                x[i] = local.p[i];
            }
            for (int i = 0; i < 4; ++i) x[3 + i] = local.q[i];
        } else if (link < L) {
            vec3 shift(0.0f, 0.0f, 0.0f);
            quat rot(0.0f, 0.0f, 0.0f, 1.0f);
            for (int d = starts[link]; d < starts[link + 1]; ++d) {
                const float* const joint = joints[d];
                const float found = joint[RATE];
                float& v_now = joint_qd.data[(long long)world * D + d];
                float& x_now = joint_q.data[(long long)world * coords + d + extra];
                const float v = v_now + dt * found, x = x_now + dt * v;
                v_now = v;
                x_now = x;
                work.drive_force.data[d * worlds + world] = joint[DRIVE] - joint[INERTIA] * found;
                const vec3 axis = chain.axis.data[d];
                if (joint[EFFORT] < 0.0f) {
                    shift = shift + x * axis;
                    rates[q] = rates[q] + v * axis;
                } else {
                    spins[q] = spins[q] + v * quat_rotate(rot, axis);
                    rot = mul(rot, quat_from_axis_angle(axis, x));
                }
            }
            const transform moved = transform_multiply(chain.parent_frame.data[link], transform(shift, rot));
            places[q] = moved.p;
            local = transform_multiply(moved, transform_inverse(chain.child_frame.data[link]));
        }
        so_far = transform_multiply(so_far, local);
        poses[q] = so_far;
    }
"""
"""Moves the joints, those of Q links in a row in each lane, and chains the links of a lane up."""

CHAIN_UP = """
    auto from = [&](const transform& t, int source) {
        transform out;
        for (int i = 0; i < 3; ++i) out.p[i] = __shfl_sync(ALL, t.p[i], source);
        for (int i = 0; i < 4; ++i) out.q[i] = __shfl_sync(ALL, t.q[i], source);
        return out;
    };
    for (int step = 1; step < 32; step *= 2) {
        const transform behind = from(so_far, lane >= step ? lane - step : lane);
        if (lane >= step) so_far = transform_multiply(behind, so_far);
    }
    const transform last = from(so_far, lane > 0 ? lane - 1 : 0);
    const transform before_all = lane > 0 ? last : still;  // pose of the link before this lane's first
    #pragma unroll
    for (int q = 0; q < Q; ++q) poses[q] = transform_multiply(before_all, poses[q]);

    auto sum_behind = [&](vec3 total) {  // of the lanes before this one
        vec3 sum = total;
        for (int step = 1; step < 32; step *= 2) {
            vec3 behind;
            for (int i = 0; i < 3; ++i) behind[i] = __shfl_sync(ALL, sum[i], lane >= step ? lane - step : lane);
            if (lane >= step) sum = sum + behind;
        }
        return sum - total;
    };
    vec3 total(0.0f, 0.0f, 0.0f);
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = begin + q;
        const transform before = q > 0 ? poses[q > 0 ? q - 1 : 0] : before_all;
        vec3 turned(0.0f, 0.0f, 0.0f);
        if (link == 0 && free_root) turned = root_ang;
        else if (link < L) {
            const quat rot = mul(before.q, chain.parent_frame.data[link].q);
            turned = quat_rotate(rot, spins[q]);
            rates[q] = quat_rotate(rot, rates[q]);
            places[q] = transform_point(before, places[q]);
        }
        total = total + turned;
        spins[q] = total;
    }
    const vec3 spin_before = sum_behind(total);
    total = vec3(0.0f, 0.0f, 0.0f);
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = begin + q;
        const transform before = q > 0 ? poses[q > 0 ? q - 1 : 0] : before_all;
        const vec3 other = q > 0 ? spins[q > 0 ? q - 1 : 0] : spin_before;
        spins[q] = spins[q] + spin_before;
        if (link == 0 && free_root) total = total + root_lin;
        else if (link < L) {
            const vec3 com = transform_point(poses[q], chain.com.data[link]);
            total = total + rates[q] + cross(spins[q], com - places[q]);
            if (link > 0) total = total + cross(other, places[q] - transform_point(before, chain.com.data[link - 1]));
        }
        rates[q] = total;
    }
    const vec3 rate_before = sum_behind(total);
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = begin + q;
        if (link < L) {
            const long long at = link * worlds + world, row = (long long)world * L + link;
            const float* const found = links[link] + FORCE;
            const spatial_vector old = body_qd.data[row];
            const vec3 omega(old[3], old[4], old[5]), lever = work.lever.data[at];
            const vec3 a_lin(found[0], found[1], found[2]), a_ang(found[3], found[4], found[5]);
            work.acc_lin.data[at] = a_lin + cross(a_ang, lever) + cross(omega, cross(omega, lever));
            work.acc_ang.data[at] = a_ang;
            const vec3 v = rates[q] + rate_before;
            body_q_out.data[row] = poses[q];
            body_qd_out.data[row] = spatial_vector(v, spins[q]);
        }
    }
"""
"""Chains the lanes up, and writes the poses, velocities and accelerations of all links."""

SOLVE = "\n#if defined(__CUDA_ARCH__)" + "".join((READ, GATHER, ACCELERATE, MOVE, CHAIN_UP)) + "#endif\n"
"""Body of the function that solves the chain of a world; empty on a CPU."""
