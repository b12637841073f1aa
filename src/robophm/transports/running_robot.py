"""The choice of the live transport: as it is asked for, or by the ROS that runs here."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

from robophm.core.errors import SourceError, nearest
from robophm.transports.live.enforced_security import refuse_enforced_security
from robophm.transports.signals.source import LiveSource

CHOICES = ("auto", "ros1", "ros2", "dds", "rclpy", "zenoh", "foxglove", "rosbridge")
"""The choices that a user can state; or the address of a router of Zenoh, an MQTT broker, a Foxglove or rosbridge
server."""

ROS1_DISTRIBUTIONS = ("noetic", "melodic", "kinetic")
"""Values of ROS_DISTRO that are ROS 1's."""

AS_ASKED = "as asked"


@dataclass(frozen=True)
class Live:
    """A live transport that has been opened, and how it was chosen."""

    source: LiveSource
    system: str
    """The system that is listened to: ``ROS 1``, ``ROS 2``, ``MQTT`` or ``Foxglove``."""
    transport: str
    """Name of the transport: ``ros1``, ``ros2_dds``, ``ros2_rclpy``, ``ros2_zenoh``, ``mqtt``, ``foxglove`` or
    ``rosbridge``."""
    reason: str
    """Reason for this one, as the end of a sentence."""
    node: Callable[[str], Any]
    """Function that makes a node of a name."""
    publisher: Callable[..., Any] | None
    """Function that makes a publisher of a node, topic, type and definition; None where nothing can be published."""
    server: Callable[..., Any] | None = None
    """Function that makes a service of a node, name, type, definitions and who answers; None where there are none."""

    @property
    def generation(self) -> Literal[1, 2]:
        """Return the generation of ROS whose types of messages are published."""
        return 1 if self.system == "ROS 1" else 2

    @property
    def has_parameters(self) -> bool:
        """Whether nodes of ours are in a graph of ROS 2, whose tools ask each for its parameters."""
        return self.transport.startswith("ros2_")

    @property
    def said(self) -> str:
        """Return one line for people: which transport was chosen and why."""
        return f"listening to {self.system} ({self.transport}): {self.reason}"


def open_live(
    choice: str = "auto", *, period: float = 0.5, node: str = "", parameters: Mapping[str, Any] | None = None
) -> Live:
    """Open the live source that is chosen, or that of the ROS that runs here.

    ``choice`` is one of CHOICES or the address of a router of Zenoh, an MQTT broker, a Foxglove or rosbridge
    server; the clock comes at multiples of ``period`` [s]. On ROS 1 the node that listens is called ``node`` and has
    these private ``parameters``.

    Raises SourceError where it cannot be spoken, or there is none.
    """
    if choice.partition("://")[0] == "foxglove":
        return _foxglove(choice, period)
    if choice.partition("://")[0] == "rosbridge":
        return _rosbridge(choice, period)
    if choice.partition("://")[0] == "zenoh":
        return _zenoh(choice, AS_ASKED, period)
    if "://" in choice:
        return _mqtt(choice, period)
    if choice not in CHOICES:
        raise SourceError(
            f"nothing is heard by way of '{choice}'; expected a transport, or the address of an MQTT broker"
            f"{nearest(choice, CHOICES)}"
        )
    generation, reason = (1 if choice == "ros1" else 2, AS_ASKED) if choice != "auto" else generation_here()
    if generation == 1:
        from robophm.transports import ros1

        refuse_enforced_security("ROS 1 has no security")
        source = ros1.Ros1(period=period, node=node, parameters=parameters)
        return Live(source, "ROS 1", "ros1", reason, ros1.Node, ros1.Publisher, ros1.Service)
    return {"dds": _dds, "rclpy": _rclpy}.get(choice, _ros2)(reason, period)


def _mqtt(address: str, period: float) -> Live:
    from robophm.transports import mqtt

    source = mqtt.Mqtt(address, period=period)
    node = partial(mqtt.Node, source.connection)
    return Live(source, "MQTT", "mqtt", f"{source.address}, {AS_ASKED}", node, mqtt.Publisher)


def _foxglove(place: str, period: float) -> Live:
    from robophm.transports import foxglove

    source = foxglove.Foxglove(place, period=period)
    encoding = source.published_encoding()
    system = {"cdr": "ROS 2", "ros1": "ROS 1"}.get(encoding, "Foxglove")
    publisher = foxglove.Publisher if encoding else None
    return Live(source, system, "foxglove", f"{source.place}, {AS_ASKED}", partial(foxglove.Node, source), publisher)


def _rosbridge(place: str, period: float) -> Live:
    from robophm.transports import rosbridge

    source = rosbridge.Rosbridge(place, period=period)
    said = f"{source.place}, {AS_ASKED}"
    try:
        system = f"ROS {source.generation}"
    except SourceError:
        source.close()
        raise
    return Live(source, system, "rosbridge", said, partial(rosbridge.Node, source), rosbridge.Publisher,
                rosbridge.Service)  # fmt: skip


def _dds(reason: str, period: float) -> Live:
    from robophm.transports import ros2_dds

    source = ros2_dds.Ros2Dds(period=period)
    return Live(source, "ROS 2", "ros2_dds", reason, ros2_dds.Node, ros2_dds.Publisher, ros2_dds.Service)


def _rclpy(reason: str, period: float) -> Live:
    from robophm.transports import ros2_rclpy

    source = ros2_rclpy.Ros2Rclpy(period=period)
    return Live(source, "ROS 2", "ros2_rclpy", reason, ros2_rclpy.Node, ros2_rclpy.Publisher, ros2_rclpy.Service)


def _zenoh(address: str, reason: str, period: float) -> Live:
    from robophm.transports import ros2_zenoh

    source = ros2_zenoh.Ros2Zenoh(address, period=period)
    node = partial(ros2_zenoh.Node, router=source.router)
    said = f"{source.place}, {reason}"
    return Live(source, "ROS 2", "ros2_zenoh", said, node, ros2_zenoh.Publisher, ros2_zenoh.Service)


def _ros2(reason: str, period: float) -> Live:
    """Through rclpy where there is one that runs in this Python; else as RMW_IMPLEMENTATION says or over DDS, and why.

    Raises SourceError.
    """
    why = "rclpy cannot be imported"
    if _has("rclpy"):
        try:
            return _rclpy(f"{reason}; rclpy can be imported", period)
        except SourceError as error:  # as where ROS 2 is sourced for the Python that it was built with
            why = str(error)
    rmw = os.environ.get("RMW_IMPLEMENTATION", "")
    if _has("zenoh") and ("zenoh" in rmw or not (_has("rclpy") or _has("cyclonedds"))):
        also = f"RMW_IMPLEMENTATION is {rmw}" if "zenoh" in rmw else "there is no cyclonedds"
        return _zenoh("zenoh", f"{reason}; {why}; {also}", period)
    if not _has("cyclonedds"):
        raise SourceError(f"{why}, and no cyclonedds: pip install robophm[ros2]")
    return _dds(f"{reason}; {why}", period)


def generation_here() -> tuple[int, str]:
    """Return 1 or 2, and how that is known: what was sourced, or a master that answers. Raises SourceError."""
    version, distribution = os.environ.get("ROS_VERSION"), os.environ.get("ROS_DISTRO", "").lower()
    if version in ("1", "2"):
        return int(version), f"ROS_VERSION is {version}"
    if distribution:
        return (1 if distribution in ROS1_DISTRIBUTIONS else 2), f"ROS_DISTRO is {distribution}"
    answer = _master()
    if answer is None:
        return 1, "a ROS master answers"
    if os.environ.get("ROS_MASTER_URI"):
        raise SourceError(f"no ROS master: {answer}; start roscore, or ask for ROS 2")
    if _has("rclpy") or _has("cyclonedds") or _has("zenoh"):
        return 2, "no ROS master answers"
    raise SourceError(f"no ROS found: {answer}, and nothing here speaks ROS 2: pip install robophm[ros2]")


def explained() -> dict[str, str]:
    """Return what of ROS is here and what of it would be listened to, by what each is."""
    absent = "cannot be imported"
    said = {"chosen": "", "rclpy": absent, "cyclonedds": absent, "zenoh": absent}
    try:
        generation, reason = generation_here()
        said["chosen"] = f"ROS {generation}: {reason}"
    except SourceError as error:
        said["chosen"] = str(error)
    if _has("rclpy"):
        from robophm.transports import ros2_rclpy

        try:
            ros2_rclpy.rclpy()
            said["rclpy"] = "runs here, and goes before cyclonedds"
        except SourceError as error:
            said["rclpy"] = str(error)
    if _has("cyclonedds"):
        said["cyclonedds"] = "can be imported"
    if _has("zenoh"):
        from robophm.transports.ros2_zenoh.session import place_of

        said["zenoh"] = f"can be imported; looks for {place_of('')}"
    rmw = os.environ.get("RMW_IMPLEMENTATION")
    heeded = "rclpy heeds it, and where there is none, Zenoh is spoken where it says so"
    said["RMW_IMPLEMENTATION"] = f"{rmw}; {heeded}" if rmw else f"is not set; {heeded}"
    said["what is lost on the way"] = _lost_on_the_way()
    from robophm.transports.ros2_dds.environment import hidden_by, place_in_words

    try:
        said["ROS 2 is looked for in"] = place_in_words()
        said["what could hide it"] = "; ".join(hidden_by(over_dds="runs" not in said["rclpy"]))
        refuse_enforced_security()
        said["security"] = "not enforced"
    except SourceError as error:
        said["security" if "SECURITY" in str(error) else "ROS 2 is looked for in"] = str(error)
    return said


def _lost_on_the_way() -> str:
    """Words on what each transport tells of best-effort messages that are lost, and on what decides how many are."""
    told = (
        "ROS 1 and Zenoh number messages, and so does rclpy with Fast DDS; over DDS packets that this machine dropped "
        "are counted, on Linux; over rosbridge and Foxglove messages of ROS 1 with a header, over MQTT those of "
        "VDA 5050; of others nothing is told"
    )
    try:
        most = int(Path("/proc/sys/net/core/rmem_max").read_text())
    except (OSError, ValueError):
        return told
    from robophm.transports.ros2_dds.environment import RECEIVED_AT_ONCE

    more = f"; large pictures over DDS want more: sysctl -w net.core.rmem_max={RECEIVED_AT_ONCE}"
    hint = more if most < RECEIVED_AT_ONCE else ""
    return f"{told}; net.core.rmem_max is {most:,} bytes{hint}"


def _master() -> str | None:
    """The reason why the master cannot be used; None where it answers."""
    from robophm.transports.ros1.environment import place
    from robophm.transports.ros1.source import CALLER
    from robophm.transports.ros1.xmlrpc import call

    try:
        call(place().master, "getPid", CALLER)
    except SourceError as error:
        return str(error)
    return None


def _has(package: str) -> bool:
    return importlib.util.find_spec(package) is not None
