#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Input file of CalculiX (ccx) for the cylinder upsetting of benchmarks/peers.py.

    calculix.py FILE.inp --cells 16 --step 0.25 --material plastic|rate|hardening --friction none|coulomb|sticking

Upper half of the meridian section, 25 x 25 mm, graded towards the edge of the platen, CAX8R or CAX8 elements, large
strains (NLGEOM). Elastic-plastic (*PLASTIC) or elastic-viscoplastic by *CREEP (Norton, in a *VISCO step). Elasticity
is high enough that its share of the force is below the errors looked at.

- none: the platen is a boundary condition; the surface stays flat and nothing folds.
- sticking: the end is a boundary condition in both directions; the side can fold on to a rigid platen, contact with a
  friction coefficient beyond all need.
- coulomb: the end and the side are in contact with the platen.
"""
import argparse


def places(cells, length, grading):
    """Corners of graded cells, the last one the smallest."""
    ratio = grading ** (-1.0 / (cells - 1)) if cells > 1 else 1.0
    sizes = [ratio**i for i in range(cells)]
    at, out = 0.0, [0.0]
    for size in sizes:
        at += size * length / sum(sizes)
        out.append(at)
    out[-1] = length
    return out


def with_middles(corners):
    out = [corners[0]]
    for a, b in zip(corners, corners[1:]):
        out += [0.5 * (a + b), b]
    return out


def table(rows, per_line=8):
    """Numbers of a set, as lines of at most per_line."""
    return "\n".join(", ".join(str(x) for x in rows[i : i + per_line]) for i in range(0, len(rows), per_line))


def deck(o):
    n = o.cells
    place = with_middles(places(n, 25.0, o.grading))
    number, nodes, top, axis, bottom = {}, [], [], [], []
    for j, z in enumerate(place):
        for i, r in enumerate(place):
            if i % 2 and j % 2:
                continue  # eight nodes: no centre
            k = len(nodes) + 1
            number[i, j] = k
            nodes.append(f"{k}, {r:.12g}, {z:.12g}, 0")
            if j == 2 * n:
                top.append(k)
            if i == 0:
                axis.append(k)
            if j == 0:
                bottom.append(k)
    elements, end_faces, side_faces = [], [], []
    for j in range(n):
        for i in range(n):
            e = len(elements) + 1
            a, b = 2 * i, 2 * j
            ring = [(a, b), (a + 2, b), (a + 2, b + 2), (a, b + 2), (a + 1, b), (a + 2, b + 1), (a + 1, b + 2), (a, b + 1)]
            elements.append(f"{e}, " + ", ".join(str(number[k]) for k in ring))
            if j == n - 1:
                end_faces.append(f"{e}, S3")
            if i == n - 1:
                side_faces.append(f"{e}, S2")
    text = ["*HEADING", "cylinder upsetting", "*NODE, NSET=ALL", *nodes]
    text += [f"*ELEMENT, TYPE={o.element}, ELSET=WORKPIECE", *elements]
    text += ["*NSET, NSET=TOP", table(top), "*NSET, NSET=AXIS", table(axis), "*NSET, NSET=BOTTOM", table(bottom)]
    text += ["*NSET, NSET=SIDE", table([number[2 * n, j] for j in range(2 * n + 1)])]
    contact = o.friction != "none"
    if contact:
        # The platen: one layer of cells whose nodes are all prescribed
        first, count = len(nodes) + 1, o.platen_cells
        low = [(o.platen_from + (45.0 - o.platen_from) * i / count, 25.0) for i in range(count + 1)]
        text.append("*NODE, NSET=PLATEN")
        for i, (r, z) in enumerate(low):
            text.append(f"{first + i}, {r:.12g}, {z:.12g}, 0")
            text.append(f"{first + count + 1 + i}, {r:.12g}, {z + 5:.12g}, 0")
        text.append("*ELEMENT, TYPE=CAX4, ELSET=TOOL")
        e = len(elements)
        for i in range(count):
            e += 1
            up = first + count + 1
            text.append(f"{e}, {first + i}, {first + i + 1}, {up + i + 1}, {up + i}")
        text += ["*SURFACE, NAME=MASTER, TYPE=ELEMENT", *[f"{len(elements) + 1 + i}, S1" for i in range(count)]]
        faces = side_faces[n - o.side_cells if o.side_cells else 0 :]
        text += ["*SURFACE, NAME=SLAVE, TYPE=ELEMENT", *faces]
        if o.friction == "coulomb":
            text += end_faces
        text += ["*CONTACT PAIR, INTERACTION=PLATEN, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"]
        text += ["*SURFACE INTERACTION, NAME=PLATEN", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{o.stiffness:g}"]
        coefficient = o.coefficient if o.friction == "coulomb" else o.stick_coefficient
        text += ["*FRICTION", f"{coefficient:g}, {o.stick_slope:g}"]
    text += ["*MATERIAL, NAME=METAL", "*ELASTIC", f"{o.young:g}, {o.poisson:g}"]
    if o.material == "plastic":
        text += ["*PLASTIC", "100, 0", "100, 10"]
    elif o.material == "hardening":
        text.append("*PLASTIC")
        strain = 0.0
        while strain < 8:  # linear in between: off by less than 1e-4
            text.append(f"{100 * (0.01 + strain) ** 0.2:.8g}, {strain:.8g}")
            strain = (0.01 + strain) * 1.05 - 0.01 if strain else 0.0005
    else:
        # sigma = 100 (rate / 0.01)^0.2: rate = 0.01 / 100^5 sigma^5
        text += ["*CREEP, LAW=NORTON", f"{0.01 / 100.0**5:g}, 5, 0"]
    text += ["*SOLID SECTION, ELSET=WORKPIECE, MATERIAL=METAL"]
    if contact:
        text += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{o.young:g}, {o.poisson:g}", "*SOLID SECTION, ELSET=TOOL, MATERIAL=STEEL"]
    text += ["*BOUNDARY", "AXIS, 1, 1", "BOTTOM, 2, 2"]
    if contact:
        text.append("PLATEN, 1, 1")
    if o.friction == "sticking":
        text.append("TOP, 1, 1")
    # A *VISCO step applies its loads at once unless an amplitude says otherwise.
    text += ["*AMPLITUDE, NAME=RAMP", f"0, 0, {o.stroke / 0.25:g}, 1"]
    text += ["*STEP, NLGEOM, INC=100000"]
    solver = f", SOLVER={o.solver}" if o.solver else ""
    if o.material == "rate":
        text.append(f"*VISCO, CETOL={o.cetol:g}{', DIRECT' if o.direct else ''}{solver}")
    else:
        text.append(f"*STATIC{', DIRECT' if o.direct else ''}{solver}")
    step = o.step / 0.25
    text.append(f"{o.first_step * step:g}, {o.stroke / 0.25:g}, {1e-6 * step:g}, {step:g}")
    text += ["*BOUNDARY, AMPLITUDE=RAMP"]
    moved = ([] if o.friction == "coulomb" else ["TOP"]) + (["PLATEN"] if contact else [])
    text += [f"{name}, 2, 2, {-o.stroke:g}" for name in moved]
    text += ["*CONTROLS, PARAMETERS=FIELD", o.controls] if o.controls else []
    for name in moved:
        text += [f"*NODE PRINT, NSET={name}, TOTALS=ONLY", "RF"]
    text += ["*NODE PRINT, NSET=SIDE", "U", "*END STEP"]
    return "\n".join(text) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--cells", type=int, default=16)
    parser.add_argument("--grading", type=float, default=4.0)
    parser.add_argument("--step", type=float, default=0.25)
    parser.add_argument("--first-step", type=float, default=1.0)
    parser.add_argument("--stroke", type=float, default=10.0)
    parser.add_argument("--element", default="CAX8R")
    parser.add_argument("--material", default="plastic", choices=["plastic", "rate", "hardening"])
    parser.add_argument("--friction", default="sticking", choices=["none", "coulomb", "sticking"])
    parser.add_argument("--coefficient", type=float, default=0.17)
    parser.add_argument("--stick-coefficient", type=float, default=2.0)
    parser.add_argument("--stick-slope", type=float, default=1e4)
    parser.add_argument("--stiffness", type=float, default=1e5)
    parser.add_argument("--platen-cells", type=int, default=9)
    parser.add_argument("--platen-from", type=float, default=0.05)
    parser.add_argument("--side-cells", type=int, default=0)
    parser.add_argument("--young", type=float, default=1e5)
    parser.add_argument("--poisson", type=float, default=0.3)
    parser.add_argument("--cetol", type=float, default=1e-2)
    parser.add_argument("--direct", action="store_true")
    parser.add_argument("--solver", default="")
    parser.add_argument("--controls", default="")
    o = parser.parse_args()
    with open(o.file, "w") as file:
        file.write(deck(o))


if __name__ == "__main__":
    main()
