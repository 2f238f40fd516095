#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Error of the force against unknowns, uniform and adaptive meshes.

    benchmarks/sticking_cylinder.py [PROGRAM] [FOLDER]

Runs parameter_files/study_sticking_cylinder.prm and study_sticking_adaptive.prm with PROGRAM
(build/release/axiforge), results in FOLDER (a temporary one), prints a Markdown table and writes
doc/images/adaptive_sticking.svg. The error is that against the limit of the two finest adaptive meshes. Needs nothing but the standard library.
"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURE = ROOT / "doc" / "images" / "adaptive_sticking.svg"


def study(program, scene, folder):
    """Unknowns and force of each run."""
    subprocess.run(
        [program, "study", ROOT / "parameter_files" / (scene + ".prm"), "--output", folder / scene, "--quiet"], check=True
    )
    with open(folder / scene / "study.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return [(int(row["unknowns"]), float(row["force_upper_N"])) for row in rows if row["force_upper_N"]]


def picture(curves, width=640, height=420):
    """An SVG with logarithmic axes."""
    left, right, top, bottom = 80, 20, 20, 50
    xs = [x for curve in curves for x, _ in curve[2]]
    ys = [y for curve in curves for _, y in curve[2]]
    low = (math.floor(math.log10(min(xs))), math.floor(math.log10(min(ys))))
    high = (math.ceil(math.log10(max(xs))), math.ceil(math.log10(max(ys))))

    def place(x, y):
        return (
            left + (math.log10(x) - low[0]) / (high[0] - low[0]) * (width - left - right),
            top + (high[1] - math.log10(y)) / (high[1] - low[1]) * (height - top - bottom),
        )

    text = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for axis in (0, 1):
        for exponent in range(low[axis], high[axis] + 1):
            a = place(10.0**exponent, 10.0 ** low[1]) if axis == 0 else place(10.0 ** low[0], 10.0**exponent)
            b = place(10.0**exponent, 10.0 ** high[1]) if axis == 0 else place(10.0 ** high[0], 10.0**exponent)
            text.append(f'<path d="M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" stroke="#ddd"/>')
            label = f"1e{exponent}"
            at = (a[0], a[1] + 20, "middle") if axis == 0 else (a[0] - 8, a[1] + 4, "end")
            text.append(f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{at[2]}">{label}</text>')
    text.append(f'<text x="{(left + width - right) / 2}" y="{height - 10}" text-anchor="middle">unknowns</text>')
    middle = (top + height - bottom) / 2
    text.append(
        f'<text transform="translate(22 {middle}) rotate(-90)" text-anchor="middle">relative error of the force</text>'
    )
    for name, colour, points in curves:
        line = " ".join("{:.1f},{:.1f}".format(*place(*point)) for point in points)
        text.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for point in points:
            text.append('<circle cx="{:.1f}" cy="{:.1f}" r="3.5" fill="{}"/>'.format(*place(*point), colour))
        end = place(*points[-1])
        text.append(f'<text x="{end[0] - 8:.1f}" y="{end[1] - 8:.1f}" text-anchor="end" fill="{colour}">{name}</text>')
    text.append("</svg>\n")
    return "\n".join(text)


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release" / "axiforge").resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else temporary)
        uniform = study(program, "study_sticking_cylinder", folder)
        adaptive = study(program, "study_sticking_adaptive", folder)
    # The error of adapted meshes falls with the square of the unknowns: the limit of the last two.
    (fewer, before), (more, last) = adaptive[-2:]
    limit = last - (before - last) / ((more / fewer) ** 2 - 1)
    print(f"Limit: {limit:.2f} N = {limit / (math.pi * 625 * 100):.6f} sigma_0 A\n")
    print("| mesh | unknowns | error of the force |\n|---|---|---|")
    curves = []
    for name, colour, runs in (("uniform", "#777", uniform), ("adaptive", "#c33", adaptive)):
        points = [(unknowns, force / limit - 1) for unknowns, force in runs]
        for unknowns, error in points:
            print(f"| {name} | {unknowns:,} | {error:.1e} |")
        curves.append((name, colour, [point for point in points if point[1] > 1e-7]))
    PICTURE.write_text(picture(curves))


if __name__ == "__main__":
    main()
