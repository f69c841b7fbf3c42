# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Turn a folder of masks or surfaces, such as the HQColon release, into a folder of colons. Needs ``arcgym[importer]``.

OUT receives a folder a colon, table.csv with a row each, splits.json with train, validation and test, logs/ and
refused/, which says why a file became no colon. What is there already is not made again; --retry tries refused ones.
Any other option of import-colon is passed on after --, such as: -- --max-gap 80 --label 1 2
"""

from __future__ import annotations

import argparse
import contextlib
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arcgym.cli.arguments import positive
from arcgym.cli.import_colon import check_packages
from arcgym.cli.stopping import stopped_cleanly
from arcgym.utils.errors import UsageError

if TYPE_CHECKING:
    from arcgym.anatomy.importing.dataset import Scan

PASSES_ON = True

UNWINDING = 30.0
"""Time that an import has to remove what it had begun, before it is killed [s]."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the folders and which files are taken."""
    parser.add_argument("folder", type=Path, help="folder of masks or surfaces, subfolders included")
    parser.add_argument("out", type=Path, help="folder of colons to make or to go on with")
    parser.add_argument("--pattern", default="*", help="file names that are taken (default: all)")
    parser.add_argument("--patient", default="", help="regular expression whose group is the patient in a name")
    parser.add_argument("--metadata", type=Path, help="the HQColon release's meta-data.json, if it lies elsewhere")
    parser.add_argument("--licence", default="unknown", help="licence of the data, kept in every stage")
    parser.add_argument("--jobs", type=positive, default=1, help="imports at a time, of 2 to 3 GB each (default: 1)")
    parser.add_argument("--limit", type=positive, help="import no more than so many files, the first by name")
    parser.add_argument("--timeout", type=positive, default=900, help="longest time of an import [s] (default: 900)")
    parser.add_argument("--retry", action="store_true", help="try files again that were refused")


def run(args: argparse.Namespace) -> int:
    """Import what is still to do; returns 1 where a file was refused."""
    from arcgym.anatomy.importing.dataset import find_scans, outcome, refusal
    from arcgym.anatomy.importing.errors import ImportArgumentError

    check_packages()
    if not args.folder.is_dir():
        raise UsageError(f"{args.folder} is no folder; pass one that holds masks or surfaces")
    try:
        scans = find_scans(args.folder, args.pattern, args.patient, args.metadata)[: args.limit]
    except ImportArgumentError as error:
        raise UsageError(str(error)) from error
    _make_folders(args.out)
    if args.retry:
        for scan in scans:
            refusal(scan, args.out).unlink(missing_ok=True)
    try:
        todo = [scan for scan in scans if outcome(scan, args.out) is None]
    except ImportArgumentError as error:
        raise UsageError(str(error)) from error
    print(f"{len(scans)} files, {len(scans) - len(todo)} done before", flush=True)
    with stopped_cleanly(f"{args.out} holds what was done; the same command goes on"):
        _import_all(todo, scans, args)
    status = [row["status"] for row in _write_tables(scans, args.out)]
    said = [f"{status.count(kind)} {kind}" for kind in ("imported", "refused", "doubtful") if kind in status]
    print(f"{args.out / 'table.csv'}: {', '.join(said)}")
    return 0 if set(status) <= {"imported"} else 1


def _make_folders(out: Path) -> None:
    try:
        for folder in (out, out / "logs", out / "refused"):
            folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{out} cannot be made: {error.strerror}; pass a folder elsewhere") from error


def _import_all(todo: list[Scan], scans: list[Scan], args: argparse.Namespace) -> None:
    children: set[subprocess.Popen[bytes]] = set()
    with ThreadPoolExecutor(args.jobs) as pool:
        running = {pool.submit(_import, scan, args, children): scan for scan in todo}
        try:
            for number, done in enumerate(as_completed(running), 1):
                print(f"{number}/{len(todo)} {running[done].name}: {done.result()}", flush=True)
                _write_tables(scans, args.out)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in list(children):
                child.terminate()  # it removes what it had begun


def _import(scan: Scan, args: argparse.Namespace, children: set[subprocess.Popen[bytes]]) -> str:
    """Import one file in a process of its own, and return what came of it in a few words."""
    from arcgym.anatomy.importing.dataset import refusal
    from arcgym.anatomy.importing.preflight import made_by_import

    command = [sys.executable, "-m", "arcgym", "import-colon", str(scan.path), str(args.out / scan.name)]
    command += ["--posture", scan.posture, "--patient", scan.about, "--licence", args.licence, *args.passed_on]
    log, began = args.out / "logs" / f"{scan.name}.log", time.monotonic()
    with log.open("w") as file:
        with subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT) as child:
            children.add(child)
            status = _wait(child, args.timeout)
            children.discard(child)
    seconds = time.monotonic() - began
    if status == 0:
        return f"imported in {seconds:.0f} s"
    if status is None:
        return _refuse(refusal(scan, args.out), f"error: not done after {args.timeout} s. Pass a longer --timeout")
    if status == -signal.SIGKILL:
        memory = "Pass fewer --jobs, or -- --voxel 1.5"
        return _refuse(refusal(scan, args.out), f"error: killed, most likely as the memory was full. {memory}")
    if made_by_import(args.out / scan.name / "report.json"):
        return "doubtful, kept as --keep-doubtful says"
    if status < 0 or status > 128:
        raise SystemExit(f"{scan.name}: import-colon was stopped by a signal (status {status}), see {log}")
    lines = [line for line in log.read_text().splitlines() if "error:" in line]
    problem = lines[-1] if lines else f"error: import-colon ended with status {status}, see {log}"
    if status == 2:
        raise UsageError(problem.split("error:", 1)[1].strip())
    return _refuse(refusal(scan, args.out), problem)


def _wait(child: subprocess.Popen[bytes], timeout: float) -> int | None:
    """Return the exit status of an import; None where it took too long and was stopped."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        return child.wait(timeout)
    child.terminate()
    try:
        child.wait(UNWINDING)
    except subprocess.TimeoutExpired:
        child.kill()
    return None


def _refuse(path: Path, problem: str) -> str:
    """Write down why a file was refused, and return it."""
    path.write_text(problem + "\n")
    return problem


def _write_tables(scans: list[Scan], out: Path) -> list[dict[str, Any]]:
    """Write table and split anew, each in one step, and return the rows."""
    from arcgym.anatomy.importing.dataset import outcome, split_text, table_text

    rows = [row for scan in scans if (row := outcome(scan, out)) is not None]
    for name, text in (("table.csv", table_text(rows)), ("splits.json", split_text(rows))):
        part = out / f".{name}"
        part.write_text(text)
        part.replace(out / name)
    return rows
