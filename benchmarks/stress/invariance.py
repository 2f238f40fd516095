# SPDX-License-Identifier: GPL-2.0-or-later
"""What must not change an answer: the scene upside down or at another height, cells and nodes in another order."""
from meshes import Mesh, polyline
from scaling import difference
from scenes import HARDENING, PLASTIC
from tables import Table

TITLE = "Mirrored, shifted, renumbered"
FRICTION = {"smm": {"Law": "smm", "Factor": 0.3}, "shear": {"Law": "shear", "Factor": 0.3}}
# A punch with a flat tip and a conical side comes down on a cylinder that lies on a platen.
PUNCH = [(0.0, 40.0), (6.0, 40.0), (60.0, 52.0)]
PLATEN = [(0.0, 0.0), (200.0, 0.0)]


def scene(program, material, friction, tolerance, mirrored=False, shift=0.0, seed=None):
    mesh = Mesh(20.0, 40.0, 6, 12).distort(0.2, seed=1)
    sign = -1 if mirrored else 1
    if mirrored:
        mesh.mirror()
    mesh.map(lambda r, z: (r, z + shift))
    if seed is not None:
        mesh.renumber(seed)
    mesh.write(program.work / "workpiece.msh")
    entries = {
        "Tools": "punch, platen",
        "Workpiece/Geometry file": "workpiece.msh",
        **material,
        "Tool punch/Motion/Type": "constant velocity",
        "Tool punch/Motion/Velocity": f"0, {-0.4 * sign}",
        "Process/End stroke": 10,
        "Time stepping/Stroke per step": 0.4,
        "Flow solver/Tolerance": tolerance,
    }
    for name, outline in (("punch", PUNCH), ("platen", PLATEN)):
        polyline(program.work / f"{name}.csv", [(r, sign * z + shift) for r, z in outline])
        entries[f"Tool {name}/Geometry file"] = f"{name}.csv"
        for entry, value in FRICTION[friction].items():
            entries[f"Tool {name}/Friction/{entry}"] = value
    return entries


def run(session):
    program = session.program
    variants = {"mirrored in z": {"mirrored": True}, "shifted by 1,000 mm": {"shift": 1e3},
                "renumbered": {"seed": 1}, "mirrored, shifted, renumbered": {"mirrored": True, "shift": 77.7, "seed": 2}}
    if not session.short:
        variants.update({"shifted by 1e5 mm": {"shift": 1e5}, "shifted by 1e7 mm": {"shift": 1e7}, "shifted by 1e9 mm": {"shift": 1e9},
                         "renumbered again": {"seed": 3}, "and again": {"seed": 4}})
    materials = {"hardening": HARDENING} if session.short else {"hardening": HARDENING, "plastic": PLASTIC}
    table = Table(
        "Difference from the scene as it is",
        ["material", "friction", "tolerance", "change", "ends", "iterations", "largest difference", "in"],
        "A punch with a conical side comes down on a cylinder of 6 x 12 distorted cells that lies on a platen: 25 steps to a "
        "quarter of the height. Largest difference as in scaling.md; the signs of what points along z are those of the change.",
    )
    for name, material in materials.items():
        for friction in ("smm",) if session.short else FRICTION:
            for tolerance in (1e-8,) if session.short else (1e-5, 1e-8):
                base = program.run(scene(program, material, friction, tolerance))
                session.check(base.done, f"{name}, {friction}, {tolerance}: {base.message}")
                table.add(name, friction, f"{tolerance:.0e}", "none", base.reason or "done", base.iterations, None, "")
                for change, values in variants.items():
                    other = program.run(scene(program, material, friction, tolerance, **values))
                    if not other.done:
                        table.add(name, friction, f"{tolerance:.0e}", change, other.reason, None, None, "")
                        # So far away the rounding of the positions is more than the tolerance asks for.
                        session.check(tolerance < 1e-5 and values.get("shift", 0) >= 1e9, f"{name}, {friction}, {tolerance}, {change}: {other.message}")
                        continue
                    if values.get("mirrored"):
                        for row in other.rows:
                            # A tool at rest has its force along +z.
                            row["force_platen_N"] *= -1
                            row["end_force_platen_N"] *= -1
                    deviation, column = difference(base, other)
                    table.add(name, friction, f"{tolerance:.0e}", change, "done", other.iterations, deviation, column)
                    # The positions of a scene that is far from z = 0 are rounded.
                    rounding = abs(values.get("shift", 0)) * 2.2e-16 / 20
                    # The tolerance is one of the residual in the mean: single values may be off by some times as much.
                    allowed = max(10 * tolerance, 2e4 * rounding)
                    session.check(deviation < allowed,
                                  f"{name}, {friction}, {tolerance}, {change}: {column} differs by {deviation:.1e}")
    return [table], {"changes": table}
