# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Terms of the Markov decision process, one module for each kind; import as ``from arcgym.envs import mdp``."""

from arcgym.envs.mdp.abdomen import *  # noqa: F403
from arcgym.envs.mdp.actions import *  # noqa: F403
from arcgym.envs.mdp.costs import *  # noqa: F403
from arcgym.envs.mdp.coverage import *  # noqa: F403
from arcgym.envs.mdp.curriculums import *  # noqa: F403
from arcgym.envs.mdp.events import *  # noqa: F403
from arcgym.envs.mdp.gas import *  # noqa: F403
from arcgym.envs.mdp.image_faults import *  # noqa: F403
from arcgym.envs.mdp.image_recorders import *  # noqa: F403
from arcgym.envs.mdp.load_metrics import *  # noqa: F403
from arcgym.envs.mdp.loads import *  # noqa: F403
from arcgym.envs.mdp.lumen import *  # noqa: F403
from arcgym.envs.mdp.metrics import *  # noqa: F403
from arcgym.envs.mdp.observations import *  # noqa: F403
from arcgym.envs.mdp.recorders import *  # noqa: F403
from arcgym.envs.mdp.rewards import *  # noqa: F403
from arcgym.envs.mdp.segments import *  # noqa: F403
from arcgym.envs.mdp.shaft_metrics import *  # noqa: F403
from arcgym.envs.mdp.terminations import *  # noqa: F403
