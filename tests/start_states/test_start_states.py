# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Start states in a tube of 0.2 m with five segments of 40 mm: made once, kept, made anew when something changed."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from tiny import write_tiny_colon
from tiny_sim import TinySim

from arcgym import start_states
from arcgym.assets import GasCfg
from arcgym.experts import ExpertBase, PullExpert
from arcgym.scene import InteractiveSceneCfg
from arcgym.scene.interactive_scene import InteractiveScene
from arcgym.sim import LoopFrictionCfg, SimulationCfg
from arcgym.sim.snapshot import Snapshot, SnapshotSet
from arcgym.start_states import StartStateError, find, store
from arcgym.start_states.ahead import make_ahead
from arcgym.start_states.key import settings_of
from arcgym.start_states.making import key_of
from arcgym.utils.paths import cache_dir


class HaltingExpert(PullExpert):
    """Stops at 60 mm, in the sigmoid."""

    def act(self) -> None:
        super().act()
        if float(self.scene["endoscope"].data.tip_arc_length.max()) > 0.06:
            self.scene["endoscope"].set_tip_velocity_command(torch.zeros(1, 3), torch.zeros(1, 3))


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> TinySim:
    return TinySim(tmp_path_factory.mktemp("tube"))


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def scene_cfg(tiny: TinySim, **scope) -> InteractiveSceneCfg:
    colon = tiny.colon_cfg(rigid=True)
    return InteractiveSceneCfg(num_envs=2, colon=colon, endoscope=tiny.scope_cfg("capsule", **scope))


def build(tiny: TinySim, sim: SimulationCfg | None = None, **scope) -> InteractiveScene:
    return InteractiveScene(scene_cfg(tiny, **scope), sim or SimulationCfg())


def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Segments that are driven to from here on."""
    made: list[str] = []
    original = find.make_all
    monkeypatch.setattr(find, "make_all", lambda a, b, until, of: made.append(until) or original(a, b, until, of))
    return made


def test_a_missing_state_is_made_and_kept(tiny: TinySim, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = counted(monkeypatch)
    scene = build(tiny)
    states = start_states.ensure(scene, "sigmoid")
    assert states.names == ("rectum", "sigmoid") and made == ["sigmoid"]
    scene.sim.load_snapshots(states)
    scene.sim.write_snapshot(states.index("sigmoid"))
    scene.sim.forward()
    arc = scene["endoscope"].data.tip_arc_length
    assert arc.tolist() == pytest.approx([0.045, 0.045], abs=0.005)  # a control step and the lead of the pull
    assert not scene["endoscope"].data.joint_vel.any()
    again = start_states.ensure(build(tiny), "sigmoid")
    assert again.names == states.names and made == ["sigmoid"]
    assert [file.suffix for file in sorted((cache / "start_states" / tiny.folder.name).iterdir())] == [".lock", ".npz"]


def test_a_segment_farther_on_is_driven_to(tiny: TinySim, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = counted(monkeypatch)
    start_states.ensure(build(tiny), "sigmoid")
    states = start_states.ensure(build(tiny), "descending")
    assert states.names == ("rectum", "sigmoid", "descending") and made == ["sigmoid", "descending"]


def test_what_changed_is_said_and_made_anew(tiny: TinySim, cache: Path, monkeypatch, capsys) -> None:
    made = counted(monkeypatch)
    start_states.ensure(build(tiny), "sigmoid")
    soft = SimulationCfg()
    soft.contact.stiffness = 1500.0
    start_states.ensure(build(tiny, soft, drives={"tip": {"force_limit": 0.9}}), "sigmoid")
    assert made == ["sigmoid", "sigmoid"]
    assert "are stale: robot and solver changed; making new ones" in capsys.readouterr().err


def test_the_device_changes_nothing(tiny: TinySim) -> None:
    scene = build(tiny)
    before = key_of(scene)
    scene.sim.cfg.device, scene.sim.cfg.use_graph = "cuda:3", False
    assert key_of(scene) == before


def test_damping_of_deep_contacts_is_no_part_of_the_key(tiny: TinySim) -> None:
    scene = build(tiny)
    before = key_of(scene)
    scene.sim.cfg.contact.deep_damping = 0.0
    assert key_of(scene) == before


def test_all_of_the_steps_damping_is_no_part_of_the_key(tiny: TinySim) -> None:
    scene = build(tiny)
    before = key_of(scene)
    assert "step_damping" not in settings_of(scene.sim.cfg)["contact"]
    assert "bends" not in settings_of(SimulationCfg(loops=LoopFrictionCfg(enabled=True)))["loops"]
    scene.sim.cfg.contact.step_damping = 0.5
    assert key_of(scene).changed({**vars(before)}) == ["solver"]


def test_gas_takes_the_states_that_were_made_without_it(tiny: TinySim, cache: Path, monkeypatch) -> None:
    start_states.ensure(build(tiny), "sigmoid")
    made = counted(monkeypatch)
    cfg = scene_cfg(tiny)
    cfg.colon.gas = GasCfg(enabled=True)
    scene = InteractiveScene(cfg, SimulationCfg())
    states = start_states.ensure(scene, "sigmoid")
    assert made == []
    scene.sim.load_snapshots(states)
    scene.sim.write_snapshot(states.index("sigmoid"))
    scene.sim.forward()
    assert scene.sim.colon.data.lumen_pressure[0] == pytest.approx(cfg.colon.gas.imaging_pressure)
    farther = start_states.ensure(scene, "descending")  # is made without gas, too
    assert made == ["descending"] and not any(name.startswith("gas.") for name in farther.snapshots[0].arrays)


def test_a_drive_that_does_not_arrive_keeps_what_it_passed(tiny: TinySim, cache: Path, monkeypatch) -> None:
    made = counted(monkeypatch)
    for _ in range(2):  # the second finds the failure in the file and does not drive again
        with pytest.raises(StartStateError) as error:
            start_states.ensure(build(tiny, expert=HaltingExpert), "descending")
        message = str(error.value)
        assert "capsule_6.usda does not reach the descending" in message and "0.06 m far, into the sigmoid" in message
        assert "no progress in 30 s" in message and "rectum, sigmoid can be used (env.segment=sigmoid)" in message
    assert made == ["descending"]
    assert start_states.ensure(build(tiny, expert=HaltingExpert), "sigmoid").names == ("rectum", "sigmoid")


def test_a_robot_without_expert_is_told_what_to_do(tiny: TinySim, cache: Path) -> None:
    with pytest.raises(StartStateError, match="has no scripted expert: set EndoscopeCfg.expert.*env.start=rest"):
        start_states.ensure(build(tiny, expert=None), "sigmoid")


def test_an_unknown_segment_is_refused(tiny: TinySim, cache: Path) -> None:
    with pytest.raises(StartStateError, match="segment 'sigmod' is not in .*Did you mean 'sigmoid'"):
        make_ahead(scene_cfg(tiny), SimulationCfg(), "sigmod", 0.04, 10.0)


def test_a_file_that_cannot_be_read_is_made_anew(tiny: TinySim, cache: Path, monkeypatch) -> None:
    made = counted(monkeypatch)
    scene = build(tiny)
    path = store.in_cache(scene.colon, scene.endoscope, key_of(scene))
    path.parent.mkdir(parents=True)
    path.write_bytes(b"half a file")
    assert start_states.ensure(scene, "sigmoid").names == ("rectum", "sigmoid") and made == ["sigmoid"]


def test_a_file_that_is_damaged_is_made_anew(tmp_path: Path) -> None:
    """One byte after the other is another: whatever the archive, LZMA or the arrays say of it, there are no states."""
    states = SnapshotSet(("rectum",), (Snapshot({"joint_q": np.arange(40.0)}),), "here")
    states.save(tmp_path / "states.npz")
    content = (tmp_path / "states.npz").read_bytes()
    found = []
    for place in range(0, len(content), 7):
        damaged = bytearray(content)
        damaged[place] ^= 0xFF
        (tmp_path / "damaged.npz").write_bytes(damaged)
        found.append(store.load(tmp_path / "damaged.npz"))
    assert store.load(tmp_path / "states.npz") is not None and found.count(None) > len(found) // 2


def test_a_cache_that_cannot_be_written_does_not_stop_the_run(tiny: TinySim, tmp_path, monkeypatch, capsys) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("ARCGYM_CACHE", str(tmp_path / "file"))
    assert "sigmoid" in start_states.ensure(build(tiny), "sigmoid").names
    assert "cannot be kept" in capsys.readouterr().err


def test_states_beside_the_colon_come_first(tmp_path: Path, cache: Path, monkeypatch, capsys) -> None:
    tube = TinySim(tmp_path)
    path = make_ahead(scene_cfg(tube), SimulationCfg(), "sigmoid", 0.04, 10.0, beside_colon=True)
    assert path == tmp_path / "snapshots" / "capsule_6.npz"
    made = counted(monkeypatch)
    assert start_states.ensure(build(tube), "sigmoid").names == ("rectum", "sigmoid") and made == []
    tube.scope_cfg("proximal", 8)
    path.rename(path.with_name("proximal_8.npz"))  # states of another scope
    other = InteractiveSceneCfg(num_envs=1, colon=tube.colon_cfg(), endoscope=tube.scope_cfg("proximal", 8))
    assert find.find_stored(InteractiveScene(other, SimulationCfg()), "sigmoid") is None
    assert "do not fit: another wall mesh or endoscope" in capsys.readouterr().err


def test_states_made_ahead_are_not_made_twice(tiny: TinySim, cache: Path, capsys) -> None:
    args = (scene_cfg(tiny), SimulationCfg(), "sigmoid", 0.04, 10.0)
    path = make_ahead(*args)
    written = path.stat().st_mtime_ns
    assert make_ahead(*args) == path and path.stat().st_mtime_ns == written
    assert "are there (--force" in capsys.readouterr().err
    make_ahead(*args, force=True)
    assert path.stat().st_mtime_ns > written


def test_a_shorter_drive_leaves_a_longer_file(tiny: TinySim, cache: Path, capsys) -> None:
    make_ahead(scene_cfg(tiny), SimulationCfg(), "descending", 0.04, 10.0)
    path = make_ahead(scene_cfg(tiny), SimulationCfg(), "sigmoid", 0.04, 10.0, force=True)
    assert "has more and is kept" in capsys.readouterr().err
    assert store.load(path).names == ("rectum", "sigmoid", "descending")


def test_the_first_world_that_arrives_gives_the_state(tiny: TinySim) -> None:
    class Uneven(ExpertBase):
        def act(self) -> None:
            velocity = torch.tensor([[0.0, 0.0, 0.02], [0.0, 0.0, 0.06]])
            self.scene["endoscope"].set_tip_velocity_command(velocity, torch.zeros(2, 3))

    scene = build(tiny, expert=Uneven)
    drive = start_states.Drive(scene)
    assert drive.run("sigmoid")
    arcs = scene["endoscope"].data.tip_arc_length
    assert arcs[0] < 0.04 < arcs[1]
    height = drive.states["sigmoid"].arrays["joint_q"][2]
    assert 0.04 - 0.010 < height < 0.05  # the tip is 10 mm ahead of the capsule's center


def test_make_returns_states_and_file(tiny: TinySim, cache: Path) -> None:
    states, path = start_states.make(scene_cfg(tiny), SimulationCfg(), "sigmoid", speed=0.06)
    assert states.about["problem"] == "" and states.about["speed"] == 0.06 and path.is_file()


def test_states_lie_beside_the_colon_by_robot_and_tissue(tmp_path: Path) -> None:
    patient = SimpleNamespace(path=tmp_path / "colon.usda")
    colon = SimpleNamespace(patients=[patient], cfg=SimpleNamespace(material="in_situ"))
    scope = SimpleNamespace(path=Path("magnetic.usda"))
    assert store.find_beside_colon(colon, scope) is None
    default, own = (tmp_path / "snapshots" / name for name in ("magnetic.npz", "magnetic_in_situ.npz"))
    default.parent.mkdir()
    for path in (default, own):
        path.touch()
        assert store.find_beside_colon(colon, scope) == path


def test_the_cache_is_the_users(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("ARCGYM_CACHE", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_dir() == tmp_path / "arcgym"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_dir() == Path.home() / ".cache" / "arcgym"
    monkeypatch.setenv("ARCGYM_CACHE", "~/elsewhere")
    assert cache_dir() == Path.home() / "elsewhere"


def test_every_patient_starts_from_states_of_its_own(tmp_path: Path, cache: Path) -> None:
    tube, paths = TinySim(tmp_path), []
    for name, length in (("short", 0.20), ("long", 0.22)):
        (tmp_path / name).mkdir()
        paths.append(str(write_tiny_colon(tmp_path / name, length=length)))
    colon = tube.colon_cfg(usd_path=paths, rigid=True)
    cfg = InteractiveSceneCfg(num_envs=2, colon=colon, endoscope=tube.scope_cfg("capsule"))
    scene = InteractiveScene(cfg, SimulationCfg())
    sets = find.ensure_all(scene, "sigmoid")
    assert sets[0].fingerprint != sets[1].fingerprint
    scene.sim.load_snapshots([states.only(["sigmoid"]) for states in sets])
    scene.sim.write_snapshot(0)
    scene.sim.forward()
    starts = scene["colon"].data.segment_spans[:, 1, 0]
    assert starts.tolist() == pytest.approx([0.20 / 5, 0.22 / 5], abs=0.006)
    assert (scene["endoscope"].data.tip_arc_length - starts).abs().max() < 0.01
    assert sorted(path.parent.name for path in (cache / "start_states").rglob("*.npz")) == ["long", "short"]


def test_patients_in_which_the_expert_does_not_arrive_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    patients = [SimpleNamespace(name=f"p{k}") for k in range(3)]
    scene = SimpleNamespace(
        colon=SimpleNamespace(patients=patients), endoscope=SimpleNamespace(path=Path("robot.usda"))
    )
    arrived, gave_up = SimpleNamespace(names=("rectum", "sigmoid")), SimpleNamespace(names=("rectum",))
    monkeypatch.setattr(find, "find_stored", lambda scene, segment, patient: arrived if patient == 1 else None)
    monkeypatch.setattr(find, "_make", lambda scene, segment, missing: dict.fromkeys(missing, gave_up))
    with pytest.raises(StartStateError, match=r"robot.usda does not reach the sigmoid of 2 of 3 patients \(p0, p2\)"):
        find.ensure_all(scene, "sigmoid")
