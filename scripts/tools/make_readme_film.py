# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Make the short film at the head of README.md of a video that ``arcgym play`` has written.

make demo
python scripts/tools/make_readme_film.py logs/rsl_rl/arc_leftcolon_magnetic/pretrained/videos/play/rl-video-step-0.mp4
"""

from __future__ import annotations

import argparse
from pathlib import Path

OUT = Path(__file__).resolve().parents[2] / "docs" / "images" / "left_colon_policy.webp"


def main() -> None:
    """Parse the command line and write the film."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("video", type=Path, help="video of an episode, whose last picture is of the next one's start")
    parser.add_argument("--out", type=Path, default=OUT, help="animated WebP to write")
    parser.add_argument("--every", type=int, default=4, help="pictures of the video for one of the film")
    parser.add_argument("--width", type=int, default=480, help="width of the film [px]")
    parser.add_argument("--quality", type=int, default=30, help="of WebP, 0 to 100")
    parser.add_argument("--rate", type=float, default=10.0, help="pictures of the film a second")
    args = parser.parse_args()
    write_film(args.video, args.out, args.every, args.width, args.quality, args.rate)
    print(f"{args.out}: {args.out.stat().st_size / 1000:.0f} kB")


def write_film(video: Path, out: Path, every: int, width: int, quality: int, rate: float) -> None:
    """Write an animated WebP that repeats for ever; its last picture is the last one of the episode, shown for 2 s."""
    import imageio.v3 as imageio
    from PIL import Image

    pictures = imageio.imread(video)[:-1]
    chosen = [*pictures[:-1:every], pictures[-1]]
    height = round(pictures.shape[1] * width / pictures.shape[2])
    images = [Image.fromarray(picture).resize((width, height), Image.Resampling.LANCZOS) for picture in chosen]
    times = [round(1000.0 / rate)] * (len(images) - 1) + [2000]
    images[0].save(
        out,
        save_all=True,
        append_images=images[1:],
        duration=times,
        loop=0,
        quality=quality,
        method=6,
        minimize_size=True,
    )


if __name__ == "__main__":
    main()
