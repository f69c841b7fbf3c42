# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A drive that was cut off goes on: capsules in two straight tubes, two worlds of each."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch
from tiny import write_tiny_colon
from tiny_sim import TinySim

from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import SimulationCfg
from arcgym.start_states import Drive
from arcgym.start_states.halts import Halt, go_on, halt_of


def scene_of(folder: Path, worlds: int) -> InteractiveScene:
    tube, paths = TinySim(folder), []
    for name, length in (("short", 0.20), ("long", 0.22)):
        (folder / name).mkdir(exist_ok=True)
        paths.append(str(write_tiny_colon(folder / name, length=length)))
    cfg = InteractiveSceneCfg(
        num_envs=worlds, colon=tube.colon_cfg(usd_path=paths, rigid=True), endoscope=tube.scope_cfg("capsule")
    )
    return InteractiveScene(cfg, SimulationCfg())


def cut_off(drive: Drive, steps: int) -> None:
    """Drive for some control steps."""

    def report(drive: Drive) -> None:
        if drive.time > 0.1 * steps - 0.05:
            for route in drive.routes:
                route.problem = "cut off"

    drive.run("sigmoid", report, settled=False)


def test_a_drive_goes_on_with_more_worlds_from_where_it_was_cut_off(tmp_path: Path) -> None:
    drive = Drive(scene_of(tmp_path, 4))
    cut_off(drive, 4)
    for patient in (0, 1):
        halt_of(drive, patient).save(tmp_path / f"{patient}.npz")
    scene = scene_of(tmp_path, 6)
    later = Drive(scene)
    for patient in (0, 1):
        halt = Halt.load(tmp_path / f"{patient}.npz")
        assert halt is not None and halt.time == pytest.approx(0.4)
        go_on(later, patient, halt)
    arc = scene["endoscope"].data.tip_arc_length
    assert torch.equal(arc, drive.scene["endoscope"].data.tip_arc_length[[0, 1, 2, 3, 0, 1]])
    assert torch.equal(later.expert.speed[:4], drive.expert.speed)
    assert later.expert.roll[4] != drive.expert.roll[0]
    assert [list(route.entries) for route in later.routes] == [["rectum"], ["rectum"]]
    assert [len(places) for places in later.trail.places] == [len(places) for places in drive.trail.places] != [0, 0]
    arrived = later.run("sigmoid", settled=False)
    assert arrived and all(route.entries["sigmoid"].time > 0.45 for route in later.routes)


def test_another_patient_is_refused(tmp_path: Path) -> None:
    drive = Drive(scene_of(tmp_path, 2))
    cut_off(drive, 1)
    with pytest.raises(ValueError, match="The drive that was cut off is not of long with"):
        go_on(Drive(scene_of(tmp_path, 2)), 1, halt_of(drive, 0))


def test_a_missing_file_is_no_drive(tmp_path: Path) -> None:
    assert Halt.load(tmp_path / "none.npz") is None


def test_worlds_of_a_patient_that_is_done_go_to_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drive = Drive(scene_of(tmp_path, 4))
    monkeypatch.setattr(drive.expert, "PERIOD", 2)

    def report(drive: Drive) -> None:
        drive.routes[0].problem = "cut off"

    assert not drive.run("sigmoid", report)
    assert drive.pool.owner.tolist() == drive.scene.colon.data.patient.tolist() == [1] * 4
    assert list(drive.routes[1].states) == ["rectum", "sigmoid"] and list(drive.routes[0].states) == ["rectum"]
    length = drive.routes[1].bounds["sigmoid"][0]
    assert drive.scene["endoscope"].data.tip_arc_length.max() > length  # settling has put the worlds back
