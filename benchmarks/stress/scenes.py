# SPDX-License-Identifier: GPL-2.0-or-later
"""The scenes that several groups start from."""
import math

from program import geometry_parameters

PLASTIC = {"Material/Model": "perfectly plastic", "Material/Yield stress": 100}
# sigma = 100 (0.01 + strain)^0.2 (rate/(0.01/s))^0.02 MPa
HARDENING = {
    "Material/Model": "product",
    "Material/Hardening": "swift",
    "Material/Strength coefficient": 100,
    "Material/Prestrain": 0.01,
    "Material/Hardening exponent": 0.2,
    "Material/Rate sensitivity": "power",
    "Material/Rate exponent": 0.02,
    "Material/Reference strain rate": 0.01,
}
MATERIALS = {"plastic": PLASTIC, "hardening": HARDENING}


def power_law(exponent):
    """sigma = 100 rate^m MPa."""
    law = {"Material/Model": "power law", "Material/Strength coefficient": 100, "Material/Rate exponent": exponent}
    # At m = 0 there is no such law.
    return law if exponent > 0 else PLASTIC


MATERIALS["rate sensitive"] = power_law(0.2)


def platen(name, z, velocity, friction=None):
    """A flat platen; friction as {"Law": "smm", "Factor": 0.5}."""
    tool = {
        f"Tool {name}/Geometry file": "platen.geo",
        f"Tool {name}/Geometry parameters": geometry_parameters(Z=z, Radius=200.0),
    }
    if velocity != 0:
        tool[f"Tool {name}/Motion/Type"] = "constant velocity"
        tool[f"Tool {name}/Motion/Velocity"] = f"0, {velocity!r}"
    for entry, value in (friction or {}).items():
        tool[f"Tool {name}/Friction/{entry}"] = value
    return tool


def smm(factor):
    return {"Law": "smm", "Factor": factor}


def shear(factor):
    return {"Law": "shear", "Factor": factor}


def cylinder(material, friction, cells=10, stroke=2.5, step=0.25, radius=25.0, height=25.0, grading=1):
    """The upper half of a cylinder, pressed at 0.25 mm/s (the closing speed is twice that)."""
    radial, axial = cells if isinstance(cells, tuple) else (cells, cells)
    return {
        "Tools": "upper",
        "Workpiece/Geometry file": "cylinder.geo",
        "Workpiece/Geometry parameters": geometry_parameters(
            Radius=radius, Height=height, RadialCells=radial, AxialCells=axial, Grading=grading
        ),
        **material,
        **platen("upper", height, -0.25, friction),
        "Process/End stroke": stroke,
        "Time stepping/Stroke per step": step,
    }


def frictionless_force(radius, height, speed, strokes, flow_stress, regularisation=1e-3):
    """
    Force of frictionless upsetting in each step as the midpoint rule has it, exactly: a step with the
    rate e = V/h_m moves r by (1 + q)/(1 - q), q = dt e/4. flow_stress(strain, rate) in MPa; the height
    is that of the half model.
    """
    first_rate = speed / height
    forces, strain = [], 0.0
    for stroke in strokes:
        middle = height - 0.5 * stroke
        rate = speed / middle
        dt = stroke / speed
        q = 0.25 * dt * rate
        regular = math.hypot(rate, regularisation * first_rate)
        next_radius = radius * (1 + q) / (1 - q)
        stress = flow_stress(strain + 0.5 * dt * rate, regular) * rate / regular
        forces.append(math.pi * (0.5 * (radius + next_radius)) ** 2 * stress)
        strain += dt * rate
        radius, height = next_radius, height - stroke
    return forces
