// SPDX-License-Identifier: GPL-2.0-or-later
// The sizes of new meshes, the meshes that follow them, and what is done to bad ones.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/meshing/mesh_checks.h>
#include <axiforge/meshing/mesh_repair.h>
#include <axiforge/meshing/outline_mesh.h>
#include <axiforge/meshing/remesh.h>
#include <axiforge/meshing/size_demands.h>

using namespace axiforge;
using namespace axiforge::meshing;
using namespace axiforge::testing_support;

namespace
{
  /// A loop through the corners, its edges as long as the field has it in their middle.
  NewLoop polygon(const std::vector<Point> &corners, const SizeField &field)
  {
    NewLoop loop;
    for (unsigned int k = 0; k < corners.size(); ++k)
      {
        const Point         a = corners[k], b = corners[(k + 1) % corners.size()];
        const unsigned int  fine = 1000;
        std::vector<double> count(1, 0.);
        for (unsigned int i = 0; i < fine; ++i)
          count.push_back(count.back() +
                          a.distance(b) / fine / field.at(a + (i + 0.5) / fine * (b - a)));
        const unsigned int n = 2 * std::max(1l, std::lround(0.5 * count.back()));
        std::vector<Point> x;
        for (unsigned int i = 0, j = 0; i <= n; ++i)
          {
            while (j < fine && count[j] < i * count.back() / n)
              ++j;
            x.push_back(a + double(j) / fine * (b - a));
          }
        for (unsigned int i = 0; i < n; ++i)
          {
            NewNode vertex{}, middle{};
            vertex.position = x[i];
            middle.position = x[i] + 0.5 * ((i + 1 < n ? x[i + 1] : b) - x[i]);
            loop.vertices.push_back(vertex);
            loop.middles.push_back(middle);
            loop.ids.push_back(surface_id);
          }
      }
    return loop;
  }


  /// A made mesh of straight cells from vertices, cells and a closed boundary.
  NewMesh mesh_of(const std::vector<Point>                       &vertices,
                  const std::vector<std::array<unsigned int, 4>> &cells,
                  const std::vector<unsigned int>                &boundary)
  {
    NewMesh made;
    made.mesh.vertices = vertices;
    made.mesh.cells    = cells;
    for (unsigned int k = 0; k < boundary.size(); ++k)
      {
        const unsigned int a = boundary[k], b = boundary[(k + 1) % boundary.size()];
        made.mesh.boundary_edges.push_back({ a, b, surface_id });
        std::array<NewNode, 3> nodes{};
        nodes[0].position = vertices[a];
        nodes[1].position = vertices[b];
        nodes[2].position = vertices[a] + 0.5 * (vertices[b] - vertices[a]);
        made.boundary.push_back(nodes);
      }
    place_cell_nodes(made);
    return made;
  }
} // namespace


TEST(SizeField, GrowsNoFasterThanAsked)
{
  SizeField field(4, 0.2, 0.3);
  field.demand(Point(1, 1), 0.5);
  field.demand(Point(9, 2), 0.01); // less than the smallest size
  field.demand(Point(2, 8), 10);   // more than the largest
  EXPECT_NEAR(field.at(Point(1, 1)), 0.5, 1e-14);
  EXPECT_NEAR(field.at(Point(9, 2)), 0.2, 1e-14);
  EXPECT_NEAR(field.at(Point(1, 3)), 0.5 + 0.3 * 2, 1e-14);
  EXPECT_EQ(field.at(Point(100, 100)), 4);
  double steepest = 0;
  for (unsigned int i = 0; i < 50; ++i)
    for (unsigned int j = 0; j < 50; ++j)
      {
        const Point a(0.2 * i, 0.2 * j), b(0.2 * i + 0.1, 0.2 * j + 0.05);
        steepest = std::max(steepest, std::abs(field.at(a) - field.at(b)) / a.distance(b));
      }
  EXPECT_LE(steepest, 0.3 + 1e-12);
  EXPECT_GT(steepest, 0.25);
}


/// Inside, too, cells are as large as the field asks for, and good.
TEST(OutlineMesh, FollowsTheField)
{
  SizeField field(2, 0.2, 0.3);
  field.demand(Point(20, 10), 0.25);
  const NewLoop loop = polygon({ Point(10, 0), Point(30, 0), Point(30, 20), Point(10, 20) }, field);
  const NewMesh made = mesh_outline({ loop }, field, { { "surface", surface_id } });
  ASSERT_TRUE(made.fault.empty()) << made.fault;
  EXPECT_GT(smallest_scaled_jacobian(made.mesh), 0.3);
  EXPECT_EQ(made.mesh.boundary_edges.size(), loop.vertices.size());

  double area = 0, sum = 0, expected = 0;
  for (const auto &x : made.mesh.cell_nodes)
    {
      const double cell = jacobian(x, Point(0.5, 0.5));
      const double size = std::sqrt(cell), wanted = field.at(x[8]);
      EXPECT_LT(size, 2.2 * wanted) << x[8];
      EXPECT_GT(size, wanted / 3) << x[8];
      area += cell;
      sum += std::log(size / wanted);
      expected += cell / (wanted * wanted);
    }
  EXPECT_NEAR(area, 400, 0.1);
  EXPECT_NEAR(sum / made.mesh.cells.size(), 0, 0.35) << "on the whole too fine or too coarse";
  EXPECT_NEAR(made.mesh.cells.size() / expected, 1.2, 0.5);
}


/// A cell with two edges on a straight side has an angle of 180 degrees: no position of inner
/// vertices helps, a ring of six cells around the three at the opposite vertex does.
TEST(MeshRepair, FlatCornersAreFramed)
{
  // A 2 x 2 square; the lower side has a middle vertex 1 that belongs to one cell only.
  NewMesh made = mesh_of(
      { Point(1, 0), Point(2, 0), Point(3, 0), Point(3, 2), Point(2, 2), Point(1, 2), Point(2, 1) },
      { { { 0, 1, 6, 2 } }, { { 6, 2, 4, 3 } }, { { 0, 6, 5, 4 } } }, { 0, 1, 2, 3, 4, 5 });
  ASSERT_LT(smallest_scaled_jacobian(made.mesh), 1e-10);
  EXPECT_EQ(repair_topology(made), 1u);
  EXPECT_EQ(made.mesh.cells.size(), 9u);
  smooth(made, 50);
  EXPECT_EQ(fault_of_mesh(made.mesh), "");
  EXPECT_GT(smallest_scaled_jacobian(made.mesh), 0.25);
  double area = 0;
  for (const auto &x : made.mesh.cell_nodes)
    area += jacobian(x, Point(0.5, 0.5));
  EXPECT_NEAR(area, 4, 1e-12);
}


/// A regular grid whose inner vertices are thrown about, cells inverted, becomes regular again.
TEST(MeshRepair, SmoothingUntangles)
{
  constexpr unsigned int                   n = 6;
  std::vector<Point>                       x;
  std::vector<std::array<unsigned int, 4>> cells;
  std::vector<unsigned int>                boundary;
  for (unsigned int j = 0; j <= n; ++j)
    for (unsigned int i = 0; i <= n; ++i)
      {
        const bool inner = i > 0 && i < n && j > 0 && j < n;
        x.push_back(Point(1. + i + (inner ? 1.3 * std::sin(7. * i + 3. * j) : 0.),
                          j + (inner ? 1.3 * std::cos(5. * i + 11. * j) : 0.)));
      }
  for (unsigned int j = 0; j < n; ++j)
    for (unsigned int i = 0; i < n; ++i)
      {
        const unsigned int v = j * (n + 1) + i;
        cells.push_back({ { v, v + 1, v + n + 1, v + n + 2 } });
      }
  for (unsigned int k = 0; k < n; ++k)
    boundary.push_back(k);
  for (unsigned int k = 0; k < n; ++k)
    boundary.push_back(k * (n + 1) + n);
  for (unsigned int k = 0; k < n; ++k)
    boundary.push_back((n + 1) * (n + 1) - 1 - k);
  for (unsigned int k = 0; k < n; ++k)
    boundary.push_back((n - k) * (n + 1));
  NewMesh made = mesh_of(x, cells, boundary);
  ASSERT_LT(smallest_scaled_jacobian(made.mesh), 0);
  smooth(made, 500);
  EXPECT_GT(smallest_scaled_jacobian(made.mesh), 0.98);
  for (unsigned int j = 0; j <= n; ++j)
    for (unsigned int i = 0; i <= n; ++i)
      EXPECT_LT(made.mesh.vertices[j * (n + 1) + i].distance(Point(1. + i, j)), 0.02);
}


/// An inner vertex of two cells goes.
TEST(MeshRepair, DoubletsAreJoined)
{
  NewMesh made = mesh_of({ Point(1, 0), Point(3, 0), Point(1, 2), Point(3, 2), Point(2, 1) },
                         { { { 0, 1, 4, 3 } }, { { 0, 4, 2, 3 } } }, { 0, 1, 3, 2 });
  EXPECT_EQ(repair_topology(made), 1u);
  EXPECT_EQ(made.mesh.cells.size(), 1u);
  EXPECT_EQ(made.mesh.vertices.size(), 4u);
  EXPECT_NEAR(smallest_scaled_jacobian(made.mesh), 1, 1e-12);
}


int main(int argc, char *argv[])
{
  ::testing::InitGoogleTest(&argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return RUN_ALL_TESTS();
}
