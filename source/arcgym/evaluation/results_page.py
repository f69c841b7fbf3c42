# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""The page of results: all tables, made of result folders. Loads neither torch nor Warp.

Figures are those of :mod:`arcgym.evaluation.summary`, :mod:`~arcgym.evaluation.strengths` and
:mod:`~arcgym.evaluation.paper_tables`; here is only which of them stand where.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import yaml

from arcgym.evaluation.paper_tables import TABLES_FILE, paper_table
from arcgym.evaluation.result_folder import Row
from arcgym.evaluation.results import Result, added_mark, best
from arcgym.evaluation.statistics import Interval
from arcgym.evaluation.strengths import strengths_tables
from arcgym.evaluation.suites import FOLDER, read_suites
from arcgym.evaluation.summary import summarize
from arcgym.evaluation.task_settings import PATIENCE, PHYSICS_STEP
from arcgym.utils.untrained import UNTRAINED

SECTIONS_FILE = FOLDER / "results.yaml"
"""Sections of the page."""

METRICS = {
    "progress": ("progress", 2),
    "seconds": ("time [s]", 1),
    "s_c": ("centered view s_c", 2),
    "coverage": ("mucosa seen", 2),
    "polyps_seen": ("polyps seen", 2),
    "tip_time_above_unsafe": ("tip above unsafe, mean [s]", 2),
    "shaft_time_above_unsafe": ("shaft above unsafe [s]", 2),
    "p95_tip_force": ("p95 tip force [N]", 2),
    "p95_shaft_force": ("p95 shaft force [N]", 2),
}
"""Heading and digits of the figures beside success."""

TRAINED = "model.pt"
"""Stands for a checkpoint in commands."""

NOTHING = "–"
"""Stands in a cell for which nothing was run."""


FIGURE = "Success in 30 trials of each task, with intervals, and the paper's own figures"
"""What the picture shows."""

EARLIER = (
    "Trials of {names} are of an earlier version of the population, whose patients were others"
    " ([how](patients.md#make-check-and-look-at-others))."
)
"""Stands above tables in which some trials are no longer the suite's."""

EARLIER_STEP = (
    "‡{names} ran with physics steps of {value}, an earlier default: not to be compared with what has none"
    " ([why](physics.md#a-step-twice-as-long))."
)
"""Stands above tables in which some trials had another physics step than the task has now."""

EARLIER_PATIENCE = (
    "§{names} counted as stuck after {value} without progress, an earlier default: not to be compared with what has"
    " none ([why](evaluation.md#stuck))."
)
"""Stands above tables in which some episodes ended as stuck sooner than they do now."""

INTRODUCTION = """# Results

Made by `{command}`
and nothing else. A cell has the share of successful trials [%] with Wilson's interval (95 %), and behind it the
number of trials where they are not all of the suite's; other figures are interquartile means with bootstrap
intervals, but where a column says mean. `–` was not run: the command that would make it is below its table. *n* seeds
are training runs, each with its share of the trials; of one seed the interval is that of this policy and not of the
method. † marks rules on actions that read the simulator's depth, which the policy does not see. ¶ marks policies that
see the simulator's state, which no scope knows: teachers, no results of images. ‡ marks trials of an earlier physics
step, such as 1/480 s. `_roll9` is a roll to and fro of 9 rad/s, added to what an agent commands,
`_roll8_2s` one of 8 rad/s in 2 s where others take 4; `_back45` goes back at 45 mm/s for a while where a tether no
longer comes on; `_slow6.5` commands at most 6.5 mm/s. What was run where is in the
[last table](#what-was-run).
"""


def results_page(
    results: Sequence[Result], command: str, sections: Sequence[dict[str, Any]], figure: str | None = None
) -> str:
    """Return the page in Markdown.

    Args:
        results: What can be shown, see :func:`arcgym.evaluation.results.find_results`.
        command: What makes the page, for the record.
        sections: Those of :data:`SECTIONS_FILE`.
        figure: Picture of the first section's table, as the page finds it; None has none.
    """
    used: dict[tuple[Path, str], Result] = {}
    asked: dict[str, None] = {}
    parts = [INTRODUCTION.format(command=command)]
    for section in sections:
        own = [result for result in results if result.suite == section["suite"]]
        shown, text, missing = KINDS[section["kind"]](section, own)
        used |= {(one.folder, one.task): one for one in shown}
        missing = [command for command in missing if command not in asked]
        asked |= dict.fromkeys(missing)
        parts.append(f"## {section['title']}\n")
        parts += [f"{section['text']}\n"] if "text" in section else []
        parts += [f"{note}\n" for note in _earlier(shown, named=section["kind"] in UNMARKED)]
        parts += [text] if text else []
        parts += [f"![{FIGURE}]({figure})\n"] if figure and section is sections[0] else []
        parts += [_commands(missing)] if missing else []
    return "\n".join([*parts, "## What was run\n", _provenance(list(used.values()))])


def _earlier(results: Sequence[Result], named: bool) -> list[str]:
    """Return sentences on what is of an earlier version, trials, physics step or patience; none if nothing is.

    Args:
        results: What the table shows.
        named: Whether to name the agents of another physics step or patience, which the table does not mark.
    """
    suites = read_suites()
    names = sorted({one.conditions for one in results if one.conditions != suites[one.suite].conditions})
    found = [EARLIER.format(names=", ".join(f"`{name}`" for name in names))] if names else []
    for setting, sentence in ((PHYSICS_STEP, EARLIER_STEP), (PATIENCE, EARLIER_PATIENCE)):
        old = [(one, setting.in_run(one.run, one.task)) for one in results if not setting.is_present(one.run, one.task)]
        for value in sorted({had for _, had in old if had is not None}):
            agents = dict.fromkeys(_agent(one) for one, had in old if had == value)
            which = f" {', '.join(agents)}" if named else ""
            found.append(sentence.format(names=which, value=setting.as_text(value)))
    return found


def _agent(result: Result) -> str:
    """Return the name of an agent in a table: its method, and the first digits of its checkpoint."""
    return f"{result.method} `{result.checkpoints[0][:8]}`" if result.checkpoints else result.method


def read_sections() -> list[dict[str, Any]]:
    """Return the sections of the page."""
    return yaml.safe_load(SECTIONS_FILE.read_text())


def published_figures(section: dict[str, Any], robot: str, method: str) -> list[float] | None:
    """Return the paper's figures of a row of the first table, one a segment, or None."""
    given = section.get("published", {}).get(robot, {}).get(method)
    if isinstance(given, str):
        rows = yaml.safe_load(TABLES_FILE.read_text())["algorithms"]["rows"]
        return next(row["paper"] for row in rows if row["algorithm"] == given)
    return None if given is None else [given] * len(section["segments"])


def cells_of(section: dict[str, Any], results: Sequence[Result]) -> Iterator[tuple[str, str, list[Result | None]]]:
    """Yield robot, method and one result a segment of each row of a table of methods."""
    for robot, methods in section["robots"].items():
        for method in methods:
            own = [one for one in results if (one.robot, one.method) == (robot, method)]
            yield robot, method, [best([one for one in own if one.segment == name]) for name in section["segments"]]


def _methods(section: dict[str, Any], results: Sequence[Result]) -> tuple[list[Result], str, list[str]]:
    """Return the results of a table of methods, the table, and the commands of the cells that are missing."""
    lines = [_row(["robot", "method", *section["segments"]]), _rule(2 + len(section["segments"]))]
    used, missing = [], []
    for robot, method, found in cells_of(section, results):
        asked = section.get("asked", {}).get(robot, {}).get(method, section["segments"])
        published: Sequence[float | None] = published_figures(section, robot, method) or [None] * len(found)
        pairs = zip(found, published, strict=True)
        metric = section.get("metric", "success")
        cells = [_cell(one, metric) + ("" if figure is None else f" [{figure:g}]") for one, figure in pairs]
        lines.append(_row([robot, section["labels"][method], *cells]))
        used += [one for one in found if one]
        none = [name for name, one in zip(section["segments"], found, strict=True) if one is None and name in asked]
        if none:
            segments = ",".join(name.lower() for name in none)
            missing.append(section["command"].format(method=method, robot=robot, segment=segments))
    return used, "\n".join(lines) + "\n", missing


def _agents(section: dict[str, Any], results: Sequence[Result]) -> tuple[list[Result], str, list[str]]:
    """Return the results of a table of agents, the table, and the commands of the cells that are missing."""
    wanted = section.get("methods")
    own = [one for one in results if wanted is None or _is_asked(one, section)]
    own = [one for one in _newest(own) if one.checkpoints or one is best([same for same in own if _same(same, one)])]
    own.sort(key=lambda one: (one.task, _place(one), one.limits, one.folder.name))
    metrics = [name for name in section["metrics"] if any(name in row for one in own for row in one.rows[:1])]
    head = ["task", "agent", "trials", "success [%]", *(METRICS[name][0] for name in metrics)]
    lines = [_row(head), _rule(len(head)), *(_row(_agent_cells(one, metrics)) for one in own)]
    there = {(one.robot, TRAINED if one.checkpoints else one.method) for one in own if one.is_current}
    asked = [(robot, agent) for robot, agents in section["robots"].items() for agent in [*agents, TRAINED]]
    missing = [
        section["command"].format(suite=section["suite"], robot=robot, agent=agent)
        for robot, agent in asked
        if (robot, agent) not in there
    ]
    return own, "\n".join(lines) + "\n" if own else "", missing


def _is_asked(result: Result, section: dict[str, Any]) -> bool:
    """Return whether a section has a result's robot and its method, whatever is added to its commands."""
    method = result.method.removesuffix(added_mark(result.run, result.task))
    return result.robot in section["robots"] and method in section["methods"]


def _same(first: Result, second: Result) -> bool:
    return (first.task, first.method) == (second.task, second.method)


def _newest(results: Sequence[Result]) -> list[Result]:
    """Return the results without those of earlier trials or steps whose agent has run the present ones."""
    there = {(one.task, one.method, *one.checkpoints) for one in results if one.is_current}
    return [one for one in results if one.is_current or (one.task, one.method, *one.checkpoints) not in there]


def _place(result: Result) -> int:
    return UNTRAINED.index(result.method) if result.method in UNTRAINED else len(UNTRAINED)


def _agent_cells(result: Result, metrics: Sequence[str]) -> list[str]:
    (summary,) = summarize(result.rows).values()
    name = _agent(result)
    figures = [
        _interval(summary[name], METRICS[name][1]) if name in summary else _mean(result.rows, name) for name in metrics
    ]
    name += f", limit {result.limits}" if result.limits else ""
    name += "" if result.conditions == read_suites()[result.suite].conditions else f", {result.conditions}"
    name += ("¶" if result.sees_state else "") + result.marks
    return [f"`{result.task}`", name, str(summary["trials"]), _interval(summary["success"], 0, 100.0), *figures]


def _mean(rows: Sequence[Row], name: str) -> str:
    """Return the plain mean of a metric that the summary does not have, which may be zero in most trials."""
    return f"{sum(row[name] for row in rows) / len(rows):.2f}" if name in rows[0] else ""


def _one_each(results: Sequence[Result]) -> list[Result]:
    """Return one result of each task, method and set of checkpoints: the same trials again are no further ones."""
    groups: dict[tuple[Any, ...], list[Result]] = {}
    for one in results:
        groups.setdefault((one.task, one.method, *one.checkpoints), []).append(one)
    return [chosen for own in groups.values() if (chosen := best(own))]


def _robustness(section: dict[str, Any], results: Sequence[Result]) -> tuple[list[Result], str, list[str]]:
    """Return the results of the robustness variants, a table an agent, and the command where there is none."""
    own = _one_each(_newest(results))
    rows = [{**row, "agent": f"{row['agent']}{added_mark(one.run, one.task)}"} for one in own for row in one.rows]
    text = "\n".join(table.to_markdown() for table in strengths_tables(rows))
    return own, text, [] if any(one.is_current for one in own) else [section["command"]]


def _paper(section: dict[str, Any], results: Sequence[Result]) -> tuple[list[Result], str, list[str]]:
    """Return the results of one of the paper's studies of a fixed policy, a table a method."""
    parts = []
    results = _one_each(_newest(results))
    for method in sorted({one.method for one in results}):
        rows = [row for one in results if one.method == method for row in one.rows]
        parts.append(f"`{method}`. {paper_table(rows, section['suite'])}")
    return list(results), "\n".join(parts), [] if results else [section["command"]]


KINDS = {"methods": _methods, "agents": _agents, "robustness": _robustness, "paper": _paper}
"""What makes the sections of each kind."""

UNMARKED = ("robustness", "paper")
"""Kinds whose tables have no place for a mark."""


def _cell(result: Result | None, metric: str) -> str:
    """Return a cell of a table of methods; † where rules read true depth, ¶ where the policy sees the state."""
    if result is None:
        return NOTHING
    (summary,) = summarize(result.rows).values()
    if metric != "success":
        return _interval(summary[metric], METRICS[metric][1]) + result.marks
    seeds = f", {len(result.checkpoints)} seeds" if len(result.checkpoints) > 1 else ""
    few = f" of {summary['trials']}" if summary["trials"] != 30 else ""
    more = ("†" if result.reads_depth else "") + ("¶" if result.sees_state else "")
    return _interval(summary["success"], 0, 100.0) + few + seeds + more + result.marks


def _provenance(results: Sequence[Result]) -> str:
    """Return a table of the results that are shown, a line a folder and task."""
    head = ["suite", "conditions", "task", "method", "trials", "transitions", "checkpoint (SHA-256)"]
    head += ["physics step", "commit", "machine", "folder"]
    lines = [_row(head), _rule(len(head))]
    for one in dict.fromkeys((one.folder, one.task.partition(":")[0]) for one in results):
        own = [result for result in results if (result.folder, result.task.partition(":")[0]) == one]
        hashes = ", ".join(digest[:12] for digest in own[0].checkpoints)
        transitions = f"{own[0].transitions:,.0f}".replace(",", " ") if own[0].transitions else ""
        about = [str(sum(len(result.rows) for result in own)), transitions, hashes, PHYSICS_STEP.as_text(own[0].steps)]
        about += [own[0].commit, own[0].run["machine"], one[0].name]
        lines.append(_row([own[0].suite, own[0].conditions, f"`{one[1]}`", own[0].method, *about]))
    return "\n".join(lines) + "\n"


def _commands(missing: Sequence[str]) -> str:
    """Return what would make the cells that are missing, below a fold."""
    return "\n".join([f"Not run ({NOTHING}), and how it would be made:\n", "```bash", *missing, "```\n"])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _rule(columns: int) -> str:
    return f"|{'---|' * columns}"


def _interval(interval: Interval, digits: int, factor: float = 1.0) -> str:
    return (
        f"{factor * interval.value:.{digits}f} ({factor * interval.low:.{digits}f}–{factor * interval.high:.{digits}f})"
    )
