#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Forces at new meshes: how far they jump, and the saw-tooth of caught nodes.

    scripts/benchmark.sh remeshing_jumps [NAME]

Runs upset_to_20_percent.prm with each friction law, spike.prm and backward_cup.prm to their ends (only those with NAME in
theirs, if given). The jump at a new mesh is the change of the force in that step less what the median slope of the eight
steps around predicts, over the force; the saw-tooth is the rms difference of a force from the mean of its neighbours,
over sqrt(1.5), which is the rms of a noise from step to step. Writes benchmarks/results/remeshing_jumps.csv and .md.
"""
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import common

LAW = "Tool upper/Friction/"


def upset(law, **constants):
    entries = [LAW + "Law = " + law, LAW + "Factor = 0"] + [LAW + "%s = %g" % item for item in constants.items()]
    return "upset_to_20_percent.prm", entries


SCENES = {
    "upset, SMM f' = 0.4": ("upset_to_20_percent.prm", []),
    "upset, SMM f' = 0.3": upset("smm", Factor=0.3),
    "upset, shear m = 0.3": upset("shear", Factor=0.3),
    "upset, arctan m = 0.3": upset("arctan", Factor=0.3),
    "upset, Coulomb 0.2": upset("coulomb", Coefficient=0.2),
    "upset, sticking": upset("sticking"),
    "spike": ("spike.prm", []),
    "backward cup": ("backward_cup.prm", []),
}


def analysis(history):
    force_name = next(k for k in history[0] if k.startswith(("force_upper", "force_punch")))
    force, stroke, meshes = ([float(row[name]) for row in history] for name in (force_name, "stroke_mm", "remeshings"))
    jumps = []
    for i in range(1, len(history)):
        if meshes[i] == meshes[i - 1]:
            continue
        around = [j for j in range(max(1, i - 4), min(len(history), i + 5)) if j != i and meshes[j] == meshes[j - 1]]
        slopes = [(force[j] - force[j - 1]) / (stroke[j] - stroke[j - 1]) for j in around if stroke[j] > stroke[j - 1]]
        expected = statistics.median(slopes) * (stroke[i] - stroke[i - 1]) if slopes else 0
        jumps.append(abs(force[i] - force[i - 1] - expected) / force[i])
    teeth = [(force[i] - 0.5 * (force[i - 1] + force[i + 1])) / force[i] for i in range(2, len(force) - 1)]
    return {
        "stroke": stroke[-1],
        "meshes": int(meshes[-1]),
        "largest": 100 * max(jumps, default=0),
        "second": 100 * sorted(jumps)[-2] if len(jumps) > 1 else 0.0,
        "rms": 100 * (sum(j * j for j in jumps) / max(1, len(jumps))) ** 0.5,
        "saw": 100 * (sum(t * t for t in teeth) / len(teeth) / 1.5) ** 0.5,
        "volume": float(history[-1]["relative_volume_change"]),
    }


def main():
    chosen = sys.argv[1] if len(sys.argv) > 1 else ""
    rows = []
    for name, (scene, entries) in SCENES.items():
        if chosen not in name:
            continue
        result = common.run(common.PROGRAM, common.SCENES / scene, entries)
        rows.append({"scene": name, "end": "yes" if result.status == 0 else "no", **analysis(result.history)})
        print(rows[-1], flush=True)
    common.write_csv("remeshing_jumps", rows)
    common.write_markdown("remeshing_jumps", "Forces at new meshes", common.PROGRAM, common.table(rows, {
        "scene": ("scene", "{}"), "to its end": ("end", "{}"), "stroke [mm]": ("stroke", "{:.4g}"),
        "new meshes": ("meshes", "{}"), "largest jump [%]": ("largest", "{:.2f}"), "second [%]": ("second", "{:.2f}"),
        "rms [%]": ("rms", "{:.2f}"), "saw-tooth, rms [%]": ("saw", "{:.2f}"), "change of volume": ("volume", "{:.1e}")}))


if __name__ == "__main__":
    main()
