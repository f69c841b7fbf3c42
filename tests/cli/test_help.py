# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest

from arcgym.cli.main import COMMANDS, main


def help_of(name, capsys):
    with pytest.raises(SystemExit) as stop:
        main([*name.split(), "--help"])
    assert stop.value.code == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_no_markup_of_the_documentation(name, capsys):
    text = help_of(name, capsys)
    assert "``" not in text
    assert "::\n" not in text


@pytest.mark.parametrize(("name", "films"), [("train", True), ("play", True), ("record", False), ("teleop", False)])
def test_commands_that_do_not_film_take_no_video(name, films, capsys):
    assert ("--video_length" in help_of(name, capsys)) == films
