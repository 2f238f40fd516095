# SPDX-License-Identifier: GPL-2.0-or-later
"""Slender and flat cylinders, distorted meshes, long cells."""
import math

from meshes import Mesh
from program import geometry_parameters
from scenes import HARDENING, MATERIALS, PLASTIC, cylinder, frictionless_force, platen, power_law, shear, smm
from tables import Table

TITLE = "Slender, flat, distorted, long cells"
FRICTION = {"none": {"Law": "none"}, "smm 0.3": smm(0.3), "sticking": {"Law": "sticking"}}


def slender(session):
    """H/D = 3: buckling would break the symmetry of revolution, so what can show is the mirror symmetry."""
    program = session.program
    table = Table(
        "Slender: H/D = 3 to half its height",
        ["material", "friction", "platens", "ends", "steps", "iterations per step", "asymmetry of radii", "imbalance of the platens",
         "smallest Jacobian", "why not"],
        "A whole cylinder, 20 mm across and 60 mm high, on 6 x 36 cells between two platens, to half its height in 50 steps. Asymmetry: largest "
        "difference of the outer radius at mirrored heights (of the quarter points, and of 1/20 and 19/20), over the radius; both "
        "platens move, or the lower one rests.",
    )
    for name in ("hardening",) if session.short else ("hardening", "rate sensitive"):
        for friction in ("smm 0.3",) if session.short else FRICTION:
            for both in (True, False) if name == "hardening" and not session.short else (True,):
                height, steps = 60.0, (10 if session.short else 50)
                reduction = 0.1 if session.short else 0.5
                speeds = (0.3, -0.3) if both else (0, -0.6)
                end = (0.5 if both else 1.0) * reduction * height
                entries = {
                    "Tools": "upper, lower",
                    "Gauges": "a, b, c, d",
                    "Workpiece/Geometry file": "cylinder_full.geo",
                    "Workpiece/Geometry parameters": geometry_parameters(Radius=10.0, Height=height, RadialCells=6, AxialCells=36),
                    **MATERIALS[name],
                    **platen("upper", height, speeds[1], FRICTION[friction]),
                    **platen("lower", 0.0, speeds[0], FRICTION[friction]),
                    "Process/Driving tool": "upper",
                    "Process/End stroke": end,
                    "Time stepping/Stroke per step": end / steps,
                }
                # Heights of the final shape; with the lower platen at rest the middle comes down.
                lowest, last = (0.5 * reduction * height if both else 0.0), (1 - reduction) * height
                for gauge, share in zip("abcd", (0.25, 0.75, 0.05, 0.95)):
                    entries[f"Gauge {gauge}/Measure"] = "outer radius"
                    entries[f"Gauge {gauge}/At"] = lowest + share * last
                outcome = program.run(entries, f"slender, {name}, {friction}")
                what = f"slender, {name}, {friction}, {'both' if both else 'one'}"
                session.check(outcome.done, f"{what}: {outcome.message}")
                asymmetry = imbalance = None
                if outcome.done:
                    a, b, c, d = (outcome.last[f"gauge_{gauge}_mm"] for gauge in "abcd")
                    asymmetry = max(abs(a - b), abs(c - d)) / a
                    imbalance = max(
                        abs(abs(row["force_upper_N"]) - abs(row["force_lower_N"])) / abs(row["force_upper_N"]) for row in outcome.rows
                    )
                    # What each step may leave at the tolerance of 1e-5 adds up.
                    session.check(asymmetry < steps * 1e-5, f"{what}: radii differ by {asymmetry:.1e}")
                    session.check(imbalance < 1e-4, f"{what}: forces differ by {imbalance:.1e}")
                table.add(name, friction, "both" if both else "upper", "done" if outcome.done else f"at {outcome.last['stroke_mm'] / (2 if not both else 1) / 30:.0%}",
                          len(outcome.rows), outcome.iterations / len(outcome.rows), asymmetry, imbalance, outcome.last["smallest_jacobian"], outcome.reason)
    return table


def slender_plastic(session):
    """What makes the slender cylinder hard, and what helps."""
    table = Table(
        "Slender and perfectly plastic",
        ["material", "scheme", "reaches", "steps", "repeats", "iterations per step", "CPU [s]"],
        "The same cylinder, frictionless, to 10 % of its height in ten steps, 25 steps at most.",
    )
    height, end = 60.0, 3.0
    linear = {"Material/Model": "ludwik", "Material/Yield stress": 100, "Material/Strength coefficient": 10, "Material/Hardening exponent": 1}
    cases = {"m = 0": PLASTIC, "m = 0.001": power_law(0.001), "m = 0.003": power_law(0.003), "m = 0.01": power_law(0.01), "m = 0.03": power_law(0.03),
             "sigma = 100 + 10 strain MPa": linear, "swift, m = 0.02": HARDENING}
    for name, material in cases.items():
        for scheme in ("midpoint", "explicit euler") if name == "m = 0" else ("midpoint",):
            entries = {
                "Tools": "upper, lower",
                "Workpiece/Geometry file": "cylinder_full.geo",
                "Workpiece/Geometry parameters": geometry_parameters(Radius=10.0, Height=height, RadialCells=6, AxialCells=36),
                **material,
                **platen("upper", height, -0.3),
                **platen("lower", 0.0, 0.3),
                "Process/Driving tool": "upper",
                "Process/End stroke": end,
                "Time stepping/Stroke per step": 0.1 * end,
                "Time stepping/Most steps": 25,
                "Time stepping/Scheme": scheme,
            }
            outcome = session.program.run(entries, f"slender, {name}, {scheme}")
            done = outcome.rows and outcome.last["stroke_mm"] > 0.999 * end
            table.add(name, scheme, f"{outcome.last['stroke_mm'] / height * 2:.1%}" if outcome.rows else outcome.reason, len(outcome.rows), outcome.repeats,
                      outcome.iterations / max(1, len(outcome.rows)), outcome.cpu)
            if name in ("m = 0.01", "m = 0.03", "swift, m = 0.02"):
                session.check(done and outcome.repeats == 0, f"slender, {name}: {outcome.reason}, {outcome.repeats} repeats")
    return table


def flat(session):
    """H/D = 0.05: the pressure is that of the slab method, and not above the parallel field's."""
    program = session.program
    radius, half = 50.0, 2.5
    table = Table(
        "Flat: H/D = 0.05",
        ["friction", "p / sigma_0, first step", "bound 1 + 2 m R / (3 sqrt 3 h)", "to 30 %", "iterations per step", "repeats", "condition", "why not"],
        "A disc 100 mm across and 5 mm high, perfectly plastic, 40 x 4 cells (each twice as long as high) in the upper half, steps of 1 %. The parallel field "
        "is an upper bound; for a flat disc it is close to the answer.",
    )
    cases = [("shear", m) for m in (0.01, 0.1, 0.3, 0.577, 1.0)] + [("smm", f) for f in (0.1, 0.5, 0.99)] + [("sticking", 1.0)]
    for law, factor in cases[2:3] if session.short else cases:
        friction = {"Law": law} if law == "sticking" else {"Law": law, "Factor": factor}
        stroke = 0.05 if session.short else 0.3 * half
        entries = {**cylinder(PLASTIC, friction, cells=(40, 4), radius=radius, height=half, stroke=stroke, step=0.01 * half),
                   "Flow solver/Estimate condition": "true"}
        outcome = program.run(entries, f"flat, {law}, {factor}")
        first = outcome.rows[0] if outcome.rows else None
        m = min(1.0, 1.25 * factor / (1 - factor)) if law == "smm" else factor
        # At the middle of the step: area and height have changed by half of it.
        q = 0.25 * 0.01 / (1 - 0.005)
        middle = radius * 0.5 * (1 + (1 + q) / (1 - q))
        bound = 1 + 2 * m * middle / (3 * math.sqrt(3) * 2 * half * 0.995)
        pressure = first["force_upper_N"] / (math.pi * middle**2 * 100) if first else math.nan
        name = law if law == "sticking" else f"{law} {factor:g}"
        table.add(name, f"{pressure:.4f}", f"{bound:.4f}", "done" if outcome.done else f"at {outcome.last['stroke_mm'] / half:.0%}" if first else "no step",
                  outcome.iterations / max(1, len(outcome.rows)), outcome.repeats, max(outcome.column("condition")) if first else None, outcome.reason)
        # Where it sticks, four cells have no layer to shear in at the platen: their answer lies above the parallel field's.
        allowed = 1.01 if law == "sticking" or m == 1 and law == "smm" else 1.002
        session.check(first is not None and 1 < pressure < bound * allowed, f"flat, {name}: {pressure:.4f}, bound {bound:.4f}; {outcome.reason}")
        # Perfectly plastic material at high friction wears the mesh out: that it has to say.
        session.check(outcome.done or m > 0.6 and outcome.reason == "a cell turns over" and outcome.last["stroke_mm"] > 0.1 * half,
                      f"flat, {name}: {outcome.message}")
    return table


def distorted(session):
    program = session.program
    table = Table(
        "Distorted initial meshes",
        ["share of a cell", "smallest corner", "frictionless: error of the force", "iterations per step", "smm 0.5: force", "work", "iterations per step ",
         "condition", "why not"],
        "Cylinder on 10 x 10 cells of a .msh file whose inner nodes are moved at random by up to this share of a cell, sigma = 100 rate^0.2; smallest "
        "corner: least Jacobian at a corner over an undistorted cell's. Frictionless upsetting is exact on any mesh (tolerance 1e-10). "
        "With friction the differences from the undistorted mesh are those of the discretisation. Ten steps of 1 %.",
    )
    base = None
    for share in (0, 0.3) if session.short else (0, 0.1, 0.2, 0.3, 0.35, 0.4, 0.45):
        cells, steps = (6, 2) if session.short else (10, 10)
        mesh = Mesh(25.0, 25.0, cells, cells, symmetry=True).distort(share, seed=4)
        mesh.write(program.work / "distorted.msh")
        results = {}
        for friction, tolerance in (("none", 1e-10), ("smm 0.5", 1e-5)):
            entries = {**cylinder(power_law(0.2), smm(0.5) if friction != "none" else FRICTION["none"], stroke=0.25 * steps),
                       "Flow solver/Tolerance": tolerance, "Flow solver/Estimate condition": "true"}
            del entries["Workpiece/Geometry parameters"]
            entries["Workpiece/Geometry file"] = "distorted.msh"
            results[friction] = program.run(entries, f"distorted by {share}, {friction}")
        exact = frictionless_force(25.0, 25.0, 0.25, [0.25] * steps, lambda _, rate: 100 * rate**0.2)
        plain, rough = results["none"], results["smm 0.5"]
        error = max(abs(force / wanted - 1) for force, wanted in zip(plain.forces(), exact)) if plain.done else None
        worst = mesh.smallest_jacobian()
        if share == 0:
            base = rough
        table.add(share, worst, error, plain.iterations / steps if plain.done else None,
                  rough.forces()[-1] / base.forces()[-1] - 1 if rough.done else None, rough.work / base.work - 1 if rough.done else None,
                  rough.iterations / steps if rough.done else None, rough.condition if rough.done else None, plain.reason or rough.reason)
        if worst > 0.05:
            session.check(plain.done and error < 1e-8, f"distorted by {share}: frictionless {plain.reason} {error}")
            session.check(rough.done and abs(rough.work / base.work - 1) < 0.01, f"distorted by {share}, smm: {rough.reason}")
    return table


def aspect(session):
    program = session.program
    table = Table(
        "Long cells",
        ["cells", "length over height", "frictionless: error of the force", "iterations per step", "smm 0.5: force", "iterations per step ",
         "sticking: force", "iterations per step  ", "repeats", "condition", "why not"],
        "The same cylinder, sigma = 100 rate^0.2, in ten steps of 1 % on cells of all aspect ratios. Frictionless upsetting is exact (tolerance 1e-12; at 1e-10 the longest cells are off by 1.5e-8); the "
        "other forces are relative to those on 40 x 40 cells and show the discretisation.",
    )
    steps = 2 if session.short else 10
    shapes = [(10, 10), (2, 100)] if session.short else [(10, 10), (20, 2), (60, 3), (100, 2), (200, 2), (2, 20), (3, 60), (2, 100), (2, 200)]
    names = ("none", "smm 0.5") if session.short else ("none", "smm 0.5", "sticking")
    fine = {}
    law = {"none": {"Law": "none"}, "smm 0.5": smm(0.5), "sticking": {"Law": "sticking"}}
    for name in names[1:]:
        cells = 10 if session.short else 40
        fine[name] = program.run(cylinder(power_law(0.2), law[name], cells=cells, stroke=0.25 * steps), f"fine, {name}").forces()[-1]
    for shape in shapes:
        values, reason, condition, repeats = [], "", 0.0, 0
        for name in names:
            entries = {**cylinder(power_law(0.2), law[name], cells=shape, stroke=0.25 * steps), "Flow solver/Estimate condition": "true",
                       "Flow solver/Tolerance": 1e-12 if name == "none" else 1e-5}
            outcome = program.run(entries, f"{shape}, {name}")
            session.check(outcome.done, f"{shape[0]} x {shape[1]} cells, {name}: {outcome.message}")
            reason = reason or outcome.reason
            if not outcome.done:
                values += [None, None]
                continue
            condition = max(condition, outcome.condition)
            # Where the step travels more than half a cell the first one is repeated shorter.
            strokes = [0.25 * seconds for seconds in outcome.column("time_step_s")]
            exact = frictionless_force(25.0, 25.0, 0.25, strokes, lambda _, rate: 100 * rate**0.2)
            error = (max(abs(force / wanted - 1) for force, wanted in zip(outcome.forces(), exact)) if name == "none"
                     else outcome.forces()[-1] / fine[name] - 1)
            repeats += outcome.repeats
            values += [error, outcome.iterations / len(outcome.rows)]
            session.check(abs(error) < (1e-8 if name == "none" else 0.1), f"{shape[0]} x {shape[1]} cells, {name}: force off by {error:.1e}")
        values += [None] * (6 - len(values))
        table.add(f"{shape[0]} x {shape[1]}", f"{shape[1] / shape[0]:g}", *values, repeats, condition, reason)
    return table


def run(session):
    sweeps = {"slender": slender, "slender_plastic": slender_plastic, "flat": flat, "distorted": distorted, "aspect": aspect}
    if session.short:
        del sweeps["slender_plastic"]
    results = {name: sweep(session) for name, sweep in sweeps.items()}
    return list(results.values()), results
