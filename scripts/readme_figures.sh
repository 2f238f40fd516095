#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/readme_figures.sh [SCENE...]
#
# Runs the scenes of the README (all, or the named ones) and prints what comes out beside the figure that the README
# states. Ends with 1 if one differs by more than one in its last digit. It takes some minutes; "reference" stands
# for the table of mean pressures.
set -euo pipefail
export LC_ALL=C
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"
ensure_packages "${axiforge_packages[@]}"
ensure_build release
program=$axiforge_build/release/axiforge
readme=$axiforge_root/README.md
work=$(mktemp -d "${TMPDIR:-/tmp}/axiforge-figures.XXXXXX")
trap 'rm -rf "$work"' EXIT
wanted=" $* "
n_checked=0
n_wrong=0

# run SCENE STATUS [study]: nothing if it is not wanted; false then. Sets $scene and $history.
run() {
  local got=0
  scene=$1
  [ "$wanted" = "  " ] || [[ $wanted == *" $scene "* ]] || return 1
  (cd "$axiforge_root/parameter_files" && "$program" ${3:-} "$scene.prm" --quiet --output "$work/$scene") \
    >"$work/said" 2>&1 || got=$?
  history=$work/$scene/history.csv
  if [ "$got" -ne "$2" ]; then
    printf '%-28s ended with status %s: %s\n' "$scene" "$got" "$(tail -n 1 "$work/said")"
    n_wrong=$((n_wrong + 1))
    return 1
  fi
}

# column NAME [last|first|largest|smallest|near] [COLUMN VALUE]: of $history; "near": where COLUMN is nearest to VALUE.
column() {
  awk -F, -v name="$1" -v what="${2:-last}" -v by="${3:-}" -v at="${4:-0}" '
    function size(x) { return x < 0 ? -x : x }
    NR == 1 { for (i = 1; i <= NF; ++i) number[$i] = i
      if (!(name in number)) { print "no column " name > "/dev/stderr"; exit 1 }
      next }
    { x = $number[name] }
    NR == 2 || what == "last" || (what == "largest" && size(x) > size(result)) ||
      (what == "smallest" && x < result) { result = x }
    what == "near" && (NR == 2 || size($number[by] - at) < distance) { distance = size($number[by] - at); result = x }
    END { if (what == "largest") result = size(result); printf "%.10g\n", result }' "$history"
}

# figure "TEXT BEFORE" "TEXT BEHIND" VALUE [bound]: the number between the texts in the scene's row of the README, which
# are extended regular expressions. "bound": what comes out may be less.
figure() {
  local row=$scene stated
  [ "$scene" != reference ] || row=
  # The table has "| `scene` |"; the other one the name of the case, which is in TEXT BEFORE.
  stated=$(grep -E "^\| ${row:+\`$row\`}" "$readme" | sed -nE "s/(^|.*[^0-9.-])$1([0-9][0-9.,]*(e-?[0-9]+)?)$2.*/\2/p" | head -n 1)
  n_checked=$((n_checked + 1))
  if ! awk -v stated="${stated//,/}" -v value="$3" -v bound="${4:-}" -v scene="$scene" -v text="$1*$2" 'BEGIN {
      if (stated == "") { printf "%-28s the README has no figure \"%s\"\n", scene, text; exit 1 }
      mantissa = stated; exponent = 0
      if (split(stated, parts, "e") > 1) { mantissa = parts[1]; exponent = parts[2] }
      decimals = index(mantissa, ".") ? length(mantissa) - index(mantissa, ".") : 0
      unit = 10 ^ (exponent - decimals)
      difference = value - stated
      wrong = difference > 1.0001 * unit || (bound == "" && difference < -1.0001 * unit)
      printf "%-28s %12s %14.6g  %s%s\n", scene, stated, value, text, wrong ? "   <-- differs" : ""
      exit wrong }'; then
    n_wrong=$((n_wrong + 1))
  fi
}

kilo() { awk -v x="$1" 'BEGIN { printf "%.10g\n", 1e-3 * x }'; }
mega() { awk -v x="$1" 'BEGIN { printf "%.10g\n", 1e-6 * x }'; }
# study_figure SECTION COLUMN: of the last row of a table of study.md.
study_figure() {
  awk -F'|' -v section="## $1" -v column="$2" '
    $0 == section { inside = 1; next }
    /^## / { inside = 0 }
    inside && NF > 3 { if (!seen++) { for (i = 2; i < NF; ++i) { gsub(/^ +| +$/, "", $i); number[$i] = i } }
      else if ($0 !~ /--:/) value = $number[column] }
    END { gsub(/ /, "", value); print value }' "$work/$scene/study.md"
}

printf '%-28s %12s %14s\n' scene README "comes out"
if run cylinder_upsetting 0; then
  figure '' ' kN at the end' "$(kilo "$(column force_upper_N)")"
  figure 'barrel of ' ' mm' "$(column largest_radius_mm)"
fi
if run cylinder_coarse 0; then
  figure '' ' kN' "$(kilo "$(column force_upper_N)")"
fi
if run cylinder_upsetting_shear 0; then
  figure '' ' kN' "$(kilo "$(column force_upper_N)")"
  shear_first=$(column force_upper_N first)
  if run cylinder_upsetting_tangential 0; then
    figure '' ' % below shear' "$(awk -v a="$shear_first" -v b="$(column force_upper_N first)" \
      'BEGIN { print 100 * (1 - b / a) }')"
  fi
fi
if run ring_compression 0; then
  figure '' ' kN' "$(kilo "$(column force_upper_N)")"
  figure 'moves to ' ' mm' "$(column neutral_radius_upper_mm)"
fi
if run wheel_hub 0; then
  history=$work/wheel_hub/chain.csv
  figure 'volume kept to ' ',' "$(column relative_volume_change largest)" bound
  figure 'balance to ' ' ' "$(column force_imbalance largest)" bound
fi
if run upset_to_20_percent 0; then
  figure '' ' MN' "$(mega "$(column force_upper_N)")"
  figure 'volume kept to ' ';' "$(column relative_volume_change largest)" bound
fi
if run groove_closing 2; then
  figure 'at ' ' mm, at r' "$(column stroke_mm)"
fi
if run spike 0; then
  figure 'spike ' ' mm high' "$(column height_mm)"
  figure '' ' MN' "$(mega "$(column force_upper_N)")"
  figure 'volume kept to ' ' ' "$(column relative_volume_change largest)" bound
fi
if run backward_cup 0; then
  figure 'wall ' ' mm high' "$(column height_mm)"
  figure '' ' MN' "$(mega "$(column force_punch_N)")"
  figure 'volume kept to ' ' ' "$(column relative_volume_change largest)" bound
fi
if run punch_indentation 0; then
  figure 'contact radius ' ' to below' "$(column contact_radius_lower_mm near stroke_mm 2)"
  figure 'to below ' ' mm' "$(column contact_radius_lower_mm near stroke_mm 2.95)" bound
fi
if run cylinder_adaptive 0; then
  figure '' ' kN' "$(kilo "$(column force_upper_N)")"
  figure 'with ' ' cells' "$(column cells)"
fi
if run cone_upsetting 0; then
  figure 'grows from ' ' to' "$(column contact_radius_cone_mm first)"
  figure 'to ' ' mm' "$(column contact_radius_cone_mm)"
  figure '' ' kN' "$(kilo "$(column force_cone_N)")"
fi
if run study_sticking_cylinder 0 study; then
  figure 'order ' ' in the force' "$(study_figure force_upper_N order)"
  figure 'limit ' ' kN' "$(kilo "$(study_figure force_upper_N limit)")"
fi
if run study_time_step 0 study; then
  figure 'order ' ' in the force' "$(study_figure force_upper_N_at_3_mm order)"
  figure ', ' ' in the volume' "$(study_figure relative_volume_change_at_3_mm order)"
fi

scene=reference
if [ "$wanted" = "  " ] || [[ $wanted == *" reference "* ]]; then
  said=$(OMPI_MCA_orte_create_session_dirs=0 AXIFORGE_TEST_FIGURES=1 \
    "$axiforge_build/release/tests/process_reference_forces" --gtest_filter='MeanPressure*')
  pressure() { sed -nE "s/^$1: ([0-9.]+),.*/\1/p" <<<"$said"; }
  behind=' \|$'
  figure '0\.5, \$m\$ = 0\.1 \|.*\| ' "$behind" "$(pressure 'R\/h 0.5 m 0.1')"
  figure '^\| \$m\$ = 0\.3 \|.*\| ' "$behind" "$(pressure 'R\/h 0.5 m 0.3')"
  figure '^\| \$m\$ = 0\.5 \|.*\| ' "$behind" "$(pressure 'R\/h 0.5 m 0.5')"
  figure '^\| sticking \|.*\| ' "$behind" "$(pressure 'R\/h 0.5 m 1')"
  figure '= 1, sticking \|.*\| ' "$behind" "$(pressure 'R\/h 1 m 1')"
  figure '6:3:2, \$m\$ = 0\.05 \|.*\| ' "$behind" "$(pressure 'ring m 0.05')"
  figure '^\| \$m\$ = 0\.1 \|.*\| ' "$behind" "$(pressure 'ring m 0.1')"
  figure '^\| \$m\$ = 0\.2 \|.*\| ' "$behind" "$(pressure 'ring m 0.2')"
fi

printf '\n%s figures, %s differ\n' "$n_checked" "$n_wrong"
[ "$n_wrong" -eq 0 ]
