"""The scene in another place: its mirror image, x to LENGTH - x, or shifted, with the same done to its mesh. The answers have to be those of the scene."""

import pathlib
import re
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
LENGTH = 1605.0  # m, from end to end, so that the water of the scene spans both


def write(talus, folder, size):
    """Writes the mirror image and its mesh in cells of `size` [m]; returns the scene's file."""
    return placed(talus, folder, size, "mirrored", lambda x, y: (LENGTH - x, y), turned=True)


def write_shifted(talus, folder, size, right, up):
    """Writes the scene and its mesh in cells of `size` [m], moved to the right and upwards [m]: nodes differ by round-off alone. Returns the scene's file."""
    return placed(talus, folder, size, f"shifted_{right:g}_{up:g}", lambda x, y: (x + right, y + up))


def placed(talus, folder, size, name, place, turned=False):
    drawn, mesh, scene = (pathlib.Path(folder) / file for file in (f"{name}_drawn.msh", f"{name}.msh", f"{name}.toml"))
    subprocess.run([talus, "mesh", HERE.parents[2] / "meshes/vaiont.csv", "--size", str(size), "--format", "2.2", "-o", drawn],
                   stdout=subprocess.DEVNULL, check=True)
    section, lines = "", []
    for line in drawn.read_text().splitlines():
        parts = line.split()
        if line.startswith("$"):
            section = line
        elif section == "$Nodes" and len(parts) == 4:
            x, y = place(float(parts[1]), float(parts[2]))
            line = f"{parts[0]} {x!r} {y!r} {parts[3]}"
        elif section == "$Elements" and len(parts) > 1 and turned:  # nodes keep their sense of rotation
            tags = 3 + int(parts[2])
            line = " ".join(parts[:tags] + parts[:tags - 1:-1])
        lines.append(line)
    mesh.write_text("\n".join(lines) + "\n")

    def at_its_place(match):
        return "[{:.10g}, {:.10g}]".format(*place(float(match[1]), float(match[2])))
    text = re.sub(r'^section = .*\nsize = .*$', f'file = "{mesh}"', (HERE / "scene.toml").read_text(), flags=re.M)
    keys = "points|position" if turned else "points|position|table"  # the water of the scene is its own mirror image
    text = re.sub(rf"^(?:{keys}) = .*$", lambda line: re.sub(r"\[(-?[\d.]+), (-?[\d.]+)\]", at_its_place, line[0]), text, flags=re.M)
    scene.write_text(text)
    return scene
