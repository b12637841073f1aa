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


NUMBERS = {  # as makers print them on parts that are sold, each without a word beside it
    ("Q", "gan_transistor"): """
        EPC2302 EPC7001 GS61008P GAN041-650WSB GAN7R0-150LBE IGLD60R190D1 IGLR60R190D1 IGT65R055D2 IGC033S10S1
        IGD70R140D2S TPH3206PS TP65H480G4JSG INN650D240A INN100W032A GNP1070TC-Z SGT65R65AL CGD65B130S2 CGH40010F
        CG2H40010 QPD1009 NV6113 NV6128""",
    ("U", "gan_transistor"): """
        LMG2100R044 LMG2610 LMG3522R030-Q1 LMG5200 EPC2152 EPC23102 NV6247 NV6257C MASTERGAN4 VIPERGAN50
        IGI60F1414A1L BM3G007MUV-LB ISG3201""",
    ("Q", "sic_transistor"): """
        C2M0080120D E3M0075120K CAB450M12XM3 SCT040W65G3-4 SCT10N120 SCT4045DR BSM120D12P2C005 IMW65R048M1H
        IMBG120R030M1H IMDQ75R016M1H AIMW120R045M1 AIMZHN120R040M1T FF8MR12W2M1_B11 NTBG020N090SC1 NTH4L014N120M3P
        NVBG022N120M3S NTT2023N065M3S NXH010P120MNF1 UF4SC120030K4S UJ3N120070K3S MSC025SMA120B LSIC1MO120E0080
        G3R75MT12D TW070J120B NSF040120L3A0 GP2T040A120H B2M040120Z P3M12080K3 IV1Q12050T3""",
    ("D", "sic_diode"): """
        C6D20065D E4D20120A CSD10060A SCS220KG SCS304AP STPSC20H12 IDWD40G120C5 AIDW40S65C5 FFSH20120A NDSH25170A
        MSC030SDA120B UJ3D1210KS GD10MPS12A TRS10E65C PSC1065K VS-3C10ET07S2L WNSC2D101200 B1D10065F""",
    ("Q", SILICON): """
        IGW40N60H3 IGB10N60T IGD06N60T IKW40N120T2 FF450R12ME4 BSM50GB120DLC NDS331N NTMFS5C404N NTH027N65S3F
        CSD18540Q5B IMX1T110 IMZ1AT108 IMH11AT110 TPH1R403NL TP0610K GT30J121""",
    ("D", SILICON): "IDP30E65D1 IDW40E65D1 STTH8R06 MBR20100 VS-8ETH06 SDT10A45 FFPF08H60S",
    ("U", SILICON): "TRS3232E DSC1001 LMG1205 LMG1020 INN3278C GS2962 EP2S15",
}


@pytest.mark.parametrize(("letter", "expected"), NUMBERS)
def test_makers_numbers_alone_tell_what_a_part_is_made_of(tmp_path, letter, expected):
    numbers = NUMBERS[letter, expected].split()
    rows = "".join(f"{letter}{i},{number}\n" for i, number in enumerate(numbers))
    (source := tmp_path / "power.csv").write_text("Reference,Value\n" + rows)
    taken = {}
    for one in import_bom(source, tmp_path / "robot.yaml").parts:
        entry = one.rating.entry if one.rating else None
        taken |= {int(reference[1:]): entry.name if entry else SILICON for reference in one.part.references}
    assert {numbers[i]: made_of for i, made_of in taken.items()} == dict.fromkeys(numbers, expected)


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
