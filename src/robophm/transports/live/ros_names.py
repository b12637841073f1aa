"""Names as a node of ROS 1 resolves them, and as it is told them when it is started (wiki.ros.org/Names).

``from:=to`` renames, ``__name:=`` and ``__ns:=`` say what the node is called and where, ``_speed:=0.3`` is a parameter
of its own; roslaunch adds words of these kinds to the command of every node that it starts.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from robophm.core.errors import SourceError, nearest
from robophm.transports.live.renamed import RenamedSource
from robophm.transports.signals.source import LiveSource, TopicInfo

ENVIRONMENT = {"__master": "ROS_MASTER_URI", "__ip": "ROS_IP", "__hostname": "ROS_HOSTNAME"}
"""Variables of the environment by the words that go before them."""

SPECIAL = ("__name", "__ns", "__log", *ENVIRONMENT)

_NAME = re.compile(r"[~/]?[A-Za-z]\w*(/\w+)*/?\Z|/\Z", re.ASCII)
_BASE = re.compile(r"[A-Za-z]\w*\Z", re.ASCII)


@dataclass(frozen=True)
class RosNames:
    """The name of a node, its namespace, and what names mean to it; without any it is at the root, as is all else."""

    namespace: str = "/"
    node: str = ""
    """Name of the node in its namespace; empty where it was given none."""
    remaps: Mapping[str, str] = field(default_factory=dict)
    """Whole names by the whole names in whose place they are taken."""
    environment: Mapping[str, str] = field(default_factory=dict)
    """Variables of the environment that were given in words."""
    parameters: Mapping[str, str] = field(default_factory=dict)
    """Private parameters of the node that were given in words, as they were written."""

    @property
    def whole_node(self) -> str:
        """Return the whole name of the node; empty where it was given none."""
        return self.node and _below(self.namespace, self.node)

    def of(self, name: str) -> str:
        """Return the whole name that a name means here. Raises SourceError where a private one has no node."""
        whole = self._whole(name)
        return self.remaps.get(whole, whole)

    def _whole(self, name: str) -> str:
        if name.startswith("~"):
            if not self.node:
                raise SourceError(f"'{name}' is a name of a node that has none itself; expected __name:= with it")
            return _below(self.whole_node, name[1:])
        return name if name.startswith("/") else _below(self.namespace, name)


def names_of(words: Sequence[str], namespace: str = "") -> RosNames:
    """Return the names that the words of a command line say, ``/motor:=/drive/motor`` and ``__ns:=amr_7``.

    ``namespace``: where the node is unless they say so, as ROS_NAMESPACE. Raises SourceError where a word is none.
    """
    own = {name[1:]: value for name, value in map(_parameter, words) if name}
    said = dict(_pairs([word for word in words if not _parameter(word)[0]]))
    root = _below("", said.pop("__ns", namespace) or "/")
    node = said.pop("__name", "")
    if node and not _BASE.match(node):
        raise SourceError(f"'__name:={node}' is not the name of a node; expected e.g. __name:=robophm, and __ns:=amr_7")
    environment = {variable: said.pop(key) for key, variable in ENVIRONMENT.items() if key in said}
    said.pop("__log", None)  # where roslaunch would have a node's log
    for key in said:
        if key.startswith("__"):
            raise SourceError(f"'{key}:=' is nothing that a node is told; expected a name{nearest(key, SPECIAL)}")
    plain = RosNames(root, node)
    remaps = {_below("", plain.of(name)): _below("", plain.of(meant)) for name, meant in said.items()}
    return RosNames(root, node, remaps, environment, own)


def _parameter(word: str) -> tuple[str, str]:
    """The name and the value of ``_name:=value``; of any other word nothing."""
    name, between, value = word.partition(":=")
    return (name, value) if between and re.match(r"_[A-Za-z]\w*\Z", name) else ("", "")


def _pairs(words: Sequence[str]) -> Iterator[tuple[str, str]]:
    for word in words:
        name, between, meant = (part.strip() for part in word.partition(":="))
        if not between or not meant or not (name.startswith("__") or (_NAME.match(name) and _NAME.match(meant))):
            raise SourceError(f"'{word}' gives no name another; expected e.g. /motor:=/drive/motor")
        if name == "__ns" and not _NAME.match(meant):
            raise SourceError(f"'{word}' is no namespace; expected e.g. __ns:=amr_7")
        yield name, meant


def _below(root: str, name: str) -> str:
    """The name below a root, with single slashes, none at its end."""
    return "/" + "/".join(step for step in f"{root}/{name}".split("/") if step)


class Remapped(RenamedSource):
    """A live source by the names that a node has for its topics; its notes have their whole names."""

    def __init__(self, source: LiveSource, names: RosNames) -> None:
        super().__init__(source, names.of)
        self._names = names

    def topics(self) -> list[TopicInfo]:
        """Return the topics by the names that mean them, whole ones; one that another is taken for has none."""
        by_whole: dict[str, list[str]] = {}
        for name, meant in self._names.remaps.items():
            by_whole.setdefault(meant, []).append(name)
        found = []
        for info in self._source.topics():
            own = [info.topic] if info.topic not in self._names.remaps else []
            found += [info.called(name) for name in dict.fromkeys([*own, *by_whole.get(info.topic, ())])]
        return found
