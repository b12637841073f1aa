"""Figures as a fleet's store keeps them, one report's and many's."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

from robophm.core.errors import StoreError
from robophm.fleet.figures import figures_as_bytes, figures_of_bytes, figures_of_rows

KEYS = np.array([(7, 1, seq, seq * 10**9 - 5) for seq in range(1, 6)])
FIGURES = [(0.1, -0.0, 1e-46), (float("inf"), 3e38, 1e300), (float("nan"), 2.0, 0.0), (5.0,), ()]
KEPT = [figures_as_bytes((7, 1, seq), time, one) for (_, _, seq, time), one in zip(KEYS.tolist(), FIGURES, strict=True)]


def test_many_are_read_as_each_alone_to_the_bit():
    found = figures_of_rows(KEYS, KEPT)
    assert found.shape == (5, 3)
    for row, (key, one) in zip(found, zip(KEYS.tolist(), KEPT, strict=True), strict=True):
        alone = struct.pack(f"<{len(one) // 4 - 1}f", *figures_of_bytes(tuple(key[:3]), key[3], one))
        assert row.tobytes()[: len(alone)] == alone == one[:-4]
        assert np.isnan(row[len(alone) // 4 :]).all()
        assert int.from_bytes(one[-4:], "little") == zlib.crc32(alone, zlib.crc32(struct.pack("<4q", *key)))
    assert figures_of_rows(KEYS[:0], []).shape == (0, 0)


@pytest.mark.parametrize("damage", [b"", b"abc", KEPT[2][:-1] + b"x", KEPT[3], b"x" + KEPT[2]])
def test_one_that_is_damaged_among_many_is_named(damage):
    kept = [*KEPT]
    kept[2] = damage
    with pytest.raises(StoreError, match="report 3 of epoch 1 of robot 7 is damaged"):
        figures_of_rows(KEYS, kept)
