"""Fails unless the loops over points are vector code: in the machine code of each law's update_stress (2D and 3D) more arithmetic must
be done on packed numbers than on single ones. What stays single is prepare(), once per call. Laws that go point by point are left out.
vector_code.py OBJECT..."""

import re
import subprocess
import sys

arithmetic = re.compile(r"^\s+[0-9a-f]+:\s+v?\w*(?:add|sub|mul|div|sqrt|max|min)\w*(pd|sd)\b")
# a law's loop stands alone, or inside of the choice between its cases
loop = re.compile(r"correct_all<true|as_case<.*update_stress<|as_caseI.*13update_stressI")
one_by_one = re.compile(r"Umat, talus::StressPoints|HoekBrown")
scalar, found = [], 0
for path in sys.argv[1:]:
    text = subprocess.run(["objdump", "-d", "-C", "--no-show-raw-insn", path], check=True, capture_output=True, text=True).stdout
    for block in re.split(r"\n\n", text):
        head, _, body = block.strip().partition("\n")
        if not head.endswith(">:") or not loop.search(head) or one_by_one.search(head):
            continue
        kinds = [m.group(1) for m in map(arithmetic.match, body.splitlines()) if m]
        packed, single = kinds.count("pd"), kinds.count("sd")
        found += 1
        print(f"{packed:5d} packed {single:5d} single  {head[18:150]}")
        if packed <= single:
            scalar.append(head)
if found < 20:
    sys.exit(f"only {found} loops found: the names have changed")
if scalar:
    sys.exit("scalar code in\n" + "\n".join(scalar))
