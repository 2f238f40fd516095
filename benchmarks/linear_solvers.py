#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""The direct solver against conjugate gradients with four preconditioners, on the same matrices.

    benchmarks/linear_solvers.py [PROGRAM] [--cells 36 75 150 300] [--penalties 1e2 1e3 1e4 1e8] [--keep]

Builds and runs the target linear_solvers (linear_solvers.cc): the first velocity solve of parameter_files/cylinder_upsetting.prm,
matrix of the fourth Newton iteration, for several penalties. PROGRAM only tells its revision.
"""
import argparse
import csv
import io
import pathlib
import re
import subprocess

from support.common import PROGRAM, RESULTS, SCENES, build, table, write_csv, write_markdown

PENALTIES = [("penalty", 1e2), ("penalty", 1e3), ("iterated penalty", 1e4), ("iterated penalty", 1e8)]
MOST = {75: 1000, 300: 300}  # iterations by cells along a side: more would take hours, and tell no more
FEWEST = 100


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--cells", nargs="+", type=int, default=[36, 75, 150, 300])
    parser.add_argument("--penalties", nargs="+", type=float, default=[penalty for _, penalty in PENALTIES])
    parser.add_argument("--keep", action="store_true", help="add to the last results")
    arguments = parser.parse_args()
    solvers = build("linear_solvers")
    if not solvers:
        raise SystemExit("The target linear_solvers could not be built.")
    rows = []
    if arguments.keep:
        with open(RESULTS / "linear_solvers.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            row.update({key: float(row[key]) for key in ("penalty", "set_up_s", "solve_s", "residual")}, unknowns=int(row["unknowns"]))
    for cells in arguments.cells:
        for kind, penalty in PENALTIES:
            if penalty not in arguments.penalties:
                continue
            most = next((most for size, most in sorted(MOST.items()) if cells <= size), FEWEST)
            done = subprocess.run(
                [solvers, SCENES / "cylinder_upsetting.prm", str(most), "Flow solver/Incompressibility = " + kind,
                 "Flow solver/Penalty = %g" % penalty,
                 "Workpiece/Geometry parameters = RadialCells = %d, AxialCells = %d" % (cells, cells)],
                capture_output=True, text=True,
            )
            newton = re.search(r"in (\d+) iterations", done.stderr)
            for row in csv.DictReader(io.StringIO(done.stdout)):
                if row["iteration"] != "4":
                    continue
                loose, tight = row["iterations_1e-3"], row["iterations_1e-6"]
                rows.append({
                    "cells": "%d x %d" % (cells, cells), "unknowns": int(row["unknowns"]), "penalty": penalty, "kind": kind,
                    "newton": newton.group(1) if newton else "", "solver": row["solver"],
                    "set_up_s": float(row["set_up_s"]), "solve_s": float(row["solve_s"]),
                    "loose": "" if loose == "" else loose if loose != "-1" else "> %d" % most,
                    "tight": "" if tight == "" else tight if tight != "-1" else "> %d" % most,
                    "residual": float(row["residual"]),
                })
                print(rows[-1], flush=True)
            write_csv("linear_solvers", rows)
    body = (
        "First velocity solve of `cylinder_upsetting.prm`, matrix of the fourth Newton iteration (pressure and cell centres condensed; "
        "unknowns are those of the matrix). CPU seconds of one core. Iterations until the residual is 1e-3 and 1e-6 of the right-hand "
        "side; the time is that to 1e-6, or of the most iterations allowed. *newton*: iterations of the velocity solve with the direct "
        "solver at that penalty. Multigrid is smoothed aggregation (Trilinos ML, two unknowns a node, symmetric Gauss-Seidel); incomplete "
        "Cholesky has as many entries as the matrix; the old factor is that of the first Newton iteration.\n\n"
        + table(rows, {"cells": ("cells", "{}"), "unknowns": ("unknowns", "{:,}"), "penalty": ("penalty", "{:.0e}"), "": ("kind", "{}"),
                       "newton": ("newton", "{}"), "solver": ("solver", "{}"), "set-up [s]": ("set_up_s", "{:.3g}"),
                       "solve [s]": ("solve_s", "{:.3g}"), "to 1e-3": ("loose", "{}"), "to 1e-6": ("tight", "{}"),
                       "residual at the end": ("residual", "{:.0e}")}))
    write_markdown("linear_solvers", "The direct solver against iterative ones", arguments.program.resolve(), body)


if __name__ == "__main__":
    main()
