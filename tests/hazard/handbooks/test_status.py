"""What a model's page says of published answers is what the tests compare."""

import json

from tests.cases import each_case

from robophm.hazard.handbooks import handbook_model, handbook_models

from .adapter import DATA
from .test_published import CASES, adapter

APPENDIX = [json.loads(file.read_text(encoding="utf-8"))["rows"].values() for file in DATA.glob("appendix_a_*.json")]
PRINTED = [case for case in CASES.values() if not case.get("weak")]  # the others are another program's own figures
ANSWERED = {adapter(case).kind for case in PRINTED} | {row["model"] for rows in APPENDIX for row in rows}
UNSAID = (
    "general.",
    "nswc_11.",
    "mil_hdbk_217f.parts_count",
)  # which say that the text itself was not to be had, or are it


@each_case("kind", [kind for kind in handbook_models() if not kind.startswith(UNSAID)])
def test_a_page_denies_no_published_answer_that_exists(kind):
    denied = "no published answer" in handbook_model(kind).source.status
    assert denied == (kind not in ANSWERED)
