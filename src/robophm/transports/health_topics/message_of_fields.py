"""Messages out of mappings of their fields."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from robophm.transports.signals.message_type import MessageType, serialized

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_DTYPES = {"byte": np.uint8, "char": np.uint8, "octet": np.uint8}


def compose(store: Typestore, type_: str, fields: Mapping[str, Any]) -> Any:
    """Return a message of this type, ``phm_msgs/msg/Health``; what is not among its fields is zero, empty or False.

    A field that the generation of ROS does not have, ``header.seq`` or a texture, is thereby right as well.
    Raises KeyError where the type has no such field.
    """
    from rosbags.interfaces import Nodetype

    known = store.fielddefs[type_][1]
    if strange := fields.keys() - {name for name, _ in known}:
        raise KeyError(f"{type_} has no {', '.join(sorted(strange))}")

    def value(node: Nodetype, detail: Any, given: Any) -> Any:
        if node == Nodetype.NAME:
            return compose(store, cast(str, detail), given or {})
        if node == Nodetype.BASE:
            return {"string": "", "bool": False}.get(detail[0], 0) if given is None else given
        (inner, part), length = detail
        if inner == Nodetype.BASE and part[0] != "string":
            numbers = [0] * length if given is None and node == Nodetype.ARRAY else given or []
            return np.array(numbers, _DTYPES.get(part[0], part[0]))
        return [value(inner, part, each) for each in given or ([None] * length if node == Nodetype.ARRAY else [])]

    return store.types[type_](**{name: value(node, detail, fields.get(name)) for name, (node, detail) in known})


def bytes_of_fields(type_: MessageType, fields: Mapping[str, Any]) -> bytes:
    """Return the bytes of a message with these fields. Raises as ``compose`` and ``serialized``."""
    return serialized(type_, compose(cast("Typestore", type_.store), type_.name, fields))
