#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Picture of a run: a field in the meridian section with tools and mesh, with what stands along it.

    scripts/render.py RESULTS [--field strain] [--range LOW HIGH] [--step LAST] [--symmetry]
    scripts/render.py RESULTS --force      the field and the forces against the stroke below it
    scripts/render.py RESULTS --contact    the field and the traction along the tools below it
    scripts/render.py RESULTS --history    the forces alone

RESULTS is the folder of a run, or of one operation of a chain. --symmetry draws the part below the symmetry plane z = 0 as well. The
colours span the middle 99 % of the values unless --range says otherwise. Needs matplotlib and numpy
(Debian: python3-matplotlib); the program itself does not.
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
    from matplotlib.ticker import MaxNLocator, ScalarFormatter
    from matplotlib.tri import Triangulation as MeshTriangulation
    import numpy as np
    from PIL import Image
except ImportError:
    sys.exit("render.py needs matplotlib and numpy: apt-get install python3-matplotlib")

LABELS = {"strain": "effective strain", "strain_rate": "effective strain rate [1/s]", "velocity": "speed [mm/s]"}
TYPES = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "<u1"}


def check_folder(folder):
    """A folder of results; that of a chain has them in the folders of its operations."""
    if not folder.is_dir():
        sys.exit(f"{folder}: there is no such folder")
    if (folder / "history.csv").exists():
        return
    operations = [f.name for f in folder.glob("[0-9]*_*") if (f / "history.csv").exists()]
    if operations:
        operations.sort(key=lambda name: int(name.split("_")[0]))
        sys.exit(f"{folder}: these are the results of a chain; name one of its operations: "
                 + ", ".join(str(folder / name) for name in operations))
    sys.exit(f"{folder}: no results of a run (there is no history.csv)")


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


def field_file(folder, step):
    """The last file of fields, or the last one up to a step."""
    files = sorted((folder / "fields").glob("workpiece_*.vtu"))
    if not files:
        sys.exit(f"{folder}: no fields (Output/Fields = none?)")
    if step is not None:
        files = [f for f in files if int(f.stem.split("_")[1]) <= step] or files[:1]
    return files[-1]


def lines_of_tools(path):
    """Outlines of the tools, as arrays of (r, z)."""
    path = path.with_name(path.name.replace("workpiece", "tools"))
    if not path.exists():
        return []
    points, lines, _ = read_vtu(path)
    return [points[line, :2] for line in lines]


def split_cells(points, cells):
    """Triangles, and the curved edges of the cells as polylines, of Q2 Lagrange quadrilaterals: 4
    vertices, mid-sides (bottom, right, top, left), centre."""
    triangles, edges = [], []
    s = np.linspace(-1, 1, 7)[:, None]
    for c in cells:
        for a, b in ((0, 4), (4, 1), (1, 5), (5, 2), (2, 6), (6, 3), (3, 7), (7, 0)):
            triangles.append((c[a], c[b], c[8]))
        for a, m, b in ((0, 4, 1), (1, 5, 2), (3, 6, 2), (0, 7, 3)):
            x = points[[c[a], c[m], c[b]], :2]
            edges.append(0.5 * s * (s - 1) * x[0] + (1 - s * s) * x[1] + 0.5 * s * (s + 1) * x[2])
    return np.array(triangles), edges


def draw_tool(axes, line, middle, far, signs):
    """An outline, and the body behind it where the outline begins on the axis."""
    for sign_r, sign_z in signs:
        x = line * (sign_r, sign_z)
        axes.plot(x[:, 0], x[:, 1], color="0.25", linewidth=1.6, zorder=4)
        if abs(line[0, 0]) < 1e-6 or abs(line[-1, 0]) < 1e-6:
            z = sign_z * (far if line[:, 1].mean() > middle else -far)
            behind = np.array([(x[-1, 0], z), (x[0, 0], z)])
            axes.fill(*np.concatenate([x, behind]).T, color="0.82", zorder=0, linewidth=0)


def draw_section(figure, axes, path, arguments):
    points, cells, fields = read_vtu(path)
    name = arguments.field
    if name not in fields:
        sys.exit(f"{path.name} has no field {name}: it has {', '.join(fields)}")
    values = fields[name]
    values = np.hypot(values[:, 0], values[:, 1]) if values.shape[1] > 1 else values[:, 0]
    low, high = arguments.range or np.percentile(values, (0.5, 99.5))
    if not high > low:
        high = low + max(1e-9, 1e-6 * abs(low))
    levels = np.linspace(low, high, 41)

    triangles, edges = split_cells(points, cells)
    signs = [(1, 1), (-1, 1)] + ([(1, -1), (-1, -1)] if arguments.symmetry else [])
    for sign in signs:
        mesh = MeshTriangulation(points[:, 0] * sign[0], points[:, 1] * sign[1], triangles)
        picture = axes.tricontourf(mesh, values, levels, cmap="turbo", extend="both", zorder=1)
        if sign[0] > 0:
            mirrored = [edge * sign for edge in edges]
            axes.add_collection(LineCollection(mirrored, colors="black", linewidths=0.3, alpha=0.7, zorder=2))
    axes.axvline(0, color="white", linewidth=0.8, linestyle=(0, (8, 3, 2, 3)), zorder=3)

    r, (bottom, top) = points[:, 0].max(), (points[:, 1].min(), points[:, 1].max())
    for line in lines_of_tools(path):
        draw_tool(axes, line, 0.5 * (bottom + top), 1e3 * r, signs)
    if arguments.symmetry:
        bottom = -top
    margin = 0.12 * (top - bottom)
    axes.set_xlim(-1.2 * r, 1.2 * r)
    axes.set_ylim(bottom - margin, top + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("r [mm]")
    axes.set_ylabel("z [mm]")
    bar = figure.colorbar(picture, ax=axes, fraction=0.05, pad=0.02, aspect=16)
    bar.set_label(LABELS.get(name, name.replace("_", " ") + " [MPa]"))
    bar.set_ticks([tick for tick in MaxNLocator(7).tick_values(low, high) if low <= tick <= high])
    bar.ax.yaxis.set_major_formatter(ScalarFormatter())
    return (1.2 * 2 * r) / (top - bottom + 2 * margin)


def read_history(folder):
    """Rows of the history, and the names of the tools in it."""
    with open(folder / "history.csv", newline="", encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    if not rows:
        sys.exit(f"{folder}: the history has no step")
    return rows, [name[15:-3] for name in rows[0] if name.startswith("contact_radius_")]


def draw_forces(axes, folder):
    rows, tools = read_history(folder)
    if tools:
        stroke = [float(r["stroke_middle_mm"]) for r in rows]  # where the forces hold
        for tool in tools:
            axes.plot(stroke, [float(r[f"force_{tool}_N"]) / 1e3 for r in rows], label=tool)
        axes.set_xlabel("stroke [mm]")
        axes.set_ylabel("force [kN]")
    else:
        for name in rows[0]:
            if name.startswith("pressure_"):
                time = [float(r["time_middle_s"]) for r in rows]
                axes.plot(time, [float(r[name]) for r in rows], label=name[9:-4])
        axes.set_xlabel("time [s]")
        axes.set_ylabel("pressure [MPa]")
    axes.set_ylim(0, 1.05 * axes.dataLim.y1)
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)


def draw_tractions(axes, path, names):
    """Contact pressure and friction traction of the nodes that touch, against the radius. Nodes that
    belong to different tools are told apart by which outline is nearer."""
    points, _, fields = read_vtu(path)
    touching = np.flatnonzero(np.abs(fields["contact_pressure"][:, 0]) > 0)
    _, first = np.unique(points[touching].round(9), axis=0, return_index=True)
    touching = touching[first]
    lines = lines_of_tools(path)
    if not lines or not len(touching):
        sys.exit(f"{path.name}: nothing touches a tool")

    def distance(x, line):
        a, d = line[:-1], np.diff(line, axis=0)
        t = np.clip(((x - a) * d).sum(1) / np.maximum((d * d).sum(1), 1e-300), 0, 1)
        return np.hypot(*(a + t[:, None] * d - x).T).min()

    nearest = np.array([np.argmin([distance(points[i, :2], line) for line in lines]) for i in touching])
    for tool in range(len(lines)):
        nodes = touching[nearest == tool]
        nodes = nodes[np.argsort(points[nodes, 0])]
        if not len(nodes):
            continue
        suffix = f", {names[tool]}" if len(names) == len(lines) > 1 else ""
        line = axes.plot(points[nodes, 0], fields["contact_pressure"][nodes, 0], ".-", label="pressure" + suffix)
        axes.plot(points[nodes, 0], fields["friction_traction"][nodes, 0], "--", color=line[0].get_color(),
                  label="friction" + suffix)
    axes.set_xlabel("r [mm]")
    axes.set_ylabel("traction [MPa]")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--field", default="strain")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"))
    parser.add_argument("--step", type=int, help="the last fields written up to this step")
    parser.add_argument("--symmetry", action="store_true", help="draw the part below z = 0 as well")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--force", action="store_true", help="forces against the stroke below the field")
    what.add_argument("--contact", action="store_true", help="tractions along the tools below the field")
    what.add_argument("--history", action="store_true", help="forces against the stroke alone")
    parser.add_argument("--output", type=pathlib.Path)
    arguments = parser.parse_args()
    check_folder(arguments.results)
    output = arguments.output or arguments.results / ("history.png" if arguments.history else "fields.png")

    plt.rcParams.update({"font.size": 9, "axes.linewidth": 0.8})
    if arguments.history:
        figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
        draw_forces(axes, arguments.results)
    else:
        path = field_file(arguments.results, arguments.step)
        below = arguments.force or arguments.contact
        figure = plt.figure(figsize=(8, 6), layout="constrained")
        figure.get_layout_engine().set(h_pad=0.08)
        grid = figure.add_gridspec(2 if below else 1, 1, height_ratios=[1, 0.01] if below else [1])
        aspect = draw_section(figure, figure.add_subplot(grid[0]), path, arguments)
        height = min(max(6.6 / aspect, 1.8), 5)
        if below:
            grid.set_height_ratios([height, 2.2])
            axes = figure.add_subplot(grid[1])
            if arguments.force:
                draw_forces(axes, arguments.results)
            else:
                draw_tractions(axes, path, read_history(arguments.results)[1])
        figure.set_size_inches(8, height + 0.5 + (2.4 if below else 0))
    figure.savefig(output, dpi=100, bbox_inches="tight")
    if output.suffix == ".png":  # 256 colours do, and take a third of the space
        with Image.open(output) as picture:
            few = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
        few.save(output, optimize=True)
    print(output)


if __name__ == "__main__":
    main()
