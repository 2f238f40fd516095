// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace axiforge
{
  /**
   * OpenBLAS chooses its kernels when it is loaded, and falls back to those of a processor of 2004
   * (PRESCOTT, a quarter of the speed) when it is older than the machine. In that case sets
   * OPENBLAS_CORETYPE to what the processor has and lets OpenBLAS choose again, through the two
   * functions that it does so with itself (gotoblas_dynamic_quit and _init of its dynamic.c). Does
   * nothing with another BLAS, on a known processor, or if the user has set that variable. Call it
   * before anything calls the BLAS.
   */
  void use_suitable_blas();

  /**
   * One thread for BLAS and for CHOLMOD's OpenMP loops: the fronts are small, several ranks would
   * fight for the cores, and the same run has to give the same bytes. OPENBLAS_NUM_THREADS and
   * OMP_NUM_THREADS, where the user sets them, win.
   */
  void use_one_thread();
} // namespace axiforge
