#!/usr/bin/env python3
"""Runs the notebooks beside a server and puts every picture that they draw on one sheet.

Usage: SKYGLOW_URL=http://127.0.0.1:8080 python python/notebooks/contact_sheet.py docs/notebooks.png [FOLDER], with what
`python/requirements-test.txt` has; FOLDER gets each picture by itself.
"""

import base64
import io
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from PIL import Image, ImageDraw, ImageFont

WIDE, GAP, HEAD = 1500, 18, 44
# Of a row: pixels, and widths over height.
MOST_HIGH, MOST_WIDE = 380, 5.6
HERE = Path(__file__).parent


def pictures(path):
    """The pictures of a notebook, in order."""
    book = nbformat.read(path, as_version=4)
    NotebookClient(book, timeout=600, kernel_name="python3", resources={"metadata": {"path": HERE}}).execute()
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    drawn = [output["data"]["image/png"] for output in outputs if "image/png" in output.get("data", {})]
    return [Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB") for data in drawn]


def rows(given):
    """Pictures side by side over the whole width; what is left is as high as the row before."""
    row, high = [], MOST_HIGH
    for picture in [*given, None]:
        aspects = [each.width / each.height for each in row]
        if picture is None or sum(aspects) + picture.width / picture.height > MOST_WIDE:
            fills = (WIDE - GAP * (len(row) + 1)) / sum(aspects)
            high = round(min(fills, high))
            yield [each.resize((round(high * aspect), high), Image.Resampling.LANCZOS) for each, aspect in zip(row, aspects)]
            row = []
        row.append(picture)


def main():
    out, folder = sys.argv[1], Path(sys.argv[2]) if len(sys.argv) > 2 else None
    books = {path.stem: pictures(path) for path in sorted(HERE.glob("*.ipynb"))}
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        for name, drawn in books.items():
            for number, picture in enumerate(drawn, 1):
                picture.save(folder / f"{name}-{number}.png")
    laid = {name: list(rows(drawn)) for name, drawn in books.items()}
    high = sum(HEAD + sum(line[0].height + GAP for line in lines) for lines in laid.values()) + GAP
    sheet = Image.new("RGB", (WIDE, high), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(22)
    y = GAP
    for name, lines in laid.items():
        draw.text((GAP, y), name.capitalize(), fill="black", font=font)
        y += HEAD
        for line in lines:
            x = GAP
            for picture in line:
                sheet.paste(picture, (x, y))
                x += picture.width + GAP
            y += line[0].height + GAP
    sheet.quantize(256).save(out, optimize=True)


main()
