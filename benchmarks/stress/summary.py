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

from tables import markdown_rows

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "stress"
DOCUMENT = ROOT / "doc" / "stability.md"


def read(name):
    with open(RESULTS / (name + ".csv"), newline="") as file:
        return list(csv.DictReader(file))


def tables_of(group):
    """The tables of a group's Markdown file, as lists of lines."""
    text = (RESULTS / (group + ".md")).read_text()
    return [table.rstrip("\n").split("\n") for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)]


def number(text):
    """What a cell of a .csv file says; nothing where there is nothing."""
    return float(text) if text not in ("", "-") else None


def largest(rows, column):
    return max((abs(number(row[column])) for row in rows if number(row[column]) is not None), default=None)


def penalty_first_step():
    rows = {(row["method"], row["lambda"]): row for row in read("penalty_first_step")}
    result = []
    for value in dict.fromkeys(key[1] for key in rows):
        iterated, static, classical = (rows[(method, value)] for method in ("iterated", "static", "classical"))
        solved = "residual can be solved to"
        result.append([
            value, "refused" if iterated[solved] == "-" else iterated[solved], number(iterated["error of the force"]),
            static[solved], number(static["error of the force"]), number(static["power of the divergence"]),
            "not to 1e-3" if classical[solved] == "-" else classical[solved],
            "all" if classical[solved] == "-" else classical["digits lost"], number(classical["error of the force"])])
    return markdown_rows([r"$\lambda$", "iterated: solved to", "error", "static: solved to", "error", "power of the divergence",
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
                      + [number(static["error of the last force"]), number(static["volume change"])])
    return markdown_rows([r"$\lambda$", "iterations at 1e-5: iterated", "static", "classical", "at 1e-8: iterated", "static",
                          "classical", "error of the last force, static", "volume change, static"], result)


def scaling_units():
    rows = read("scaling_units")
    result = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        mine = [row for row in rows if row["scene"] == scene]
        binary = [row for row in mine if "2^" in row["units"]]
        decimal = [row for row in mine if row not in binary and row["units"] != "own"]
        numbers = sorted({int(row["iterations"]) for row in mine})
        result.append([scene, len(decimal), largest(decimal, "largest difference"), len(binary),
                       largest(binary, "largest difference"), " to ".join(str(n) for n in dict.fromkeys((numbers[0], numbers[-1])))])
    return markdown_rows(["scene", "units of 1e±3, 1e±6", "largest difference of any answer", "units of 2^±10, 2^±20",
                          "largest difference", "iterations"], result)


def invariance_changes():
    rows = read("invariance_changes")
    result = []
    for change in dict.fromkeys(row["change"] for row in rows if row["change"] != "none"):
        line = [change]
        for tolerance in ("1e-05", "1e-08"):
            mine = [row for row in rows if row["change"] == change and row["tolerance"] == tolerance]
            failed = [row for row in mine if row["ends"] != "done"]
            line.append(f"{len(failed)} of {len(mine)}: {failed[0]['ends']}" if failed else largest(mine, "largest difference"))
        result.append(line)
    return markdown_rows(["change", "largest difference of any answer, tolerance 1e-5", "tolerance 1e-8"], result)


def steps():
    rows = read("steps_steps")
    result = []
    for step in dict.fromkeys(row["step"] for row in rows):
        mine = [row for row in rows if row["step"] == step]
        done = [row for row in mine if row["ends"] == "done"]
        free, rubbed = ([row for row in done if (row["friction"] == "none") == none] for none in (True, False))
        each = [float(row["iterations per step"]) for row in done]
        result.append([step, f"{len(done)} of {len(mine)}", sum(int(row["repeats"]) for row in mine), f"{min(each):.1f} to {max(each):.1f}" if each else None]
                      + [largest(some, "error of the " + what) for what in ("work", "radius") for some in (free, rubbed)]
                      + [largest(done, "volume change")])
    return markdown_rows(["step", "done", "repeats", "iterations per step", "error of the work, frictionless", "with friction",
                          "error of the radius, frictionless", "with friction", "volume change"], result)


def regularisation():
    """The table of material.md, whose errors have more digits than the .csv file, with the frictions side by side."""
    rows = {}
    for line in tables_of("material")[1][2:]:
        m, friction, value, at_5, _, at_8, error = [cell.strip() for cell in line.strip("|").split("|")][:7]
        rows.setdefault((m, value), []).append((friction, at_5, at_8, error))
    frictions = [friction for friction, *_ in next(iter(rows.values()))]
    assert all([friction for friction, *_ in each] == frictions for each in rows.values())
    result = [[m, value, *(" / ".join(column) for column in list(zip(*each))[1:3]), *list(zip(*each))[3]] for (m, value), each in rows.items()]
    return markdown_rows(["m", "regularisation", "iterations per step at a tolerance of 1e-5: SMM / shear / sticking", "at 1e-8",
                          "error of the force: SMM 0.5", "shear 0.3", "sticking"], result)


DIGESTS = {function.__name__: function for function in
           (penalty_first_step, penalty_whole_run, scaling_units, invariance_changes, steps, regularisation)}


def made(name):
    if name in DIGESTS:
        return DIGESTS[name]()
    file, place = name.split()
    return tables_of(file)[int(place) - 1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="compare only")
    arguments = parser.parse_args()
    before = DOCUMENT.read_text()

    def replaced(match):
        return match.group(1) + "\n".join(made(match.group(2))) + "\n"

    after, n_tables = re.subn(r"(<!-- table: (.+?) -->\n)(?:\|.*\n)+", replaced, before)
    if n_tables != before.count("<!-- table:"):
        sys.exit("doc/stability.md has a line <!-- table: NAME --> that no table follows")
    if after == before:
        return
    if arguments.check:
        sys.exit("doc/stability.md is not what benchmarks/results/stress says: run benchmarks/stress/summary.py")
    DOCUMENT.write_text(after)


if __name__ == "__main__":
    main()
