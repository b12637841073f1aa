"""MIL-HDBK-217F Notice 2 Appendix A: the published rates, and that the parts' own sections reproduce them."""

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

COUNT = handbook_model("mil_hdbk_217f.parts_count")


@each_case("part", ["relay-general", "switch-toggle", "circuit-breaker"])
def test_what_is_not_published_has_no_answer(part):
    with pytest.raises(ModelError, match=f"no published rate for {part} in CL"):
        COUNT.settle({"part": part, "quality_factor": 1, "environment": "CL"})


def test_misprints_are_no_parts():
    with pytest.raises(ModelError, match="part 'connector-rectangular' is not one of its choices"):
        COUNT.settle({"part": "connector-rectangular", "quality_factor": 1, "environment": "GB"})


@each_case("environment", ["GB", "GF", "GM", "NS", "AUF", "SF"])
@each_case(
    ("part", "model", "inputs"),
    [
        ("fuse", "fuse", {}),
        ("socket-ic", "connector_socket", {"style": "IC", "contacts": 40, "quality": "lower"}),
        ("circuit-breaker", "circuit_breaker", {"poles": "DPST", "use": "breaker-only", "quality": "MIL-SPEC"}),
        (
            "switch-toggle", "switch",
            {"style": "toggle", "contact_form": "SPST", "load": "resistive", "load_current": "0 A",
             "rated_current": "1 A", "quality": "MIL-SPEC"},
        ),
    ],
)  # fmt: skip
def test_sections_reproduce_the_count(part, model, inputs, environment):
    count = COUNT.evaluate(COUNT.settle({"part": part, "quality_factor": 1, "environment": environment})).value
    own = handbook_model(f"mil_hdbk_217f.{model}")
    assert own.evaluate(own.settle({**inputs, "environment": environment})).value == pytest.approx(count, rel=0.065)


def test_quality_multiplies():
    once, thrice = (
        COUNT.evaluate(COUNT.settle({"part": "capacitor-ck", "quality_factor": q, "environment": "GM"})).value
        for q in (1, 3)
    )
    assert once == pytest.approx(0.064e-6, rel=1e-14)
    assert thrice == pytest.approx(3 * once, rel=1e-14)
