# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Remake the USD assets: the patients' colons and the endoscopes. The same code always writes the same assets."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from arcgym.assets.endoscope_spec import EndoscopeSpec

DEFAULT_OUT = Path(__file__).resolve().parents[2] / "assets" / "usd"


def author_colon(name: str, out: Path) -> None:
    """Generate one patient's colon into ``out/<name>/colon.usda``."""
    from arcgym.anatomy import write_colon
    from arcgym.anatomy.generator.generate import make_colon
    from arcgym.anatomy.generator.patients import PATIENTS

    folder = out / name
    stage = make_colon(PATIENTS[name](), folder)
    write_colon(stage, folder / "colon.usda")
    wall, visual, proxy = len(stage.wall.points), len(stage.visual.points), len(stage.visual_proxy.points)
    print(f"  length {stage.length:.3f} m, wall {wall} vertices, render {visual}, proxy {proxy}")


def share_textures(out: Path) -> int:
    """Let colons whose textures are the same use the first one's, remove the copies, and return how many went."""
    first: dict[bytes, Path] = {}
    removed = 0
    for texture in sorted(out.glob("colon_*/mucosa_*")):
        kept = first.setdefault(texture.read_bytes(), texture)
        stage = texture.parent / "colon.usda"
        if kept != texture and stage.is_file():
            stage.write_text(stage.read_text().replace(f"@./{texture.name}@", f"@../{kept.parent.name}/{kept.name}@"))
            texture.unlink()
            removed += 1
    return removed


def asset_authors() -> dict[str, Callable[[Path], object]]:
    """Return the function that writes each asset below a folder, by asset name."""
    from arcgym.anatomy.generator.patients import PATIENTS
    from arcgym.assets.endoscope_spec import endoscope_specs
    from arcgym.assets.endoscope_stage import write_endoscope

    authors: dict[str, Callable[[Path], object]] = {name: partial(author_colon, name) for name in PATIENTS}
    for spec in endoscope_specs():
        authors[spec.name] = partial(_author_endoscope, write_endoscope, spec)
    return authors


def _author_endoscope(write: Callable[..., Path], spec: EndoscopeSpec, out: Path) -> None:
    write(spec, out / "endoscopes" / f"{spec.name}.usda")


def main() -> None:
    """Parse the command line and writes the assets."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=DEFAULT_OUT, help="folder for the assets (default: assets/usd)")
    parser.add_argument("--only", nargs="+", metavar="ASSET", help="names of the assets to make (default: all)")
    args = parser.parse_args()
    authors = asset_authors()
    unknown = set(args.only or []) - set(authors)
    if unknown:
        parser.error(f"unknown asset {', '.join(sorted(unknown))}; choose from {', '.join(authors)}")
    for name in args.only or authors:
        started = time.perf_counter()
        print(f"{name} ...", flush=True)
        authors[name](args.out)
        print(f"  {time.perf_counter() - started:.1f} s", flush=True)
    print(f"{share_textures(args.out)} textures are another colon's")


if __name__ == "__main__":
    main()
