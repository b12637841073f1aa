"""Files as tables: every usual encoding, workbooks made by hand, and what is refused in one line."""

import io
import random
import time
import zipfile
from xml.sax.saxutils import escape

import pytest

from robophm.core.errors import DesignError
from robophm.design.importers.bom import read_parts, spreadsheets, tables
from robophm.design.importers.bom.columns import mapping_text, parse_mapping, read_table

ROWS = [
    ["Reference", "Value", "Description", "Qty"],
    ["C1, C2", "0,1 µF", "Keramik 50 V", "2"],
    ["R1", "2,2 k", "Größe 0603", "1"],
]


def cells(read):
    return [row.cells for row in read.rows]


def office(rows, *, sheet="", shared=True, parts=()):
    """An .xlsx: the first sheet empty, the list in the second."""
    texts = list(dict.fromkeys(cell for row in rows for cell in row))
    if not sheet:
        for y, row in enumerate(rows, 3):
            inner = ""
            for x, cell in enumerate(row):
                place = f'r="{chr(65 + x)}{y}"'
                if cell.replace(".", "").isdigit():
                    inner += f"<c {place}><v>{cell}</v></c>"
                elif cell.startswith("="):
                    inner += f'<c {place} t="str"><f>{escape(cell[1:])}</f><v>shown</v></c>'
                elif shared:
                    inner += f'<c {place} t="s"><v>{texts.index(cell)}</v></c>'
                else:
                    inner += f'<c {place} t="inlineStr"><is><t>{escape(cell)}</t></is></c>'
            sheet += f'<row r="{y}">{inner}</row>'
    main = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/workbook.xml", f"<workbook {main}/>")
        archive.writestr("xl/worksheets/sheet1.xml", f"<worksheet {main}><sheetData/></worksheet>")
        archive.writestr("xl/worksheets/sheet2.xml", f"<worksheet {main}><sheetData>{sheet}</sheetData></worksheet>")
        runs = "".join(f"<si><r><t>{escape(text[:2])}</t></r><r><t>{escape(text[2:])}</t></r></si>" for text in texts)
        archive.writestr("xl/sharedStrings.xml", f"<sst {main}>{runs}</sst>")
        for name, text in parts:
            archive.writestr(name, text)
    return stream.getvalue()


def open_document(rows, body=""):
    names = " ".join(
        f'xmlns:{short}="urn:oasis:names:tc:opendocument:xmlns:{short}:1.0"' for short in ("office", "table", "text")
    )
    for row in rows:
        inner = ""
        for cell in row:
            if cell.replace(".", "").isdigit():
                value = f'office:value-type="float" office:value="{cell}"'
                inner += f"<table:table-cell {value}><text:p>shown</text:p></table:table-cell>"
            elif not cell:
                inner += "<table:table-cell/>"
            else:
                note = "<office:annotation><text:p>a remark</text:p></office:annotation>"
                inner += f"<table:table-cell>{note}<text:p>{escape(cell)}</text:p></table:table-cell>"
        body += f'<table:table-row>{inner}<table:table-cell table:number-columns-repeated="16000"/></table:table-row>'
    blank = '<table:table-cell table:number-columns-repeated="16384"/>'
    body += f'<table:table-row table:number-rows-repeated="1048000">{blank}</table:table-row>'
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        table = f'<table:table table:name="BOM">{body}</table:table>'
        archive.writestr("content.xml", f"<office:document-content {names}>{table}</office:document-content>")
    return stream.getvalue()


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_text_of_any_kind(tmp_path, delimiter, encoding, ending):
    text = ending.join(delimiter.join(f'"{cell}"' for cell in row) for row in ROWS)
    path = tmp_path / "list.csv"
    path.write_bytes(text.encode(encoding))
    read = read_table(path)
    assert cells(read) == [tuple(row) for row in ROWS[1:]]
    assert (read.sheet, read.decimal) == (tables.DELIMITERS[delimiter], ",")


def test_a_spreadsheets_own_first_line(tmp_path):
    path = tmp_path / "list.csv"
    path.write_text("sep=;\nReference;Value;Qty\nC1;100n;1\n")
    read = read_table(path)
    assert (read.header_row, cells(read), read.rows[0].number) == (2, [("C1", "100n", "1")], 3)


@pytest.mark.parametrize("make", [office, lambda rows: office(rows, shared=False), open_document])
def test_workbooks(tmp_path, make):
    path = tmp_path / "list.xlsx"  # what is in it counts, not its name
    rows = [*ROWS, ["C5", "=A1&B1", '<b> & "c"', "1"], ["L1", "1.125", "", "1"]]
    path.write_bytes(make(rows))
    read = read_table(path)
    formula = "shown" if make is not open_document else "=A1&B1"
    expected = [*ROWS[1:], ["C5", formula, '<b> & "c"', "1"], ["L1", "1.1250", "", "1"]]
    assert cells(read) == [tuple(row) for row in expected]
    assert read.rows[0].number == (4 if make is not open_document else 2)


def test_a_workbook_is_imported_like_text(tmp_path):
    (tmp_path / "a.csv").write_text("\n".join(";".join(row) for row in ROWS), encoding="utf-8")
    (tmp_path / "b.xlsx").write_bytes(office(ROWS))
    (tmp_path / "c.ods").write_bytes(open_document(ROWS))
    found = [
        [(p.references, p.quantity, p.recognised) for p in read_parts(path).parts]
        for path in sorted(tmp_path.iterdir())
    ]
    assert found[0] == found[1] == found[2]
    assert dict(found[0][0][2].facts)["capacitance"] == "0.1 uF"


def test_numbers_of_a_workbook_do_not_say_what_a_comma_means(tmp_path):
    """They have points in every country; what people wrote beside them tells."""
    rows = [
        ["Bezeichner", "Wert", "Bauform", "Nennspannung", "Toleranz"],
        ["C1", "0,1 µF", "0603", "6.3", "0.1"],
        ["C2", "1.000 µF", "radial", "2.5", "0.2"],
        ["R1", "2.2", "805", "1.125", "0.05"],
    ]
    for name, make in (("a.xlsx", office), ("b.ods", open_document)):
        path = tmp_path / name
        path.write_bytes(make(rows))
        facts = [part.recognised.facts for part in read_parts(path).parts]
        assert [one.get("capacitance") for one in facts] == ["0.1 uF", "1000 uF", None]
        assert [one.get("rated_voltage") for one in facts] == ["6.3 V", "2.5 V", None]
        assert (facts[2]["resistance"], facts[2]["size"]) == ("2.2 ohm", "0805")


@pytest.mark.parametrize(
    ("cells", "field"), [(["R1, R2", "C3"], "reference"), (["10k 1%", "100nF"], "value")], ids=["references", "values"]
)
def test_a_column_called_part_is_what_its_cells_are(tmp_path, cells, field):
    path = tmp_path / "list.csv"
    path.write_text("Part;Qty\n" + "".join(f"{cell};1\n" for cell in cells))
    assert {column.header: column.field for column in read_table(path).columns}["Part"] == field


def zipped(*parts):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts:
            archive.writestr(name, text)
    return stream.getvalue()


LAUGHS = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><x>&b;</x>'
HOSTILE = {
    "binary": (bytes(range(256)) * 50, "is not text"),
    "NUL": (b"Reference,Value\nC1,1\x000\n", "is not text"),
    "empty": (b"", "holds no rows"),
    "blank": (b"\n\n ,,\n", "has no header"),
    "no header": (b"a,b\n1,2\n", "has no header with e.g. Reference, Quantity, Value, Footprint; found 'a', 'b'"),
    "one column": (b"Reference\nC1\n", "has no header"),
    "a million columns": (b"Reference,Value\n" + b"1," * 1_000_000 + b"1\n", "row 2 has 1,000,001 columns"),
    "a long cell": (b"Reference,Value\nC1," + b"x" * 120_000 + b"\n", "row 2 has a cell of 120,0"),
    "a longer cell": (b"Reference,Value\nC1," + b"x" * 200_000 + b"\n", "field larger than field limit"),
    "many rows": (b"Reference,Value\n" + b"C1,1n\n" * 100_001, "has more than 100,000 rows"),
    "old Excel": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 600, "is an old Excel workbook; expected .xlsx"),
    "broken zip": (b"PK\x03\x04" + b"x" * 500, "is no workbook"),
    "other zip": (zipped(("a.txt", "a")), "is an archive, but no workbook"),
    "entities": (zipped(("content.xml", LAUGHS)), "declares a document type"),
    "entities in xlsx": (zipped(("xl/workbook.xml", ""), ("xl/sharedStrings.xml", LAUGHS)), "declares a document type"),
    "utf-16 entities": (zipped(("content.xml", LAUGHS.encode("utf-16"))), "declares a document type"),
    "no XML": (zipped(("content.xml", "<a><b></a>")), "content.xml is not XML"),
    "cut zip": (open_document(ROWS)[:-30], "is no workbook"),
    "far column": (office([], sheet='<row r="1"><c r="XFD1"><v>1</v></c></row>'), "row 1 has more than 1,000 columns"),
    "far row": (office([], sheet='<row r="99999999"><c><v>1</v></c></row>'), "'99999999' is not a number of rows"),
    "text out of range": (office([], sheet='<row><c t="s"><v>7</v></c></row>'), "names text 7, and there are 0"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_list_is_refused_in_one_line(tmp_path, name):
    content, words = HOSTILE[name]
    path = tmp_path / "list.csv"
    path.write_bytes(content)
    begun = time.process_time()
    with pytest.raises(DesignError) as raised:
        read_parts(path)
    assert words in str(raised.value)
    assert str(raised.value).startswith(f"{path}: ")
    assert len(str(raised.value).splitlines()) == 1
    assert time.process_time() - begun < 5


def test_a_hundred_megabytes_are_not_read(tmp_path):
    path = tmp_path / "list.csv"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    with pytest.raises(DesignError, match="is more than 20 MB"):
        read_parts(path)


def test_a_zip_bomb_is_unpacked_to_a_bound(tmp_path, monkeypatch):
    monkeypatch.setattr(spreadsheets, "MAX_UNPACKED", 1_000_000)
    path = tmp_path / "list.ods"
    path.write_bytes(open_document([["Reference", "Value"], ["C1", "x" * 2_000_000]]))
    with pytest.raises(DesignError, match=r"content.xml unpacks to more than 1 MB"):
        read_parts(path)


@pytest.mark.parametrize(("columns", "rows", "words"), [(10**9, 1, "1,000 columns"), (1, 10**9, "100,000 rows")])
def test_repeated_cells_are_not_written_out_beyond_a_bound(tmp_path, columns, rows, words):
    cell = f'<table:table-cell table:number-columns-repeated="{columns}"><text:p>a</text:p></table:table-cell>'
    row = f'<table:table-row table:number-rows-repeated="{rows}">{cell}</table:table-row>'
    path = tmp_path / "list.ods"
    path.write_bytes(open_document([], row))
    with pytest.raises(DesignError, match=words):
        read_parts(path)


def test_archives_with_bytes_changed_are_read_or_refused(tmp_path):
    draw, refused = random.Random(3), []
    path = tmp_path / "list"
    for whole in (office(ROWS), open_document(ROWS)):
        for _ in range(150):
            content = bytearray(whole)
            for _ in range(draw.randrange(1, 6)):
                content[draw.randrange(len(content))] = draw.randrange(256)
            path.write_bytes(content)
            try:
                read_parts(path)
            except DesignError as error:
                refused.append(str(error).startswith(str(path)))
    assert all(refused)
    assert len(refused) > 10


def test_a_missing_file_and_a_folder(tmp_path):
    (tmp_path / "parts.csv").write_text("x")
    with pytest.raises(DesignError, match=r"no such file; did you mean 'parts.csv'"):
        read_parts(tmp_path / "part.csv")
    with pytest.raises(DesignError, match="cannot be read"):
        read_parts(tmp_path)


def test_a_mapping_file_is_written_and_read(tmp_path):
    path, saved = tmp_path / "list.csv", tmp_path / "map.yaml"
    path.write_text('Wo;"Was: #1";Wieviel\nC1;0,1 µF Kerko;1\n', encoding="utf-8")
    with pytest.raises(DesignError, match="say which columns they are in a mapping file"):
        read_table(path)
    saved.write_text("schema_version: 1\ncolumns: {reference: Wo, value: 'Was: #1', quantity: wieviel}\n")
    read = read_table(path, parse_mapping(saved))
    assert [(column.field, column.confidence) for column in read.columns] == [
        ("reference", 1),
        ("value", 1),
        ("quantity", 1),
    ]
    saved.write_text(mapping_text(read))
    assert read_table(path, parse_mapping(saved)) == read


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("columns: {}", "map.yaml:1: schema_version: not stated; expected 1"),
        (
            "schema_version: 1\ncolumns: {valeu: a}",
            "map.yaml:2: columns/valeu: unknown field 'valeu'; did you mean 'value'",
        ),
        ("schema_version: 1\ncolumns: 3", "expected what each column means"),
        ("schema_version: 1\ncolumns: {value: [a]}", "expected the header of a column"),
        ("schema_version: 1\ncolumns: {}\ndecimal: x", "map.yaml:3: decimal: 'x'; expected ',' or '.'"),
        ("schema_version: 1\ncolumn: {}", "unknown key 'column'; did you mean 'columns'"),
    ],
)
def test_wrong_mappings(tmp_path, text, words):
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(DesignError) as raised:
        parse_mapping(tmp_path / "map.yaml")
    assert words in str(raised.value)


def collated(tmp_path, last):
    """A list that names each part alone, and then, below its header again, all of a kind together."""
    head = '"Item","Qty","Reference(s)","Value","ManufacturerPartNum"\n'
    alone = '"","","C1","100n",""\n"","","C2","100n",""\n"","","R1","10k","RC0402FR-0710KL"\n'
    path = tmp_path / "collated.csv"
    path.write_text(f'"Component Count:","3"\n\n{head}{alone}\n"Collated Components:"\n\n{head}{last}')
    return read_parts(path)


def test_a_list_that_tells_its_parts_twice_counts_them_once(tmp_path):
    found = collated(tmp_path, '"1","2","C1, C2","100n",""\n"2","1","R1","10k","RC0402FR-0710KL"\n')
    assert [(part.references, part.quantity) for part in found.parts] == [(("C1", "C2"), 2), (("R1",), 1)]
    assert found.parts[1].described.part_number == "RC0402FR-0710KL"
    assert any("name the same parts" in note.text for note in found.left_out)
    assert not found.notes


def test_a_second_list_of_other_parts_is_read_too(tmp_path):
    found = collated(tmp_path, '"1","2","C1, C3","100n",""\n')
    assert sum(part.quantity for part in found.parts) == 5
    assert any("C1 stands in rows" in note.text for note in found.notes)


@pytest.mark.parametrize("header", ["manf#", "Mfr #", "ManufacturerPartNum", "Manufacturer_Part_Num", "MfrPartNumber"])
def test_headers_of_part_numbers(tmp_path, header):
    (tmp_path / "list.csv").write_text(f"Reference,Value,{header},Manufacturer\nR1,10k,RC0402FR-0710KL,Yageo\n")
    (part,) = read_parts(tmp_path / "list.csv").parts
    assert part.described.part_number == "RC0402FR-0710KL"
