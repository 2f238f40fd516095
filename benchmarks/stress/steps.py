# SPDX-License-Identifier: GPL-2.0-or-later
"""Steps of 0.1 % to 10 % of the height."""
from scenes import HARDENING, MATERIALS, cylinder, shear, smm
from tables import Table

TITLE = "Steps of 0.1 % to 10 % of the height"
SIZES = [0.001, 0.002, 0.005, 0.01, 0.02, 0.04, 0.05, 0.1]
FRICTION = {"none": {"Law": "none"}, "shear 0.3": shear(0.3), "smm 0.5": smm(0.5), "sticking": {"Law": "sticking"}}


def run(session):
    program = session.program
    sizes = (0.01, 0.1) if session.short else SIZES
    materials = {"hardening": HARDENING} if session.short else {name: MATERIALS[name] for name in ("hardening", "plastic")}
    reduction, cells = (0.2, 5) if session.short else (0.4, 10)
    table = Table(
        "Length of a step",
        ["material", "friction", "step", "ends", "steps", "repeats", "iterations per step", "iterations", "error of the work",
         "error of the radius", "volume change", "why not"],
        "Cylinder 50 x 50 mm on 10 x 10 cells to 40 %, step given as a share of the first height. Errors against the shortest step "
        "of the same mesh; the work of the tool up to the end is the sum over the steps.",
    )
    for material, entries in materials.items():
        for friction in ("smm 0.5",) if session.short else FRICTION:
            reference = None
            for size in sizes:
                outcome = program.run(
                    cylinder(entries, FRICTION[friction], cells=cells, stroke=25 * reduction, step=25 * size), f"{material}, {friction}, {size}"
                )
                if outcome.done and reference is None and size == sizes[0]:
                    reference = outcome
                comparable = outcome.done and reference is not None
                work = outcome.work / reference.work - 1 if comparable else None
                radius = outcome.last["largest_radius_mm"] / reference.last["largest_radius_mm"] - 1 if comparable else None
                table.add(material, friction, f"{100 * size:g} %", "done" if outcome.done else f"at {outcome.last['stroke_mm'] / 25:.0%}",
                          len(outcome.rows), outcome.repeats, outcome.iterations / len(outcome.rows), outcome.iterations, work, radius,
                          outcome.volume_change, outcome.reason)
                what = f"{material}, {friction}, step {100 * size:g} %"
                if material == "hardening":
                    session.check(outcome.done, f"{what}: {outcome.message}")
                if not outcome.done:
                    continue
                # Second order: the volume falls behind by about the square of the step.
                session.check(abs(outcome.volume_change) < 1.0 * size**2 + 1e-7, f"{what}: volume off by {outcome.volume_change:.1e}")
                if comparable:
                    session.check(abs(work) < 5 * size**2 + 0.05 * size, f"{what}: work off by {work:.1e}")
    return [table], {"steps": table}
