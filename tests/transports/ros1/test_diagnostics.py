"""Values of diagnostics over ROS 1, as a rospy node tells them: texts with a unit, in the unit of the design."""

from __future__ import annotations

from robophm.design.file import parse
from robophm.transports.ros1 import Ros1

from ..listener import Heard, within
from .conftest import System

DESIGN = """
schema_version: 1
name: R
components:
  motor:
    rate: 1e-5 /h
    acceleration: {model: q10, reference_temperature: 40 degC}
    signals: {temperature: {topic: /diagnostics, field: motor 3/temperature, unit: degC, range: [-40, 150]}}
  gear:
    rate: 1e-5 /h
    acceleration: {model: cubic_load}
    signals: {load: {topic: /diagnostics, field: motor 3/current, unit: A, rated: 10, range: [-100, 100]}}
"""
TALK = """
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
rospy.init_node("driver", anonymous=True)
out = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)
heard(out)
say("ready")
for temperature, current in (("23.5 C", "3.2 A"), ("74.3 degF", "3200 mA"), ("warming up", "12 %")):
    pairs = [KeyValue("temperature", temperature), KeyValue("current", current)]
    message = DiagnosticArray(status=[DiagnosticStatus(0, "motor 3", "", "", pairs)])
    message.header.stamp = rospy.Time.now()
    out.publish(message)
    rospy.sleep(0.05)
rospy.spin()
"""


def test_texts_with_a_unit_are_heard_in_the_unit_of_the_design(system: System) -> None:
    """74.3 °F are 23.5 °C; a share is no current, and words are no temperature."""
    system.start_master()  # its own: others tell of themselves on /diagnostics
    with Ros1(system.uri) as source:
        heard = Heard(source, *parse(DESIGN).signals)
        system.talk(TALK)
        path = "/diagnostics.status[motor 3].values"
        within(8, lambda: len(heard.of(f"{path}[current].value")) == 3)
    temperatures, currents = (heard.of(f"{path}[{key}].value") for key in ("temperature", "current"))
    assert [round(one, 9) for one in temperatures[:2]] == [23.5, 23.5]
    assert [round(one, 9) for one in currents[:2]] == [3.2, 3.2]
    assert all(one != one for one in (temperatures[2], currents[2]))
