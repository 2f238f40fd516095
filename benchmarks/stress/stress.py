#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Stress tests of numerical stability.

    benchmarks/stress/stress.py PROGRAM [GROUP ...] [--short] [--output FOLDER]

Each group sweeps one thing and writes GROUP.md and GROUP_*.csv to FOLDER (benchmarks/results/stress).
--short is for ctest: fewer values, no files unless --output is given. Status 1 if something that is
asserted does not hold, or if any run crashes, hangs, fails without a reason or writes numbers that are
not finite. Needs nothing but the standard library.
"""
import argparse
import importlib
import pathlib
import sys

sys.dont_write_bytecode = True  # the tree of the sources stays clean
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import program as programs  # noqa: E402
import tables  # noqa: E402

GROUPS = ("penalty", "scaling", "invariance", "friction", "material", "steps", "shapes", "random_scenes",
          "industrial")


class Session:
    """What a group is given: the program, the size of the job, and where to say what does not hold."""

    def __init__(self, program, short, group):
        self.program, self.short, self.group = program, short, group
        self.n_checks = 0
        self.failures = []

    def check(self, holds, text):
        self.n_checks += 1
        if not holds:
            self.failures.append(text)
            print(f"  does not hold: {text}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS))
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--output", type=pathlib.Path)
    arguments = parser.parse_intermixed_args()
    unknown = [group for group in arguments.groups if group not in GROUPS]
    if unknown:
        parser.error(f"there is no group {unknown[0]}; there are {', '.join(GROUPS)}")
    folder = arguments.output or (None if arguments.short else programs.ROOT / "benchmarks" / "results" / "stress")

    bad = 0
    for name in arguments.groups or GROUPS:
        group = importlib.import_module(name)
        program = programs.Program(arguments.program)
        session = Session(program, arguments.short, name)
        print(f"{name}: {group.TITLE}", flush=True)
        try:
            results, details = group.run(session)
        finally:
            program.close()
        for scene, fault, text in program.faults:
            print(f"  a run broke a rule ({scene}): {fault}\n{text}", flush=True)
        print(f"  {program.n_runs} runs, {program.cpu:.0f} s CPU, {session.n_checks} checks, "
              f"{len(session.failures) + len(program.faults)} failed", flush=True)
        bad += len(session.failures) + len(program.faults)
        if folder:
            tables.write(folder, name, group.TITLE, program, program.cpu, results, details)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
