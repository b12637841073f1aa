"""The message types that health is published in, as text with the texts of all types in it."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Literal

from robophm.core.files import shipped

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

Generation = Literal[1, 2]
"""The generation of ROS: 1 or 2."""

PACKAGE = "phm_msgs"
"""The package of those that are not ROS's own (ros/phm_msgs)."""

PARAMETER_SERVICES = {
    "ListParameters": ("string[] prefixes\nuint64 depth", "rcl_interfaces/ListParametersResult result"),
    "GetParameters": ("string[] names", "rcl_interfaces/ParameterValue[] values"),
    "GetParameterTypes": ("string[] names", "uint8[] types"),
    "DescribeParameters": ("string[] names", "rcl_interfaces/ParameterDescriptor[] descriptors"),
    "SetParameters": ("rcl_interfaces/Parameter[] parameters", "rcl_interfaces/SetParametersResult[] results"),
    "SetParametersAtomically": ("rcl_interfaces/Parameter[] parameters", "rcl_interfaces/SetParametersResult result"),
}
"""Request and response of the services by which nodes of ROS 2 tell of their parameters, of rcl_interfaces."""


@cache
def typestore(generation: Generation) -> Typestore:
    """Return all types of one generation of ROS, those of phm_msgs among them."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if generation == 1 else Stores.LATEST)
    folder = shipped(f"ros/{PACKAGE}")
    texts = {file.stem: file.read_text(encoding="utf-8") for file in (folder / "msg").glob("*.msg")}
    if generation == 1:  # has a time of its own
        texts |= {file.stem: file.read_text(encoding="utf-8") for file in (folder / "ros1" / "msg").glob("*.msg")}
    types: Typesdict = {}
    for name, text in texts.items():
        types |= get_types_from_msg(text, f"{PACKAGE}/msg/{name}")
    for file in (folder / "srv").glob("*.srv"):
        halves = file.read_text(encoding="utf-8").split("\n---\n")
        for name, text in zip(service_types(f"{PACKAGE}/srv/{file.stem}", generation), halves, strict=True):
            types |= get_types_from_msg(text, name)
    for service, texts_of in PARAMETER_SERVICES.items() if generation == 2 else ():
        for name, text in zip(service_types(f"rcl_interfaces/srv/{service}", 2), texts_of, strict=True):
            types |= get_types_from_msg(text, name)
    store.register(types)
    return store


def service_types(service: str, generation: Generation) -> tuple[str, str]:
    """Return the types of the request and the response of a service, ``phm_msgs/srv/AssessTask``, as messages.

    ROS 1 spells them ``phm_msgs/AssessTaskRequest``; ROS 2 ``phm_msgs/srv/AssessTask_Request``, which rosbags has not.
    """
    name = service.replace("/srv/", "/msg/") + ("" if generation == 1 else "_")
    return f"{name}Request", f"{name}Response"


@cache
def definition(type_: str, generation: Generation) -> str:
    """Return the text of a type, ``phm_msgs/msg/Health``."""
    return str(typestore(generation).generate_msgdef(type_, ros_version=generation)[0])
