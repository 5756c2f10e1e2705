#!/usr/bin/python3
"""Draws architecture.png: the libraries and programs of Talus and who links whom, read from the CMakeLists.txt files.

    docs/architecture.py            # writes docs/architecture.png
    docs/architecture.py --check    # status 1 if the picture shows another structure than the CMakeLists.txt files

An arrow from A to B means that A uses B. A link that follows from others is left out. The comment above add_library describes
the library.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs" / "architecture.png"
HIDDEN = {"talus_flags", "talus_precompiled"}  # compiler flags and headers of other libraries, which every library has


def read_targets():
    """Name -> (folder, description, set of linked targets) of the libraries and programs outside of tests."""
    targets = {}
    for file in sorted(ROOT.rglob("CMakeLists.txt")):
        folder = file.parent.relative_to(ROOT)
        if folder.parts and folder.parts[0] in ("build", "tests"):
            continue
        text = file.read_text()
        for match in re.finditer(r"((?:^#[^\n]*\n)*)^add_(library|executable)\((\S+)", text, re.M):
            comment = " ".join(line.lstrip("# ") for line in match.group(1).splitlines())
            targets[match.group(3)] = (str(folder), comment, match.group(2), set())
        for match in re.finditer(r"target_link_libraries\((\S+)([^)]*)\)", text):
            if match.group(1) in targets:
                targets[match.group(1)][3].update(match.group(2).split())
    targets = {name: t for name, t in targets.items() if name not in HIDDEN}
    for _, _, _, links in targets.values():
        links.intersection_update(targets)
    return targets


def reachable(targets, name):
    found = set()
    for other in targets[name][3]:
        found |= {other} | reachable(targets, other)
    return found


def direct_links(targets):
    """Links that do not follow from others."""
    links = set()
    for name in targets:
        through = set().union(*(reachable(targets, other) for other in targets[name][3])) if targets[name][3] else set()
        links |= {(name, other) for other in targets[name][3] - through}
    return links


def levels(targets):
    """Row of each target: one above the highest that it links."""
    row = {}

    def place(name):
        if name not in row:
            row[name] = 1 + max((place(other) for other in targets[name][3]), default=-1)
        return row[name]

    for name in targets:
        place(name)
    return row


def structure(targets):
    """Names, folders and links in one line, which is stored in the picture."""
    return "; ".join(sorted(f"{name} in {t[0]} -> {' '.join(sorted(t[3]))}" for name, t in targets.items()))


def wrapped(text, width):
    lines, line = [], ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return lines + [line] if line else lines


WIDTH, HEIGHT, GAP, LANE, ROW = 2.75, 1.02, 0.35, 0.3, 1.42  # of boxes, between boxes, of a passing arrow, between rows


def laid_out(targets):
    """Places: box or lane -> (x, row), and the links as chains of boxes and lanes. A lane (user, used, row) lets a link pass a row."""
    row = levels(targets)
    chains = []
    for user, used in sorted(direct_links(targets)):
        chains.append([user] + [(user, used, r) for r in range(row[user] - 1, row[used], -1)] + [used])
    rows = [[name for name in sorted(targets) if row[name] == r] for r in range(max(row.values()) + 1)]
    for chain in chains:
        for lane in chain[1:-1]:
            rows[lane[2]].append(lane)
    neighbours = {}
    for chain in chains:
        for upper, lower in zip(chain, chain[1:]):
            neighbours.setdefault(upper, []).append(lower)
            neighbours.setdefault(lower, []).append(upper)
    size = {node: WIDTH if node in targets else LANE for names in rows for node in names}
    x = {node: 0. for node in size}

    def pack(names):
        """Keeps the order and the distances of a row, and its mean where it wants to be."""
        wanted = [x[node] for node in names]
        at = wanted[0]
        for i, node in enumerate(names):
            if i > 0:
                at = max(wanted[i], at + (size[names[i - 1]] + size[node]) / 2 + GAP)
            x[node] = at
        shift = sum(wanted) / len(names) - sum(x[node] for node in names) / len(names)
        for node in names:
            x[node] += shift

    for sweep in range(40):
        for names in rows if sweep % 2 else reversed(rows):
            for node in names:
                near = neighbours.get(node, [])
                if near:
                    x[node] = sum(x[other] for other in near) / len(near)
            names.sort(key=lambda node: (x[node], str(node)))
            pack(names)
    return {node: (x[node], r) for r, names in enumerate(rows) for node in names}, chains


def draw(targets):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    places, chains = laid_out(targets)
    low = min(x for x, _ in places.values()) - WIDTH / 2 - 0.1
    high = max(x for x, _ in places.values()) + WIDTH / 2 + 0.1
    top = (max(r for _, r in places.values())) * ROW + HEIGHT / 2 + 0.1
    figure, axes = pyplot.subplots(figsize=(high - low, 0.9 * (top + HEIGHT / 2 + 0.1)))
    spread = {}
    for chain in chains:
        spread.setdefault(("from", chain[0]), []).append(chain)
        spread.setdefault(("to", chain[-1]), []).append(chain)

    def port(side, node, chain):
        """Ends of arrows share the side of a box, in the order of their other ends."""
        other = 1 if side == "from" else -2
        order = sorted(spread[side, node], key=lambda c: places[c[other]][0])
        return places[node][0] + WIDTH * 0.8 * ((order.index(chain) + 1) / (len(order) + 1) - 0.5)

    for chain in chains:
        points = [(port("from", chain[0], chain), places[chain[0]][1] * ROW - HEIGHT / 2)]
        for lane in chain[1:-1]:
            x, r = places[lane]
            points += [(x, r * ROW + HEIGHT / 2), (x, r * ROW - HEIGHT / 2)]
        end = (port("to", chain[-1], chain), places[chain[-1]][1] * ROW + HEIGHT / 2)
        axes.plot(*zip(*points, end), color="#666666", linewidth=1.1, zorder=1)
        axes.annotate("", end, points[-1], zorder=1,
                      arrowprops=dict(arrowstyle="-|>", color="#666666", linewidth=1.1, shrinkA=0, shrinkB=0))
    for name, (folder, comment, kind, _) in targets.items():
        x, y = places[name][0], places[name][1] * ROW
        axes.add_patch(pyplot.Rectangle((x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, zorder=2, linewidth=1,
                                        facecolor="#fdf1dc" if kind == "executable" else "#e8eff7", edgecolor="#33475b"))
        axes.text(x, y + 0.34, name, ha="center", va="center", fontsize=10, weight="bold", zorder=3)
        axes.text(x, y + 0.15, folder, ha="center", va="center", fontsize=8, color="#33475b", family="monospace", zorder=3)
        for i, line in enumerate(wrapped(comment.rstrip("."), 44)[:3]):
            axes.text(x, y - 0.05 - 0.17 * i, line, ha="center", va="center", fontsize=7.5, zorder=3)
    axes.set_xlim(low, high)
    axes.set_ylim(-HEIGHT / 2 - 0.1, top)
    axes.set_axis_off()
    figure.tight_layout(pad=0.2)
    figure.savefig(PICTURE, dpi=100, metadata={"Description": structure(targets)})


def drawn_structure():
    """The structure that the picture carries in a text chunk of the PNG file."""
    data, at = PICTURE.read_bytes(), 8
    while at < len(data):
        length = int.from_bytes(data[at:at + 4], "big")
        kind, content = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        if kind == b"tEXt" and content.startswith(b"Description\0"):
            return content.split(b"\0", 1)[1].decode("latin-1")
        at += 12 + length
    return ""


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        if drawn_structure() != structure(read_targets()):
            sys.exit("docs/architecture.png shows another structure than the CMakeLists.txt files; run docs/architecture.py")
    else:
        draw(read_targets())
