"""One of several robots that share a system: its topics are those below its namespace, and are named from there."""

from __future__ import annotations

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import is_robot_name
from robophm.transports.live.renamed import RenamedSource
from robophm.transports.signals.source import LiveSource, TopicInfo

LOG = "/rosout"
"""The topic on which the nodes of all robots log."""


def namespace_of(robot: str) -> str:
    """Return the namespace of a robot, ``/amr_7`` for ``amr_7``. Raises SourceError where that can be none."""
    name = robot.strip("/")
    if not is_robot_name(name):
        raise SourceError(f"'{robot}' is not the namespace of a robot; expected e.g. amr_7")
    return f"/{name}"


class OneRobot(RenamedSource):
    """A live source as one robot's own: of ``/amr_7/motor`` the topic ``/motor``. What is not below is not heard.

    ``/rosout`` is one topic for all: of it are heard the nodes below, ``/amr_7/lidar`` as ``/lidar``.

    Raises SourceError where the name is no namespace.
    """

    def __init__(self, source: LiveSource, robot: str) -> None:
        self.root = namespace_of(robot)
        super().__init__(source, lambda topic: topic if topic == LOG else f"{self.root}/{topic.removeprefix('/')}")

    def _meant(self, topic: str, field: str) -> str:
        return field.replace("[/", f"[{self.root}/", 1) if topic == LOG else field

    @property
    def place(self) -> str:
        """Return where it listens, and below what."""
        return f"{self._source.place}, below {self.root}"

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard: another name, which is told, or what hides any."""
        first = {info.topic.split("/")[1] for info in self._source.topics() if info.topic.count("/") > 1}
        if not first:
            return self._source.hidden_by()
        return [f"there are topics of others{nearest(self.root.strip('/'), sorted(first))}"]

    def topics(self) -> list[TopicInfo]:
        """Return the topics of the robot, named from its namespace; where it has any, the log of all nodes too."""
        all_, below = self._source.topics(), f"{self.root}/"
        own = [info.called(info.topic.removeprefix(self.root)) for info in all_ if info.topic.startswith(below)]
        return own + [info for info in all_ if own and info.topic == LOG]
