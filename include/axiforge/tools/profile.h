// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include <axiforge/tools/segment.h>

namespace axiforge::tools
{
  /// Where a point is with respect to a tool.
  struct Contact
  {
    double  gap = 0;       ///< signed distance [mm], negative inside the tool
    Vector2 normal;        ///< unit vector out of the tool, to the workpiece's side
    Point   closest;       ///< closest point of the tool's surface
    double  curvature = 0; ///< of the surface there [1/mm], positive where the tool is convex; 0 at
                           ///< a corner. The second derivative of the gap along the tangent is
                           ///< curvature / (1 + curvature * gap).
    unsigned int face       = 0; ///< number of the smooth part of the outline
    double       arc_length = 0; ///< of `closest` along its chain [mm]
    double       past_end   = 0; ///< way beyond a free end of the profile, along it [mm]
    Vector2      end_normal;     ///< that the profile has at its free end, if past_end > 0
  };

  /// The deepest of some points inside a tool.
  struct Penetration
  {
    double gap = 0; ///< smallest gap [mm], negative if a point is inside
    Point  place;
  };

  /**
   * The outline of a rigid tool in the meridian plane: lines, circular arcs and cubics, joined to
   * open or closed chains. A tool may have several chains.
   *
   * Which side of a chain is the tool is not known from the outline: orient() finds it from the
   * workpiece. From then on chains run with the workpiece on their left, so that face numbers and
   * arc lengths do not depend on the order or direction in which a file lists the segments. Before,
   * the left side of the first segment of each chain is taken for the workpiece's.
   *
   * The gap is the true signed distance, with these conventions:
   * - Behind an open chain its gap is negative without limit, but only where a point projects on
   * it. Beyond a free end the gap is the positive distance from the end: a platen that ends leaves
   * the nodes beyond it free. An end on the axis r = 0 is no free end: the outline goes on
   * mirrored.
   * - At a convex corner points in the fan have the direction from the corner as their normal.
   * - At a concave corner of more than `corner_angle` a point has the gaps of both flanks, the
   * other flank continued by its tangent beyond the corner. Behind the corner, where the corner
   *   itself is closest, the gaps are those of the continued flanks, not of the corner.
   * - Flatter corners (polylines in place of a curve) give one contact, the closest point's.
   */
  class Profile
  {
  public:
    /// Directions that differ less than this [rad] are one smooth face.
    static constexpr double smooth_angle = 1e-5;

    /// Concave corners that turn by more than this [rad] (10 degrees) have two contacts.
    static constexpr double corner_angle = 0.17453292519943295;

    Profile() = default;

    /**
     * Join segments, in any order and direction, whose ends meet within 1e-7 of the profile's size.
     * Throws InputError, with @p name and the place, if there is no segment or if more than two
     * meet in a point.
     */
    explicit Profile(std::vector<Segment> segments, const std::string &name = "tool");

    /**
     * Choose the workpiece's side of each chain, so that @p workpiece_points, points of the
     * workpiece's boundary [mm] at the tool's start position, lie outside of the tool. Every point
     * has a vote; touching points and far ones weigh little. Throws InputError if they leave it
     * open.
     */
    void orient(const std::vector<Point> &workpiece_points);

    /// Put the whole profile elsewhere; the workpiece's side stays the same side.
    void move(const Vector2 &way);

    /**
     * Contacts of x [mm, in the tool's own coordinates]: those with a gap of at most @p reach [mm],
     * penetrating points whatever their depth. Returns their number:
     * the nearest first, then the other flank of a concave corner or, if it is within reach as well
     * and has another direction, another chain of the same tool. A large reach makes this a plain
     * nearest query. Points far in front of all tangent planes of a
     * chain, as above a platen, cost next to nothing; under a die that opens what near ones do.
     */
    unsigned int find(const Point &x, double reach, std::array<Contact, 2> &contacts) const;

    /// The deepest point (or, if none is inside, the nearest one).
    Penetration worst_penetration(const std::vector<Point> &points) const;

    /// Box around the outline.
    const Box &bounding_box() const;

    /// Length of the outline [mm].
    double length() const;

    /// A corner of more than `corner_angle` between two segments.
    struct Corner
    {
      Point  place; ///< [mm], in the tool's own coordinates
      double turn;  ///< angle between the tangents [rad], positive where the tool is concave
    };
    std::vector<Corner> corners() const;

    /// Ends of the chains away from the axis [mm], in the tool's own coordinates.
    std::vector<Point> free_ends() const;

    unsigned int n_faces() const;
    unsigned int n_chains() const;

    /// Polylines, one per chain, off the outline by at most @p chord_tolerance [mm].
    std::vector<std::vector<Point>> sample(double chord_tolerance) const;

  private:
    /// What is between two segments, or at the end of a chain. Normals point to the left.
    struct Junction
    {
      bool    free_end = false; ///< nothing follows
      Vector2 bisector;         ///< sum of the normals at both sides
      double  turn = 0; ///< angle from one tangent to the next, positive to the left: concave
    };

    /// Consecutive segments without a corner larger than `corner_angle`.
    struct Run
    {
      unsigned int first = 0, count = 0; ///< segments, counted around the end of closed chains
      Box          box;
    };

    struct Chain
    {
      std::vector<Segment>      segments;
      bool                      closed = false;
      std::vector<Junction>     junctions; ///< before each segment, and one after the last
      std::vector<unsigned int> faces;     ///< of each segment
      std::vector<double>       starts;    ///< arc length at the begin of each segment [mm]
      std::vector<Run>          runs;
      std::vector<unsigned int> run_of; ///< of each segment
      Box                       box;
      bool                      tool_is_inside = false; ///< closed chains
      bool                      has_cone = false; ///< the normals turn by less than half a turn
      std::vector<Vector2>      cone; ///< the two outermost normals, and those at ends on the axis

      const Junction &junction(unsigned int segment, bool at_end) const;
    };

    struct Nearest
    {
      unsigned int  segment = 0;
      Segment::Foot foot;
    };

    /// Everything that follows from the segments and their direction.
    void complete();
    void complete(Chain &chain, unsigned int first_face) const;
    void set_junctions(Chain &chain) const;
    void set_runs(Chain &chain) const;
    void set_cone(Chain &chain) const;

    /// Run through a chain the other way.
    static void reverse(Chain &chain);

    /// Whether x is farther than @p reach away and sure to be outside of the tool.
    static bool is_far(const Chain &chain, const Point &x, double reach);

    static Nearest
    nearest(const Chain &chain, const Point &x, unsigned int first, unsigned int count);

    static Contact make_contact(const Chain &chain, const Nearest &nearest, const Point &x);

    /// The other flank of a concave corner at an end of the run of @p nearest.
    static bool other_flank(const Chain   &chain,
                            const Nearest &nearest,
                            const Point   &x,
                            double         reach,
                            double         first_gap,
                            Contact       &contact);

    /// Contribution of one point to the choice of the side, with the chain's present direction.
    static double vote(const Chain &chain, const Point &x, double weighting_distance);

    std::string        name;
    std::vector<Chain> chains;
    Box                box;
    double             whole_length = 0;
    unsigned int       face_count   = 0;
  };
} // namespace axiforge::tools
