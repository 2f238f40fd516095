/* SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Preloaded by growth.py: counts what CHOLMOD's factorisations do in a program that knows nothing
 * of it. At the end one line on standard error: factorisations, floating-point operations of one,
 * entries of the factor, CPU seconds of all; one with the shares of the operations in supernodes of
 * fewer than 16, 32, 64, 128 columns; and the CPU seconds that the BLAS alone takes for fronts of
 * the supernodes' shapes (dpotrf, dtrsm, dsyrk on one matrix that is there already). */
#define _GNU_SOURCE
#include <cholmod.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef int
factorize_function(cholmod_sparse *, double *, int *, size_t, cholmod_factor *, cholmod_common *);

static long   calls;
static double operations, entries, seconds;
static double share[4]; /* below 16, 32, 64, 128 columns */
static size_t fronts;
static int (*shape)[2]; /* columns and rows of each supernode */

/* Column j of a supernode of h rows costs (h - j)^2 operations, with what it takes from later ones.
 */
static void sort_by_width(const cholmod_factor *factor)
{
  const int *first = factor->super, *rows = factor->pi;
  double     sum = 0, part[4] = { 0 };
  if (!factor->is_super || factor->itype != CHOLMOD_INT)
    return;
  fronts = factor->nsuper;
  shape  = malloc(fronts * sizeof *shape);
  for (size_t s = 0; s < factor->nsuper; ++s)
    {
      const int width = first[s + 1] - first[s], height = rows[s + 1] - rows[s];
      double    cost = 0;
      shape[s][0]    = width;
      shape[s][1]    = height;
      for (int j = 0; j < width; ++j)
        cost += (double)(height - j) * (height - j);
      sum += cost;
      for (int k = 0; k < 4; ++k)
        if (width < 16 << k)
          part[k] += cost;
    }
  for (int k = 0; k < 4; ++k)
    share[k] = part[k] / sum;
}

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

typedef void potrf_function(const char *, const int *, double *, const int *, int *);
typedef void trsm_function(const char *,
                           const char *,
                           const char *,
                           const char *,
                           const int *,
                           const int *,
                           const double *,
                           const double *,
                           const int *,
                           double *,
                           const int *);
typedef void syrk_function(const char *,
                           const char *,
                           const int *,
                           const int *,
                           const double *,
                           const double *,
                           const int *,
                           const double *,
                           double *,
                           const int *);

static double seconds_of_blas(void)
{
  potrf_function *dpotrf = (potrf_function *)dlsym(RTLD_DEFAULT, "dpotrf_");
  trsm_function  *dtrsm  = (trsm_function *)dlsym(RTLD_DEFAULT, "dtrsm_");
  syrk_function  *dsyrk  = (syrk_function *)dlsym(RTLD_DEFAULT, "dsyrk_");
  int             most   = 0, status;
  for (size_t s = 0; s < fronts; ++s)
    most = shape[s][1] > most ? shape[s][1] : most;
  double *front = calloc((size_t)most * most, sizeof *front);
  if (!dpotrf || !dtrsm || !dsyrk || !front)
    return 0;
  const double one = 1, minus = -1;
  double       sum = 0;
  for (size_t s = 0; s < fronts; ++s)
    {
      const int width = shape[s][0], height = shape[s][1], rest = height - width;
      for (int j = 0; j < width; ++j)
        for (int i = j; i < height; ++i)
          front[(size_t)j * height + i] = i == j;
      const double begin = now();
      dpotrf("L", &width, front, &height, &status);
      if (rest)
        {
          dtrsm("R", "L", "T", "N", &rest, &width, &one, front, &height, front + width, &height);
          dsyrk("L", "N", &rest, &width, &minus, front + width, &height, &one,
                front + (size_t)width * height + width, &height);
        }
      sum += now() - begin;
    }
  free(front);
  return sum;
}

int cholmod_factorize_p(cholmod_sparse *matrix,
                        double          beta[2],
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
  if (!calls++)
    sort_by_width(factor);
  operations = common->fl;
  entries    = common->lnz;
  return result;
}

__attribute__((destructor)) static void report(void)
{
  if (calls)
    fprintf(stderr,
            "cholmod: %ld factorisations, %.6g operations each, %.6g entries, %.6g s in all\n",
            calls, operations, entries, seconds);
  if (calls)
    fprintf(stderr, "cholmod: shares below 16, 32, 64, 128 columns: %.4f %.4f %.4f %.4f\n",
            share[0], share[1], share[2], share[3]);
  if (fronts)
    fprintf(stderr, "cholmod: BLAS alone %.6g s, %zu supernodes\n", seconds_of_blas(), fronts);
}
