# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenes as dictionaries, runs of the program, and what every run has to keep to."""
import csv
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
GEOMETRY = ROOT / "parameter_files" / "geometry"

# Words that no run may end with: an exception nobody has caught, or a signal.
CRASHES = ("terminate called", "Stacktrace", "An error occurred in line <", "Segmentation fault", "MPI_ABORT", "Aborted")


def parameter_text(entries):
    """The .prm of {"Section/Sub section/Entry": value}."""
    tree = {}
    for path, value in entries.items():
        *sections, entry = path.split("/")
        node = tree
        for section in sections:
            node = node.setdefault(section + "/", {})
        node[entry] = value

    def write(node, depth):
        lines = []
        for name, value in node.items():
            indent = "  " * depth
            if isinstance(value, dict):
                lines += [f"{indent}subsection {name[:-1]}", *write(value, depth + 1), f"{indent}end"]
            else:
                lines.append(f"{indent}set {name} = {number(value)}")
        return lines

    return "\n".join(write(tree, 0)) + "\n"


def number(value):
    return f"{value:.17g}" if isinstance(value, float) else str(value)


def geometry_parameters(**values):
    return ", ".join(f"{name} = {number(value)}" for name, value in values.items())


class Run:
    """What came out of one run."""

    def __init__(self, status, message, operations, cpu, leftovers):
        self.status = status  # of the program; None: it had to be stopped
        self.message = message
        self.operations = operations  # for each operation the rows of its history.csv, {column: number}
        self.rows = [row for rows in operations for row in rows]
        self.cpu = cpu  # user and system [s], start and mesh included
        self.leftovers = leftovers  # files that are neither whole nor gone

    @property
    def done(self):
        # A scene may be cut short by "Most steps" on purpose: what it has is sound.
        return self.status == 0 or (self.status == 2 and "The run has stopped after" in self.message)

    @property
    def last(self):
        return self.rows[-1]

    def column(self, name):
        return [row[name] for row in self.rows]

    def total(self, name):
        return sum(self.column(name))

    @property
    def iterations(self):
        return int(self.total("iterations"))

    @property
    def repeats(self):
        return int(self.total("repeats"))

    @property
    def condition(self):
        return max(self.column("condition"))

    @property
    def power_residual(self):
        """Largest power that nothing accounts for, over the largest power put in."""
        put_in = max(abs(row["power_tools_mW"] + row["power_boundaries_mW"]) for row in self.rows)
        return max(abs(row["power_residual_mW"]) for row in self.rows) / put_in if put_in > 0 else 0.0

    @property
    def volume_change(self):
        return max((row["relative_volume_change"] for row in self.rows), key=abs)

    @property
    def work(self):
        """Of the tools [mJ]: the midpoint rule's own, as their power holds at the middle of a step."""
        return sum(row["power_tools_mW"] * row["time_step_s"] for row in self.rows)

    def forces(self, tool="upper"):
        return self.column(f"force_{tool}_N")

    @property
    def reason(self):
        """The message in a few words, for tables."""
        if self.done:
            return ""
        text = re.sub(r"\s+", " ", self.message)
        for pattern in (
            r"no convergence in \d+ iterations",
            r"a cell near .*? turns over",
            r"the matrix is not positive definite",
            r"numbers that are not finite",
            r"flow has become so uneven",
            r"nothing holds the workpiece along z",
            r"too small for the iterated penalty",
            r"Entry \"[^\"]*\"( = \"[^\"]*\")?: [^.:]*",
            r"surface folds",
        ):
            found = re.search(pattern, text)
            if found:
                return re.sub(r" near .*? mm, z = .*? mm", "", found.group(0))
        return text[:80]


class Program:
    def __init__(self, path, timeout=120):
        self.path = pathlib.Path(path).resolve()
        self.timeout = timeout
        self.version = subprocess.run([self.path, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        self.cpu = 0.0
        self.n_runs = 0
        self.faults = []  # runs that broke a rule that holds for all of them
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="axiforge_stress_"))
        # The scenes name geometry files without a folder.
        for file in GEOMETRY.glob("*.geo"):
            shutil.copy(file, self.work)

    def close(self):
        shutil.rmtree(self.work, ignore_errors=True)

    def run(self, entries, name="", work=None):
        """Runs a scene, in a folder of its own if there is one with its files, and notes what no scene may do."""
        self.n_runs += 1
        work = work or self.work
        scene, folder = work / "scene.prm", work / "output"
        shutil.rmtree(folder, ignore_errors=True)
        scene.write_text(parameter_text({"Output/Fields": "none", **entries}))
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_THREAD_LIMIT": "1", "OPENBLAS_NUM_THREADS": "1"}
        with open(work / "screen", "w+") as screen:
            process = subprocess.Popen(
                [self.path, scene, "--quiet", "--output", folder],
                stdin=subprocess.DEVNULL, stdout=screen, stderr=screen, env=environment,
            )
            status, cpu = self.wait(process)
            screen.seek(0)
            message = screen.read().replace(f"{work}/", "")
        self.cpu += cpu
        operations, whole = [], True
        # A chain has a folder for each of its operations.
        histories = [folder / "history.csv"] if (folder / "history.csv").exists() else sorted(folder.glob("[0-9]*_*/history.csv"))
        for history in histories:
            with open(history, newline="") as file:
                lines = list(csv.reader(file))
            rows = [dict(zip(lines[0], map(float, line))) for line in lines[1:] if len(line) == len(lines[0])]
            whole = whole and len(rows) == len(lines) - 1 and history.read_bytes().endswith(b"\n")
            if rows:
                operations.append(rows)
        if not histories:
            whole = status != 0
        # Files are written under another name and renamed: none may stay under that name.
        leftovers = [str(file.name) for file in folder.rglob("*") if re.search(r"tmp|part|~$", file.name)] if folder.exists() else []
        if not whole:
            leftovers.append("history.csv")
        run = Run(status, message, operations, cpu, leftovers)
        fault = self.broken_rule(run)
        if fault:
            self.faults.append((name, fault, parameter_text(entries)))
        return run

    def wait(self, process):
        """Exit status (None: killed after the timeout) and CPU seconds."""
        end = time.monotonic() + self.timeout
        pause = 0.005
        while True:
            pid, code, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                process.returncode = os.waitstatus_to_exitcode(code)
                return process.returncode, usage.ru_utime + usage.ru_stime
            if time.monotonic() > end:
                process.kill()
                _, code, usage = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(code)
                return None, usage.ru_utime + usage.ru_stime
            time.sleep(pause)
            pause = min(2 * pause, 0.05)

    @staticmethod
    def broken_rule(run):
        if run.status is None:
            return "it did not end in time"
        if run.status not in (0, 1, 2):
            return f"it ended with status {run.status}: {run.message[-300:]}"
        for text in CRASHES:
            if text in run.message:
                return f"it crashed: {text}"
        if run.status != 0 and len(run.message.split()) < 8:
            return "it failed without a reason"
        if run.leftovers:
            return "files that are not whole: " + ", ".join(run.leftovers)
        if run.done and not run.rows:
            return "it succeeded without a step"
        for row in run.rows:
            for column, value in row.items():
                # "Nowhere" and "not known" are nan.
                may_be_nan = column.startswith(("neutral_radius_", "gauge_")) or column == "condition"
                if not math.isfinite(value) and not may_be_nan:
                    return f"{column} is {value} in step {row['step']:.0f}"
        return None
