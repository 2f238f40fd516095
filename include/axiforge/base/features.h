// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace axiforge
{
  /**
   * Whether friction, loads (body force, pressure), adaptive refinement, remeshing, error
   * estimates, folds and gauges are in the program. They always are but in the build that
   * benchmarks/skip.py makes with AXIFORGE_CORE_ONLY, which shows that they cost nothing where a
   * scene does not ask for them: there the compiler drops everything behind this.
   */
#ifdef AXIFORGE_CORE_ONLY
  constexpr bool optional_features = false;
#else
  constexpr bool optional_features = true;
#endif
} // namespace axiforge
