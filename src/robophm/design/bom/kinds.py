"""What kind of part a row is: by the letters of its reference, and by its words where these mean several things."""

from __future__ import annotations

import re
from collections.abc import Mapping

KINDS: Mapping[str, str] = {
    # From the special to the general: the first whose words are in a row is what it is. English, German, French; and
    # of semiconductors the beginnings of usual part numbers, for many lists say nothing else of them.
    "no part": r"test ?points?|testpads?|mounting ?holes?|fiducials?|logo|solder ?jumper|tooling ?hole|messpunkt",
    "thermistor": r"thermistors?|ntc|ptc|heißleiter|kaltleiter",
    "varistor": r"varistors?|mov",
    "optocoupler": r"opto-?couplers?|opto-?isolators?|photo-?couplers?|optokoppler|pc817\w*|4n[23][0-9]|6n13[0-9]",
    "solid state relay": r"solid[ -]?state[ -]?relays?|ssr|photomos",
    "oscillator": r"oscillators?|tcxo|ocxo|vcxo|oszillator(en)?|oscillateur",
    "resistor network": r"resistor ?(network|array|pack)s?|widerstandsnetzwerk",
    "microcontroller": r"microcontrollers?|mikrocontroller|microprocessors?|processors?|mcus?|cpus?|soc|"
    r"(stm(32|8)|at(mega|tiny|xmega|sam)|samd[0-9]|dspic|pic(1[0268]|24|32)|esp(32|8266)|rp2[0-9]|nrf5[0-9]|msp430|"
    r"lpc[0-9]{3}|mimxrt|gd32|ch32|efm32|xmc[0-9])\w*",
    "programmable logic": r"fpgas?|cplds?|(xc[2-9]|ep[1-5][cm]|10m0|lcmxo|lfe[0-9]|ice40)\w*",
    "analog circuit": r"op-?amps?|operational ?amplifiers?|amplifiers?|comparators?|regulators?|\w*regler|ldo|"
    r"converters?|dc-?dc|(gate |motor |stepper |led |line )?drivers?|treiber|transceivers?|voltage references?|adc|dac|"
    r"timers?|(lm|tl0|opa|ina|ne55|ams1117|tps|ltc|drv8|tmc[2-9]|mcp[136]|ad[58]|max[0-9]|mp[12]|uln|l78|l298|7[89][0l-m])"
    r"[0-9]\w*",
    "memory": r"memory|speicher|eeproms?|eprom|flash|[sdf]?rams?|(ddr[0-9]?)|(24(lc|aa|fc|c)[0-9]|at2[45]c|"
    r"25(lc|aa)[0-9]|m24[cm]|w25[qn]|mx25|gd25|is25|is6[12]|as6c|cy6|mt4[178]|k4[abt])\w*",
    "logic": r"logic|gates?|flip-?flops?|buffers?|inverters?|(shift ?)?registers?|decoders?|latch(es)?|multiplexers?|"
    r"level ?(shifters?|translators?)|((sn)?[57]4[a-z]{0,5}|cd4|hef4)[0-9]{2}\w*",
    "microcircuit": r"ics?|integrated ?circuits?|controllers?|schaltkreis(e)?",
    "photodetector": r"photo-?(diodes?|transistors?)|foto(dioden?|transistor(en)?)",
    "laser diode": r"laser ?diodes?",
    "liquid crystal or OLED display": r"lcds?|oleds?|tft",
    "display": r"7-?segment|seven ?segment|displays?|anzeigen?",
    "led": r"leds?|leuchtdioden?|light[ -]?emitting( diodes?)?|neopixel|ws2812\w*",
    "thyristor": r"thyristors?|scrs?|triacs?|diacs?|bt(a|b|1)[0-9]\w*|tic[0-9]{3}\w*",
    "fet": r"mosfets?|jfets?|fets?|[np]-?mos|[np]-?(channel|ch|kanal)|"
    r"(2n70|bss[18]|irf|irl|ao[0-9]{3}|si[0-9]{3}|dm[np][0-9]|csd[0-9]|fds[0-9]|ntr[0-9])\w*",
    "bipolar transistor": r"bjts?|npn|pnp|bipolar|darlington|"
    r"(bc[3-8][0-9]{2}|2n[2-6][0-9]{3}|[mp]mbt|bd[0-9]{3}|bcp5|tip[0-9]|mje[0-9]|s8[05]50)\w*",
    "transistor": r"transistors?|transistoren|igbts?",
    "tvs diode": r"tvs|transient ?(voltage)? ?suppress\w*|esd (protection|diode)|suppressordioden?|(smaj|smbj|p6ke)\w*",
    "zener diode": r"zener\w*|z-?dioden?|(bzx|bzt|mmsz)\w*",
    "schottky diode": r"schottky\w*|(bat[0-9]|1n58[12]|ss[1-5][2-6]|b[0-9]{3}a|mbr)\w*",
    "rectifier": r"rectifiers?|gleichrichter|redresseur|(1n400|1n540|db10|gbu)\w*",
    "diode": r"diodes?|dioden",
    "crystal": r"crystals?|xtals?|quartz|quarze?|resonators?",
    "ferrite bead": r"ferrite ?(beads?)?|ferritperlen?",
    "transformer": r"transformers?|transformator(en)?|trafo|transformateur|\w*übertrager",
    "filter": r"filters?",
    "inductor": r"inductors?|inductances?|coils?|chokes?|drosseln?|spulen?|induktivität(en)?|bobine",
    "potentiometer": r"potentiometers?|trim ?pots?|trimmer ?pots?|poti|potentiomètre",
    "resistor": r"resistors?|res|widerst[aä]nde?|widerstand|r[ée]sistances?|resistenza|resistencia|shunts?",
    "supercapacitor": r"super-?cap\w*|edlc|ultra-?cap\w*",
    "capacitor": r"capacitors?|caps?|mlcc|\w*kondensator(en)?|elko|kerko|condensateurs?|condensatore?|condensador",
    "circuit breaker": r"circuit ?breakers?|sicherungsautomat",
    "fuse": r"fuses?|polyfuse|poly-?switch|\w*sicherung(en)?|fusibles?",
    "relay": r"relays?|relais",
    "encoder": r"encoders?|drehgeber",
    "switch": r"switch(es)?|(push)? ?buttons?|taster|\w*schalter|interrupteur",
    "socket": r"(ic|dip) ?sockets?",
    "connector": r"connectors?|conn|(pin)? ?headers?|terminal ?blocks?|terminals?|sockets?|plugs?|jacks?|receptacles?|"
    r"usb|rj45|d-?sub|stecker|buchsen?|steckverbinder|\w*leisten?|\w*klemmen?|connecteurs?|borniers?",
    "battery": r"batter(y|ies)|batterien?|akku|coin ?cell",
    "motor": r"\w*motors?|\w*motoren|moteurs?|steppers?|nema ?[0-9]+|servos?",
    "lamp": r"lamps?|lampen?|incandescent",
    "buzzer": r"buzzers?|speakers?|lautsprecher",
    "antenna": r"antennas?|antennen?",
    "hardware": r"stand-?offs?|spacers?|screws?|nuts?|washers?|heat ?sinks?|schrauben?|muttern?|abstandsbolzen|"
    r"kühlkörper|labels?|etiketten?",
    "printed board": r"pcbs?|printed (circuit|wiring)? ?boards?|bare ?boards?|leiterplatten?|platine",
}  # fmt: skip
"""Kinds of parts and the words that name them.""" ""

NO_PARTS = ("no part", "hardware")
"""What stands on lists and fails no circuit."""

PREFIXES: Mapping[str, tuple[str, ...]] = {
    # IEEE 315 as schematic editors use it. Where IEC 81346 or habit has another meaning, both are here: words decide.
    **dict.fromkeys(("R", "RS"), ("resistor",)), **dict.fromkeys(("RN", "RA"), ("resistor network",)),
    **dict.fromkeys(("RT", "TH", "NTC"), ("thermistor",)), **dict.fromkeys(("VR", "POT"), ("potentiometer",)),
    "RP": ("resistor network", "potentiometer"), "RV": ("potentiometer", "varistor"),
    **dict.fromkeys(("VDR", "MOV"), ("varistor",)), **dict.fromkeys(("C", "CP", "CE"), ("capacitor",)),
    "L": ("inductor",), "FB": ("ferrite bead",), "FL": ("filter",), "TR": ("transformer",),
    "T": ("transformer", "transistor"), "V": ("diode", "transistor"),
    **dict.fromkeys(("D", "CR"), ("diode",)), **dict.fromkeys(("DZ", "ZD"), ("zener diode",)), "TVS": ("tvs diode",),
    **dict.fromkeys(("LED", "LD"), ("led",)), "DS": ("led", "display", "lamp"), "BR": ("rectifier",),
    "Q": ("transistor",), "SCR": ("thyristor",), **dict.fromkeys(("OK", "OC"), ("optocoupler",)),
    **dict.fromkeys(("U", "IC"), ("microcircuit",)), "X": ("connector", "crystal"), "H": ("no part", "connector"),
    **dict.fromkeys(("J", "P", "CN", "CON", "CONN", "XS", "XP", "TB"), ("connector",)), "JP": ("connector",),
    **dict.fromkeys(("Y", "XTAL"), ("crystal",)), "OSC": ("oscillator",), "F": ("fuse",), "CB": ("circuit breaker",),
    **dict.fromkeys(("K", "RY", "RL"), ("relay",)), **dict.fromkeys(("S", "SW", "BTN"), ("switch",)),
    **dict.fromkeys(("BT", "BAT"), ("battery",)), "M": ("motor", "microcircuit"),
    **dict.fromkeys(("LS", "BZ"), ("buzzer",)), **dict.fromkeys(("AE", "ANT"), ("antenna",)),
    "PCB": ("printed board",), **dict.fromkeys(("TP", "MH", "FID"), ("no part",)),
}  # fmt: skip
"""What the letters of a reference designator mean. Of one with several meanings the words of its row decide."""

MICROCIRCUITS = ("microcircuit", "microcontroller", "programmable logic", "memory", "analog circuit", "logic")

FAMILIES: tuple[frozenset[str], ...] = tuple(
    frozenset(kinds)
    for kinds in (
        ("diode", "led", "zener diode", "schottky diode", "rectifier", "tvs diode", "thyristor", "laser diode",
         "photodetector"),
        ("transistor", "fet", "bipolar transistor", "thyristor", "photodetector"),
        ("resistor", "resistor network", "thermistor", "potentiometer", "varistor"),
        ("inductor", "ferrite bead", "transformer", "filter"),
        ("crystal", "oscillator"),
        ("capacitor", "supercapacitor"),
        (*MICROCIRCUITS, "optocoupler", "oscillator", "solid state relay"),
        ("led", "display", "liquid crystal or OLED display", "lamp"),
        ("connector", "socket", "no part"),
        ("switch", "encoder"),
        ("relay", "solid state relay"),
    )
)  # fmt: skip
"""Kinds that share letters: other words in the row of a part with these letters speak of something else."""


def kind_of(letters: str, words: str) -> str:
    """The kind of a part by the letters of its reference and the words of its row; '' where they do not tell."""
    lettered = PREFIXES.get(letters, ())
    words = spread(words)
    family = {kind for family in FAMILIES if not family.isdisjoint(lettered) for kind in family} | set(lettered)
    for kind, pattern in _KIND_WORDS.items():
        if (not lettered or kind in family) and pattern.search(words):
            return kind
    return lettered[0] if len(lettered) == 1 else ""


def spread(words: str) -> str:
    """Words that were written together apart: PinHeader_1x04 has three."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", words).replace("_", " ")


def any_of(words: str) -> re.Pattern[str]:
    """One of these words, whole, in whatever case."""
    return re.compile(rf"(?<![^\W_])(?:{words})(?![^\W_])", re.IGNORECASE)


_KIND_WORDS = {kind: any_of(words) for kind, words in KINDS.items()}
