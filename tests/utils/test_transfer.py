# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

from __future__ import annotations

import pytest
import torch

from arcgym.utils.transfer import HostCopy, send

DEVICES = ["cpu", *(["cuda:0"] if torch.cuda.is_available() else [])]


@pytest.mark.parametrize("device", DEVICES)
def test_answer_is_of_the_time_when_it_was_asked_for(device: str) -> None:
    values = torch.tensor([True, False, True], device=device)
    copy = HostCopy(values)
    copy.ask(values)
    values.logical_not_()
    assert copy.wait().device.type == "cpu" and copy.wait().tolist() == [True, False, True]
    copy.ask(values)
    assert copy.wait().tolist() == [False, True, False]


@pytest.mark.parametrize("device", DEVICES)
def test_what_is_sent_arrives(device: str) -> None:
    for values in (torch.tensor([3, 1]), torch.zeros(0, dtype=torch.long)):
        sent = send(values, device)
        assert sent.device == torch.device(device) and sent.tolist() == values.tolist()
