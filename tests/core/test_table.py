import math

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, band

SOURCE = Source("Handbook", "1.2", "3", "made up")
TABLE = Table(
    "π",
    SOURCE,
    """
    A  1.5  2  first, with a note
    B  3    4
    """,
    columns=("x", "y"),
)


def test_rows_columns_and_notes():
    assert TABLE["A"] == 1.5
    assert TABLE.cell("B", "y") == 4
    assert list(TABLE) == ["A", "B"]
    assert len(TABLE) == 2
    assert TABLE.notes == {"A": "first, with a note", "B": ""}
    assert str(SOURCE) == "Handbook §1.2, p. 3"
    assert str(Source("Handbook", "1.2", "Table 4", "x")) == "Handbook §1.2, Table 4"


def test_whether_a_row_is_there_can_be_asked():
    assert "A" in TABLE
    assert "C" not in TABLE
    assert 5.0 not in TABLE


def test_an_unknown_row_names_table_source_and_nearest():
    with pytest.raises(ModelError, match=r"^π: no row 'a' in Handbook §1\.2, p\. 3; did you mean 'A'\?$"):
        TABLE["a"]


@pytest.mark.parametrize("text", ["A 1\nA 2", "A", "A x", "A 1\nB"])
def test_a_bad_transcription_does_not_load(text):
    with pytest.raises(ValueError):
        Table("π", SOURCE, text)


def test_a_band_holds_up_to_its_limit():
    values = band(
        [0.0, 0.1, 0.1 * (1 + 1e-9), 0.8 * (1 + 1e-15), 0.81, math.inf], (0.1, 0.8, math.inf), (3.3, 1.0, 0.66)
    )
    assert values.tolist() == [3.3, 3.3, 1.0, 1.0, 0.66, 0.66]
    assert np.isnan(band(2.0, (1.0,), (5.0,)))
    assert band(np.ones((2, 3)), (1.0,), (5.0,)).shape == (2, 3)
