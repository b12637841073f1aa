"""A URDF file, read within bounds: links, joints with their limits, transmissions, ros2_control and Gazebo tags.

Source: the XML specifications of the ROS packages urdf and transmission_interface; the documentation of ros2_control on
its URDF tags; SDFormat's element ``sensor``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from robophm.core.markup import Element, Markup
from robophm.design.naming import printable

MOST = 10_000
"""Links, joints, sensors of one robot; a file with more is refused."""

LONGEST = 120
"""Letters of a name."""

XACRO = "http://www.ros.org/wiki/xacro", "http://ros.org/wiki/xacro", "http://wiki.ros.org/xacro"
_EXPANDED = "expected what xacro makes of it: `xacro {name} > robot.urdf`, or the parameter robot_description"
_INSERTED = re.compile(r"\$\{(\w+)\}|\$\(arg (\w+)\)")
MOVES = ("revolute", "continuous", "prismatic", "planar", "floating")


@dataclass(frozen=True)
class Link:
    """A rigid body."""

    name: str
    mass: float
    """The mass of the body [kg]; 0 where it is not stated."""
    looks: tuple[str, ...]
    """Names of the meshes and materials that it is drawn with, which often name the part."""


@dataclass(frozen=True)
class Joint:
    """A joint between two links, with the limits of its movement."""

    name: str
    type: str
    parent: str
    child: str
    lower: float
    upper: float
    """The ends of its travel [rad, or m of a prismatic joint]; not a number where they are not stated."""
    effort: float
    """The most that it may be driven with [N·m or N]; not a number where it is not stated, or 0."""
    velocity: float
    """The largest speed [rad/s or m/s]; not a number where it is not stated, or 0."""
    mimics: str
    """The joint that it follows, which is driven in its place; "" where there is none."""
    driven: bool
    """Whether a transmission, ros2_control or a plugin of Gazebo moves it."""

    @property
    def moves(self) -> bool:
        """Whether it is no fixed one."""
        return self.type in MOVES


@dataclass(frozen=True)
class Sensor:
    """A sensor that a tag of Gazebo or of ros2_control names."""

    name: str
    type: str
    """The type that a tag of Gazebo states: gpu_lidar, camera, imu …; "" for a sensor of ros2_control."""
    link: str
    topic: str
    """The topic that the tag states; "" where it states none."""
    rings: int
    """Vertical samples of a lidar; 1 where none are stated."""


@dataclass(frozen=True)
class Description:
    """A robot as its URDF describes it."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    sensors: tuple[Sensor, ...]
    plugins: tuple[str, ...]
    """Files and names of the plugins of Gazebo and ros2_control."""

    @property
    def mass(self) -> float:
        """The mass of all links together [kg]; links that state none count as 0."""
        return math.fsum(link.mass for link in self.links)


def read_urdf(path: Path) -> Description:
    """Read the robot that a URDF file describes.

    Raises DesignError, one line, where it cannot be read, is no URDF, or is a xacro file that was not expanded.
    """
    markup = Markup(path)
    root = markup.root()
    if root.tag != "robot":
        raise markup.fault(root.line, f"<{root.tag}> is no URDF; expected <robot name=…>")
    return _Reader(markup, root).description()


class _Reader:
    def __init__(self, markup: Markup, root: Element) -> None:
        self.markup, self.root = markup, root
        self._texts = self._properties()

    def description(self) -> Description:
        links = [self._link(one) for one in self._several("link")]
        known = {link.name for link in links}
        driven = set(self._driven())
        joints = [self._joint(one, known, driven) for one in self._several("joint")]
        if not links:
            raise self.markup.fault(self.root.line, "describes no link; expected a robot with links and joints")
        plugins = {
            said
            for one in self.root.all()
            if one.tag == "plugin"
            for said in (one.attributes.get("filename", ""), one.content)
            if said
        }
        name = self._said(self.root, "name") or self.markup.name.rpartition("/")[2]
        return Description(name, tuple(links), tuple(joints), tuple(self._sensors()), tuple(sorted(plugins)))

    def _several(self, tag: str) -> list[Element]:
        found = list(self.root.each(tag))
        if len(found) > MOST:
            raise self.markup.fault(found[MOST].line, f"more than {MOST:,} of <{tag}>")
        return found

    # -- xacro

    def _properties(self) -> Mapping[str, str]:
        """Arguments and properties that are plain text; whatever else is of xacro is refused."""
        texts: dict[str, str] = {}
        hint = _EXPANDED.format(name=Path(self.markup.name).name)
        for one in self.root.all():
            kind = one.tag.partition(":")[2] if one.tag.startswith("xacro:") else ""
            if kind == "arg" and "name" in one.attributes:
                texts[one.attributes["name"]] = one.attributes.get("default", "")
            elif kind == "property" and {"name", "value"} <= one.attributes.keys():
                texts[one.attributes["name"]] = self._plain(one.attributes["value"], texts, one.line)
            elif kind:
                raise self.markup.fault(one.line, f"<{one.tag}> is xacro, a program that makes a URDF; {hint}")
        return texts

    def _plain(self, text: str, texts: Mapping[str, str], line: int) -> str:
        found = _INSERTED.sub(lambda one: texts.get(one[1] or one[2], one[0]), text)
        if "${" in found or "$(" in found:
            hint = _EXPANDED.format(name=Path(self.markup.name).name)
            raise self.markup.fault(line, f"{text!r:.60} is xacro that is not plain; {hint}")
        return found

    # -- what elements say

    def _said(self, element: Element, key: str) -> str:
        text = self._plain(element.attributes.get(key, ""), self._texts, element.line)
        return printable(text).strip()[:LONGEST]

    def _named(self, element: Element) -> str:
        if name := self._said(element, "name"):
            return name
        raise self.markup.fault(element.line, f"<{element.tag}> has no name")

    def _number(self, element: Element | None, key: str) -> float:
        if element is None or key not in element.attributes:
            return math.nan
        text = self._said(element, key)
        try:
            return float(text)
        except ValueError:
            raise self.markup.fault(element.line, f"<{element.tag} {key}> {text!r:.40} is no number") from None

    def _link(self, element: Element) -> Link:
        inertial = next(element.each("inertial"), None)
        mass = self._number(next(inertial.each("mass"), None) if inertial else None, "value")
        looks = [
            PurePosixPath(self._said(one, "filename")).stem if one.tag == "mesh" else self._said(one, "name")
            for one in element.all()
            if one.tag in ("mesh", "material")
        ]
        return Link(
            self._named(element), mass if 0 < mass < math.inf else 0.0, tuple(dict.fromkeys(filter(None, looks)))
        )

    def _joint(self, element: Element, links: set[str], driven: set[str]) -> Joint:
        name, type_ = self._named(element), self._said(element, "type")
        if type_ not in (*MOVES, "fixed"):
            raise self.markup.fault(
                element.line, f"joint '{name}' is {type_!r:.40}; expected one of {', '.join(MOVES)}, fixed"
            )
        ends: list[str] = []
        for tag in ("parent", "child"):
            end = next(element.each(tag), None)
            link = self._said(end, "link") if end else ""
            if link not in links:
                raise self.markup.fault(element.line, f"joint '{name}' has no {tag} link '{link}'")
            ends.append(link)
        limit, mimic = (next(element.each(tag), None) for tag in ("limit", "mimic"))
        lower, upper, effort, velocity = (self._number(limit, key) for key in ("lower", "upper", "effort", "velocity"))
        return Joint(
            name, type_, ends[0], ends[1], lower, upper, _positive(effort), _positive(velocity),
            self._said(mimic, "joint") if mimic else "", name in driven,
        )  # fmt: skip

    def _driven(self) -> Iterator[str]:
        """The joints that something moves."""
        for one in self.root.all():
            if one.tag == "transmission":
                yield from (self._said(joint, "name") for joint in one.each("joint"))
            elif one.tag == "ros2_control":
                for joint in one.each("joint"):
                    if any(joint.each("command_interface")):
                        yield self._said(joint, "name")
            elif one.tag == "plugin":
                yield from (inner.content for inner in one.all() if "joint" in inner.tag.lower() and inner.content)

    def _sensors(self) -> Iterator[Sensor]:
        for gazebo in self._several("gazebo"):
            for one in (inner for inner in gazebo.all() if inner.tag == "sensor"):
                said = {inner.tag: inner.content for inner in one.all()}
                topic = next((said[key] for key in ("topic", "topicName", "remapping") if said.get(key)), "")
                rings = [
                    samples.content
                    for vertical in one.all()
                    if vertical.tag == "vertical"
                    for samples in vertical.each("samples")
                ]
                yield Sensor(
                    self._said(one, "name"), self._said(one, "type"), self._said(gazebo, "reference"),
                    printable(topic)[:LONGEST], int(rings[0]) if rings and rings[0].isdigit() else 1,
                )  # fmt: skip
        for control in self._several("ros2_control"):
            for one in control.each("sensor"):
                yield Sensor(self._named(one), "", "", "", 1)


def _positive(value: float) -> float:
    return value if 0 < value < math.inf else math.nan
