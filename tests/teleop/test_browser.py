# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""A real Chromium, without a window, opens the page of a real session and steers it."""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from small_session import until

from arcgym.cli.main import main
from arcgym.managers import Episode

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="needs Debian's chromium and chromium-driver"),
]
FLAGS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,700", "--use-gl=angle")
FLAGS += ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
TOKEN = "a-token-of-the-test"
FAR = 120.0
"""Longest wait on a machine that others use too [s]."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    pytest.importorskip("selenium")
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in FLAGS:
        options.add_argument(flag)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    driver.set_page_load_timeout(FAR)
    driver.set_script_timeout(FAR)
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def page(make_session) -> Iterator[Any]:
    pytest.importorskip("viser")
    from arcgym.teleop.page import Page

    session = make_session(gas=True)  # as the command starts one
    session.needs_page, session.speed = True, 1.0
    page = Page(session, "127.0.0.1", 0, TOKEN, size=96)
    page.session = session
    yield page
    page.close()


@pytest.fixture
def tab(browser, page) -> Any:
    """The browser on the page, alone; the session at a fresh start."""
    for handle in browser.window_handles[1:]:
        browser.switch_to.window(handle)
        browser.close()
    browser.switch_to.window(browser.window_handles[0])
    browser.get(page.gate.url)
    until(lambda: state(browser).get("connected") and numbers(browser), FAR)
    page.session.start_anew(keep=False).result()
    return browser


def state(browser: Any) -> dict[str, Any]:
    return browser.execute_script("return window.arcgym || {}")


def numbers(browser: Any) -> str:
    return browser.execute_script("const e = document.getElementById('arcgym-readouts'); return e ? e.innerText : ''")


def key(browser: Any, kind: str, code: str) -> None:
    script = "document.body.dispatchEvent(new KeyboardEvent(arguments[0], {code: arguments[1], bubbles: true}))"
    browser.execute_script(script, kind, code)


def click(browser: Any, text: str) -> None:
    """Press the button, or open the folder, with a text."""
    script = """const all = [...document.querySelectorAll('button, label, legend, div, span, p')];
        const one = all.reverse().find((b) => (b.innerText || '').trim() === arguments[0]);
        if (!one) return false; one.scrollIntoView(); one.click(); return true;"""
    until(lambda: browser.execute_script(script, text), FAR)


def hold(browser: Any, text: str) -> None:
    """Press the button with a text and keep it pressed."""
    press = """const b = [...document.querySelectorAll('button')].find((b) => b.innerText.trim() === arguments[0]);
        if (!b) return false; b.dispatchEvent(new PointerEvent('pointerdown', {bubbles: true, button: 0}));
        b.dispatchEvent(new MouseEvent('mousedown', {bubbles: true, button: 0})); return true;"""
    until(lambda: browser.execute_script(press, text), FAR)


def let_go(browser: Any, text: str) -> None:
    """Release a button that is held."""
    script = """for (const kind of ['pointerup', 'mouseup'])
        window.dispatchEvent(new MouseEvent(kind, {bubbles: true, button: 0}));
        const b = [...document.querySelectorAll('button')].find((b) => b.innerText.trim() === arguments[0]);
        for (const kind of ['pointerup', 'mouseup', 'mouseleave'])
        b.dispatchEvent(new MouseEvent(kind, {bubbles: true, button: 0}));"""
    browser.execute_script(script, text)


def pressure(browser: Any) -> float:
    """Return the pressure that the page shows [mmHg]; NaN without."""
    found = re.search(r"pressure in lumen\s+(-?[\d.]+) mmHg", numbers(browser))
    return float(found.group(1)) if found else float("nan")


def choose(browser: Any, label: str, option: str) -> None:
    """Choose an option of the list with a label, as a person does: open it, then press the option."""
    opens = """const label = [...document.querySelectorAll('label')].find((l) => l.innerText.trim() === arguments[0]);
        const list = label && document.getElementById(label.htmlFor);
        if (!list) return false; list.scrollIntoView(); list.click(); return true;"""
    takes = """const all = [...document.querySelectorAll('[role=option]')].filter((o) => o.offsetParent);
        const one = all.find((o) => o.innerText.trim() === arguments[0]);
        if (!one) return false; one.click(); return true;"""
    until(lambda: browser.execute_script(opens, label), FAR)
    until(lambda: browser.execute_script(takes, option), FAR)


def shown(browser: Any, label: str) -> str:
    """Return what the list with a label shows."""
    script = """const label = [...document.querySelectorAll('label')].find((l) => l.innerText.trim() === arguments[0]);
        return label ? document.getElementById(label.htmlFor).value : ''"""
    return browser.execute_script(script, label)


def shot(browser: Any, name: str, folder: Path) -> np.ndarray:
    path = Path(os.environ.get("ARCGYM_SHOTS", folder)) / f"{name}.png"
    browser.save_screenshot(str(path))
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def test_page_loads_and_shows_the_world(tab, page, tmp_path) -> None:
    assert tab.title == "ARCGym" and "token" not in tab.current_url
    until(lambda: "force on tip" in numbers(tab) and "paused" in numbers(tab), FAR)
    source = (
        "const i = [...document.images].find((i) => i.naturalWidth == 96); return i ? i.getBoundingClientRect() : 0"
    )
    until(lambda: tab.execute_script(source), FAR)
    place = tab.execute_script(source)
    picture = shot(tab, "loaded", tmp_path)
    x, y = int(place["x"] + place["width"] / 2), int(place["y"] + place["height"] / 2)
    red, green, blue = picture[y - 40 : y + 40, x - 40 : x + 40].reshape(-1, 3).mean(axis=0)
    assert place["width"] > 400 and red > 1.3 * blue and red > green  # large, and of mucosa


def test_a_wrong_token_is_refused(browser, page) -> None:
    browser.delete_all_cookies()
    for address in (page.gate.url.replace(TOKEN, "wrong"), f"http://localhost:{page.gate.port}/"):
        browser.get("about:blank")
        browser.get(address)
        until(lambda: "needs the address" in browser.page_source, FAR)  # the browser shows it a moment later
        assert "ARCGym" not in browser.title


def test_keys_move_the_scope_while_they_are_held(tab, page) -> None:
    session = page.session
    start = session.frame.info.inserted
    key(tab, "keydown", "Space")
    until(lambda: session.status.state == "running", FAR)
    key(tab, "keydown", "KeyW")
    until(lambda: session.frame.info.inserted > start + 0.02, FAR)
    key(tab, "keyup", "KeyW")
    until(lambda: not session.hand.value().any(), FAR)
    key(tab, "keydown", "Space")
    until(lambda: session.status.state == "paused", FAR)
    steps = session.status.steps
    time.sleep(0.5)
    assert session.status.steps == steps
    assert "KeyW" not in str(state(tab)) and state(tab)["steps"] >= 1


def test_held_buttons_and_a_gamepad_command(tab, page) -> None:
    session = page.session
    click(tab, "Buttons to hold")
    hold(tab, "+ insertion")
    until(lambda: session.hand.value()[0] > 0.5, FAR)
    let_go(tab, "+ insertion")
    until(lambda: not session.hand.value().any(), FAR)
    pad = "({connected: true, axes: [0, -0.8, 0, 0], buttons: []})"
    tab.execute_script(f"navigator.getGamepads = () => [{pad}]")
    until(lambda: session.hand.value()[0] == pytest.approx(0.8), FAR)
    tab.execute_script("navigator.getGamepads = () => []")
    until(lambda: not session.hand.value().any(), FAR)


def test_the_pressure_rises_while_insufflation_is_held_and_falls_by_suction(tab, page, tmp_path) -> None:
    session = page.session
    until(lambda: pressure(tab) == 20.0, FAR)  # that of the imaged shape
    click(tab, "Go")
    click(tab, "Buttons to hold")
    hold(tab, "+ insufflation")
    until(lambda: pressure(tab) > 21.0, FAR)
    let_go(tab, "+ insufflation")
    until(lambda: not session.hand.value().any(), FAR)
    assert session.frame.lumen_pressure > 21.0 * 133.3
    high = pressure(tab)
    shot(tab, "insufflated", tmp_path)
    key(tab, "keydown", "KeyB")
    until(lambda: pressure(tab) < high - 3.0, FAR)
    key(tab, "keyup", "KeyB")
    session.pause(True).result()
    path = session.save().result()
    shown_then = Episode.load(path).data["wall/lumen_pressure"]
    assert shown_then.max() > 21.0 * 133.3 and shown_then[-1] < (high - 2.9) * 133.3
    assert main(["replay", str(path), "--device", "cpu"]) == 0


def test_a_second_tab_and_a_lost_connection_lose_nothing(tab, page) -> None:
    session, first = page.session, tab.current_window_handle
    key(tab, "keydown", "Space")
    key(tab, "keydown", "KeyW")
    until(lambda: session.status.steps >= 4, FAR)
    key(tab, "keyup", "KeyW")
    key(tab, "keydown", "Space")  # a tip that stood still while the second tab loads would end the episode as stuck
    until(lambda: session.status.state == "paused", FAR)
    tab.switch_to.new_window("tab")
    tab.get(page.gate.url)
    until(lambda: state(tab).get("connected"), FAR)
    until(lambda: page.hand_server.tabs == 2, FAR)
    tab.close()
    tab.switch_to.window(first)
    until(lambda: page.hand_server.tabs == 1, FAR)
    assert session.status.state == "paused"
    key(tab, "keydown", "Space")
    until(lambda: session.status.state == "running", FAR)
    key(tab, "keydown", "KeyW")
    until(lambda: session.hand.value().any(), FAR)
    before = session.status.steps
    tab.get("about:blank")
    until(lambda: page.hand_server.tabs == 0 and session.status.state == "waiting", FAR)
    held = session.status.steps
    assert held >= before and not session.hand.value().any()
    time.sleep(1.0)
    assert session.status.steps == held
    tab.get(page.gate.url)
    until(lambda: state(tab).get("connected") and session.status.steps > held, FAR)
    session.pause(True).result()


def test_marks_undo_and_save_by_buttons_and_the_file_replays(tab, page, tmp_path) -> None:
    session = page.session
    click(tab, "Go")
    key(tab, "keydown", "KeyW")
    until(lambda: session.status.steps >= 6, FAR)
    click(tab, "Mark")
    until(lambda: len(session.status.marks) == 2, FAR)
    until(lambda: session.status.steps >= 14, FAR)
    key(tab, "keyup", "KeyW")
    click(tab, "Undo")
    until(lambda: session.status.undone == 1 and session.status.state == "paused", FAR)
    click(tab, "Go")
    key(tab, "keydown", "KeyI")
    steps = session.status.steps
    until(lambda: session.status.steps >= steps + 5, FAR)
    key(tab, "keyup", "KeyI")
    click(tab, "Pause")
    until(lambda: session.status.state == "paused", FAR)
    click(tab, "Save")
    until(lambda: session.status.message.startswith("saved: "), FAR)
    until(lambda: "saved: " in numbers(tab), FAR)
    shot(tab, "saved", tmp_path)
    path = session.status.message.removeprefix("saved: ")
    assert Episode.load(path).info["undone"] == 1
    assert main(["replay", path, "--device", "cpu"]) == 0


def test_latency_is_measured(tab, page) -> None:
    until(lambda: state(tab).get("latency") is not None, FAR)
    assert 0.0 < float(np.median([state(tab)["latency"] for _ in range(5)])) < 1.0
    print(f"\nlatency of the hand's messages: {1000 * page.hand_server.latency:.1f} ms")


def test_a_policy_drives_a_key_takes_over_and_that_is_recorded(tab, page) -> None:
    session = page.session
    choose(tab, "driver", "expert")
    until(lambda: session.status.driver == "expert", FAR)
    click(tab, "Go")
    until(lambda: session.status.steps >= 4, FAR)
    key(tab, "keydown", "KeyS")
    until(lambda: session.status.driver == "hand" and session.status.interventions == 1, FAR)
    steps = session.status.steps
    until(lambda: session.status.steps >= steps + 3 and shown(tab, "driver") == "hand", FAR)
    key(tab, "keyup", "KeyS")
    click(tab, "Pause")
    until(lambda: session.status.state == "paused", FAR)
    path = session.save().result()
    episode = Episode.load(path)
    leads = episode.data["hand/leads"].tolist()
    first = leads.index(1)
    assert first >= 4 and leads == [0] * first + [1] * (len(leads) - first)
    assert episode.info["interventions"] == 1 and episode.data["actions"][first, 0] < 0.0
    assert main(["replay", str(path), "--device", "cpu"]) == 0


def test_single_steps_and_slow_motion(tab, page) -> None:
    from selenium.webdriver.common.by import By

    session = page.session
    click(tab, "Step")
    until(lambda: session.status.steps == 1, FAR)
    key(tab, "keydown", "Period")
    until(lambda: session.status.steps == 2 and session.status.state == "paused", FAR)
    thumbs = tab.find_elements(By.CSS_SELECTOR, "[role=slider]")
    pace = next(thumb for thumb in thumbs if thumb.get_attribute("aria-valuemax") == "2")
    for _ in range(16):
        pace.send_keys("\ue012")  # to the left: 16 times 0.05 below 1
    until(lambda: session.speed == pytest.approx(0.2), FAR)
    click(tab, "Go")
    until(lambda: session.status.steps >= 4, FAR)
    before, start = session.status.steps, time.monotonic()
    until(lambda: session.status.steps >= before + 3, FAR)
    assert time.monotonic() - start > 1.0  # three steps of 0.1 s, five times as slowly
    session.pause(True).result()
    session.speed = 1.0


def test_the_colon_is_seen_from_another_side(tab, page, tmp_path) -> None:
    (client,) = page._viser.get_clients().values()
    front = np.array(client.camera.position)
    click(tab, "left")
    until(lambda: np.linalg.norm(np.array(client.camera.position) - front) > 0.3, FAR)
    assert client.camera.position[0] < page._middle[0] - 0.3
    until(lambda: shot(tab, "left", tmp_path).std() > 1.0, FAR)


def test_another_robot_is_loaded_and_steered_by_its_own_keys(tab, page, tmp_path) -> None:
    session = page.session
    choose(tab, "task and robot", "ARC-Splenic-Capsule")
    click(tab, "Load")
    until(lambda: session.status.choice.task == "ARC-Splenic-Capsule" and session.status.state == "paused", FAR)
    until(lambda: state(tab).get("axes") == list(session.hand.axes), FAR)
    assert len(session.hand.axes) == 7  # of the tip, and gas
    click(tab, "Go")
    key(tab, "keydown", "KeyR")
    up = session.hand.axes.index("up")
    until(lambda: session.hand.value()[up] > 0.5 and session.status.steps >= 3, FAR)
    key(tab, "keyup", "KeyR")
    shot(tab, "capsule", tmp_path)
    session.pause(True).result()
