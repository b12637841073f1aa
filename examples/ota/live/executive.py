"""The executive of the case study: takes tasks from a server, drives them leg by leg, and tells of them.

States: idle → task → legs → done → idle. A task that comes is told as ``/robot_task_list`` [[x, y, speed], …], from
which its probability of completion is predicted; when it is done, ``/task_time`` [s] and ``/task_position`` [[x, y], …]
say what it took, and by them it is judged again.
"""

from __future__ import annotations

import json
import math
import signal
import sys
import time
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum

from robophm.core.signal import Sample
from ros import Ros, header

NEAR = 0.05
"""How near a waypoint is reached [m]."""

PATIENCE = 5.0
"""Times as long as a leg should take, after which the task is given up."""

Waypoint = tuple[float, float, float]
"""x, y [m], and the speed from there on [m/s]."""


class State(Enum):
    """Where the executive is."""

    IDLE = "idle"
    TASK = "task"
    LEGS = "legs"
    DONE = "done"


@dataclass
class Executive:
    """The state machine; ``step`` is called with where the robot is, and says what is to be published.

    It knows nothing of ROS, so that SMACH states can be made of it as well.
    """

    state: State = State.IDLE
    waypoints: list[Waypoint] = field(default_factory=list)
    leg: int = 0
    begun: float = 0.0
    """Of the leg [s]."""
    times: list[float] = field(default_factory=list)
    places: list[tuple[float, float]] = field(default_factory=list)
    given_up: int = 0

    def take(self, waypoints: list[Waypoint]) -> None:
        """A task. Raises ValueError where it is none, or one is under way."""
        if self.state is not State.IDLE:
            raise ValueError("a task is under way")
        if len(waypoints) < 2 or not all(len(each) == 3 and each[2] > 0 for each in waypoints):
            raise ValueError(f"{waypoints} is no task; expected [[x, y, speed], …], two at least, speeds above zero")
        self.waypoints, self.state = waypoints, State.TASK

    def step(self, now: float, place: tuple[float, float]) -> Iterator[tuple[str, object]]:
        """Topics and what to say on them; at most one change of state."""
        if self.state is State.TASK:
            # the task begins where the robot is, not where it was thought to be
            self.waypoints[0] = (*place, self.waypoints[0][2])
            yield "/robot_task_list", self.waypoints
            self.leg, self.times, self.places, self.begun = 0, [], [place], now
            self.state = State.LEGS
            yield "/ota/goal", (*self.waypoints[1][:2], self.waypoints[0][2])
        elif self.state is State.LEGS:
            here, there = self.waypoints[self.leg], self.waypoints[self.leg + 1]
            if math.dist(place, there[:2]) < NEAR:
                self.times.append(now - self.begun)
                self.places.append(place)
                self.leg, self.begun = self.leg + 1, now
                if self.leg + 1 == len(self.waypoints):
                    self.state = State.DONE
                else:
                    yield "/ota/goal", (*self.waypoints[self.leg + 1][:2], self.waypoints[self.leg][2])
            elif now - self.begun > PATIENCE * (math.dist(here[:2], there[:2]) / here[2] + 5):
                self.given_up += 1
                self.state = State.IDLE
        elif self.state is State.DONE:
            yield "/task_time", self.times
            yield "/task_position", self.places
            self.state = State.IDLE


def next_task(server: str) -> list[Waypoint] | None:
    """What the server has to do; None where it has nothing, or does not answer."""
    try:
        with urllib.request.urlopen(f"{server}/next", timeout=2) as answer:
            text = answer.read(1 << 16)
    except OSError:
        return None
    return [(float(x), float(y), float(speed)) for x, y, speed in json.loads(text)] if text else None


def main(server: str) -> None:
    """Until SIGTERM or SIGINT."""
    executive, place = Executive(), {"x": math.nan, "y": math.nan}
    with Ros("/ota_executive") as ros:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: ros.source.close())
        texts = {
            topic: ros.publisher(topic, "std_msgs/msg/String")
            for topic in ("/robot_task_list", "/task_time", "/task_position")
        }
        goal = ros.publisher("/ota/goal", "nav_msgs/msg/Odometry", latched=True)
        asked = time.monotonic()  # who listens to tasks has a second to find us before the first
        signals = {f"/ota/odom.pose.pose.position.{axis}": axis for axis in "xy"}
        for heard in ros.listen(signals, ()):
            if isinstance(heard, Sample) and heard.signal in signals:
                place[signals[heard.signal]] = heard.value
                continue
            now = time.monotonic()
            here = place["x"], place["y"]
            if math.isnan(sum(here)):
                continue
            if executive.state is State.IDLE and now - asked > 1:
                asked = now
                if task := next_task(server):
                    executive.take(task)
            before = executive.state
            for topic, content in executive.step(now, here):
                if topic == "/ota/goal":
                    x, y, speed = content
                    goal({"header": header("odom"), "pose": {"pose": {"position": {"x": x, "y": y}}},
                          "twist": {"twist": {"linear": {"x": speed}}}})  # fmt: skip
                else:
                    texts[topic]({"data": json.dumps(content)})
            if executive.state is not before:
                print(f"{before.value} → {executive.state.value}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
