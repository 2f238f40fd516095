#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the calibration of the ring test and prints the tables of doc/ring_calibration.md.

    scripts/ring_calibration.py [--program build/release/axiforge] [--output results/ring_calibration]
                                [--plot doc/images/ring_calibration.svg] [--only NAME ...]

Each series is `axiforge study parameter_files/ring_calibration.prm` with another law of friction or another
material; runs that are there are not repeated (delete the folder). Then the change of the inner diameter at
mid-height against the reduction is laid over that of constant shear, which gives the map from the factor f' of
the SMM layer to m.
"""
import argparse
import csv
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENE = ROOT / "parameter_files" / "ring_calibration.prm"
RADIUS, HALF_HEIGHT = 9.0, 6.0
REDUCTIONS = (10, 20, 30, 40, 50)

# sigma = 100 (rate / reference rate)^0.2 MPa: 100 MPa at the rate of the start, V / H = 0.01 /s.
RATE = ["Material/Model = power law", "Material/Strength coefficient = 251.1886431509580",
        "Material/Rate exponent = 0.2", "Material/Yield stress = 0", "Remeshing/Enabled = false"]
SHEAR = "0; 0.05; 0.1; 0.2; 0.3; 0.5; 0.7; 1"
LAYER = "0.05; 0.1; 0.15; 0.2; 0.25; 0.3; 0.35; 0.4; 0.5; 0.7"
WORKPIECE = "0.05; 0.1; 0.2; 0.3; 0.4; 0.5; 0.6; 0.7; 0.8; 0.9; 0.95"


def smm(viscosity, values):
    return ["Tool upper/Friction/Law = smm", "Tool upper/Friction/Factor = 0.1",
            f"Tool upper/Friction/Layer viscosity = {viscosity}", f"Study/Values = {values}"]


def mesh(radial, axial, step):
    return ["Workpiece/Geometry parameters = InnerRadius = 9, OuterRadius = 18, Height = 6, "
            f"RadialCells = {radial}, AxialCells = {axial}", f"Time stepping/Stroke per step = {step}"]


# name -> entries; the values of a study are factors m or f'.
SERIES = {
    "shear": [],
    "shear_rate": RATE,
    "layer": smm("layer", LAYER),
    "layer_rate": RATE + smm("layer", LAYER),
    # Only beta / thickness counts; with the default of 1 % of the height f' = 0.05 sticks.
    "workpiece_rate": RATE + smm("workpiece", WORKPIECE) + ["Tool upper/Friction/Layer thickness = 6",
                                                            "Flow solver/Most iterations = 200"],
    # Convergence, m = 0.1 and 0.2.
    "mesh_12x6": mesh(12, 6, 0.06) + ["Study/Values = 0.1; 0.2"],
    "mesh_48x24": mesh(48, 24, 0.06) + ["Study/Values = 0.1; 0.2"],
    "step_2": mesh(24, 12, 0.12) + ["Study/Values = 0.1; 0.2"],
    "step_05": mesh(24, 12, 0.03) + ["Study/Values = 0.1; 0.2"],
}


def run(program, folder, entries):
    if (folder / "study.csv").exists():
        return
    command = [program, "study", str(SCENE), "--output", str(folder)]
    for entry in entries:
        command += ["--set", entry]
    subprocess.run(command + ["--quiet"], check=False)


def read_curve(folder, column):
    """Pairs of reduction [%] and value of a column of history.csv."""
    with open(folder / "history.csv", newline="") as file:
        return [(100 * float(row["stroke_mm"]) / HALF_HEIGHT, float(row[column])) for row in csv.DictReader(file)]


def at(curve, x):
    """Linear between rows; None beyond the end of a run that stopped."""
    before = (0.0, None)
    for here in curve:
        if abs(here[0] - x) < 1e-6:
            return here[1]
        if here[0] > x and before[1] is not None:
            return before[1] + (here[1] - before[1]) * (x - before[0]) / (here[0] - before[0])
        before = here
    return None


class Study:
    """The runs of one series: factors, and curves of change of the inner diameter [%]."""

    def __init__(self, folder):
        with open(folder / "study.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        label = "value" if "value" in rows[0] else list(rows[0])[1]
        self.factors = [float(row[label]) for row in rows]
        self.folders = [folder / f"run_{i + 1}" for i in range(len(rows))]

    def change(self, i, reduction, gauge="bore_middle"):
        value = at(read_curve(self.folders[i], f"gauge_{gauge}_mm"), reduction)
        return None if value is None else 100 * (value / RADIUS - 1)

    def force(self, i, reduction):
        return at(read_curve(self.folders[i], "force_upper_N"), reduction)


def cell(x, digits=2):
    return "-" if x is None else f"{x:.{digits}f}"


def table(study, name, gauge="bore_middle"):
    lines = [f"| {name} | " + " | ".join(f"{r} %" for r in REDUCTIONS) + " |", "|---" * (len(REDUCTIONS) + 1) + "|"]
    for i, factor in enumerate(study.factors):
        lines.append(f"| {factor:g} | " + " | ".join(cell(study.change(i, r, gauge)) for r in REDUCTIONS) + " |")
    return "\n".join(lines)


def equivalent(shear, change, reduction):
    """m whose inner diameter changes by the same at this reduction; linear between the factors computed."""
    known = [(m, shear.change(i, reduction)) for i, m in enumerate(shear.factors)]
    known = [(m, c) for m, c in known if c is not None]
    if change is None or not known:
        return ""
    if change < known[-1][1]:
        return f"> {known[-1][0]:g}"
    for (m0, c0), (m1, c1) in zip(known, known[1:]):
        if c1 <= change <= c0:
            return f"{m0 + (m1 - m0) * (c0 - change) / (c0 - c1):.3f}"
    return ""


def equivalent_table(study, shear):
    lines = ["| f' | " + " | ".join(f"{r} %" for r in REDUCTIONS) + " |", "|---" * (len(REDUCTIONS) + 1) + "|"]
    for i, factor in enumerate(study.factors):
        lines.append(f"| {factor:g} | " + " | ".join(equivalent(shear, study.change(i, r), r) or "-"
                                                     for r in REDUCTIONS) + " |")
    return "\n".join(lines)


def plot(studies, path):
    """Two diagrams side by side as an SVG of their own."""
    width, height, low, high = 520, 420, -60, 45
    colours = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
    parts = []

    def text(x, y, words, anchor="middle", more=""):
        parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{words}</text>')

    for k, (name, letter, title) in enumerate((("shear", "m", "perfectly plastic, constant shear"),
                                               ("layer_rate", "f'", "rate-sensitive, SMM layer, its own viscosity"))):
        left = 70 + k * (width + 40)

        def place(x, y):
            return left + x / 60 * width, 40 + (high - y) / (high - low) * height

        text(left + width / 2, 24, title)
        text(left + width / 2, height + 84, "reduction of the height [%]")
        for x in range(0, 61, 10):
            text(place(x, low)[0], height + 58, x)
        for y in range(low, high + 1, 15):
            x0, y0 = place(0, y)
            text(left - 8, y0 + 4, y, "end")
            parts.append(f'<path d="M{x0:.1f} {y0:.1f} h{width}" stroke="{"#888" if y == 0 else "#ddd"}"/>')
        parts.append(f'<rect x="{left}" y="40" width="{width}" height="{height}" fill="none" stroke="#000"/>')
        study = studies[name]
        for i, factor in enumerate(study.factors):
            curve = [(0, RADIUS)] + read_curve(study.folders[i], "gauge_bore_middle_mm")
            points = [place(x, 100 * (r / RADIUS - 1)) for x, r in curve]
            colour = colours[i % len(colours)]
            line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
            text(points[-1][0] + 4, points[-1][1] + 4, f"{letter} = {factor:g}", "start", f' fill="{colour}"')
    text(20, 40 + height / 2, "change of the inner diameter at mid-height [%]", "middle",
         f' transform="rotate(-90 20 {40 + height / 2})"')
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * width + 140}" height="{height + 100}" '
                    'font-family="sans-serif" font-size="12">\n<rect width="100%" height="100%" fill="#fff"/>\n'
                    + "\n".join(parts) + "\n</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "release" / "axiforge"))
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("results/ring_calibration"))
    parser.add_argument("--plot", type=pathlib.Path)
    parser.add_argument("--only", nargs="+", choices=sorted(SERIES), help="these series alone, no tables")
    options = parser.parse_args()
    for name in options.only or SERIES:
        run(options.program, options.output / name, SERIES[name])
    if options.only:
        return
    studies = {name: Study(options.output / name) for name in SERIES}
    for name, title in (("shear", "Perfectly plastic, constant shear"), ("shear_rate", "Rate-sensitive, constant shear"),
                        ("layer", "Perfectly plastic, SMM, layer"), ("layer_rate", "Rate-sensitive, SMM, layer"),
                        ("workpiece_rate", "Rate-sensitive, SMM, workpiece")):
        letter = "m" if name.startswith("shear") else "f'"
        print(f"\n## {title}: change of the inner diameter at mid-height [%]\n\n{table(studies[name], letter)}")
    for gauge in ("bore_platen", "bore_smallest"):
        print(f"\n## Perfectly plastic, constant shear: {gauge} [%]\n\n{table(studies['shear'], 'm', gauge)}")
    for name, shear in (("layer", "shear"), ("layer_rate", "shear_rate"), ("workpiece_rate", "shear_rate")):
        print(f"\n## {name}: equivalent m\n\n{equivalent_table(studies[name], studies[shear])}")
    print("\n## Convergence: change of the inner diameter at mid-height [%]\n")
    for name in ("mesh_12x6", "shear", "mesh_48x24", "step_2", "step_05"):
        study = studies[name]
        for i, m in enumerate(study.factors):
            if m in (0.1, 0.2):
                print(f"| {name} | {m:g} | " + " | ".join(cell(study.change(i, r), 3) for r in REDUCTIONS) + " |")
    if options.plot:
        plot(studies, options.plot)


if __name__ == "__main__":
    try:
        main()
    except FileNotFoundError as error:
        sys.exit(f"ring_calibration.py: {error}")
