"""Transport ``synthetic``: a robot that does not exist, driving a day that can be repeated.

A differential-drive transport AGV of five modules (Power, Sensing, Communication, Mobility, Computation)
carries loads between the stations of a factory, charges when its battery is low, and is off at night. It is
made for demonstrations and tests: believable in size and shape, measured on no robot.

``drive.py`` plans where it goes, ``ota.py`` follows the plan and measures, ``messages.py`` knows how what it says lies
in its messages.
"""

from __future__ import annotations

from robophm.transports.synthetic.ota import SyntheticOta

__all__ = ["SyntheticOta"]
