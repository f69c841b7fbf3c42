# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""CUDA code that prepares a link: :func:`.scope_kernels.prepare_links` as a part of :mod:`.aba_cuda_code`.

The order of the operations is that of the kernel, so that the two differ by rounding alone.
"""

from __future__ import annotations

PREPARE = """
    auto anchor = [&](int link, const transform& pose) {
        return transform_point(pose, link == 0 && free_root ? chain.com.data[0] : chain.child_frame.data[link].p);
    };
    auto skew_times = [](const vec3& r, const mat33& m) {
        mat33 out;
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const int x = (i + 1) % 3, y = (i + 2) % 3;
                out.data[i][j] = r[x] * m.data[y][j] - r[y] * m.data[x][j];
            }
        return out;
    };
    auto prepare_axes = [&](int link, const vec3& here) {
        const long long row = (long long)world * L + link;
        transform parent = chain.parent_frame.data[link];
        vec3 arm(0.0f, 0.0f, 0.0f), spin(0.0f, 0.0f, 0.0f);
        if (link > 0) {
            const transform before = body_q.data[row - 1];
            parent = transform_multiply(before, parent);
            arm = here - anchor(link - 1, before);
            spin = spatial_bottom(body_qd.data[row - 1]);
        }
        quat rot = parent.q;
        vec3 drift_lin = cross(spin, cross(spin, arm)), drift_ang(0.0f, 0.0f, 0.0f);
        if (link > 0 || !free_root)
            for (int d = starts[link]; d < starts[link + 1]; ++d) {
                float* const joint = joints[d];
                const vec3 own(joint[0], joint[1], joint[2]), axis = quat_rotate(rot, own), rate = axis * joint[V];
                for (int i = 0; i < 3; ++i) joint[i] = axis[i];
                if (joint[SLIDES] != 0.0f) drift_lin = drift_lin + 2.0f * cross(spin, rate);
                else {
                    drift_ang = drift_ang + cross(spin, rate);
                    spin = spin + rate;
                    rot = mul(rot, quat_from_axis_angle(own, joint[X]));
                }
            }
        for (int i = 0; i < 3; ++i) {
            links[link][i] = arm[i];
            links[link][DRIFT + i] = drift_lin[i];
            links[link][DRIFT + 3 + i] = drift_ang[i];
        }
    };
    // force, ll, la, torque, aa of a link's load, as in a LoadSum, and one more: this lane's of 32 links in a row
    auto load_of = [&](int link, float* load) {
        const float4* const row = (const float4*)loads.fours.data + 8 * ((long long)world * L + link);
        #pragma unroll
        for (int n = 0; n < 7; ++n) {
            float4 four = make_float4(0.0f, 0.0f, 0.0f, 0.0f);
            if (loaded >> link / 32 & 1) four = row[n];
            load[4 * n] = four.x, load[4 * n + 1] = four.y, load[4 * n + 2] = four.z, load[4 * n + 3] = four.w;
        }
    };
    auto symmetric = [](const float* of) {  // xx, yy, zz, yz, zx, xy
        return mat33(of[0], of[5], of[4], of[5], of[1], of[3], of[4], of[3], of[2]);
    };
    auto general = [](const float* of) { return mat33(of[0], of[1], of[2], of[3], of[4], of[5], of[6], of[7], of[8]); };
    auto prepare = [&](int link, float* to) {
        const long long row = (long long)world * L + link;
        const transform pose = body_q.data[row];
        const vec3 omega = spatial_bottom(body_qd.data[row]);
        const spatial_vector push = body_f.data[row], resists = *address(resistance, link, world);
        float load[28];
        load_of(link, load);
        const float mass = chain.mass.data[link];
        const vec3 here = anchor(link, pose), lever = transform_point(pose, chain.com.data[link]) - here;
        mat33 ll = symmetric(load + LL);
        const mat33 la = general(load + LA);
        mat33 aa = add(symmetric(load + AA), diag(spatial_bottom(resists)));
        vec3 force = vec3(load[0], load[1], load[2]) - spatial_top(push);
        vec3 torque = vec3(load[TORQUE], load[TORQUE + 1], load[TORQUE + 2]) - spatial_bottom(push);
        for (int i = 0; i < 3; ++i) ll.data[i][i] = ll.data[i][i] + resists[i] + mass;
        const mat33 rot = quat_to_matrix(pose.q);
        const mat33 inertia = mul(mul(rot, chain.inertia.data[link]), transpose(rot));
        const vec3 centripetal = cross(omega, cross(omega, lever));
        aa = add(aa, inertia);
        force = force + mul(ll, centripetal);
        torque = torque + (mul(transpose(la), centripetal) + cross(omega, mul(inertia, omega)));
        // from the center of mass to the anchor
        const mat33 moved_la = add(la, transpose(skew_times(lever, ll)));
        const mat33 moved_aa = add(add(aa, skew_times(lever, moved_la)), transpose(skew_times(lever, la)));
        torque = torque + cross(lever, force);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                to[3 * i + j] = ll.data[i][j];
                to[9 + 3 * i + j] = moved_la.data[i][j];
                to[18 + 3 * i + j] = moved_aa.data[i][j];
            }
            to[FORCE + i] = force[i];
            to[FORCE + 3 + i] = torque[i];
        }
        *address(work.lever, link, world) = lever;
        prepare_axes(link, here);
    };
"""
"""Functions that write a link's matrices and bias to a row of ``room``, and the rest to ``links`` and ``joints``."""
