"""Tables as a workbook (.xlsx), which is a few small XML files in a zip file."""

import math
import zipfile
from html import escape

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006/"
SHEET = "application/vnd.openxmlformats-officedocument.spreadsheetml."
HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'


def cell(value):
    """A number, or a text; empty where there is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return f'<c t="inlineStr"><is><t xml:space="preserve">{escape(str(value))}</t></is></c>' if value not in (None, "") else "<c/>"
    return f"<c><v>{value!r}</v></c>" if math.isfinite(value) else "<c/>"


def write_workbook(path, tables):
    """`tables` {name of the sheet: rows}, the first row of each with the names of its columns. Returns the path."""
    numbers = range(1, len(tables) + 1)
    relation = lambda to, kind, number: f'<Relationship Id="r{number}" Type="{OFFICE}/{kind}" Target="{to}"/>'
    about = {
        "[Content_Types].xml": f'<Types xmlns="{PACKAGE}content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                               f'<Override PartName="/xl/workbook.xml" ContentType="{SHEET}sheet.main+xml"/>'
                               + "".join(f'<Override PartName="/xl/worksheets/sheet{k}.xml" ContentType="{SHEET}worksheet+xml"/>' for k in numbers) + "</Types>",
        "_rels/.rels": f'<Relationships xmlns="{PACKAGE}relationships">{relation("xl/workbook.xml", "officeDocument", 1)}</Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>'
                           + "".join(f'<sheet name="{escape(name[:31])}" sheetId="{k}" r:id="r{k}"/>' for k, name in zip(numbers, tables)) + "</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{PACKAGE}relationships">' + "".join(relation(f"worksheets/sheet{k}.xml", "worksheet", k) for k in numbers)
                                      + "</Relationships>"}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as book:
        for name, text in about.items():
            book.writestr(name, HEAD + text)
        for k, rows in zip(numbers, tables.values()):
            lines = "".join(f"<row>{''.join(map(cell, row))}</row>" for row in rows)
            book.writestr(f"xl/worksheets/sheet{k}.xml", f'{HEAD}<worksheet xmlns="{MAIN}"><sheetData>{lines}</sheetData></worksheet>')
    return path
