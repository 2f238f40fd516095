/* SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Preloaded by growth.py: counts what CHOLMOD's factorisations do in a program that knows nothing of
 * it. At the end one line on standard error: factorisations, floating-point operations of one, entries
 * of the factor, CPU seconds of all. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <time.h>

#include <cholmod.h>

typedef int factorize_function(cholmod_sparse *, double *, int *, size_t, cholmod_factor *,
                               cholmod_common *);

static long   calls;
static double operations, entries, seconds;

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

int cholmod_factorize_p(cholmod_sparse *matrix,
                        double         *beta,
                        int            *set,
                        size_t          size,
                        cholmod_factor *factor,
                        cholmod_common *common)
{
  static factorize_function *original;
  if (!original)
    original = (factorize_function *)dlsym(RTLD_NEXT, "cholmod_factorize_p");
  const double begin  = now();
  const int    result = original(matrix, beta, set, size, factor, common);
  seconds += now() - begin;
  ++calls;
  operations = common->fl;
  entries    = common->lnz;
  return result;
}

__attribute__((destructor)) static void report(void)
{
  if (calls)
    fprintf(stderr, "cholmod: %ld factorisations, %.6g operations each, %.6g entries, %.6g s in all\n",
            calls, operations, entries, seconds);
}
