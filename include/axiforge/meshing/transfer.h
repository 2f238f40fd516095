// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <deal.II/base/bounding_box.h>

#include <axiforge/meshing/snapshot.h>

namespace axiforge::meshing
{
  /// The fields of an old mesh at any point: found by boxes and Newton's method in the Q2 cells.
  class OldFields
  {
  public:
    explicit OldFields(const Snapshot &snapshot);

    struct Place
    {
      unsigned int cell;
      double       xi[2];
    };

    /// The cell of a point and its reference coordinates; of a point outside of all cells the
    /// nearest, with coordinates that leave the unit cell by 0.05 at most.
    Place find(const Point &x) const;

    /// Q2 interpolation of the nodes [mm/s]: exact for linear fields on straight cells.
    Vector2 velocity(const Place &place) const;

    /// The polynomial through the nine Gauss points, within the range of these nine.
    double at_gauss_points(const double (&values)[9], const Place &place) const;
    double strain(const Place &place) const;

    /// Stresses and rates, each within the range of the cell's values; the pressure's coefficients
    /// are left alone.
    void history(const Place &place, CellHistory &history, unsigned int q) const;

  private:
    /// Column (c = 0) or row (1) of the bin of a point, the nearest for points outside.
    unsigned int bin(const Point &x, unsigned int c) const;
    double       try_cell(unsigned int cell, const Point &x, double (&xi)[2]) const;

    const Snapshot                        &snapshot;
    Point                                  lower;
    double                                 bin_size;
    unsigned int                           bins[2];
    std::vector<std::vector<unsigned int>> cells_of_bin;
    std::vector<dealii::BoundingBox<2>>    boxes;    ///< of the cells, a quarter larger
    double                                 gauss[3]; ///< points on [0, 1]
  };

  /**
   * Fills velocity, strain, histories, contacts and friction of a state with a new mesh (everything
   * zero but the position) from the old one. @p boundary has what the nodes of the new boundary
   * edges carry, found by their position. Collective.
   */
  struct CarriedEdge
  {
    double      position[3][2];
    SurfaceNode node[3]; ///< start, end, middle
  };
  void transfer(const Snapshot &old, const std::vector<CarriedEdge> &boundary, State &state);

  /// Integral of the effective strain over the body of revolution [mm^3]. Collective.
  double strain_integral(const State &state);
} // namespace axiforge::meshing
