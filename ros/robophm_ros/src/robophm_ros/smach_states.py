"""The executive of the case study as SMACH states (executive_smach): drop them into a machine of yours.

    idle --task--> plan --told--> legs --done--> tell --told--> idle
                                       --failed--> idle

What moves the robot is yours: ``next_task()`` gives [[x, y, speed], …] or None, ``drive(x, y, speed)`` drives there and
says whether it came there, ``where()`` gives (x, y), and ``tell(topic, text)`` publishes a std_msgs/String.
"""

import json
import time

import smach


class Idle(smach.State):
    """Waits for a task."""

    def __init__(self, next_task, wait=1.0):
        smach.State.__init__(self, outcomes=["task", "preempted"], output_keys=["waypoints"])
        self._next_task, self._wait = next_task, wait

    def execute(self, userdata):
        while not self.preempt_requested():
            waypoints = self._next_task()
            if waypoints:
                userdata.waypoints = waypoints
                return "task"
            time.sleep(self._wait)
        self.service_preempt()
        return "preempted"


class Plan(smach.State):
    """Tells of the task on /robot_task_list, from where the robot is."""

    def __init__(self, tell, where):
        smach.State.__init__(self, outcomes=["told"], input_keys=["waypoints"], output_keys=["waypoints"])
        self._tell, self._where = tell, where

    def execute(self, userdata):
        first, rest = userdata.waypoints[0], userdata.waypoints[1:]
        userdata.waypoints = [[*self._where(), first[2]], *rest]
        self._tell("/robot_task_list", json.dumps([list(each) for each in [[*self._where(), first[2]], *rest]]))
        return "told"


class MayDo(smach.State):
    """Asks phm/assess_task whether the robot may do a task; ``ask(legs)`` is as rospy.ServiceProxy calls it."""

    def __init__(self, ask):
        smach.State.__init__(self, outcomes=["go", "no_go"], input_keys=["legs"], output_keys=["assessment"])
        self._ask = ask

    def execute(self, userdata):
        answer = userdata.assessment = self._ask(userdata.legs)
        return "go" if answer.go and not answer.refused else "no_go"


class Legs(smach.State):
    """Drives leg after leg, and remembers how long each took and where it led."""

    def __init__(self, drive, where):
        smach.State.__init__(
            self, outcomes=["done", "failed", "preempted"], input_keys=["waypoints"], output_keys=["times", "places"]
        )
        self._drive, self._where = drive, where

    def execute(self, userdata):
        times, places = [], [list(self._where())]
        for start, end in zip(userdata.waypoints, userdata.waypoints[1:]):
            if self.preempt_requested():
                self.service_preempt()
                return "preempted"
            begun = time.time()
            if not self._drive(end[0], end[1], start[2]):
                return "failed"
            times.append(time.time() - begun)
            places.append(list(self._where()))
        userdata.times, userdata.places = times, places
        return "done"


class Tell(smach.State):
    """Tells on /task_time and /task_position what the task took."""

    def __init__(self, tell):
        smach.State.__init__(self, outcomes=["told"], input_keys=["times", "places"])
        self._tell = tell

    def execute(self, userdata):
        self._tell("/task_time", json.dumps(userdata.times))
        self._tell("/task_position", json.dumps(userdata.places))
        return "told"


def executive(next_task, drive, where, tell, wait=1.0):
    """All of them in one machine, which ends when it is preempted."""
    machine = smach.StateMachine(outcomes=["preempted"])
    with machine:
        smach.StateMachine.add("IDLE", Idle(next_task, wait), {"task": "PLAN", "preempted": "preempted"})
        smach.StateMachine.add("PLAN", Plan(tell, where), {"told": "LEGS"})
        smach.StateMachine.add("LEGS", Legs(drive, where), {"done": "TELL", "failed": "IDLE", "preempted": "preempted"})
        smach.StateMachine.add("TELL", Tell(tell), {"told": "IDLE"})
    return machine
