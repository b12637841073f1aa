"""Motors, servos and gears of each joint of a URDF, as entries of the library of parts.

They are told by names and meshes of links, by the limits of joints, and by what somebody answered.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from robophm.design.draft import DraftPart
from robophm.design.importers.urdf.reading import Description, Joint
from robophm.parts import Entry, library

DRIVES = ("servos", "motors", "gears")
"""Kinds of the library that say what a joint is moved by."""

LIGHT = 5.0
"""The largest mass [kg] of a robot whose wheels are taken to have small brushed gearmotors."""

WEAK = 12.0
"""The largest effort [N·m] at which a joint of a robot up to ``LIGHT`` is taken to have a servo."""

GRIPPING = frozenset({"gripper", "finger", "fingers", "jaw", "knuckle", "claw", "hand", "grip"})
SPINNING = frozenset({"rotor", "rotors", "prop", "propeller", "props"})
ROLLING = frozenset({"wheel", "wheels", "tyre", "tire"})
TRAILING = frozenset({"caster", "castor"})
_WORDS = re.compile(r"[A-Za-z]+|\d+")
_PLAIN = frozenset({"link", "joint", "frame", "base", "motor", "the"})


def words_of(name: str) -> list[str]:
    """The words of a name of ROS, small: of wheel_left_joint wheel, left, joint; of RearWheel rear, wheel."""
    return [word.lower() for word in _WORDS.findall(re.sub(r"([a-z])([A-Z])", r"\1 \2", name))]


def short(name: str) -> str:
    """A name less what says only that it is a joint or a link."""
    kept = [word for word in re.split(r"[_\s/.-]+", name) if word and word.lower() not in ("link", "joint", "frame")]
    return " ".join(kept) or name


@dataclass(frozen=True)
class Moved:
    """A joint and what it is for."""

    joint: Joint
    use: str
    """The use of the joint: wheel, caster, rotor, gripper, slide or arm."""


def moved(description: Description) -> list[Moved]:
    """The joints that something moves, from the root outwards; those that follow another are not among them."""
    joints = [one for one in description.joints if one.moves and not one.mimics]
    inwards = {one.child: one.parent for one in description.joints}

    def depth(link: str) -> int:
        steps = 0
        while link in inwards and steps <= len(inwards):
            link, steps = inwards[link], steps + 1
        return steps

    found = [Moved(one, use) for one in sorted(joints, key=lambda one: depth(one.child)) if (use := _use(one))]
    grippers = [one for one in found if one.use == "gripper"]
    return [one for one in found if one.use != "gripper" or one is grippers[0] or one.joint.driven]


def _use(joint: Joint) -> str:
    words = {*words_of(joint.name), *words_of(joint.child)}
    if joint.type in ("planar", "floating"):
        return ""  # where the robot itself is
    if words & TRAILING:
        return "" if joint.type == "fixed" else "caster"
    if words & SPINNING:
        return "rotor"
    if words & ROLLING and joint.type == "continuous":
        return "wheel"
    if words & GRIPPING:
        return "gripper"
    return "slide" if joint.type == "prismatic" else "arm"


def casters(description: Description) -> list[str]:
    """The links that are casters, whether they turn or not; a caster's parts count once."""
    found: dict[str, str] = {}
    for link in description.links:
        words = words_of(link.name)
        if TRAILING & set(words):
            place = " ".join(word for word in words if word not in ROLLING | TRAILING | _PLAIN | {"rotation", "swivel"})
            found.setdefault(place, link.name)
    return list(found.values())


def drive_parts(description: Description, chosen: Entry | None = None) -> Iterator[DraftPart]:
    """The parts that move a robot; ``chosen`` is what its wheels and joints have, where somebody said so."""
    for one in moved(description):
        if one.use == "rotor":
            yield from _rotor(one.joint)
        elif one.use == "gripper":
            yield from _gripper(one.joint, description, chosen)
        elif one.use == "slide":
            yield _part(
                one.joint,
                "slides",
                f"{short(one.joint.name)} actuator",
                "linear_actuator",
                "prismatic, taken for a spindle with its motor",
            )
        elif one.use in ("wheel", "arm"):
            yield from _driven(one, description, chosen)
    for link in casters(description):
        name = short(link) if "caster" in link.lower() or "castor" in link.lower() else f"{short(link)} caster"
        yield DraftPart("drive", name, "caster_wheel", f"link {link}")


def _part(joint: Joint, module: str, name: str, entry: str, assumed: str = "") -> DraftPart:
    effort, velocity = (None if math.isnan(one) else one for one in (joint.effort, joint.velocity))
    limit = "" if effort is None else f", limit {effort:g} {'N' if joint.type == 'prismatic' else 'N·m'}"
    return DraftPart(module, name, entry, f"joint {joint.name}{limit}", assumed, joint.name, effort, velocity)


def _rotor(joint: Joint) -> Iterator[DraftPart]:
    module = short(joint.name)
    for name, entry in (("motor", "drone_motor"), ("speed controller", "esc"), ("propeller", "propeller")):
        yield _part(joint, module, name, entry, "a rotor has a motor, its speed controller and a propeller")


def _gripper(joint: Joint, description: Description, chosen: Entry | None) -> Iterator[DraftPart]:
    servo = _seen(joint, description) or chosen
    if servo and servo.kind == "servos":
        yield _part(joint, "joints", f"{short(joint.name)} servo", servo.name)
    else:
        yield _part(joint, "gripper", short(joint.name), "gripper_electric", "taken for an electric gripper")


def _driven(one: Moved, description: Description, chosen: Entry | None) -> Iterator[DraftPart]:
    joint, wheel = one.joint, one.use == "wheel"
    seen = None if chosen else _seen(joint, description)
    why = "" if chosen or seen else _guess(joint, description, wheel)[1]
    drive = chosen or seen or library()[_guess(joint, description, wheel)[0]]
    name = short(joint.name)
    module = "drive" if wheel else "joints"
    if drive.kind == "servos":
        yield _part(joint, module, f"{name} servo", drive.name, why)
    elif drive.kind == "motors":
        yield _part(joint, module, f"{name} motor", drive.name, why)
        yield _part(joint, module, f"{name} motor driver", "motor_driver", "a motor has a driver")
    elif wheel:
        yield _part(joint, module, f"{name} gear", drive.name, why)
        yield _part(joint, module, f"{name} motor", "bldc_motor", "a wheel with a gear has a brushless motor")
        yield _part(joint, module, f"{name} encoder", "wheel_encoder", "a motor that is controlled has an encoder")
        yield _part(joint, module, f"{name} motor driver", "motor_controller", "a motor has a driver")
    else:
        yield _part(joint, name, "gear", drive.name, why)
        yield _part(joint, name, "motor", "servo_motor", "a joint with a gear has a servo motor")
        yield _part(
            joint, name, "encoder", "joint_encoder", "a joint with a gear has an absolute encoder, optical or magnetic"
        )
        yield _part(joint, name, "brake", "holding_brake", "a joint that carries load has a holding brake")
        yield _part(joint, name, "motor driver", "motor_controller", "a motor has a driver")
    if wheel:
        yield _part(joint, module, f"{name} tread", "drive_wheel", "taken for rubber or polyurethane")


def _seen(joint: Joint, description: Description) -> Entry | None:
    """What the meshes and materials beside a joint say that it is moved by."""
    looks = [look for link in description.links if link.name in (joint.parent, joint.child) for look in link.looks]
    return named(looks, DRIVES)


def _guess(joint: Joint, description: Description, wheel: bool) -> tuple[str, str]:
    light = 0 < description.mass <= LIGHT
    if wheel:
        said = f"a robot of {description.mass:.1f} kg" if description.mass else "a robot of unknown mass"
        return ("gearmotor_hobby" if light else "gearmotor"), f"{said}, no motor named"
    if light and not joint.effort > WEAK:
        return "smart_servo", f"a robot of {description.mass:.1f} kg, no motor named"
    return "strain_wave_gear", "no motor or gear named; joints of arms mostly have strain wave gears"


def named(looks: list[str], kinds: tuple[str, ...]) -> Entry | None:
    """The entry of these kinds that a name of a link, mesh or material has as one of its words."""
    for look in looks:
        said = {look.lower(), *re.split(r"[_\s.-]+", look.lower())} - _PLAIN
        for entry in library().values():
            if entry.kind in kinds and said.intersection(entry.words):
                return entry
    return None
