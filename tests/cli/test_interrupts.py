# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import importlib

import pytest

from arcgym.cli.main import COMMANDS, main


@pytest.mark.parametrize("name", ["zero", "replay", "bench throughput"])
def test_ctrl_c_is_one_line(name, monkeypatch, capsys):
    def interrupted(args):
        raise KeyboardInterrupt

    module = importlib.import_module(COMMANDS[name][0])
    monkeypatch.setattr(module, "run", interrupted)
    monkeypatch.setattr(module, "add_arguments", lambda parser: None)
    assert main(name.split()) == 130
    assert capsys.readouterr().err == f"arcgym {name}: stopped by SIGINT\n"


def test_ctrl_c_while_libraries_load_is_one_line(monkeypatch, capsys):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr("arcgym.cli.main.importlib.import_module", interrupted)
    assert main(["play"]) == 130
    assert capsys.readouterr().err == "arcgym play: stopped by SIGINT\n"
