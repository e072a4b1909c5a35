"""MAVSDK, a third party, drives the robot on the bench over a real socket, by its own library."""

import asyncio
import socket
import threading
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from typing import Any, Final, TypeVar

import pytest

from emulators.rig import Rig
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from firmware_bridge.wire.internet import number_of
from hil_tests.scenarios.ride import READY_S, ride

T = TypeVar("T")

WITHIN_S: Final = 30.0
"""A loaded machine takes its time."""
SENT_EACH_S: Final = 0.05
LOOKED_AT_EACH: Final = 5 * MILLISECOND
STEP_S: Final = 0.005
PLACE: Final = number_of("192.0.2.9", 14550)
"""MAVSDK's, as the bridge sees it."""
WATCHED_S: Final = 3.5
"""3 s after its start Offboard stops sending set-points if no heartbeat reports its mode."""

pytestmark = pytest.mark.timeout(240)


@dataclass
class Station:
    """MAVSDK's plugins for one robot."""

    telemetry: Any
    action: Any
    offboard: Any
    manual: Any
    info: Any
    sdk: Any
    """The module of its value classes."""
    stick: float = 0.0

    async def newest(self, stream: Callable[[], AsyncGenerator[T, None]]) -> T:
        """Return the next item of a stream."""
        async with asyncio.timeout(WITHIN_S):
            return await anext(aiter(stream()))

    async def reported(
        self,
        stream: Callable[[], AsyncGenerator[T, None]],
        met: Callable[[T], bool],
        within_s: float = WITHIN_S,
    ) -> T:
        """Return the first item of a stream that is as wanted."""
        async with asyncio.timeout(within_s):
            async for one in stream():
                if met(one):
                    return one
        raise AssertionError("the stream ended")

    async def does(self, act: Callable[[], Awaitable[Any]], *, tries: int = 20) -> None:
        """Do something until the robot grants it: for the moment it may be busy."""
        for left in reversed(range(tries)):
            try:
                async with asyncio.timeout(WITHIN_S):
                    await act()
            except self.sdk.ActionError:
                if not left:
                    raise
                await asyncio.sleep(SENT_EACH_S * 4)
            else:
                return

    async def moves(self) -> Any:
        """Push the stick forward until the robot drives, with neutral in between, as the robot requires."""
        for _ in range(20):
            self.stick = 0.0
            await asyncio.sleep(0.5)
            self.stick = 0.4
            with suppress(TimeoutError):
                return await self.reported(
                    self.telemetry.subscribe_odometry,
                    lambda one: one.velocity_body.x_m_s > 0.1 and one.position_body.x_m > 0.1,
                    within_s=3.0,
                )
        raise AssertionError("the stick moves nothing")

    async def holds_the_stick(self) -> None:
        """Send what the stick is, as an application with a joystick does."""
        while True:
            await self.manual.set_manual_control_input(self.stick, 0.0, 0.5, 0.0)
            await asyncio.sleep(SENT_EACH_S)


@asynccontextmanager
async def connected(port: int) -> AsyncIterator[Station]:
    try:
        import mavsdk.asyncio as sdk  # noqa: PLC0415 - where it cannot be loaded this test fails
        from mavsdk.asyncio.plugins import action, info, manual_control, offboard, telemetry  # noqa: PLC0415
    except Exception as error:  # noqa: BLE001 - whatever keeps it from being loaded
        pytest.fail(f"MAVSDK's library cannot be loaded here: {error}")
    configuration = sdk.Configuration.create_with_component_type(sdk.ComponentType.GROUND_STATION)
    async with sdk.Mavsdk(configuration) as library:
        await library.add_any_connection(f"udpout://127.0.0.1:{port}")
        system = await library.first_autopilot(WITHIN_S)
        assert system is not None, "no autopilot was found"
        yield Station(
            telemetry.TelemetryAsync(system),
            action.ActionAsync(system),
            offboard.OffboardAsync(system),
            manual_control.ManualControlAsync(system),
            info.InfoAsync(system),
            action,
        )


class Net:
    """The bench's end of a UDP socket on loopback: a node that passes datagrams on, both ways."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.setblocking(False)  # noqa: FBT003 - a socket's own word
        self._peer: tuple[str, int] | None = None
        self._due: Nanoseconds = 0

    @property
    def port(self) -> int:
        return int(self._socket.getsockname()[1])

    def receive(self, packet: Packet, _now: Nanoseconds) -> Reaction:
        if packet.address == PLACE and self._peer is not None:
            self._socket.sendto(packet.payload, self._peer)
        return Reaction((), self._due)

    def wake(self, now: Nanoseconds) -> Reaction:
        if now < self._due:
            return Reaction((), self._due)
        self._due = now + LOOKED_AT_EACH
        came = []
        with suppress(BlockingIOError):
            while True:
                datagram, self._peer = self._socket.recvfrom(2048)
                came.append(Packet(OPERATOR, PLACE, datagram))
        return Reaction(tuple(came), self._due)

    def closes(self) -> None:
        self._socket.close()


def carry(rig: Rig, ends: threading.Event) -> None:
    """Run the bench no faster than the wall's clock; where the machine is late, the bench's time waits."""
    clock = Clock()
    begun = clock.now() - rig.world.now
    while not ends.is_set():
        rig.runs(STEP_S)
        ahead = rig.world.now - (clock.now() - begun)
        if ahead > 0:
            ends.wait(ahead / SECOND)
        else:
            begun -= ahead


@pytest.fixture
def port() -> Iterator[int]:
    """Put bridge, drives and plant at a UDP port, on a bench that keeps to the wall's clock."""
    bench = ride(seconds=3600.0)
    net, ends = Net(), threading.Event()
    bench.rig.world.attach("net", net, {OPERATOR: bench.rig.operator_wire})
    bench.runs_until(READY_S)
    thread = threading.Thread(target=carry, args=(bench.rig, ends))
    thread.start()
    yield net.port
    ends.set()
    thread.join()
    net.closes()


@pytest.mark.long(beside="test_offboard_drives_and_hold_stops_whatever_set_points_go_on")
def test_mavsdk_reads_arms_drives_by_stick_and_by_set_points_and_holds(port: int) -> None:
    asyncio.run(story(port))


async def story(port: int) -> None:
    from mavsdk.plugins.offboard import VelocityBodyYawspeed  # noqa: PLC0415 - as in `connected`
    from mavsdk.plugins.telemetry.telemetry import FlightMode, LandedState  # noqa: PLC0415

    async with connected(port) as station:
        telemetry = station.telemetry
        version = await station.info.get_version()
        assert (version.flight_sw_major, version.flight_sw_minor) == (0, 1)
        battery = await station.newest(telemetry.subscribe_battery)
        assert 23.0 < battery.voltage_v < 25.0
        health = await station.reported(telemetry.subscribe_health, lambda one: bool(one.is_armable))
        assert not health.is_global_position_ok

        # By stick, in what MAVSDK calls position control.
        async with asyncio.TaskGroup() as at_once:
            hand = at_once.create_task(station.holds_the_stick())
            await station.does(station.action.arm)
            await station.manual.start_position_control()
            await station.reported(telemetry.subscribe_flight_mode, lambda mode: mode == FlightMode.MANUAL)
            await station.reported(telemetry.subscribe_landed_state, lambda one: one == LandedState.IN_AIR)
            moved = await station.moves()
            assert moved.position_body.x_m > 0.05
            station.stick = 0.0
            await station.reported(
                telemetry.subscribe_odometry, lambda one: abs(one.velocity_body.x_m_s) < 0.01
            )
            hand.cancel()

        # By set-points, and on while its watchdog looks at the heartbeats; clockwise as seen from above.
        await station.offboard.set_velocity_body(VelocityBodyYawspeed(0.0, 0.0, 0.0, 0.0))
        await station.offboard.start()
        await station.reported(telemetry.subscribe_flight_mode, lambda mode: mode == FlightMode.OFFBOARD)
        await station.offboard.set_velocity_body(VelocityBodyYawspeed(0.2, 0.0, 0.0, 10.0))
        await asyncio.sleep(WATCHED_S)
        assert await station.offboard.is_active()
        turned = await station.reported(
            telemetry.subscribe_heading, lambda one: 10.0 < one.heading_deg < 90.0
        )
        attitude = await station.newest(telemetry.subscribe_attitude_euler)
        assert attitude.yaw_deg == pytest.approx(turned.heading_deg, abs=30.0)
        driven = await station.newest(telemetry.subscribe_position_velocity_ned)
        assert driven.velocity.east_m_s > 0.0

        await station.does(station.action.hold)
        await station.reported(telemetry.subscribe_flight_mode, lambda mode: mode == FlightMode.HOLD)
        await station.reported(telemetry.subscribe_odometry, lambda one: one.velocity_body.x_m_s < 0.01)
        await station.does(station.action.disarm)
        await station.reported(telemetry.subscribe_armed, lambda armed: not armed)
