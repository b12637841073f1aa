"""The second transcription of the handbooks, shared/handbook/tables: where a thing stands in it."""

import re

CIRCUITS, BOARDS = "mil217_microcircuits", "mil217_interconnection"
OTHERS = "mil217_crystals_fuses_lamps_filters_meters"
DIODES, TRANSISTORS, LIGHT = "mil217_diodes", "mil217_transistors", "mil217_optoelectronics"
MECHANICS, SPRINGS, SEALS = "nswc_motors_couplings_shafts_actuators", "nswc_springs", "nswc_misc_seals_sensors_belts"


def at(file, *path, **words):
    """What stands at a path of a file, whose rows ``words`` call by our names."""

    def found(second):
        value = second(file)
        for step in path:
            value = value[step]
        return renamed(value, words) if words else value

    return found


def renamed(rows, words):
    """Rows by our names, which are given with theirs: a word that they do not have fails."""
    assert set(words.values()) <= rows.keys()
    ours = {theirs: name for name, theirs in words.items()}
    return {ours.get(key, key): row for key, row in rows.items()}


def numbers(text, *patterns):
    """The first number after each pattern of a text."""
    return [float(re.search(pattern + r"\s*([\d.]*\d)", text).group(1)) for pattern in patterns]
