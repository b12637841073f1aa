"""A parts list of ten thousand rows: read and recognised, then rated; beside csv.reader and np.exp alone."""

from __future__ import annotations

import csv
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks import Line, agree, benchmark, race
from robophm.design.importers.bom import read_parts
from robophm.design.importers.bom.assumptions import Assumptions
from robophm.design.importers.bom.models import Rater, rates

ROWS = 10_000


@benchmark
def parts_list() -> Iterator[Line]:
    draw = np.random.default_rng(11)
    nanofarads, volts = draw.integers(1, 1000, ROWS), draw.choice([6.3, 10, 16, 25, 50], ROWS)
    rows = (f"C{i},{n}nF,C_0603,1,Ceramic X7R {v:g}V\n" for i, (n, v) in enumerate(zip(nanofarads, volts, strict=True)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "list.csv")
        path.write_text("Reference,Value,Footprint,Quantity,Description\n" + "".join(rows))
        parts = read_parts(path).parts
        times = race(lambda: read_parts(path), lambda: list(csv.reader(path.open())), rounds=3)
    yield Line(f"a parts list of {ROWS:,} rows: read and recognised", *times, "csv.reader", per_second=_rows(times[0]))

    rater = Rater(Assumptions())
    begun = time.perf_counter()
    ratings = [rater.rating(part.recognised) for part in parts]
    settling = time.perf_counter() - begun
    yield Line(f"{ROWS:,} parts: models chosen, inputs checked", settling, per_second=_rows(settling))

    # §10.1 by hand at 40 °C: CDR, λb 0.0020, C^0.09 in µF, S = 0.5, πQ 10, πE 20, per 10⁶ h
    heat, stress = np.exp(-0.35 / 8.617e-5 * (1 / 313 - 1 / 298)), (0.5 / 0.6) ** 3 + 1
    agree("rates", rates(ratings), 0.0020 * heat * (nanofarads / 1000) ** 0.09 * stress * 200e-6, 1e-12)
    rating = race(lambda: rates(ratings))[0]
    yield Line(f"{ROWS:,} parts: rated", rating, per_second=_rows(rating))


def _rows(seconds: float) -> str:
    return f"{ROWS / seconds / 1000:.3g} k rows/s"
