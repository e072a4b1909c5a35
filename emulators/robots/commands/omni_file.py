"""`new --kind omni`: the words of the command line to a robot file of three wheels on a board."""

from dataclasses import dataclass

from emulators.robots.commands.kind_options import KindOptions, write_file


@dataclass(frozen=True, slots=True, kw_only=True)
class OmniOptions(KindOptions):
    """The options of an omni base, with their defaults; `kit` is the motor of ROME's."""

    wheel_radius: float
    wheel_distance: float
    protocol: str = "ros-arduino-bridge"
    motor: str = "kit"
    gear: float = 64.0
    encoder_lines: int = 12
    mass: float = 5.0
    voltage: float = 12.0
    speed: float = 0.4
    acceleration: float = 0.5
    turn_rate: float = 1.2

    def write(self) -> None:
        """Write the robot file."""
        from emulators import motors
        from emulators.arduino_omni.starter import counting
        from emulators.robots.rome.starter import KIT, WHEELS, OmniSpecification, robot_file
        from emulators.specification import ENCODER_LINES, one_of, positive, within
        from firmware_bridge.families.motor_shield.settings import ShieldProtocol

        # Without an encoder at each wheel no one would know where it is.
        protocols = counting(len(WHEELS))
        specified = OmniSpecification(
            name=self.name,
            protocol=ShieldProtocol(one_of("--protocol", "", self.protocol, protocols)),
            wheel_radius_m=positive("--wheel-radius", self.wheel_radius),
            wheel_distance_m=positive("--wheel-distance", self.wheel_distance),
            motor=KIT if self.motor == "kit" else motors.motor(self.motor),
            gear=positive("--gear", self.gear),
            encoder_lines=within("--encoder-lines", self.encoder_lines, ENCODER_LINES),
            mass_kg=positive("--mass", self.mass),
            voltage_v=positive("--voltage", self.voltage),
            speed_mps=positive("--speed", self.speed),
            acceleration_mps2=positive("--acceleration", self.acceleration),
            turn_rate_rad_s=positive("--turn-rate", self.turn_rate),
        )
        write_file(self, robot_file(specified))
