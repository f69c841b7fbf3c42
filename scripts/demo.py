# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Train for a few iterations, film the policy that comes with ARCGym, and say how long it took and where everything is.

Run it as ``make demo``. Training shows that the whole chain works; a policy worth watching takes far longer, so the
film is that of one that was trained before.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TASK = "ARC-LeftColon-Magnetic"
TRAIN = ["--num_envs", "2", "--max_iterations", "3", "--run_name", "demo", "agent.num_steps_per_env=16"]
PLAY = ["--use_pretrained_checkpoint", "--num_envs", "1", "--video", "--video_length", "300", "--json"]
PLAY += [
    "env.viewer.samples=1",
    "env.viewer.outside.width=456",
    "env.viewer.outside.height=416",
]  # drawn in half the time


def main() -> None:
    """Run both stages and print the summary."""
    seconds, outputs = {}, {}
    for stage, arguments in (("train", TRAIN), ("play", PLAY)):
        start = time.perf_counter()
        outputs[stage] = run(stage, [*arguments, "--device", "cpu"])
        seconds[stage] = time.perf_counter() - start
    print("\n" + "\n".join(f"{stage:>11}: {duration:6.1f} s" for stage, duration in seconds.items()))
    print(f"{'checkpoint':>11}: {find(outputs['train'], 'checkpoint')}")
    print(f"{'log':>11}: {find(outputs['train'], 'run')}")
    print(f"{'video':>11}: {find(outputs['play'], 'video')}")
    print(f"{'in it':>11}: {outcome(outputs['play'])}")


def run(stage: str, arguments: list[str]) -> str:
    """Run a script of ``rsl_rl`` with its output shown as it comes, and return that output."""
    command = [sys.executable, "-u", f"scripts/rsl_rl/{stage}.py", "--task", TASK, *arguments]
    print(f"\n$ {' '.join(command)}", flush=True)
    lines = []
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            print(line, end="", flush=True)
            lines.append(line)
    if process.returncode != 0:
        sys.exit(f"demo: {stage} ended with status {process.returncode}; see its output above.")
    return "".join(lines)


def find(output: str, name: str) -> Path:
    """Return the path that a line ``<name>: <path>`` of the output holds."""
    match = re.search(rf"^{name}: (.+)$", output, re.MULTILINE)
    if match is None or not Path(match[1]).exists():
        sys.exit(f"demo: the output names no existing {name}.")
    return Path(match[1])


def outcome(output: str) -> str:
    """Return what the policy that comes with ARCGym achieved, from the figures on the last line of its output."""
    figures = json.loads(output.strip().splitlines()[-1])
    if figures["success_rate"] == 1.0:
        seconds = figures["metrics"]["Episode_Metrics/time_to_success"]
        return f"the policy that comes with ARCGym, from the anus past the splenic flexure in {seconds:.1f} s"
    way = figures["metrics"].get("Episode_Metrics/progress", 0.0)
    return f"the policy that comes with ARCGym, which came {way:.0%} of the way to the splenic flexure"


if __name__ == "__main__":
    main()
