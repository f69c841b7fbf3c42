# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CUDA code that moves a chain whose accelerations are known: the last parts of :mod:`.aba_cuda_code`."""

from __future__ import annotations

MOVE = """
    float speeds[J], coordinates[J], forces[J];
    #pragma unroll
    for (int n = 0; n < J; ++n) {
        const int d = lane + 32 * n;
        if (d >= first_joint && d < D) {
            const float found = joints[d][FOUND];
            const float drive = *address(work.drive, d, world), inertia = *address(work.drive_inertia, d, world);
            speeds[n] = v_now[d] + dt * found;
            coordinates[n] = x_now[d] + dt * speeds[n];
            forces[n] = drive - inertia * found;
        }
    }
    #pragma unroll
    for (int n = 0; n < J; ++n) {
        const int d = lane + 32 * n;
        if (d >= first_joint && d < D) {
            const vec3 axis = chain.axis.data[d];
            for (int i = 0; i < 3; ++i) joints[d][i] = axis[i];
            joints[d][V] = v_now[d] = speeds[n];
            joints[d][X] = x_now[d] = coordinates[n];
            *address(work.drive_force, d, world) = forces[n];
        }
    }
    __syncwarp();
    // each lane moves Q links in a row
    const int begin = lane * Q;
    transform poses[Q];
    vec3 spins[Q], rates[Q], places[Q];
    transform so_far(vec3(0.0f, 0.0f, 0.0f), quat(0.0f, 0.0f, 0.0f, 1.0f));
    const transform still = so_far;
    vec3 root_lin(0.0f, 0.0f, 0.0f), root_ang(0.0f, 0.0f, 0.0f);
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = begin + q;
        transform local = still;
        spins[q] = rates[q] = places[q] = vec3(0.0f, 0.0f, 0.0f);
        if (link == 0 && free_root) {
            float *const v = v_now, *const x = x_now - extra;
            root_lin = vec3(v[0], v[1], v[2]) + dt * vec3(room[0], room[1], room[2]);
            root_ang = vec3(v[3], v[4], v[5]) + dt * vec3(room[3], room[4], room[5]);
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
                const float v = joint[V], x = joint[X];
                const vec3 axis(joint[0], joint[1], joint[2]);
                if (joint[SLIDES] != 0.0f) {
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
    // by way of shared memory, of which the rows of links and accelerations are not needed any more
    float *const poses_of_all = links[0], *const twists_of_all = room;
    #pragma unroll
    for (int q = 0; q < Q; ++q) {
        const int link = begin + q;
        if (link < L) {
            const vec3 v = rates[q] + rate_before;
            for (int i = 0; i < 3; ++i) {
                poses_of_all[7 * link + i] = poses[q].p[i];
                twists_of_all[6 * link + i] = v[i];
                twists_of_all[6 * link + 3 + i] = spins[q][i];
            }
            for (int i = 0; i < 4; ++i) poses_of_all[7 * link + 3 + i] = poses[q].q[i];
        }
    }
    __syncwarp();
    float* const pose_out = (float*)(body_q_out.data + (long long)world * L);
    float* const twist_out = (float*)(body_qd_out.data + (long long)world * L);
    for (int n = lane; n < 7 * L; n += 32) pose_out[n] = poses_of_all[n];
    for (int n = lane; n < 6 * L; n += 32) twist_out[n] = twists_of_all[n];
"""
"""Chains the lanes up, and writes the poses and velocities of all links."""
