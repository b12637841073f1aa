"""The OTA in MuJoCo: a body on two driven wheels and a caster, its motors and how warm they get.

What is measured comes from the physics: a wheel's torque is its motor's current, current is heat, and heat is what
the thermometers of the modules see. Figures are of a transport vehicle of this size; they were measured on no robot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import mujoco

STEP = 0.002
"""Seconds of a step of the physics."""

AMBIENT = 24.0
"""[°C]"""

WHEEL = 0.1
"""Radius [m]."""

TRACK = 0.44
"""Between the wheels [m]."""

MODEL = f"""
<mujoco>
  <option timestep="{STEP}" integrator="implicitfast"/>
  <default><geom friction="0.9 0.01 0.001"/></default>
  <worldbody>
    <geom type="plane" size="50 50 0.1"/>
    <body name="ota" pos="0 0 {WHEEL}">
      <freejoint/>
      <geom type="box" size="0.35 0.2 0.08" pos="0 0 0.06" mass="70"/>
      <geom type="sphere" size="0.04" pos="0.28 0 -0.06" mass="1" friction="0.01 0.001 0.001" priority="1"/>
      <geom type="sphere" size="0.04" pos="-0.28 0 -0.06" mass="1" friction="0.01 0.001 0.001" priority="1"/>
      <body pos="0 {TRACK / 2} 0">
        <joint name="left" axis="0 1 0" damping="0.1" frictionloss="3.5" armature="0.05"/>
        <geom type="cylinder" size="{WHEEL} 0.02" euler="90 0 0" mass="2"/>
      </body>
      <body pos="0 -{TRACK / 2} 0">
        <joint name="right" axis="0 1 0" damping="0.1" frictionloss="3.5" armature="0.05"/>
        <geom type="cylinder" size="{WHEEL} 0.02" euler="90 0 0" mass="2"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="left" joint="left" ctrlrange="-25 25" ctrllimited="true"/>
    <motor name="right" joint="right" ctrlrange="-25 25" ctrllimited="true"/>
  </actuator>
</mujoco>
"""

GAIN = 12.0
"""Torque of a wheel for each rad/s that it is too slow [N·m·s]; a motor's controller."""

TORQUE_PER_AMPERE = 1.1
"""Of a wheel, through its gear [N·m/A]."""

RESISTANCE = 0.55
"""Of a winding [Ω]."""

VOLTAGE, INTERNAL = 26.2, 0.06
"""Of the battery without load [V], and its resistance [Ω]."""

IDLE = 2.6
"""Current of computers and sensors [A]."""


@dataclass
class Warm:
    """A module: heat in, warmth out."""

    resistance: float
    """To the air [K/W]."""
    inertia: float
    """Time constant [s]."""
    above: float = 0.0
    """The air [K]."""

    def heat(self, power: float, seconds: float) -> None:
        """Take up heat [W]."""
        self.above += (power * self.resistance - self.above) * -math.expm1(-seconds / self.inertia)


@dataclass
class Ota:
    """The robot. ``goal`` is where it drives, ``cruise`` how fast at most."""

    goal: tuple[float, float] | None = None
    cruise: float = 0.5
    """[m/s]"""
    current: float = IDLE
    """Of the battery [A]."""
    voltage: float = VOLTAGE
    warm: dict[str, Warm] = field(
        default_factory=lambda: {
            "power": Warm(0.55, 300.0),
            "sensing": Warm(1.10, 120.0),
            "communication": Warm(1.30, 150.0),
            "mobility": Warm(0.90, 60.0),
            "computation": Warm(0.90, 90.0),
        }
    )

    def __post_init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(MODEL)
        self.data = mujoco.MjData(self.model)
        self._wheels = [self.model.joint(name).dofadr[0] for name in ("left", "right")]

    @property
    def place(self) -> tuple[float, float]:
        """[m]"""
        return float(self.data.qpos[0]), float(self.data.qpos[1])

    @property
    def heading(self) -> float:
        """[rad]"""
        w, x, y, z = self.data.qpos[3:7]
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    @property
    def speed(self) -> tuple[float, float]:
        """Forward [m/s], and of turning [rad/s]."""
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        vx, vy = self.data.qvel[:2]
        return float(vx * cosine + vy * sine), float(self.data.qvel[5])

    def temperature(self, module: str) -> float:
        """[°C]"""
        return AMBIENT + self.warm[module].above

    def advance(self, seconds: float) -> None:
        """Let so much time go by."""
        for _ in range(round(seconds / STEP)):
            forward, turn = self._wanted()
            for number, side in enumerate((-1, 1)):
                wanted = (forward + side * turn * TRACK / 2) / WHEEL
                self.data.ctrl[number] = GAIN * (wanted - self.data.qvel[self._wheels[number]])
            mujoco.mj_step(self.model, self.data)
            motors = [abs(torque) / TORQUE_PER_AMPERE for torque in self.data.actuator_force]
            self.current = IDLE + sum(motors)
            self.voltage = VOLTAGE - INTERNAL * self.current
            heat = {
                "power": self.current**2 * INTERNAL + 4.0,
                "sensing": 6.0,
                "communication": 3.0,
                "mobility": RESISTANCE * sum(current**2 for current in motors) + 1.0,
                "computation": 18.0,
            }
            for module, power in heat.items():
                self.warm[module].heat(power, STEP)

    def _wanted(self) -> tuple[float, float]:
        """Speeds towards the goal: turn first, then drive, slower near it."""
        if self.goal is None:
            return 0.0, 0.0
        (x, y), (gx, gy) = self.place, self.goal
        distance = math.hypot(gx - x, gy - y)
        if distance < 0.03:
            return 0.0, 0.0
        off = (math.atan2(gy - y, gx - x) - self.heading + math.pi) % (2 * math.pi) - math.pi
        turn = max(-1.2, min(1.2, 2.5 * off))
        if abs(off) > 0.4:
            return 0.0, turn
        return min(self.cruise, max(0.08, 0.9 * distance)), turn
