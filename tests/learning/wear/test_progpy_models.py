"""NASA's models of batteries and motors, where progpy is installed."""

import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.progpy_models import ProgpyModel


def test_progpy_models():
    """A battery runs empty sooner under more load; a motor's model says what a healthy one does."""
    pytest.importorskip("progpy.models", reason="progpy is not installed: pip install robophm[progpy]")
    battery = ProgpyModel("BatteryCircuit")
    assert battery.events == ("EOD",)
    two, four = (battery.time_to("EOD", {"i": amps}, 10_000, step=2.0) for amps in (2.0, 4.0))
    assert 0.4 * two < four < 0.55 * two  # half of it, and less for what the resistance takes
    capacity = battery.model.parameters["qMax"] / 2.0
    assert 0.8 * capacity < two < 1.1 * capacity
    for wrong, said in (({"amps": 1.0}, "takes i, not amps"), ({}, "takes i, not nothing")):
        with pytest.raises(DataError, match=said):
            battery.run(wrong, 10)
    with pytest.raises(DataError, match="no event 'EOL'"):
        battery.time_to("EOL", {"i": 1.0}, 10)
    with pytest.raises(DataError, match="no model 'Batery'"):
        ProgpyModel("Batery")
