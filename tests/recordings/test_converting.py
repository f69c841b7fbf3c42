# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Three episodes made up so that a reader knows each sample, turned into other layouts and loaded back."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import imageio.v3 as iio
import numpy as np
import pytest

from arcgym.cli.main import main
from arcgym.managers import Episode, load_episodes, save_episode
from arcgym.recordings.lerobot_stats import FeatureStats, merged

LENGTHS = (5, 4, 3)


def made_up(number: int, length: int) -> Episode:
    """Step t of episode k: action (t, k), tip at (t, 0, k) after it, a picture of brightness 20 t, reward t / 10."""
    t = np.arange(length, dtype=np.float32)
    zero = np.zeros_like(t)
    data = {
        "actions": np.stack([t, zero + number], axis=1),
        "poses/tip_pos_w": np.stack([t, zero, zero + number], axis=1),
        "images/rgb": np.broadcast_to((20 * t).astype(np.uint8)[:, None, None, None], (length, 16, 32, 3)).copy(),
        "rewards/total": t / 10,
        "initial_state/joint_q": np.zeros(length),
    }
    info = {"length": length, "success": number != 1, "complete": True, "step_dt": 0.1, "env_id": 0}
    steps = frozenset(name for name in data if not name.startswith("initial_state"))
    return Episode(data, info, {"task": "ARC-Made-Up", "step_dt": 0.1}, {}, steps)


@pytest.fixture(scope="module")
def source(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("source")
    for number, length in enumerate(LENGTHS):
        save_episode(made_up(number, length), folder / "tube" / f"episode_{number:06d}.hdf5")
    return folder


def convert(source: Path, out: Path, *words: str) -> Path:
    assert not main(["convert", str(source), str(out), "--state", "poses/tip_pos_w", *words])
    return out


@pytest.fixture(scope="module")
def lerobot_folder(source, tmp_path_factory) -> Path:
    return convert(source, tmp_path_factory.mktemp("out") / "set", "--to", "lerobot")


def test_robomimic_samples(source, tmp_path) -> None:
    path = convert(source, tmp_path / "demos.hdf5", "--to", "robomimic")
    with h5py.File(path) as file:
        demo = file["data/demo_0"]
        # The first of five steps has nothing recorded before it.
        np.testing.assert_array_equal(demo["actions"][:, 0], [1, 2, 3, 4])
        np.testing.assert_array_equal(demo["obs/state"][:, 0], [0, 1, 2, 3])
        np.testing.assert_array_equal(demo["next_obs/state"][:, 0], [1, 2, 3, 4])
        np.testing.assert_array_equal(demo["obs/endoscope_image"][:, 0, 0, 0], [0, 20, 40, 60])
        np.testing.assert_array_equal(demo["dones"][:], [0, 0, 0, 1])
        np.testing.assert_allclose(demo["rewards"][:], [0.1, 0.2, 0.3, 0.4])
        assert demo.attrs["num_samples"] == 4 and file["data"].attrs["total"] == 4 + 3 + 2
        assert json.loads(file["data"].attrs["env_args"])["env_name"] == "ARC-Made-Up"
        names = {key: [name.decode() for name in file[f"mask/{key}"]] for key in ("train", "valid")}
    assert names == {"train": ["demo_0", "demo_1"], "valid": ["demo_2"]}


def test_only_successes_and_no_pictures(source, tmp_path) -> None:
    words = ("--to", "robomimic", "--only_successes", "--image", "none")
    with h5py.File(convert(source, tmp_path / "demos.hdf5", *words)) as file:
        assert len(file["data"]) == 2 and list(file["data/demo_0/obs"]) == ["state"]
    joined = convert(source, tmp_path / "own.hdf5", "--to", "arcgym", "--only_successes")
    assert [episode.info["length"] for episode in load_episodes(joined)] == [5, 3]


def test_lerobot_layout(lerobot_folder) -> None:
    pq = pytest.importorskip("pyarrow.parquet")
    info = json.loads((lerobot_folder / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["total_episodes"], info["total_frames"]) == ("v3.0", 10, 3, 9)
    assert info["features"]["observation.state"]["names"] == ["tip_pos_w_0", "tip_pos_w_1", "tip_pos_w_2"]
    episodes = pq.read_table(lerobot_folder / "meta" / "episodes" / "chunk-000" / "file-000.parquet").to_pylist()
    assert [(row["dataset_from_index"], row["dataset_to_index"]) for row in episodes] == [(0, 4), (4, 7), (7, 9)]
    for number, row in enumerate(episodes):
        path = info["data_path"].format(chunk_index=row["data/chunk_index"], file_index=row["data/file_index"])
        frames = pq.read_table(lerobot_folder / path).to_pylist()
        assert [frame["index"] for frame in frames] == list(range(row["dataset_from_index"], row["dataset_to_index"]))
        assert [frame["action"] for frame in frames] == [[t + 1.0, number] for t in range(row["length"])]
        assert frames[-1]["next.done"] and frames[-1]["next.success"] == (number != 1)
    tasks = pq.read_table(lerobot_folder / "meta" / "tasks.parquet").to_pydict()
    assert tasks == {"task_index": [0], "__index_level_0__": ["ARC-Made-Up"]}


def test_lerobot_videos_hold_the_pictures_before_the_actions(lerobot_folder) -> None:
    video = lerobot_folder / "videos" / "observation.images.endoscope" / "chunk-000" / "file-001.mp4"
    frames = iio.imread(video, plugin="FFMPEG")
    np.testing.assert_allclose(frames[:, 8, 16, 0].astype(int), [0, 20, 40], atol=4)


def test_lerobot_statistics(lerobot_folder) -> None:
    stats = json.loads((lerobot_folder / "meta" / "stats.json").read_text())
    # Actions 1, 2, 3, 4 and 1, 2, 3 and 1, 2.
    actions = np.array([1, 2, 3, 4, 1, 2, 3, 1, 2])
    assert stats["action"]["mean"][0] == pytest.approx(actions.mean())
    assert stats["action"]["std"][0] == pytest.approx(actions.std())
    assert (stats["action"]["min"][0], stats["action"]["max"][0], stats["action"]["count"]) == (1, 4, [9])
    assert np.shape(stats["observation.images.endoscope"]["mean"]) == (3, 1, 1)


def test_statistics_of_parts_are_those_of_the_whole() -> None:
    values = np.random.default_rng(0).normal(size=(10, 2))
    whole, parts = FeatureStats.of(values), [{"x": FeatureStats.of(part)} for part in (values[:3], values[3:])]
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(getattr(merged(parts)["x"], name), getattr(whole, name))


LEROBOT = """
import json, sys
try:
    from lerobot.datasets.lerobot_dataset import LeRobotDataset
except ImportError:
    sys.exit(SKIPS)
loaded = LeRobotDataset("local/set", root=sys.argv[1], video_backend="pyav")
print(json.dumps({
    "shape": [loaded.num_episodes, loaded.num_frames, loaded.fps],
    "file": loaded.meta.get_video_file_path(1, IMAGE).name,
    "task": loaded[5]["task"], "most": loaded.meta.stats["action"]["max"].tolist(),
    "action": loaded[5]["action"].tolist(), "time": float(loaded[5]["timestamp"]),
    "brightness": 255.0 * float(loaded[5][IMAGE].mean()), "picture": list(loaded[5][IMAGE].shape),
}))
"""
ROBOMIMIC = """
import json, sys
try:
    from robomimic.utils.dataset import SequenceDataset
except ImportError:
    sys.exit(SKIPS)
keys = {"obs_keys": ("state", "endoscope_image"), "dataset_keys": ("actions", "rewards", "dones")}
parts = {"seq_length": 2, "frame_stack": 1, "filter_by_attribute": "train"}
loaded = SequenceDataset(sys.argv[1], hdf5_use_swmr=False, **parts, **keys)
item = loaded[0]
print(json.dumps({
    "count": len(loaded), "actions": item["actions"].tolist(), "state": item["obs"]["state"].tolist(),
    "picture": list(item["obs"]["endoscope_image"].shape), "rewards": item["rewards"].tolist(),
}))
"""
SKIPS = 77


def loaded_by(library: str, code: str, path: Path) -> dict:
    """Return what a program says that loads a data set; ``ARCGYM_LEROBOT_PYTHON`` and such name another Python."""
    python = os.environ.get(f"ARCGYM_{library.upper()}_PYTHON", sys.executable)
    head = f"SKIPS, IMAGE = {SKIPS}, 'observation.images.endoscope'\n"
    done = subprocess.run([python, "-c", head + code, str(path)], capture_output=True, text=True, timeout=300)
    if done.returncode == SKIPS:
        pytest.skip(f"{python} has no {library}")
    assert not done.returncode, done.stderr[-2000:]
    return json.loads(done.stdout.strip().splitlines()[-1])


def test_lerobot_itself_loads_it(lerobot_folder) -> None:
    said = loaded_by("lerobot", LEROBOT, lerobot_folder)
    assert (said["shape"], said["task"], said["file"]) == ([3, 9, 10], "ARC-Made-Up", "file-001.mp4")
    assert (said["action"], said["most"], said["picture"]) == ([2.0, 1.0], [4.0, 2.0], [3, 16, 32])
    # The second sample of the second episode: its picture is that after step 1, of brightness 20.
    assert said["time"] == pytest.approx(0.1) and said["brightness"] == pytest.approx(20.0, abs=3.0)


def test_robomimic_itself_loads_it(source, tmp_path) -> None:
    said = loaded_by("robomimic", ROBOMIMIC, convert(source, tmp_path / "demos.hdf5", "--to", "robomimic"))
    # Episodes 0 and 1 have 4 and 3 samples; a sequence is two of them.
    assert said["count"] == 7 and said["actions"] == [[1.0, 0.0], [2.0, 0.0]]
    assert said["state"] == [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]] and said["picture"] == [2, 16, 32, 3]
    assert said["rewards"] == pytest.approx([0.1, 0.2])


def test_mistakes_are_named_before_anything_is_written(source, tmp_path, capsys) -> None:
    (tmp_path / "there").mkdir()
    for words, message in (
        ([str(tmp_path / "none"), str(tmp_path / "out"), "--to", "lerobot"], "There is no recording"),
        ([str(source), str(tmp_path / "there"), "--to", "lerobot"], "exists; name a path that does not"),
        ([str(source), str(tmp_path / "out.txt"), "--to", "robomimic"], "expected a name that ends in .hdf5"),
        ([str(tmp_path / "there"), str(tmp_path / "out.hdf5"), "--to", "robomimic"], "No finished recordings"),
        ([str(source), str(tmp_path / "out"), "--to", "lerobot", "--state", "poses/tip_pos"], "'poses/tip_pos_w'"),
    ):
        with pytest.raises(SystemExit):
            main(["convert", *words])
        assert message in capsys.readouterr().err
        assert [path.name for path in tmp_path.iterdir()] == ["there"]
