#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Error of the force against unknowns and CPU time: meshes, the paper's settings, time schemes.

    benchmarks/accuracy_per_unknown.py [PROGRAM] [--reference] [--keep-meshes] [--quick]

The hardening cylinder of parameter_files/cylinder_upsetting.prm from 50 to 30 mm, with SMM friction f' = 0.5 and sticking.

Reference of the whole stroke: adapted meshes of 24 and 36 cells along a side whose cells at the edge of the platen are divided
five and four times, in 120 steps; the mean of the two counts, and the rms of their difference is its error bar. Nodes that are
caught one by one make a saw-tooth in the force that is proportional to the cells there: no extrapolation of uniform meshes
gets rid of it. All curves are compared as ratios to the force of frictionless upsetting, which vary slowly with the stroke.
The reference is kept in results/accuracy_reference.csv; --reference makes it anew.

Reference of the first increment: adapted meshes of 18, 20 and 22 refinements.
"""
import argparse
import csv
import math
import pathlib

import numpy

from support.common import PROGRAM, RESULTS, SCENES, must, plots, power_fit, run, save_figure, table, write_csv, write_markdown

RADIUS, HEIGHT, SPEED, STROKE = 25.0, 25.0, 0.25, 10.0
STEP = 0.25  # mm: 40 steps
CASES = {
    "smm": [],
    "sticking": ["Tool upper/Friction/Law = sticking", "Tool upper/Friction/Factor = 0"],
}
SCENE = SCENES / "cylinder_upsetting.prm"
EARLY = (0.5, 1.25)  # mm: no node of 18 x 18 cells is caught so early, and the steep start of hardening is over


def frictionless(stroke):
    """Force without friction [N]."""
    strain = -numpy.log(1 - stroke / HEIGHT)
    rate = SPEED / (HEIGHT - stroke)
    area = math.pi * RADIUS**2 / (1 - stroke / HEIGHT)
    return area * 100 * (0.01 + strain) ** 0.2 * (rate / 0.01) ** 0.02


def mesh(cells):
    return "Workpiece/Geometry parameters = RadialCells = %d, AxialCells = %d" % (cells, cells)


def curve(result, scheme="midpoint"):
    """Where the forces of a run hold, and the forces over the frictionless ones."""
    end = numpy.array(result.column("stroke_mm"))
    begin = numpy.concatenate(([0.0], end[:-1]))
    stroke = begin if scheme == "explicit euler" else (begin + end) / 2
    return stroke, numpy.array(result.column("force_upper_N")) / frictionless(stroke), end - begin


# References


def whole_reference(program):
    """Ratio of the force to the frictionless one over the stroke, for each case."""
    rows = []
    for case, entries in CASES.items():
        ratios = []
        for cells, level in ((24, 5), (36, 4)):
            result = must(run(program, SCENE, entries + [mesh(cells), "Time stepping/Stroke per step = %.17g" % (STEP / 3),
                                                         "Refinement/Every steps = 4"] + adaptive(level, level)[:3]))
            stroke, ratio, _ = curve(result)
            ratios.append((stroke, ratio))
            print("reference", case, cells, level, "%.1f s" % result.cpu, flush=True)
        at = ratios[0][0]
        first, second = ratios[0][1], numpy.interp(at, *ratios[1])
        for stroke, a, b in zip(at, first, second):
            rows.append({"case": case, "stroke_mm": float(stroke), "first": float(a), "second": float(b),
                         "mean": float(a + b) / 2})
    write_csv("accuracy_reference", rows)


def read_reference():
    """The reference as a function of the stroke, and its error bar, for each case."""
    reference = {}
    with open(RESULTS / "accuracy_reference.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for case in CASES:
        stroke, first, second, mean = (numpy.array([float(row[key]) for row in rows if row["case"] == case])
                                       for key in ("stroke_mm", "first", "second", "mean"))
        reference[case] = (lambda x, stroke=stroke, mean=mean: numpy.interp(x, stroke, mean), rms(first / second - 1))
    return reference


FIRST = ["Process/End stroke = 0.001", "Time stepping/Stroke per step = 0.001", "Flow solver/Tolerance = 1e-8"]


def first_reference(program, case):
    """Force of the first increment, extrapolated, and how far the last mesh is from it."""
    runs = []
    for cycles in (18, 20, 22):
        entries = CASES[case] + FIRST + [mesh(4)] + adaptive(cycles, 16)
        result = must(run(program, SCENE, entries))
        runs.append((float(result.history[-1]["unknowns"]), result.column("force_upper_N")[-1]))
    limits = [last - (before - last) / ((more / fewer) ** 2 - 1) for (fewer, before), (more, last) in zip(runs, runs[1:])]
    return limits[-1], max(abs(limits[-1] / limits[0] - 1), abs(runs[-1][1] / limits[-1] - 1))


# What is compared


def adaptive(cycles, level):
    return ["Refinement/Enabled = true", "Refinement/Start cycles = %d" % cycles, "Refinement/Largest level = %d" % level,
            "Refinement/Every steps = 3", "Refinement/Coarsen fraction = 0.05"]


def paper(case):
    entries = ["Flow solver/Incompressibility = penalty", "Flow solver/Penalty = 1e6"]
    return entries + (["Tool upper/Friction/Layer element = serendipity"] if case == "smm" else [])


def configurations(case, quick):
    """Name, label, entries of each run."""
    for cells in (6, 9) if quick else (4, 6, 9, 13, 18, 28, 40, 56):
        yield "uniform", "%d x %d" % (cells, cells), [mesh(cells)]
    for cells in (6,) if quick else (4, 6, 9, 13, 18, 28):
        yield "paper's settings", "%d x %d" % (cells, cells), [mesh(cells)] + paper(case)
    for level in (2,) if quick else (1, 2, 3, 4, 5):
        yield "adaptive", "8 x 8, level %d" % level, [mesh(8)] + adaptive(level, level)
    for target in (2,) if quick else (4, 2, 1, 0.5, 0.25):
        yield "target accuracy", "%g %%" % target, [mesh(6), "Accuracy/Target accuracy = %g %%" % target]


def rms(values, weights=None):
    return float(numpy.sqrt(numpy.average(numpy.square(values), weights=weights)))


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def bars(program, case):
    """The references' error bars, and the force of the first increment."""
    limit, bar = first_reference(program, case)
    return {"case": case, "whole": read_reference()[case][1], "first": limit, "first_bar": bar}


def meshes(program, quick):
    rows, notes = [], []
    for case, entries in CASES.items():
        notes.append(bars(program, case))
        limit, exact = notes[-1]["first"], read_reference()[case][0]
        for kind, label, changes in configurations(case, quick):
            row = {"case": case, "kind": kind, "mesh": label}
            rows.append(row)
            result = run(program, SCENE, entries + changes + ["Time stepping/Stroke per step = %g" % STEP])
            if not result.history:
                row["reached_mm"] = 0.0
                continue
            stroke, ratio, width = curve(result)
            error = ratio / exact(stroke) - 1
            row.update(reached_mm=float(result.history[-1]["stroke_mm"]), steps=len(error),
                       unknowns=float(numpy.average(result.column("unknowns"), weights=width)),
                       iterations=sum(result.column("iterations")), cpu_s=result.cpu,
                       steps_cpu_s=result.phases["steps"][2], rms=rms(error, width), largest=float(abs(error).max()),
                       volume=float(result.history[-1]["relative_volume_change"]))
            if kind != "target accuracy":
                first = run(program, SCENE, entries + changes + FIRST)
                if first.status == 0:
                    row.update(first_unknowns=first.column("unknowns")[-1],
                               first=abs(first.column("force_upper_N")[-1] / limit - 1))
            print(row, flush=True)
            write_csv("accuracy_per_unknown", rows)
    return rows, notes


def time_schemes(program, quick):
    """Errors of time alone: against midpoint with 640 steps on the same mesh."""
    rows = []
    for case, friction in CASES.items():
        entries = friction + ["Flow solver/Tolerance = 1e-8"]
        fine = must(run(program, SCENE, entries + [mesh(18), "Time stepping/Stroke per step = %.17g" % (STROKE / 640)]))
        at, ratio, _ = curve(fine)
        end = fine.history[-1]
        for scheme in ("midpoint", "explicit euler"):
            for steps in (40, 80) if quick else (20, 40, 80, 160, 320):
                result = must(run(program, SCENE, entries + [mesh(18), "Time stepping/Scheme = " + scheme,
                                                             "Time stepping/Stroke per step = %.17g" % (STROKE / steps)]))
                stroke, values, width = curve(result, scheme)
                error = values / numpy.interp(stroke, at, ratio) - 1
                early = (stroke >= EARLY[0]) & (stroke <= EARLY[1])
                last = result.history[-1]
                rows.append({
                    "case": case, "scheme": scheme, "steps": steps, "cpu_s": result.cpu, "steps_cpu_s": result.phases["steps"][2],
                    "iterations": sum(result.column("iterations")),
                    "early": rms(error[early], width[early]) if early.any() else math.nan, "rms": rms(error, width),
                    "radius": abs(float(last["largest_radius_mm"]) / float(end["largest_radius_mm"]) - 1),
                    "strain": abs(float(last["largest_strain"]) / float(end["largest_strain"]) - 1),
                    "volume": abs(float(last["relative_volume_change"])),
                })
                print(rows[-1], flush=True)
                write_csv("accuracy_time_schemes", rows)
    return rows


def equal_errors(rows):
    """CPU time of both schemes at the same error of the volume and of the force before nodes are caught."""
    lines = []
    for case in CASES:
        for key, what, targets in (("early", "force before nodes are caught", (1e-3, 1e-4)), ("volume", "volume at the end", (1e-4,))):
            for target in targets:
                row = {"case": case, "what": what, "target": target}
                for scheme in ("midpoint", "explicit euler"):
                    points = [r for r in rows if r["case"] == case and r["scheme"] == scheme and r[key] > 0]
                    order = -power_fit([r["steps"] for r in points], [r[key] for r in points])
                    nearest = min(points, key=lambda r: abs(math.log(r[key] / target)))
                    steps = nearest["steps"] * (nearest[key] / target) ** (1 / order)
                    row[scheme + " order"] = order
                    row[scheme + " steps"] = steps
                    cost = sum(r["steps_cpu_s"] for r in points) / sum(r["steps"] for r in points)
                    row[scheme + " cpu"] = steps * cost
                row["ratio"] = row["explicit euler cpu"] / row["midpoint cpu"]
                lines.append(row)
    return lines


def pictures(rows, notes):
    pyplot = plots()
    if not pyplot:
        return
    styles = {"uniform": "o-", "paper's settings": "s--", "adaptive": "^-", "target accuracy": "D-"}
    figure, axes = pyplot.subplots(2, 2, figsize=(10, 8), sharey="row")
    for column, (case, title) in enumerate((("smm", "SMM f' = 0.5"), ("sticking", "sticking"))):
        bar = next(note["whole"] for note in notes if note["case"] == case)
        for line, key in enumerate(("unknowns", "cpu_s")):
            for kind, style in styles.items():
                points = [row for row in rows if row["case"] == case and row["kind"] == kind and row.get("reached_mm", 0) > 9.99]
                points.sort(key=lambda row: row[key])
                axes[line][column].loglog([row[key] for row in points], [row["rms"] for row in points], style, markersize=4,
                                          label=kind)
            axes[line][column].axhline(bar, color="k", linestyle=":", label="error bar of the reference")
            axes[line][column].set(xlabel="unknowns (mean)" if line == 0 else "CPU seconds of the whole run")
        axes[0][column].set_title(title)
    for line in (0, 1):
        axes[line][0].set_ylabel("rms error of the force")
    axes[0][0].legend(fontsize=8)
    save_figure(figure, "accuracy_per_unknown")


def picture_of_schemes(rows):
    pyplot = plots()
    if not pyplot:
        return
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4.2))
    for case, colour in (("smm", "C0"), ("sticking", "C1")):
        for scheme, style in (("midpoint", "o-"), ("explicit euler", "s--")):
            points = [row for row in rows if row["case"] == case and row["scheme"] == scheme]
            label = "%s, %s" % (scheme, case)
            for axis, key in zip(axes, ("early", "volume")):
                axis.loglog([row["steps_cpu_s"] for row in points], [row[key] for row in points], style, color=colour,
                            markersize=4, label=label)
    axes[0].set(xlabel="CPU seconds of the steps", ylabel="rms error of the force from %g to %g mm" % EARLY)
    axes[1].set(xlabel="CPU seconds of the steps", ylabel="error of the volume at the end")
    axes[0].legend(fontsize=8)
    save_figure(figure, "time_schemes")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--reference", action="store_true", help="compute the reference of the whole stroke anew (minutes)")
    parser.add_argument("--keep-meshes", action="store_true", help="only the time schemes; the meshes are taken from the last results")
    parser.add_argument("--quick", action="store_true", help="a few small runs, to test the script")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    if arguments.reference or not (RESULTS / "accuracy_reference.csv").exists():
        whole_reference(program)
    if arguments.keep_meshes:
        with open(RESULTS / "accuracy_per_unknown.csv", newline="") as file:
            rows = [{key: number(value) for key, value in row.items() if value} for row in csv.DictReader(file)]
        notes = [bars(program, case) for case in CASES]
    else:
        rows, notes = meshes(program, arguments.quick)
    schemes = time_schemes(program, arguments.quick)
    form = "{:.2%}"
    body = (
        "`cylinder_upsetting.prm` from 50 to 30 mm in 40 steps (a target accuracy chooses its own, not longer ones); CPU seconds of the "
        "whole process. Errors are relative to the reference that the head of the script describes; the first increment (0.001 mm) has "
        "one of its own.\n\n"
        + table(notes, {"case": ("case", "{}"), "error bar, whole stroke": ("whole", "{:.1e}"), "first increment [N]": ("first", "{:.1f}"),
                        "error bar, first increment": ("first_bar", "{:.0e}")})
        + "\n"
        + table(rows, {"case": ("case", "{}"), "mesh": ("kind", "{}"), "": ("mesh", "{}"), "unknowns (mean)": ("unknowns", "{:,.0f}"),
                       "steps": ("steps", "{:.0f}"), "iterations": ("iterations", "{:.0f}"), "CPU [s]": ("cpu_s", "{:.2f}"),
                       "rms error": ("rms", form), "largest": ("largest", form), "volume": ("volume", "{:.0e}"),
                       "unknowns, first increment": ("first_unknowns", "{:,.0f}"), "its error": ("first", "{:.1e}"),
                       "reached [mm]": ("reached_mm", "{:.4g}")})
        + "\nTime schemes on 18 x 18 cells, against midpoint with 640 steps on the same mesh; *early*: from %g to %g mm, before nodes are "
        "caught; the force of an Euler step is taken where its equations are written, at the start of the step. Over the whole stroke nodes "
        "are caught at other instants, and the saw-tooth of 18 x 18 cells hides the error of time. `Tolerance = 1e-8` here.\n\n" % EARLY
        + table(schemes, {"case": ("case", "{}"), "scheme": ("scheme", "{}"), "steps": ("steps", "{:.0f}"), "iterations": ("iterations", "{:.0f}"),
                          "CPU of the steps [s]": ("steps_cpu_s", "{:.2f}"), "force, early": ("early", "{:.1e}"), "force, whole": ("rms", "{:.1e}"),
                          "radius": ("radius", "{:.1e}"), "strain": ("strain", "{:.1e}"), "volume": ("volume", "{:.1e}")})
        + "\nSteps and CPU seconds at equal error, by the fitted order (extrapolated where the steps are not between 20 and 320):\n\n"
        + table(equal_errors(schemes), {"case": ("case", "{}"), "error of the": ("what", "{}"), "target": ("target", "{:.0e}"),
                                        "midpoint: order": ("midpoint order", "{:.2f}"), "steps": ("midpoint steps", "{:,.0f}"),
                                        "CPU [s]": ("midpoint cpu", "{:.2g}"), "Euler: order": ("explicit euler order", "{:.2f}"),
                                        "steps ": ("explicit euler steps", "{:,.0f}"), "CPU [s] ": ("explicit euler cpu", "{:.2g}"),
                                        "Euler over midpoint": ("ratio", "{:.1f}")}))
    write_markdown("accuracy_per_unknown", "Accuracy for the unknowns", program, body)
    pictures(rows, notes)
    picture_of_schemes(schemes)


if __name__ == "__main__":
    main()
