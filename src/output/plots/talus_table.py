"""Tables of outcomes as commands print them: no wider than the terminal."""

import shutil
import textwrap

WIDE = 10**6  # where there is no terminal: lines of a file are not folded [characters]
BETWEEN = "  "  # columns
LEAST = 7  # width at which headings are folded, where the values are no wider


def terminal():
    """Width of the terminal to which the program prints."""
    return shutil.get_terminal_size((WIDE, 24)).columns


def lines_of(headings, rows, keys=1, width=None):
    """Lines of a table: `rows` are texts, or a row's texts for the first `keys` columns and one sentence in place of the others. Headings are folded;
    columns that have no room are another table below, which repeats the first `keys` columns. Numbers and their headings stand to the right."""
    width = width or terminal()
    whole = [row for row in rows if len(row) == len(headings)]
    folded, sizes = [], []
    for k, heading in enumerate(headings):
        widest = max((len(row[k]) for row in (rows if k < keys else whole)), default=0)
        folded.append(textwrap.wrap(heading, max(widest, LEAST, len(heading) // 3), break_long_words=False, break_on_hyphens=False) or [""])
        sizes.append(max(widest, *map(len, folded[-1])))
    lines = []
    for columns in fitting(sizes, keys, width):
        tall = max(len(folded[k]) for k in columns)
        block = [[([""] * (tall - len(folded[k])) + folded[k])[line] for k in columns] for line in range(tall)]
        texts = [row_of(cells, [sizes[k] for k in columns]) for cells in block]
        for row in rows:
            if len(row) == len(headings):
                texts.append(row_of([row[k] for k in columns], [sizes[k] for k in columns]))
            elif not lines:
                texts += sentence(row_of(row[:keys], sizes[:keys]) + BETWEEN, row[keys], width)
        lines += [""] * bool(lines) + texts
    return lines


def row_of(cells, sizes):
    return BETWEEN.join(cell.rjust(size) for cell, size in zip(cells, sizes)).rstrip()


def sentence(before, text, width):
    """A sentence behind the first columns of its row, folded."""
    return textwrap.wrap(text, max(width, len(before) + 40), initial_indent=before, subsequent_indent=" " * len(before))


def fitting(sizes, keys, width):
    """Numbers of the columns of each block: the first `keys`, and others as far as they have room."""
    first = list(range(keys))
    blocks, used = [], width
    taken = sum(sizes[k] + len(BETWEEN) for k in first)
    for k in range(keys, len(sizes)):
        if used + len(BETWEEN) + sizes[k] > width:
            blocks.append(list(first))
            used = taken - len(BETWEEN)
        blocks[-1].append(k)
        used += len(BETWEEN) + sizes[k]
    return blocks or [first]


def folded(text, width=None):
    """A sentence in lines that fit into the terminal."""
    return textwrap.fill(text, width or terminal(), break_long_words=False, break_on_hyphens=False)
