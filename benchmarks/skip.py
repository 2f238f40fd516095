#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""What a scene does not ask for costs nothing: the program beside a build that does not have it.

    scripts/benchmark.sh skip [PAIRS]

Builds the program a second time, in build/core with AXIFORGE_CORE_ONLY (no friction, loads, refinement, remeshing,
error estimates, folds, gauges), and runs the same scene with both in turn, PAIRS (15) times. CPU time and peak memory of
the processes; what counts is the median of the ratios of the pairs. Writes benchmarks/results/skip.csv and .md.
"""
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import common

CORE = common.ROOT / "build" / "core" / "axiforge"
STICKING = ["Tool upper/Friction/Law = sticking", "Tool upper/Friction/Factor = 0", "Folding/When found = off",
            "Output/Fields = none"]
SCENES = {
    "sticking cylinder, 18 x 18 cells, 40 steps": STICKING,
    "sticking cylinder, 40 x 40 cells, 20 steps": STICKING + [
        "Workpiece/Geometry parameters = RadialCells = 40, AxialCells = 40", "Time stepping/Stroke per step = 0.25",
        "Process/End stroke = 5"],
}


def build_core():
    subprocess.run(["cmake", "-G", "Ninja", "-S", common.ROOT, "-B", CORE.parent, "-DCMAKE_BUILD_TYPE=Release",
                    "-DAXIFORGE_CORE_ONLY=ON", "-DAXIFORGE_BUILD_TESTS=OFF"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", CORE.parent, "axiforge"], check=True, stdout=subprocess.DEVNULL)


def run(program, entries):
    return common.must(common.run(program, common.SCENES / "cylinder_upsetting.prm", entries))


def answers(rows):
    return [{k: v for k, v in row.items() if not k.startswith("wall")} for row in rows]


def main():
    pairs = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    build_core()
    table = []
    for name, entries in SCENES.items():
        full, core, ratios = [], [], []
        for k in range(pairs):
            order = [(common.PROGRAM, full), (CORE, core)]
            for program, results in order if k % 2 == 0 else reversed(order):
                results.append(run(program, entries))
            ratios.append(full[-1].cpu / core[-1].cpu)
        same = all(answers(result.history) == answers(full[0].history) for result in full + core)
        table.append({
            "scene": name, "pairs": pairs,
            "cpu_s": statistics.median(r.cpu for r in full), "cpu_core_s": statistics.median(r.cpu for r in core),
            "ratio": statistics.median(ratios), "lower_quartile": sorted(ratios)[len(ratios) // 4],
            "upper_quartile": sorted(ratios)[(3 * len(ratios)) // 4],
            "memory_MB": statistics.median(r.memory for r in full),
            "memory_core_MB": statistics.median(r.memory for r in core), "same_answers": "yes" if same else "NO"})
    common.write_csv("skip", table)
    common.write_markdown("skip", "What a scene does not ask for", common.PROGRAM, common.table(table, {
        "scene": ("scene", "{}"), "pairs": ("pairs", "{}"), "CPU [s]": ("cpu_s", "{:.3f}"),
        "without the options [s]": ("cpu_core_s", "{:.3f}"), "ratio, median": ("ratio", "{:.3f}"),
        "lower quartile": ("lower_quartile", "{:.3f}"), "upper quartile": ("upper_quartile", "{:.3f}"),
        "memory [MB]": ("memory_MB", "{:.1f}"), "without [MB]": ("memory_core_MB", "{:.1f}"),
        "same answers": ("same_answers", "{}")}))


if __name__ == "__main__":
    main()
