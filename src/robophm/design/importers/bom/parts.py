"""The facts that a row of a parts list gives about its part, read from its value, footprint and words.

Nothing here knows hazard models. What a row does not say is not in ``facts``; what follows from something that merely
suggests it has its reason in ``concluded``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from robophm.design.importers.bom.columns import Decimal
from robophm.design.importers.bom.kinds import MICROCIRCUITS, Spoken, any_of, kind_of, spread
from robophm.design.importers.bom.part_numbers import part_number
from robophm.design.importers.bom.power_by_size import CHIP_POWER, PACKAGE_POWER
from robophm.design.importers.bom.quantities import (
    CURRENT,
    END,
    NUMBER,
    POWER,
    VOLTAGE,
    first,
    measured,
    plain,
    plain_value,
    value_of,
    with_unit,
)
from robophm.design.importers.bom.references import prefix
from robophm.design.importers.bom.wide_band_gap import semiconductor


@dataclass(frozen=True)
class Described:
    """The cells of a row that describe its part."""

    value: str = ""
    footprint: str = ""
    description: str = ""
    library: str = ""
    part_number: str = ""
    voltage: str = ""
    tolerance: str = ""
    power: str = ""
    material: str = ""
    note: str = ""


@dataclass(frozen=True)
class Recognised:
    """A kind of part and what is known of it: quantities as texts with a unit ('100 nF'), and words."""

    kind: str
    """One of KINDS, or '' where nothing tells, or letters have several meanings and no words decide."""
    facts: Mapping[str, str] = field(default_factory=dict)
    concluded: Mapping[str, str] = field(default_factory=dict)
    """Facts, and 'kind', that something only suggests: by what."""
    contradictions: tuple[str, ...] = ()
    """Sentences on cells of the row that contradict each other, each with which of them was believed."""


def recognise(references: tuple[str, ...], row: Described, decimal: Decimal = ".") -> Recognised:
    """The kind of a part and what is known of it."""
    if not row.value and row.description:  # a list whose comment is the value
        row = replace(row, value=row.description)
    said = _Said(row, decimal)
    letters = prefix(references[0]) if references else ""
    kind, why, against = kind_of(letters, said.spoken(row))
    if why:
        said.concluded["kind"] = why
    facts = said.facts(kind)
    return Recognised(kind, facts, said.concluded, tuple(filter(None, (against, *said.contradictions))))


_SIZE = re.compile(rf"{NUMBER}[ -]?([kKMG]?)i?[ -]?((?i:bits?|bytes?)|[bB]){END}")
_SERIAL_MEMORY = re.compile(r"2[45](?:LC|AA|FC|C)0*([1-9][0-9]{0,3})(?![0-9])", re.IGNORECASE)
_WORD = re.compile(r"(?<![0-9])(4|8|16|32)[ -]?bit", re.IGNORECASE)
_LAYERS = re.compile(r"(?<![0-9])([0-9]{1,2})[ -]?(?:layers?|lagig|lagen|couches)", re.IGNORECASE)
_HOLES = re.compile(r"(?<![0-9])([0-9]{1,6}) ?(?:(?:plated )?(?:through )?holes|vias|bohrungen|trous)", re.IGNORECASE)
_CHARACTERS = re.compile(r"(?<![0-9.])([1-9])[ -]?(?:digits?|characters?|stellig)", re.IGNORECASE)
_CONTACTS = re.compile(
    r"(?<![A-Z0-9])([SD346]P[SD]T)(?![A-Z0-9])|([1-4]) ?(?:x ?)?(form ?[ac]|wechsler|schließer)", re.IGNORECASE
)
_TOLERANCE = re.compile(r"(?<![\w.])([0-9]{1,2}(?:\.[0-9]{1,3})?)\s?%")
_CHIP = re.compile(r"(?<![0-9])(01005|0201|0402|0603|0805|1206|1210|1218|1806|1808|1812|2010|2220|2225|2512)(?![0-9])")
_NUMBERS_OF_CHIPS = ("201", "402", "603", "805")
"""Numbers that spreadsheets make of chip sizes."""

_METRIC = re.compile(r"_[0-9]{4,5}Metric")
_DIELECTRIC = any_of("C0G|COG|NP0|NPO|X5R|X7R|X7S|X7T|X6S|X8R|X5S|X8L|Y5V|Z5U|U2J")
_ROWS_OF_PINS = re.compile(r"(?<![0-9.])0?([1-9])x0?([0-9]{1,3})(?![0-9.]|mm)")  # 1x06, but not 3.9x4.9mm
_PACKAGE_PINS = re.compile(
    r"(?<![A-Za-z])(?:[A-Z]{0,3}SOP|[A-Z]?SOIC|SO|[A-Z]?SOT-?23|SC-?70|P?DIP|[A-Z]{0,2}QFN|[A-Z]?DFN|[A-Z]?SON|[A-Z]?QFP|"
    r"[A-Z]{0,2}BGA|LGA|WLCSP|PLCC|TO-?220|TO-?263)-?([0-9]{1,4})(?![0-9.])",
)
_SURFACE = re.compile(
    r"sm[dt]|(?<![A-Za-z])(?:[A-Z]{0,3}SOP|[A-Z]?SOIC|SO|[A-Z]?SOT|SC|[A-Z]{0,2}QFN|[A-Z]?DFN|[A-Z]?SON|[A-Z]?QFP|"
    r"[A-Z]{0,2}BGA|LGA|WLCSP|PLCC)-?[0-9]",
    re.IGNORECASE,
)
_POSITIONS = re.compile(rf"{NUMBER}[ -]?(?:pins?|pos(?:itions?)?|ways?|pol(?:ig)?|contacts?|p){END}", re.IGNORECASE)
_PINS = re.compile(rf"{NUMBER}[ -]?(?:pins?|leads?){END}", re.IGNORECASE)
_LAND_PATTERN = re.compile(
    r"(?<![A-Z])[A-Z]{2,5}[0-9]{1,3}P[0-9]{2,4}X[0-9]{2,4}(?:X[0-9]{2,4})?-([0-9]{1,4})(?![0-9])"
)
"""Land patterns as IPC-7351 names them: SOP50P810X120-48N."""

_THROUGH_HOLE = re.compile(
    r"tht|through.?hole|radial|axial|C_Disc|C_Rect|bedrahtet|leaded|traversant|(?<![A-Za-z])[CP]?DIP(?![A-Za-z])|"
    r"TO-?(?:92|126|220|247)(?![0-9])",
    re.IGNORECASE,
)

TYPES: Mapping[str, Mapping[str, re.Pattern[str]]] = {
    kind: {name: any_of(words) for name, words in types.items()}
    for kind, types in {
        "capacitor": {
            "polymer": r"polymer\w*|os-?con|poscap|hybrid",
            "niobium": r"niob\w*",
            "tantalum": r"tantal\w*|tant",
            "electrolytic": r"electrolytic|elec|alu\w*|elko|elektrolyt\w*|électrolytique|electrolytique|"
            r"CP (Radial|Elec|Axial)",
            "film": r"film|folie\w*|mk[tps][0-9]?|fkp[0-9]?|polyester|polypropyl[eè]ne|pet|pps",
            "paper": r"paper|papier",
            "mica": r"mica|glimmer",
            "variable": r"trimmer|trim ?cap|variable",
            "ceramic": r"ceramic|cer|mlcc|keramik\w*|kerko|c[ée]ramique|C Disc",
        },
        "resistor": {
            "wirewound": r"wire.?wound|draht\w*|bobin[ée]e?",
            "metal film": r"metal[- ]?(?:film|oxide)|metall(?:film|schicht)\w*|couche métal\w*",
            "carbon film": r"carbon[- ]?film|kohleschicht\w*|couche carbone",
            "carbon composition": r"carbon comp\w*",
            "thin film": r"thin[- ]?film|dünnschicht\w*",
            "thick film": r"thick[- ]?film|dickschicht\w*",
        },
        "potentiometer": {"wirewound": r"wire.?wound|draht\w*", "trimmer": r"trim\w*"},
        "diode": {"switching": r"switching|small[ -]?signal|schaltdiode|1n4148\w*|1n914|bav\w+|bas[0-9]+\w*|ll4148"},
        "fet": {
            "JFET": r"jfets?",
        },
        "photodetector": {"phototransistor": r"[pf]h?oto-?transistor(en|s)?", "photodiode": r"[pf]h?oto-?diod(en?|es)"},
        "optocoupler": {"photodarlington": r"(photo)?darlington", "photodiode": r"6n13[0-9]|photodiode"},
        "relay": {"reed": r"reed", "latching": r"latching|bistabil?e?", "contactor": r"contactors?|schütz"},
        "switch": {
            "DIP": r"dip|dil|codierschalter",
            "limit": r"limit|end(schalter|stops?)",
            "reed": r"reed",
            "rocker": r"rocker|wipp\w*",
            "rotary": r"rotary|dreh\w*",
            "sensitive": r"micro ?-?switch|mikroschalter|sensitive",
            "toggle": r"toggle|kipp\w*|slide|spdt slide|schiebe\w*",
            "pushbutton": r"push\w*|tact\w*|buttons?|taster",
        },
        "connector": {
            "radio frequency": r"sma|smb|bnc|mcx|mmcx|u\.?fl|ipex|coax\w*|koax\w*",
            "telephone": r"rj-?[0-9]{2}\w*|8p8c|ethernet ?jack|mod(ular)? ?jack",
            "card edge": r"card ?edge|edge|m\.2|pcie?|so-?dimm|slot",
            "rack and panel": r"d-?sub\w*|d[abe]-?[0-9]{1,2}|din ?41612",
            "circular": r"m5|m8|m12|circular|rund\w*|din ?[0-9]pol",
            "power": r"barrel\w*|dc ?jack|xt[369]0\w*|anderson|iec ?60320|kaltgeräte\w*",
        },
        "transformer": {
            "flyback": r"fly-?back|sperrwandler\w*",
            "pulse": r"pulse|ethernet|lan|magnetics|gate|impuls\w*",
            "audio": r"audio|nf-?übertrager",
            "radio frequency": r"rf|balun|hf-?übertrager",
        },
        "filter": {"crystal": r"saw|crystal|quarz", "LC": r"lc"},
        "battery": {
            "nickel": r"ni-?(cd|mh)",
            "primary": r"primary|alkali\w*|(cr|br|lr)[0-9]+\w*|coin|button ?cell|knopfzelle",
            "lithium ion": r"li-?(ion|po|polymer)|lithium\w*|lipo|lifepo4|18650|21700",
        },
        "encoder": {"with contacts": r"mechanical|mechanisch\w*|ec1[12]\w*|(with )?switch|contacts?|kontakte?"},
        "memory": {
            "flash": r"(nor |nand )?flash|(w25[qn]|mx25|gd25|is25)[0-9a-z]*",
            "DRAM": r"s?drams?|ddr[0-9]?|mt4[178]\w*|k4[abt]\w*",
            "SRAM": r"srams?|psrams?|is6[12]\w*|as6c\w*",
        },
        "motor": {"stepper": r"stepp\w*|schritt\w*|nema ?[0-9]+", "servo": r"servo\w*"},
    }.items()
}  # fmt: skip
"""Types of a kind that change how it fails, and the words that name them."""

_TRANSISTORS = ("transistor", "fet", "bipolar transistor")
_WITH_VOLTAGE = (
    "capacitor", "supercapacitor", "fuse", "varistor", "tvs diode", "zener diode", "schottky diode", "rectifier",
    "diode", "thyristor", "bipolar transistor", "lamp",
)  # fmt: skip
_RECTIFYING = ("diode", "rectifier", "schottky diode")
_FORWARD = 1.5
"""Volts below which a diode's value is what drops across it, and not what it blocks."""

_WITH_CURRENT = ("fuse", "inductor", "relay", "switch", "thyristor")


class _Said:
    """The cells of a row, with letters such as in 4k7 made decimal points."""

    def __init__(self, row: Described, decimal: Decimal) -> None:
        self.value = plain_value(row.value, decimal)
        self.rest = plain(" ".join((row.description, row.library, row.note, row.part_number)), decimal)
        self.described = plain(f"{row.description} {row.library}", decimal)
        self.column = {name: plain(getattr(row, name), decimal) for name in ("voltage", "tolerance", "power")}
        self.number = part_number(row.part_number, row.library, row.value, row.footprint, row.description, row.note)
        self.contradictions: list[str] = []
        self.footprint, self.part_number = row.footprint, row.part_number
        self.words = " ".join((row.description, row.library, row.footprint, row.value, row.material, row.note))
        self.concluded: dict[str, str] = {}

    def spoken(self, row: Described) -> Spoken:
        may, does = measured(self.value)
        return Spoken(
            (row.description, row.library, row.material), row.value, row.part_number, row.note, row.footprint,
            may, does,
            self.number.kind if self.number else "",
        )  # fmt: skip

    def value_of(self, kind: str, fact: str) -> str | None:
        """The capacitance, resistance, inductance or frequency; by what, and what speaks against it, is kept."""
        number = self.number.facts.get(fact) if self.number else None
        text, why, contradiction = value_of(kind, self.value, self.described, number)
        if why:
            self.concluded[fact] = why
        if contradiction:
            self.contradictions.append(contradiction)
        return text

    def facts(self, kind: str) -> dict[str, str]:
        """Return the facts that matter for this kind of part, as far as the row states them."""
        if not kind:
            return {}
        found: dict[str, str | None] = {"type": self.type(kind), "size": self.chip()}
        found["semiconductor"] = semiconductor(kind, spread(f"{self.words} {self.part_number}"))
        found["mounting"] = self.mounting(self.footprint) or self.mounting(self.words)
        if kind in ("capacitor", "supercapacitor"):
            found |= self.capacitor(found["type"])
        elif kind in ("resistor", "resistor network", "potentiometer", "thermistor", "resettable fuse"):
            found |= self.resistor()
        elif kind in _TRANSISTORS:
            found["rated_power"] = self.transistor_power()
        elif kind in ("inductor", "ferrite bead"):
            found["inductance"] = self.value_of("inductor", "inductance")
        elif kind in ("crystal", "oscillator"):
            found["frequency"] = self.value_of("crystal", "frequency")
        elif kind in ("connector", "socket", "optocoupler", *MICROCIRCUITS):
            found["pins"] = self.pins(circuit=kind in MICROCIRCUITS)
        if kind == "memory":
            found["bits"] = self.memory_size()
        elif kind == "microcontroller":
            word = _WORD.search(f"{self.value} {self.rest}")
            found["bits"] = f"{word[1]} bit" if word else None
        elif kind == "display":
            characters = _CHARACTERS.search(f"{self.value} {self.rest}")
            found["characters"] = characters[1] if characters else None
        elif kind == "printed board":
            for name, pattern in (("layers", _LAYERS), ("holes", _HOLES)):
                count = pattern.search(f"{self.value} {self.rest}")
                found[name] = count[1] if count else None
        elif kind in ("relay", "switch", "circuit breaker"):
            found["contact_form"] = self.contact_form()
        if kind in _WITH_VOLTAGE:
            found["rated_voltage"] = self._rated_voltage(kind)
        if kind in _WITH_CURRENT:
            found["rated_current"] = first(CURRENT, "A", self.value, self.rest)
        known = {name: text for name, text in found.items() if text}
        of_number = self.number.facts if self.number and self.number.kind == kind else {}
        for name in ("type", "rated_power"):  # what a size suggests, the maker's number knows
            if name in of_number and self.concluded.pop(name, ""):
                del known[name]
        return {**of_number, **known}

    def mounting(self, text: str) -> str | None:
        if _THROUGH_HOLE.search(text):
            return "through hole"
        return "surface" if self.chip() or _SURFACE.search(text) else None

    def type(self, kind: str) -> str | None:
        words = spread(self.words)
        return next((name for name, pattern in TYPES.get(kind, {}).items() if pattern.search(words)), None)

    def capacitor(self, kind: str | None) -> dict[str, str | None]:
        dielectric = _DIELECTRIC.search(self.words)
        if not kind and (dielectric or self.chip()):
            kind = "ceramic"
            self.concluded["type"] = f"by its {'dielectric' if dielectric else f'size {self.chip()}'}"
        said = dielectric[0].upper() if dielectric else None
        return {
            "capacitance": self.value_of("capacitor", "capacitance"),
            "dielectric": "C0G" if said in ("COG", "NP0", "NPO") else said,
            "type": kind,
        }

    def resistor(self) -> dict[str, str | None]:
        power = first(POWER, "W", with_unit(self.column["power"], "W"), self.value, self.rest)
        size = self.chip()
        if not power and size in CHIP_POWER and size:
            power = CHIP_POWER[size]
            self.concluded["rated_power"] = f"by its size {size}"
        tolerance = _TOLERANCE.search(" ".join((with_unit(self.column["tolerance"], "%"), self.value, self.rest)))
        return {
            "resistance": self.value_of("resistor", "resistance"),
            "rated_power": power,
            "tolerance": f"{tolerance[1]} %" if tolerance else None,
        }

    def _rated_voltage(self, kind: str) -> str | None:
        """What a column of voltages or the value says, else the maker's number, else other words."""
        said = first(VOLTAGE, "V", with_unit(self.column["voltage"], "V"), self.value)
        if said and kind in _RECTIFYING and float(said.split()[0]) < _FORWARD:
            said = None
        number = self.number.facts.get("rated_voltage") if self.number and self.number.kind == kind else None
        return said or number or first(VOLTAGE, "V", self.rest)

    def transistor_power(self) -> str | None:
        power = first(POWER, "W", with_unit(self.column["power"], "W"), self.value, self.rest)
        for usual, packages in () if power else PACKAGE_POWER.items():
            if package := packages.search(spread(self.words)):
                self.concluded["rated_power"] = f"by its package {package[0]}"
                return usual
        return power

    def memory_size(self) -> str | None:
        text = f"{self.value} {self.rest}"
        if serial := _SERIAL_MEMORY.search(text):
            return f"{int(serial[1]) * 1024} bit"
        match = _SIZE.search(text)
        if not match:
            return None
        byte = match[3] == "B" or match[3].lower().startswith("byte")
        scale = 1024 ** " kMG".index(match[2].replace("K", "k") or " ")
        return f"{round(float(match[1]) * scale) * (8 if byte else 1)} bit"

    def contact_form(self) -> str | None:
        match = _CONTACTS.search(self.words)
        if not match:
            return None
        if match[1]:
            return match[1].upper()
        throws = "ST" if match[3].lower() in ("forma", "form a", "schließer") else "DT"
        return {"1": "SP", "2": "DP"}.get(match[2], f"{match[2]}P") + throws

    def chip(self) -> str | None:
        if self.footprint in _NUMBERS_OF_CHIPS:
            return f"0{self.footprint}"
        for text in (self.footprint, self.words):
            if match := _CHIP.search(_METRIC.sub("", text)):
                return match[1]
        return None

    def pins(self, *, circuit: bool) -> str | None:
        texts = (self.footprint, self.value, self.rest)
        for text in texts:
            if land := _LAND_PATTERN.search(text):
                return land[1]
            if package := _PACKAGE_PINS.search(text):
                return str(int(package[1]))
            if rows := _ROWS_OF_PINS.search(text):
                return str(int(rows[1]) * int(rows[2]))
        pattern = _PINS if circuit else _POSITIONS  # an LM358P has not 358
        positions = next((found for text in texts if (found := pattern.search(text))), None)
        return positions[1] if positions else None
