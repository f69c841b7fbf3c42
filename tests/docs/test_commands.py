# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Commands and configuration paths on the pages exist."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from arcgym.cli.main import COMMANDS
from arcgym.cli.parser import CommandParser
from arcgym.utils.config_reference import leaves_of
from arcgym.utils.registry import load_cfg_from_registry
from arcgym_tasks.navigation.agents import AGENTS

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
IDS = [page.name for page in PAGES]
GIVEN_AWAY = {"env.simm.dt", "env.path", "agent.path", "env.rewards.bending"}
"""Paths that pages give as mistakes, placeholders or for terms of the reader's own."""


def commands(text: str) -> list[str]:
    """Lines of the shell blocks that call ``arcgym`` or ``python -m arcgym``, one a command."""
    blocks = "".join(re.findall(r"^```bash\n(.*?)^```", text, re.DOTALL | re.MULTILINE)).replace("\\\n", " ")
    blocks = blocks.replace(" && ", "\n")
    return re.findall(r"(?:^|-m )arcgym (.+)$", blocks, re.MULTILINE)


def subcommand(line: str) -> str:
    words = line.split()
    return " ".join(words[:2]) if " ".join(words[:2]) in COMMANDS else words[0]


def flags(name: str) -> set[str]:
    module = importlib.import_module(COMMANDS[name][0])
    accepts = (getattr(module, mark, False) for mark in ("TAKES_OVERRIDES", "PASSES_ON"))
    parser = CommandParser(f"arcgym {name}", "", *accepts)
    module.add_arguments(parser)
    return set(parser._option_string_actions)


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_commands_and_their_flags_exist(page: Path) -> None:
    for line in commands(page.read_text()):
        name = subcommand(line)
        if name not in ("--help", "train.py"):
            assert name in COMMANDS, line
            assert set(re.findall(r"(?<=\s)--\w+", line.split("#")[0])) <= flags(name), line


@pytest.fixture(scope="module")
def known() -> set[str]:
    """Every path of the three robots' tasks and of all agents, and the beginnings of these paths."""
    found: set[str] = set()
    for robot in ("Capsule", "Magnetic", "Proximal"):
        cfg = load_cfg_from_registry(f"ARC-Sigmoid-{robot}", "env_cfg_entry_point")
        found |= {path for path, *_ in leaves_of(cfg, "env")}
    for key in AGENTS:
        agent = load_cfg_from_registry("ARC-Sigmoid-Capsule", key)
        found |= {path for path, *_ in leaves_of(agent, "agent")}
    return found | {path[: dot.start()] for path in found for dot in re.finditer(r"\.", path)}


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_paths_exist(page: Path, known: set[str]) -> None:
    paths = set(re.findall(r"[`\s]((?:env|agent)\.[\w.]+)=", page.read_text()))
    maps = ("env.scene.colon.anchor_stiffness.", "agent.algorithm.limits.", "env.lumen.", "agent.obs_groups.")
    unknown = {p for p in paths - known if not p.startswith((*maps, *GIVEN_AWAY)) and ".params." not in p}
    assert unknown == set()


def test_links_between_pages_lead_somewhere() -> None:
    made = {f"reference/{name}.md" for name in ("terms", "tasks", "actions", "observations", "configuration", "paths")}
    for page in PAGES:
        for link in re.findall(r"\]\((?!http)([^)#\s]+)(?:#[^)]*)?\)", page.read_text()):
            assert link in made or (page.parent / link).exists(), f"{page.name}: {link}"


def test_a_misspelt_flag_would_be_found() -> None:
    (line,) = commands("```bash\narcgym train --task T \\\n    --num_env 3  # comment\n```\n")
    assert subcommand(line) == "train" and "--num_env" in line and "--num_env" not in flags("train")
