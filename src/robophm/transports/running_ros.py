"""The choice of the live transport, by the ROS that runs here."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

from robophm.core.errors import SourceError, nearest
from robophm.transports.signals.source import LiveSource

Choice = Literal["auto", "1", "2"]
"""The choice that a user states."""

ROS1_DISTRIBUTIONS = ("noetic", "melodic", "kinetic")
"""Values of ROS_DISTRO that are ROS 1's."""


@dataclass(frozen=True)
class Live:
    """A live transport that has been opened, and how it was chosen."""

    source: LiveSource
    generation: Literal[1, 2]
    transport: str
    """Name of the transport: ``ros1``, ``ros2_dds`` or ``ros2_rclpy``."""
    reason: str
    """Reason for this one, as the end of a sentence."""
    node: Callable[[str], Any]
    """Function that makes a node of a name."""
    publisher: Callable[..., Any]
    """Function that makes a publisher of a node, topic, type and definition."""

    @property
    def said(self) -> str:
        """Return one line for people: which transport was chosen and why."""
        return f"listening to ROS {self.generation} ({self.transport}): {self.reason}"


def open_live(choice: str = "auto", *, period: float = 0.5) -> Live:
    """Open the live source of the ROS that runs here, or is chosen; its clock comes at multiples of ``period`` [s].

    Raises SourceError where it cannot be spoken, or there is none.
    """
    if choice not in get_args(Choice):
        known = get_args(Choice)
        raise SourceError(f"there is no ROS '{choice}'; expected {', '.join(known)}{nearest(choice, known)}")
    generation, reason = (int(choice), "as asked") if choice != "auto" else generation_here()
    if generation == 1:
        from robophm.transports import ros1

        return Live(ros1.Ros1(period=period), 1, "ros1", reason, ros1.Node, ros1.Publisher)
    return _ros2(reason, period)


def _ros2(reason: str, period: float) -> Live:
    """Through rclpy where there is one that runs in this Python; else over DDS, and why. Raises SourceError."""
    from robophm.transports import ros2_dds, ros2_rclpy

    why = "rclpy cannot be imported"
    if _has("rclpy"):
        try:
            source = ros2_rclpy.Ros2Rclpy(period=period)
            return Live(
                source, 2, "ros2_rclpy", f"{reason}; rclpy can be imported", ros2_rclpy.Node, ros2_rclpy.Publisher
            )
        except SourceError as error:  # as where ROS 2 is sourced for the Python that it was built with
            if not _has("cyclonedds"):
                raise SourceError(f"{error}, and no cyclonedds: pip install robophm[ros2]") from None
            why = str(error)
    return Live(ros2_dds.Ros2Dds(period=period), 2, "ros2_dds", f"{reason}; {why}", ros2_dds.Node, ros2_dds.Publisher)


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
    if _has("rclpy") or _has("cyclonedds"):
        return 2, "no ROS master answers"
    raise SourceError(f"no ROS found: {answer}, and nothing here speaks ROS 2: pip install robophm[ros2]")


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
