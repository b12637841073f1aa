"""Dimensions: what is scaled together leaves a rate as it is, and at the handbooks' reference points factors are 1.

For kinds of which hardly an answer is published: a slip in a power, a unit or a ratio breaks one of these.
"""

import math

import pytest
from tests.cases import each_case

from robophm.hazard.handbooks import handbook_models

from .adapter import Adapter, plausible

LENGTHS = dict.fromkeys(
    ("diameter", "length", "step_diameter", "step_length", "fillet_radius", "groove_depth", "groove_radius"), 1
)
COIL = {"wire_diameter": 1, "coil_diameter": 1}
WASHER = {"thickness": 1, "outer_diameter": 1, "deflection": 1}
LEAF = {"thickness": 1, "span": 1, "deflection": 1}
STRENGTH = {"elastic_modulus": 1, "tensile_strength": 1}
PISTON = {"bore": 1, "piston_diameter": 1}
STIFFNESS = {"cylinder_modulus": 1, "piston_modulus": 1, "yield_strength": 1}
VISCOSITIES = {"specified_viscosity": 1, "lubricant_viscosity": 1}

SIMILAR = [
    ("nswc_11.helical_spring", {**COIL, "deflection": 1}, 0),
    ("nswc_11.helical_spring", {"shear_modulus": 1, "tensile_strength": 1}, 0),
    ("nswc_11.torsion_spring", COIL, 0),
    ("nswc_11.torsion_spring", STRENGTH, 0),
    ("nswc_11.curved_washer", WASHER, 0),
    ("nswc_11.wave_washer", WASHER, 0),
    ("nswc_11.belleville_washer", {**WASHER, "inner_diameter": 1}, 0),
    ("nswc_11.belleville_washer", STRENGTH, 0),
    ("nswc_11.cantilever_spring", LEAF, 0),
    ("nswc_11.beam_spring", LEAF, 0),
    ("nswc_11.beam_spring", STRENGTH, 0),
    ("nswc_11.gear", {"load": 1, "design_load": 1}, 0),
    ("nswc_11.gear", {"speed": 1, "design_speed": 1}, 1),  # as many more revolutions an hour
    ("nswc_11.gear", {"design_life": 1}, -1),
    ("nswc_11.gear", VISCOSITIES, 0),
    ("nswc_11.spline", {"diameter": 1, "length": 1, "torque": 3}, 0),
    ("nswc_11.spline", {"hardness": 1, "torque": 1}, 0),
    ("nswc_11.spline", {"speed": 1, "design_speed": 1}, 1),
    ("nswc_11.bearing", {"load": 1, "dynamic_rating": 1}, 0),
    ("nswc_11.bearing", {"speed": 1}, 1),
    ("nswc_11.bearing", VISCOSITIES, 0),
    ("nswc_11.bearing_rated_life", {"load": 1, "specified_load": 1}, 0),
    ("nswc_11.bearing_rated_life", {"rated_life": 1}, -1),
    ("nswc_11.actuator_side_load", {"load": 2, "contact_length": 1, **PISTON}, 0),
    ("nswc_11.actuator_side_load", {"load": 1, **STIFFNESS}, 0),
    ("nswc_11.actuator_side_load", {"load": 1, "contact_length": 1}, 0),
    ("nswc_11.actuator_axial_load", {"load": 2, **PISTON}, 0),
    ("nswc_11.actuator_axial_load", {"load": 1, **STIFFNESS}, 0),
    ("nswc_11.actuator_axial_load", {"particle_hardness": 1, "cylinder_hardness": 1}, 0),
    ("nswc_11.shaft", {"force": 2, "allowable_bending": 1, **LENGTHS}, 0),
    ("nswc_11.shaft", {"force": 1, "elastic_modulus": 1}, 0),
    ("nswc_11.shaft", {"cycles_to_failure": 1}, -1),
    ("nswc_11.static_seal", {"hardness": 1, "contact_pressure": 1}, 0),
    ("nswc_11.static_seal", {"filter_size": 1, "particles": -3}, 0),
    ("nswc_11.static_seal", {"flow": 1, "particles": -1}, 0),
    ("mil_hdbk_217f.capacitor", {"dc_voltage": 1, "ac_voltage": 1, "rated_voltage": 1}, 0),
    ("mil_hdbk_217f.diode_low_frequency", {"voltage": 1, "rated_voltage": 1}, 0),
    ("mil_hdbk_217f.thyristor", {"voltage": 1, "rated_voltage": 1}, 0),
    ("mil_hdbk_217f.transistor_bipolar_low_frequency", {"voltage": 1, "rated_voltage": 1}, 0),
    ("mil_hdbk_217f.transistor_bipolar_low_noise_high_frequency", {"voltage": 1, "rated_voltage": 1}, 0),
    ("mil_hdbk_217f.transistor_bipolar_high_power_high_frequency", {"voltage": 1, "rated_voltage": 1}, 0),
    ("mil_hdbk_217f.relay", {"load_current": 1, "rated_current": 1}, 0),
    ("mil_hdbk_217f.switch", {"load_current": 1, "rated_current": 1}, 0),
    ("mil_hdbk_217f.laser_diode", {"required_optical_power": 1, "rated_optical_power": 1}, 0),
    ("mil_hdbk_217f.surface_mount", {"package_side": 1, "joint_height": 1}, 0),
    ("mil_hdbk_217f.microcircuit.hybrid", {"component_rate": 1}, 1),
    *(
        (kind, {"power": 1, "thermal_resistance": -1}, 0)
        for kind in handbook_models()
        if "thermal_resistance" in Adapter(kind, {}).model.inputs
    ),
]
"""What is scaled by which power of a number, and the power of it by which the rate then is."""


@each_case("times", [0.9, 1.1])
@each_case(("kind", "powers", "result"), SIMILAR)
def test_what_is_scaled_together(kind, powers, result, times):
    model = Adapter(kind, {}).model
    inputs = model.settle(plausible(kind))
    scaled = inputs | {name: inputs[name] * times**power for name, power in powers.items() if name in inputs}
    assert len(scaled.items() - inputs.items()) == len(powers) - ("ac_voltage" in powers)  # of which there is none
    once, then = (float(model.evaluate(given).value) for given in (inputs, scaled))
    assert then / once == pytest.approx(times**result, rel=1e-9)


def of(kind, symbol, **given):
    """One factor of a model at its plausible inputs, of which some are changed."""
    found = Adapter(kind, {})
    return found.leaves(found.model.settle({**plausible(kind), **given}))[symbol]


AT_25 = {"temperature": "25 degC", "power": "0 W"}
REFERENCE = [
    ("mil_hdbk_217f.resistor", "πT", {"temperature": "25 degC"}, 1),
    ("mil_hdbk_217f.resistor", "πP", {"power": "1 W", "rated_power": "1 W"}, 1),
    ("mil_hdbk_217f.capacitor", "πT", {"temperature": "25 degC"}, 1),
    ("mil_hdbk_217f.capacitor", "πC", {"capacitance": "1 uF"}, 1),
    ("mil_hdbk_217f.capacitor", "πV", {"style": "CDR", "dc_voltage": "6 V", "rated_voltage": "10 V"}, 2),
    ("mil_hdbk_217f.coil", "πT", {"temperature": "25 degC", "temperature_rise": "0 K"}, 1),
    ("mil_hdbk_217f.transformer", "πT", {"temperature": "25 degC", "temperature_rise": "0 K"}, 1),
    ("mil_hdbk_217f.connector", "πT", {"temperature": "25 degC", "current": "0 A"}, 1),
    ("mil_hdbk_217f.relay", "λb", {"temperature": "25 degC"}, 0.0059),
    ("mil_hdbk_217f.crystal", "λb", {"frequency": "1 MHz"}, 0.013),
    ("mil_hdbk_217f.connector_socket", "πP", {"contacts": 1}, 1),
    ("mil_hdbk_217f.synchro", "λb", {"temperature": "61 degC", "frame_rise": "0 K"}, 0.00535 * math.e),
    *((f"mil_hdbk_217f.{kind}", "πT", AT_25, 1) for kind in (
        "diode_low_frequency", "diode_high_frequency", "transistor_bipolar_low_frequency",
        "transistor_bipolar_low_noise_high_frequency", "transistor_fet_low_frequency",
        "transistor_fet_high_frequency", "transistor_gaas_fet", "transistor_unijunction", "thyristor",
        "optoelectronic", "display", "laser_diode",
    )),
    *((f"mil_hdbk_217f.microcircuit.{kind}", "πT", {"case_temperature": "25 degC", "power": "0 W"}, 0.1) for kind in (
        "logic", "linear", "processor", "programmable", "memory", "vhsic",
    )),
    ("mil_hdbk_217f.microcircuit.gaas", "πT", {"case_temperature": "150 degC", "power": "0 W"}, 0.1),
    ("nswc_11.gear", "C_GS", {"speed": "9 rpm", "design_speed": "9 rpm"}, 2),
    ("nswc_11.gear", "C_GP", {"load": "5 N*m", "design_load": "10 N*m"}, 1),
    ("nswc_11.gear", "C_GA", {"misalignment": "0.006 rad"}, 1),
    ("nswc_11.gear", "C_GT", {"temperature": "160 degF"}, 1),
    ("nswc_11.gear", "λG,B", {"speed": "100 rpm", "design_life": "1e8 revolution"}, 60.0),
    ("nswc_11.bearing", "C_t", {"temperature": "183 degC"}, 1),
    ("nswc_11.bearing", "C_CW", {"water": "0 percent"}, 1),
    ("nswc_11.electric_motor", "C_T", {"temperature": "40 degC"}, 1),
    ("nswc_11.electric_motor", "C_alt", {"altitude": "3300 foot"}, 1),
    ("nswc_11.actuator_axial_load", "C_T", {"temperature": "25.2 degC"}, 1),
    ("nswc_11.actuator_side_load", "C_S", {"filter_size": "10 um"}, 1),
    ("nswc_11.coupling", "λ_CP,B", {}, 5.0),
    ("nswc_11.coupling", "λ_H", {}, 0.001),
    ("nswc_11.shaft", "C_T", {"temperature": "160 degF"}, 1),
    ("nswc_11.shaft", "C_SC,R", {"diameter": "10 mm", "step_diameter": "10.001 mm", "fillet_radius": "3 mm"}, 1),
]  # fmt: skip
"""Where the handbooks normalise a factor."""


@each_case(("kind", "symbol", "given", "expected"), REFERENCE)
def test_at_its_reference_point(kind, symbol, given, expected):
    assert of(kind, symbol, **given) == pytest.approx(expected, rel=1e-4 if symbol == "C_SC,R" else 1e-9)
