"""The printed tables of factors, cell by cell: they are the equations, rounded, and so are ours."""

import math

import pytest
from tests.cases import each_case

from .mil_hdbk_217f.adapters import ADAPTERS
from .transcription import OTHERS, at


def number(label):
    """Of 'c_20', 'vs_0_1', 'cf_1e-06'; a watt's eighth is printed as 0.13."""
    value = float(label.partition("_")[2].replace("_", "."))
    return 0.125 if label == "w_0_13" else value


def last(label):
    """Of 'column_2', 'r_125', 'B1925'."""
    return int(label.rpartition("_")[2].removeprefix("B"))


TABLES = [
    ("mil217_capacitors", ("printed", "piT"), "10.1", "piT", [("column", last), ("TA_C", number)]),
    ("mil217_capacitors", ("printed", "piC"), "10.1", "piC", [("column", last), ("C_uF", number)]),
    ("mil217_capacitors", ("printed", "piV"), "10.1", "piV", [("column", last), ("S", number)]),
    ("mil217_resistors", ("printed", "Temperature Factor"), "9.1", "piT", [("T_C", number), ("column", last)]),
    ("mil217_resistors", ("printed", "Power Factor"), "9.1", "piP", [("P_W", number)]),
    ("mil217_resistors", ("printed", "Power Stress Factor"), "9.1", "piS", [("S", number), ("column", last)]),
    ("mil217_diodes", ("printed_piT",), "6.1", "piT", [("B", last), ("TJ_C", number)]),
    ("mil217_inductive", ("printed_piT",), "11.2", "piT", [("THS_C", number)]),
    ("mil217_rotating", ("motor", "printed_alphaB_h"), "12.1", "alphaB", [("TA_C", number)]),
    ("mil217_rotating", ("motor", "printed_alphaW_h"), "12.1", "alphaW", [("TA_C", number)]),
    ("mil217_relays", ("printed_lambda_b",), "13.1", "lambda_b", [("TA_C", number), ("rated_C", last)]),
    ("mil217_relays", ("printed_piL",), "13.1", "piL", [("S", number), ("load", str)]),
    ("mil217_connectors", ("printed_piT",), "15.1", "piT", [("T0_C", number)]),
    ("mil217_connectors", ("printed_piP",), "15.2", "piP", [("N", last)]),
    (OTHERS, ("crystal", "printed_lambda_b"), "19.1", "lambda_b", [("f_MHz", number)]),
]
DISPUTED = {("lambda_b", 85.0, 85): "0.0204 by the equation, 0.021 in print"}


def cells(rows, levels):
    """What each cell is printed for, and what is printed there."""
    (name, of), *deeper = levels
    for label, value in rows.items():
        if deeper:
            yield from (({name: of(label), **more}, printed) for more, printed in cells(value, deeper))
        else:
            yield {name: of(label)}, value


def rounding(printed):
    """Half a unit of the last digit in print: of the second, or of one behind it that is not 0."""
    digits = f"{printed:.12g}".replace(".", "").strip("0")
    behind = max(2, len(digits)) - 1 - math.floor(math.log10(printed))
    return 0.55 * 10.0**-behind


@each_case(("file", "path", "section", "factor", "levels"), TABLES)
def test_printed_factors(file, path, section, factor, levels, second):
    found = list(cells(at(file, *path)(second), levels))
    assert len(found) >= 15
    for inputs, printed in found:
        if (factor, *inputs.values()) in DISPUTED:
            continue
        # the tables of capacitors and resistors have no more than two decimals
        tolerance = max(rounding(printed), 0.0055 if section in ("9.1", "10.1") else 0)
        for ours in ADAPTERS[section].answers({
            "name": path, "inputs": {"factor": factor, **inputs}, "expected": {"unit": "1"}
        }):  # fmt: skip
            assert ours == pytest.approx(printed, abs=tolerance), inputs
