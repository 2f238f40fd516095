# SPDX-License-Identifier: GPL-2.0-or-later
"""Tables as CSV and Markdown, with machine, date and revision."""
import csv
import datetime
import os


def machine():
    model = "unknown processor"
    try:
        with open("/proc/cpuinfo") as file:
            model = next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model}, {os.cpu_count()} cores"


def plain(value):
    """A number with the digits that say something."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: ""}[value]
    if isinstance(value, float):
        if value != value:
            return "-"
        if value == 0:
            return "0"
        return f"{value:.1e}" if abs(value) < 1e-2 or abs(value) >= 1e5 else f"{value:.4g}"
    return str(value)


def markdown_rows(columns, rows):
    """Lines of a table in Markdown."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return lines + ["| " + " | ".join(plain(value).replace("|", "/") for value in row) + " |" for row in rows]


class Table:
    """Rows for the Markdown file; all_rows, if there are more of them, for the CSV file."""

    def __init__(self, title, columns, note=""):
        self.title, self.columns, self.note = title, columns, note
        self.rows = []

    def add(self, *row):
        assert len(row) == len(self.columns), (self.title, row)
        self.rows.append(row)
        return row

    def markdown(self):
        lines = [f"## {self.title}", ""]
        if self.note:
            lines += [self.note, ""]
        return "\n".join(lines + markdown_rows(self.columns, self.rows)) + "\n"


def stamp(program, seconds):
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")
    return (
        f"Machine: {machine()}. Date: {date}. {program.version}. {program.n_runs} runs, "
        f"{seconds:.0f} s CPU."
    )


def write(folder, group, text, program, seconds, tables, details):
    """group.md has the tables, group_NAME.csv the rows of each of them and of the details."""
    folder.mkdir(parents=True, exist_ok=True)
    body = [f"# {text}", "", f"Made by `scripts/stress.sh {group}`.", "", stamp(program, seconds), ""]
    (folder / f"{group}.md").write_text("\n".join(body) + "\n" + "\n".join(table.markdown() for table in tables))
    for name, table in details.items():
        with open(folder / f"{group}_{name}.csv", "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(table.columns)
            for row in table.rows:
                writer.writerow([f"{v:.10g}" if isinstance(v, float) else v for v in row])
