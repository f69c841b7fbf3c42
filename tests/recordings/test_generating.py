# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""``arcgym record`` with the expert in two tiny colons, three episodes each in two worlds."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tiny import write_tiny_colon

from arcgym.cli.main import main
from arcgym.managers import Episode, episode_paths, load_episodes
from arcgym.recordings.generating import clean
from arcgym.sensors.truth_images import LABELS

SIZE = 24
OPTIONS = [
    *("--task", "ARC-Descending-Capsule", "--agent", "expert", "--episodes", "3", "--num_envs", "2"),
    *("--device", "cpu", "--seed", "5", "--size", str(SIZE), "env.start=rest", "env.episode_length_s=4.0"),
    *("env.scene.camera.width=36", "env.scene.camera.height=36"),
]


@pytest.fixture(scope="module")
def colons(tmp_path_factory) -> list[Path]:
    """A straight tube and a bent one."""
    folder = tmp_path_factory.mktemp("colons")
    for name in ("straight", "bent"):
        (folder / name).mkdir()
    return [write_tiny_colon(folder / "straight"), write_tiny_colon(folder / "bent", bend=0.6)]


@pytest.fixture(scope="module")
def data(colons, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("data") / "tubes"
    assert main(["record", *OPTIONS, "--images", "--patients", ",".join(map(str, colons)), "--out", str(out)]) == 0
    return out


def test_each_patient_has_its_episodes(data) -> None:
    for name in ("straight", "bent"):
        episodes = list(load_episodes(data / name))
        assert [episode.info["complete"] for episode in episodes] == [True] * 3
        assert {episode.provenance["seed"] for episode in episodes} == {5, 7}
        assert all(episode.info["success"] for episode in episodes)
        assert Path(episodes[0].provenance["stages"]["colon"]["path"]).parent.name == name


def test_pictures_fit_each_other(data) -> None:
    images = {name.removeprefix("images/"): v for name, v in Episode.load(episode_paths(data / "bent")[0]).data.items()}
    length = len(images["actions"])
    assert images["rgb"].shape == (length, SIZE, SIZE, 3) and images["rgb"].dtype == np.uint8
    assert images["depth"].dtype == np.uint16 and images["normal"].dtype == np.int8
    assert images["rays"].shape == (SIZE, SIZE, 3) and set(np.unique(images["label"])) <= set(range(len(LABELS)))
    # Points that two pictures see lie on the same wall: in the tube, 20 mm from its center line at rest.
    seen = images["label"][-1] > 0
    assert seen.mean() > 0.9
    facing = (images["normal"][-1].astype(float) * images["rays"]).sum(axis=-1)[seen]
    assert facing.max() <= 1.0 and facing.min() < -60.0


def test_points_of_pictures_lie_on_the_wall(data) -> None:
    images = {
        name.removeprefix("images/"): v for name, v in Episode.load(episode_paths(data / "straight")[0]).data.items()
    }
    for step in (1, len(images["actions"]) // 2):
        seen = images["label"][step] > 0
        points = images["rays"][seen] * images["depth"][step][seen, None] * 1e-5
        x, y, z, w = images["camera_quat_w_opengl"][step]
        axis = np.array([x, y, z])
        turned = points + 2.0 * np.cross(axis, w * points + np.cross(axis, points))
        world = turned + images["camera_pos_w"][step]
        from_axis = np.linalg.norm(world[:, :2], axis=1)
        side = (world[:, 2] > 0.02) & (world[:, 2] < 0.18)
        assert abs(np.median(from_axis[side]) - 0.020) < 0.001


def test_the_same_command_goes_on(data, colons, capsys) -> None:
    folder = data / "bent"
    first = episode_paths(folder)[0]
    kept = first.read_bytes()
    episode_paths(folder)[2].rename(folder / "episode_000002.partial.hdf5")
    before = {path: path.stat().st_mtime_ns for path in episode_paths(data / "straight")}
    assert main(["record", *OPTIONS, "--images", "--patients", ",".join(map(str, colons)), "--out", str(data)]) == 0
    assert "1 episodes of" in capsys.readouterr().out and len(episode_paths(folder)) == 3
    assert first.read_bytes() == kept and not list(folder.glob("*.partial.hdf5"))
    assert {path: path.stat().st_mtime_ns for path in episode_paths(data / "straight")} == before
    assert main(["record", *OPTIONS, "--images", "--patients", ",".join(map(str, colons)), "--out", str(data)]) == 0
    assert "recorded: nothing to do, 6 were there" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (("--agent", "zero"), "was made with agent expert, and now it is zero"),
        (("--seed", "6"), "was made with seed 5, and now it is 6"),
        (("env.scene.colon.material=in_situ",), "was made with overrides ['env.start=rest'"),
    ],
)
def test_a_data_set_is_made_by_one_agent(data, colons, capsys, changed: tuple[str, ...], message: str) -> None:
    """It would be kept as it is, and its card would name the new one."""
    card = (data / "README.md").read_text()
    with pytest.raises(SystemExit):
        main(["record", *OPTIONS, "--images", "--patients", str(colons[0]), "--out", str(data), *changed])
    assert message in capsys.readouterr().err and (data / "README.md").read_text() == card


def test_replays_bit_for_bit(data, capsys) -> None:
    assert main(["replay", str(episode_paths(data / "bent")[1]), "--device", "cpu"]) == 0
    assert "the same, bit for bit" in capsys.readouterr().out


def test_data_card_counts_the_files(data) -> None:
    card = (data / "README.md").read_text()
    steps = sum(episode.info["length"] for episode in load_episodes(data / "straight"))
    assert f"| straight | 3 | {steps} |" in card and "6 episodes" in card
    assert f"| `images/rgb` | uint8 (T, {SIZE}, {SIZE}, 3) |" in card and "ARC-Descending-Capsule" in card


def test_incomplete_episodes_are_made_again(data, tmp_path) -> None:
    from arcgym.managers import save_episode

    for number, complete in enumerate((True, False)):
        episode = Episode({"actions": np.zeros((2, 6))}, {"length": 2, "complete": complete})
        save_episode(episode, tmp_path / f"episode_{number:06d}.hdf5")
    assert clean(tmp_path) == 1 and [path.name for path in tmp_path.iterdir()] == ["episode_000000.hdf5"]


@pytest.mark.slow
@pytest.mark.parametrize("stop", [signal.SIGTERM, signal.SIGKILL])
def test_a_run_that_was_stopped_from_outside_goes_on(stop, colons, tmp_path) -> None:
    words = [*OPTIONS, "--images", "--patients", str(colons[0]), "--out", str(tmp_path)]
    command = [sys.executable, "-u", "-m", "arcgym", "record", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as run:
        next(line for line in run.stdout if "2 of 3 episodes" in line)  # the first of two rounds is over
        run.send_signal(stop)
        said = run.stdout.read()
    assert (run.returncode, "the same command goes on" in said) == (
        (143, True) if stop == signal.SIGTERM else (-9, False)
    )
    whole = {path.name: path.read_bytes() for path in episode_paths(tmp_path / "straight")[:2]}
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    assert "recorded: 1 episodes of" in done.stdout and "2 were there" in done.stdout
    episodes = list(load_episodes(tmp_path / "straight"))
    assert [episode.info["complete"] for episode in episodes] == [True] * 3
    assert all((tmp_path / "straight" / name).read_bytes() == content for name, content in whole.items())
    assert not list(tmp_path.rglob("*.partial.hdf5")) and "| straight | 3 |" in (tmp_path / "README.md").read_text()


def test_patients_in_one_batch(colons, tmp_path, capsys) -> None:
    words = ["record", *OPTIONS, "--patients", ",".join(map(str, colons)), "--out", str(tmp_path), "--together"]
    assert main([*words, "--num_envs", "3"]) == 0
    episodes = list(load_episodes(tmp_path / "together"))
    drawn = [episode.info["patient"] for episode in episodes]
    assert len(episodes) == 6 and set(drawn) == {"straight", "bent"}
    assert all(
        Path(one.provenance["stages"]["colon"]["path"]).parent.name == name
        for name, one in zip(drawn, episodes, strict=True)
    )
    assert f"| bent | {drawn.count('bent')} |" in (tmp_path / "README.md").read_text()
    bent = episode_paths(tmp_path / "together")[drawn.index("bent")]
    assert main(["replay", str(bent), "--device", "cpu"]) == 0


def test_unknown_patients_are_named(capsys) -> None:
    with pytest.raises(SystemExit):
        main(["record", *OPTIONS, "--patients", "colon_11"])
    assert "'colon_11', which is no stage file. Did you mean 'colon_1'" in capsys.readouterr().err
