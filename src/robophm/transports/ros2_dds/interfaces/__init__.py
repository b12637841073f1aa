"""Interfaces that other packages than ROS 2's own define, for robots whose workspace is not here: Nav2's, PX4's …

A file of text for each package: what a type is made of, as far as messages and hashes depend on it, by the releases
that have it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from functools import lru_cache
from importlib.resources import files
from typing import NamedTuple

from robophm.core.errors import SourceError

PX4 = "px4_msgs"
"""The package of PX4, whose publishers tell no hash (the bridge of uXRCE-DDS knows none)."""

PX4_RELEASE = "PX4_RELEASE"
"""The environment variable that names the release of PX4, where it cannot be told by the topic."""

_TYPE = re.compile(r"(\S+?)(?: version (\d+))?: (.+)")
_VERSIONED = re.compile(r"_v(\d+)\Z")


class Interface(NamedTuple):
    """A type as one release has it."""

    text: str
    """Fields of the type, as in a ``.msg`` file."""
    version: str
    """Version of the message, as PX4 counts it; empty where it has none."""


@lru_cache(maxsize=64)
def releases(package: str) -> dict[str, dict[str, Interface]]:
    """Return the types of a package by name, by release, the oldest first; none where the package is not here."""
    file = files(__name__) / f"{package}.txt"
    found: dict[str, dict[str, Interface]] = {}
    if not file.is_file():
        return found
    blocks = re.split(r"\n(?=\S)", file.read_text(encoding="utf-8").rstrip("\n"))
    for head, *fields in (block.split("\n") for block in blocks if not block.startswith("#")):
        if match := _TYPE.match(head):
            name, version, labels = match.groups()
            for label in labels.split():
                text = "".join(f"{field.strip()}\n" for field in fields)
                found.setdefault(label, {})[name] = Interface(text, version or "")
    return found


def candidates(topic: str, name: str, told: str) -> Iterator[tuple[str, dict[str, Interface]]]:
    """Yield the releases that have a type, with all that they have, the oldest first.

    Of PX4, whose publishers tell no hash, those that can be the one that publishes ``topic``; raises SourceError where
    these differ.
    """
    package = name.partition("/")[0]
    having = {label: types for label, types in releases(package).items() if name in types}
    if package == PX4 and not told:
        having = _of_px4(topic, name, having)
    yield from having.items()


def _of_px4(topic: str, name: str, having: dict[str, dict[str, Interface]]) -> dict[str, dict[str, Interface]]:
    """Since 1.16 a topic ends in the version of its message, ``_v1``, unless that is 0 (PX4: message versioning)."""
    if release := os.environ.get(PX4_RELEASE):
        if release not in releases(PX4):
            known = ", ".join(releases(PX4))
            raise SourceError(f"{PX4_RELEASE} is '{release}', of which no messages are known; expected one of {known}")
        return {label: types for label, types in having.items() if label == release}
    version = _VERSIONED.search(topic)
    wanted = {version[1]} if version else {"", "0"}
    having = {label: types for label, types in having.items() if types[name].version in wanted}
    if len({types[name].text for types in having.values()}) > 1:
        raise SourceError(
            f"topic '{topic}': releases {', '.join(having)} of PX4 define '{name}' differently, and its publisher does "
            f"not tell which it has; expected {PX4_RELEASE}={[*having][-1]} or the like"
        )
    return having
