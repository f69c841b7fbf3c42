# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

"""What spoils a picture, on pictures that a reader can work out: two worlds, 20 x 20 pixels."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import warp as wp

from arcgym.envs import mdp
from arcgym.envs.mdp.image_faults import MURK
from arcgym.managers import ObservationTermCfg
from arcgym.sensors.camera_rays import fisheye_rays

SIZE = 20


@pytest.fixture
def pictures(env):
    """An even gray, 5 cm away everywhere."""
    camera = env.scene["camera"]
    camera.data.output = {
        "rgb": torch.full((2, SIZE, SIZE, 3), 100, dtype=torch.uint8),
        "depth": torch.full((2, SIZE, SIZE), 0.05),
    }
    pose = np.tile(np.array([0, 0, 0, 0, 0, 0, 1], np.float32), (2, 1))
    camera.renderer = SimpleNamespace(
        drawn_from=wp.array(pose, dtype=wp.transform),
        rays=wp.array(fisheye_rays(SIZE, SIZE, math.radians(150.0)), dtype=wp.vec3),
    )
    return env


def term(env, kind: str, amount: float) -> mdp.impaired_rgb:
    cfg = ObservationTermCfg(func=mdp.impaired_rgb, params={"kind": kind, "amount": amount})
    made = mdp.impaired_rgb(cfg, env)
    made.reset(None)
    return made


def spoiled(env, kind: str, amount: float) -> torch.Tensor:
    return term(env, kind, amount)(env, kind, amount).clone()


@pytest.mark.parametrize("kind", mdp.IMAGE_FAULTS)
def test_nothing_of_it_leaves_the_picture_as_it_is(pictures, kind: str) -> None:
    image = spoiled(pictures, kind, 0.0)
    assert image.shape == (2, 3, SIZE, SIZE) and image.dtype == torch.uint8 and bool((image == 100).all())


def test_fluid_fades_by_beer_and_lambert(pictures) -> None:
    """20 per meter over 5 cm leave exp(-1) of the picture."""
    left = math.exp(-1.0)
    expected = [round(100 * left + (1 - left) * murk) for murk in MURK]
    assert spoiled(pictures, "fluid", 20.0)[1, :, 3, 4].tolist() == expected


def test_blur_spreads_an_edge_and_keeps_an_even_picture(pictures) -> None:
    assert bool((spoiled(pictures, "blur", 0.1) == 100).all())
    pictures.scene["camera"].data.output["rgb"][0, :, SIZE // 2 :] = 200
    row = spoiled(pictures, "blur", 0.1)[0, 0, 5].tolist()
    assert row == sorted(row) and row[0] == 100 and row[-1] == 200 and 138 < row[SIZE // 2 - 1] < 150 < row[SIZE // 2]


@pytest.mark.parametrize("kind", ["stool", "bubbles"])
def test_what_lies_on_the_wall_covers_more_of_it_with_a_larger_share(pictures, kind: str) -> None:
    """Balls of about 0.45 cells in all cells fill 4/3 pi 0.45^3 of space, 38 %, less what they share."""
    some, all_ = (float((spoiled(pictures, kind, share) != 100).any(dim=1).float().mean()) for share in (0.2, 1.0))
    assert 0.02 < some < 0.2 < all_ < 0.5


def test_what_lies_on_the_wall_stays_there_while_the_camera_turns(pictures) -> None:
    """A quarter turn about the axis of the view turns the picture of the stool by a quarter."""
    stool = term(pictures, "stool", 0.4)
    before = stool(pictures, "stool", 0.4)[0, 0].clone()
    half = math.sqrt(0.5)
    turned = np.tile(np.array([0, 0, 0, 0, 0, half, half], np.float32), (2, 1))
    pictures.scene["camera"].renderer.drawn_from.assign(turned)
    after = stool(pictures, "stool", 0.4)[0, 0]
    same = (torch.rot90(before, -1).int() - after.int()).abs() <= 2
    assert float(same.float().mean()) > 0.95


def test_drops_show_the_picture_turned_about(pictures) -> None:
    pictures.scene["camera"].data.output["rgb"][:, : SIZE // 2] = 200
    image = spoiled(pictures, "droplets", 12.0)[0, 0].int()
    changed = image != torch.where(torch.arange(SIZE)[:, None] < SIZE // 2, 200, 100)
    assert 0.01 < float(changed.float().mean()) < 0.6


def test_noise_has_its_deviation_and_is_another_one_every_step(pictures) -> None:
    noisy = term(pictures, "noise", 12.0)
    first = noisy(pictures, "noise", 12.0).float().clone()
    again = noisy(pictures, "noise", 12.0).float()
    assert torch.equal(first, again)
    assert float(first.mean()) == pytest.approx(100.0, abs=2.0) and float(first.std()) == pytest.approx(12.0, rel=0.1)
    pictures.episode_length_buf += 1
    assert not torch.equal(first, noisy(pictures, "noise", 12.0).float())


def test_a_lost_picture_is_the_one_before(pictures) -> None:
    """One of two pictures is lost on average; the first of an episode never is."""
    lossy = term(pictures, "dropped", 0.5)
    image, shown = pictures.scene["camera"].data.output["rgb"], []
    for number in range(60):
        image.fill_(number)
        shown.append(int(lossy(pictures, "dropped", 0.5)[0, 0, 0, 0]))
        pictures.random.advance()
    assert shown[0] == 0 and all(one <= number for number, one in enumerate(shown))
    lost = sum(one < number for number, one in enumerate(shown))
    assert 15 < lost < 45


def test_a_world_depends_on_its_own_seed_alone(pictures) -> None:
    image = spoiled(pictures, "stool", 0.4)
    assert not torch.equal(image[0], image[1])
    pictures.random._give(torch.arange(2), torch.tensor([5, 5]))
    image = spoiled(pictures, "stool", 0.4)
    assert torch.equal(image[0], image[1])
