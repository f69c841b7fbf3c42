# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The truth about pixels in a straight tube, where a reader can work it out."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from tiny import tiny_colon_stage
from tube_scene import RADIUS, TubeScene

from arcgym.assets.patient import patient_of_stage
from arcgym.sensors import EndoscopeCamera, EndoscopeCameraCfg
from arcgym.sensors.truth_images import LABELS, TruthImages, vertex_labels

SIZE = (40, 32)


@pytest.fixture
def drawn(tmp_path):
    """Pictures from the axis of the tube, and the rays."""
    scene = TubeScene(tmp_path)
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=16, height=16))
    camera.initialize(scene)
    camera.update()
    patient = patient_of_stage(tiny_colon_stage(texture_folder=tmp_path))
    visual = scene["colon"].patients[0].visual
    line = dataclasses.replace(
        patient.centerline,
        points=np.linspace([0, 0, 0], [0, 0, 0.3], 41).astype(np.float32),
        radius=np.full(41, RADIUS, np.float32),
    )
    truth = TruthImages(camera, (dataclasses.replace(patient, visual=visual, centerline=line),), SIZE)
    images = truth.draw(scene["endoscope"].camera_pose_wp)
    return {name: image[0].numpy() for name, image in images.items()}, truth.rays


def test_distance_and_normal_of_a_tube(drawn):
    """From the axis a ray at the angle theta meets the wall after R / sin(theta), and the normal points at the axis."""
    images, rays = drawn
    across = rays[..., :2]
    sine = np.linalg.norm(across, axis=-1)
    seen = (RADIUS / sine < 0.1) & (images["label"] > 0)
    assert seen.mean() > 0.8 and images["rgb"].shape == (32, 40, 3)
    np.testing.assert_allclose(images["depth"][seen], (RADIUS / sine)[seen], rtol=0.02)
    inward = np.zeros_like(rays)
    inward[..., :2] = -across / sine[..., None]
    assert (images["normal"] * inward).sum(axis=-1)[seen].min() > 0.99
    assert set(np.unique(images["label"][seen])) == {LABELS.index("mucosa")}


def test_kinds_of_surface(tmp_path):
    """In a tube of 20 mm: 16.9 mm from the axis is a fold, 17.1 mm is not; tint marks polyps and diverticula."""
    patient = patient_of_stage(tiny_colon_stage(texture_folder=tmp_path))
    visual = patient.visual
    points, tint = visual.points.copy(), visual.tint.copy()
    row = np.abs(points[:, 2] - 0.1) < 1e-4
    other = np.abs(points[:, 2] - 0.15) < 1e-4
    points[row, :2] *= 0.0169 / 0.020
    points[other, :2] *= 0.0171 / 0.020
    tint[0], tint[1], tint[2] = 0.8, -0.8, 0.05
    labels = vertex_labels(dataclasses.replace(patient, visual=dataclasses.replace(visual, points=points, tint=tint)))
    assert row.sum() > 10 and other.sum() > 10
    assert [LABELS[label] for label in labels[:3]] == ["polyp", "diverticulum", "mucosa"]
    assert set(labels[row]) == {LABELS.index("fold")} and set(labels[other]) == {LABELS.index("mucosa")}


def test_a_camera_in_the_open_sees_nothing(tmp_path):
    scene = TubeScene(tmp_path)
    scene.move_camera(0, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0])
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=16, height=16, far=0.5))
    camera.initialize(scene)
    camera.update()
    truth = TruthImages(camera, (patient_of_stage(tiny_colon_stage(texture_folder=tmp_path)),), SIZE)
    images = truth.draw(scene["endoscope"].camera_pose_wp)
    assert (images["label"] == 0).all() and (images["depth"] == 0.5).all() and (images["normal"] == 0.0).all()


def test_the_own_shaft_hides_the_wall(tmp_path):
    """A shaft of 4 mm radius lies across the axis 30 mm ahead: the ray along the axis meets it after 26 mm."""
    scene = TubeScene(tmp_path)
    # links along X (a quarter turn about Y), 30 mm ahead of the camera; the last one, which carries it, is not drawn
    turn = [0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]
    poses = torch.tensor([[[0.0, 0.0, 0.18, *turn], [0.0, 0.0, 0.155, *turn]]], dtype=torch.float32)
    scene["endoscope"].data = SimpleNamespace(body_pos_w=poses[..., :3], body_quat_w=poses[..., 3:])
    scene["endoscope"].stage.link_radius, scene["endoscope"].stage.link_length = [0.004, 0.004], [0.02, 0.02]
    camera = EndoscopeCamera(EndoscopeCameraCfg(width=16, height=16))
    camera.initialize(scene)
    camera.update()
    stage = patient_of_stage(tiny_colon_stage(texture_folder=tmp_path))
    patients = (dataclasses.replace(stage, visual=scene["colon"].patients[0].visual),)
    truth = TruthImages(camera, patients, (41, 41), 1, scene["endoscope"])
    images = {name: image[0].numpy() for name, image in truth.draw(scene["endoscope"].camera_pose_wp).items()}
    shaft = images["label"] == LABELS.index("scope")
    assert shaft[20, 20] and images["depth"][20, 20] == pytest.approx(0.026, abs=1e-5)
    np.testing.assert_allclose(images["normal"][20, 20], [0.0, 0.0, 1.0], atol=1e-5)
    # 20 mm long with rounded ends of 4 mm, 8 mm thick: wider than high, the wall beside it is as before
    wide, high = shaft.any(axis=0).sum(), shaft.any(axis=1).sum()
    assert 2.5 < wide / high < 4.5 and (images["label"][0] == LABELS.index("mucosa")).all()
    plain = TruthImages(camera, patients, (41, 41), 1).draw(scene["endoscope"].camera_pose_wp)
    np.testing.assert_array_equal(images["depth"][~shaft], plain["depth"][0].numpy()[~shaft])
    assert images["rgb"][shaft].mean() < 0.7 * images["rgb"][~shaft].mean()  # black
