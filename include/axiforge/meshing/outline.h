// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <vector>

#include <deal.II/base/types.h>

#include <axiforge/meshing/size_field.h>
#include <axiforge/meshing/snapshot.h>
#include <axiforge/scene/scene.h>

namespace axiforge::meshing
{
  /// A node of the new outline.
  struct NewNode
  {
    Point       position;  ///< [mm]
    SurfaceNode carried;   ///< what the old surface knows there
    Vector2     direction; ///< in which it moves to restore the volume: 1 along the outer normal,
                           ///< less near a tool, 0 where it is held
  };

  /// A closed chain of new edges, the workpiece on its left. Edge k runs from vertex k to vertex
  /// k + 1; sharp corners are at even vertices, and the number of edges is even.
  struct NewLoop
  {
    std::vector<NewNode>                    vertices, middles;
    std::vector<dealii::types::boundary_id> ids;
  };

  /// A part of the old outline that is free or touches one tool: a parabola.
  struct OutlinePiece
  {
    std::array<Point, 3>       x; ///< start, end, middle
    dealii::types::boundary_id id;
    int                        tool; ///< that both ends and the middle touch; -1: none
    std::array<SurfaceNode, 3> node;
    std::array<double, 17>     arc; ///< length from the start at sixteenths of the parameter [mm]

    double length() const
    {
      return arc.back();
    }
    /// @param xi 0 at the start, 1 at the end
    Point   position(double xi) const;
    Vector2 tangent(double xi) const;
    double  parameter(double arc_length) const;
  };

  /// Of a node on free surface.
  SurfaceNode without_contact();

  /// Between two nodes that touch the same tool, t from 0 at a to 1 at b.
  SurfaceNode blend(const SurfaceNode &a, const SurfaceNode &b, double t, int tool);

  /// Sets OutlinePiece::arc from its nodes.
  void measure_arc(OutlinePiece &piece);

  /// Whether this part of the boundary is the axis or the symmetry line.
  bool is_straight(dealii::types::boundary_id id);

  /**
   * The outline of the workpiece as it stands, and its division into new edges.
   *
   * New nodes stand on the old Q2 edges; those between touching nodes are moved on to the profile
   * of the tool, and so are those that have come to stand inside of one. Corners stay: ends of the
   * axis, the symmetry line and named parts; nodes that touch two surfaces; and, unless they come
   * too close to each other, ends of contact and angles of more than 30 degrees. Where the surface
   * passes over a corner of a tool, a node is put into that corner.
   *
   * gmsh makes quadrilaterals by splitting the edges of a coarser mesh, whose vertices are the even
   * ones: in an odd vertex two cells meet, an even one may be the corner of a single cell. So
   * where the outline does not turn, as where it folds on to a tool, a corner is put at an odd
   * vertex: a single cell would have an angle of 180 degrees there.
   */
  class Outline
  {
  public:
    Outline(const Snapshot &snapshot, const scene::Scene &scene, double time);

    /**
     * Closes pockets: free surface between two places on the same tool goes on to the tool if they
     * are closer than @p width [mm] and the gap between has an area below a tenth of its square.
     * Nodes that are caught before their neighbours leave such gaps, which fold over into
     * themselves in the next steps. Returns their number.
     */
    unsigned int close_pockets(double width);

    /**
     * Cuts off notches and curls of the free surface: where it comes back to within half of its own
     * way, and that way is shorter than four times the width [mm], a straight line takes its place.
     * Perfectly plastic surfaces zig-zag and overlap below the edge of a platen. Returns their
     * number.
     */
    unsigned int cut_curls(double width);

    /// A place of the outline.
    struct Sample
    {
      Point                      x;
      Vector2                    inward; ///< unit normal into the workpiece
      dealii::types::boundary_id id;
      int                        tool; ///< -1: none
    };
    /// Each loop at places about so far from each other [mm], the ends of pieces among them.
    std::vector<std::vector<Sample>> sample(double spacing) const;

    /// Places where the surface leaves a tool.
    std::vector<Point> contact_ends() const;

    /// Edges as long as the field wants them. Parts of the outline that are shorter than that
    /// become demands of the field.
    std::vector<NewLoop> divide(SizeField &field) const;

    /// Area of the meridian section [mm^2].
    double area() const;

    /// Largest depth of an edge inside a tool between its nodes, over the length of the edge.
    static double penetration(const State &state, const scene::Scene &scene, double time);

    /// The smaller part, over the whole, that the middle node of a touching edge divides its chord
    /// into: the least of all such edges. At 1/4 the parabola begins to turn back on itself.
    static double least_division(const State &state);

  private:
    using Loop = std::vector<OutlinePiece>;

    struct Place
    {
      unsigned int piece;
      double       xi;
    };

    struct Corner
    {
      double s;            ///< arc length [mm]
      bool   keep;         ///< the old node stays where it is
      bool   hard;         ///< the outline turns by more than 30 degrees
      bool   snap = false; ///< the node goes to a corner of the tool:
      Point  place;
    };

    NewNode             new_node(const Loop &loop, const Place &place, bool keep) const;
    void                set_directions(const Loop                &loop,
                                       const std::vector<double> &arc,
                                       const SizeField           &field,
                                       NewLoop                   &result) const;
    std::vector<Corner> corners(const Loop &loop, const SizeField &field) const;
    void                add_tool_corners(const Loop                &loop,
                                         const std::vector<double> &start,
                                         const SizeField           &field,
                                         std::vector<Corner>       &found) const;
    void fair(NewLoop &loop) const; ///< takes waves of two edges from the free surface
    NewNode
    middle_node(const Loop &loop, const Place &place, const Point &from, const Point &to) const;
    Point on_tool(int tool, const Point &x) const;

    const scene::Scene  &scene;
    std::vector<Vector2> shift; ///< of the tools [mm]
    std::vector<Loop>    loops;
  };
} // namespace axiforge::meshing
