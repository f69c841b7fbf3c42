# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A page about one evaluation: a single HTML file with its figures inside."""

from __future__ import annotations

import base64
import html
import io
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from arcgym.evaluation.result_folder import Row, read_run, read_trial_rows
from arcgym.evaluation.strengths import strengths_tables
from arcgym.evaluation.summary import KEY_METRICS, summarize
from arcgym.evaluation.video_choice import chosen_rows, video_path

STYLE = """body{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ccc;padding:.25em .6em;text-align:right}
td:first-child,th:first-child,.run td,.run th{text-align:left}td{white-space:nowrap}.run td{white-space:normal;
overflow-wrap:anywhere}.run td:first-child{overflow-wrap:normal}img{max-width:100%}.scroll{overflow-x:auto}
.films{display:flex;flex-wrap:wrap}figure{margin:.5em;width:20em}video{width:100%}"""

DISTRIBUTIONS = ("progress", "seconds", "p95_tip_force", "p95_shaft_force")
"""Figures whose distribution over the trials is drawn, if the rows have them."""

FEW = 8
"""Tasks up to which figures have a legend and tall lines; of more, such as robustness variants, lines are gray."""

EMBEDDED = 6_000_000
"""Size up to which a film is put into the page [bytes]."""

LABELS = {
    "seconds": "time [s]",
    "p95_tip_force": "p95 tip force [N]",
    "p95_shaft_force": "p95 shaft force [N]",
    "shaft_time_above_unsafe": "shaft above unsafe [s]",
    "max_base_force": "max base force [N]",
}
"""Headings of figures with units; others are without one."""


def write_page(folder: Path) -> Path:
    """Write ``page.html`` into a result folder and return its path.

    Raises:
        UsageError: It is no result folder, or has no finished trial.
    """
    run, rows = read_run(folder), read_trial_rows(folder)
    summaries = summarize(rows)
    names = [name for name in KEY_METRICS if any(name in summary for summary in summaries.values())]
    body = [
        f"<h1>{html.escape(str(run.get('suite')))}: {html.escape(_agent(run))}</h1>",
        "<h2>Tasks</h2><p>Interquartile means and success over all trials, with 95 % intervals.</p>",
        _table(
            ["task", "trials", "success [%]", *(LABELS.get(name, name) for name in names)],
            [_summary_row(task, summary, names) for task, summary in summaries.items()],
        ),
        _picture(_success_figure(summaries)),
        *_strengths(rows),
        "<h2>Trials</h2>",
        _picture(_distribution_figure(rows)),
        _films(folder, rows),
        "<h2>How episodes ended</h2>",
        _table(["task", "end", "trials"], _ends(rows)),
        "<h2>What was run</h2>",
        _table(["entry", "value"], [[name, _plain(run.get(name))] for name in run], "scroll run"),
    ]
    page = f"<!doctype html><html lang=en><meta charset=utf-8><title>Evaluation</title><style>{STYLE}</style>"
    path = folder / "page.html"
    path.write_text(page + "\n".join(body) + "</html>\n")
    return path


def _strengths(rows: Sequence[Row]) -> list[str]:
    """Return what robustness variants change, a table a task and agent."""
    return [
        f"<h2>{html.escape(table.title)}</h2>" + _table(table.head, table.lines) for table in strengths_tables(rows)
    ]


def _films(folder: Path, rows: Sequence[Row]) -> str:
    """Return the films of each task's best, median and worst trial, as far as they were made.

    Those that are larger than :data:`EMBEDDED` stay files beside the page.
    """
    parts = []
    for task in sorted({row["task"] for row in rows}):
        for label, row in chosen_rows([row for row in rows if row["task"] == task]).items():
            path = video_path(folder, row, label)
            if path.is_file():
                end = f"{row['end']} after {row['seconds']:.1f} s"
                caption = html.escape(f"{task}: {label}, trial {row['trial']}, {end}")
                source = html.escape(str(path.relative_to(folder)))
                if path.stat().st_size <= EMBEDDED:
                    source = f"data:video/mp4;base64,{base64.b64encode(path.read_bytes()).decode()}"
                parts.append(
                    f"<figure><video controls src='{source}'></video><figcaption>{caption}</figcaption></figure>"
                )
    return f"<h2>Best, median, worst</h2><div class=films>{''.join(parts)}</div>" if parts else ""


def _agent(run: dict[str, Any]) -> str:
    paths = [Path(path) for path in run.get("checkpoint") or []]
    return ", ".join(f"{path.parent.name}/{path.name}" for path in paths) or str(run.get("agent"))


def _plain(value: Any) -> str:
    if isinstance(value, dict):
        nested = any(isinstance(entry, dict) for entry in value.values())
        return ("; " if nested else ", ").join(_pair(name, entry) for name, entry in value.items()) or "none"
    if isinstance(value, list):
        return ", ".join(map(_plain, value)) or "none"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _pair(name: str, value: Any) -> str:
    return f"{name}{':' if isinstance(value, dict) else ''} {_plain(value)}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], kind: str = "scroll") -> str:
    cells = ["<tr>" + "".join(f"<th>{html.escape(text)}</th>" for text in head) + "</tr>"]
    cells += ["<tr>" + "".join(f"<td>{html.escape(str(text))}</td>" for text in row) + "</tr>" for row in rows]
    return f"<div class='{kind}'><table>{''.join(cells)}</table></div>"


def _summary_row(task: str, summary: dict[str, Any], names: Sequence[str]) -> list[str]:
    success = summary["success"]
    rate = f"{100 * success.value:.0f} ({100 * success.low:.0f}–{100 * success.high:.0f})"
    values = [
        f"{summary[n].value:.2f} ({summary[n].low:.2f}–{summary[n].high:.2f})" if n in summary else "" for n in names
    ]
    return [task, str(summary["trials"]), rate, *values]


def _ends(rows: Sequence[dict[str, Any]]) -> list[list[str]]:
    counts = Counter((row["task"], row["end"]) for row in rows)
    return [[task, end, str(count)] for (task, end), count in sorted(counts.items())]


def _success_figure(summaries: dict[str, dict[str, Any]]) -> Any:
    from matplotlib.figure import Figure

    height = 0.5 if len(summaries) <= FEW else 0.22
    figure = Figure(figsize=(7.0, height * len(summaries) + 1.2), layout="constrained")
    axes = figure.subplots()
    for place, summary in enumerate(summaries.values()):
        rate = summary["success"]
        axes.errorbar(
            100 * rate.value,
            place,
            xerr=[[100 * (rate.value - rate.low)], [100 * (rate.high - rate.value)]],
            fmt="o",
            capsize=4,
            color="C0",
        )
    axes.set(xlim=(-2, 102), ylim=(len(summaries) - 0.5, -0.5), xlabel="success [%]")
    axes.set_yticks(range(len(summaries)), list(summaries), fontsize="small")
    return figure


def _distribution_figure(rows: Sequence[dict[str, Any]]) -> Any:
    from matplotlib.figure import Figure

    names = [name for name in DISTRIBUTIONS if name in rows[0]]
    tasks = sorted({row["task"] for row in rows})
    style: dict[str, Any] = {} if len(tasks) <= FEW else {"color": "0.6", "linewidth": 0.7}
    figure = Figure(figsize=(3.2 * len(names), 3.0), layout="constrained")
    for axes, name in zip(np.atleast_1d(figure.subplots(1, len(names), sharey=True)), names, strict=True):
        for task in tasks:
            values = np.sort([row[name] for row in rows if row["task"] == task])
            shares = 100.0 * np.arange(len(values) + 1) / len(values)
            axes.step(values[[0, *range(len(values))]], shares, where="post", label=task, **style)
        axes.set(xlabel=LABELS.get(name, name), ylim=(0, 105))
        axes.locator_params(axis="x", nbins=4)
    figure.axes[0].set_ylabel("trials at or below [%]")
    if len(tasks) <= FEW:
        figure.axes[0].legend(fontsize="x-small")
    return figure


def _picture(figure: Any) -> str:
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=130)
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}">'
