# SPDX-License-Identifier: GPL-2.0-or-later
"""Rate exponents from 0 to 1, and the regularisation of the corner at rest."""
import math

from program import geometry_parameters
from scenes import cylinder, power_law, shear, smm
from tables import Table

TITLE = "Rate exponent and regularisation"
EXPONENTS = [0, 1e-6, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.5, 0.9, 1]
FRICTION = {"smm 0.5": smm(0.5), "shear 0.3": shear(0.3), "sticking": {"Law": "sticking"}}


def tube(exponent):
    """Expansion of a thick tube with v_r = c/r, see tube_expansion.prm."""
    return {
        "Boundaries": "inner",
        "Workpiece/Geometry file": "tube.geo",
        "Workpiece/Geometry parameters": geometry_parameters(InnerRadius=10.0, OuterRadius=20.0, Height=5.0, RadialCells=8, AxialCells=4),
        **power_law(exponent),
        "Boundary inner/Type": "velocity",
        "Boundary inner/Velocity r": "10 / r",
        "Process/End time": 1,
        "Time stepping/Time step": 0.1,
    }


def tube_pressure(exponent, time):
    """Hill (1950): 2 C/(sqrt 3) int (2c/(sqrt 3 r^2))^n dr/r between the radii at the time."""
    a, b, c = math.sqrt(100 + 20 * time), math.sqrt(400 + 20 * time), 10.0
    if exponent == 0:
        return 200 / math.sqrt(3) * math.log(b / a)
    # expm1: at small exponents the difference of the powers cancels
    rate = (2 * c / (math.sqrt(3) * b * b)) ** exponent
    return 100 / (math.sqrt(3) * exponent) * rate * math.expm1(2 * exponent * math.log(b / a))


def exponents(session):
    program = session.program
    table = Table(
        "Rate exponent, sigma = 100 (rate / (1/s))^m MPa",
        ["m", "error of the tube's pressure", "iterations, tube", *(f"{name}: iterations per step" for name in FRICTION),
         "condition", "largest power residual"],
        "Tube: expansion with the exact pressure (Hill), 8 x 4 cells, ten steps. Others: cylinder on 10 x 10 cells, ten steps of 1 %.",
    )
    for m in (0, 0.2, 1) if session.short else EXPONENTS:
        outcome = program.run(tube(m), f"tube, {m}")
        session.check(outcome.done, f"tube, m = {m}: {outcome.message}")
        error = max(
            abs(row["pressure_inner_MPa"] / tube_pressure(m, row["time_s"] - 0.05) - 1) for row in outcome.rows
        )
        session.check(error < 1e-4, f"tube, m = {m}: pressure off by {error:.1e}")
        cells, stroke = (5, 0.5) if session.short else (10, 2.5)
        numbers, conditions, residuals = [], [], []
        for name in ("smm 0.5",) if session.short else FRICTION:
            entries = {**cylinder(power_law(m), FRICTION[name], cells=cells, stroke=stroke), "Flow solver/Estimate condition": "true"}
            press = program.run(entries, f"{name}, m = {m}")
            session.check(press.done and press.repeats == 0, f"{name}, m = {m}: {press.reason}, {press.repeats} repeats")
            numbers.append(press.iterations / len(press.rows) if press.done else math.nan)
            conditions.append(press.condition if press.done else math.nan)
            residuals.append(press.power_residual if press.done else math.nan)
        session.check(max(residuals) < 1e-3, f"m = {m}: power off by {max(residuals):.1e}")
        numbers += [math.nan] * (len(FRICTION) - len(numbers))
        table.add(m, error, outcome.iterations, *numbers, max(conditions), max(residuals))
    return table


def regularisation(session):
    program = session.program
    table = Table(
        "Regularisation over the reference rate",
        ["m", "friction", "regularisation", "iterations per step at 1e-5", "repeats", "iterations per step at 1e-8", "error of the force",
         "condition", "why not"],
        "The same cylinder; penalty 1e8, or 10 over the regularisation if that is more. Error: of the last force at a tolerance of 1e-8, "
        "against the smallest regularisation that was solved. Regularisations of friction follow their own entry and stay as they are.",
    )
    every = Table("Every run", ["m", "friction", "regularisation", "tolerance", "ends", "iterations", "repeats", "last force [N]", "condition"])
    decades = (1, 3, 6) if session.short else range(1, 9)
    cells, stroke = (5, 0.5) if session.short else (10, 2.5)
    for m in (0,) if session.short else (0, 0.2):
        for name in ("smm 0.5",) if session.short else FRICTION:
            found = {}
            for decade in decades:
                for tolerance in (1e-5, 1e-8):
                    entries = {
                        **cylinder(power_law(m), FRICTION[name], cells=cells, stroke=stroke),
                        "Flow solver/Regularisation": 10.0**-decade,
                        "Flow solver/Penalty": max(1e8, 10.0 * 10.0**decade),
                        "Flow solver/Tolerance": tolerance,
                        "Flow solver/Estimate condition": "true",
                        "Time stepping/Smallest step": 0.1,
                    }
                    outcome = program.run(entries, f"{name}, m = {m}, regularisation 1e-{decade}, {tolerance}")
                    found[decade, tolerance] = outcome
                    every.add(m, name, f"1e-{decade}", tolerance, outcome.reason or "done", outcome.iterations, outcome.repeats,
                              outcome.forces()[-1] if outcome.done else None, outcome.condition if outcome.done else None)
            solved = [found[decade, 1e-8] for decade in decades if found[decade, 1e-8].done]
            limit = solved[-1].forces()[-1] if solved else math.nan
            for decade in decades:
                usual, tight = found[decade, 1e-5], found[decade, 1e-8]
                per_step = [outcome.iterations / len(outcome.rows) if outcome.done else math.nan for outcome in (usual, tight)]
                error = tight.forces()[-1] / limit - 1 if tight.done else math.nan
                table.add(m, name, f"1e-{decade}", per_step[0], usual.repeats if usual.done else None, per_step[1], error,
                          usual.condition if usual.done else math.nan, usual.reason or tight.reason)
                if 2 <= decade <= 4:
                    session.check(usual.done and usual.repeats == 0, f"{name}, m = {m}, 1e-{decade}: {usual.reason}, {usual.repeats} repeats")
                if decade == 3 and not session.short:
                    session.check(abs(error) < 1e-4, f"{name}, m = {m}: the default costs {error:.1e} of the force")
    return table, every


def run(session):
    first = exponents(session)
    second, every = regularisation(session)
    return [first, second], {"exponent": first, "regularisation": every}
