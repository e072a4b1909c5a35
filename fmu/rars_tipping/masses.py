"""The robot's mass and where its centre is: it follows the payload and the lift."""

from fmu.export.functions import named
from fmu.export.model import Expression
from fmu.parts.symbols import HALF
from fmu.rars_tipping.symbols import P


class Masses:
    """Mass in kg; centre of mass `ahead` of the rear axle, `left` of the middle and over the floor, in m.

    z = (m Z_cg + m_s r / 2 + m_p (h_0 + r)) / (m + m_p) with the lift's rise r: half of it for the scissor's
    mass, which is part of m (assumed; [R] 2.3.1 has Z_cg of the retracted robot only). The rear wheels'
    centres count at Z_cg, as in fmu/rars.
    """

    def __init__(self, rise: Expression) -> None:
        self.payload = P["lift_payload"]
        self.unloaded = P["platform_mass"] + 2 * P["wheel_mass"]
        self.total = self.unloaded + self.payload
        self.payload_ahead = P["centre_offset"] + P["payload_ahead"]
        # First moments in kg.m.
        self.moment_ahead = P["platform_mass"] * P["centre_offset"] + self.payload * self.payload_ahead
        self.moment_left = self.payload * P["payload_left"]
        self.ahead, self.left = self.moment_ahead / self.total, self.moment_left / self.total
        top = P["table_height"] + rise
        lifted = P["scissor_mass"] * HALF * rise
        self.height = named((self.unloaded * P["cg_height"] + lifted + self.payload * top) / self.total)
        apart = top - P["cg_height"] - lifted / self.unloaded
        # What the payload adds to the inertia about the common centre of mass, over its height alone.
        self._raised = named(self.unloaded * self.payload / self.total * apart**2)

    def yaw_inertia(self) -> Expression:
        """Return the inertia about the vertical through the rear axle's middle in kg m2."""
        payload = self.payload * (self.payload_ahead**2 + P["payload_left"] ** 2)
        return (
            P["yaw_inertia"]
            + 2 * P["wheel_yaw_inertia"]
            + P["platform_mass"] * P["centre_offset"] * P["centre_offset"]
            + 2 * P["wheel_mass"] * (P["rear_track"] / 2) ** 2
            + payload
        )

    def rocking_inertia(self, unloaded: Expression) -> Expression:
        """Return the inertia about a level axis through the centre of mass in kg m2, from the parameter's."""
        return unloaded + self._raised
