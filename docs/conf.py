# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx configuration: MyST pages and an API reference made from the docstrings."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "source"), str(ROOT / "docs" / "_ext")]

from sphinx.ext.napoleon.docstring import GoogleDocstring  # noqa: E402

from arcgym import __version__  # noqa: E402

# Napoleon takes the words before a colon in a field's docstring for its type; ours are sentences.
GoogleDocstring._parse_attribute_docstring = lambda self: [*self._lines]

project = "ARCGym"
author = "The ARCGym Developers"
copyright = f"2026, {author}"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.apidoc",
    "sphinx.ext.viewcode",
    "mathml",
    "reference_pages",
]
exclude_patterns = ["_build"]
html_math_renderer = "mathml"
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
napoleon_google_docstring = True
napoleon_numpy_docstring = False

_KERNELS = str(ROOT / "source" / "arcgym" / "**" / "*_kernels.py")
apidoc_modules = [
    {
        "path": str(ROOT / "source" / package),
        "destination": f"api/{package}",
        "separate_modules": True,
        "module_first": True,
        "no_headings": False,
        "exclude_patterns": [_KERNELS],
    }
    for package in ("arcgym", "arcgym_tasks")
]
apidoc_automodule_options = {"members", "show-inheritance"}
autodoc_default_options = {"ignore-module-all": True}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
# Annotations name classes that only type checkers import by their last name, which several modules may share.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_title = f"ARCGym {version}"
html_static_path = ["_static"]
html_css_files = ["arcgym.css"]
