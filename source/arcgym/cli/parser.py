# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Argument parser that answers a mistake in one line with the nearest right name."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from typing import Any, NoReturn

from arcgym.utils.string import did_you_mean

OVERRIDE = re.compile(r"\+?(env|agent)\.[^=]*=.*", re.DOTALL)
"""Form of an override: a path that starts with ``env`` or ``agent``, an equals sign and a value."""


class CommandParser(argparse.ArgumentParser):
    """Parser of one subcommand. Flags are written out in full: an abbreviation could mean another flag tomorrow."""

    def __init__(
        self,
        prog: str,
        description: str | None,
        takes_overrides: bool = False,
        passes_on: bool = False,
        **kwargs: Any,
    ):
        """Create the parser.

        Args:
            prog: Command as it was typed, such as ``arcgym train``.
            description: Text of ``--help``.
            takes_overrides: Whether ``env.…=value`` and ``agent.…=value`` are accepted.
            passes_on: Whether arguments after ``--`` are accepted, for another command.
            kwargs: Further arguments of ``argparse.ArgumentParser``.
        """
        epilog = "Any other argument is an override: env.scene.num_envs=64 agent.algorithm.learning_rate=1e-4"
        super().__init__(
            prog=prog,
            description=_plain(description),
            epilog=epilog if takes_overrides else None,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
            **kwargs,
        )
        self.takes_overrides, self.passes_on = takes_overrides, passes_on
        self.override = OVERRIDE
        """Form of the overrides that are accepted."""

    def parse(self, argv: Sequence[str]) -> argparse.Namespace:
        """Return the arguments; overrides are in ``overrides``, those after ``--`` in ``passed_on``.

        A mistake exits with status 2.
        """
        own, passed_on = list(argv), list[str]()
        if self.passes_on and "--" in own:
            at = own.index("--")
            own, passed_on = own[:at], own[at + 1 :]
        args, rest = self.parse_known_args(own)
        args.passed_on = passed_on
        args.overrides = [text for text in rest if self.takes_overrides and self.override.fullmatch(text)]
        for text in rest:
            if text not in args.overrides:
                self.error(self._unknown(text))
        return args

    def error(self, message: str) -> NoReturn:
        """Print one line on stderr and exit with status 2."""
        line = " ".join(message.split())
        self.exit(2, f"{self.prog}: error: {line} (help: {self.prog} --help)\n")

    def _unknown(self, text: str) -> str:
        flags = [flag for flag in self._option_string_actions if flag.startswith("--")]
        if text.startswith("-"):
            return f"unknown flag '{text}'. {did_you_mean(text.partition('=')[0], flags)}"
        hint = " An override is written env.path=value or agent.path=value." if self.takes_overrides else ""
        if self.takes_overrides and text[0] in "~+":
            hint = f" Hydra's ~ and + are not there: {text.lstrip('~+').partition('=')[0]}=null takes a term away."
        return f"unexpected argument '{text}'.{hint}"


def _plain(description: str | None) -> str | None:
    """Return a module's docstring without the markup of the documentation, for a terminal."""
    return description and description.replace("``", "'").replace("::\n", ":\n")
