"""The room of a transport for the contract suite, where a server stands for the robot on the other side."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, ClassVar, Self


@dataclasses.dataclass
class Node:
    robot: Any

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass


class ServedRoom:
    """What subclasses name: the transport, its robot, and what publishes from it; and they have its source's name."""

    ours = False
    transport: ClassVar[str]
    robot_behind: ClassVar[Callable[[], Any]]
    publisher: ClassVar[Callable[..., Any]]

    def __init__(self) -> None:
        self.__name__ = f"robophm.transports.{self.transport}"
        self.robot = type(self).robot_behind()

    def Node(self, name: str) -> Any:
        return Node(self.robot)

    def Publisher(self, node: Node, topic: str, type_: str, definition: str | None = None, *, latched: bool) -> Any:
        return type(self).publisher(node.robot, topic, type_, definition, latched)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.robot.close()
