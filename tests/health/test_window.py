from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from robophm.core.signal import Sample
from robophm.health.window import Columns, Window, parted

SAMPLES = st.lists(st.builds(Sample, st.integers(-5, 5), st.sampled_from("abc"), st.floats(-9, 9)), max_size=12)


def plain(columns: Columns) -> list[Sample]:
    return sorted(
        Sample(time, signal, value)
        for signal, (times, values) in columns.items()
        for time, value in zip(times.tolist(), values.tolist(), strict=True)
    )


@given(SAMPLES, SAMPLES, st.integers(-6, 6))
def test_what_is_taken_and_what_stays(first: list[Sample], more: list[Sample], until: int) -> None:
    window = Window(first)
    copy = window.copy()
    taken = window.take(until)
    assert plain(taken) == sorted(sample for sample in first if sample.time <= until)
    for sample in more:
        window.add(sample)
    rest = sorted([*(sample for sample in first if sample.time > until), *more])
    assert window.samples() == plain(window.columns()) == rest
    assert len(window) == len(rest)
    assert copy.samples() == sorted(first)
    ready, later = parted(window.columns(), until)
    assert plain(ready) + plain(later) == sorted(rest, key=lambda sample: (sample.time > until, sample))


@given(SAMPLES)
def test_each_signal_comes_in_order_of_time_and_value(samples: list[Sample]) -> None:
    columns = Window.of(Window(samples).columns()).columns()
    assert columns.keys() == {sample.signal for sample in samples}
    for signal, (times, values) in columns.items():
        own = sorted((sample.time, sample.value) for sample in samples if sample.signal == signal)
        assert list(zip(times.tolist(), values.tolist(), strict=True)) == own
