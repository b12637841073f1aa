"""What the published cases of MIL-HDBK-217F Notice 2 call their inputs, one adapter a section.

A worked example that another section answers, such as those of §5.13, has an adapter under its own name.
"""

from dataclasses import replace

from robophm.hazard.handbooks.mil_hdbk_217f import _semiconductor as semiconductor
from robophm.hazard.handbooks.mil_hdbk_217f import (
    capacitor,
    coil,
    diode_high_frequency,
    diode_low_frequency,
    relay,
    resistor,
    surface_mount,
    switch,
    transistor_gaas_fet,
)

from ..adapter import Adapter, measured, of_rated, same, taken, word, worth

ENVIRONMENT = {"environment": same("environment")}
QUALITY = {"quality": same("quality")}
JUNCTION = {"TJ_C": measured("temperature", "degC")}
AT_THE_JUNCTION = {"power": "0 W"}
"""The case gives the junction's temperature, so nothing is added to it."""
CASE_TEMPERATURE = {"TJ_C": measured("case_temperature", "degC")}
CHIP = {
    **CASE_TEMPERATURE, **QUALITY, **ENVIRONMENT,
    "pins": same("pins"),
    "package": word("package", {"dip_glass_seal": "DIP-glass", "flatpack": "flatpack"}),
    "years_in_production": measured("years_in_production", "year"),
}  # fmt: skip
SEMICONDUCTOR = {**JUNCTION, **ENVIRONMENT, "piQ": worth("quality", semiconductor.QUALITY)}
FREQUENCY = {"F_GHz": measured("frequency", "GHz"), "P_W": measured("output_power", "W")}


def of_column(table, style):
    """All rows of a table of styles whose factor is of that column."""
    return lambda symbol, column: [
        {style: row} for row in table if table.cell(row, f"{symbol} column") == column
    ]  # fmt: skip


ADAPTERS = {
    "5.3": Adapter(
        "mil_hdbk_217f.microcircuit.vhsic", {"VTH_V": measured("discharge_threshold", "V")}, {"lambda_EOS": "λEOS"}
    ),
    "6.1": Adapter(
        "mil_hdbk_217f.diode_low_frequency",
        {
            **SEMICONDUCTOR,
            "diode_type": same("kind"),
            "S": of_rated("voltage", "rated_voltage", "V"),
            "piC": worth("contact", diode_low_frequency.CONTACT),
        },
        {"piT": "πT", "piS": "πS"},
        unsaid=AT_THE_JUNCTION,
        alike={
            "B": lambda _, b: [
                {"kind": kind, **AT_THE_JUNCTION}
                for kind in diode_low_frequency.KIND
                if diode_low_frequency.KIND.cell(kind, "B") == b
            ]
        },
    ),
    "6.2": Adapter(
        "mil_hdbk_217f.diode_high_frequency",
        {
            **JUNCTION, **ENVIRONMENT,
            "type": same("kind"),
            "P_rated_W": measured("rated_power", "W"),
            "piQ": worth("quality", diode_high_frequency.QUALITY),
        },
        unsaid=AT_THE_JUNCTION,
    ),
    "6.3": Adapter(
        "mil_hdbk_217f.transistor_bipolar_low_frequency",
        {
            **SEMICONDUCTOR, **QUALITY,
            "application": same("application"),
            "P_rated_W": measured("rated_power", "W"),
            "P_W": measured("rated_power", "W"),
            "S": of_rated("voltage", "rated_voltage", "V"),
            "VCE_ratio": of_rated("voltage", "rated_voltage", "V"),
        },
        {"piR": "πR", "piS": "πS"},
        unsaid=AT_THE_JUNCTION,
    ),
    "6.4": Adapter(
        "mil_hdbk_217f.transistor_fet_low_frequency",
        {**SEMICONDUCTOR, "fet": same("kind"), "application": same("application")},
        # Appendix A's silicon is a small-signal switch, below 2 W, which the case does not say
        unsaid={**AT_THE_JUNCTION, "rated_power": "0.5 W"},
    ),
    "6.7": Adapter(
        "mil_hdbk_217f.transistor_bipolar_high_power_high_frequency",
        FREQUENCY,
        {"lambda_b": "λb"},
        beyond="RAMSTK's example is of 50 mW, where the section begins at 1 W",
    ),
    "6.8": Adapter(
        "mil_hdbk_217f.transistor_gaas_fet",
        {
            **JUNCTION, **ENVIRONMENT, **FREQUENCY,
            "application": same("application"),
            "piM": worth("matching", transistor_gaas_fet.MATCHING),
            "piQ": worth("quality", semiconductor.RF_QUALITY),
        },
        unsaid=AT_THE_JUNCTION,
    ),
    "6.10": Adapter(
        "mil_hdbk_217f.thyristor",
        {"I_A": measured("rated_current", "A"), "S": of_rated("voltage", "rated_voltage", "V")},
        {"piR": "πR", "piS": "πS"},
    ),
    "6.12": Adapter(
        "mil_hdbk_217f.display",
        {
            **SEMICONDUCTOR,
            "type": same("kind"),
            "C": same("characters"),
            "logic_chip": word("logic_chip", {False: "without", True: "with"}),
        },
        unsaid=AT_THE_JUNCTION,
    ),
    "6.13": Adapter("mil_hdbk_217f.laser_diode", {"I_A": measured("current", "A")}, {"piI": "πI"}),
    "9.1": Adapter(
        "mil_hdbk_217f.resistor",
        {
            **ENVIRONMENT,
            "style": same("style"),
            "T_C": measured("temperature", "degC"),
            "P_W": lambda watts, _: {"power": f"{watts} W", "rated_power": f"{watts} W"},
            "S": lambda share, case: {
                "power": f"{case.get('P_dissipated_W', share)} W",
                "rated_power": f"{case.get('P_dissipated_W', share) / share} W",
            },
            "P_dissipated_W": taken,
            "piQ": worth("quality", resistor.QUALITY),
        },
        {"piT": "πT", "piP": "πP", "piS": "πS"},
        alike={"column": of_column(resistor.STYLE, "style")},
    ),
    "10.1": Adapter(
        "mil_hdbk_217f.capacitor",
        {
            **ENVIRONMENT, **QUALITY,
            "style": same("style"),
            "C_uF": measured("capacitance", "uF"),
            "TA_C": measured("temperature", "degC"),
            "S": of_rated("dc_voltage", "rated_voltage", "V"),
            "Vdc": measured("dc_voltage", "V"),
            "Vac_rms": measured("ac_voltage", "V"),
            "V_rated": measured("rated_voltage", "V"),
            "CR_ohm_per_V": measured("series_resistance", "ohm/V"),
            "piQ": worth("quality", capacitor.QUALITY),
        },
        {"piT": "πT", "piC": "πC", "piV": "πV"},
        alike={"column": of_column(capacitor.STYLE, "style")},
    ),
    "11.1": Adapter(
        "mil_hdbk_217f.transformer",
        {**ENVIRONMENT, **QUALITY, "type": same("kind"), "THS_C": measured("temperature", "degC")},
        unsaid={"temperature_rise": "0 K"},  # of the hot spot above itself
    ),
    "11.2": Adapter(
        "mil_hdbk_217f.coil",
        {
            **ENVIRONMENT,
            "THS_C": lambda celsius, _: {"temperature": f"{celsius} degC", "temperature_rise": "0 K"},
            "piQ": worth("quality", coil.QUALITY),
        },
        {"piT": "πT"},
        unsaid={"kind": "fixed"},  # as the case's name says
    ),
    "12.1": Adapter(
        "mil_hdbk_217f.motor",
        {
            "motor_type": same("kind"),
            "TA_C": measured("temperature", "degC"),
            "LC_h": measured("design_life", "h"),
        },
        {
            "alphaB": lambda leaves: 1 / leaves["1/αB"], "alphaW": lambda leaves: 1 / leaves["1/αW"],
            "alpha_B_h": lambda leaves: 1 / leaves["1/αB"], "alpha_W_h": lambda leaves: 1 / leaves["1/αW"],
        },
    ),
    "12.2": Adapter(
        "mil_hdbk_217f.synchro",
        {"TF_C": lambda celsius, _: {"temperature": f"{celsius} degC", "frame_rise": "0 K"}},
        {"lambda_b": "λb"},
    ),
    "13.1": Adapter(
        "mil_hdbk_217f.relay",
        {
            **ENVIRONMENT, **QUALITY,
            "rated_temp_C": measured("rated_temperature", "degC"),
            "rated_C": measured("rated_temperature", "degC"),
            "TA_C": measured("temperature", "degC"),
            "load": same("load"),
            "S": of_rated("load_current", "rated_current", "A"),
            "contact_form": same("contact_form"),
            "cycles_per_h": measured("cycling", "cycle/h"),
            "construction": word(
                "construction", {"0-5 A general purpose balanced armature (piF 5)": "general-balanced-armature"}
            ),
            "piQ": worth("quality", relay.QUALITY),
        },
        {"lambda_b": "λb", "piL": "πL", "piCYC": "πCYC"},
    ),
    "14.1": Adapter(
        "mil_hdbk_217f.switch",
        {
            **ENVIRONMENT, **QUALITY,
            "type": same("style"),
            "S": of_rated("load_current", "rated_current", "A"),
            "contacts": worth("contact_form", switch.CONTACTS),
        },
        unsaid={"load": "resistive"},  # of which there is none: S is 0
    ),
    "14.2": Adapter(
        "mil_hdbk_217f.circuit_breaker",
        {**ENVIRONMENT, **QUALITY, "poles": same("poles"), "usage": word("use", {"not power switch": "breaker-only"})},
    ),
    "15.1": Adapter(
        "mil_hdbk_217f.connector",
        {
            **ENVIRONMENT, **QUALITY,
            "type": same("style"),
            "TA_C": measured("temperature", "degC"),
            "T0_C": lambda celsius, _: {"temperature": f"{celsius} degC", "current": "0 A"},
            "dT_C": lambda rise, _: {0: {"current": "0 A"}}[rise],
            "matings_per_1000h": measured("matings", "/10^3 h"),
        },
        {"piT": "πT"},
        unsaid={"wire_gauge": "22"},  # which counts only with a current
    ),
    "15.2": Adapter(
        "mil_hdbk_217f.connector_socket",
        {
            **ENVIRONMENT,
            "type": same("style"),
            "pins": same("contacts"),
            "N": same("contacts"),
            "piQ": word("quality", {0.3: "MIL-SPEC", 1.0: "lower"}),
        },
        {"piP": "πP"},
    ),
    "16.1": Adapter(
        "mil_hdbk_217f.printed_board",
        {
            **ENVIRONMENT, **QUALITY,
            "lambda_b": word("technology", {"printed_wiring_board": "printed"}),
            "N1": same("automated_holes"),
            "N2": same("hand_soldered_holes"),
            "planes": same("planes"),
        },
    ),
    "16.2": Adapter(
        "mil_hdbk_217f.surface_mount",
        {
            "d_mil": lambda mils, _: {"package_side": f"{2 * mils} thou"},
            "h_mil": measured("joint_height", "thou"),
            "alphaS_ppm": worth("substrate", surface_mount.SUBSTRATE),
            "alphaCC_ppm": worth("package", surface_mount.PACKAGE),
            "dT_C": measured("temperature_swing", "K"),
            "thetaJC": measured("thermal_resistance", "K/W"),
            "P_W": measured("power", "W"),
            "CR_per_h": worth("application", surface_mount.CYCLING),
            "LC_h": measured("design_life", "h"),
            "lead": same("lead"),
        },
        unsaid={"environment": "GB"},  # whose swing of temperature the case gives itself
    ),
    "19.1": Adapter(
        "mil_hdbk_217f.crystal", {**ENVIRONMENT, **QUALITY, "f_MHz": measured("frequency", "MHz")}, {"lambda_b": "λb"}
    ),
    "20.1": Adapter(
        "mil_hdbk_217f.lamp",
        {
            **ENVIRONMENT,
            "V_rated": measured("rated_voltage", "V"),
            "utilization": same("utilisation"),
            "application": same("supply"),
        },
    ),
    "21.1": Adapter(
        "mil_hdbk_217f.filter",
        {**ENVIRONMENT, **QUALITY},
        unsaid={"style": "ceramic-ferrite"},  # as the case's name says
    ),
    "22.1": Adapter("mil_hdbk_217f.fuse", ENVIRONMENT),
    "ex_flotox_eeprom": Adapter(
        "mil_hdbk_217f.microcircuit.memory",
        {
            **CHIP,
            "type": word("style", {"MOS EEPROM flotox": "MOS-EEPROM-flotox"}),
            "bits": measured("bits", "bit"),
            "cycles": measured("programming_cycles", "cycle"),
            "ecc": same("error_correction"),
        },
        {"C1": "C1", "A1": "A1", "B1": "B1", "lambda_cyc": lambda leaf: leaf["A1"] * leaf["B1"] * leaf["πECC"]},
        unsaid=AT_THE_JUNCTION,
    ),
    "ex_gaas_mmic": Adapter(
        "mil_hdbk_217f.microcircuit.gaas",
        {
            **CHIP,
            "type": lambda kind, _: {"GaAs MMIC": {}}[kind],
            "elements": same("elements"),
            "application": word("application", {"unknown (piA 3)": "unknown"}),
        },
        {"C1": "C1", "C2": "C2", "piT": "πT"},
        unsaid=AT_THE_JUNCTION,
    ),
    "ex_hybrid_linear": Adapter(
        "mil_hdbk_217f.microcircuit.hybrid",
        {
            **QUALITY, **ENVIRONMENT,
            "sum_Nc_lambda_c": measured("component_rate", "FPMH"),
            "function": word("function", {"linear (piF 5.8)": "linear"}),
            "years_in_production": measured("years_in_production", "year"),
        },
    ),
}  # fmt: skip
ADAPTERS["10.2"] = ADAPTERS["10.1"]
ADAPTERS["6.15"] = replace(
    ADAPTERS["6.3"],
    names={**ADAPTERS["6.3"].names, "combine": lambda how, _: {"sum of both sides": {}}[how]},
    sum_of="sides",
)
