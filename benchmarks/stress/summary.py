#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Puts the tables of the last stress runs into doc/stability.md.

    benchmarks/stress/summary.py [--check]

A table of the document that follows a line `<!-- table: NAME -->` is replaced by what NAME stands for: `FILE N` is the
Nth table of results/stress/FILE.md as it is, other names are digests of the .csv files, made here. --check changes
nothing and ends with status 1 if the document is not what the results say.
"""
import argparse
import csv
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "stress"
DOCUMENT = ROOT / "doc" / "stability.md"


def read(name):
    with open(RESULTS / (name + ".csv"), newline="") as file:
        return list(csv.DictReader(file))


def short(value):
    """A number as it stands in the document; text as it is."""
    try:
        number = float(value)
    except ValueError:
        return value
    return "0" if number == 0 else f"{number:.1e}" if abs(number) < 0.01 or abs(number) >= 1e4 else f"{number:.4g}"


def table(columns, rows):
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return lines + ["| " + " | ".join(str(x) for x in row) + " |" for row in rows]


def largest(rows, column):
    return max((abs(float(row[column])) for row in rows if row[column] not in ("", "-")), default=None)


def penalty_first_step():
    rows = {(row["method"], row["lambda"]): row for row in read("penalty_first_step")}
    result = []
    for value in dict.fromkeys(key[1] for key in rows):
        iterated, static, classical = (rows[(method, value)] for method in ("iterated", "static", "classical"))
        solved = "residual can be solved to"
        result.append([
            value, "refused" if iterated[solved] == "-" else iterated[solved], short(iterated["error of the force"]),
            static[solved], short(static["error of the force"]), short(static["power of the divergence"]),
            "not to 1e-3" if classical[solved] == "-" else classical[solved],
            "all" if classical[solved] == "-" else classical["digits lost"], short(classical["error of the force"])])
    return table([r"$\lambda$", "iterated: solved to", "error", "static: solved to", "error", "power of the divergence",
                  "classical: solved to", "digits lost", "error"], result)


def penalty_whole_run():
    rows = {(row["method"], row["lambda"], row["tolerance"]): row for row in read("penalty_whole_run")}

    def iterations(method, value, tolerance):
        row = rows[(method, value, tolerance)]
        return row["iterations"] or ("refused" if "too small" in row["why not"] else "fails")

    result = []
    for value in dict.fromkeys(key[1] for key in rows):
        static = rows[("static", value, "1e-08")]
        result.append([value] + [iterations(method, value, tolerance) for tolerance in ("1e-05", "1e-08")
                                 for method in ("iterated", "static", "classical")]
                      + [short(static["error of the last force"]), short(static["volume change"])])
    return table([r"$\lambda$", "iterations at 1e-5: iterated", "static", "classical", "at 1e-8: iterated", "static",
                  "classical", "error of the last force, static", "volume change, static"], result)


def scaling_units():
    rows = read("scaling_units")
    result = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mine = [row for row in rows if row["scene"] == scene]
        binary = [row for row in mine if "2^" in row["units"]]
        decimal = [row for row in mine if row not in binary and row["units"] != "own"]
        numbers = sorted({int(row["iterations"]) for row in mine})
        result.append([scene, len(decimal), short(largest(decimal, "largest difference")), len(binary),
                       short(largest(binary, "largest difference")), " to ".join(str(n) for n in dict.fromkeys((numbers[0], numbers[-1])))])
    return table(["scene", "units of 1e±3, 1e±6", "largest difference of any answer", "units of 2^±10, 2^±20",
                  "largest difference", "iterations"], result)


def invariance_changes():
    rows = read("invariance_changes")
    result = []
    for change in dict.fromkeys(row["change"] for row in rows if row["change"] != "none"):
        line = [change]
        for tolerance in ("1e-05", "1e-08"):
            mine = [row for row in rows if row["change"] == change and row["tolerance"] == tolerance]
            failed = [row for row in mine if row["ends"] != "done"]
            line.append(f"{len(failed)} of {len(mine)}: {failed[0]['ends']}" if failed else short(largest(mine, "largest difference")))
        result.append(line)
    return table(["change", "largest difference of any answer, tolerance 1e-5", "tolerance 1e-8"], result)


def steps():
    rows = read("steps_steps")
    result = []
    for step in dict.fromkeys(row["step"] for row in rows):
        mine = [row for row in rows if row["step"] == step]
        done = [row for row in mine if row["ends"] == "done"]
        free, rubbed = ([row for row in done if (row["friction"] == "none") == none] for none in (True, False))
        each = [float(row["iterations per step"]) for row in done]
        result.append([step, f"{len(done)} of {len(mine)}", sum(int(row["repeats"]) for row in mine), f"{min(each):.1f} to {max(each):.1f}"]
                      + [short(largest(some, "error of the " + what)) for what in ("work", "radius") for some in (free, rubbed)]
                      + [short(largest(done, "volume change"))])
    return table(["step", "done", "repeats", "iterations per step", "error of the work, frictionless", "with friction",
                  "error of the radius, frictionless", "with friction", "volume change"], result)


def regularisation():
    rows = {(row["m"], row["regularisation"], row["friction"], row["tolerance"]): row for row in read("material_regularisation")}
    frictions = list(dict.fromkeys(key[2] for key in rows))
    result = []
    for m in dict.fromkeys(key[0] for key in rows):
        values = list(dict.fromkeys(key[1] for key in rows))
        for value in values:
            line = [m, value]
            for tolerance in ("1e-05", "1e-08"):
                line.append(" / ".join("%.3g" % (int(rows[(m, value, friction, tolerance)]["iterations"]) / 10) for friction in frictions))
            for friction in frictions:
                force, exact = (float(rows[(m, v, friction, "1e-08")]["last force [N]"]) for v in (value, values[-1]))
                line.append(short(force / exact - 1))
            result.append(line)
    return table(["m", "regularisation", "iterations per step at a tolerance of 1e-5: SMM / shear / sticking", "at 1e-8",
                  "error of the force: SMM 0.5", "shear 0.3", "sticking"], result)


DIGESTS = {function.__name__: function for function in
           (penalty_first_step, penalty_whole_run, scaling_units, invariance_changes, steps, regularisation)}


def made(name):
    if name in DIGESTS:
        return DIGESTS[name]()
    file, number = name.split()
    tables = re.findall(r"(?:^\|.*\n)+", (RESULTS / (file + ".md")).read_text(), re.MULTILINE)
    return tables[int(number) - 1].rstrip("\n").split("\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="compare only")
    arguments = parser.parse_args()
    before = DOCUMENT.read_text()

    def replaced(match):
        return match.group(1) + "\n".join(made(match.group(2))) + "\n"

    after = re.sub(r"(<!-- table: (.+?) -->\n)(?:\|.*\n)+", replaced, before)
    if after == before:
        return
    if arguments.check:
        sys.exit("doc/stability.md is not what benchmarks/results/stress says: run benchmarks/stress/summary.py")
    DOCUMENT.write_text(after)


if __name__ == "__main__":
    main()
