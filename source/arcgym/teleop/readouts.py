# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""The numbers on the page, as HTML."""

from __future__ import annotations

import math
from html import escape

from arcgym.assets.gas_cfg import MMHG
from arcgym.envs.mdp.gas import RUPTURE_PRESSURE
from arcgym.teleop.frames import Frame
from arcgym.teleop.session import Status
from arcgym.viewers.palette import FORCE_TIERS, Tiers, force_tier

CELL = (
    "<div style='min-width:88px'><div style='font-size:11px;opacity:.65'>{label}</div>"
    "<div style='font-size:17px;font-variant-numeric:tabular-nums;color:{color}'>{value}</div></div>"
)
"""A figure of the page with its name above it."""


def readouts(frame: Frame | None, status: Status, tiers: Tiers, latency: float, picture_rate: float) -> str:
    """Return the panel of numbers."""
    state = f"<b>{escape(status.state)}</b> · {escape(status.driver)} drives"
    head = f"<div style='margin-bottom:6px'>{state}<br><span style='opacity:.75'>{escape(status.message)}</span></div>"
    if frame is None:
        return f"<div id='arcgym-readouts' style='padding:8px 14px'>{head}</div>"
    info, runs = frame.info, status.state == "running"
    cells = [
        ("time", f"{info.time:.1f} s", ""),
        (f"tip in {info.segment}", f"{100 * info.tip_arc:.1f} cm", ""),
        ("inserted", f"{100 * info.inserted:.1f} cm", ""),
        ("force on tip", f"{info.tip_force:.2f} N", _color(info.tip_force, tiers)),
        ("force on shaft", f"{info.max_force:.2f} N", _color(info.max_force, tiers)),
        ("tier", frame.tier, _color(info.tip_force, tiers)),
        ("push on base", f"{frame.base_force:.1f} N", ""),
        ("wall strain", _number(100 * frame.wall_strain, "{:.1f} %"), ""),
        ("pull on anchors", _number(frame.anchor_tension, "{:.2f} N"), ""),
        ("pressure in lumen", _number(frame.lumen_pressure / MMHG, "{:.1f} mmHg", "no gas"), _warning(frame)),
        ("progress", _number(100 * frame.progress, "{:.0f} %"), ""),
        ("looping ratio", _number(frame.looping, "{:.2f}"), ""),
        ("recorded", f"{status.steps} steps", ""),
        ("control", f"{status.rate:.1f} steps/s" if runs else "–", ""),
        ("pictures", f"{picture_rate:.1f} /s" if runs else "–", ""),
        ("latency", _number(1000 * latency, "{:.0f} ms"), ""),
    ]
    grid = "".join(CELL.format(label=escape(name), value=escape(value), color=color) for name, value, color in cells)
    body = f"<div style='display:flex;flex-wrap:wrap;gap:8px 12px'>{grid}</div>"
    return f"<div id='arcgym-readouts' style='padding:8px 14px'>{head}{body}</div>"


def _color(force: float, tiers: Tiers) -> str:
    return "rgb({}, {}, {})".format(*force_tier(force, tiers).color)


def _warning(frame: Frame) -> str:
    """Return the color of the pressure: that of the last tier where a cecum ruptures, else the text's."""
    return "rgb({}, {}, {})".format(*FORCE_TIERS[-1].color) if frame.lumen_pressure > RUPTURE_PRESSURE else ""


def _number(value: float, form: str, without: str = "–") -> str:
    return without if math.isnan(value) else form.format(value)
