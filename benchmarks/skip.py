#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""What a scene does not ask for costs nothing: the program beside a build that does not have it.

    scripts/benchmark.sh skip [PAIRS]

Builds the program a second time, in build/core with AXIFORGE_CORE_ONLY (no friction, loads, refinement, remeshing,
error estimates, folds, gauges), and runs the same scene with both in turn, PAIRS (15) times. CPU time and peak memory of
the processes; what counts is the median of the ratios of the pairs. Writes benchmarks/results/skip.csv and .md.
"""
import csv
import datetime
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FULL = ROOT / "build" / "release" / "axiforge"
CORE = ROOT / "build" / "core" / "axiforge"
STICKING = ["Tool upper/Friction/Law = sticking", "Tool upper/Friction/Factor = 0", "Folding/When found = off",
            "Output/Fields = none"]
SCENES = {
    "sticking cylinder, 18 x 18 cells, 40 steps": STICKING,
    "sticking cylinder, 40 x 40 cells, 20 steps": STICKING + [
        "Workpiece/Geometry parameters = RadialCells = 40, AxialCells = 40", "Time stepping/Stroke per step = 0.25",
        "Process/End stroke = 5"],
}


def build_core():
    subprocess.run(["cmake", "-G", "Ninja", "-S", ROOT, "-B", CORE.parent, "-DCMAKE_BUILD_TYPE=Release",
                    "-DAXIFORGE_CORE_ONLY=ON", "-DAXIFORGE_BUILD_TESTS=OFF"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", CORE.parent, "axiforge"], check=True, stdout=subprocess.DEVNULL)


def run(program, entries, folder):
    """CPU seconds and peak memory [MB] of a run; its history."""
    command = [program, ROOT / "parameter_files" / "cylinder_upsetting.prm", "--quiet", "--output", folder]
    for entry in entries:
        command += ["--set", entry]
    child = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))} failed")
    with open(pathlib.Path(folder) / "history.csv") as file:
        rows = list(csv.DictReader(file))
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, rows


def answers(rows):
    return [{k: v for k, v in row.items() if not k.startswith("wall")} for row in rows]


def main():
    pairs = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    build_core()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for name, entries in SCENES.items():
            full, core, ratios = [], [], []
            for k in range(pairs):
                order = [(FULL, full), (CORE, core)]
                for program, results in order if k % 2 == 0 else reversed(order):
                    results.append(run(program, entries, folder))
                ratios.append(full[-1][0] / core[-1][0])
            same = all(answers(rows) == answers(full[0][2]) for _, _, rows in full + core)
            low, high = sorted(ratios)[len(ratios) // 4], sorted(ratios)[(3 * len(ratios)) // 4]
            table.append({
                "scene": name, "pairs": pairs,
                "cpu_s": round(statistics.median(r[0] for r in full), 3),
                "cpu_core_s": round(statistics.median(r[0] for r in core), 3),
                "ratio": round(statistics.median(ratios), 3), "lower_quartile": round(low, 3),
                "upper_quartile": round(high, 3),
                "memory_MB": round(statistics.median(r[1] for r in full), 1),
                "memory_core_MB": round(statistics.median(r[1] for r in core), 1),
                "same_answers": "yes" if same else "NO"})
    results = ROOT / "benchmarks" / "results"
    with open(results / "skip.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, table[0])
        writer.writeheader()
        writer.writerows(table)
    revision = subprocess.run([FULL, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if "model name" in line),
                 platform.processor())
    text = ("# What a scene does not ask for\n\nMade by `scripts/benchmark.sh skip`. Machine: "
            f"{model}, {os.cpu_count()} cores. Date: {datetime.date.today()}. {revision}.\n\n"
            "| scene | pairs | CPU [s] | without the options [s] | ratio, median (quartiles) | memory [MB] | "
            "without [MB] | same answers |\n|---|---|---|---|---|---|---|---|\n")
    for row in table:
        text += (f"| {row['scene']} | {row['pairs']} | {row['cpu_s']} | {row['cpu_core_s']} | {row['ratio']} "
                 f"({row['lower_quartile']} to {row['upper_quartile']}) | {row['memory_MB']} | {row['memory_core_MB']} | "
                 f"{row['same_answers']} |\n")
    (results / "skip.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
