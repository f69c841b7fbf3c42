# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Names that are imported when they are asked for."""

from __future__ import annotations

import sys

import pytest

from arcgym.utils.lazy import lazy_names


def test_module_is_imported_when_its_name_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "colorsys", raising=False)
    get = lazy_names("colors", {"rgb_to_hsv": "colorsys"})
    assert "colorsys" not in sys.modules
    assert get("rgb_to_hsv")(1.0, 0.0, 0.0) == (0.0, 1.0, 1.0)


def test_other_names_are_no_attributes() -> None:
    with pytest.raises(AttributeError, match="module 'colors' has no attribute 'cmyk'"):
        lazy_names("colors", {"rgb_to_hsv": "colorsys"})("cmyk")
