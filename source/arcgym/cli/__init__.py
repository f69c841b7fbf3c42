# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The command ``arcgym`` and its subcommands, one module each.

A module of a subcommand has a docstring, which ``--help`` shows, and two functions:

* ``add_arguments(parser)`` declares arguments. It imports neither torch nor Newton.
* ``run(args)`` does the work and returns None or an exit status. Heavy imports are inside it. A mistake in the
  arguments is raised as :class:`arcgym.utils.errors.UsageError`.

With ``TAKES_OVERRIDES = True`` the module also accepts ``env.…=value`` and ``agent.…=value``, as the list
``args.overrides``. A line in :data:`arcgym.cli.main.COMMANDS` makes the subcommand known.
"""
