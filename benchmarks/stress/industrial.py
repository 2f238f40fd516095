#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Industrial scenes drawn at random: each must come to its end, and what comes out must be right.

    benchmarks/stress/industrial.py SCENE FOLDER [--short]

writes the inputs of a scene, by its number, to a folder: `axiforge scene.prm` there runs it.
"""
import argparse
import collections
import math
import pathlib
import random
import shutil

from outlines import Outline, volume_between, volume_of, way_down, write_workpiece
from program import parameter_text
from tables import Table

TITLE = "Industrial scenes"
SEED = 2027
N_SCENES = 400
N_SHORT = 40
LONGEST = 240  # wall seconds that a scene may take, on a machine that does something else beside
LEAST_RIGHT = {False: 0.99, True: 0.95}  # share of the scenes, in the long form and in the short one


class Scene:
    """A scene on the way: entries, files in its folder, and what has to come out."""

    def __init__(self, generator, folder, short):
        self.random, self.folder, self.short = generator, folder, short
        # Without new meshes, once in a while: between platens, and not far.
        self.fixed = generator.random() >= 0.97
        self.what = ""
        self.prefix = ""  # of the operation that is drawn: "Operation NAME/"
        self.entries = {"Remeshing/Enabled": "true", "Time stepping/Most steps": 600}
        self.ends = []  # for each operation: {"stroke": mm, "height": mm, "force": N}
        self.pressing = []  # for each operation: {tool that can only press along z: sign of its force}
        self.size = 10 ** generator.uniform(0.6, 2.1)  # radius of the workpiece or of the tool [mm]
        self.speed = self.size * 10 ** generator.uniform(-2, 0.7)
        self.cells = generator.randint(40, 60) if short else generator.randint(50, 150)
        self.material()
        if generator.random() < 0.15:
            self.refinement()

    def set(self, entry, value):
        self.entries[self.prefix + entry] = value

    def share(self, low, high):
        return self.random.uniform(low, high)

    def material(self):
        """Of metals, cold to hot."""
        model = self.random.choice(
            ("perfectly plastic", "hollomon", "swift", "power law", "product", "perzyna", "table"))
        stress, hardening, rate = self.share(50, 900), self.share(0.05, 0.35), self.share(0.03, 0.25)
        reference = self.speed / self.size
        prestrain = self.share(0.005, 0.05)
        swift = {"Strength coefficient": stress, "Prestrain": prestrain, "Hardening exponent": hardening}
        power = {"Rate exponent": rate, "Reference strain rate": reference}
        values = {
            "perfectly plastic": {"Yield stress": stress},
            "hollomon": {"Strength coefficient": stress, "Hardening exponent": hardening},
            "swift": swift,
            "power law": {"Strength coefficient": stress, **power},
            "product": {"Hardening": "swift", **swift, "Rate sensitivity": "power", **power},
            "perzyna": {"Yield stress": stress, **power, "Reference strain rate": 3 * reference},
            "table": {"Table file": "flow_stress.csv"},
        }[model]
        if model == "table":
            rates = [reference * factor for factor in (0.01, 1, 100, 10000)]
            rows = ["strain/rate, " + ", ".join(f"{value:.6g}" for value in rates)]
            for strain in (0, 0.05, 0.2, 0.5, 1, 2, 4, 8):
                static = stress * (0.02 + strain) ** hardening
                stresses = (static * (value / reference) ** (0.3 * rate) for value in rates)
                rows.append(f"{strain}, " + ", ".join(f"{value:.6g}" for value in stresses))
            (self.folder / "flow_stress.csv").write_text("\n".join(rows) + "\n")
        self.entries["Material/Model"] = model
        self.entries.update({f"Material/{entry}": value for entry, value in values.items()})
        self.stress, self.model = stress, model

    def refinement(self):
        self.entries["Refinement/Enabled"] = "true"
        self.entries["Refinement/Largest level"] = self.random.choice((1, 2))
        self.entries["Refinement/Most cells"] = 200 if self.short else 400

    def friction(self, tool):
        law = self.random.choice(("none", "coulomb", "coulomb", "shear", "shear", "arctan", "smm", "smm",
                                  "sticking", "norton", "tangential forces"))
        entries = {"Law": law}
        if law == "coulomb":
            entries["Coefficient"] = self.share(0.02, 0.35)
        elif law in ("shear", "arctan", "smm"):
            entries["Factor"] = self.share(0.05, 0.95)
        elif law == "tangential forces":
            # Large ones drive the surface by themselves where the slip turns round (doc/stability.md).
            entries["Factor"] = 0.5 * self.share(0.05, 0.6)
        elif law == "norton":
            entries["Exponent"] = self.share(0.1, 1)
            entries["Viscosity"] = self.share(0.05, 0.5) * self.stress / self.speed ** entries["Exponent"]
        for entry, value in entries.items():
            self.set(f"Tool {tool}/Friction/{entry}", value)

    def tool(self, name, outline, velocity=None, touching=False):
        """A tool with its file; velocity as (r, z)."""
        file = (self.prefix.split()[-1].replace("/", "_") if self.prefix else "") + name + ".geo"
        outline.write(self.folder / file)
        self.set(f"Tool {name}/Geometry file", file)
        if touching:
            self.set(f"Tool {name}/Start", "touching")
        if velocity:
            self.set(f"Tool {name}/Motion/Type", "constant velocity")
            self.set(f"Tool {name}/Motion/Velocity", f"{velocity[0]:.10g}, {velocity[1]:.10g}")
        self.friction(name)

    def workpiece(self, points, symmetry=False):
        size = write_workpiece(self.folder / "workpiece.geo", points, self.cells, symmetry)
        self.entries["Workpiece/Geometry file"] = "workpiece.geo"
        if len(points) != 4:
            self.entries["Workpiece/Element size"] = size

    def end(self, tools, stroke, height=None, force=None, pressing=None):
        """End of an operation. The short form goes half of the way, all of it if `stroke` is a tuple."""
        whole = isinstance(stroke, tuple)
        stroke = stroke[0] if whole else stroke
        wanted = {"stroke": stroke * (0.5 if self.short and not whole else 1.0)}
        pressing = pressing or {}
        if self.fixed and "upper" in pressing and not self.prefix:
            self.entries["Remeshing/Enabled"] = "false"
            wanted["stroke"] *= 0.4
        self.set("Tools", ", ".join(tools))
        if height and (whole or not self.short):
            wanted["stroke"] *= 1.05
            wanted["height"] = height
            self.set("Process/End height", height)
        if force:
            wanted["force"] = force
            self.set("Process/End force", force)
        self.set("Process/End stroke", wanted["stroke"])
        self.ends.append(wanted)
        self.pressing.append(pressing)


def rectangle(radius, height, lowest=0.0, inner=0.0):
    return [(inner, lowest), (radius, lowest), (radius, lowest + height), (inner, lowest + height)]


def chamfered(radius, height, cut):
    return [(0, 0), (radius - cut, 0), (radius, cut), (radius, height), (0, height)]


def platen(z, radius):
    return Outline([(0.0, z), (radius, z)])


def fillet(scene, low, high, sharp=0.2):
    """A radius as a share, once in a while 0."""
    return 0.0 if scene.random.random() < sharp else scene.share(low, high)


def die(scene, rim, depth, gap, kinds):
    """A lower die with its land at z = 0, and its kind. Cavity to r = rim, draft, fillets, land, gutter."""
    slope = math.tan(math.radians(scene.share(2, 10)))
    land = gap * scene.share(3, 5)
    gutter = scene.share(1, 2) * gap
    kind = scene.random.choice(kinds)
    f = lambda: rim * fillet(scene, 0.03, 0.12)  # noqa: E731
    foot = rim - depth * slope
    points, radii = [], []
    if kind == "boss":
        radius, deep = rim * scene.share(0.3, 0.5), rim * scene.share(0.1, 0.35)
        points = [(0, -depth - deep), (radius - deep * slope, -depth - deep), (radius, -depth)]
        radii = [0, f(), f()]
    elif kind == "pin":
        radius, high = rim * scene.share(0.2, 0.4), depth * scene.share(0.3, 0.8)
        points = [(0, -depth + high), (radius, -depth + high), (radius + high * slope, -depth)]
        radii = [0, f(), f()]
    elif kind == "dish":
        points, radii = [(0, -depth)], [0]
    if kind == "flat":
        points, radii = [(0, 0)], [0]
    else:
        points += [(foot, -depth), (rim, 0)]
        radii += [f(), gap * fillet(scene, 0.3, 1.5)]
    points += [(rim + land, 0)]
    radii += [gap * scene.share(0.3, 1)]
    if kind != "flat":
        points += [(rim + land + gutter, -gutter)]
        radii += [gap * scene.share(0.3, 1)]
    points += [(3 * rim, points[-1][1])]
    radii += [0]
    return Outline(points, radii), kind


def flash_pair(scene, rim):
    """Lower die, upper die where it ends, their kinds, and the gap of the flash."""
    gap = rim * (scene.share(0.05, 0.08) if scene.short else scene.share(0.025, 0.07))
    kinds = ("dish", "boss", "boss", "pin")
    lower, below = die(scene, rim, rim * scene.share(0.12, 0.35), gap, (*kinds, "flat"))
    upper, above = die(scene, rim, rim * scene.share(0.12, 0.35), gap, kinds)
    return lower, upper.mirrored().moved(gap), below, above, gap


def closed_die(scene):
    """Two dies with flash land and gap, and a billet that more or less fills them."""
    rim = scene.size
    while True:
        lower, upper, below, above, gap = flash_pair(scene, rim)
        fill = scene.share(0.92, 1.1)
        volume = fill * volume_between(lower, upper, rim)
        radius = rim * scene.share(0.35, 0.85)
        height = volume / (math.pi * radius ** 2)
        billet = Outline([(0, 0), (radius, 0)])
        rest = way_down(billet, lower)  # how far a flat billet at z = 0 comes down
        top = Outline([(0, height - rest), (radius, height - rest)])
        stroke = -way_down(upper, top)  # from touching to its end
        # Not so slender that it folds, and something to form.
        if 0.4 < height / radius < 2.8 and stroke > 0.15 * height:
            break
    scene.workpiece(rectangle(radius, height))
    scene.what = f"{below} below, {above} above, {100 * fill:.0f} % full"
    scene.tool("lower", lower)
    scene.tool("upper", upper.moved(height + 2 * rim), (0, -scene.speed), touching=True)
    scene.set("Placement/Rest on", "lower")
    # On the axis from end to end: the height of the workpiece says where the dies stand.
    flat = below in ("dish", "flat") and above in ("dish", "flat")
    last = upper.points[0][1] - lower.points[0][1]
    force = math.pi * rim ** 2 * scene.stress * scene.share(2, 6) if scene.random.random() < 0.25 else None
    if scene.random.random() < 0.3:
        scene.set("Process/Fill radius", rim)
    scene.end(["lower", "upper"], stroke, last if flat and scene.random.random() < 0.6 else None, force)


def container(radius, height, corner=0.0, bottom=True):
    """Wall of a container, with its bottom at z = 0 or without."""
    points = [(radius, 0.0), (radius, height)]
    return Outline([(0, 0), *points], [0, corner, 0]) if bottom else Outline(points)


def backward_extrusion(scene):
    """A punch into a billet in a container, with or without an ejector."""
    radius = scene.size
    height = radius * scene.share(0.7, 1.8)
    ejector = scene.random.random() < 0.4
    corner = 0.0 if ejector else radius * fillet(scene, 0.03, 0.2, 0.5)
    clearance = 0.0 if scene.random.random() < 0.5 else radius * scene.share(0.01, 0.06)
    own = radius - clearance
    scene.workpiece(chamfered(own, height, corner) if corner else rectangle(own, height))
    punch = radius * scene.share(0.45, 0.85)
    corners = (0.0, scene.share(0.02, 0.1), scene.share(0.1, 0.4), scene.share(0.4, 0.9))
    edge = punch * scene.random.choice(corners)
    # A sharp corner takes many steps.
    stroke = height * scene.share(0.25, 0.7) * (0.6 if edge < 0.03 * punch else 1.0)
    nose = punch * math.tan(math.radians(scene.random.choice((0, 0, scene.share(1, 12)))))
    wall = height + stroke * radius ** 2 / (radius ** 2 - punch ** 2) + 2 * radius
    points, radii = [(0, height), (punch, height + nose)], [0, edge]
    if scene.random.random() < 0.5:
        relief, land = punch * scene.share(0.01, 0.03), edge + nose + punch * scene.share(0.1, 0.3)
        points += [(punch, height + land), (punch - relief, height + land + 2 * relief)]
        points += [(punch - relief, height + wall)]
        radii += [0, 0, 0]
    else:
        points += [(punch, height + wall)]
        radii += [0]
    scene.tool("punch", Outline(points, radii), (0, -scene.speed))
    scene.tool("container", container(radius, wall, corner, not ejector))
    if ejector:
        scene.tool("ejector", platen(0.0, radius * scene.random.choice((1, 1.5))))
    scene.what = f"punch {punch / radius:.2f}, corner {edge / punch:.2f}, clearance {clearance / radius:.2f}"
    tools = ["punch", "container"] + ["ejector"] * ejector
    scene.end(tools, stroke, pressing={"ejector": 1} if ejector else None)


def forward_extrusion(scene):
    """A ram pushes a billet through a die: conical, rounded, or a flat one with a sharp or rounded mouth."""
    radius = scene.size
    exit = radius * math.sqrt(1 - scene.share(0.15, 0.65))
    kind = scene.random.choice(("conical", "rounded", "flat", "sharp"))
    angle = math.radians(90 if kind in ("flat", "sharp") else scene.share(20, 70))
    deep = (radius - exit) / math.tan(angle) if angle < 1.57 else 0.0
    bearing = exit * scene.share(0.1, 0.4)
    height = radius * scene.share(1, 2.2)
    stroke = height * scene.share(0.2, 0.55)
    mouth = 0.0 if kind in ("sharp", "conical") else exit * scene.share(0.1, 0.5)
    throat = 0.0 if kind != "rounded" else radius * scene.share(0.1, 0.5)
    relief = exit * scene.share(0.02, 0.05)
    low = -deep - bearing
    out = stroke * (radius / exit) ** 2 + radius
    points = [(exit + relief, low - 2 * relief - out), (exit + relief, low - 2 * relief), (exit, low)]
    points += [(exit, -deep), (radius, 0), (radius, height + radius)]
    outline = Outline(points, [0, 0, 0, mouth, throat, 0])
    # The blank has the die's cone, where it has one, or stands on it with its corner.
    nosed = kind == "conical" and scene.random.random() < 0.6
    clearance = 0.0 if kind == "rounded" or scene.random.random() < 0.6 else radius * scene.share(0.005, 0.03)
    if nosed:
        clearance = 0.0
        blank = [(0, -deep), (exit, -deep), (radius, 0), (radius, height), (0, height)]
    else:
        blank = rectangle(radius - clearance, height)
        scene.set("Placement/Rest on", "die")
    scene.workpiece(blank)
    scene.tool("die", outline)
    ram = platen(height + (0 if nosed else radius), radius * scene.random.choice((1, 1.3)))
    scene.tool("ram", ram, (0, -scene.speed), touching=not nosed)
    scene.what = f"{kind}, reduction {1 - (exit / radius) ** 2:.2f}{', blank with a cone' if nosed else ''}"
    scene.end(["ram", "die"], stroke, pressing={"ram": 1})


def simple_upper(scene, kind, radius, height):
    """An upper tool that touches a flat workpiece at z = height."""
    wide = 6 * radius
    if kind == "platen":
        return platen(height, wide)
    if kind == "cone":
        tip, angle = radius * scene.share(0, 0.3), math.radians(scene.share(5, 35))
        points = [(0, height), (tip, height), (wide, height + (wide - tip) * math.tan(angle))]
        return Outline(points, [0, radius * fillet(scene, 0.05, 0.3), 0])
    if kind == "hole":
        hole, draft = radius * scene.share(0.3, 0.6), math.tan(math.radians(scene.share(2, 8)))
        deep = min(2 * hole, 0.8 * hole / draft)
        points = [(0, height + deep), (hole - deep * draft, height + deep), (hole, height), (wide, height)]
        return Outline(points, [0, hole * scene.share(0.1, 0.3), hole * fillet(scene, 0.1, 0.4, 0.1), 0])
    if kind == "punch":
        punch = radius * scene.share(0.35, 0.7)
        points = [(0, height), (punch, height), (punch, height + 6 * radius)]
        return Outline(points, [0, punch * fillet(scene, 0.1, 0.5), 0])
    # A dish: a shallow cavity that is wider than the workpiece gets.
    deep = 0.25 * radius
    points = [(0, height), (1.3 * radius, height), (1.45 * radius, height - deep), (wide, height - deep)]
    return Outline(points, [0, radius * fillet(scene, 0.05, 0.1), radius * fillet(scene, 0.05, 0.1), 0])


def target_accuracy(scene):
    """Upsetting and simple dies with a mesh and steps that follow a target accuracy."""
    scene.refinement()
    target = scene.random.choice((5, 8) if scene.short else (2, 3, 5))
    scene.set("Accuracy/Target accuracy", f"{target} %")
    radius = scene.size
    height = radius * scene.share(0.6, 2)
    half = scene.random.random() < 0.3
    kind = "platen" if half else scene.random.choice(("platen", "platen", "cone", "hole", "punch"))
    scene.workpiece(rectangle(radius, height), half)
    scene.tool("upper", simple_upper(scene, kind, radius, height), (0, -scene.speed))
    reduction = scene.share(0.2, 0.55) if kind in ("platen", "hole") else scene.share(0.15, 0.35)
    tools, pressing = ["upper"], {}
    if kind == "platen":
        pressing["upper"] = 1
    if not half:
        scene.tool("lower", platen(0.0, 6 * radius))
        tools.append("lower")
        pressing["lower"] = 1
    scene.what = f"{kind}{', half' if half else ''}, {target} %"
    scene.end(tools, reduction * height, pressing=pressing)


def tapered_billet(scene):
    """Tapered, stepped, chamfered billets between platens, under simple tools or with the neck in a die."""
    radius = scene.size
    height = radius * scene.share(0.9, 2.2)
    kind = scene.random.choice(("tapered", "barrel", "stepped", "chamfered", "in a hole"))
    neck, at = radius * scene.share(0.6, 0.85), height * scene.share(0.4, 0.6)
    cut = radius * scene.share(0.05, 0.25)
    blunt = 0.15 * radius  # a step has a slope
    points = {
        "tapered": [(0, 0), (radius, 0), (neck, height), (0, height)],
        "barrel": [(0, 0), (neck, 0), (radius, at), (neck, height), (0, height)],
        "stepped": [(0, 0), (radius, 0), (radius, at), (neck, at + blunt), (neck, height), (0, height)],
        "chamfered": [(0, 0), (radius - cut, 0), (radius, cut), (radius, height - cut),
                      (radius - cut, height), (0, height)],
        "in a hole": [(0, 0), (neck, 0), (neck, at), (radius, at), (radius, height), (0, height)],
    }[kind]
    scene.workpiece(points)
    if kind == "in a hole":
        upper, wide = "platen", 6 * radius
        hole = neck * scene.random.choice((1.0, 1.02))
        scene.tool("lower", Outline([(0, 0), (hole, 0), (hole, at), (wide, at)]))
        reduction = scene.share(0.2, 0.5) * (height - at)
    else:
        upper = scene.random.choice(("platen", "platen", "hole", "cone"))
        scene.tool("lower", platen(0.0, 6 * radius))
        # The neck is upset, but does not come down on the step.
        stepped = kind == "stepped"
        reduction = scene.share(0.15, 0.3) * (height - at) if stepped else scene.share(0.2, 0.5) * height
        if upper == "cone":
            reduction *= 0.6
    outline = simple_upper(scene, upper, neck if kind != "in a hole" else radius, height)
    scene.tool("upper", outline, (0, -scene.speed))
    pressing = {"lower": 1} if kind != "in a hole" else {}
    if upper == "platen":
        pressing["upper"] = 1
    scene.what = f"{kind}, {upper}"
    scene.end(["upper", "lower"], reduction, pressing=pressing)


def ring(scene):
    """Rings between platens, on mandrels, and widened by a conical mandrel."""
    radius = scene.size
    inner = radius * scene.share(0.4, 0.7)
    height = (radius - inner) * scene.share(0.6, 1.8)
    kind = scene.random.choice(("platens", "mandrel", "mandrel", "expanded"))
    scene.workpiece(rectangle(radius, height, inner=inner))
    tools, pressing = ["upper", "lower"], {"lower": 1}
    scene.tool("lower", platen(0.0, 4 * radius))
    if kind == "expanded":
        angle, top = math.radians(scene.share(10, 25)), inner * scene.share(1.08, 1.25)
        tip = 0.7 * inner
        # The cone touches the bore's upper edge at the start.
        base = height - (inner - tip) / math.tan(angle)
        upper_end = base + (top - tip) / math.tan(angle)
        stroke = scene.share(0.4, 0.9) * (upper_end - height)
        # It must not get to the lower platen.
        stroke = min(stroke, 0.9 * height)
        points = [(0.3 * inner, base), (tip, base), (top, upper_end), (top, upper_end + 3 * radius)]
        scene.tool("upper", Outline(points[1:], [0, inner * scene.share(0.05, 0.3), 0]), (0, -scene.speed))
    else:
        stroke = scene.share(0.2, 0.5) * height
        scene.tool("upper", platen(height, 4 * radius), (0, -scene.speed))
        pressing["upper"] = 1
        if kind == "mandrel":
            mandrel = inner * scene.random.choice((1.0, scene.share(0.9, 0.99)))
            scene.tool("mandrel", Outline([(mandrel, -0.5 * height), (mandrel, 1.5 * height)]))
            tools.append("mandrel")
    scene.what = f"{kind}, bore {inner / radius:.2f}"
    scene.end(tools, stroke, pressing=pressing)


def several_tools(scene):
    """Punches from one or two sides, in a container or not, jaws, heading."""
    radius = scene.size
    height = radius * scene.share(0.8, 2)
    kind = scene.random.choice(("indentation", "two punches", "double cup", "jaws", "heading", "ring punch"))
    pressing = {}
    punch = radius * scene.share(0.4, 0.75)
    shank = 6 * (radius + height)

    def punch_from_above(r, z):
        return Outline([(0, z), (r, z), (r, z + shank)], [0, r * fillet(scene, 0.05, 0.5), 0])

    if kind == "jaws":
        height = radius * scene.share(2, 3.5)
        width = height * scene.share(0.1, 0.2)
        far = 4 * radius
        scene.workpiece(rectangle(radius, height))
        below, above = 0.5 * height - width, 0.5 * height + width
        points = [(far, below), (radius, below), (radius, above), (far, above)]
        scene.tool("jaw", Outline(points, width * scene.share(0.2, 0.6)), (-scene.speed, 0))
        scene.set("Tool jaw/Friction/Law", "shear")  # it holds the bar
        for entry in ("Coefficient", "Viscosity", "Exponent"):
            scene.entries.pop(f"Tool jaw/Friction/{entry}", None)
        scene.set("Tool jaw/Friction/Factor", scene.share(0.2, 0.9))
        scene.tool("lower", platen(0.0, 3 * radius))
        tools, stroke = ["jaw", "lower"], radius * scene.share(0.1, 0.3)
        pressing["lower"] = 1
    elif kind == "heading":
        head = height * scene.share(0.3, 0.6)
        scene.workpiece(rectangle(radius, height))
        grip = height - head
        scene.tool("die", Outline([(0, 0), (radius, 0), (radius, grip), (5 * radius, grip)],
                                  [0, 0, min(radius, grip) * fillet(scene, 0.03, 0.15), 0]))
        scene.tool("header", platen(height, 5 * radius), (0, -scene.speed))
        tools, stroke = ["header", "die"], head * scene.share(0.3, 0.65)
        pressing["header"] = 1
    elif kind == "double cup":
        scene.workpiece(rectangle(radius, height))
        stroke = 0.5 * height * scene.share(0.3, 0.6)
        scene.tool("upper", punch_from_above(punch, height), (0, -scene.speed))
        counter = punch_from_above(radius * scene.share(0.4, 0.75), 0.0).mirrored()
        both = scene.random.random() < 0.5
        scene.tool("counter", counter, (0, scene.speed * scene.share(0.3, 1)) if both else None)
        scene.tool("container", Outline([(radius, -shank), (radius, shank)]))
        tools = ["upper", "counter", "container"]
    else:
        scene.workpiece(rectangle(radius, height))
        stroke = height * scene.share(0.15, 0.4)
        if kind == "two punches":
            scene.tool("upper", punch_from_above(punch, height), (0, -scene.speed))
            scene.tool("lower", punch_from_above(punch * scene.share(0.9, 1.1), 0.0).mirrored())
        elif kind == "ring punch":
            outer = radius * scene.share(0.7, 0.9)
            hole = outer * scene.share(0.4, 0.6)
            points = [(hole, height + shank), (hole, height), (outer, height), (outer, height + shank)]
            scene.tool("upper", Outline(points, (outer - hole) * fillet(scene, 0.1, 0.4)), (0, -scene.speed))
            scene.tool("lower", platen(0.0, 5 * radius))
            pressing["lower"] = 1
        else:
            scene.tool("upper", punch_from_above(punch, height), (0, -scene.speed))
            scene.tool("lower", platen(0.0, 5 * radius))
            pressing["lower"] = 1
        tools = ["upper", "lower"]
    scene.what = kind
    scene.set("Process/Driving tool", tools[0])
    scene.end(tools, stroke, pressing=pressing)


def chain(scene):
    """Two to four operations with tools of their own; the workpiece is turned over before some."""
    radius = scene.size
    height = radius * scene.share(1.2, 2.4)
    scene.workpiece(rectangle(radius, height))
    n = scene.random.choice((2, 2, 3) if scene.short else (2, 3, 4))
    names, kinds = [f"op{i + 1}" for i in range(n)], []
    last = ("platen", "hole", "punch", "dish", "cone")
    scene.entries["Operations"] = ", ".join(names)
    for i, name in enumerate(names):
        scene.prefix = f"Operation {name}/"
        # Punches and holes come last: what they leave would fold.
        kind = scene.random.choice(("platen", "platen", "cone", "dish") if i < n - 1 else last)
        if kind in ("cone", "hole") and kinds and kinds[-1] == "cone":
            kind = "platen"
        kinds.append(kind)
        reduction = scene.share(0.1, 0.3)
        if kind in ("cone", "punch", "dish"):
            reduction *= 0.6
        if i and scene.random.random() < 0.4:
            scene.set("Placement/Flip", "true")
        scene.set("Placement/Rest on", "lower")
        scene.tool("lower", platen(0.0, 8 * radius))
        scene.tool("upper", simple_upper(scene, kind, radius, 4 * height), (0, -scene.speed), touching=True)
        if scene.random.random() < 0.4:
            scene.set("Process/Dwell", scene.share(0.1, 5))
        pressing = {"lower": 1}
        if kind == "platen":
            pressing["upper"] = 1
        scene.end(["upper", "lower"], reduction * height, pressing=pressing)
        height *= 1 - reduction
        radius /= math.sqrt(1 - reduction)
    scene.prefix = ""
    scene.what = ", ".join(kinds)


def full_die(scene):
    """A container without flash that gets full: the operation ends there."""
    radius = scene.size
    kind = scene.random.choice(("clearance", "cavity", "cup"))
    height = radius * scene.share(0.6, 1.6)
    wide = scene.random.choice((1, 1.3))
    pressing = {"ram": 1}
    if kind == "clearance":
        own = radius * scene.share(0.88, 0.99)
        box = container(radius, 3 * height, (radius - own) * fillet(scene, 0.3, 0.9, 0.5))
        ram = platen(height, wide * radius)
    elif kind == "cavity":
        hole, deep = radius * scene.share(0.4, 0.75), radius * scene.share(0.1, 0.35)
        foot = hole - deep * math.tan(math.radians(scene.share(2, 30)))
        own = radius * scene.random.choice((1.0, scene.share(0.93, 0.99)))
        r = deep * fillet(scene, 0.1, 0.4)
        points = [(0, -deep), (foot, -deep), (hole, 0), (radius, 0), (radius, 3 * height)]
        box = Outline(points, [0, r, r, 0, 0])
        ram = platen(height, wide * radius)
    else:
        punch, deep = radius * scene.share(0.4, 0.75), height * scene.share(0.15, 0.4)
        foot = punch - deep * math.tan(math.radians(scene.share(2, 15)))
        own = radius * scene.random.choice((1.0, scene.share(0.95, 0.99)))
        r = deep * fillet(scene, 0.1, 0.4)
        box = container(radius, 3 * height + 3 * deep)
        # Full when the shoulder comes down on the rim.
        points = [(0, height), (foot, height), (punch, height + deep), (wide * radius, height + deep)]
        ram = Outline(points, [0, r, r, 0])
        pressing = {}
    scene.workpiece(rectangle(own, height))
    scene.tool("container", box)
    scene.tool("ram", ram, (0, -scene.speed))
    empty = volume_between(box, ram, radius, 2000) - math.pi * own ** 2 * height
    stroke = empty / (math.pi * radius ** 2)
    scene.what = f"{kind}{', tight' if own == radius else ''}"
    scene.end(["ram", "container"], (1.1 * stroke,), pressing=pressing)
    scene.ends[-1]["full"] = stroke


CLASSES = {
    "closed die with flash": closed_die,
    "backward extrusion": backward_extrusion,
    "forward extrusion": forward_extrusion,
    "target accuracy": target_accuracy,
    "tapered billet": tapered_billet,
    "ring": ring,
    "several tools": several_tools,
    "chain": chain,
    "full die": full_die,
}


def draw(number, folder, short=False):
    """A scene by its number, with its files in the folder. Each has a generator of its own."""
    scene = Scene(random.Random(f"{SEED} {number}"), folder, short)
    scene.kind = list(CLASSES)[number % len(CLASSES)]
    scene.entries["Title"] = scene.kind
    CLASSES[scene.kind](scene)
    return scene


POWERS = ("tools", "boundaries", "plastic", "friction", "contact", "volume")


def laws(scene):
    return sorted({str(value) for entry, value in scene.entries.items() if entry.endswith("Friction/Law")})


def wrong(scene, outcome):
    """What a run with status 0 does not keep to, or None."""
    rows = outcome.rows
    largest = max(abs(row[column]) for row in rows for column in row if column.startswith("power_"))
    least = {name: min(row[f"power_{name}_mW"] for row in rows) for name in ("plastic", "friction")}
    if abs(outcome.volume_change) > 1e-4:
        return f"volume off by {outcome.volume_change:.1e}"
    if least["plastic"] < -1e-6 * largest:
        return "plastic power below 0"
    # Tangential forces go by the slip of the last step.
    if "tangential forces" not in laws(scene) and least["friction"] < -1e-6 * largest:
        return "friction gives power"
    for row in rows:
        powers = sum(abs(row[f"power_{name}_mW"]) for name in POWERS)
        powers = max(powers, 1e-6 * largest)  # a step may carry the workpiece along as a rigid body
        if abs(row["power_residual_mW"]) > 1e-3 * powers:
            share = abs(row["power_residual_mW"]) / powers
            return f"power off by {share:.1e} of all powers in step {row['step']:.0f}"
    if len(outcome.operations) != len(scene.ends):
        return f"{len(outcome.operations)} of {len(scene.ends)} operations"
    for rows, wanted, pressing in zip(outcome.operations, scene.ends, scene.pressing):
        for tool, sign in pressing.items():
            forces = [sign * row[f"force_{tool}_N"] for row in rows]
            if min(forces) < -1e-3 * max(map(abs, forces)):
                return f"tool {tool} pulls"
        last = rows[-1]
        if "full" in wanted:
            # Corners fill to the last bit at no stroke to speak of.
            if "the die is full" not in outcome.message:
                return "the die is full, and nothing says so"
            if not 0.98 <= last["stroke_mm"] / wanted["full"] <= 1.01:
                return f"full at {last['stroke_mm']:g} mm, and should be at {wanted['full']:g} mm"
        elif not (last["stroke_mm"] >= wanted["stroke"] * (1 - 1e-6)
                  or last["height_mm"] <= wanted.get("height", 0.0) * (1 + 1e-3)
                  or last[f"end_force_{driving(scene)}_N"] >= 0.99 * wanted.get("force", math.inf)):
            return f"stroke {last['stroke_mm']:g} of {wanted['stroke']:g} mm"
    return None


def driving(scene):
    """The first tool that moves."""
    tools = [entry.split("/")[-3].split()[1] for entry in scene.entries if entry.endswith("Motion/Type")]
    return tools[0]


def reached(scene, outcome):
    """Stroke over what was wanted, of the operation in which it ended."""
    if not outcome.operations:
        return 0.0
    return outcome.operations[-1][-1]["stroke_mm"] / scene.ends[len(outcome.operations) - 1]["stroke"]


def judged(scene, outcome):
    """right, wrong, cannot go on, refused, or not in time, and why."""
    lines = outcome.message.strip().split("\n")
    message = " ".join(line for line in lines if not line.startswith(("Note", "Warning"))).strip()
    if outcome.status == 0 and outcome.rows:
        fault = wrong(scene, outcome)
        full = "the die is full" if "the die is full" in outcome.message else ""
        return ("wrong", fault) if fault else ("right", full)
    if outcome.status == 2:
        return "cannot go on" if lines[-1].startswith("axiforge: ") else "no reason", message
    return {1: "refused", None: "not in time"}.get(outcome.status, "crashed"), message


EVERY = ["scene", "class", "what", "material", "friction", "status", "ends", "of the stroke", "steps",
         "cells", "remeshings", "repeats", "power residual", "volume change", "CPU [s]", "message"]


def run_one(program, number, short, folder):
    """Row of a scene."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    scene = draw(number, folder, short)
    outcome = program.run(scene.entries, f"scene {number}", folder)
    ends, message = judged(scene, outcome)
    row = [number, scene.kind, scene.what, scene.model, ", ".join(laws(scene)), outcome.status, ends,
           reached(scene, outcome)]
    if outcome.rows:
        row += [len(outcome.rows), int(max(outcome.column("cells"))), int(outcome.last.get("remeshings", 0)),
                outcome.repeats, outcome.power_residual, outcome.volume_change]
    else:
        row += [0, 0, 0, 0, None, None]
    return *row, outcome.cpu, message


def run(session):
    program = session.program
    program.timeout = LONGEST
    every = Table("Every scene", EVERY)
    for number in range(N_SHORT if session.short else N_SCENES):
        row = run_one(program, number, session.short, program.work / "industrial")
        row = dict(zip(EVERY, every.add(*row)))
        # A reason that is true is an end as well; how many there may be is asserted below.
        session.check(row["ends"] in ("right", "cannot go on"),
                      f"scene {number} ({row['class']}: {row['what']}): {row['ends']}: {row['message']}")
    classes, volume = summaries(every)
    right = sum(row[EVERY.index("ends")] == "right" for row in every.rows)
    least = LEAST_RIGHT[session.short] * len(every.rows)
    session.check(right >= least, f"{right} of {len(every.rows)} scenes are right")
    return [classes, volume], {"scenes": every}


def summaries(every):
    rows = [dict(zip(every.columns, row)) for row in every.rows]
    classes = Table(
        "What became of them",
        ["class", "scenes", "right", "wrong with status 0", "status 2", "other", "share right",
         "CPU, median [s]", "CPU, largest [s]"],
        f"Seed {SEED}. Right: at its end with status 0, volume to 1e-4, powers not negative and balanced to "
        "1e-3, no flat tool that pulls. Other: refused, not in time, crashed.",
    )
    for kind in (*CLASSES, "all"):
        mine = [row for row in rows if kind in (row["class"], "all")]
        if not mine:
            continue
        count = collections.Counter(row["ends"] for row in mine)
        seconds = sorted(row["CPU [s]"] for row in mine)
        n_two = sum(row["status"] == 2 for row in mine)
        other = len(mine) - count["right"] - count["wrong"] - n_two
        share = f"{100 * count['right'] / len(mine):.1f} %"
        classes.add(kind, len(mine), count["right"], count["wrong"], n_two, other, share,
                    seconds[len(seconds) // 2], seconds[-1])
    done = sorted(abs(row["volume change"]) for row in rows if row["ends"] in ("right", "wrong"))
    volume = Table("Volume", ["scenes with status 0", "within 1e-5", "nine of ten within", "largest"])
    if done:
        share = sum(change <= 1e-5 for change in done) / len(done)
        volume.add(len(done), f"{100 * share:.1f} %", done[math.ceil(0.9 * len(done)) - 1], done[-1])
    return classes, volume


def main():
    layout = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=layout)
    parser.add_argument("scene", type=int)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--short", action="store_true")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    scene = draw(arguments.scene, arguments.folder, arguments.short)
    (arguments.folder / "scene.prm").write_text(parameter_text({"Output/Fields": "none", **scene.entries}))
    print(f"{scene.kind}: {scene.what}")


if __name__ == "__main__":
    main()
