"""Behaviours of py_trees for a robot that asks before it goes: put ``MayDo`` before what drives.

    selector
    ├── sequence
    │   ├── MayDo      phm/assess_task
    │   └── your driving
    └── your way home

``ask(legs)`` calls the service and returns its response, as rospy.ServiceProxy does; it may take its time, for it is
called in a thread, and the tree ticks on.
"""

from concurrent.futures import ThreadPoolExecutor

import py_trees
from py_trees.common import Access, Status


class MayDo(py_trees.behaviour.Behaviour):
    """Succeeds where the robot, as it is now, may do the task on the blackboard, and fails where not, or not known.

    Reads ``legs``, phm_msgs/TaskLeg; writes ``assessment``, the response, or None where there was no answer. With
    ``prefix`` also a task is done of which the first legs alone may be: ``legs`` are then these.
    """

    def __init__(self, ask, prefix=False, name="may do the task"):
        super().__init__(name)
        self._ask, self._prefix = ask, prefix
        self._calls = ThreadPoolExecutor(1)
        self._call = None
        self.board = self.attach_blackboard_client(name)
        self.board.register_key("legs", access=Access.WRITE)
        self.board.register_key("assessment", access=Access.WRITE)

    def initialise(self):
        self._call = self._calls.submit(self._ask, self.board.legs)

    def update(self):
        if not self._call.done():
            self.feedback_message = "waits for an answer"
            return Status.RUNNING
        error = self._call.exception()
        answer = self.board.assessment = None if error else self._call.result()
        if answer is None or answer.refused:
            self.feedback_message = str(error) if error else answer.refused
            return Status.FAILURE
        self.feedback_message = "completed with %.4g, at least %.4g is wanted" % (
            answer.completion_sensor_based, answer.limit)  # fmt: skip
        if not answer.go and self._prefix and answer.longest_prefix:
            self.board.legs = self.board.legs[: answer.longest_prefix]
            return Status.SUCCESS
        return Status.SUCCESS if answer.go else Status.FAILURE

    def terminate(self, new_status):
        if self._call and not self._call.done():
            self._call.cancel()

    def shutdown(self):
        self._calls.shutdown(wait=False)
