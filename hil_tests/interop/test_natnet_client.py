"""`emulate capture` and PyPI's natnet client, two programs on loopback: a body goes round, and is read.

The client is made for 2.x to 4.2. It leaves the precise stamps of 4.1 and the software latency of 2.x unread;
what stands behind them is not compared there.
"""

import math
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import pytest
from natnet import NatNetClient

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND

PROGRAM: Final = Path(sys.executable).with_name("firmware-bridge")
WITHIN: Final = 30 * SECOND
"""A loaded machine takes its time; nothing here is measured."""
WANTED: Final = 48


@contextmanager
def emulated(*words: str) -> Iterator[int]:
    process = subprocess.Popen(
        [PROGRAM, "emulate", "capture", "--command-port", "0", "--data-port", "0", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    try:
        assert process.stdout is not None
        greeting = process.stdout.readline()
        port = re.search(r":(\d+), frames", greeting)
        assert port is not None, greeting
        yield int(port[1])
    finally:
        process.kill()
        process.wait()
        if process.stdout is not None:
            process.stdout.close()


@pytest.mark.parametrize("version", ["3.1", "2.10", "4.1"])
def test_a_third_party_client_reads_the_stream(version: str) -> None:
    received: list[Any] = []
    models: list[Any] = []
    with (
        emulated("--natnet", version, "--up", "z", "--noise-mm", "0", "--body", "rome") as port,
        NatNetClient("127.0.0.1", "127.0.0.1", command_port=port, use_multicast=False) as client,
    ):
        client.on_data_frame_received_event.handlers.append(received.append)
        client.on_data_description_received_event.handlers.append(models.append)
        client.request_modeldef()
        clock = Clock()
        while len(received) < WANTED or not models:
            assert clock.now() < WITHIN, f"{len(received)} frames, {len(models)} models"
            client.update_sync()
            clock.wait([], clock.now() + MILLISECOND)
        assert client.server_info.application_name == "Motive"
        assert str(client.protocol_version).startswith(version)
    assert [body.name for body in models[0].rigid_bodies] == ["rome"]
    for frame in received:
        (body,) = frame.rigid_bodies
        angle = 0.5 * frame.prefix.frame_number / 240
        assert body.id_num == 1
        assert body.pos == pytest.approx((math.cos(angle), math.sin(angle), 0.2), abs=1e-5)
        assert body.tracking_valid
        assert len(frame.labeled_markers) == 3
        if version == "3.1":
            assert frame.suffix.timestamp == pytest.approx(frame.prefix.frame_number / 240, abs=1e-6)
            assert not frame.suffix.is_recording
    numbers = [frame.prefix.frame_number for frame in received]
    assert numbers == sorted(set(numbers))
