# SPDX-License-Identifier: GPL-2.0-or-later
"""Iterated, static and classical penalty from 1e2 to 1e12: what each costs in digits."""
import math
import statistics

from scenes import HARDENING, cylinder, smm
from tables import Table

TITLE = "Penalty: iterated, static, classical"
METHODS = {"iterated": "iterated penalty", "static": "penalty", "classical": "classical penalty"}


def scene(method, penalty, tolerance, stroke=0.25, cells=18):
    return {
        **cylinder(HARDENING, smm(0.5), cells=cells, stroke=stroke),
        "Flow solver/Incompressibility": METHODS[method],
        "Flow solver/Penalty": penalty,
        "Flow solver/Tolerance": tolerance,
        "Time stepping/Smallest step": 1,
    }


def attainable(program, method, penalty, cells):
    """The tightest tolerance, in decades, that the first step can be solved to, and that run."""
    for digits in range(13, 2, -1):
        run = program.run(scene(method, penalty, 10.0**-digits, cells=cells))
        if run.done or run.status == 1:
            return digits, run
    return 0, run


def short(session):
    """The ends of the sweep: what keeps its digits, and what loses as many as lambda has."""
    def solve(method, penalty, tolerance, stroke=0.25):
        return session.program.run({**scene(method, penalty, tolerance, stroke, cells=6), "Flow solver/Most iterations": 40})

    exact = solve("iterated", 1e8, 1e-12).forces()[0]
    for method, penalty, tolerance, error in (
        ("iterated", 1e4, 1e-12, 1e-11), ("iterated", 1e12, 1e-12, 1e-11), ("static", 1e6, 1e-12, 1e-6),
        ("static", 1e12, 1e-12, 1e-10), ("classical", 1e8, 1e-6, 1e-5),
    ):
        outcome = solve(method, penalty, tolerance)
        off = outcome.forces()[0] / exact - 1 if outcome.done else math.inf
        session.check(abs(off) < error, f"{method} penalty {penalty:.0e} at {tolerance:.0e}: force off by {off:.1e}")
    session.check(not solve("classical", 1e8, 1e-10).done, "the classical penalty 1e8 cannot be solved to 1e-10")
    # Steps after the first have the motion of the cells in the tangent.
    for method in METHODS:
        outcome = solve(method, 1e6, 1e-5, stroke=2)
        session.check(outcome.done, f"eight steps with the {method} penalty 1e6: {outcome.reason}")
    return [], {}


def run(session):
    if session.short:
        return short(session)
    program = session.program
    cells, exponents = 18, range(2, 13)
    exact = program.run(scene("iterated", 1e8, 1e-12, cells=cells)).forces()[0]
    whole = program.run(scene("iterated", 1e8, 1e-10, stroke=10, cells=cells)).last["force_upper_N"]

    first = Table(
        "First step: digits that are left",
        ["method", "lambda", "residual can be solved to", "digits lost", "iterations", "error of the force",
         "power of the divergence", "volume change", "condition", "why not"],
        "`cylinder_upsetting.prm`, one step of 1 %. The residual can be solved to the tightest power of ten at which the "
        "iteration ends; digits lost are counted from what the iterated penalty reaches as a rule. Force, volume and divergence are of "
        "that solution; the force is compared with the iterated penalty at 1e-12. Power of the divergence: of the mean "
        "stress on div v, over the plastic power.",
    )
    results = {}
    for method in METHODS:
        for exponent in exponents:
            results[method, exponent] = attainable(program, method, 10.0**exponent, cells)
    best = statistics.mode(digits for (method, _), (digits, run) in results.items() if method == "iterated" and run.done)
    for (method, exponent), (digits, outcome) in results.items():
        if outcome.status == 1 or not outcome.done:
            first.add(method, f"1e{exponent}", "-", None, None, None, None, None, None, outcome.reason)
            continue
        row = outcome.last
        error = row["force_upper_N"] / exact - 1
        volume = row["power_volume_mW"] / row["power_plastic_mW"]
        condition = condition_of(program, method, exponent, digits, cells)
        first.add(method, f"1e{exponent}", f"1e-{digits}", max(0, best - digits), outcome.iterations, error, volume,
                  row["relative_volume_change"], condition, "")

    def at(method, exponent):
        return next(row for row in first.rows if row[:2] == (method, f"1e{exponent}"))

    last = exponents[-1]
    for exponent in exponents:
        if exponent >= 4:
            session.check(at("iterated", exponent)[3] is not None and at("iterated", exponent)[3] <= 2,
                          f"iterated penalty 1e{exponent} keeps its digits: {at('iterated', exponent)[2]}")
            session.check(abs(at("iterated", exponent)[5]) < 1e-8,
                          f"iterated penalty 1e{exponent}: force off by {at('iterated', exponent)[5]:.1e}")
            session.check(at("static", exponent)[3] <= 2, f"static penalty 1e{exponent} keeps its digits: {at('static', exponent)[2]}")
        # The plain penalty's error of the force is of the order 1/lambda; here it is the stress over 3 lambda.
        if at("static", exponent)[5] is not None:
            session.check(abs(at("static", exponent)[5]) < 10 * 10.0**-exponent + 1e-9,
                          f"static penalty 1e{exponent}: force off by {at('static', exponent)[5]:.1e}")
    lost = at("classical", last)[3]
    session.check(lost is None or lost >= 4, f"classical penalty 1e{last} loses digits: {lost}")

    over_run = Table(
        "The whole run at a tolerance of 1e-5 and of 1e-8",
        ["method", "lambda", "tolerance", "ends", "iterations", "error of the last force", "volume change", "CPU [s]", "why not"],
        "`cylinder_upsetting.prm`, 40 steps to 40 %. Force against the iterated penalty at 1e-10. Steps are not repeated "
        "with a shorter length here: the first step that fails ends the run.",
    )
    for tolerance in (1e-5, 1e-8):
        for method in METHODS:
            for exponent in exponents:
                outcome = program.run(scene(method, 10.0**exponent, tolerance, stroke=10, cells=cells))
                figures = [None] * 4
                if outcome.done:
                    figures = [outcome.iterations, outcome.last["force_upper_N"] / whole - 1,
                               outcome.last["relative_volume_change"], outcome.cpu]
                ends = "40 steps" if outcome.done else f"after {len(outcome.rows)} steps"
                if 4 <= exponent <= 6:
                    session.check(outcome.done, f"40 steps with the {method} penalty 1e{exponent} at {tolerance:.0e}: {outcome.reason}")
                over_run.add(method, f"1e{exponent}", f"{tolerance:.0e}", ends, *figures, outcome.reason)
    return [first, over_run], {"first_step": first, "whole_run": over_run}


def condition_of(program, method, exponent, digits, cells):
    entries = scene(method, 10.0**exponent, 10.0**-digits, cells=cells)
    outcome = program.run({**entries, "Flow solver/Estimate condition": "true"})
    return outcome.condition if outcome.done else math.nan
