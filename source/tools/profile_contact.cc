// SPDX-License-Identifier: GPL-2.0-or-later
// The queries of Profile: closest points, gaps and normals.
#include <algorithm>
#include <cmath>
#include <limits>

#include <axiforge/tools/profile.h>

namespace axiforge::tools
{
  namespace
  {
    Vector2 left_of(const Vector2 &t)
    {
      return Vector2({ -t[1], t[0] });
    }
  } // namespace

  bool Profile::is_far(const Chain &chain, const Point &x, const double reach)
  {
    if (chain.box.distance_square(x) <= reach * reach)
      return false;
    if (chain.closed)
      return chain.tool_is_inside;
    if (!chain.has_cone)
      return false;
    // In front of every tangent plane: every normal is a positive combination of the two outermost,
    // and every point of the chain one of the box's corners.
    for (const Vector2 &normal : chain.cone)
      for (const double r : { chain.box.lower[0], chain.box.upper[0] })
        for (const double z : { chain.box.lower[1], chain.box.upper[1] })
          if ((x - Point(r, z)) * normal <= 0)
            return false;
    return true;
  }

  Profile::Nearest Profile::nearest(const Chain       &chain,
                                    const Point       &x,
                                    const unsigned int first,
                                    const unsigned int count)
  {
    const unsigned int n = chain.segments.size();

    // Begin with the segment whose box is nearest: most others are then left out by theirs.
    unsigned int start         = first;
    double       start_squared = std::numeric_limits<double>::max();
    for (unsigned int i = 0; i < count && count > 1; ++i)
      {
        const unsigned int s       = (first + i) % n;
        const double       squared = chain.segments[s].box().distance_square(x);
        if (squared < start_squared)
          {
            start_squared = squared;
            start         = s;
          }
      }

    Nearest best{ start, chain.segments[start].closest(x) };
    for (unsigned int i = 0; i < count; ++i)
      {
        const unsigned int s         = (first + i) % n;
        const double       tolerance = 1e-12 * best.foot.distance;
        const double       limit     = best.foot.distance + tolerance;
        if (s == start || chain.segments[s].box().distance_square(x) > limit * limit)
          continue;
        const Segment::Foot foot = chain.segments[s].closest(x);
        // At a corner both segments are equally near: one that x projects on comes first.
        if (foot.distance < best.foot.distance - tolerance ||
            (foot.distance <= limit && foot.inside && !best.foot.inside))
          best = { s, foot };
      }
    return best;
  }

  Contact Profile::make_contact(const Chain &chain, const Nearest &nearest, const Point &x)
  {
    const Segment       &segment = chain.segments[nearest.segment];
    const Segment::Foot &foot    = nearest.foot;
    const Vector2        offset  = x - foot.point;

    Contact contact;
    contact.closest    = foot.point;
    contact.normal     = left_of(segment.tangent(foot.parameter));
    contact.face       = chain.faces[nearest.segment];
    contact.arc_length = chain.starts[nearest.segment] + segment.arc_length(foot.parameter);

    if (foot.inside)
      {
        contact.gap       = std::copysign(foot.distance, offset * contact.normal);
        contact.curvature = -segment.curvature(foot.parameter);
        return contact;
      }

    const Junction &junction = chain.junction(nearest.segment, foot.parameter > 0.5);
    const bool      outside  = junction.free_end || offset * junction.bisector >= 0;
    if (junction.free_end)
      {
        contact.past_end   = std::abs(offset * segment.tangent(foot.parameter));
        contact.end_normal = contact.normal;
      }
    if (!outside && junction.turn > corner_angle)
      {
        contact.gap = offset * contact.normal; // behind a concave corner: the continued flank
        return contact;
      }
    contact.gap    = outside ? foot.distance : -foot.distance;
    contact.normal = offset / contact.gap;
    return contact;
  }

  bool Profile::other_flank(const Chain   &chain,
                            const Nearest &nearest_point,
                            const Point   &x,
                            const double   reach,
                            const double   first_gap,
                            Contact       &contact)
  {
    const unsigned int n      = chain.segments.size();
    const unsigned int n_runs = chain.runs.size();
    const unsigned int run    = chain.run_of[nearest_point.segment];
    const double       limit  = std::max(reach, -first_gap);

    bool found = false;
    for (const bool at_end : { false, true })
      {
        const Run         &here = chain.runs[run];
        const unsigned int corner =
            at_end ? (here.first + here.count - 1) % n + 1 : here.first; // index of a junction
        const bool is_chain_end = !chain.closed && (corner == 0 || corner == n);
        if (n_runs < 2 || is_chain_end || !(chain.junctions[corner].turn > corner_angle))
          continue;

        const Run &flank = chain.runs[(run + (at_end ? 1 : n_runs - 1)) % n_runs];
        if (flank.box.distance_square(x) > limit * limit)
          continue;
        const Nearest on_flank  = nearest(chain, x, flank.first, flank.count);
        Contact       candidate = make_contact(chain, on_flank, x);
        if (!on_flank.foot.inside)
          {
            // Beyond the corner the flank goes on straight; beyond its other end it does not.
            const unsigned int corner_segment =
                at_end ? flank.first : (flank.first + flank.count - 1) % n;
            if (on_flank.segment != corner_segment || (on_flank.foot.parameter > 0.5) == at_end)
              continue;
            candidate.normal =
                left_of(chain.segments[corner_segment].tangent(on_flank.foot.parameter));
            candidate.gap = (x - on_flank.foot.point) * candidate.normal;
          }
        if (candidate.gap <= reach && (!found || candidate.gap < contact.gap))
          {
            contact = candidate;
            found   = true;
          }
      }
    return found;
  }

  unsigned int
  Profile::find(const Point &x, const double reach, std::array<Contact, 2> &contacts) const
  {
    if (std::all_of(chains.begin(), chains.end(),
                    [&](const Chain &chain) { return is_far(chain, x, reach); }))
      return 0;

    Nearest      best;
    const Chain *best_chain = nullptr;
    for (const Chain &chain : chains)
      {
        if (best_chain != nullptr &&
            chain.box.distance_square(x) > best.foot.distance * best.foot.distance)
          continue;
        const Nearest candidate = nearest(chain, x, 0, chain.segments.size());
        if (best_chain == nullptr || candidate.foot.distance < best.foot.distance)
          {
            best       = candidate;
            best_chain = &chain;
          }
      }
    contacts[0] = make_contact(*best_chain, best, x);
    if (contacts[0].gap > reach)
      return 0;

    bool second = other_flank(*best_chain, best, x, reach, contacts[0].gap, contacts[1]);
    if (second && !best.foot.inside && contacts[0].gap < 0 && contacts[1].gap < contacts[0].gap)
      std::swap(contacts[0], contacts[1]); // behind a concave corner: the deeper flank first

    for (const Chain &chain : chains)
      {
        if (&chain == best_chain || chain.box.distance_square(x) > reach * reach)
          continue;
        const Nearest candidate = nearest(chain, x, 0, chain.segments.size());
        if (!candidate.foot.inside || candidate.foot.distance > reach)
          continue;
        const Contact contact = make_contact(chain, candidate, x);
        if (contact.normal * contacts[0].normal < std::cos(corner_angle) &&
            (!second || contact.gap < contacts[1].gap))
          {
            contacts[1] = contact;
            second      = true;
          }
      }
    return second ? 2 : 1;
  }

  Penetration Profile::worst_penetration(const std::vector<Point> &points) const
  {
    Penetration worst;
    worst.gap = std::numeric_limits<double>::max();
    std::array<Contact, 2> contacts;
    for (const Point &x : points)
      if (find(x, std::numeric_limits<double>::max(), contacts) > 0 && contacts[0].gap < worst.gap)
        worst = { contacts[0].gap, x };
    return worst;
  }
} // namespace axiforge::tools
