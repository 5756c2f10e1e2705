"""The mirror image of the scene, x to LENGTH - x, with that of the mesh: its answers have to be those of the scene."""

import pathlib
import re
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
LENGTH = 1605.0  # m, from end to end, so that the water of the scene spans both


def write(talus, folder, size):
    """Writes the scene and its mesh in cells of `size` [m]; returns the scene's file."""
    drawn, mesh, scene = (pathlib.Path(folder) / name for name in ("drawn.msh", "mirrored.msh", "mirrored.toml"))
    subprocess.run([talus, "mesh", HERE.parents[2] / "meshes/vaiont.csv", "--size", str(size), "--format", "2.2", "-o", drawn],
                   stdout=subprocess.DEVNULL, check=True)
    section, lines = "", []
    for line in drawn.read_text().splitlines():
        parts = line.split()
        if line.startswith("$"):
            section = line
        elif section == "$Nodes" and len(parts) == 4:
            line = f"{parts[0]} {LENGTH - float(parts[1])!r} {parts[2]} {parts[3]}"
        elif section == "$Elements" and len(parts) > 1:  # nodes keep their sense of rotation
            tags = 3 + int(parts[2])
            line = " ".join(parts[:tags] + parts[:tags - 1:-1])
        lines.append(line)
    mesh.write_text("\n".join(lines) + "\n")

    def turned(match):
        return f"[{LENGTH - float(match[1]):.10g}, "
    text = re.sub(r'^section = .*\nsize = .*$', f'file = "{mesh}"', (HERE / "scene.toml").read_text(), flags=re.M)
    text = re.sub(r"^(?:points|position) = .*$", lambda line: re.sub(r"\[(-?[\d.]+), ", turned, line[0]), text, flags=re.M)
    scene.write_text(text)
    return scene
