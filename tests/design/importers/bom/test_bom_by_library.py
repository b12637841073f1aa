"""Parts that no handbook rates and the library has are entries of it: never as silicon, with their grade and range."""

import json

import pytest

from robophm.cli.import_bom import command
from robophm.design.importers.bom import import_bom
from robophm.design.importers.bom.by_library import BY_LIBRARY
from robophm.health.drawn_rates import draw_rates
from robophm.health.plant import Plant
from robophm.parts import graded, library

SILICON = "silicon"
ROWS = (  # reference, value, description, and what it is, by the makers' own pages
    ("Q1", "EPC2001C", "", "gan_transistor"),
    ("Q2", "GS-065-011-1-L", "", "gan_transistor"),
    ("Q3", "GS66508T", "", "gan_transistor"),
    ("Q4", "IGT60R070D1", "", "gan_transistor"),
    ("Q5", "TP65H050WS", "", "gan_transistor"),
    ("Q6", "?", "GANFET N-CH 100V 36A DIE", "gan_transistor"),
    ("Q7", "?", "Gallium Nitride power transistor", "gan_transistor"),
    ("U1", "LMG3410R070", "600-V 70 mOhm GaN with integrated driver", "gan_transistor"),
    ("U2", "MASTERGAN1", "half-bridge driver with two GaN HEMTs", "gan_transistor"),
    ("Q10", "C3M0065090D", "SICFET N-CH 900V 36A TO247-3", "sic_transistor"),
    ("Q11", "SCT3030AL", "N-channel SiC power MOSFET", "sic_transistor"),
    ("Q12", "SCTW35N65G2V", "", "sic_transistor"),
    ("Q13", "IMZ120R045M1", "", "sic_transistor"),
    ("Q14", "NTHL080N120SC1", "", "sic_transistor"),
    ("Q15", "UJ4C075018K3S", "", "sic_transistor"),
    ("Q16", "?", "MOSFET 1200V silicon carbide", "sic_transistor"),
    ("D1", "C4D10120A", "", "sic_diode"),
    ("D2", "STPSC10H065", "", "sic_diode"),
    ("D3", "IDH10G65C6", "", "sic_diode"),
    ("D4", "?", "DIODE SIL CARB 650V 10A", "sic_diode"),
    ("U5", "MPU-6050", "", "mems_sensor_chip"),
    ("U6", "MS5611", "barometric pressure sensor", "mems_sensor_chip"),
    ("Q20", "IRF540", "MOSFET N-CH 100V 33A", SILICON),
    ("Q21", "CSD17577Q3A", "", SILICON),
    ("Q22", "IPB017N06N3", "N-channel MOSFET", SILICON),
    ("D10", "SS14", "Schottky", SILICON),
    ("D11", "1N4148", "", SILICON),
    ("U10", "LMG1210", "200-V half-bridge MOSFET and GaN FET driver", SILICON),
    ("U11", "UCC21750", "isolated gate driver for SiC MOSFET and IGBT", SILICON),
    ("U12", "LM5113", "gate driver for enhancement mode GaN FETs", SILICON),
)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("list")
    rows = (f'{reference},{value},"{words}"' for reference, value, words, _ in ROWS)
    (source := folder / "power.csv").write_text("Reference,Value,Description\n" + "\n".join(rows) + "\n")
    return import_bom(source, folder / "robot.yaml")


@pytest.mark.parametrize(("reference", "expected"), [(row[0], row[3]) for row in ROWS])
def test_what_a_part_is_made_of_is_told_by_words_and_numbers(found, reference, expected):
    (one,) = [one for one in found.parts if reference in one.part.references]
    entry = one.rating.entry
    assert (entry.name if entry else SILICON) == expected
    assert bool(one.rating.model) == (expected == SILICON)


def test_it_has_the_grade_and_the_range_of_its_entry(found):
    parts = {part.path: part for part in found.robot.all_components()}
    (mode,) = parts["Q1"].modes
    assert mode.rate == pytest.approx(115e-9, rel=1e-12)  # 115 FIT, as the entry says
    assert graded(mode.source) == "gan_transistor, grade C"
    assert mode.uncertainty.error_factor == 10
    drawn = draw_rates(Plant(found.robot), 50, seed=1)
    rows = {mode.path: i for i, mode in enumerate(found.robot.modes)}
    assert (drawn[rows["Q1"]] == drawn[rows["Q2"]]).all()  # of one entry: one unknown
    assert (drawn[rows["Q1"]] != drawn[rows["Q10"]]).any()


def test_it_is_found_again_and_a_hand_edit_stays(found, tmp_path):
    design, source = tmp_path / "robot.yaml", tmp_path / "power.csv"
    source.write_text("Reference,Value\nQ1,EPC2001C\nR1,10k\n")
    design.write_text(import_bom(source, design).text)
    assert [one.outcome.state for one in import_bom(source, design).parts] == ["unchanged", "unchanged"]
    source.write_text("Reference,Value\nQ1,IRF540\nR1,10k\n")
    again = import_bom(source, design)
    assert [one.outcome.state for one in again.parts] == ["changed", "unchanged"]
    assert "gan_transistor" not in again.text
    design.write_text(design.read_text().replace("part: gan_transistor", "part: gan_transistor\n    rate: 3 FIT"))
    kept = import_bom(source, design)
    assert [one.outcome.state for one in kept.parts] == ["kept", "unchanged"]


def test_a_command_says_the_entry(found, tmp_path, capsys):
    source = tmp_path / "power.csv"
    source.write_text("Reference,Value\nQ1,EPC2001C\nR1,10k\n")
    command(source, tmp_path / "robot.yaml", dry_run=True, as_json=True)
    (first, _) = json.loads(capsys.readouterr().out)["parts"]
    assert (first["model"], first["part"]) == (None, "gan_transistor")


@pytest.mark.parametrize("name", BY_LIBRARY)
def test_each_entry_states_one_rate(name):
    assert len({"rate", "mtbf"} & library()[name].part.keys()) == 1
