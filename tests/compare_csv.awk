# SPDX-License-Identifier: GPL-2.0-or-later
# Compares two CSV tables number by number:
#
#     awk -v abs=1e-9 -v rel=1e-6 -v range=0 -v skip=wall_time_s -f compare_csv.awk EXPECTED ACTUAL
#
# The columns of EXPECTED are looked up by name in ACTUAL, which may have more and in another order. Two
# numbers agree if their difference is at most the largest of: abs; rel times the larger of both; range
# times the largest magnitude in this column of EXPECTED (for columns that pass through zero). Other
# fields, nan included, must be the same text. skip and only are lists of columns, separated by commas.
# Prints the first differences and the largest one of each column; ends with 1 if there are any.
#
# With -v mode=filter it prints the columns of ACTUAL (its only file) that skip and only leave.

function is_number(text) {
  return text ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/
}

function magnitude(x) {
  return x < 0 ? -x : x
}

# Splits a line into fields[1..n], quotes as in RFC 4180 (without line breaks), and returns n.
function split_csv(line, fields,    n, i, c, quoted) {
  sub(/\r$/, "", line)
  n = 1
  fields[1] = ""
  for (i = 1; i <= length(line); ++i) {
    c = substr(line, i, 1)
    if (c == "\"")
      quoted = !quoted
    else if (c == "," && !quoted)
      fields[++n] = ""
    else
      fields[n] = fields[n] c
  }
  return n
}

function is_listed(name, list) {
  return index("," list ",", "," name ",") > 0
}

function is_compared(name) {
  return !is_listed(name, skip) && (only == "" || is_listed(name, only))
}

function complain(text) {
  ++n_complaints
  if (n_complaints <= 5)
    print "  " text
}

mode == "filter" {
  n = split_csv($0, fields)
  line = ""
  if (NR == 1)
    for (i = 1; i <= n; ++i)
      kept[i] = is_compared(fields[i])
  for (i = 1; i <= n; ++i)
    if (kept[i])
      line = line "," (fields[i] ~ /,/ ? "\"" fields[i] "\"" : fields[i])
  print substr(line, 2)
  next
}

FNR == 1 {
  ++file
}

# The expected table, kept as a whole.
file == 1 {
  n = split_csv($0, fields)
  if (FNR == 1) {
    n_columns = n
    for (i = 1; i <= n; ++i)
      column[i] = fields[i]
  } else {
    n_expected = FNR - 1
    for (i = 1; i <= n; ++i) {
      expected[FNR, i] = fields[i]
      if (is_number(fields[i]) && magnitude(fields[i] + 0) > largest[i])
        largest[i] = magnitude(fields[i] + 0)
    }
  }
  next
}

file == 2 && FNR == 1 {
  n = split_csv($0, fields)
  for (i = 1; i <= n; ++i)
    place[fields[i]] = i
  for (i = 1; i <= n_columns; ++i)
    if (is_compared(column[i]) && !(column[i] in place))
      complain("column \"" column[i] "\" is missing")
  next
}

file == 2 {
  n_actual = FNR - 1
  if (n_actual > n_expected)
    next
  for (i in fields)
    delete fields[i]
  split_csv($0, fields)
  for (i = 1; i <= n_columns; ++i) {
    if (!is_compared(column[i]) || !(column[i] in place))
      continue
    want = expected[FNR, i]
    have = fields[place[column[i]]]
    if (!is_number(want) || !is_number(have)) {
      if (want != have)
        complain("row " n_actual ", " column[i] ": \"" have "\" instead of \"" want "\"")
      continue
    }
    difference = magnitude(have - want)
    size = magnitude(have + 0) > magnitude(want + 0) ? magnitude(have + 0) : magnitude(want + 0)
    tolerance = abs + 0
    if (rel * size > tolerance)
      tolerance = rel * size
    if (range * largest[i] > tolerance)
      tolerance = range * largest[i]
    if (difference > tolerance) {
      complain("row " n_actual ", " column[i] ": " have " instead of " want)
      if (difference > worst[i])
        worst[i] = difference
    }
  }
}

END {
  if (mode == "filter")
    exit 0
  if (file < 2 && n_expected > 0 || n_actual + 0 != n_expected + 0)
    complain(n_actual + 0 " rows instead of " n_expected + 0)
  if (n_complaints > 5)
    print "  ... and " n_complaints - 5 " more"
  for (i = 1; i <= n_columns; ++i)
    if (worst[i] > 0)
      printf "  largest difference in %s: %.3g (largest value %.6g)\n", column[i], worst[i], largest[i]
  exit n_complaints > 0
}
