#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""A revision beside an older one: CPU time of the phases, in pairs.

    scripts/benchmark.sh before_after REVISION [PAIRS]

Builds REVISION in build/before and runs the same scenes with it and with the present program in turn, PAIRS (5) times.
What counts is the median of the ratios of the pairs, so that a machine that is slow for a while is so for both. Writes
benchmarks/results/before_after.csv and .md.
"""
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import common

CELLS = "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = %d, AxialCells = %d"
WHOLE = ["whole process", "steps of Newton's method", "flow solver", "forces of the cells", "assembly", "factorisation"]
SCENES = {
    "start: 4 x 4 cells, one step": (
        "cylinder_upsetting.prm", [CELLS % (4, 4), "Process/End stroke = 0.01"], ["whole process", "wall time"]),
    "cylinder, 18 x 18 cells, 40 steps": (
        "cylinder_upsetting.prm", [], WHOLE),
    "cylinder, 56 x 56 cells, 8 steps": (
        "cylinder_upsetting.prm", [CELLS % (56, 56), "Process/End stroke = 2"], WHOLE),
    "cylinder, fields at every of 40 steps": (
        "cylinder_upsetting.prm", ["Output/Fields = vtu", "Output/Fields every steps = 1"], ["fields"]),
    "hub, the whole chain with fields": (
        "wheel_hub.prm", ["Output/Fields = vtu"], WHOLE + ["fields", "remeshing", "transfer"]),
}


def program_of(revision):
    """The program of a revision, built beside the present one."""
    folder = common.ROOT / "build" / "before"
    source = folder / "source"
    if source.exists():
        shutil.rmtree(source)
    source.mkdir(parents=True)
    archive = subprocess.run(["git", "-C", common.ROOT, "archive", revision], check=True, stdout=subprocess.PIPE)
    subprocess.run(["tar", "-x", "-C", source], check=True, input=archive.stdout)
    subprocess.run(["cmake", "-G", "Ninja", "-S", source, "-B", folder / "build", "-DCMAKE_BUILD_TYPE=Release",
                    "-DAXIFORGE_BUILD_TESTS=OFF"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", folder / "build", "axiforge"], check=True, stdout=subprocess.DEVNULL)
    return folder / "build" / "axiforge"


def figures(run):
    """Name -> seconds (or number of iterations)."""
    values = {name: cpu for name, (_, _, cpu) in run.phases.items()}
    values["whole process"] = run.cpu
    values["wall time"] = run.wall
    values["steps of Newton's method"] = run.phases["factorisation"][0]
    return values


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: scripts/benchmark.sh before_after REVISION [PAIRS]")
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    revision = subprocess.run(["git", "-C", common.ROOT, "rev-parse", "--short=12", sys.argv[1]], check=True,
                              capture_output=True, text=True).stdout.strip()
    before = program_of(revision)
    rows = []
    for scene, (file, entries, names) in SCENES.items():
        measured = {before: [], common.PROGRAM: []}
        for k in range(pairs):
            for program in (measured if k % 2 == 0 else reversed(measured)):
                with tempfile.TemporaryDirectory() as folder:
                    result = common.must(common.run(program, common.SCENES / file, entries, keep=folder))
                    measured[program].append(figures(result))
        for name in names:
            old, new = ([run.get(name, 0) for run in measured[program]] for program in measured)
            ratios = sorted(b / a for a, b in zip(old, new) if a > 0)
            rows.append({
                "scene": scene, "what": name, "before": statistics.median(old), "after": statistics.median(new),
                "ratio": statistics.median(ratios), "least": ratios[0], "most": ratios[-1]})
    common.write_csv("before_after", rows)
    common.write_markdown(
        "before_after", "Before and after", common.PROGRAM,
        "Before: revision %s. %d pairs; CPU seconds (medians), the ratio after / before as the median, the least and the "
        "most of the pairs. Factorisation is CHOLMOD's own and here a control, as long as its number stays.\n\n" % (revision, pairs)
        + common.table(rows, {
            "scene": ("scene", "{}"), "what": ("what", "{}"), "before": ("before", "{:.4g}"),
            "after": ("after", "{:.4g}"), "ratio": ("ratio", "{:.2f}"), "least": ("least", "{:.2f}"),
            "most": ("most", "{:.2f}")}))


if __name__ == "__main__":
    main()
