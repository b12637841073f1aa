"""The rules by which kinds of parts are rated: the model of each, and inputs where a list does not state them.

What is assumed of a kind is what MIL-HDBK-217F's Appendix A assumes, where that rates parts of which no more is known
than what they are. The part's own section is taken all the same: its temperature can be stated and measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from robophm.core.units import quantity
from robophm.design.importers.bom.assumptions import (
    NO_MORE_HEAT,
    Assumptions,
    Entry,
    Rule,
    TooLittle,
    around,
    assume,
    at_most,
    by_type,
    junction,
    required_in_list,
    rise,
    said_or,
    share,
)
from robophm.design.importers.bom.parts import TYPES, Recognised

APPENDIX = "as in the handbook's Appendix A"
STAND_IN = "a stand-in: only the ratio to what is applied counts"
NEAREST = "the nearest"
CLASS_I = ("C0G", "U2J")
MOST_BITS = 268435456
"""The largest memory [bit] that is rated, to which the rules of ANSI/VITA 51.1 extend the handbook's."""

USUAL_BITS = 1048576
LARGE = 1.0
"""The capacitance [µF] from which on a capacitor of which nothing else is known is taken for an electrolytic one."""


def _capacitor_style(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    """The military style nearest to what a capacitor is made of."""
    through = part.facts.get("mounting") == "through hole"
    kind, why = part.facts.get("type"), part.concluded.get("type", "")
    if kind is None:
        kind, why = "ceramic", f"as is usual below {LARGE:g} uF"
        if quantity(part.facts.get("capacitance", "0 uF"), "uF") >= LARGE:
            kind, why = "electrolytic", f"as is usual from {LARGE:g} uF on"
    ceramic = ("CC" if part.facts.get("dielectric") in CLASS_I else "CK") if through else "CDR"
    styles = {
        "ceramic": ceramic, "electrolytic": "CE", "tantalum": "CSR" if through else "CWR", "film": "CFR", "paper": "CP",
        "mica": "CM", "variable": "CV",
    }  # fmt: skip
    if kind not in styles:
        raise TooLittle(f"the handbook has no {kind} capacitors")
    return styles[kind], ", ".join(filter(None, (f"{NEAREST} to {kind}", why)))


def _series_resistance(part: Recognised, assumed: Assumptions) -> tuple[str, str] | None:
    return ("0.1 ohm/V", "the handbook's worst row") if part.facts.get("type") == "tantalum" else None


def _resistor_style(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    styles = {"metal film": "RN", "carbon film": "RL", "carbon composition": "RC", "wirewound": "RW"}
    kind = part.facts.get("type", "")
    if kind in ("thick film", "thin film") or (part.facts.get("mounting") == "surface" and kind != "wirewound"):
        return "RM", f"{NEAREST} to a chip"
    return (styles[kind], f"{NEAREST} to {kind}") if kind in styles else ("RL", "a film, as is usual")


def _resistor(style: Entry, watts: str, why: str) -> Mapping[str, Entry]:
    return {
        "style": style,
        "power": share("rated_power", "W", watts),
        "rated_power": said_or("rated_power", watts, why),
        "temperature": around,
    }


_JUNCTION: Mapping[str, Entry] = {"temperature": junction, "power": NO_MORE_HEAT}


def _voltages(applied: str) -> Mapping[str, Entry]:
    """Applied and rated voltage; formulas take their ratio alone."""
    return {applied: share("rated_voltage", "V", "1 V"), "rated_voltage": said_or("rated_voltage", "1 V", STAND_IN)}


def _currents(applied: str) -> Mapping[str, Entry]:
    return {applied: share("rated_current", "A", "1 A"), "rated_current": said_or("rated_current", "1 A", STAND_IN)}


def _diode(kind: Entry, *, stressed: bool = False) -> Rule:
    more = _voltages("voltage") if stressed else {}
    contact = {"contact": assume("bonded", APPENDIX)}
    return Rule("mil_hdbk_217f.diode_low_frequency", {"kind": kind, **contact, **_JUNCTION, **more})


def _of_its_kind(kind: str) -> Entry:
    """The kind that the list itself states, as an entry without a remark."""
    return assume(kind, "")


def _optoelectronic(kind: Entry) -> Rule:
    return Rule("mil_hdbk_217f.optoelectronic", {"kind": kind, **_JUNCTION})


def _package(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    package = "DIP-plastic" if part.facts.get("mounting") == "through hole" else "SMT-plastic"
    return package, "a plastic one" if part.facts.get("mounting") else "a plastic one for surface mounting"


def _microcircuit(model: str, pins: str, **entries: Entry) -> Rule:
    common: dict[str, Entry] = {
        "package": _package,
        "pins": at_most("pins", "", 3000, said_or("pins", pins, "a usual number")),
        "power": NO_MORE_HEAT,
        "case_temperature": junction,
        "years_in_production": assume("2 year", "or longer: no new type"),
    }
    return Rule(f"mil_hdbk_217f.microcircuit.{model}", {**entries, **common})


_CMOS = assume("CMOS", "as is usual")
_MOST_GATES = (
    "the most that ANSI/VITA 51.1 has; most FPGAs have more: their maker's figure is part: fpga of the library"
)
_LINEAR = {"transistors": assume("1000", "the third of the handbook's four classes")}


def _programming(part: Recognised, assumed: Assumptions) -> tuple[str, str] | None:
    """How often a memory is written, which counts for EEPROMs and what is nearest to them."""
    kind = part.facts.get("type")
    return None if kind in _WRITTEN_AT_WILL else ("100 cycle" if kind == "flash" else "1000 cycle", "in its life")


_WRITTEN_AT_WILL = {"DRAM": "MOS-DRAM", "SRAM": "MOS-SRAM"}
_MEMORIES = {**_WRITTEN_AT_WILL, "flash": "MOS-EEPROM-flotox"}


def _unless_radio(text: str, why: str) -> Entry:
    """An entry on the warming of contacts, which the handbook knows of RF connectors by itself."""
    return lambda part, assumed: None if part.facts.get("type") == "radio frequency" else (text, why)


def _transformer(kind: Entry) -> Rule:
    return Rule("mil_hdbk_217f.transformer", {"kind": kind, "temperature": around, "temperature_rise": rise})


_COIL = Rule(
    "mil_hdbk_217f.coil",
    {"kind": assume("fixed", "as is usual"), "temperature": around, "temperature_rise": rise},
)


_FET = Rule(
    "mil_hdbk_217f.transistor_fet_low_frequency",
    {
        "kind": by_type({"JFET": "JFET"}, "MOSFET", APPENDIX),
        "application": assume("switching", APPENDIX),
        "rated_power": said_or("rated_power", "0.5 W", "of a small one"),
        **_JUNCTION,
    },
)

_CRYSTAL = Rule(
    "mil_hdbk_217f.crystal",
    {"frequency": at_most("frequency", "MHz", 105.0, said_or("frequency", "10 MHz", "nothing is said"))},
)


def _switch(style: Entry) -> Rule:
    return Rule(
        "mil_hdbk_217f.switch",
        {
            "style": style,
            "contact_form": said_or("contact_form", "SPST", APPENDIX),
            "load": assume("resistive", "as is usual"),
            **_currents("load_current"),
        },
    )


def _encoder_style(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    if "type" not in part.facts:
        raise TooLittle("the list does not say that it has contacts; no handbook has optical or magnetic encoders")
    return "rotary", NEAREST


RULES: Mapping[str, Rule] = {
    "capacitor": Rule(
        "mil_hdbk_217f.capacitor",
        {
            "style": _capacitor_style,
            "capacitance": required_in_list("capacitance", "its capacitance"),
            **_voltages("dc_voltage"),
            "series_resistance": _series_resistance,
            "temperature": around,
        },
    ),
    "resistor": Rule("mil_hdbk_217f.resistor", _resistor(_resistor_style, "1 W", APPENDIX)),
    "resistor network": Rule(
        "mil_hdbk_217f.resistor", _resistor(assume("RZ", f"{NEAREST} to a network"), "1 W", "as of a resistor")
    ),
    "thermistor": Rule(
        "mil_hdbk_217f.resistor", _resistor(assume("RTH", f"{NEAREST} to a thermistor"), "1 W", APPENDIX)
    ),
    "resettable fuse": Rule(
        "mil_hdbk_217f.resistor",
        _resistor(assume("RTH", f"{NEAREST} to a resettable fuse"), "1 W", APPENDIX),
        taken_for="a thermistor, for the handbook has no resettable fuses",
    ),
    "potentiometer": Rule(
        "mil_hdbk_217f.resistor",
        _resistor(by_type({"wirewound": "RT"}, "RJ", "not wirewound, as is usual"), "1 W", "as of a resistor"),
    ),
    "diode": _diode(
        by_type({"switching": "switching"}, "general_purpose_analog", "nothing else is said"), stressed=True
    ),
    "schottky diode": _diode(_of_its_kind("power_rectifier_schottky"), stressed=True),
    "rectifier": _diode(assume("power_rectifier_schottky", APPENDIX), stressed=True),
    "zener diode": _diode(_of_its_kind("voltage_regulator_zener")),
    "tvs diode": _diode(_of_its_kind("transient_suppressor_varistor")),
    "varistor": _diode(_of_its_kind("transient_suppressor_varistor")),
    "led": _optoelectronic(_of_its_kind("led")),
    "photodetector": _optoelectronic(
        by_type({"phototransistor": "phototransistor", "photodiode": "photodiode"}, "phototransistor", "the worse")
    ),
    "optocoupler": _optoelectronic(
        by_type(
            {"photodarlington": "isolator_photodarlington_single", "photodiode": "isolator_photodiode_single"},
            "isolator_phototransistor_single",
            "a single one, as is usual",
        )
    ),
    "laser diode": Rule(
        "mil_hdbk_217f.laser_diode",
        {
            "kind": assume("GaAs_AlGaAs", "as is usual"),
            **_JUNCTION,
            "current": assume("0.5 A", APPENDIX),
            "application": assume("cw", "the worse"),
            "required_optical_power": share("optical_power", "W", "1 W"),
            "rated_optical_power": assume("1 W", STAND_IN),
            "quality": assume("nonhermetic_uncoated", "the worst"),
        },
    ),
    "display": Rule(
        "mil_hdbk_217f.display",
        {
            "kind": assume("segment", "as is usual"),
            "characters": said_or("characters", "1", "nothing else is said"),
            "logic_chip": assume("without", "as is usual"),
            **_JUNCTION,
        },
    ),
    "thyristor": Rule(
        "mil_hdbk_217f.thyristor",
        {**_JUNCTION, "rated_current": said_or("rated_current", "1 A", APPENDIX), **_voltages("voltage")},
    ),
    "bipolar transistor": Rule(
        "mil_hdbk_217f.transistor_bipolar_low_frequency",
        {
            "application": assume("switching", APPENDIX),
            **_JUNCTION,
            "rated_power": said_or("rated_power", "0.5 W", APPENDIX),
            **_voltages("voltage"),
        },
    ),
    "fet": _FET,
    "transistor": replace(_FET, taken_for="a field-effect transistor"),
    "microcontroller": _microcircuit(
        "processor", "64", family=_CMOS, bits=said_or("bits", "32 bit", "the widest that the handbook has")
    ),
    "programmable logic": _microcircuit(
        "programmable",
        "144",
        family=_CMOS,
        gates=assume("60000", _MOST_GATES),
    ),
    "memory": _microcircuit(
        "memory",
        "8",
        style=by_type(
            {**_WRITTEN_AT_WILL, "flash": "MOS-EEPROM-flotox"},
            "MOS-EEPROM-flotox",
            f"{NEAREST} to what keeps what it is told",
        ),
        bits=at_most("bits", "bit", MOST_BITS, said_or("bits", f"{USUAL_BITS} bit", "the most of the handbook itself")),
        programming_cycles=_programming,
    ),
    "logic": _microcircuit("logic", "16", family=_CMOS, gates=assume("100", "the first of the handbook's classes")),
    "analog circuit": _microcircuit("linear", "8", **_LINEAR),
    "microcircuit": replace(_microcircuit("linear", "16", **_LINEAR), taken_for="an analog circuit"),
    "inductor": _COIL,
    "ferrite bead": _COIL,
    "transformer": _transformer(
        by_type(
            {"flyback": "flyback", "pulse": "low_power_pulse", "audio": "audio", "radio frequency": "rf"},
            "high_power_pulse_power_filter",
            "a power transformer",
        )
    ),
    "filter": Rule(
        "mil_hdbk_217f.filter",
        {"style": by_type({"LC": "discrete-LC", "crystal": "discrete-LC-crystal"}, "ceramic-ferrite", "as is usual")},
    ),
    "crystal": _CRYSTAL,
    "oscillator": replace(_CRYSTAL, taken_for="its crystal alone, without its circuit"),
    "fuse": Rule("mil_hdbk_217f.fuse", {}),
    "circuit breaker": Rule(
        "mil_hdbk_217f.circuit_breaker",
        {"poles": said_or("contact_form", "DPST", APPENDIX), "use": assume("breaker-only", APPENDIX)},
    ),
    "relay": Rule(
        "mil_hdbk_217f.relay",
        {
            "construction": by_type(
                {
                    "reed": "signal-dry-reed",
                    "latching": "latching-balanced-armature",
                    "contactor": "contactor-armature-short",
                },
                "general-balanced-armature",
                APPENDIX,
            ),
            "rated_temperature": assume("85 degC", APPENDIX),
            "temperature": around,
            "load": assume("resistive", APPENDIX),
            **_currents("load_current"),
            "contact_form": said_or("contact_form", "SPST", APPENDIX),
            "cycling": assume("10 cycle/h", APPENDIX),
        },
    ),
    "solid state relay": Rule("mil_hdbk_217f.relay_solid_state", {}),
    "switch": _switch(
        by_type({style: style for style in TYPES["switch"]}, "pushbutton", "nothing else is said"),
    ),
    "encoder": replace(_switch(_encoder_style), taken_for="a rotary switch"),
    "connector": Rule(
        "mil_hdbk_217f.connector",
        {
            "style": by_type(
                {
                    "radio frequency": "rf-coaxial",
                    "telephone": "telephone",
                    "card edge": "card-edge",
                    "rack and panel": "rack-panel",
                    "circular": "circular",
                    "power": "power",
                },
                "rectangular",
                "as is usual on boards",
            ),
            "temperature": around,
            "current": _unless_radio("0 A", f"contacts no warmer than what is around, {APPENDIX}"),
            "wire_gauge": _unless_radio("22", "without effect where no current flows"),
            "matings": assume("0.05 /10^3 h", APPENDIX),
            "half": assume("mated pair", "'one half' where its mate is in the design too"),
        },
    ),
    "socket": Rule(
        "mil_hdbk_217f.connector_socket",
        {"style": assume("IC", "as is usual"), "contacts": at_most("pins", "", 180, said_or("pins", "40", APPENDIX))},
    ),
    "battery": Rule(
        "general.battery",
        {
            "chemistry": by_type(
                {"primary": "primary", "nickel": "nickel_cadmium", "lithium ion": "lithium_ion"},
                "lithium_ion",
                "the worst of its table",
            )
        },
    ),
    "lamp": Rule(
        "mil_hdbk_217f.lamp",
        {
            "rated_voltage": said_or("rated_voltage", "28 V", "nothing is said"),
            "utilisation": assume("1", "always lit"),
            "supply": assume("dc", "as is usual on a robot"),
        },
    ),
    "motor": Rule(
        "mil_hdbk_217f.motor",
        {
            "kind": by_type({"stepper": "stepper", "servo": "servo"}, "electrical_general", "nothing else is said"),
            "temperature": around,
            "design_life": assume("10000 h", "its life or until it is replaced; state yours"),
        },
    ),
    "printed board": Rule(
        "mil_hdbk_217f.printed_board",
        {
            "automated_holes": required_in_list("holes", "how many plated holes it has"),
            "hand_soldered_holes": assume("0", "all soldered by machine"),
            "technology": assume("printed", "as is usual"),
            "planes": said_or("layers", "2", "nothing is said"),
        },
    ),
}
"""The rule of each kind; a kind that is not here has no model in any handbook that is shipped."""
