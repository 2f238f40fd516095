// SPDX-License-Identifier: GPL-2.0-or-later
#include <cstdlib>

#include <axiforge/base/single_process.h>

namespace axiforge
{
  void expect_single_process()
  {
    for (const char *launched : { "OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK", "SLURM_PROCID" })
      if (std::getenv(launched))
        return;
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    setenv("OMPI_MCA_pml", "ob1", 0);
    setenv("OMPI_MCA_btl", "self", 0);
  }
} // namespace axiforge
