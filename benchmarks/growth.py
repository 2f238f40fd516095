#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Time and memory of one velocity solve from 1,000 to 1,000,000 unknowns, on one rank and on two.

    benchmarks/growth.py [PROGRAM] [--ranks 1 2] [--cells 11 18 ...] [--keep]

The first 0.01 mm of parameter_files/cylinder_upsetting.prm on n x n cells. The phases are those of --timing, in
CPU seconds of one rank, per Newton iteration where a phase belongs to one. Small meshes are repeated on one rank, the
median counts. The operations of the factorisation are counted by a library that is preloaded (cholmod_flops.c); what the
BLAS reaches in dgemm comes from the target kernels.
"""
import argparse
import csv
import json
import pathlib
import re
import statistics
import subprocess
import tempfile

from support.common import (PROGRAM, RESULTS, ROOT, SCENES, build, must, plots, power_fit, run, save_figure, table, write_csv,
                    write_markdown)

CELLS = [11, 18, 25, 35, 55, 78, 108, 176, 250, 353]
LIMIT_SHARE, LIMIT_EXPONENT, LIMIT_RATE = 0.30, 1.25, 0.60
PER_ITERATION = {
    "forces": "forces of the cells",
    "assembly": "assembly",
    "factorisation": "factorisation",
    "solve": "triangular solves",
    "recovery": "pressure and cell centres",
}


def measure(program, cells, ranks, counter):
    """Medians of some runs of one mesh, as a row."""
    entries = [
        "Process/End stroke = 0.01",
        "Time stepping/Stroke per step = 0.01",
        "Workpiece/Geometry parameters = RadialCells = %d, AxialCells = %d" % (cells, cells),
    ]
    rows = []
    for _ in range(1 if ranks > 1 or cells > 150 else 3 if cells > 50 else 5):
        result = run(program, SCENES / "cylinder_upsetting.prm", entries, ranks, {"LD_PRELOAD": str(counter)})
        if result.status != 0 and ranks > 1:
            reason = re.search(r"^axiforge: .*?: (.*?)\.", result.output, re.MULTILINE)
            print(result.output[:2000])
            return {"ranks": ranks, "cells": cells * cells, "unknowns": 2 * (2 * cells + 1) ** 2, "memory_MB": result.memory,
                    "failed": reason.group(1) if reason else "status %d" % result.status}
        must(result)
        iterations = result.phases["factorisation"][0]
        clock = 2 if ranks == 1 else 1  # ranks that wait for each other burn CPU time
        row = {
            "ranks": ranks,
            "cells": cells * cells,
            "unknowns": int(result.history[-1]["unknowns"]),
            "iterations": iterations,
            "step_s": result.phases["flow solver"][clock],
            "analysis_s": result.phases["analysis"][clock],
            "memory_MB": result.memory,
            "whole_wall_s": result.wall,
        }
        for name, phase in PER_ITERATION.items():
            row[name + "_s"] = result.phases[phase][clock] / iterations
        row["iteration_s"] = row["step_s"] / iterations
        row["assembly_share"] = row["assembly_s"] / row["iteration_s"]
        row["cells_share"] = (row["assembly_s"] + row["forces_s"] + row["recovery_s"]) / row["iteration_s"]
        found = re.search(r"cholmod: \d+ factorisations, (\S+) operations each, (\S+) entries", result.output)
        if found and ranks == 1:
            row["operations"], row["factor_entries"] = float(found.group(1)), float(found.group(2))
            row["rate"] = row["operations"] / row["factorisation_s"]
            shares = re.search(r"128 columns: (\S+) (\S+) (\S+) (\S+)", result.output).groups()
            row.update(zip(("below_16", "below_32", "below_64", "below_128"), map(float, shares)))
            row["blas_s"] = float(re.search(r"BLAS alone (\S+) s", result.output).group(1))
        rows.append(row)
    return {key: statistics.median(row[key] for row in rows) for key in rows[0]}


def kept_rows():
    """What results/growth.csv has."""
    with open(RESULTS / "growth.csv", newline="") as file:
        rows = [{key: value for key, value in row.items() if value} for row in csv.DictReader(file)]
    return [{key: value if key == "failed" else float(value) for key, value in row.items()} for row in rows]


def dgemm_rate():
    """Operations a second of large matrices, and by size."""
    kernels = build("kernels")
    if not kernels:
        return {}
    output = subprocess.run(
        [kernels, "--benchmark_filter=dgemm", "--benchmark_format=json", "--benchmark_repetitions=5"],
        capture_output=True, text=True, check=True,
    ).stdout
    rates = {}
    for benchmark in json.loads(output)["benchmarks"]:
        if benchmark["run_type"] == "iteration":
            size = int(benchmark["run_name"].split("/")[1])
            rates.setdefault(size, []).append(benchmark["operations"])
    return {size: statistics.median(values) for size, values in rates.items()}


def picture(rows):
    pyplot = plots()
    if not pyplot:
        return
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4.2))
    one = [row for row in rows if row["ranks"] == 1]
    two = [row for row in rows if row["ranks"] == 2]
    unknowns = [row["unknowns"] for row in one]
    for name in ("factorisation", "assembly", "forces", "solve"):
        left.loglog(unknowns, [row[name + "_s"] for row in one], "o-", markersize=3, label=name)
    left.loglog(unknowns, [row["iteration_s"] for row in one], "ko-", markersize=3, label="whole iteration")
    middle = one[len(one) // 2]
    left.loglog(unknowns, [middle["iteration_s"] * (n / middle["unknowns"]) ** LIMIT_EXPONENT for n in unknowns], "k:",
                label="$N^{1.25}$")
    left.set(xlabel="unknowns", ylabel="CPU seconds of one iteration, one rank")
    left.legend(fontsize=8)
    right.loglog(unknowns, [row["memory_MB"] for row in one], "ko-", markersize=3, label="one rank")
    if two:
        right.loglog([row["unknowns"] for row in two], [row["memory_MB"] for row in two], "s--", markersize=3,
                     label="two ranks, the larger one")
    right.set(xlabel="unknowns", ylabel="peak memory of a process [MB]")
    right.legend(fontsize=8)
    save_figure(figure, "growth")


def nearest(rows, unknowns):
    return min((row for row in rows if row["ranks"] == 1), key=lambda row: abs(row["unknowns"] - unknowns))


def verdicts(rows, rates):
    one = [row for row in rows if row["ranks"] == 1]
    large = [row for row in one if row["unknowns"] >= 10000]
    size = [row["unknowns"] for row in large]
    lines = ["Growth $N^p$ from %s to %s unknowns, exponents by least squares:\n" % ("{:,}".format(int(size[0])), "{:,}".format(int(size[-1])))]
    exponents = [("the step", "step_s"), ("one iteration", "iteration_s"), ("factorisation", "factorisation_s"),
                 ("assembly", "assembly_s"), ("forces of the cells", "forces_s"), ("triangular solves", "solve_s"),
                 ("analysis, once for each mesh", "analysis_s"), ("operations of the factorisation", "operations"),
                 ("entries of the factor", "factor_entries"), ("memory", "memory_MB")]
    largest = [row for row in large if row["unknowns"] > 90000]
    fits = [{"what": what, "p": power_fit(size, [row.get(key, 0) for row in large]),
             "late": power_fit([row["unknowns"] for row in largest], [row.get(key, 0) for row in largest])}
            for what, key in exponents]
    lines.append(table(fits, {"": ("what", "{}"), "p": ("p", "{:.2f}"), "p from 94,000 on": ("late", "{:.2f}")}))
    step = fits[0]["p"]
    lines.append("- A step grows as $N^{%.2f}$; the target was at most $N^{%.2f}$: %s."
                 % (step, LIMIT_EXPONENT, "met" if step <= LIMIT_EXPONENT else "not met"))
    row = nearest(rows, 24000)
    lines.append("- At {:,} unknowns assembly is {:.0%} of the step, with the forces of the cells (the residual) and the "
                 "recovery of pressures {:.0%}; the target was at most {:.0%}: {}.".format(
                     int(row["unknowns"]), row["assembly_share"], row["cells_share"], LIMIT_SHARE,
                     "met" if row["assembly_share"] <= LIMIT_SHARE else "not met"))
    row = nearest(rows, 94000)
    if rates and "rate" in row:
        best = max(rates.values())
        share = row["rate"] / best
        lines.append("- At {:,} unknowns the factorisation does {:.2f} G operations in {:.3f} s, {:.1f} GFlop/s; dgemm reaches "
                     "{:.1f} GFlop/s on the same core: {:.0%}, where {:.0%} was the target: {}.".format(
                         int(row["unknowns"]), row["operations"] / 1e9, row["factorisation_s"], row["rate"] / 1e9,
                         best / 1e9, share, LIMIT_RATE, "met" if share >= LIMIT_RATE else "not met"))
        lines.append("  Of its operations {below_16:.0%} are in supernodes of fewer than 16 columns, {below_32:.0%} of fewer than 32, "
                     "{below_64:.0%} of fewer than 64, {below_128:.0%} of fewer than 128.".format(**row))
        if "blas_s" in row:
            lines.append("  dpotrf, dtrsm and dsyrk alone take {:.3f} s for fronts of these shapes, {:.1f} GFlop/s: {:.0%} of dgemm. What the "
                         "factorisation takes beside them gathers and scatters entries.".format(
                             row["blas_s"], row["operations"] / row["blas_s"] / 1e9, row["operations"] / row["blas_s"] / best))
        lines.append("  dgemm by size n of the matrices [GFlop/s]: "
                     + ", ".join("%d: %.1f" % (n, rate / 1e9) for n, rate in sorted(rates.items())) + ".")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--ranks", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--cells", nargs="+", type=int, default=CELLS, help="along a side")
    parser.add_argument("--keep", action="store_true", help="keep the last results of all that is not measured now")
    arguments = parser.parse_args()
    rows = []
    if arguments.keep:
        rows = [row for row in kept_rows() if row["ranks"] not in arguments.ranks or row["cells"] ** 0.5 not in arguments.cells]
    with tempfile.TemporaryDirectory() as folder:
        counter = pathlib.Path(folder) / "cholmod_flops.so"
        subprocess.run(["cc", "-O2", "-fPIC", "-shared", "-I/usr/include/suitesparse",
                        ROOT / "benchmarks" / "cholmod_flops.c", "-o", counter, "-ldl"], check=True)
        rates = dgemm_rate()
        for ranks in arguments.ranks:
            for cells in arguments.cells:
                row = measure(arguments.program.resolve(), cells, ranks, counter)
                print(row, flush=True)
                rows.append(row)
                rows.sort(key=lambda row: (row["ranks"], row["unknowns"]))
                write_csv("growth", rows)
    columns = {
        "unknowns": ("unknowns", "{:,.0f}"), "iterations": ("iterations", "{:.0f}"), "step [s]": ("step_s", "{:.3g}"),
        "iteration [s]": ("iteration_s", "{:.3g}"), "forces": ("forces_s", "{:.2g}"), "assembly": ("assembly_s", "{:.2g}"),
        "factorisation": ("factorisation_s", "{:.2g}"), "solve": ("solve_s", "{:.2g}"), "analysis": ("analysis_s", "{:.2g}"),
        "memory [MB]": ("memory_MB", "{:,.0f}"),
    }
    one = dict(columns, **{"assembly's share": ("assembly_share", "{:.0%}"), "GFlop": ("gigaflop", "{:.3g}"),
                           "GFlop/s": ("gigarate", "{:.3g}")})
    for row in rows:
        row["gigaflop"], row["gigarate"] = row.get("operations", 0) / 1e9, row.get("rate", 0) / 1e9
    body = ("The first 0.01 mm of `cylinder_upsetting.prm` on n x n cells; forces, assembly, factorisation and solve are seconds "
            "of one Newton iteration, analysis (order of the rows, pattern) comes once for each mesh. Memory is the peak of the "
            "process.\n\nOne rank, CHOLMOD, CPU seconds:\n\n"
            + table([row for row in rows if row["ranks"] == 1], one)
            + "\nTwo ranks, CHOLMOD on the first, wall seconds of that rank, memory of the larger one:\n\n"
            + table([row for row in rows if row["ranks"] == 2], dict(columns, **{"failed": ("failed", "{}")})) + "\n" + verdicts(rows, rates))
    write_markdown("growth", "Growth with the mesh", arguments.program.resolve(), body)
    picture(rows)


if __name__ == "__main__":
    main()
