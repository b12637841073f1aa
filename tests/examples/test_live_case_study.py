"""The case study live: the executive by itself, and all processes together over both generations of ROS."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

LIVE = Path(__file__).parents[2] / "examples" / "ota" / "live"


@pytest.fixture
def executive(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(LIVE))
    import executive as module

    return module


def test_the_executive_drives_leg_by_leg(executive: Any) -> None:
    one = executive.Executive()
    one.take([(0.0, 0.0, 0.5), (3.0, 4.0, 2.0), (3.0, 0.0, 1.0)])
    places = {
        0.0: (0.1, 0.0),
        1.0: (1.0, 1.0),
        10.0: (3.0, 4.01),
        11.0: (3.0, 2.0),
        13.5: (3.0, 0.02),
        14.0: (3.0, 0.0),
    }
    told = [(now, one.state.value, list(one.step(now, place))) for now, place in places.items()]
    assert told == [
        (0.0, "task", [("/robot_task_list", [(0.1, 0.0, 0.5), (3.0, 4.0, 2.0), (3.0, 0.0, 1.0)]),
                       ("/ota/goal", (3.0, 4.0, 0.5))]),
        (1.0, "legs", []),
        (10.0, "legs", [("/ota/goal", (3.0, 0.0, 2.0))]),
        (11.0, "legs", []),
        (13.5, "legs", []),
        (14.0, "done", [("/task_time", [10.0, 3.5]), ("/task_position", [(0.1, 0.0), (3.0, 4.01), (3.0, 0.02)])]),
    ]  # fmt: skip
    assert one.state.value == "idle"


def test_a_leg_that_never_ends_is_given_up_and_bad_tasks_are_refused(executive: Any) -> None:
    one = executive.Executive()
    for bad in ([], [(0, 0, 1)], [(0, 0, 0), (1, 1, 1)]):
        with pytest.raises(ValueError, match="is no task"):
            one.take(bad)
    one.take([(0.0, 0.0, 1.0), (1.0, 0.0, 1.0)])
    list(one.step(0.0, (0.0, 0.0)))
    list(one.step(29.0, (0.0, 0.0)))
    assert one.state.value == "legs"
    list(one.step(31.0, (0.0, 0.0)))
    assert (one.state.value, one.given_up) == ("idle", 1)


@pytest.mark.full
@pytest.mark.parametrize("ros", ["1", "2"])
def test_all_together(ros: str, roscore: str) -> None:
    """A minute of real time: both tasks predicted, done and judged, and read by a process that is not ours."""
    pytest.importorskip("mujoco", reason="pip install robophm[sim]")
    done = subprocess.run(
        [sys.executable, str(LIVE / "demo.py"), ros], capture_output=True, text=True, timeout=250, check=False
    )
    assert "2 tasks predicted, 2 of 2 done and judged" in done.stdout
    assert done.returncode == 0
    reader = [line for line in done.stdout.splitlines() if line.startswith("   reader |")]
    assert any("phm_hazard_rate_calculation_node" in line or "HazardRate(" in line for line in reader)
