# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""Navigation through one segment of the colon: scene, observations, rewards and the rest that all robots share.

A robot's configuration adds its endoscope and its actions (``config/<robot>.py``).
"""

from __future__ import annotations

from typing import Literal, get_args

from arcgym.anatomy.segments import SEGMENTS
from arcgym.assets import ColonCfg, EndoscopeCfg
from arcgym.assets.scope_length import has_lengths
from arcgym.envs import ManagerBasedRLEnvCfg, mdp
from arcgym.managers import CostTermCfg as CostTerm
from arcgym.managers import EventTermCfg as EventTerm
from arcgym.managers import RewardTermCfg as RewTerm
from arcgym.managers import TerminationTermCfg as DoneTerm
from arcgym.scene import InteractiveSceneCfg
from arcgym.sensors import EndoscopeCameraCfg
from arcgym.utils.configclass import MISSING, configclass
from arcgym.utils.validation import FieldError, require
from arcgym_tasks.navigation import clinical
from arcgym_tasks.navigation.back_off import check_back_off
from arcgym_tasks.navigation.gas import add_gas, check_gas
from arcgym_tasks.navigation.hand import add_hand, check_hand
from arcgym_tasks.navigation.metrics import MetricsCfg
from arcgym_tasks.navigation.observations import EXTRA_OBSERVATIONS, ObservationsCfg, add_observations
from arcgym_tasks.navigation.robustness import NONE, VARIANTS, make_harder
from arcgym_tasks.navigation.segments import Start, time_limit_s


@configclass
class NavigationSceneCfg(InteractiveSceneCfg):
    """Colon, endoscope and the camera at its tip."""

    num_envs: int = 64
    """Number of worlds. On a GPU use 256 and more."""

    colon: ColonCfg = ColonCfg()
    """The patient."""

    endoscope: EndoscopeCfg = MISSING
    """The robot."""

    camera: EndoscopeCameraCfg = EndoscopeCameraCfg(width=84, height=84)
    """The policy's camera."""


ABLATED = ("s_c", "s_1", "s_2", "s_o")
"""Parts of the paper's reward that ``env.reward`` may leave alone."""


@configclass
class RewardsCfg:
    """The paper's lumen reward, with progress and safety; each is multiplied by its weight and the step of 0.1 s.

    At 40 mm/s, 4 mm a step, progress earns 0.12 a step. A view along the lumen earns 0.03 to 0.05, and up to 0.08 in
    front of a tight bend, where the near wall counts as lumen; looking round the bend earns 0.02 (colon 1,
    docs/research_log.md). So it pays to go on: with a weight of 100 it paid more to stay and look. The bonus of the
    last step, 50 times 0.1, is more than a policy could collect by waiting before the end at a discount of 0.97.
    At 0.99 it is not, and policies did wait (docs/research_log.md): :func:`arcgym.envs.mdp.lumen_lost` in place of
    ``lumen_reward`` pays for no view.
    """

    lumen = RewTerm(func=mdp.lumen_reward, weight=1.0)
    progress = RewTerm(func=mdp.progress, weight=300.0)
    success = RewTerm(func=mdp.success, weight=50.0)
    shaft_force = RewTerm(func=mdp.load_excess, weight=-0.02, params={"kind": "shaft_force", "limit": "comfort"})
    action_rate = RewTerm(func=mdp.action_rate_l2, weight=-0.01)


@configclass
class TerminationsCfg:
    """When an episode ends.

    Being stuck is a failure: as a truncation it would be worth what the view is worth for ever, and policies would wait
    for it.
    """

    time_out = DoneTerm(func=mdp.time_out, time_out=True)
    success = DoneTerm(func=mdp.success, success=True)
    stuck = DoneTerm(func=mdp.stuck, params={"window_s": 6.0, "min_progress": 0.003})
    scope_out = DoneTerm(func=mdp.scope_out)
    wall_penetrated = DoneTerm(func=mdp.wall_penetrated)
    lumen_not_visible: DoneTerm | None = None
    """Off. Ends hopeless episodes early, but keeps the policy from learning to find the lumen again:
    ``DoneTerm(func=mdp.lumen_not_visible, params={"threshold": -0.4, "steps": 5})``."""
    perforation: DoneTerm | None = None
    """Off, as in the paper. Ends the episode at a tip force that may perforate, 14.1 N by default:
    ``DoneTerm(func=mdp.load_above, params={"kind": "tip_force", "limit": "perforation"})``."""
    facing: DoneTerm | None = None
    """Off. Ends episodes in which the tip looks the wrong way along the lumen, for the training of a capsule, which may
    turn round and come out at the anus. On a way to the cecum:
    ``"env.terminations.facing={func: 'arcgym.envs.mdp:facing', params: {towards: anus, after_s: 1.0}}"``, on the way
    back, nose first, ``{towards: cecum}``. Evaluations have the task's own terminations, and so not this one."""
    cost_limit: DoneTerm | None = None
    """Off. Ends the episode when its cost passes a limit, with which constrained algorithms are compared:
    ``DoneTerm(func=mdp.episode_cost_above, params={"limit": 0.5, "cost": "tip_force"})``."""


@configclass
class EventsCfg:
    """Where an episode starts and what differs from world to world.

    Events of a mode run in this order. What each draws, and in which unit, is in its function's docstring.
    """

    patient: EventTerm | None = EventTerm(func=mdp.randomize_patient, mode="reset")
    """First: what follows belongs to the world's patient. Annotated, as fields with a type come before the others."""
    reset = EventTerm(func=mdp.reset_to_segment_start, mode="reset")
    aim = EventTerm(func=mdp.perturb_tip, mode="reset", params={"std": 0.1})
    light = EventTerm(func=mdp.randomize_light, mode="reset", params={"gain": (0.7, 1.4)})
    color = EventTerm(func=mdp.randomize_color, mode="reset", params={"gain": (0.9, 1.1)})
    texture = EventTerm(func=mdp.randomize_texture, mode="reset")
    stiffness = EventTerm(func=mdp.randomize_tissue_stiffness, mode="reset", params={"scale": (0.7, 1.4)})
    friction = EventTerm(func=mdp.randomize_friction, mode="reset", params={"friction": (0.05, 0.15)})
    preparation: EventTerm | None = None
    """Off unless ``env.clinical`` has ``preparation``: how clean the colon is, drawn for every episode."""


@configclass
class CostsCfg:
    """What a constrained policy keeps low; plain PPO ignores it.

    Each is 1 while something is wrong and 0 else, so that a cost of an episode is in seconds (with
    ``scale_rewards_by_dt``, else in control steps).
    """

    tip_force = CostTerm(func=mdp.load_above, params={"kind": "tip_force", "limit": "unsafe"})
    view_blocked = CostTerm(func=mdp.view_blocked)
    shaft_force: CostTerm | None = None
    """Off, as the pushed scope's shaft bears that for most of an episode. Seconds with an unsafe force on 50 mm of it:
    ``CostTerm(func=mdp.load_above, params={"kind": "shaft_force", "limit": "unsafe"})``."""
    lumen_pressure: CostTerm | None = None
    """Off unless ``env.gas`` is on: whether the pressure is one at which a cecum ruptured."""


@configclass
class NavigationEnvCfg(ManagerBasedRLEnvCfg):
    """Drive the tip from the start of a segment past its end, at 10 Hz.

    Subclass a task's configuration to change it::

        @configclass
        class MyEnvCfg(ProximalEnvCfg):
            def __post_init__(self):
                super().__post_init__()
                self.rewards.progress = None

    and register it for all segments, ``register_robot("Mine", "my_package.my_env_cfg:MyEnvCfg")``.
    """

    segment: str = MISSING
    """Segment to pass, one of :data:`arcgym.anatomy.segments.SEGMENTS`."""

    start: Start = "segment"
    """Beginning of an episode: ``segment``, a stored state at the segment's start, or ``rest``, straight in the anus,
    with the whole way to the segment's end to go. States that are missing are made when they are first needed."""

    direction: Literal["insertion", "withdrawal"] = "insertion"
    """``insertion``: to the end of the segment. ``withdrawal``: from the start of the segment back to the rectum; its
    rewards, terminations and metrics are those of ``ARC-Withdrawal-*``, which a task of your own has to take over."""

    episode_length_s: float | None = None  # type: ignore[assignment]
    """Longest episode [s]; None takes the time limit of segment and start, see
    :data:`arcgym_tasks.navigation.segments.TIME_LIMIT_S`."""

    lumen: mdp.LumenCfg | str = mdp.PAPER
    """Constants of the lumen reward: ``paper``, ``metric`` or your own :class:`arcgym.envs.mdp.LumenCfg`. ``metric``
    tells wall and diverticulum from lumen more sharply; ``paper`` is the benchmark's. A name and changes to it may
    follow each other: ``env.lumen=metric env.lumen.far=0.2``."""

    reward: Literal["shaped", "paper", "s_c", "s_1", "s_2", "s_o"] = "shaped"
    """``shaped``: all terms of ``rewards``. ``paper``: the paper's lumen reward alone, whatever ``rewards`` has;
    ``s_c``, ``s_1``, ``s_2`` and ``s_o``: that part of it alone, as in the paper's ablation. Its
    tasks move forward at a constant speed [m/s]: ``env.actions.tip.forward_velocity``, of a capsule
    ``env.actions.capsule.forward_velocity``, of a pushed scope ``env.actions.base.insertion_velocity``."""

    robustness: str = NONE
    """Variant that the task is made harder by, such as ``blur_2``, a kind and one of three strengths; see
    :data:`arcgym_tasks.navigation.robustness.VARIANTS`. ``none`` for the task as it is."""

    gas: Literal["none", "present", "commanded"] = "none"
    """Gas in the lumen. ``none`` as in every benchmark; ``present``: it is simulated, with metrics and a cost of its
    pressure (``env.scene.colon.gas`` holds its settings); ``commanded``: insufflation and suction are a further action,
    which policies that were trained without it do not have."""

    hand_pressure: Literal["none", "commanded"] = "none"
    """An assistant's hand on the abdomen. ``commanded``: where and how hard it presses is a further action, and the
    colon lies in an abdomen (``env.scene.colon.abdomen`` holds its settings). ``none`` in every benchmark."""

    clinical: tuple[str, ...] = ()
    """Effects of a living colon and a used scope to switch on: ``[all]``, or some of ``tissue``, ``relaxation``,
    ``gas``, ``tension``, ``weight``, ``scope``, ``friction``, ``abdomen``, ``mesentery``, ``loops``, and of the
    camera's, together ``camera``, ``latency``, ``exposure``, ``light`` and ``preparation``; see docs/clinical.md,
    Clinical. None in every benchmark."""

    force_tiers: mdp.ForceTiersCfg = mdp.ForceTiersCfg()
    """Limits that reward, costs, metrics, terminations and videos name ``comfort``, ``unsafe`` and ``perforation``."""

    scene: NavigationSceneCfg = NavigationSceneCfg()
    """Colon, endoscope, camera."""

    observations: ObservationsCfg = ObservationsCfg()
    """Groups ``policy`` and ``critic``, and those of ``extra_observations``."""

    extra_observations: tuple[str, ...] = ()
    """Further groups that some robots can sense, of ``force``, ``shape``, ``insertion`` and ``pressure``:
    ``env.extra_observations=[force] agent.obs_groups.actor=[policy,force]``. ``policy`` stays the images alone."""

    rewards: RewardsCfg = RewardsCfg()
    """Reward terms."""

    terminations: TerminationsCfg = TerminationsCfg()
    """Termination terms."""

    events: EventsCfg = EventsCfg()
    """Event terms."""

    costs: CostsCfg = CostsCfg()
    """Cost terms."""

    metrics: MetricsCfg = MetricsCfg()
    """Metrics."""

    decimation: int = 24
    """Physics steps in a control step: 0.1 s."""

    def __post_init__(self) -> None:
        """Nothing is derived from other fields; here for subclasses to call."""

    def validate_config(self) -> None:
        """Check numbers and names.

        Raises:
            ValueError: If a number is out of range, the segment or the lumen preset is unknown, or solver or robot
                cannot do what a term needs.
        """
        require(self, "segment", SEGMENTS)
        require(self, "start", get_args(Start))
        require(self, "reward", ("shaped", "paper", *ABLATED))
        require(self, "extra_observations", tuple(EXTRA_OBSERVATIONS))
        require(self, "robustness", (NONE, *VARIANTS))
        require(self, "clinical", (*clinical.GROUPS, *clinical.EFFECTS))
        clinical.check(self)
        check_gas(self)
        check_hand(self)
        require(self, "direction", ("insertion", "withdrawal"))
        if self.direction == "withdrawal" and self.start == "rest":
            raise FieldError(
                self, "start", "is 'rest', at the anus: a withdrawal starts at a segment, env.start=segment."
            )
        if self.direction == "withdrawal" and self.terminations.stuck is not None:
            raise FieldError(
                self,
                "direction",
                "is 'withdrawal' with terminations.stuck, which counts the way to the cecum: take ARC-Withdrawal-*, or "
                "set env.terminations.stuck=null and rewards and metrics of your own.",
            )
        check_back_off(self)
        super().validate_config()
        mdp.resolve_lumen(self.lumen)
        if self.sim.solver == "newton":
            self._check_newton()

    def _check_newton(self) -> None:
        """Refuse terms that need the two-level solver."""
        terms = {
            "env.terminations.wall_penetrated": self.terminations.wall_penetrated,
            "env.events.stiffness": self.events.stiffness,
            "env.events.friction": self.events.friction,
        }
        used = [f"{name}=null" for name, term in terms.items() if term is not None]
        if used:
            raise FieldError(self, "sim.solver", f"is 'newton', which needs {' '.join(used)}; or choose 'two_level'.")

    def resolve(self) -> None:
        """Make the task harder, add groups of observations, leave the paper's reward alone, where that is asked for."""
        clinical.make_clinical(self)
        make_harder(self, self.robustness)
        add_gas(self)
        add_hand(self)
        add_observations(self.observations, self.extra_observations)
        if self.reward in ABLATED:
            self.rewards.lumen = RewTerm(func=mdp.lumen_part, weight=1.0, params={"part": self.reward})
        if self.reward != "shaped":
            for name in vars(self.rewards):
                setattr(self.rewards, name, self.rewards.lumen if name == "lumen" else None)

    @property
    def max_episode_length_s(self) -> float:
        """Longest episode [s], as set or as segment and start have it."""
        return time_limit_s(self.segment, self.start) if self.episode_length_s is None else self.episode_length_s

    @property
    def scope_length(self) -> float | None:
        """Length of the scope [m], ``env.scene.endoscope.length``; None for that of its stage.

        A task sets it for all robots. A scope that comes in one length alone keeps it: the capsule, a stage of one's
        own.
        """
        return self.scene.endoscope.length

    @scope_length.setter
    def scope_length(self, length: float | None) -> None:
        # a configuration to derive others from has no robot, and so no stage, yet
        if has_lengths(str(getattr(self.scene.endoscope, "usd_path", ""))):
            self.scene.endoscope.length = length

    @property
    def stuck_after_s(self) -> float | None:
        """Time without progress after which an episode ends [s], ``env.terminations.stuck.params.window_s``.

        None where none ends so. A task that leaves ``stuck`` out leaves it out on a journey, too.
        """
        stuck = self.terminations.stuck
        return None if stuck is None else stuck.params["window_s"]

    @stuck_after_s.setter
    def stuck_after_s(self, seconds: float) -> None:
        if self.terminations.stuck is not None:
            self.terminations.stuck.params["window_s"] = seconds

    def play(self) -> None:
        """Make the task fit for watching: few worlds, nothing randomized, no noise on the observations."""
        self.scene.num_envs = 4
        self.observations.policy.enable_corruption = False
        for name in ("patient", "aim", "light", "color", "texture", "stiffness", "friction"):
            setattr(self.events, name, None)
