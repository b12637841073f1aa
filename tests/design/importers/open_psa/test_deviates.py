"""What is uncertain in a model, drawn: closed forms, and the strata of a Latin hypercube."""

import numpy as np
import pytest
from scipy import stats

from robophm.core.errors import RobophmError, StructureError
from robophm.design.importers.open_psa import load

DRAWS = 20_000


@pytest.fixture
def model(tmp_path):
    def read(formula, events, parameters="", groups=""):
        path = tmp_path / "model.xml"
        path.write_text(
            f'<opsa-mef><define-fault-tree name="F"><define-gate name="top">{formula}</define-gate>{groups}'
            f"</define-fault-tree><model-data>{parameters}"
            + "".join(f'<define-basic-event name="{n}">{said}</define-basic-event>' for n, said in events.items())
            + "</model-data></opsa-mef>"
        )
        return load(path)

    return read


def deviate(kind, *values):
    inside = "".join(f'<float value="{value!r}"/>' for value in values)
    return f"<{kind}-deviate>{inside}</{kind}-deviate>"


A = '<basic-event name="a"/>'
BOTH = '<and><basic-event name="a"/><basic-event name="b"/></and>'


@pytest.mark.parametrize(
    ("said", "law"),
    [
        (deviate("uniform", 0.1, 0.4), stats.uniform(0.1, 0.3)),
        (deviate("normal", 0.5, 0.05), stats.norm(0.5, 0.05)),
        (deviate("lognormal", -6.0, 0.5), stats.lognorm(0.5, scale=np.exp(-6))),
        (deviate("gamma", 4.0, 0.01), stats.gamma(4, scale=0.01)),
        (deviate("beta", 2.0, 30.0), stats.beta(2, 30)),
    ],
)
def test_one_event_is_drawn_once_of_each_stratum(model, said, law):
    found = model(A, {"a": said})
    assert found.probability() == pytest.approx(law.mean(), rel=1e-12)
    levels = law.cdf(found.drawn(500, 3))
    assert sorted(np.floor(levels * 500)) == list(range(500))
    assert list(levels) != sorted(levels)


def test_an_error_factor_is_from_the_median_to_its_level(model):
    """1.15e-4 with an error factor of 3 at 0.95: the mean, and the ratio of the quantiles."""
    found = model(A, {"a": deviate("lognormal", 1.15e-4, 3.0, 0.95)})
    assert found.probability() == pytest.approx(1.15e-4, rel=1e-12)
    drawn = found.drawn(DRAWS, 0)
    median, high = np.quantile(drawn, [0.5, 0.95])
    assert high / median == pytest.approx(3, rel=5e-3)
    assert drawn.mean() == pytest.approx(1.15e-4, rel=1e-2)


def test_independent_factors_and_one_that_is_shared(model):
    """A product of lognormals is lognormal: of two unknowns, and of one unknown that two events refer to."""
    lognormal = deviate("lognormal", -5.0, 0.6)
    apart = model(BOTH, {"a": lognormal, "b": lognormal})
    parameter = f'<define-parameter name="p">{lognormal}</define-parameter>'
    shared = model(BOTH, dict.fromkeys("ab", '<parameter name="p"/>'), parameter)
    for found, scale, count in ((apart, 0.6 * 2**0.5, 2), (shared, 1.2, 1)):
        assert found.chances.uncertain == count
        law = stats.lognorm(scale, scale=np.exp(-10))
        assert np.quantile(found.drawn(DRAWS, 1), [0.05, 0.5, 0.95]) == pytest.approx(
            law.ppf([0.05, 0.5, 0.95]), rel=0.03
        )
        assert found.probability() == pytest.approx(np.exp(-10 + 0.36), rel=1e-12)  # at the means


def test_a_histogram_is_even_within_its_bins(model):
    """0 … 0.1 twice, 0.1 … 0.3 four times, 0.3 … 0.5 once as likely as the last."""
    bins = "".join(f'<bin><float value="{up}"/><float value="{w}"/></bin>' for up, w in ((0.1, 2), (0.3, 4), (0.5, 1)))
    found = model(A, {"a": f'<histogram><float value="0"/>{bins}</histogram>'})
    assert found.probability() == pytest.approx((2 * 0.05 + 4 * 0.2 + 0.4) / 7, rel=1e-12)
    drawn = found.drawn(7000, 0)
    assert [int(((drawn > low) & (drawn <= high)).sum()) for low, high in ((0, 0.1), (0.1, 0.3), (0.3, 0.5))] == [
        2000, 4000, 1000
    ]  # fmt: skip


def test_members_of_a_common_cause_group_are_drawn_together(model):
    """Both of two fail by their common cause, half of each's failures, or each by its own: of a uniform probability."""
    group = (
        '<define-CCF-group name="g" model="beta-factor">'
        '<members><basic-event name="a"/><basic-event name="b"/></members>'
        f'<distribution>{deviate("uniform", 0.1, 0.3)}</distribution><factor level="2"><float value="0.5"/></factor>'
        "</define-CCF-group>"
    )
    drawn = np.sort(model(BOTH, {}, groups=group).drawn(1000, 2))
    half = np.linspace(0.1, 0.3, 1000) / 2
    assert drawn == pytest.approx(half + (1 - half) * half**2, abs=3e-4)


def test_draws_are_the_same_by_their_seed_and_never_out_of_bounds(model):
    found = model(A, {"a": deviate("normal", 0.02, 0.05)})
    first = found.drawn(100, 5)
    assert (first == found.drawn(100, 5)).all()
    assert (first != found.drawn(100, 6)).any()
    assert first.min() == 0.0
    assert found.probability() == 0.02


def test_what_cannot_be_drawn_is_refused(model):
    with pytest.raises(RobophmError, match="too many"):
        model(A, {"a": deviate("uniform", 0.1, 0.2)}).drawn(60_000_000, 0)
    with pytest.raises(StructureError, match="could be drawn"):
        model('<constant value="true"/>', {}).drawn(10, 0)
