"""Faults of an IMU: values that stay, axes that are exchanged, no frames."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import ClassVar

from numpy.random import Generator

from emulators.bench.faults.fault import Lasting, Problem, Stations
from emulators.bench.faults.site import Site
from emulators.imu.device import Imu
from firmware_bridge.families.imu.settings import ImuLink
from firmware_bridge.robot import AnyRobot


class _OfImu(Lasting, ABC):
    among: ClassVar = Stations.NONE

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the equipment that this robot lacks for it."""
        if not ImuLink.all_of(robot):
            yield "kind", f"{robot.name} has no IMU"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let all IMUs have it."""
        del chance
        self._set(site, on=True)

    def take_off(self, site: Site) -> None:
        """Take it from them."""
        self._set(site, on=False)

    def _set(self, site: Site, *, on: bool) -> None:
        for imu in site.devices.nodes(Imu).values():
            self.of(imu, on=on)

    @staticmethod
    @abstractmethod
    def of(imu: Imu, *, on: bool) -> None:
        """Put it on one IMU, or take it off."""


class ImuFrozen(_OfImu):
    """The six values stay."""

    kind: ClassVar = "imu_frozen"

    @staticmethod
    def of(imu: Imu, *, on: bool) -> None:
        """Let its values stay."""
        imu.frozen = on


class ImuAxesSwapped(_OfImu):
    """x and y are exchanged."""

    kind: ClassVar = "imu_axes_swapped"

    @staticmethod
    def of(imu: Imu, *, on: bool) -> None:
        """Exchange its axes."""
        imu.swapped = on


class ImuSilent(_OfImu):
    """No frame is sent."""

    kind: ClassVar = "imu_silent"

    @staticmethod
    def of(imu: Imu, *, on: bool) -> None:
        """Let it send nothing."""
        imu.silent = on
