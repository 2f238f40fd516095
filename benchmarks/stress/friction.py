# SPDX-License-Identifier: GPL-2.0-or-later
"""Every friction law from nothing to as much as it can have."""
import math

from scenes import MATERIALS, PLASTIC, cylinder
from tables import Table

TITLE = "Friction from frictionless to sticking"
SMM = [0, 1e-8, 1e-4, 1e-2, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1 - 1e-4, 1 - 1e-6, 1 - 1e-8]
SHEAR = [0, 1e-8, 1e-4, 1e-2, 0.1, 0.3, 0.5, 0.7, 0.9, 1 - 1e-8, 1]


def smm(viscosity, element):
    return lambda value: {"Law": "smm", "Factor": value, "Layer viscosity": viscosity, "Layer element": element}


# Name, entries for a value, values, and whether the largest value sticks (Coulomb's is limited by k, as shear is).
LAWS = {
    "smm, viscosity of the layer": (smm("layer", "lagrange"), SMM, True),
    "smm, layer, eight nodes": (smm("layer", "serendipity"), SMM, True),
    "smm, viscosity of the workpiece": (smm("workpiece", "lagrange"), SMM, True),
    "smm, workpiece, eight nodes": (smm("workpiece", "serendipity"), SMM, True),
    "shear": (lambda m: {"Law": "shear", "Factor": m}, SHEAR, False),
    "arctan": (lambda m: {"Law": "arctan", "Factor": m}, SHEAR, False),
    "tangential forces": (lambda m: {"Law": "tangential forces", "Factor": m}, SHEAR, False),
    "coulomb": (lambda mu: {"Law": "coulomb", "Coefficient": mu}, [0, 1e-8, 1e-2, 0.05, 0.1, 0.3, 0.577, 1, 10], False),
    "norton, q = 1": (lambda k: {"Law": "norton", "Viscosity": k, "Exponent": 1}, [0, 1e-6, 1e-2, 1, 1e2, 1e4, 1e8, 1e12], True),
    "norton, q = 0.1": (lambda k: {"Law": "norton", "Viscosity": k, "Exponent": 0.1}, [0, 1e-6, 1, 10, 1e2, 1e4, 1e8, 1e12], True),
}
# Up to where a law is held to its word (doc/stability.md).
LIMITED = {"tangential forces": 0.7}
SHORT_LAWS = ("smm, viscosity of the layer", "shear", "norton, q = 0.1")
# 1e4: the first step failed when the tangent of norton had no bound.
SHORT_VALUES = (0, 0.5, 1 - 1e-8, 1, 1e4, 1e12)


def scene(material, friction, cells, stroke):
    entries = {
        **cylinder(material, friction, cells=cells, stroke=stroke),
        "Flow solver/Estimate condition": "true",
        # What fails is to be seen at the first failure, not after 13 repeats.
        "Time stepping/Smallest step": 0.01,
    }
    if friction.get("Layer viscosity") == "workpiece":
        entries["Flow solver/Most iterations"] = 400  # a direct iteration
    return entries


def run(session):
    program = session.program
    cells, stroke = (5, 0.75) if session.short else (10, 2.5)
    materials = {"hardening": MATERIALS["hardening"]} if session.short else MATERIALS
    columns = ["law", "material", "value", "ends", "steps", "iterations", "repeats", "most in a step", "last force [N]",
               "above frictionless", "below sticking", "condition", "power residual", "volume change", "why not"]
    every = Table("Every run", columns)
    summary = Table(
        "The laws",
        ["law", "material", "values", "done", "iterations per step, mean (worst run)", "least value against frictionless",
         "largest value against sticking", "rises with the value", "condition, least to largest", "first failure"],
        "A cylinder 50 x 50 mm on 10 x 10 cells, ten steps of 1 %. The least value is 0, the largest as near to its limit as the law "
        "lets it ($f'$ = 1 - 1e-8, $m$ = 1, $\\mu$ = 10, $K$ = 1e12). Forces of the last step, relative. Rises: yes, or the largest "
        "drop of the force from one value to the next, over the force.",
    )
    for material_name, material in materials.items():
        frictionless = program.run(scene(material, {"Law": "none"}, cells, stroke), f"none, {material_name}")
        sticking = program.run(scene(material, {"Law": "sticking"}, cells, stroke), f"sticking, {material_name}")
        session.check(frictionless.done and sticking.done, f"{material_name}: no friction, sticking")
        low, high = frictionless.forces()[-1], sticking.forces()[-1]
        for law in SHORT_LAWS if session.short else LAWS:
            if "eight nodes" in law and material_name != "hardening":
                continue  # the element is not the material's affair
            make, values, sticks = LAWS[law]
            if session.short:
                values = [value for value in values if value in SHORT_VALUES]
            runs = []
            for value in values:
                outcome = program.run(scene(material, make(value), cells, stroke), f"{law}, {value}, {material_name}")
                force = outcome.forces()[-1] if outcome.done else math.nan
                runs.append((value, outcome, force))
                record = [outcome.iterations, outcome.repeats, max(outcome.column("iterations")), force, force / low - 1,
                          1 - force / high, outcome.condition, outcome.power_residual, outcome.volume_change] if outcome.done else [None] * 9
                every.add(law, material_name, value, "done" if outcome.done else "failed", len(outcome.rows), *record, outcome.reason)
            add_summary(session, summary, law, material_name, runs, low, high, sticks)
    tables = [summary]
    if not session.short:
        tables.append(bounds(session))
    return tables, {"runs": every}


def add_summary(session, summary, law, material, runs, low, high, sticks):
    done = [(value, outcome, force) for value, outcome, force in runs if outcome.done]
    means = [outcome.iterations / len(outcome.rows) for _, outcome, _ in done]
    drop = max((a[2] / b[2] - 1 for a, b in zip(done, done[1:])), default=0.0)
    first_failure = next((f"{value!r}: {outcome.reason}" for value, outcome, _ in runs if not outcome.done), "")
    conditions = [outcome.condition for _, outcome, _ in done]
    at_least = done[0][2] / low - 1 if done and done[0][0] == 0 else math.nan
    at_most = done[-1][2] / high - 1 if done and done[-1][0] == runs[-1][0] else math.nan
    summary.add(
        law, material, len(runs), len(done), f"{sum(means) / len(means):.1f} ({max(means):.1f})" if means else "-",
        at_least, at_most, "yes" if drop < 1e-6 else f"-{drop:.1e}",
        f"{min(conditions):.1e} to {max(conditions):.1e}" if conditions else "-", first_failure,
    )
    what = f"{law}, {material}"
    # The viscosity of the workpiece is a direct iteration that may fail, and says so. Tangential forces are given
    # and don't answer to the slip: near the yield stress in shear they tear the surface along.
    within = LIMITED.get(law, math.inf)
    if "workpiece" not in law:
        failed = [value for value, outcome, _ in runs if not outcome.done and value <= within]
        session.check(not failed, f"{what}: {first_failure}")
    done = [(value, outcome, force) for value, outcome, force in done if value <= within]
    drop = max((a[2] / b[2] - 1 for a, b in zip(done, done[1:])), default=0.0)
    if "norton" in law:
        session.check(sum(outcome.repeats for _, outcome, _ in done) == 0, f"{what}: steps were repeated")
    if at_least == at_least:
        session.check(abs(at_least) < 1e-5, f"{what}: nothing is not frictionless, {at_least:.1e}")
    if sticks and at_most == at_most:
        session.check(abs(at_most) < 1e-3, f"{what}: the largest value does not stick, {at_most:.1e}")
    for value, outcome, force in done:
        # Where the surface slides the contact is a little wider than where it sticks: the force may lie above sticking.
        session.check(low * (1 - 1e-5) <= force <= high * 1.01, f"{what}, {value:g}: force {force:.6g} not from {low:.6g} to {high:.6g}")
        session.check(outcome.power_residual < 1e-3, f"{what}, {value:g}: power off by {outcome.power_residual:.1e}")
        session.check(abs(outcome.volume_change) < 1e-4, f"{what}, {value:g}: volume off by {outcome.volume_change:.1e}")
    session.check(drop < 5e-3, f"{what}: the force drops by {drop:.1e}")


def bounds(session):
    """Mean pressure of the first increment, which no friction may lift above the parallel field's."""
    table = Table(
        "Upper bound of the first increment, perfectly plastic",
        ["law", "m", "p / sigma_0", "bound 1 + 2 m R / (3 sqrt 3 h)", "below by"],
        "The same cylinder on 16 x 16 cells refined four times towards the edge of the platen, one step of 1e-4 of the height, "
        "regularisations 1e-4 and 1e-5 mm/s.",
    )
    radius, height = 25.0, 50.0
    for law in ("shear", "arctan"):
        for m in (0, 0.1, 0.3, 0.5, 0.7, 1) if law == "shear" else (0.1, 0.5, 1):
            entries = {
                **cylinder(PLASTIC, {"Law": law, "Factor": m, "Regularisation velocity": 1e-5}, cells=16, grading=4, stroke=0.0025, step=0.0025),
                "Flow solver/Regularisation": 1e-4,
            }
            outcome = session.program.run(entries, f"bound, {law}, {m}")
            if not outcome.done:
                session.check(False, f"bound, {law}, {m}: {outcome.reason}")
                table.add(law, m, None, None, None)
                continue
            pressure = outcome.forces()[0] / (math.pi * radius**2 * 100)
            bound = 1 + 2 * m * radius / (3 * math.sqrt(3) * height)
            table.add(law, m, f"{pressure:.5f}", f"{bound:.5f}", bound - pressure)
            # The step itself widens the cylinder by 5e-5 of its area on average.
            session.check(1 - 1e-5 < pressure < bound + 2e-4, f"{law}, {m}: pressure {pressure:.5f}, bound {bound:.5f}")
    return table
