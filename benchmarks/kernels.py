#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Time of the kernels that a step consists of, with Google Benchmark (Debian: libbenchmark-dev).

    benchmarks/kernels.py [PROGRAM]

Builds and runs the target kernels (kernels.cc); the median of 7 repetitions, in CPU time. PROGRAM only tells its revision.
"""
import json
import pathlib
import subprocess
import sys

from support.common import PROGRAM, build, table, write_csv, write_markdown


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else PROGRAM).resolve()
    kernels = build("kernels")
    if not kernels:
        raise SystemExit("The target kernels could not be built. Is Google Benchmark there (Debian: libbenchmark-dev)?")
    output = subprocess.run(
        [kernels, "--benchmark_format=json", "--benchmark_repetitions=7", "--benchmark_min_time=0.1",
         "--benchmark_enable_random_interleaving=true"],
        capture_output=True, text=True, check=True,
    ).stdout
    times = {}
    order = lambda benchmark: (benchmark["family_index"], benchmark["per_family_instance_index"])
    for benchmark in sorted(json.loads(output)["benchmarks"], key=order):
        if benchmark["run_type"] == "iteration":
            rows = times.setdefault(benchmark["run_name"], [])
            rows.append((benchmark["cpu_time"], benchmark.get("operations")))
    rows = []
    for name, values in times.items():
        values.sort()
        median = values[len(values) // 2]
        rows.append({
            "kernel": name, "ns": median[0], "least": values[0][0], "most": values[-1][0],
            "gflops": median[1] / 1e9 if median[1] else None,
        })
    write_csv("kernels", rows)
    columns = {"kernel": ("kernel", "{}"), "median [ns]": ("ns", "{:,.4g}"), "least": ("least", "{:,.4g}"), "most": ("most", "{:,.4g}")}
    body = table([row for row in rows if not row["gflops"]], columns)
    body += "\nWhat the BLAS reaches on one core, C -= A B^T of n x n matrices:\n\n"
    body += table([row for row in rows if row["gflops"]], dict(columns, **{"GFlop/s": ("gflops", "{:.1f}")}))
    write_markdown("kernels", "Kernels", program, body)


if __name__ == "__main__":
    main()
