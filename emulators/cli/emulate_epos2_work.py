"""Puts drives without a robot on real links, in real time."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from emulators.cli.emulate_epos2 import DrivesOptions
from emulators.cli.options import find_profile
from emulators.epos2.objects.choices import ChoiceError, chosen
from emulators.epos2.objects.device_profile import BAUDS, BIT_RATES, DeviceProfile, realistic
from emulators.epos2.objects.saved_parameters import StorageError
from emulators.epos2.serial.serial_drive import baud_of
from emulators.gateway import Cluster
from emulators.servo.bank import ServoError
from emulators.servo.motor import MOTOR, DcMotor
from emulators.single import Order, drives
from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.cli.links import on_the_line, opened
from firmware_bridge.cli.node_numbers import numbers
from firmware_bridge.cli.options import until
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.recorded import recording
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.shell.black_box import CAN_LOG, SERIAL_LOG
from firmware_bridge.shell.clock import LivedClock
from firmware_bridge.wire.maxon.frame import Generation
from fmu.errors import PlantError

DEFAULT_BIT_RATE: Final = 1_000_000


def emulate(given: DrivesOptions) -> None:
    """Do what `emulate epos2` says; what is wrong ends the program with a message."""
    nodes = numbers(given.node)
    if given.dip_off and len(nodes) != 1:
        raise refusal("--dip-off: drives with their switches at 0 all begin as node 1; emulate one of them")
    names = tuple(given.axes.split(",")) if given.axes else ()
    if names and len(names) != len(nodes):
        raise refusal(
            f"--axes {given.axes}: there are {len(nodes)} nodes and {len(names)} axes; name one for each"
        )
    rate = given.bit_rate or DEFAULT_BIT_RATE
    near = on_the_line(given, nodes)
    order = Order(
        nodes=nodes,
        profile=replace(
            _profile(given.profile, rate, given.choice or (), latency=given.realistic_latency),
            rs232_rate=_rs232(given.baud, given.serial, given.protocol),
        ),
        bit_rate=rate,
        motor=_loaded(given.load),
        plant=given.plant,
        plant_parameters=_settings(given.values or [], given.plant),
        axes=names,
        supply_mv=round(given.supply * 1000),
        parameters=given.parameters,
        dip_off=given.dip_off,
        serial={} if given.serial is None else {near: given.protocol},
    )
    with one_message(PlantError, StorageError, ServoError):
        made, bank = drives(order)
    owner = order.names[nodes.index(near)]
    line = "" if given.serial is None else f", node {near} on the line"
    with recording(given.record, {CAN: CAN_LOG, SERIAL: SERIAL_LOG}) as (around, _):
        openers, where = opened(given, given.protocol, baud_of(made[owner]), DEFAULT_BIT_RATE)
        carry(
            around(Cluster(made, bank, links={owner: {CAN: CAN, SERIAL: SERIAL}})),
            openers,
            until(given.duration),
            f"{order.profile.name} on {where}: node {given.node}{line}",
            PlantError,
            ServoError,
            clock=LivedClock(),
        )


def _profile(name: str, rate: int, choices: Sequence[str], *, latency: bool) -> DeviceProfile:
    codes = {bits: code for code, bits in BIT_RATES.items()}
    if rate not in codes:
        raise refusal(f"--bitrate {rate}: an EPOS2 knows {', '.join(map(str, codes))}")
    found = replace(find_profile(name), bit_rate=codes[rate])
    with one_message(ChoiceError):
        return chosen(realistic(found) if latency else found, choices)


def _rs232(baud: int | None, serial: str | None, protocol: Generation | None) -> int:
    """Return the code of a rate on RS232; what makes no sense ends the program with a message."""
    if baud is None:
        return len(BAUDS) - 1
    if serial is None or protocol is Generation.V2:
        raise refusal(f"--baud {baud}: only a line of RS232 has a rate; say --serial pty --protocol v1")
    if baud not in BAUDS:
        raise refusal(f"--baud {baud}: an EPOS2 knows {', '.join(map(str, BAUDS))}")
    return BAUDS.index(baud)


def _settings(values: Sequence[str], plant: Path | None) -> dict[str, float]:
    if values and plant is None:
        raise refusal(
            f"--set {values[0]}: there is no plant whose parameter that could be; name one by --plant"
        )
    found: dict[str, float] = {}
    for text in values:
        name, _, number = text.partition("=")
        try:
            found[name] = float(number)
        except ValueError:
            raise refusal(f"--set {text}: say NAME=VALUE, as stop_low=-1.0") from None
    return found


def _loaded(load: str | None) -> DcMotor:
    if load is None:
        return MOTOR
    try:
        inertia, friction = (float(part) for part in load.split(","))
    except ValueError:
        raise refusal(f"--load {load}: say INERTIA,FRICTION in kg m2 and N m, as 2e-5,0.001") from None
    if not (0.0 < inertia < float("inf") and 0.0 <= friction < float("inf")):
        raise refusal(f"--load {load}: the inertia must be more than 0, the friction not less")
    return replace(MOTOR, inertia=inertia, friction=friction)
