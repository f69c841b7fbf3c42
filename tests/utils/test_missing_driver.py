# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from arcgym.utils import missing_driver


def test_one_line_is_left_out_and_the_others_are_passed_on(capfd: pytest.CaptureFixture[str]) -> None:
    missing_driver.without_line("driver", lambda: os.write(2, b"one\nno driver here\nthree") and None)
    os.write(2, b" four\n")
    assert capfd.readouterr().err == "one\nthree four\n"


def test_an_error_passes_with_what_was_written_before_it(capfd: pytest.CaptureFixture[str]) -> None:
    def fail() -> None:
        os.write(2, b"first\n")
        raise RuntimeError("then")

    with pytest.raises(RuntimeError, match="then"):
        missing_driver.without_line("driver", fail)
    assert capfd.readouterr().err == "first\n"


def test_driver_is_missing_where_neither_library_loads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(missing_driver.sys, "platform", "linux")
    monkeypatch.setattr(missing_driver, "_LIBRARIES", ("libno_such.so", "libc.so.6"))
    assert not missing_driver.driver_is_missing()
    monkeypatch.setattr(missing_driver, "_LIBRARIES", ("libno_such.so",))
    assert missing_driver.driver_is_missing()


def test_warp_starts_without_a_word() -> None:
    code = "import arcgym.utils.warp_setup, warp; warp.zeros(1, device='cpu')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")
