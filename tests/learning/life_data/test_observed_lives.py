"""Tables as lifelines, reliability and SurPyval keep them; parts that were not watched from new."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import lognorm, weibull_min

from robophm.core.errors import DataError
from robophm.learning.life_data.distribution_fitting import fit, goodness
from robophm.learning.life_data.life_stress import fit_life_stress
from robophm.learning.life_data.observed_lives import LifeData, read_life_data

pytest.importorskip("surpyval")


@pytest.fixture
def read(tmp_path):
    def read(text, **more):
        (tmp_path / "lives.csv").write_text(text)
        return read_life_data(tmp_path / "lives.csv", **more)

    return read


@pytest.mark.parametrize(
    "text",
    [
        "T [h],E\n5,1\n6,0\n7,1\n",  # lifelines
        "duration [h],observed\n5,True\n6,False\n7,True\n",
        "time [h],event\n5,failure\n6,censored\n7,died\n",
        "time [h],status\n5,1\n6,0\n7,1\n",
        "time [h],status\n5,dead\n6,alive\n7,dead\n",
        "T [h],E,weights\n5,1,1\n6,0,1\n7,1,1\n",
        "time [h],death\n5,1\n6,0\n7,1\n",
        ",T [h],E\n0,5,1\n1,6,0\n2,7,1\n",  # a data frame's index
        "start [h],stop [h],event\n0,5,1\n0,6,0\n0,7,1\n",
        "lower_bound [h],upper_bound [h]\n5,5\n6,inf\n7,7\n",
        "x [h],c,n\n5,0,1\n6,1,1\n7,0,1\n",  # SurPyval
        "x [h],c,n,tl [h],tr [h]\n5,0,1,-inf,inf\n6,1,1,-inf,inf\n7,0,1,-inf,inf\n",
        "i,x [h],c\na,5,0\nb,6,1\nc,7,0\n",
        "x [h],c\n5,F\n6,C\n7,F\n",  # reliability
        "event times [h],censor code,number of events\n5,F,1\n6,C,1\n7,F,1\n",
        "xl [h],xr [h],c\n5,5,0\n6,6,1\n7,7,0\n",
        "time [h],censored\n5,\n6,yes\n7,no\n",
    ],
)
def test_words_of_other_tables(read, text):
    found = read(text)
    assert found.low.tolist() == [5, 6, 7]
    assert found.high.tolist() == [5, math.inf, 7]
    assert not found.stresses


def test_all_kinds_of_surpyval(read):
    found = read("xl [h],xr [h],c,n\n0,5,-1,2\n3,9,2,1\n4,4,0,1\n8,8,1,3\n")
    assert found.low.tolist() == [0, 3, 4, 8]
    assert found.high.tolist() == [5, 9, 4, math.inf]
    assert found.count.tolist() == [2, 1, 1, 3]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,status\n5,1\n6,2\n", r"lives.csv:3: status: 2 is a failure to some \(R\)"),
        ("time,status\n5,1\n6,1\n", r"lives.csv:2: status: 1 alone: failed, or censored\?"),
        ("time,event,censored\n5,1,\n6,0,yes\n", "columns 'censored' and 'event' both say what failed"),
        ("time,event\n5,1\n6,3\n", r"lives.csv:3: event: '3'; expected failed or worked or left"),
        ("time,event\n5,1\n6,\n", r"lives.csv:3: event: is empty; expected whether it failed"),
        ("x,c\n5,2\n6,0\n", r"lives.csv:2: c: failed within an interval, but states one time"),
        ("x,c,n,t\n5,1,1,2\n", "lives.csv:2: two columns are 'time'; expected one of 'x' and 't'"),
        ("T,C\n5,1\n6,0\n", r"lives.csv:2: C: 1: failed, or censored\? 1 is the one to some and the other to others"),
        ("time,cens\n5,0\n6,1\n", r"lives.csv:2: cens: 0: failed, or censored\?"),
        ("T,E\n5,1\n6,2\n", "lives.csv:3: event: '2'; .* in which way a part failed is a column 'mode'"),
        ("x,c,e\n5,0,a\n6,0,b\n", "'e' beside 'c' is in which way a part failed, .* headed 'mode'"),
        ("week,arrest\n5,1\n6,0\n", "has no times; expected a column 'time .*, not 'week', 'arrest' alone"),
        ("time,arrest\n5,1\n6,0\n", "'arrest' is not known.* If it says which failed, head it 'event'"),
        ("time [h],since [h]\n5,5\n", r"lives.csv:2: since: 5 is not before the part was last seen"),
        ("time [h],since [h],censored\n5,6,yes\n", "since: 6 is not before the part was last seen"),
        ("from [h],to [h],since [h]\n5,9,6\n", "since: 6 is not before the part was last seen"),
        ("time [h],since\n5,1\n", "since: '1' is in no unit, but line 2 is in h"),
        ("x,c,n,tl,tr\n5,0,1,0,10\n6,0,1,0,10\n", "lives.csv: column 'tr': right truncation"),
        ("time,weights\n5,0.5\n6,1\n", "lives.csv:2: count: 0.5; expected a whole number"),
        ("time [h],mode\n5,a\n6,\n", "lives.csv:3: mode: failed, but in which way is not said"),
        ("time [h],mode\n5,a\n6,None\n", "lives.csv:3: mode: failed, with 'None' as the way .* still worked"),
        ("time [h],time [h]\n5,6\n7,8\n", r"lives.csv:1: two columns are headed 'time \[h\]'; expected one"),
        ("time [h],mode,censored\n5,a,\n6,a,yes\n", "lives.csv:3: mode: 'a' of a part that still worked"),
    ],
)
def test_what_could_mean_either_is_refused(read, text, said):
    with pytest.raises(DataError, match=said):
        read(text)
    for name in (
        "event",
        "status",
        "c",
        "n",
        "t",
        "x",
        "since",
        "mode",
        "tr",
        "weights",
        "death",
        "cens",
        "delta",
    ):  # and never a stress, even if it is called one
        with pytest.raises(DataError):
            fit_life_stress(read(f"time [h],{name}\n5,1\n6,0\n7,1\n", stresses=[name]), reference={name: 1.0})


def late(rng, life, parts):
    """Parts that began to be watched at any age; those that had failed by then are not there, some works on."""
    ages, since = life.rvs(parts, random_state=rng), np.where(rng.random(parts) < 0.3, 0, rng.uniform(0, 900, parts))
    ages, since = ages[ages > since], since[ages > since]
    end = since + rng.uniform(200, 1200, len(ages))
    return np.minimum(ages, end), np.where(ages < end, ages, np.inf), since


@pytest.mark.parametrize("name", ["weibull", "lognormal"])
def test_late_entry(name):
    """The likelihood of truncated lives written down and searched by SciPy; and the truth, which is missed without."""
    rng, truth = (
        np.random.default_rng(2),
        weibull_min(2.5, scale=1000) if name == "weibull" else lognorm(0.5, scale=900),
    )
    low, high, since = late(rng, truth, 400)
    high[::7] = np.where(np.isfinite(high[::7]), high[::7] + 20, np.inf)  # some within intervals
    found = fit(LifeData("data", low, high, np.ones(len(low)), "h", since=since), name)

    def miss(x):
        scale, shape = np.exp(x)
        life = weibull_min(shape, scale=scale) if name == "weibull" else lognorm(shape, scale=scale)
        log = np.where(low == high, life.logpdf(low), np.log(np.maximum(life.sf(low) - life.sf(high), 1e-300)))
        return -np.sum(log - life.logsf(since))

    start = [math.log(900), 0.5 if name == "weibull" else -0.5]
    best = minimize(miss, start, method="Nelder-Mead", options={"xatol": 1e-8, "fatol": 1e-10, "maxfev": 4000})
    assert found.log_likelihood == pytest.approx(-best.fun, rel=1e-9)
    shape = found.parameters["shape" if name == "weibull" else "log_deviation"]
    assert shape.value == pytest.approx(math.exp(best.x[1]), rel=1e-3)
    assert found.life.quantile(0.5) == pytest.approx(truth.ppf(0.5), rel=0.1)
    whole = fit(LifeData("data", low, high, np.ones(len(low)), "h"), name)
    assert whole.life.quantile(0.1) > 1.1 * found.life.quantile(0.1)
    assert "not watched from new" in found.data.described()
    # The plot counts who was watched: failed shares are about those of the fit.
    assert np.abs(found.plot.failed - found.life.failure_probability(found.plot.times)).max() < 0.1


def test_late_entry_of_a_constant_rate(read):
    """Failures over the time watched."""
    data = read("time [h],since [h],censored\n100,40,\n300,,\n500,200,yes\n90,80,yes\n")
    found = fit(data, "exponential")
    assert found.parameters["rate"].value == pytest.approx(2 / (60 + 300 + 300 + 10), rel=1e-5)
    with pytest.raises(DataError, match="ranks know nothing of parts not watched from new"):
        fit(data, how="ranks")
    with pytest.raises(DataError, match="simulation knows nothing of parts not watched from new"):
        goodness(found, 5, 0)
    none = read("time [h],since [h],censored\n100,40,yes\n300,,yes\n")
    with pytest.raises(DataError, match=r"would be below 0.00832 /h"):  # -ln(0.05)/360
        fit(none)


@pytest.mark.full
def test_late_entry_at_stress():
    """By inverse power: the same likelihood as of one stress speeded up by hand."""
    rng = np.random.default_rng(5)
    low, high, since = late(rng, weibull_min(2.0, scale=1000), 300)
    volts = np.repeat([10.0, 20.0], [150, len(low) - 150])
    faster = (volts / 10) ** 3.0
    lives = LifeData("d", low / faster, high / faster, np.ones(len(low)), "h", {"voltage": volts}, since=since / faster)
    found = fit_life_stress(lives, reference={"voltage": 10.0}, level=0.99)
    assert found.coefficients["voltage"].low < 3.0 < found.coefficients["voltage"].high
    assert found.parameters["scale"].low < 1000 < found.parameters["scale"].high
    steps = LifeData("d", low[:2], low[:2], np.ones(2), "h", {"voltage": volts[:2]}, ("a", "a"), since[:2] + 1)
    with pytest.raises(DataError, match="steps of stress are of parts watched from new"):
        fit_life_stress(steps, reference={"voltage": 10.0})
