# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The ways that have tasks, segments and longer ones, and their time limits; imports neither torch nor Newton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class ConfigClass:
    """A class of configuration; a task that has it in a field gets a new object of it."""

    target: str
    """Its class, ``"module:Class"``."""

    def __repr__(self) -> str:
        """Return the name of the class."""
        return self.target.rpartition(":")[2]


Start = Literal["segment", "rest"]
"""Where an episode begins: at the start of its segment, or at rest in the anus."""

TIME_LIMIT_S: dict[str, float] = {"rectum": 10.0, "sigmoid": 45.0, "descending": 16.0, "splenic": 27.0}
"""Time limit of each segment [s], anus first: three times what a scripted expert needs that advances at 40 mm/s and
steers by the deformed centerline (2.1 to 3.4, 11 to 15, 4.5 to 5.5 and 3.6 to 9 s). A line here makes a segment's tasks
for every robot."""

LONG_SCOPE = 2.2
"""Length of the scope in ``Cecum`` [m], of which 2.0 m can be inserted: the working length of balloon enteroscopes
(EN-450P5/20, Yamamoto, Clin. Gastroenterol. Hepatol. 3:S27, 2005), which go to the cecum where a colonoscope is too
short. Of the shipped 1.68 m 1.48 can be inserted, which was all inside in half of the trials that failed; 99 of the 200
patients of ``population_cecum`` have a colon of more than 1.90 m."""

PATIENCE_S = 20.0
"""Time without progress after which a journey's episode counts as stuck [s]; a segment's ends after 6 s. A scope that
rolls to and fro, or is pulled back to straighten it, needs longer to come free: of six trials that a policy lost to the
6 s, three went on to the cecum with 20 s (docs/research_log.md)."""

JOURNEYS: dict[str, dict[str, Any]] = {
    "LeftColon": {"segment": "splenic", "start": "rest", "stuck_after_s": PATIENCE_S},
    "Cecum": {
        "segment": "cecum",
        "start": "rest",
        "episode_length_s": 240.0,
        "scope_length": LONG_SCOPE,
        "stuck_after_s": PATIENCE_S,
    },
    "Withdrawal": {
        "segment": "cecum",
        "direction": "withdrawal",
        "episode_length_s": 480.0,
        "rewards": ConfigClass("arcgym_tasks.navigation.withdrawal_cfg:WithdrawalRewardsCfg"),
        "terminations": ConfigClass("arcgym_tasks.navigation.withdrawal_cfg:WithdrawalTerminationsCfg"),
        "metrics": ConfigClass("arcgym_tasks.navigation.withdrawal_cfg:WithdrawalMetricsCfg"),
    },
}
"""Tasks of one continuous way: name in the task, and the fields of its configuration. ``LeftColon`` goes from the anus
past the splenic flexure, ``Cecum`` into the cecum with a longer scope, ``Withdrawal`` from the entrance of the cecum
back to the rectum, in the eight minutes on average that guidelines ask examiners for at least (Rex et al., Am. J.
Gastroenterol. 119:1754, 2024; six before). A line here makes a task for every robot."""


def time_limit_s(segment: str, start: Start = "segment") -> float:
    """Return the time limit of a task [s]; from rest, the limits of the segments on the way are added up.

    Raises:
        ValueError: If a segment is not in :data:`TIME_LIMIT_S`.
    """
    if segment not in TIME_LIMIT_S:
        raise ValueError(
            f"env.segment '{segment}' has no time limit of its own; set env.episode_length_s [s], or choose one of "
            f"{', '.join(TIME_LIMIT_S)}."
        )
    names = list(TIME_LIMIT_S)
    way = names[: names.index(segment) + 1] if start == "rest" else [segment]
    return sum(TIME_LIMIT_S[name] for name in way)
