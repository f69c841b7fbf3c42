# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import errno
import importlib
import os

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


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_trouble_with_the_disk_is_one_line(number, monkeypatch, capsys):
    def fail(args):
        raise OSError(number, os.strerror(number), "/data/colon")

    module = importlib.import_module(COMMANDS["make-colon"][0])
    monkeypatch.setattr(module, "run", fail)
    monkeypatch.setattr(module, "add_arguments", lambda parser: None)
    assert main(["make-colon"]) == 74
    assert capsys.readouterr().err == f"arcgym make-colon: error: {os.strerror(number)}: /data/colon\n"


def test_other_errors_of_the_system_keep_their_traceback(monkeypatch):
    def fail(args):
        raise OSError(errno.EPIPE, os.strerror(errno.EPIPE))

    module = importlib.import_module(COMMANDS["make-colon"][0])
    monkeypatch.setattr(module, "run", fail)
    monkeypatch.setattr(module, "add_arguments", lambda parser: None)
    with pytest.raises(BrokenPipeError):
        main(["make-colon"])


def test_file_that_hdf5_could_not_write_is_named(monkeypatch, capsys):
    def fail(args):
        text = "Can't write data (file write failed: time = now\n, filename = 'ds/a.hdf5', errno = 28)"
        raise OSError(errno.ENOSPC, text)

    module = importlib.import_module(COMMANDS["make-colon"][0])
    monkeypatch.setattr(module, "run", fail)
    monkeypatch.setattr(module, "add_arguments", lambda parser: None)
    assert main(["make-colon"]) == 74
    assert capsys.readouterr().err == "arcgym make-colon: error: No space left on device: ds/a.hdf5\n"
