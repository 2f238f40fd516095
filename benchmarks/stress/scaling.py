# SPDX-License-Identifier: GPL-2.0-or-later
"""The same scenes in other units of length, stress and time: the answers are the same numbers times powers of them."""
import re

from program import geometry_parameters
from tables import Table

TITLE = "Lengths, stresses and times in other units"


class Units:
    """What a number of the scene is multiplied with."""

    def __init__(self, length=1.0, stress=1.0, time=1.0):
        self.length, self.stress, self.time = length, stress, time
        self.speed = length / time

    def lengths(self, **values):
        return geometry_parameters(**{name: value * self.length for name, value in values.items()})

    def of(self, column):
        """The unit of a column of history.csv."""
        force = self.stress * self.length**2
        for suffix, unit in (
            ("_per_s", 1 / self.time), ("_mm3", self.length**3), ("_mm", self.length), ("_s", self.time),
            ("_N", force), ("_mW", force * self.speed), ("_MPa", self.stress),
        ):
            if column.endswith(suffix):
                return unit
        return 1.0


def material(units):
    return {
        "Material/Model": "product",
        "Material/Hardening": "swift",
        "Material/Strength coefficient": 100.0 * units.stress,
        "Material/Prestrain": 0.01,
        "Material/Hardening exponent": 0.2,
        "Material/Rate sensitivity": "power",
        "Material/Rate exponent": 0.05,
        "Material/Reference strain rate": 0.01 / units.time,
    }


def tool(units, name, file, velocity, friction, geometry):
    entries = {f"Tool {name}/Geometry file": file, f"Tool {name}/Geometry parameters": geometry}
    if velocity:
        entries[f"Tool {name}/Motion/Type"] = "constant velocity"
        entries[f"Tool {name}/Motion/Velocity"] = f"0, {velocity * units.speed!r}"
    entries.update({f"Tool {name}/Friction/{entry}": value for entry, value in friction.items()})
    return entries


def upset(units, friction, cells=8):
    return {
        "Tools": "upper",
        "Workpiece/Geometry file": "cylinder.geo",
        "Workpiece/Geometry parameters": units.lengths(Radius=25, Height=25) + f", RadialCells = {cells}, AxialCells = {cells}",
        **material(units),
        **tool(units, "upper", "platen.geo", -0.25, friction, units.lengths(Z=25, Radius=200)),
        "Process/End stroke": 7.5 * units.length,
        "Time stepping/Stroke per step": 0.5 * units.length,
    }


def cylinder(units):
    return upset(units, {"Law": "smm", "Factor": 0.5})


def norton(units):
    return upset(units, {"Law": "norton", "Viscosity": 20.0 * units.stress / units.speed**0.3, "Exponent": 0.3})


def adaptive(units):
    return {
        **upset(units, {"Law": "shear", "Factor": 0.3}, 6),
        "Refinement/Enabled": "true",
        "Refinement/Start cycles": 2,
        "Refinement/Every steps": 3,
    }


def cone(units):
    return {
        "Tools": "cone",
        "Workpiece/Geometry file": "cylinder.geo",
        "Workpiece/Geometry parameters": units.lengths(Radius=25, Height=25) + ", RadialCells = 12, AxialCells = 10",
        **material(units),
        **tool(units, "cone", "cone_tool.geo", -0.25, {"Law": "coulomb", "Coefficient": 0.1},
               "HalfAngle = 75, " + units.lengths(TipRadius=5, CornerRadius=3, Radius=60, Z=25)),
        "Process/End stroke": 4.0 * units.length,
    }


def spike(units):
    friction = {"Law": "smm", "Factor": 0.3}
    return {
        "Tools": "upper, lower",
        "Workpiece/Geometry file": "billet.geo",
        "Workpiece/Geometry parameters": units.lengths(Radius=20, Height=40, CellSize=2.5),
        **material(units),
        **tool(units, "upper", "spike_die.geo", -50, friction,
               "Draft = 5, " + units.lengths(HoleRadius=10, FilletRadius=3, Depth=45, RoofRadius=2, Radius=60, Z=40)),
        **tool(units, "lower", "platen.geo", 0, friction, units.lengths(Z=0, Radius=200)),
        "Process/End stroke": 14.0 * units.length,
        "Remeshing/Enabled": "true",
        "Remeshing/Every steps": 12,
    }


SCENES = {"cylinder, smm": cylinder, "cylinder, norton": norton, "cylinder, adaptive mesh": adaptive,
          "cone, coulomb": cone, "spike, remeshing": spike}
VARIANTS = {
    "lengths x 1e-3": Units(length=1e-3), "lengths x 1e3": Units(length=1e3),
    "stresses x 1e-6": Units(stress=1e-6), "stresses x 1e6": Units(stress=1e6),
    "times x 1e-3": Units(time=1e-3), "times x 1e3": Units(time=1e3),
    "all three": Units(1e-3, 1e6, 1e-3),
    # Numbers that binary arithmetic scales without rounding: the answers have to be the same to the last bit.
    "lengths x 2^-10": Units(length=2.0**-10), "lengths x 2^10": Units(length=2.0**10),
    "stresses x 2^-20": Units(stress=2.0**-20), "stresses x 2^20": Units(stress=2.0**20),
    "times x 2^-10": Units(time=2.0**-10), "times x 2^10": Units(time=2.0**10),
}
# What is left of the solver, and what the clock says, is no answer.
NO_ANSWER = re.compile(r"wall_|residual|divergence|power_volume|power_contact|iterations|repeats|set_changes|condition|^step$|neutral")


def difference(first, second, units=Units()):
    """Largest difference of any answer in any step over the largest value of its column."""
    if len(first.rows) != len(second.rows):
        return float("inf"), "steps"
    worst = (0.0, "")
    for column in first.rows[0]:
        if NO_ANSWER.search(column):
            continue
        a = first.column(column)
        b = [value / units.of(column) for value in second.column(column)]
        largest = max(map(abs, a))
        if column.startswith("relative_volume_change") or column.startswith("remeshing_"):
            largest = 1.0 if column.startswith("relative") else max(first.column("volume_mm3"))
        elif column.startswith("power_"):
            largest = max(map(abs, first.column("power_tools_mW")))
        elif column.startswith("radial_force_"):
            largest = max(max(map(abs, first.column(c))) for c in first.rows[0] if c.startswith("force_"))
        if largest > 0:
            worst = max(worst, (max(abs(x - y) for x, y in zip(a, b)) / largest, column))
    return worst


def run(session):
    program = session.program
    scenes = {"cylinder, smm": cylinder} if session.short else SCENES
    variants = ("lengths x 1e-3", "stresses x 1e6", "lengths x 2^10", "stresses x 2^-20") if session.short else VARIANTS
    table = Table(
        "Difference from the scene in its own units",
        ["scene", "units", "ends", "steps", "iterations", "largest difference", "in", "difference of the work"],
        "Every number of the scene that has the unit is multiplied, nothing else is changed (tolerance 1e-5, as by default). 0: the same to "
        "the last bit. Largest "
        "difference: of any answer in history.csv in any step, over the largest value of its column (powers: of the tools' power).",
    )
    for scene, entries in scenes.items():
        base = program.run(entries(Units()), f"{scene}, own units")
        session.check(base.done, f"{scene}: {base.message}")
        table.add(scene, "own", "done" if base.done else base.reason, len(base.rows), base.iterations, None, "", None)
        for name in variants:
            units = VARIANTS[name]
            other = program.run(entries(units), f"{scene}, {name}")
            if not (other.done and base.done):
                session.check(False, f"{scene}, {name}: {other.message}")
                table.add(scene, name, other.reason, len(other.rows), None, None, "", None)
                continue
            deviation, column = difference(base, other, units)
            work = other.work / (units.stress * units.length**3) / base.work - 1
            table.add(scene, name, "done", len(other.rows), other.iterations, deviation, column, work)
            # A power of the slip rounds in any units.
            if "2^" in name and not ("norton" in scene and "stresses" not in name):
                session.check(deviation == 0, f"{scene}, {name}: {column} differs by {deviation:.1e}")
            elif "remeshing" not in scene:
                session.check(deviation < 1e-8, f"{scene}, {name}: {column} differs by {deviation:.1e}")
            else:
                # Rounding decides between meshes that are as good as each other (doc/stability.md).
                session.check(abs(work) < 0.01, f"{scene}, {name}: work differs by {work:.1e}")
    return [table], {"units": table}
