"""NSWC-11, Handbook of Reliability Prediction Procedures for Mechanical Equipment. What its chapters share.

The handbook counts in inches, pounds and degrees Fahrenheit; users say what they have, and each chapter converts. Its
failures per 10⁶ h become 1/h, its failures per 10⁶ cycles 1/cycle, on the clock of cycles. Limits of inputs are of
sanity, for the handbook prints hardly any.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Table
from robophm.hazard.model import Array, Choice, Factor, Otherwise

TITLE = "NSWC-11"

INCH = 25.4
"""Length of an inch [mm]."""
PSI = 6.894757293168361e-3
"""Pound-force per square inch [MPa]."""
POUND = 4.4482216152605
"""Force of a pound [N]."""

TWICE = "two transcriptions agree; the handbook's own text could not be had"
ONCE = "single transcription; the handbook's own text could not be had"

PER_MILLION_CYCLES = 1e-6
"""Factor from the handbook's failures per 10⁶ cycles to 1/cycle."""

PER_HOUR = Factor("10⁻⁶", 1e-6, "failures/10⁶ h to 1/h")
PER_CYCLE = Factor("10⁻⁶", PER_MILLION_CYCLES, "failures/10⁶ cycles to 1/cycle")

OTHER = "other"
"""Choice of what no table has: its number is stated."""


def fahrenheit(celsius: Array) -> Array:
    """A temperature in degrees Fahrenheit, of one in degrees Celsius."""
    return np.asarray(celsius) * 1.8 + 32


def size(value: Array) -> Array:
    """The magnitude: what a broken sensor says below zero must not make a rate negative."""
    result: Array = np.abs(np.asarray(value, dtype=float))
    return result


def heat(symbol: str, celsius: Array) -> Factor:
    """The temperature factor of gears, splines and shafts: 1 up to 160 °F, (460 + T)/620 above, T in °F."""
    value = (460 + np.maximum(fahrenheit(celsius), 160)) / 620
    return Factor(symbol, value, "1 up to 160 °F (71 °C), then (460 + T)/620")


def viscosity(symbol: str, specified: Array, used: Array) -> Factor:
    """The lubricant factor of gears, splines and bearings: (ν_specified/ν_used)^0.54."""
    return Factor(symbol, (size(specified) / size(used)) ** 0.54, "(ν specified / ν used)^0.54")


def or_other(table: Table, description: str, stated: str) -> Choice:
    """A choice of a table's rows, or of what none of them is: then the input ``stated`` is needed."""
    return Choice((*table, OTHER), f"{description}; {OTHER} needs '{stated}'")


def of_table(table: Table, choice: str, column: str, unit: float) -> Otherwise:
    """A row's number [in ``unit`` of the table], for an input that is stated only where the table has it not."""

    def found(given: Mapping[str, Any]) -> tuple[float, str] | None:
        row = given[choice]
        return None if row == OTHER else (table.cell(row, column) * unit, f"the table's, of {row}")

    return found


def looked_up(table: Table, row: str, column: str, stated: Array | None, name: str, unit: float) -> tuple[Array, str]:
    """A row's number, or the stated one [in ``unit`` of the table] instead, and which of the two it is."""
    if stated is not None:
        return size(stated) / unit, f"'{name}' as stated"
    if row == OTHER:
        raise ModelError(f"{TITLE}: {OTHER} {table.name} needs '{name}'")
    return np.asarray(table.cell(row, column)), row


def product(factors: Iterable[Factor]) -> Factor:
    """The product of several factors, in their order."""
    first, *more = factors
    for factor in more:
        first = first * factor
    return first
