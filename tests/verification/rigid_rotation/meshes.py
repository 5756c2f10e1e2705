"""Writes core.msh and core3d.msh: a square or cube of soil (core) in a larger one of free space (rim), so coarse that every node lies on one of the two.

python3 meshes.py
"""
import itertools
from pathlib import Path


def cell_of(corners):
    """Simplices that fill a convex cell given as a list of faces (tuples of nodes in cyclic order), fanned from its smallest node."""
    apex = min(min(face) for face in corners)
    for face in corners:
        if apex in face:
            continue
        start = face.index(min(face))
        ring = face[start:] + face[:start]
        for b, c in zip(ring[1:], ring[2:]):
            yield (apex, ring[0], b, c)


def triangles_of(face):
    start = face.index(min(face))
    ring = face[start:] + face[:start]
    return [(ring[0], b, c) for b, c in zip(ring[1:], ring[2:])]


def volume(points):
    a, *others = points
    m = [[q - p for p, q in zip(a, other)] for other in others]
    if len(m) == 2:
        return m[0][0] * m[1][1] - m[0][1] * m[1][0]
    return sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))


def write(name, nodes, facets, cells, dimension):
    groups = [(dimension - 1, 1, "core_face"), (dimension - 1, 2, "rim_face"), (dimension, 3, "core"), (dimension, 4, "rim")]
    kind = {2: 1, 3: 2, 4: 4}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    lines += [f'{d} {tag} "{text}"' for d, tag, text in groups]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{i + 1} {' '.join(str(x) for x in (*p, 0)[:3])}" for i, p in enumerate(nodes)]
    elements = [(tag, f) for tag, f in facets] + [(tag, c) for tag, c in cells]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    for number, (tag, element) in enumerate(elements, 1):
        if len(element) == dimension + 1 and volume([nodes[i] for i in element]) < 0:
            element = (element[1], element[0], *element[2:])
        lines.append(f"{number} {kind[len(element)]} 2 {tag} {tag} " + " ".join(str(i + 1) for i in element))
    lines.append("$EndElements")
    (Path(__file__).parent / name).write_text("\n".join(lines) + "\n")


square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
nodes = [(0.5 * x, 0.5 * y) for x, y in square] + [(2 * x, 2 * y) for x, y in square]
sides = [(i, (i + 1) % 4) for i in range(4)]
cells = [(3, t) for t in triangles_of((0, 1, 2, 3))]
for a, b in sides:
    cells += [(4, t) for t in triangles_of((a, b, b + 4, a + 4))]
facets = [(1, s) for s in sides] + [(2, (a + 4, b + 4)) for a, b in sides]
write("core.msh", nodes, facets, cells, 2)

corners = list(itertools.product((-1, 1), repeat=3))
nodes = [tuple(0.5 * x for x in p) for p in corners] + [tuple(2 * x for x in p) for p in corners]
number = {p: i for i, p in enumerate(corners)}
faces = []
for axis in range(3):
    for side in (-1, 1):
        ring = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        faces.append(tuple(number[tuple([*p[:axis], side, *p[axis:]])] for p in ring))
cells = [(3, t) for t in cell_of(faces)]
for face in faces:
    outer = tuple(i + 8 for i in face)
    walls = [(face[k], face[(k + 1) % 4], outer[(k + 1) % 4], outer[k]) for k in range(4)]
    cells += [(4, t) for t in cell_of([face, outer, *walls])]
facets = [(1, t) for face in faces for t in triangles_of(face)] + [(2, tuple(i + 8 for i in t)) for face in faces for t in triangles_of(face)]
write("core3d.msh", nodes, facets, cells, 3)
