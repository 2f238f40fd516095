// SPDX-License-Identifier: GPL-2.0-or-later
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>

#include <axiforge/base/blas.h>

namespace axiforge
{
  namespace
  {
    /// A function of a library that may not be there.
    template <typename Function> Function *find_function(const char *name)
    {
      return reinterpret_cast<Function *>(dlsym(RTLD_DEFAULT, name));
    }

    bool parallel_regions_in_place = false;
  } // namespace


  void use_suitable_blas()
  {
#if defined(__x86_64__) && defined(__GNUC__)
    const auto core_name = find_function<char *()>("openblas_get_corename");
    const auto forget    = find_function<void()>("gotoblas_dynamic_quit");
    const auto choose    = find_function<void()>("gotoblas_dynamic_init");
    if (std::getenv("OPENBLAS_CORETYPE") || !core_name || !forget || !choose ||
        std::strcmp(core_name(), "Prescott") != 0)
      return;
    const char *core = nullptr;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
      core = "SkylakeX";
    else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
      core = "Haswell";
    if (!core)
      return;
    setenv("OPENBLAS_CORETYPE", core, 1); // which the choice goes by
    forget();
    choose();
#endif
  }


  void use_one_thread()
  {
    if (!std::getenv("OPENBLAS_NUM_THREADS"))
      if (const auto set = find_function<void(int)>("openblas_set_num_threads"))
        set(1);
    // CHOLMOD asks for four threads in so many words, whatever OMP_NUM_THREADS says; no active
    // level of parallelism stops it. On a matrix of 5,000 unknowns they take 2.4 times the CPU
    // time.
    const char *wanted = std::getenv("OMP_NUM_THREADS");
    if (wanted && std::strcmp(wanted, "1") != 0)
      return;
    if (const auto set = find_function<void(int)>("omp_set_max_active_levels"))
      set(0);
    parallel_regions_in_place = true;
  }
} // namespace axiforge


/**
 * In place of libgomp's function of this name, which the OpenMP regions of all libraries call. A
 * team of one thread costs libgomp a memory allocation and a system call each time; CHOLMOD has two
 * regions for each front, so that this was a sixth of the factorisation of 5,000 unknowns.
 */
extern "C" __attribute__((visibility("default"))) void GOMP_parallel(void (*body)(void *),
                                                                     void              *data,
                                                                     const unsigned int n_threads,
                                                                     const unsigned int flags)
{
  using Function             = void(void (*)(void *), void *, unsigned int, unsigned int);
  static const auto original = reinterpret_cast<Function *>(dlsym(RTLD_NEXT, "GOMP_parallel"));
  if (axiforge::parallel_regions_in_place || !original)
    body(data);
  else
    original(body, data, n_threads, flags);
}
