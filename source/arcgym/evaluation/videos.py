# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Films of an evaluation's best, median and worst trial, run again by their numbers."""

from __future__ import annotations

import itertools
from pathlib import Path

from arcgym.evaluation.evaluate import checkpoint_of, opened
from arcgym.evaluation.options import EvaluationOptions, LoadCfgs
from arcgym.evaluation.result_folder import ResultFolder, Row
from arcgym.evaluation.run_trials import run_trials
from arcgym.evaluation.trials import Conditions, Trial
from arcgym.evaluation.video_choice import chosen_rows, video_path
from arcgym.utils.progress import counted
from arcgym.viewers import VideoRecorder

QUALITY = 4.0
"""Quality of the films, 0 to 10: low enough for pages that hold a dozen."""


def film(conditions: Conditions, load_cfgs: LoadCfgs, options: EvaluationOptions, folder: ResultFolder) -> list[Path]:
    """Run the best, the median and the worst trial of each task again, film them, and return the new files.

    A trial that comes out otherwise than its row says is told: its film shows another episode.

    Args:
        conditions: Trials of the evaluation.
        load_cfgs: As for :func:`arcgym.evaluation.evaluate.evaluate`.
        options: As for :func:`arcgym.evaluation.evaluate.evaluate`.
        folder: Its results.
    """
    trials = {trial.trial: trial for trial in conditions.trials}
    made = []
    for task in dict.fromkeys(row["task"] for row in folder.rows):
        for label, row in chosen_rows([row for row in folder.rows if row["task"] == task]).items():
            path = video_path(folder.path, row, label)
            if row["trial"] in trials and not path.is_file():
                agents = options.agents_for(task)
                agent = agents[conditions.checkpoint_number(trials[row["trial"]], len(agents))]
                _film(row, trials[row["trial"]], agent, path, load_cfgs, options)
                made.append(path)
    return made


def _film(row: Row, trial: Trial, agent: str, path: Path, load_cfgs: LoadCfgs, options: EvaluationOptions) -> None:
    print(f"filming trial {trial.trial} of {row['task']}", flush=True)
    partial = path.with_name(f"partial_{path.name}")
    again: list[Row] = []
    cfgs = load_cfgs(row["task"], checkpoint_of(agent))
    with opened(row["task"], agent, [trial], cfgs, options) as (env, make_policy):
        world = env.unwrapped
        with (
            VideoRecorder(partial, round(1.0 / world.step_dt), quality=QUALITY) as video,
            counted(f"frames of trial {trial.trial}", round(row["seconds"] / world.step_dt)) as show,
        ):
            frames = itertools.count(1)

            def write_frame() -> None:
                video.write(world.render_world(0))
                show(next(frames))

            run_trials(env, make_policy, [trial], again.append, on_step=write_frame)
    partial.replace(path)
    other = [name for name, value in again[0].items() if row.get(name) != value]
    if other:
        print(f"note: trial {trial.trial} came out otherwise than its row says, in {', '.join(other[:5])}")
