# SPDX-License-Identifier: GPL-2.0-or-later
"""What the benchmarks in Python share: running the program, its table of phases, results as files."""
import csv
import datetime
import math
import os
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = pathlib.Path(os.environ.get("AXIFORGE") or ROOT / "build" / "release" / "axiforge")
RESULTS = ROOT / "benchmarks" / "results"
IMAGES = ROOT / "doc" / "images"
SCENES = ROOT / "parameter_files"


class Run:
    """A run of the program that has ended: seconds, memory, phases, rows of history.csv."""

    def __init__(self, status, output, cpu, wall, memory, history):
        self.status = status
        self.output = output
        self.cpu = cpu  # of all ranks [s]
        self.wall = wall
        self.memory = memory  # peak resident set of the largest process [MB]
        self.history = history
        self.phases = phases_of(output)

    def column(self, name):
        return [float(row[name]) for row in self.history]


def phases_of(output):
    """The table of --timing: name -> calls, wall and CPU seconds. What has the same name is added up."""
    phases = {}
    for line in output.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) == 6 and cells[1].isdigit():
            calls, wall, cpu = phases.get(cells[0], (0, 0.0, 0.0))
            phases[cells[0]] = (calls + int(cells[1]), wall + float(cells[2]), cpu + float(cells[3]))
    return phases


def run(program, scene, entries=(), ranks=1, environment=None, keep=None):
    """Runs a scene without fields, with one BLAS thread, and waits for it."""
    variables = dict(os.environ, OPENBLAS_NUM_THREADS="1", **(environment or {}))
    command = [str(program), str(scene), "--quiet", "--timing", "--set", "Output/Fields = none"]
    for entry in entries:
        command += ["--set", entry]
    if ranks > 1:
        variables.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        command = ["mpirun", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-np", str(ranks)] + command
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(keep or temporary)
        with open(pathlib.Path(temporary) / "log", "w+") as log:
            begin = datetime.datetime.now()
            process = subprocess.Popen(command + ["--output", str(folder)], stdout=log, stderr=log, env=variables)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            wall = (datetime.datetime.now() - begin).total_seconds()
            log.seek(0)
            output = log.read()
        history = []
        if (folder / "history.csv").exists():
            with open(folder / "history.csv", newline="") as file:
                history = list(csv.DictReader(file))
    return Run(process.returncode, output, usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024, history)


def must(result):
    if result.status != 0:
        raise SystemExit("A run failed with status %d:\n%s" % (result.status, result.output))
    return result


def machine(program):
    """The line that says where, when and with what the figures were measured."""
    model = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text()).group(1)
    version = subprocess.run([str(program), "--version"], capture_output=True, text=True).stdout.strip()
    return "Machine: %s, %d cores. Date: %s. %s. Load of the machine while measuring: %.1f." % (
        model,
        os.cpu_count(),
        datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"),
        version,
        os.getloadavg()[1],
    )


def table(rows, columns):
    """Rows (dictionaries) in Markdown; columns: heading -> (key, format)."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    for row in rows:
        lines.append("| " + " | ".join(_text(row.get(key), form) for key, form in columns.values()) + " |")
    return "\n".join(lines) + "\n"


def _text(value, form):
    if value is None or isinstance(value, float) and math.isnan(value):
        return ""
    return form.format(value)


def write_csv(name, rows):
    RESULTS.mkdir(exist_ok=True)
    keys = list(dict.fromkeys(key for row in rows for key in row))
    with open(RESULTS / (name + ".csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, keys, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: "%.8g" % v if isinstance(v, float) else v for k, v in row.items()})


def write_markdown(name, title, program, body):
    RESULTS.mkdir(exist_ok=True)
    text = "# %s\n\nMade by `benchmarks/%s.py`. %s\n\n%s" % (title, name, machine(program), body)
    (RESULTS / (name + ".md")).write_text(text)
    print(text)


def power_fit(xs, ys):
    """Exponent p of y ~ x^p by least squares in the logarithms."""
    points = [(math.log(x), math.log(y)) for x, y in zip(xs, ys) if x > 0 and y > 0]
    if len(points) < 2:
        return math.nan
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def plots():
    """matplotlib without a screen, or the reason why there are no pictures."""
    try:
        import matplotlib
    except ImportError:
        print("No pictures: this Python has no matplotlib (Debian: python3-matplotlib, /usr/bin/python3).")
        return None
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "axiforge", "font.size": 10, "axes.grid": True, "grid.color": "#ddd"})
    from matplotlib import pyplot

    return pyplot


def save_figure(figure, name):
    figure.tight_layout()
    figure.savefig(IMAGES / (name + ".svg"), metadata={"Date": None})


def build(target):
    """Builds a target of benchmarks/CMakeLists.txt; None if there is no such target (a library is missing)."""
    folder = ROOT / "build" / "release"
    subprocess.run(["cmake", "-DAXIFORGE_BENCHMARKS=ON", str(folder)], check=True, stdout=subprocess.DEVNULL)
    done = subprocess.run(["ninja", "-C", str(folder), "-j", os.environ.get("AXIFORGE_JOBS", "1"), target],
                          stdout=subprocess.DEVNULL)
    return folder / "benchmarks" / target if done.returncode == 0 else None
