#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Picture of a run: fields in the meridian section with tools and mesh, or the force against the stroke.

    scripts/render.py RESULTS [--field strain] [--step LAST] [--output picture.png]
    scripts/render.py RESULTS --history [--output picture.png]

RESULTS is the folder of a run. Needs matplotlib and numpy (Debian: python3-matplotlib); the program
itself does not.
"""
import argparse
import base64
import csv
import pathlib
import sys
import xml.etree.ElementTree as xml
import zlib

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import LineCollection
    from matplotlib.tri import Triangulation
    import numpy as np
except ImportError:
    sys.exit("render.py needs matplotlib and numpy: apt-get install python3-matplotlib")

TYPES = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "<u1"}


def read_array(element):
    """Values of a DataArray: ascii, or base64 with zlib blocks."""
    dtype = np.dtype(TYPES[element.get("type")])
    text = (element.text or "").strip()
    if element.get("format") == "ascii":
        return np.array(text.split(), dtype=dtype)
    # Header: number of blocks, block size, last block size, compressed sizes; in its own base64 piece.
    n_blocks = int(np.frombuffer(base64.b64decode(text[:8])[:4], "<u4")[0])
    header_chars = 4 * ((4 * (3 + n_blocks) + 2) // 3)
    sizes = np.frombuffer(base64.b64decode(text[:header_chars]), "<u4")[3 : 3 + n_blocks]
    data, blocks, start = base64.b64decode(text[header_chars:]), [], 0
    for size in sizes:
        blocks.append(zlib.decompress(data[start : start + size]))
        start += size
    return np.frombuffer(b"".join(blocks), dtype)


def read_vtu(path):
    """Points, lists of points of each cell, and fields of all pieces together."""
    points, cells, fields, offset = [], [], {}, 0
    for piece in xml.parse(path).getroot().iter("Piece"):
        x = read_array(piece.find("Points/DataArray")).reshape(-1, 3)
        arrays = {a.get("Name"): read_array(a) for a in piece.find("Cells")}
        first = 0
        for last in arrays["offsets"]:
            cells.append(arrays["connectivity"][first:last] + offset)
            first = last
        data = piece.find("PointData")
        for a in data if data is not None else []:
            values = read_array(a)
            components = int(a.get("NumberOfComponents") or 1)
            fields.setdefault(a.get("Name"), []).append(values.reshape(-1, components))
        points.append(x)
        offset += len(x)
    return np.concatenate(points), cells, {k: np.concatenate(v) for k, v in fields.items()}


def draw_fields(folder, field, step, output):
    files = sorted((folder / "fields").glob("workpiece_*.vtu"))
    if not files:
        sys.exit(f"{folder}: no fields (Output/Fields = none?)")
    if step is not None:
        files = [f for f in files if int(f.stem.split("_")[1]) <= step] or files[:1]
    path = files[-1]
    points, cells, fields = read_vtu(path)
    if field not in fields:
        sys.exit(f"{path.name} has no field {field}: it has {', '.join(fields)}")
    values = fields[field]
    values = np.hypot(values[:, 0], values[:, 1]) if values.shape[1] > 1 else values[:, 0]

    # Q2 Lagrange quadrilaterals: 4 vertices, mid-sides (bottom, right, top, left), centre.
    triangles, edges = [], []
    for c in cells:
        for a, b in ((0, 4), (4, 1), (1, 5), (5, 2), (2, 6), (6, 3), (3, 7), (7, 0)):
            triangles.append((c[a], c[b], c[8]))
        for a, m, b in ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0)):
            s = np.linspace(-1, 1, 7)[:, None]
            edges.append(
                0.5 * s * (s - 1) * points[c[a], :2]
                + (1 - s * s) * points[c[m], :2]
                + 0.5 * s * (s + 1) * points[c[b], :2]
            )
    figure, axes = plt.subplots(figsize=(9, 6))
    mesh = Triangulation(points[:, 0], points[:, 1], triangles)
    low, high = values.min(), max(values.max(), values.min() + 1e-12)
    levels = np.linspace(low, high, 33)
    picture = axes.tricontourf(mesh, values, levels, cmap="turbo")
    mirrored = Triangulation(-points[:, 0], points[:, 1], np.array(triangles)[:, ::-1])
    axes.tricontourf(mirrored, values, levels, cmap="turbo")
    axes.add_collection(LineCollection(edges, colors="black", linewidths=0.35))

    tools = path.with_name(path.name.replace("workpiece", "tools"))
    width, bottom, top = 1.25 * points[:, 0].max(), points[:, 1].min(), points[:, 1].max()
    if tools.exists():
        x, lines, _ = read_vtu(tools)
        for line in lines:
            for sign in (1, -1):
                axes.plot(sign * x[line, 0], x[line, 1], color="dimgray", linewidth=2.5)
    axes.set_xlim(-width, width)
    axes.set_ylim(bottom - 0.06 * (top - bottom), top + 0.15 * (top - bottom))
    axes.set_aspect("equal")
    axes.set_xlabel("r [mm]")
    axes.set_ylabel("z [mm]")
    figure.colorbar(picture, ax=axes, label=field.replace("_", " "), shrink=0.8)
    figure.savefig(output, dpi=110, bbox_inches="tight")


def draw_history(folder, output):
    with open(folder / "history.csv", newline="", encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    stroke = [float(r["stroke_mm"]) for r in rows]
    figure, axes = plt.subplots(figsize=(7, 4.5))
    for name in rows[0]:
        if name.startswith("force_"):
            axes.plot(stroke, [float(r[name]) / 1e3 for r in rows], label=name[6:-2])
    axes.set_xlabel("stroke [mm]")
    axes.set_ylabel("force [kN]")
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(output, dpi=110, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--field", default="strain")
    parser.add_argument("--step", type=int, help="the last fields written up to this step")
    parser.add_argument("--history", action="store_true", help="force against stroke")
    parser.add_argument("--output", type=pathlib.Path)
    arguments = parser.parse_args()
    output = arguments.output or arguments.results / ("history.png" if arguments.history else "fields.png")
    if arguments.history:
        draw_history(arguments.results, output)
    else:
        draw_fields(arguments.results, arguments.field, arguments.step, output)
    print(output)


if __name__ == "__main__":
    main()
