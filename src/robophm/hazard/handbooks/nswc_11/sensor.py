"""NSWC-11 §19, sensing elements and transducers:  λ = λB   failures/10⁶ h, of the element without its electronics"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import ONCE, PER_HOUR, TITLE
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(TITLE, "19", "Table 19-4", f"{ONCE}; base rates only")

BASE_RATE = Table("sensing element base rate λB", SOURCE, """
    rtd                            1.5    resistance thermometer
    hall_velocity                  2.5
    electromagnetic_velocity       3.5
    rotational_velocity            2.5    such as of an encoder
    optical_photosensor            0.16
    infrared_motion                7.5
    proximity_electromagnetic      15.38
    infrared_proximity             7.5
    humidity                       20.44
    accelerometer_piezoresistive   15.0
    accelerometer_piezoelectric    13.0
    strain_gauge_semiconductor     23.0
    smoke_ionization               8.0
    smoke_photoelectric            6.5
""")  # fmt: skip


@hazard_model(source=SOURCE, inputs={"element": Choice(BASE_RATE, "what senses")})
def hazard_rate(element: str) -> Factor:
    """λ = λB"""
    return Factor("λB", BASE_RATE[element], f"{element}, failures/10⁶ h") * PER_HOUR
