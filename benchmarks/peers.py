#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Run time against error beside FreeFEM and CalculiX: cylinder upsetting 50 x 50 mm to 30 mm.

    scripts/benchmark.sh peers [--quick] [--case TEXT] [--again] [--work FOLDER] [--report] [--results FOLDER]

Runs axiforge, FreeFEM (peers/freefem.edp) and CalculiX (peers/calculix.py) on the same cases with several meshes and
steps, one process on one core at a time, and writes peers.csv, peers.md and the plot doc/images/peers.svg. What has
been run stays in FOLDER (build/peers) and is not run again, but with another revision of axiforge or with --again;
--report only evaluates it. --case limits the cases to those that have TEXT in their name. The peers are optional: apt-get install freefem++ libfreefem++
calculix-ccx. Needs numpy and matplotlib (Debian: python3-matplotlib).
"""
import argparse
import csv
import datetime
import functools
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

try:
    import numpy as np
except ImportError:
    sys.exit("peers.py needs numpy and matplotlib: apt-get install python3-matplotlib, and run it with /usr/bin/python3")

ROOT = pathlib.Path(__file__).resolve().parent.parent
HERE = pathlib.Path(__file__).resolve().parent / "peers"
CODES = {"axiforge": "#c33", "FreeFEM": "#26a", "CalculiX": "#282"}
MATERIALS = {
    "plastic": "perfectly plastic, 100 MPa",
    "rate": "100 MPa (rate / (0.01/s))^0.2",
    "hardening": "100 MPa (0.01 + strain)^0.2",
}
FRICTIONS = {"none": "frictionless", "shear": "shear m = 0.3", "coulomb": "Coulomb 0.17", "sticking": "sticking"}
COULOMB = 0.17

SCENE = {
    "plastic": "set Model = perfectly plastic\n set Yield stress = 100",
    "rate": "set Model = power law\n set Strength coefficient = 100\n set Rate exponent = 0.2\n"
    " set Reference strain rate = 0.01",
    "hardening": "set Model = swift\n set Strength coefficient = 100\n set Prestrain = 0.01\n set Hardening exponent = 0.2",
}
LAW = {
    "none": "set Law = none",
    "shear": "set Law = shear\n  set Factor = 0.3",
    "coulomb": f"set Law = coulomb\n  set Coefficient = {COULOMB}",
    "sticking": "set Law = sticking",
}


def end_stroke(material, friction):
    """Rate-independent sliding uses the meshes of all three codes up before 10 mm; this is where it is cut."""
    return 4.0 if material == "plastic" and friction in ("shear", "coulomb") else 10.0


# ---- The runs -----------------------------------------------------------------------------------------------------


def measured(command, folder, limit, extra=None):
    """CPU and wall seconds and exit status of a process on one core; status None: it took more CPU than the limit."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", **(extra or {}))
    if os.geteuid() == 0:
        environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    start = time.monotonic()
    with open(folder / "output.txt", "w") as out:
        process = subprocess.Popen(
            ["bash", "-c", f'ulimit -t {int(limit)}; exec "$@"', "run", *map(str, command)],
            cwd=folder,
            env=environment,
            stdout=out,
            stderr=subprocess.STDOUT,
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = status
    return usage.ru_utime + usage.ru_stime, time.monotonic() - start, None if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)


def axiforge(program, material, friction, o, folder, limit):
    scene = f"""set Tools = upper
subsection Workpiece
 set Geometry file = {ROOT}/parameter_files/geometry/cylinder.geo
 set Geometry parameters = Radius = 25, Height = 25, RadialCells = {o["cells"]}, AxialCells = {o["cells"]}, Grading = {o["grading"]}
end
subsection Material
 {SCENE[material]}
end
subsection Tool upper
 set Geometry file = {ROOT}/parameter_files/geometry/platen.geo
 set Geometry parameters = Z = 25
 subsection Motion
  set Type = constant velocity
  set Velocity = 0, -0.25
 end
 subsection Friction
  {LAW[friction]}
 end
end
subsection Process
 set End stroke = {end_stroke(material, friction)}
end
subsection Time stepping
 set Stroke per step = {o["step"]}
end
subsection Output
 set Fields = none
end
"""
    if "every" in o:
        scene += f"""subsection Refinement
 set Enabled = true
 set Start cycles = {o["cycles"]}
 set Every steps = {o["every"]}
end
"""
    (folder / "scene.prm").write_text(scene)
    result = measured([program, "scene.prm", "--quiet", "--timing", "--output", "results"], folder, limit)
    whole = re.search(r"\| whole run +\|[^|]*\|[^|]*\| *([0-9.]+) \|", (folder / "output.txt").read_text())
    rows = list(csv.DictReader(open(folder / "results" / "history.csv")))
    end = [float(row["stroke_mm"]) for row in rows]
    middle = [0.5 * (a + b) for a, b in zip([0.0] + end, end)]
    return result, {
        "stroke": middle,
        "force": [float(row["force_upper_N"]) for row in rows],
        "radius": float(rows[-1]["largest_radius_mm"]),
        "unknowns": int(rows[-1]["unknowns"]),
        "end": end[-1],
        "run_cpu": float(whole.group(1)),
    }


def freefem(program, material, friction, o, folder, limit):
    command = [program, "-nw", "-ne", "-v", "0", HERE / "freefem.edp", "-material", material, "-friction", friction]
    command += ["-stroke", end_stroke(material, friction), "-n", o["cells"], "-grading", o["grading"], "-step", o["step"]]
    command += ["-tolerance", o.get("tolerance", 3e-3), "-out", "history.csv"]
    # Debian has the plug-ins where its FreeFem++ does not look
    result = measured(command, folder, limit, {"FF_LOADPATH": "/usr/lib/freefem++"})
    rows = list(csv.DictReader(open(folder / "history.csv")))
    stroke = [float(row["stroke_mm"]) for row in rows]
    return result, {
        "stroke": stroke,
        "force": [float(row["force_N"]) for row in rows],
        "radius": float(rows[-1]["radius_mm"]),
        "unknowns": 2 * (2 * o["cells"] + 1) ** 2 + (o["cells"] + 1) ** 2,
        "end": stroke[-1] + 0.5 * (stroke[-1] - stroke[-2]),
        "volume": float(rows[-1]["volume_mm3"]),
    }


def calculix(program, material, friction, o, folder, limit):
    command = [sys.executable, HERE / "calculix.py", "run.inp", "--material", material, "--friction", friction]
    command += ["--cells", o["cells"], "--grading", o["grading"], "--step", o["step"], "--element", o["element"]]
    command += ["--young", o["young"], "--poisson", o["poisson"], "--coefficient", COULOMB]
    command += ["--stroke", end_stroke(material, friction), "--platen-from", 20 if friction == "sticking" else 0.05]
    command += ["--cetol", 100]
    subprocess.run(list(map(str, command)), cwd=folder, check=True)
    result = measured([program, "run"], folder, limit)
    lines = (folder / "run.dat").read_text().split("\n")
    forces, side = {}, []
    for line, value in zip(lines, lines[2:]):
        if "total force" in line:  # of a wedge of 2 degrees
            at = float(line.split()[-1])
            forces[at] = forces.get(at, 0) - 180 * float(value.split()[1])
    for line in reversed(lines):
        words = line.split()
        if len(words) == 4:
            side.append(float(words[1]))
        elif side:
            break
    stroke = [0.25 * at for at in sorted(forces)]
    return result, {
        "stroke": stroke,
        "force": [forces[at] for at in sorted(forces)],
        "radius": 25 + max(side),
        "unknowns": 2 * ((2 * o["cells"] + 1) ** 2 - o["cells"] ** 2),
        "end": stroke[-1],
    }


RUNNERS = {"axiforge": axiforge, "FreeFEM": freefem, "CalculiX": calculix}


def variants(code, material, friction, quick):
    """Meshes and steps, the coarse ones first."""
    out = []
    if code == "axiforge":
        if friction == "none":
            return [dict(cells=2, grading=1, step=s) for s in (2.5, 1.0, 0.25)]
        table = [(4, 2, 2.0), (6, 2, 1.0), (8, 4, 0.5), (12, 4, 0.5), (16, 8, 0.25), (24, 8, 0.125)]
        out = [dict(cells=c, grading=g, step=s) for c, g, s in (table[:4] if quick else table)]
        table = [(6, 0.5, 2, 3), (8, 0.25, 2, 4), (12, 0.125, 3, 5), (16, 0.0625, 3, 8)]
        out += [dict(cells=c, grading=1, step=s, cycles=k, every=e) for c, s, k, e in (table[:2] if quick else table)]
    elif code == "FreeFEM":
        if friction == "none":
            return [dict(cells=2, grading=1, step=s) for s in (2.5, 1.0, 0.25)]
        table = [(4, 4, 1.0, 1e-2), (6, 4, 1.0, 1e-2), (8, 4, 0.5, 1e-2), (8, 4, 0.5, 3e-3), (8, 8, 0.5, 1e-2), (12, 4, 0.5, 3e-3), (16, 4, 0.25, 3e-3)]
        table += [(24, 4, 0.25, 3e-3)]
        out = [dict(cells=c, grading=g, step=s, tolerance=t) for c, g, s, t in (table[:3] if quick else table)]
    else:
        elastic = dict(young=1e6, poisson=0.3) if material != "rate" else dict(young=1e5, poisson=0.4)
        if friction == "none":
            return [dict(cells=2, grading=1, step=s, element="CAX8R", **elastic) for s in (2.5, 1.0, 0.25)]
        elastic["young"] = 1e5 if material != "rate" else 2e4
        table = [(4, 4, 1.0, "CAX8"), (6, 4, 0.5, "CAX8"), (8, 4, 0.25, "CAX8"), (4, 2, 0.5, "CAX8R"), (6, 2, 0.5, "CAX8R"), (8, 2, 0.5, "CAX8R"), (8, 4, 0.5, "CAX8R")]
        table += [(12, 4, 0.25, "CAX8"), (12, 1, 0.25, "CAX8R")]
        if material == "rate" and friction == "coulomb":
            # finer ones spend minutes in cut-backs and do not get to half the stroke
            table = [row for row in table if row[0] <= 6]
        out = [dict(cells=c, grading=g, step=s, element=e, **elastic) for c, g, s, e in (table[:2] if quick else table)]
    return out


def cost(code, o):
    """Of a run, roughly, to order them."""
    each = {"axiforge": 1, "FreeFEM": 8, "CalculiX": 20 if o.get("element") == "CAX8" else 6}[code]
    return each * o["cells"] ** 2 / o["step"] * (3 if "every" in o else 1)


REFERENCES = [dict(cells=16, grading=8, step=0.125), dict(cells=24, grading=8, step=0.0625)]
QUICK_REFERENCES = [dict(cells=16, grading=4, step=0.125), dict(cells=24, grading=4, step=0.125)]


def cases(quick):
    out = [(m, f) for f in FRICTIONS for m in MATERIALS]
    return [("rate", "shear"), ("plastic", "sticking")] if quick else out


def codes_of(friction):
    return [c for c in CODES if not (c == "CalculiX" and friction == "shear") and not (c == "FreeFEM" and friction == "coulomb")]


@functools.lru_cache
def version_of(program):
    """The line in which axiforge names its revision; the peers come from Debian and stay what they are."""
    return subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split("\n")[0].strip()


def run(programs, work, material, friction, code, o, limit, again):
    """Runs it unless this revision has done that; the record. With again = None what is there counts, whatever it is of."""
    name = "-".join(f"{key}{value}" for key, value in o.items())
    folder = work / f"{material}-{friction}" / code / name
    record = folder / "record.json"
    version = version_of(programs[code]) if code == "axiforge" else ""
    if record.exists() and not again:
        data = json.loads(record.read_text())
        if again is None or data.get("version", "") == version:
            return data
    folder.mkdir(parents=True, exist_ok=True)
    data = dict(material=material, friction=friction, code=code, options=o, version=version, date=str(datetime.date.today()))
    try:
        result, values = RUNNERS[code](programs[code], material, friction, o, folder, limit)
        cpu, wall, status = result
        if cpu < 1.5:  # short runs: the better of two
            other, second = RUNNERS[code](programs[code], material, friction, o, folder, limit)
            cpu, wall = min(cpu, other[0]), min(wall, other[1])
            if "run_cpu" in values:
                values["run_cpu"] = min(values["run_cpu"], second["run_cpu"])
        data.update(values, cpu=cpu, wall=wall, status=status)
    except (OSError, ValueError, IndexError, KeyError, AttributeError) as error:
        data.update(failed=str(error))
    record.write_text(json.dumps(data))
    for path in folder.glob("run.*"):  # CalculiX's files are large
        path.unlink()
    print(f"{material:9} {friction:8} {code:8} {name:50} {data.get('cpu', math.nan):8.2f} s to {data.get('end', 0):.2f} mm", flush=True)
    return data


# ---- Errors -------------------------------------------------------------------------------------------------------


def ideal(material, stroke):
    """Force of the frictionless cylinder, exact [N]."""
    height = 25.0 - np.asarray(stroke)
    area = math.pi * 625 * 25 / height
    if material == "plastic":
        return area * 100
    if material == "rate":
        return area * 100 * (25.0 / height) ** 0.2
    return area * 100 * (0.01 + np.log(25.0 / height)) ** 0.2


class Reference:
    """Force over that of the frictionless cylinder, a polynomial through the curve of a fine run: it leaves the
    saw-tooth of nodes that are caught out. The bar is the rms difference of those of the two finest meshes."""

    def __init__(self, material, friction, records):
        self.material, self.end = material, end_stroke(material, friction)
        if friction == "none":
            self.fit, self.bar, self.radius, self.radius_bar = None, 0.0, 25 * math.sqrt(25 / (25 - self.end)), 0.0
            return
        fits = []
        for record in records:
            stroke = np.array(record["stroke"])
            share = np.array(record["force"]) / ideal(material, stroke)
            fits.append(np.polynomial.Chebyshev.fit(stroke, share, 8))
            self.sawtooth = float(np.sqrt(np.mean((fits[-1](stroke) - share) ** 2)))
        self.fit = fits[-1]
        at = np.linspace(0.1, min(r["end"] for r in records) - 0.1, 200)
        self.bar = float(np.sqrt(np.mean((fits[-1](at) - fits[-2](at)) ** 2)))
        self.radius, self.radius_bar = records[-1]["radius"], abs(records[-1]["radius"] - records[-2]["radius"])
        self.end = min(self.end, records[-1]["end"])

    def force(self, stroke):
        return ideal(self.material, stroke) * (1 if self.fit is None else self.fit(np.asarray(stroke)))

    def mean(self):
        return float(np.mean(self.force(np.linspace(0, self.end, 500))))

    def differences(self, record):
        """Of the forces, over the mean force."""
        stroke, force = np.array(record["stroke"]), np.array(record["force"])
        keep = (stroke <= self.end + 1e-9) & (stroke > 0)
        return stroke[keep], (force[keep] - self.force(stroke[keep])) / self.mean()

    def error(self, record):
        """Root mean square over the stroke, each point standing for its surroundings."""
        stroke, difference = self.differences(record)
        edges = np.concatenate(([0.0], 0.5 * (stroke[1:] + stroke[:-1]), [self.end]))
        return float(np.sqrt(np.sum(difference**2 * np.diff(edges)) / self.end))

    def bias(self, record):
        stroke, difference = self.differences(record)
        edges = np.concatenate(([0.0], 0.5 * (stroke[1:] + stroke[:-1]), [self.end]))
        return float(np.sum(difference * np.diff(edges)) / self.end)


def front(points):
    """Pareto front of (error, seconds): from the cheapest to the most accurate."""
    out = []
    for error, cpu in sorted(points, key=lambda p: (p[1], p[0])):
        if not out or error < out[-1][0]:
            out.append((error, cpu))
    return out


def seconds_at(points, error):
    """Seconds at an error between the points of the front, in logarithms. With it how it was had: '' between points,
    '<' the cheapest run is better than that, 'extrapolated' from the last three points, '>' the most accurate run is
    worse and the time is that run's, None: no run."""
    line = front(points)
    if not line:
        return math.nan, None
    if line[0][0] <= error:
        return line[0][1], "<"
    for (e0, t0), (e1, t1) in zip(line, line[1:]):
        if e1 <= error:
            share = math.log(e0 / error) / math.log(e0 / e1)
            return t0 * (t1 / t0) ** share, ""
    # Beyond the most accurate run: no farther than a factor of 2.5, with a slope that makes sense, and only if the
    # costliest run is the most accurate one
    if len(line) > 2 and error >= 0.4 * line[-1][0] and max(points, key=lambda p: p[1])[0] < 1.05 * line[-1][0]:
        slope = np.polyfit(np.log([p[0] for p in line[-3:]]), np.log([p[1] for p in line[-3:]]), 1)[0]
        if -4 <= slope <= -0.3:
            return line[-1][1] * (error / line[-1][0]) ** slope, "extrapolated"
    return line[-1][1], ">"


# ---- Tables and plot ----------------------------------------------------------------------------------------------


def shown(value, kind):
    if kind is None:
        return "-"
    text = f"{value:.3f}" if value < 0.1 else f"{value:.2f}" if value < 10 else f"{value:.0f}" if value < 1e4 else f"{value:.1e}"
    return {"": text, "<": "< " + text, ">": "> " + text, "extrapolated": f"({text})"}[kind]


def quotient(theirs, ours):
    """Text of the ratio; in brackets if extrapolated."""
    if theirs[1] is None or ours[1] is None or (theirs[1] == ">" and ours[1] in (">", "extrapolated")):
        return "-"
    value = theirs[0] / ours[0]
    figure = f"{value:.1f}" if value < 10 else f"{value:.0f}" if value < 1e4 else f"{value:.0e}"
    figure = "> " + figure if theirs[1] == ">" else figure
    return f"({figure})" if "extrapolated" in (theirs[1], ours[1]) or ours[1] == ">" else figure


def start_up(programs, work, again):
    """CPU seconds of each program that does nothing, least of five."""
    record = work / "start.json"
    if record.exists() and not again:
        return json.loads(record.read_text())
    work.mkdir(parents=True, exist_ok=True)
    (work / "nothing.edp").write_text('load "MUMPS_seq"\nload "Element_QF"\nload "qf11to25"\n')
    nothing = {
        "axiforge": [programs["axiforge"], "--version"],
        "FreeFEM": [programs["FreeFEM"], "-nw", "-ne", "-v", "0", "nothing.edp"],
        "CalculiX": [programs["CalculiX"], "-v"],
    }
    extra = {"FF_LOADPATH": "/usr/lib/freefem++"}
    starts = {c: min(measured(nothing[c], work, 60, extra)[0] for _ in range(5)) for c in CODES if programs[c]}
    record.write_text(json.dumps(starts))
    return starts


def report(done, references, starts, results, picture):
    results.mkdir(parents=True, exist_ok=True)
    rows, fronts, nets = [], {}, {}
    for record in done:
        key = (record["material"], record["friction"])
        if key not in references:
            continue
        reference = references[key]
        complete = record.get("status") == 0 and record.get("end", 0) >= reference.end - 1e-3
        row = dict(material=key[0], friction=key[1], code=record["code"])
        row["options"] = " ".join(f"{k}={v}" for k, v in record["options"].items())
        row["complete"] = "yes" if complete else "no"
        if "cpu" in record:
            row.update(unknowns=record["unknowns"], steps=len(record["stroke"]), cpu_s=f"{record['cpu']:.3f}", wall_s=f"{record['wall']:.3f}")
            row.update(end_mm=f"{record['end']:.3f}")
            run_cpu = record.get("run_cpu", record["cpu"] - starts.get(record["code"], 0))
            row.update(run_s=f"{run_cpu:.3f}")
        if complete:
            error = reference.error(record)
            row.update(error_force=f"{error:.3e}", mean_error_force=f"{reference.bias(record):+.3e}")
            row.update(error_radius=f"{record['radius'] / reference.radius - 1:+.3e}")
            fronts.setdefault((key, record["code"]), []).append((error, record["cpu"]))
            nets.setdefault((key, record["code"]), []).append((error, run_cpu))
        rows.append(row)
    fields = "material friction code options complete unknowns steps end_mm cpu_s run_s wall_s error_force mean_error_force error_radius".split()
    with open(results / "peers.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fields)
        writer.writeheader()
        writer.writerows(rows)

    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    said = {name: sorted({record[name] for record in done if record.get(name)}) for name in ("date", "version")}
    text = [f"Machine: {cpu}, {os.cpu_count()} cores, one used. Date: {' to '.join(said['date'][:: max(1, len(said['date']) - 1)])}. {', '.join(said['version'])}.", ""]
    text += ["CPU seconds of the whole process at equal error of the force (rms over the stroke, relative to the mean force),"]
    text += ["between the points of each code's Pareto front. `<`: already the cheapest run is better. In brackets:"]
    text += ["extrapolated by the slope of the last three points of the front. `>`: no run is that accurate, time of the most"]
    text += ["accurate one. `-`: no run got to the end, or no ratio can be said. Ratios: of the whole"]
    text += ["processes, and after the slash of the runs alone: axiforge by its own table of phases (`--timing`, whole run), the peers without"]
    text += ["what they take to start and do nothing ("]
    text[-1] += ", ".join(f"{code} {seconds:.2f} s" for code, seconds in starts.items()) + ")."
    text += ["", "| material | friction | error | axiforge | its run | FreeFEM | CalculiX | FreeFEM / axiforge | CalculiX / axiforge |", "|---|---|---|---|---|---|---|---|---|"]
    for key in references:
        for error in (1e-2, 3e-3, 1e-3):
            at, ratio = {}, []
            for code in CODES:
                at[code] = (seconds_at(fronts.get((key, code), []), error), seconds_at(nets.get((key, code), []), error))
            for code in ("FreeFEM", "CalculiX"):
                ratio.append(" / ".join(quotient(at[code][i], at["axiforge"][i]) for i in (0, 1)))
            text.append(f"| {key[0]} | {FRICTIONS[key[1]]} | {100 * error:g} % | " + " | ".join([shown(*at["axiforge"][0]), shown(*at["axiforge"][1])] + [shown(*at[c][0]) for c in ("FreeFEM", "CalculiX")] + ratio) + " |")
    text += ["", "Reference curves and what the finest runs of the peers say of them. The bar is the rms difference of the fits of", "the two finest meshes; the mean error of a run has its sign, the saw-tooth averaged out.", ""]
    text += ["| material | friction | bar of the force | of the radius | code | finest run that got to the end | rms | mean error | radius |", "|---|---|---|---|---|---|---|---|---|"]
    for key, reference in references.items():
        for code in codes_of(key[1]):
            good = [r for r in rows if (r["material"], r["friction"]) == key and r["code"] == code and "error_force" in r]
            if not good:
                text.append(f"| {key[0]} | {FRICTIONS[key[1]]} | {reference.bar:.1e} | {reference.radius_bar / reference.radius:.1e} | {code} | none | | | |")
                continue
            last = max(good, key=lambda r: (r["unknowns"], r["steps"]))
            text.append(
                f"| {key[0]} | {FRICTIONS[key[1]]} | {reference.bar:.1e} | {reference.radius_bar / reference.radius:.1e} | {code} | {last['options']} | "
                f"{last['error_force']} | {last['mean_error_force']} | {last['error_radius']} |"
            )
    (results / "peers.md").write_text("\n".join(text) + "\n")
    plot(fronts, references, done, picture)


def plot(fronts, references, done, picture):
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "peers"})
    import matplotlib.pyplot as plt

    materials = [m for m in MATERIALS if any(key[0] == m for key in references)]
    frictions = [f for f in FRICTIONS if any(key[1] == f for key in references)]
    figure, axes = plt.subplots(len(frictions), len(materials), figsize=(4 * len(materials), 3.1 * len(frictions)), squeeze=False, sharex=True, sharey=True)
    for i, friction in enumerate(frictions):
        for j, material in enumerate(materials):
            axis, key = axes[i][j], (material, friction)
            axis.set_title(f"{MATERIALS[material]}\n{FRICTIONS[friction]}", fontsize=8)
            for code, colour in CODES.items():
                points = fronts.get((key, code), [])
                if not points:
                    continue
                line = front(points)
                axis.loglog([p[0] for p in points], [p[1] for p in points], ".", color=colour, alpha=0.4)
                axis.loglog([p[0] for p in line], [p[1] for p in line], "o-", color=colour, label=code, markersize=4)
            if key in references and references[key].bar > 0:
                axis.axvspan(1e-5, references[key].bar, color="#ddd", zorder=0)
            for error in (1e-2, 1e-3):
                axis.axvline(error, color="#999", linewidth=0.7, linestyle=":")
            axis.grid(alpha=0.3)
            axis.set_xlim(1e-5, 1e-1)
            axis.set_ylim(2e-2, 1e2)
            if j == 0:
                axis.set_ylabel("CPU seconds")
            if i == len(frictions) - 1:
                axis.set_xlabel("rms error of the force")
    handles, labels = {}, []
    for axis in axes.flat:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncol=3, fontsize=9)
    figure.tight_layout(rect=(0, 0, 1, 0.975))
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, metadata={"Date": None})
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="two cases, coarse: a couple of minutes; results in the work folder")
    parser.add_argument("--case", default="", help="only cases with this in their name, as plastic-sticking")
    parser.add_argument("--again", action="store_true", help="run what has been run as well")
    parser.add_argument("--work", type=pathlib.Path, default=None)
    parser.add_argument("--report", action="store_true", help="run nothing, evaluate what is there")
    parser.add_argument("--results", type=pathlib.Path, default=None)
    parser.add_argument("--limit", type=float, default=300, help="CPU seconds a run may take")
    o = parser.parse_args()
    work = (o.work or ROOT / "build" / ("peers-quick" if o.quick else "peers")).resolve()
    results = o.results or (work if o.quick or o.case else ROOT / "benchmarks" / "results")
    picture = ROOT / "doc" / "images" / "peers.svg" if results == ROOT / "benchmarks" / "results" else results / "peers.svg"
    programs = {
        "axiforge": os.environ.get("AXIFORGE", str(ROOT / "build" / "release" / "axiforge")),
        "FreeFEM": shutil.which("FreeFem++-nw"),
        "CalculiX": shutil.which("ccx"),
    }
    if not pathlib.Path(programs["axiforge"]).exists():
        sys.exit(f"{programs['axiforge']} is not there: build it (scripts/run.sh) or name another in AXIFORGE")
    for code, package in (("FreeFEM", "freefem++ libfreefem++"), ("CalculiX", "calculix-ccx")):
        if not programs[code] and not o.report:
            print(f"{code} is not installed and left out: apt-get install {package}")
    done, references = [], {}
    chosen = [key for key in cases(o.quick) if o.case in "-".join(key)]
    if not chosen:
        sys.exit(f'--case "{o.case}": no such case; there are ' + ", ".join("-".join(key) for key in cases(o.quick)))
    jobs = []
    for key in chosen:
        for code in codes_of(key[1]):
            jobs += [(key, code, v) for v in variants(code, *key, o.quick)]
    fine = QUICK_REFERENCES if o.quick else REFERENCES
    # The costly ones last, so that a benchmark that is broken off has something of every case
    jobs.sort(key=lambda job: cost(job[1], job[2]))
    records = {key: [] for key in chosen}
    jobs[:0] = [(key, "reference", v) for key in chosen if key[1] != "none" for v in fine]
    for key, code, v in jobs:
        name = "axiforge" if code == "reference" else code
        label = "-".join(f"{k}{x}" for k, x in v.items())
        path = work / "-".join(key) / name / label / "record.json"
        if not path.exists() and (o.report or not programs[name]):
            continue
        record = run(programs, work, *key, name, v, 10 * o.limit if code == "reference" else o.limit, None if o.report else o.again)
        (records[key] if code == "reference" else done).append(record)
    for key in chosen:
        usable = [r for r in records[key] if "cpu" in r]
        if key[1] == "none" or len(usable) == 2:
            references[key] = Reference(*key, usable)
    report(done, references, start_up(programs, work, o.again), results, picture)
    print((results / "peers.md").read_text())


if __name__ == "__main__":
    main()
