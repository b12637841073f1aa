"""Construction of the signals by which software tells of failures, from a design."""

from __future__ import annotations

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND, signal_name
from robophm.design import schema
from robophm.design.located_error import LocatedError, Path
from robophm.design.told_failure import ToldFailure

LEVELS = {"error": (8.0, 16.0, 40.0, 50.0), "fatal": (16.0, 50.0)}
"""Levels of messages by name: ERROR and FATAL of rosgraph_msgs/Log (ROS 1), and of rcl_interfaces/Log (ROS 2)."""

ERROR_PROCESSING, ACTIVE = 15.0, 3.0
"""States of lifecycle_msgs/State. Finalized is none of them: it follows ErrorProcessing, or an orderly shutdown."""


def build_told_failures(place: Path, mode: schema.FailureMode, quantity: int) -> tuple[ToldFailure, ...]:
    """Build what tells of failures of one failure mode. Raises LocatedError where it contradicts the rest."""
    said, place = mode.failed_when or [], (*place, "failed_when")
    if said and quantity > 1:
        raise LocatedError(
            place, f"says that one part failed, but which of {quantity} is not said; expected components of their own"
        )
    built = tuple(_told((*place, str(i)), one) for i, one in enumerate(said))
    if mode.wear and any(one.works or one.silent for one in built):
        raise LocatedError(
            place, "says that the part works again, and its wear would begin anew then; expected wear and failed_when "
            "in failure modes of their own",
        )  # fmt: skip
    return built


def _told(place: Path, said: schema.ToldFailure) -> ToldFailure:
    try:
        if said.log is not None:
            node = f"/{said.log.removeprefix('/')}"
            signal = signal_name("/rosout", f"level[{node}: {said.words}]" if said.words else f"level[{node}]")
            about = f" about '{said.words}'" if said.words else ""
            return ToldFailure(signal, LEVELS[said.level], said=f"{said.level} of {said.log} on /rosout{about}")
        if said.lifecycle is not None:
            signal = signal_name(f"{said.lifecycle}/transition_event", "goal_state.id")
            return ToldFailure(signal, (ERROR_PROCESSING,), (ACTIVE,), said=f"lifecycle of {said.lifecycle}")
        signal = signal_name(str(said.topic), str(said.field))
        if said.silent is not None:
            return ToldFailure(signal, (), (), round(said.silent * SECOND), f"{signal} silent for {said.silent:g} s")
        return ToldFailure(signal, tuple(said.values or ()), tuple(said.works or ()), said=signal)
    except RobophmError as error:
        raise LocatedError(place, str(error)) from None
