"""Parameters that may be changed while a robot is watched, by the standard services of a node of ROS 2.

So that ``ros2 param list``, ``get``, ``describe`` and ``set`` know them (rcl_interfaces).
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError, nearest
from robophm.transports.health_topics.outlet import Outlet
from robophm.transports.health_topics.report_fields import Fields
from robophm.transports.signals.incidents import UnknownTypeError

NOT_SET, INTEGER, DOUBLE = 0, 2, 3
"""Types of values (rcl_interfaces/ParameterType)."""

TYPES = {0: "nothing", 1: "a truth value", 4: "a text", 5: "bytes", 6: "truth values", 7: "integers", 8: "numbers",
         9: "texts"}  # fmt: skip
"""Words for the types that no parameter has."""

MOST_ASKED = 1000
"""Parameters that one call may name; further ones are left out."""


@dataclass(frozen=True)
class Parameter:
    """A number that may be changed while a robot is watched."""

    name: str
    description: str
    low: float
    high: float
    get: Callable[[], float]
    set: Callable[[float], None]
    whole: bool = False
    """Whether it is a whole number."""

    @property
    def type(self) -> int:
        """Return the type of its value, as rcl_interfaces/ParameterType has it."""
        return INTEGER if self.whole else DOUBLE

    def fields(self) -> Fields:
        """Return its value as the fields of rcl_interfaces/ParameterValue."""
        value = self.get()
        return {"type": self.type, **({"integer_value": int(value)} if self.whole else {"double_value": float(value)})}

    def described(self) -> Fields:
        """Return the fields of its rcl_interfaces/ParameterDescriptor."""
        kind, span = (int, "integer_range") if self.whole else (float, "floating_point_range")
        limits = {"from_value": kind(self.low), "to_value": kind(self.high)}
        return {"name": self.name, "type": self.type, "description": self.description, span: [limits]}

    def checked(self, value: Any) -> float:
        """Return a rcl_interfaces/ParameterValue as a number that it may have. Raises RobophmError in words."""
        if value.type not in (INTEGER, DOUBLE):
            raise RobophmError(f"{self.name} is {TYPES.get(value.type, 'of no type')}; expected a number")
        said = value.integer_value if value.type == INTEGER else value.double_value
        return float(number(said, self.name, low=self.low, high=self.high, whole=self.whole))


class ParameterServices:
    """Answers the six services of parameters below a node; all numbers, changed by one call at a time."""

    def __init__(self, outlet: Outlet, node: str, parameters: Iterable[Parameter]) -> None:
        """Begin to serve. Raises SourceError where that cannot be."""
        self._parameters = {one.name: one for one in parameters}
        self._changing = threading.Lock()
        self.unknown = ""
        """The reason why they are not served, where this ROS does not know their types; else empty."""
        answers = {"ListParameters": self.listed, "GetParameters": self.values, "GetParameterTypes": self.types,
                   "DescribeParameters": self.described, "SetParameters": self.set,
                   "SetParametersAtomically": self.set_together}  # fmt: skip
        try:
            for type_, answer in answers.items():
                outlet.serve(node, f"{node}/{_spelled(type_)}", f"rcl_interfaces/srv/{type_}", answer)
        except UnknownTypeError as error:
            self.unknown = str(error)

    def listed(self, request: Any) -> Fields:
        """Return the names, all or those that are asked for; none has parts."""
        wanted = set(request.prefixes[:MOST_ASKED])
        return {"result": {"names": [name for name in sorted(self._parameters) if not wanted or name in wanted]}}

    def values(self, request: Any) -> Fields:
        """Return the value of each name; of one that is none, that it is not set."""
        return {"values": [one.fields() if one else {"type": NOT_SET} for _, one in self._asked(request)]}

    def types(self, request: Any) -> Fields:
        """Return the type of each name; of one that is none, that it is not set."""
        return {"types": [one.type if one else NOT_SET for _, one in self._asked(request)]}

    def described(self, request: Any) -> Fields:
        """Return what each name means and which values it may have."""
        return {"descriptors": [one.described() if one else {"name": name, "type": NOT_SET}
                                for name, one in self._asked(request)]}  # fmt: skip

    def _asked(self, request: Any) -> list[tuple[str, Parameter | None]]:
        """The names that are asked for, and their parameters; None of a name that is none."""
        return [(name, self._parameters.get(name)) for name in request.names[:MOST_ASKED]]

    def set(self, request: Any) -> Fields:
        """Set each by itself; what is refused says why, and changes nothing."""
        return {"results": [self._set([one]) for one in request.parameters[:MOST_ASKED]]}

    def set_together(self, request: Any) -> Fields:
        """Set all, or where one is refused none."""
        too_many = {"successful": False, "reason": f"{len(request.parameters)} at once; expected {MOST_ASKED} at most"}
        return {"result": too_many if len(request.parameters) > MOST_ASKED else self._set(request.parameters)}

    def _set(self, said: Sequence[Any]) -> Mapping[str, Any]:
        try:
            wanted = []
            for one in said:
                if one.name not in self._parameters:
                    raise RobophmError(f"no parameter '{one.name:.60}'{nearest(one.name, self._parameters)}")
                wanted.append((self._parameters[one.name], self._parameters[one.name].checked(one.value)))
        except RobophmError as error:
            return {"successful": False, "reason": str(error)}
        with self._changing:
            for parameter, value in wanted:
                parameter.set(value)
        return {"successful": True, "reason": ""}


def _spelled(type_: str) -> str:
    """The name of a service of this type: ``set_parameters`` for ``SetParameters``."""
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in type_).lstrip("_")
