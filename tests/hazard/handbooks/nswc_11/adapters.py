"""What the published cases of NSWC-11, and those of the 2020 tool, call their inputs: one adapter a factor.

Where two chapters have a factor of one name, its section stands before it.
"""

import math

from ..adapter import Adapter, measured, same, taken, word


def of_inertia(length, diameter):
    """A section of a shaft, of which the source states the second moment of area, π·d⁴/64."""
    return lambda one: {length: f"{one['L']} inch", diameter: f"{(one['I'] * 64 / math.pi) ** 0.25} inch"}


FIRST, SECOND = of_inertia("length", "diameter"), of_inertia("step_length", "step_diameter")
VISCOSITY = {"nuO": measured("specified_viscosity", "cSt"), "nuL": measured("lubricant_viscosity", "cSt")}
FINISH = {"hot_rolled": "hot_rolled", "machined": "machined_cold_drawn", "forged": "forged"}

FACTORS = {
    "C_G": ("helical_spring", "C_G", {"GM_psi": measured("shear_modulus", "psi")}),
    "C_E": ("torsion_spring", "C_E", {"EM_psi": measured("elastic_modulus", "psi")}),
    "C_Y": ("helical_spring", "C_Y", {"TS_psi": measured("tensile_strength", "psi")}),
    "C_NW": ("wave_washer", "C_NW", {"waves": same("waves")}),
    "C_DW": ("helical_spring", "C_DW", {"Dw_in": measured("wire_diameter", "inch")}),
    "C_DC": ("helical_spring", "C_DC", {"Dc_in": measured("coil_diameter", "inch")}),
    "C_N": ("helical_spring", "C_N", {"Na": same("active_coils")}),
    "C_L": (
        "helical_spring", "C_L",
        {"L1_in": lambda longer, case: {"deflection": f"{longer - case['L2_in']} inch"}, "L2_in": taken},
    ),
    "C_K": (
        "helical_spring", "C_K",
        {"Dc": measured("coil_diameter", "inch"), "Dw": measured("wire_diameter", "inch")},
    ),
    "C_CS": ("helical_spring", "C_CS", {"CR_cpm": measured("cycle_rate", "cycle/min")}),
    "C_R": ("bearing", "C_R", {"R_percent": measured("reliability", "percent")}),
    "C_nu": ("bearing", "C_ν", VISCOSITY),
    "C_CW": ("bearing", "C_CW", {"water_percent": measured("water", "percent")}),
    "C_t": ("bearing", "C_t", {"T_C": measured("temperature", "degC")}),
    "lambda_G,B": (  # of a revolution: an hour has one at 1/60 of a revolution a minute
        "gear", "λG,B",
        {"design_life_revolutions": lambda life, _: {"design_life": f"{life} revolution", "speed": f"{1 / 60} rpm"}},
    ),
    "lambda_G,B per hour": (
        "gear", "λG,B", {"rpm": measured("speed", "rpm"), "revolutions": measured("design_life", "revolution")}
    ),
    "C_GS": ("gear", "C_GS", {"Vo": measured("speed", "rpm"), "Vd": measured("design_speed", "rpm")}),
    "C_GP": ("gear", "C_GP", {"LO": measured("load", "N*m"), "LD": measured("design_load", "N*m")}),
    "C_GA": ("gear", "C_GA", {"AE_rad": measured("misalignment", "rad")}),
    "C_GL": ("gear", "C_GL", VISCOSITY),
    "C_GT": ("gear", "C_GT", {"T_F": measured("temperature", "degF")}),
    "C_H": ("actuator_axial_load", "C_H", {"HP": same("particle_hardness"), "HC": same("cylinder_hardness")}),
    "C_S": ("actuator_axial_load", "C_S", {"filter_um": measured("filter_size", "um")}),
    "lambda_WI,B": ("electric_motor", "λ_WI,B", {"L_I_h": measured("winding_life", "h")}),
    ("14.5.2", "C_T"): ("electric_motor", "C_T", {"T_C": measured("temperature", "degC")}),
    "C_V single": (
        "electric_motor", "C_V",
        {
            "VD": lambda volts, case: {"kind": "ac_single_phase", "voltage_deviation": volts / case["VR"]},
            "VR": taken,
        },
    ),
    "C_V three": (
        "electric_motor", "C_V",
        {"VU_percent": lambda percent, _: {"kind": "ac_polyphase", "voltage_unbalance": f"{percent} percent"}},
    ),
    "C_alt": ("electric_motor", "C_alt", {"a_ft": measured("altitude", "foot")}),
    "C_f": (
        "shaft", "C_f",
        {"finish": word("finish", FINISH), "TS_kpsi": lambda kpsi, _: {"tensile_strength": f"{1000 * kpsi} psi"}},
    ),
    ("20.4.3", "C_T"): ("shaft", "C_T", {"T_F": measured("temperature", "degF")}),
    "C_DY": (
        "shaft", "C_DY",
        {
            "E_psi": measured("elastic_modulus", "psi"),
            "F_lb": measured("force", "lbf"),
            "b_in": measured("allowable_bending", "inch"),
            "sections": lambda two, _: {**FIRST(two[0]), **SECOND(two[1])},
        },
    ),
    "C_SC,R": (
        "shaft", "C_SC,R",
        {
            "r": measured("fillet_radius", "inch"),
            "D": measured("step_diameter", "inch"),
            "d": measured("diameter", "inch"),
        },
    ),
    "lambda_SH,B": ("shaft", "10⁶/N", {"N_cycles": measured("cycles_to_failure", "cycle")}),
    "C_P": ("static_seal", "C_P", {"P_psi": measured("pressure", "psi")}),
}  # fmt: skip
"""By their factor: our model, our symbol, and the names of the inputs."""

ADAPTERS = {
    key: Adapter(f"nswc_11.{kind}", names, {key[1] if isinstance(key, tuple) else key: ours})
    for key, (kind, ours, names) in FACTORS.items()
}
