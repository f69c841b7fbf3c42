# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import yaml

from arcgym.rl import create_run_folder, find_checkpoint, write_params
from arcgym.rl.run_folder import removed_on_failure
from arcgym.utils.errors import UsageError


@pytest.fixture
def runs(tmp_path):
    for name in (
        "2026-01-01_00-00-00/model_5.pt",
        "2026-01-02_00-00-00_b/model_2.pt",
        "2026-01-02_00-00-00_b/model_10.pt",
    ):
        path = tmp_path / "splenic" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path


def test_latest_is_by_number_in_the_newest_run(runs):
    assert find_checkpoint("splenic", root=runs).name == "model_10.pt"


def test_run_is_chosen_by_pattern(runs):
    assert find_checkpoint("splenic", "2026-01-01.*", root=runs).name == "model_5.pt"


def test_path_is_taken_as_it_is(runs):
    path = runs / "splenic" / "2026-01-02_00-00-00_b" / "model_2.pt"
    assert find_checkpoint("other", checkpoint=str(path), root=runs) == path


def test_missing_checkpoint_lists_what_is_there(runs):
    with pytest.raises(UsageError, match="'best'.*model_10.pt.*model_5.pt"):
        find_checkpoint("splenic", checkpoint="best", root=runs)


def test_missing_best_says_when_there_is_one(runs):
    with pytest.raises(UsageError, match="A run has a best one once an episode has ended in it"):
        find_checkpoint("splenic", checkpoint="best", root=runs)


def test_names_as_the_message_lists_them_are_taken(runs):
    found = find_checkpoint("splenic", checkpoint="2026-01-02_00-00-00_b/model_2.pt", root=runs)
    assert found == runs / "splenic" / "2026-01-02_00-00-00_b" / "model_2.pt"


def test_path_that_is_no_file_says_what_its_folder_has(runs):
    run = runs / "splenic" / "2026-01-01_00-00-00"
    with pytest.raises(UsageError, match=r"model_6.pt': there is no such file; .*00-00-00 has model_5.pt\."):
        find_checkpoint("splenic", checkpoint=str(run / "model_6.pt"), root=runs)
    with pytest.raises(UsageError, match=r"that is a folder, expected a file; .* has model_5.pt\."):
        find_checkpoint("splenic", checkpoint=str(run), root=runs)
    with pytest.raises(UsageError, match=r"nowhere/model_6.pt': there is no such file\."):
        find_checkpoint("splenic", checkpoint="nowhere/model_6.pt", root=runs)


def test_unknown_experiment_lists_the_known(runs):
    with pytest.raises(UsageError, match="splenc.*Available: none.*splenic"):
        find_checkpoint("splenc", root=runs)


def test_bad_pattern_is_named(runs):
    with pytest.raises(UsageError, match="load_run '\\[' is no regular expression"):
        find_checkpoint("splenic", "[", root=runs)


def test_runs_of_one_second_have_folders_of_their_own(tmp_path):
    folders = [create_run_folder("splenic", "a", root=tmp_path) for _ in range(20)]
    assert len(set(folders)) == 20
    assert all(folder.is_dir() for folder in folders)


def test_failed_start_leaves_no_folder(tmp_path):
    folder = create_run_folder("splenic", root=tmp_path)
    with pytest.raises(RuntimeError), removed_on_failure(folder):
        write_params(folder, env={"a": 1})
        raise RuntimeError
    assert not folder.exists()


def test_params_name_functions(tmp_path):
    folder = create_run_folder("splenic", "trial", root=tmp_path)
    write_params(folder, env={"func": pytest.raises, "range": (1, 2), "off": None})
    assert folder.name.endswith("_trial")
    params = yaml.safe_load((folder / "params" / "env.yaml").read_text())
    assert params == {"func": "_pytest.raises:raises", "range": [1, 2], "off": None}
