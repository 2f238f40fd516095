// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include <axiforge/meshing/size_field.h>

namespace axiforge::meshing
{
  SizeField::SizeField(const double largest, const double smallest, const double growth)
      : h_max(largest)
      , h_min(std::min(smallest, largest))
      , growth(growth)
  {
  }


  void SizeField::demand(const Point &x, const double size)
  {
    // What is met within a hundredth is not worth a place in the list.
    const double wanted = std::max(size, h_min);
    if (wanted < 0.99 * at(x))
      demands.push_back({ x, wanted });
  }


  double SizeField::at(const Point &x) const
  {
    double size = h_max;
    for (const Demand &demand : demands)
      if (size > demand.size)
        size = std::min(size, demand.size + growth * x.distance(demand.x));
    return size;
  }


  void SizeField::scale(const double factor)
  {
    h_max *= factor;
    h_min *= factor;
    for (Demand &demand : demands)
      demand.size *= factor;
  }
} // namespace axiforge::meshing
