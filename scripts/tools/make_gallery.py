#!/usr/bin/env python3
# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Film the scenes of ``docs/data/gallery.yaml``, and write ``docs/gallery.md`` with what came of each.

    python scripts/tools/make_gallery.py --processes 4
    python scripts/tools/make_gallery.py --only splenic_capsule

A scene with a ``way`` is filmed from the states in that folder, which its command ``before`` has kept. Videos are half
the size of those that ``arcgym play`` writes. A scene whose run fails is listed, the others go on.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from datetime import date
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "docs" / "data" / "gallery.yaml"
VIDEOS = ROOT / "docs" / "_static" / "videos"
PAGE = ROOT / "docs" / "gallery.md"
LONGEST = 600
"""Control steps of a video at most."""
QUALITY = 30
"""Constant rate factor of H.264: more is smaller and worse."""

Scene = dict[str, Any]


def main() -> int:
    """Parse the command line, film, and write the page; the exit status is 1 if a scene failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="scenes, separated by commas (default: all)")
    parser.add_argument("--processes", type=int, default=1, help="scenes filmed at a time")
    parser.add_argument("--device", default="cpu", help="device of the runs")
    args = parser.parse_args()
    import yaml

    scenes = yaml.safe_load(SCENES.read_text())
    wanted = [name for name in args.only.split(",") if name] or [scene["name"] for scene in scenes]
    if unknown := sorted(set(wanted) - {scene["name"] for scene in scenes}):
        parser.error(f"unknown scenes {unknown}; expected some of {[scene['name'] for scene in scenes]}")
    VIDEOS.mkdir(parents=True, exist_ok=True)
    chosen = [scene for scene in scenes if scene["name"] in wanted]
    with ThreadPoolExecutor(args.processes) as pool:
        failed = [name for name in pool.map(lambda scene: film(scene, args.device), chosen) if name]
    PAGE.write_text(page([scene for scene in scenes if video_of(scene).is_file()]))
    print(f"{PAGE.relative_to(ROOT)}: {len(chosen) - len(failed)} filmed" + (f", failed: {failed}" if failed else ""))
    return 1 if failed else 0


def film(scene: Scene, device: str) -> str | None:
    """Film a scene; return its name if that failed."""
    with tempfile.TemporaryDirectory() as folder:
        result = subprocess.run(command(scene, device, ROOT), cwd=folder, capture_output=True, text=True)
        said = [line.removeprefix("video: ") for line in result.stdout.splitlines() if line.startswith("video: ")]
        videos = [Path(folder) / name for name in said] or sorted(Path(folder).rglob("*.mp4"))  # beside a checkpoint
        if result.returncode or not videos:
            print(f"{scene['name']}: {(result.stdout + result.stderr).strip()[-600:]}", flush=True)
            return str(scene["name"])
        if "way" in scene:  # made small by its tool
            video_of(scene).write_bytes(videos[0].read_bytes())
        else:
            every = 1 if "recording" in scene else scene.get("every", 1)
            shrink(videos[0], video_of(scene), every, quality=scene.get("quality", QUALITY))
        video_of(scene).with_suffix(".json").write_text(json.dumps(record(result.stdout, device), indent=1) + "\n")
    print(f"{scene['name']}: {video_of(scene).stat().st_size / 1e6:.1f} MB", flush=True)
    return None


def command(scene: Scene, device: str, root: Path = Path()) -> list[str]:
    """Return the command line that plays a scene, with files below a folder."""
    if "way" in scene:
        words = [str(root / "scripts/tools/film_way.py"), str(root / scene["way"]), f"{scene['name']}.mp4"]
        for name in ("every", "quality", "held"):
            words += [f"--{name}", str(scene[name])] if name in scene else []
        return [sys.executable, *words, "--task", scene["task"], *scene.get("overrides", [])]
    if "recording" in scene:
        file = str(root / scene["recording"])
        words = ["replay", file, "--video", f"{scene['name']}.mp4", "--every", str(scene.get("every", 1))]
        return [sys.executable, "-m", "arcgym", *words, "--device", device]
    play = ["play", "--task", scene["task"], "--policy", scene.get("policy", "expert"), "--num_envs", "1"]
    play += ["--device", device, "--video", "--video_length", str(scene.get("steps", LONGEST)), "--json"]
    play += ["--steps", str(scene["steps"])] if "steps" in scene else []
    play += ["--checkpoint", str(root / scene["checkpoint"])] if "checkpoint" in scene else []
    return [sys.executable, "-m", "arcgym", *play, *scene.get("overrides", [])]


def record(output: str, device: str) -> dict[str, Any]:
    """Return what a run printed at its end, with the commit and the day it was filmed on."""
    from arcgym.envs.provenance import versions

    last = output.strip().splitlines()[-1]
    figures = json.loads(last) if last.startswith("{") else {"said": last}
    return {"figures": figures, "device": device, "day": str(date.today())} | {"versions": versions()}


def shrink(source: Path, target: Path, every: int, fps: float = 10.0, quality: int = QUALITY) -> None:
    """Write one of so many frames of a video at half its size, whole or not at all, with ``fps`` frames a second."""
    import imageio_ffmpeg

    temporary = target.with_name(f".{target.name}.tmp.mp4")
    chosen = f"framestep={every},setpts=PTS/{every},scale=trunc(iw/4)*2:trunc(ih/4)*2"
    filters = ["-vf", chosen, "-r", f"{fps:g}", "-crf", str(quality), "-preset", "slow", "-an"]
    tool = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", "-i", str(source)]
    subprocess.run([*tool, *filters, "-movflags", "+faststart", str(temporary)], check=True)
    temporary.replace(target)


def video_of(scene: Scene) -> Path:
    """Return the file of a scene's video."""
    return VIDEOS / f"{scene['name']}.mp4"


def page(scenes: list[Scene]) -> str:
    """Return the gallery as Markdown."""
    head = "# Gallery\n\nThe endoscope's view, and the colon with the scope in it. "
    head += "Each video names the command that made it;\n"
    head += "`python scripts/tools/make_gallery.py` films them all again.\n"
    return head + "".join(entry(scene) for scene in scenes)


def outcome(figures: dict[str, Any]) -> str:
    """Return how the first episode of a film ended, as a sentence after a space; nothing where it goes on."""
    if figures.get("success_rate") is None:
        return ""
    metrics = {name.rpartition("/")[2]: value for name, value in figures["metrics"].items()}
    if figures["success_rate"] == 1.0:
        return f" Success after {metrics['time_to_success']:.1f} s."
    return f" The first episode ends without success, at {metrics['progress']:.0%} of the way."


def entry(scene: Scene) -> str:
    """Return one scene's part of the page."""
    made = json.loads(video_of(scene).with_suffix(".json").read_text())
    words = command(scene, made["device"])
    said = " ".join(["python", *words[1:]] if "way" in scene else ["arcgym", *words[3:]])
    file = f"_static/videos/{scene['name']}.mp4"
    tag = f'<video controls loop muted preload="metadata" width="100%" src="{file}"></video>'
    commit = made["versions"].get("arcgym commit", "unknown")[:7]
    when = f"Filmed on {made['day']}, commit {commit}{scene.get('note', '')}.{outcome(made['figures'])}"
    shown = f"```{{raw}} html\n{tag}\n```\n\n{when} [{scene['name']}.mp4]({file})"
    first = f"{scene['before']}\n" if "before" in scene else ""
    return f"\n## {scene['title']}\n\n{shown}\n\n```bash\n{first}{said}\n```\n"


if __name__ == "__main__":
    sys.exit(main())
