"""Every table of ours row by row against a second, independent transcription, and a list of those that have none.

SECOND says where in shared/handbook/tables a table of ours stands again, and what its rows are called there where they
are called otherwise than in case, blanks, hyphens and underscores.
"""

import math
import pkgutil
import re
from importlib import import_module

import numpy as np
from tests.cases import each_case

import robophm.hazard
from robophm.core.table import Table

from .transcription import (
    BOARDS,
    CIRCUITS,
    DIODES,
    LIGHT,
    MECHANICS,
    OTHERS,
    SEALS,
    SPRINGS,
    TRANSISTORS,
    at,
    numbers,
    renamed,
)


def tables():
    """All tables of all hazard models, by name."""
    found = {}
    for module in pkgutil.walk_packages(robophm.hazard.__path__, "robophm.hazard."):
        for table in vars(import_module(module.name)).values():
            if isinstance(table, Table):
                assert found.setdefault(table.name, table) is table, f"two tables are called {table.name}"
    return found


TABLES = tables()


def computed(file, of):
    """Rows that are put together from more than one place of a file, or read from its words."""
    return lambda second: of(second(file))


def of_bands(*lists):
    """Bands are listed as [from,] limit, value; one list a column."""
    return {limits[0][-2]: [row[-1] for row in limits] for limits in zip(*lists, strict=True)}


def microcircuit_packages(t):
    forms = {
        "hermetic": "hermetic_dip_solder_weld_seal_PGA_SMT", "glass": "dip_glass_seal", "can": "can",
        "plastic": "nonhermetic_DIP_PGA_SMT", "flatpack": "flatpack_axial_leads",
    }  # fmt: skip
    cases = {"DIP": "DIP", "PGA": "PGA", "SMT": "chip_carrier", "flatpack": "flatpack", "can": "can"}
    kinds = [f"{case}-{seal}" for case in ("DIP", "PGA", "SMT") for seal in ("hermetic", "plastic")]
    heat = t["thetaJC_default_C_per_W"]
    return {
        kind: [*t["C2"][forms[kind.partition("-")[2] or kind]], *heat[cases[kind.partition("-")[0]]]]
        for kind in (*kinds, "DIP-glass", "flatpack", "can")
    }


def logic_families(t):
    """Ea by family; MOS and BiCMOS have the C1 of MOS."""
    energies = {family: ea for families, ea in t["Ea_eV"].items() for family in families.split("_") if ea < 0.65}
    for other in ("digital", "VHSIC", "memories"):
        del energies[other]
    # of unknown bipolar logic: the family of the first row, as the rulings have it
    return {f: (ea, f in ("CMOS", "MOS", "BiCMOS")) for f, ea in {**energies, "bipolar": energies["TTL"]}.items()}


def slash_sheets(t):
    return {
        f"39010/{sheet}": rise
        for label, rise in t["hot_spot"].items()
        if label.startswith("dT_MIL-C-39010_")
        for sheet in label.removeprefix("dT_MIL-C-39010_").replace("1C-3C", "1C_2C_3C").split("_")
    }


def switch_contacts(t):
    return {form: float(number) for form, number in re.findall(r"(\w+P[SD]T) (\d+)", t["piC"])}


def memory_sizes(t):
    rows = {kind.replace("_", "-"): [value for _, value in limits] for kind, limits in t["C1_memory_bits"].items()}
    both = rows.pop("mos-eeprom")
    return {**rows, "mos-eeprom-flotox": both, "mos-eeprom-textured": both}


def programming_cycles(t):
    """A2 is 0 up to its first limit; 300,000 cycles are a limit of it, and in a band of A1."""
    cycles = t["eeprom_lambda_cyc"]
    a1 = {limit: (value, textured) for (limit, value), (_, textured) in zip(
        cycles["flotox_A1_cycles_upto"], cycles["textured_A1"], strict=True
    )}  # fmt: skip
    (first, _), *_ = cycles["textured_A2"]
    limits = sorted({*a1, first})
    a2 = {limit: next(value for upto, value in cycles["textured_A2"] if limit <= upto) for limit in limits}
    return {0: (0, 0, 0)} | {
        limit: (*next(a1[upto] for upto in sorted(a1) if limit <= upto), a2[limit]) for limit in limits
    }  # fmt: skip


def vhsic(*patterns):
    return lambda t: numbers(t["vhsic_5_3"], *patterns)


def vhsic_packages(t):
    rows = re.findall(r"(DIP|PGA|chip carrier) ([\d.]+)/([\d.]+)", t["vhsic_5_3"])
    both = {kind.replace("chip carrier", "SMT"): factors for kind, *factors in rows}
    seals = ("hermetic", "plastic")
    return {f"{kind}-{seal}": float(two[seals.index(seal)]) for kind, two in both.items() for seal in seals}


def displays(t):
    patterns = {"segment": r"^()([\d.]+)\*C \+ ([\d.]+)", "diode_array": r"^([\d.]+) \+ ([\d.]+)\*C \+ ([\d.]+)"}
    return {
        kind: [float(number or 0) for number in re.match(pattern, t["display"][kind]).groups()]
        for kind, pattern in patterns.items()
    }


def finishes(t):
    """1.07-.0051*TS+2.21e-5*TS^2-3.57e-8*TS^3, or a number."""
    rows = {}
    for finish, said in t["shaft"]["C_f"].items():
        if finish != "TS":
            terms = re.findall(r"([+-]?[\d.]+(?:e-\d+)?)(?:\*TS(?:\^(\d))?)?", str(said))
            powers = {1 if f"{number}*TS" in said and not power else int(power or 0): float(number)
                      for number, power in terms} if isinstance(said, str) else {0: said}  # fmt: skip
            rows[finish] = [powers.get(power, 0) for power in range(4)]
    return rows


def bearing_service(t):
    """What is printed of one kind of bearing is taken for both, by the rulings."""
    printed = {row: list(kinds.values()) for row, kinds in t["C_SF"].items()}
    return {row: factors if len(factors) == 2 else factors * 2 for row, factors in printed.items()}


SECOND = {
    "battery base rate λ0": at(
        "battery", "lambda0", primary="primary_cell", nickel_cadmium="secondary_NiCd", lithium_ion="secondary_LiIon"
    ),
    "default case temperature [°C]": at("environments", "default_case_temperature_C"),
    # capacitors, resistors
    "capacitor style": computed("mil217_capacitors", lambda t: {
        s: (r["lambda_b"], r["piT_col"], r["piC_col"], r["piV_col"], r["piSR"]) for s, r in t["styles"].items()
    }),
    "capacitor quality πQ": at("mil217_capacitors", "piQ"),
    "capacitor environment πE": at("mil217_capacitors", "piE"),
    "resistor style": computed("mil217_resistors", lambda t: {
        s: (r["lambda_b"], r["piT_col"], r["piS_col"]) for s, r in t["styles"].items()
    }),
    "resistor quality πQ": at("mil217_resistors", "piQ"),
    "resistor environment πE": at("mil217_resistors", "piE"),
    # semiconductors
    "diode type": computed(DIODES, lambda t: renamed(
        {kind: (r["lambda_b"], r["B"], r["stress"]) for kind, r in t["low_frequency_6_1"]["types"].items()},
        {"high_voltage_stack": "high_voltage_stack_per_junction"},
    )),
    "diode contact construction πC": at(
        DIODES, "low_frequency_6_1", "piC", bonded="metallurgically_bonded", spring="non_metallurgically_bonded_spring"
    ),
    "semiconductor quality πQ": at(DIODES, "low_frequency_6_1", "piQ"),
    "semiconductor environment πE": at(DIODES, "low_frequency_6_1", "piE"),
    "high-frequency diode type": computed(DIODES, lambda t: renamed(
        {kind: (r["lambda_b"], r["B"]) for kind, r in t["high_frequency_6_2"]["types"].items()},
        {
            "impatt": "impatt_le_35GHz", "gunn": "gunn_bulk_effect", "tunnel": "tunnel_back",
            "schottky": "schottky_barrier_point_contact_0.2-35GHz", "varactor": "varactor_step_recovery",
        },
    )),
    "high-frequency diode application πA": at(DIODES, "high_frequency_6_2", "piA", other="all_other"),
    "high-frequency diode quality πQ": at(DIODES, "high_frequency_6_2", "piQ"),
    "high-frequency Schottky diode quality πQ": at(DIODES, "high_frequency_6_2", "piQ_schottky"),
    "high-frequency semiconductor environment πE": at(DIODES, "high_frequency_6_2", "piE"),
    "high-frequency transistor quality πQ": at(TRANSISTORS, "6.6_rf_low_noise_bipolar", "piQ"),
    "bipolar transistor application πA": at(TRANSISTORS, "6.3_bipolar_lf", "piA"),
    "field-effect transistor type λb": at(TRANSISTORS, "6.4_fet_lf", "lambda_b"),
    "field-effect transistor application πA below 2 W": computed(TRANSISTORS, lambda t: {
        "linear": t["6.4_fet_lf"]["piA"]["linear_P<2W"],
        "switching": t["6.4_fet_lf"]["piA"]["small_signal_switching_P<2W"],
    }),
    "power field-effect transistor πA from a rated power on": computed(TRANSISTORS, lambda t: {
        float(re.search(r"(\d+)<=P<|P>=(\d+)", band).group(1) or band.partition(">=")[2]): factor
        for band, factor in t["6.4_fet_lf"]["piA"].items() if band.startswith("power")
    }),
    "high-power transistor metallization of πT": computed(TRANSISTORS, lambda t: {
        metal: [
            *numbers(t["6.7_rf_power_bipolar"][f"piT_{metal}"]["S<=.4"], r"exp\(-"),
            *numbers(t["6.7_rf_power_bipolar"][f"piT_{metal}"]["S<=.4"], "^"),
            *numbers(t["6.7_rf_power_bipolar"][f"piT_{metal}"][".4<S<=.55"], "^"),
        ]
        for metal in ("gold", "aluminum")
    }),
    "high-frequency transistor matching network πM": at(TRANSISTORS, "6.7_rf_power_bipolar", "piM"),
    "high-frequency silicon field-effect transistor type λb": at(TRANSISTORS, "6.9_rf_si_fet", "lambda_b"),
    "GaAs transistor application πA": at(TRANSISTORS, "6.8_gaas_fet", "piA"),
    "GaAs transistor matching network πM": at(TRANSISTORS, "6.8_gaas_fet", "piM"),
    "GaAs transistor environment πE": at(TRANSISTORS, "6.8_gaas_fet", "piE"),
    "thermal resistance θJC, junction to case": computed(
        # no row of the handbook: of a package that is unknown the largest counts
        TRANSISTORS, lambda t: {**t["thetaJC_C_per_W"], "unknown": max(t["thetaJC_C_per_W"].values())}
    ),
    "optoelectronic device λb": at(LIGHT, "lambda_b", isolator_light_sensitive_resistor_dual="isolator_lsr_dual"),
    "optoelectronic environment πE": at(LIGHT, "piE"),
    "display type λb": computed(LIGHT, lambda t: {kind: row[:2] for kind, row in displays(t).items()}),
    "display logic chip λb": computed(LIGHT, lambda t: {"without": 0, "with": displays(t)["segment"][2]}),
    "laser diode λb": at(LIGHT, "laser_diode_6_13", "lambda_b"),
    "laser diode quality πQ": at(
        LIGHT, "laser_diode_6_13", "piQ",
        nonhermetic_coated="nonhermetic_with_facet_coating", nonhermetic_uncoated="nonhermetic_without",
    ),
    # microcircuits
    "microcircuit activation energy by logic family": computed(CIRCUITS, logic_families),
    "microcircuit C2 = a Np^b, and θJC by die": computed(CIRCUITS, microcircuit_packages),
    "microcircuit πQ": computed(CIRCUITS, lambda t: renamed(
        {**t["piQ"], "custom": [None]}, {"commercial": "commercial_unknown"}
    )),
    "microcircuit πE": at(CIRCUITS, "piE"),
    "digital C1 by gates, up to": computed(CIRCUITS, lambda t: of_bands(*t["C1_digital_gates"].values())),
    "linear C1 by transistors, up to": computed(CIRCUITS, lambda t: of_bands(t["C1_linear_transistors"])),
    "microprocessor C1 by bits, up to": computed(CIRCUITS, lambda t: of_bands(*t["C1_microprocessor_bits"].values())),
    "bipolar PLA C1 by gates, up to": computed(CIRCUITS, lambda t: of_bands(t["C1_pla_gates"]["bipolar"])),
    "MOS PLA C1 by gates, up to": computed(CIRCUITS, lambda t: of_bands(t["C1_pla_gates"]["mos"])),
    "memory C1 by bits, up to": computed(CIRCUITS, memory_sizes),
    "EEPROM A1, A2 by programming cycles over its life, up to": computed(CIRCUITS, programming_cycles),
    "EEPROM πECC": at(
        CIRCUITS, "eeprom_lambda_cyc", "piECC", hamming="on_chip_hamming", redundant="two_needs_one_redundant_cell"
    ),
    "VHSIC λBD": computed(CIRCUITS, lambda t: dict(zip(
        ("logic", "array", "memory"), vhsic("logic/custom", "gate array/memory", "array/memory")(t), strict=True
    ))),
    "VHSIC πMFG": computed(CIRCUITS, lambda t: dict(zip(("QML", "other"), vhsic("QML/QPL", "else")(t), strict=True))),
    "VHSIC πPT": computed(CIRCUITS, vhsic_packages),
    "GaAs MMIC C1 by elements, up to": computed(CIRCUITS, lambda t: of_bands(t["C1_gaas"]["mmic_elements"])),
    "GaAs digital C1 by elements, up to": computed(CIRCUITS, lambda t: of_bands(t["C1_gaas"]["digital_elements"])),
    "GaAs πA and activation energy": computed(CIRCUITS, lambda t: {
        "MMIC-low-power": (t["gaas_piA"]["mmic_le_100mW"], t["Ea_eV"]["GaAs_MMIC"]),
        "MMIC": (t["gaas_piA"]["mmic_gt_100mW_or_unknown"], t["Ea_eV"]["GaAs_MMIC"]),
        "digital": (t["gaas_piA"]["digital"], t["Ea_eV"]["GaAs_digital"]),
    }),
    "hybrid πF": computed(CIRCUITS, lambda t: {
        name: float(number)
        for name, number in re.findall(r"(\w+) ([\d.]*\d)", t["hybrid_5_5"].partition("piF ")[2])
    }),
    # coils, transformers, rotating devices
    "transformer type λb": at("mil217_inductive", "transformer_lambda_b"),
    "transformer quality πQ": at("mil217_inductive", "piQ_transformer"),
    "coil type λb": at("mil217_inductive", "coil_lambda_b"),
    "coil quality πQ": at("mil217_inductive", "piQ_coil"),
    "inductive device environment πE": at("mil217_inductive", "piE"),
    "temperature rise ΔT of MIL-C-39010 coils": computed("mil217_inductive", slash_sheets),
    "radiating area of MIL-T-27 cases": computed("mil217_inductive", lambda t: {
        f"T27/{case}": area for case, area in t["hot_spot"]["case_areas_in2_MIL-T-27"].items()
    }),
    "motor type A and B": computed("mil217_rotating", lambda t: {
        kind: (a, t["motor"]["B"][kind]) for kind, a in t["motor"]["A"].items()
    }),
    "effective cumulative failures λ1, λ2 up to LC/α": computed("mil217_rotating", lambda t: {
        math.inf if isinstance(limit, str) else limit: value
        for limit, value in t["motor"]["lambda_bands_LC_over_alpha_upto"]
    }),
    "synchro and resolver size πS": computed("mil217_rotating", lambda t: {
        kind: [size[kind] for size in t["synchro_resolver"]["piS"].values()] for kind in ("synchro", "resolver")
    }),
    "synchro and resolver environment πE": at("mil217_rotating", "synchro_resolver", "piE"),
    "elapsed-time meter type λb": at("mil217_rotating", "elapsed_time_meter", "lambda_b"),
    "elapsed-time meter environment πE": at("mil217_rotating", "elapsed_time_meter", "piE"),
    # relays, switches
    "contact load, divisor d": computed("mil217_relays", lambda t: {
        load: float(d) for d, load in re.findall(r"([\d.]+) (resistive|inductive|lamp)", t["piL"])
    }),
    "relay πC": at("mil217_relays", "piC"),
    "relay πF by rating, application and construction": at("mil217_relays", "piF"),
    "relay πQ": at("mil217_relays", "piQ"),
    "relay πE": at("mil217_relays", "piE"),
    "solid-state relay πQ": at("mil217_relays", "ss_relay_13_2", "piQ"),
    "solid-state relay πE": at("mil217_relays", "ss_relay_13_2", "piE"),
    "switch λb": at("mil217_switches", "lambda_b"),
    "switch contacts Nc": computed("mil217_switches", switch_contacts),
    "switch πQ": at("mil217_switches", "piQ"),
    "switch πE": at("mil217_switches", "piE"),
    "circuit breaker πU": at("mil217_switches", "breaker", "piU", **{
        "breaker-only": "not_used_as_switch", "also-switch": "also_used_as_switch"
    }),
    "circuit breaker πQ": at("mil217_switches", "breaker", "piQ"),
    "circuit breaker πE": at("mil217_switches", "breaker", "piE"),
    # connectors, boards
    "connector λb": computed("mil217_connectors", lambda t: {
        # the same row, its insert warmer
        **t["lambda_b_mated_pair"], "rf-coaxial-power": t["lambda_b_mated_pair"]["rf_coaxial"]
    }),
    "insert temperature rise by AWG": at("mil217_connectors", "insert_dT", "coef"),
    "connector πK": computed("mil217_connectors", lambda t: {
        math.inf if isinstance(limit, str) else limit: value for limit, value in t["piK_per_1000h"]
    }),
    "connector πQ": at("mil217_connectors", "piQ"),
    "connector πE": at("mil217_connectors", "piE"),
    "socket λb": at("mil217_connectors", "socket_lambda_b", IC="DIP_SIP_chip_carrier_PGA", tube="tube_CRT"),
    "socket πQ": at("mil217_connectors", "socket_piQ"),
    "socket πE": at("mil217_connectors", "socket_piE"),
    "plated through holes λb": at(
        BOARDS, "pth_16_1", "lambda_b",
        printed="printed_wiring_board", discrete="discrete_wiring_electroless_PTH_2_levels",
    ),
    "plated through holes πQ": at(BOARDS, "pth_16_1", "piQ", **{"MIL-SPEC": "MIL-SPEC_or_IPC_level_3"}),
    "plated through holes πE": at(BOARDS, "pth_16_1", "piE"),
    "surface mount πLC, and joint height [mil]": computed(BOARDS, lambda t: {
        lead: (t["smt_16_2"]["piLC"][theirs], *numbers(t["smt_16_2"]["Trise"], height))
        for lead, theirs, height in (
            ("leadless", "leadless", "worked example"), ("J-lead", "J_or_S_lead", "leadless;"),
            ("gull-wing", "gull_wing", "leadless;"),
        )
    }),
    "surface mount αCC [ppm/K]": at(BOARDS, "smt_16_2", "alphaCC_ppm"),
    "surface mount αS [ppm/K]": at(BOARDS, "smt_16_2", "alphaS_ppm"),
    "surface mount CR [cycles/h]": at(BOARDS, "smt_16_2", "CR_cycles_per_h"),
    "surface mount ΔT [K] by environment": at(BOARDS, "smt_16_2", "dT_C"),
    "connection λb": at(BOARDS, "connections_17_1", "lambda_b"),
    "connection πE": at(BOARDS, "connections_17_1", "piE"),
    # crystals, lamps, filters, fuses, meters
    "crystal πQ": at(OTHERS, "crystal", "piQ"),
    "crystal πE": at(OTHERS, "crystal", "piE"),
    "fuse πE": at(OTHERS, "fuse", "piE"),
    "lamp πA": at(OTHERS, "lamp", "piA"),
    "lamp πE": at(OTHERS, "lamp", "piE"),
    "filter λb": at(OTHERS, "filter", "lambda_b", **{
        "ceramic-ferrite": "ceramic_ferrite_MIL-F-15733", "discrete-LC": "discrete_LC_MIL-F-15733",
        "discrete-LC-composition-1": "discrete_LC_MIL-F-18327_comp1",
        "discrete-LC-crystal": "discrete_LC_crystal_MIL-F-18327_comp2",
    }),
    "filter πQ": at(OTHERS, "filter", "piQ"),
    "filter πE": at(OTHERS, "filter", "piE"),
    "panel meter πA": at(OTHERS, "panel_meter", "piA"),
    "panel meter πF": at(OTHERS, "panel_meter", "piF"),
    "panel meter πQ": at(OTHERS, "panel_meter", "piQ", **{"MIL-SPEC": "MIL-M-10304"}),
    "panel meter πE": at(OTHERS, "panel_meter", "piE"),
    "generic rate λg at πQ = 1": computed("mil217_appendixA_published", lambda t: {
        # the rectangular connector is a misprint, as is the toggle switch in CL
        part: [None if (part, e) == ("switch_toggle", "CL") else row.get(e) for e in t["rows"]["fuse"]]
        for part, row in t["rows"].items() if part != "connector_rectangular"
    }),
    # mechanics
    "spring material": computed(SPRINGS, lambda t: {
        m: (r["GM_Mpsi"], r["C_G"], r["EM_Mpsi"], r["C_E_printed"]) for m, r in t["materials"].items()
    }),
    "spring alloy": computed(SPRINGS, lambda t: {a: (r["TS_kpsi"], r["C_Y"]) for a, r in t["tensile"].items()}),
    "AGMA service factor C_GV": at("nswc_gears", "C_GV_AGMA[prime_mover][load]"),
    "bearing service C_SF": computed("nswc_bearings", bearing_service),
    "bearing contamination C_C": at(
        "nswc_bearings", "C_C",
        high_clean="high_clean_le10um_filter", slight_contamination="slight_contamination_gt10um",
        severe_contamination="severe_no_seals",
    ),
    "motor base rate λM,B": computed(MECHANICS, lambda t: {
        # 2 brushes of DC, none of others, by the rulings
        kind: (rate, 2 if kind == "DC" else 0) for kind, rate in t["motor"]["base_fpmh"].items()
    }),
    "motor load C_SF": at(MECHANICS, "motor", "C_SF"),
    "coupling service C_SF": at(MECHANICS, "coupling", "C_SF"),
    "shaft finish C_f": computed(MECHANICS, finishes),
    "shaft material": at(MECHANICS, "shaft", "E_Mpsi"),
    "shaft equipment": at(MECHANICS, "shaft", "allowable_bending_in"),
    "shaft groove C_SC,G": computed(MECHANICS, lambda t: {
        depth: [row.get(sharpness) for sharpness in (0.1, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0)]
        for depth, row in t["shaft"]["C_SCG[h_over_D][h_over_r]"].items()
    }),
    "shear over yield γ": at(MECHANICS, "actuator", "gamma"),
    "yield strength": at(MECHANICS, "actuator", "yield_kpsi_range"),
    "number of particles C_N": at(MECHANICS, "actuator", "C_N"),
    "belt drive base rate λB": computed(SEALS, lambda t: {
        part: t[f"{part}_fpmh"] for part in ("belt", "pulley_flat", "pulley_grooved")
    }),
    "sensing element base rate λB": at(SEALS, "sensing_element_fpmh"),
}  # fmt: skip

ALONE = {
    "generic rate λg of microcircuits at πQ = πL = 1": "the sections' own formulas, in the tests of Appendix A",
    **{
        f"{what}, up to, extended": "ANSI/VITA 51.1 is copyrighted: the file of its rules, tests/data/vita_51_1.json"
        for what in (
            "microprocessor C1 by bits",
            "linear C1 by transistors",
            "bipolar PLA C1 by gates",
            "MOS PLA C1 by gates",
            "memory C1 by bits",
        )
    },
    "circuit breaker πC": "the number of poles, as the second transcription says in words",
}
"""Tables of which there is no second transcription, and what they are checked by instead."""


def test_every_table_has_a_second_transcription_or_is_known_to_have_none():
    assert set(TABLES) == SECOND.keys() | ALONE.keys()
    assert not SECOND.keys() & ALONE.keys()


@each_case("name", SECOND)
def test_row_by_row(name, second):
    theirs = {spelled(key): row for key, row in SECOND[name](second).items() if row is not None}
    ours = {spelled(key): row for key, row in TABLES[name].rows.items()}
    assert ours.keys() == theirs.keys()
    for key, row in ours.items():
        other = theirs[key]
        other = list(other.values()) if isinstance(other, dict) else other
        other = other if isinstance(other, list | tuple) else [other]
        printed = [math.nan if number is None else float(number) for number in other]
        assert np.array_equal(row, printed, equal_nan=True), (key, row, printed)


def spelled(key):
    """A number as a number, a name without what people vary."""
    try:
        return float(key)
    except ValueError:
        return re.sub(r"[\s_-]+", " ", key.casefold())
