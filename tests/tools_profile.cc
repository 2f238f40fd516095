// SPDX-License-Identifier: GPL-2.0-or-later
// Gap, normal and closest point of rigid tool profiles.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <axiforge/base/errors.h>
#include <axiforge/tools/profile.h>

using namespace axiforge;
using axiforge::tools::Contact;
using axiforge::tools::Profile;
using axiforge::tools::Segment;

namespace
{
  constexpr double everything = 1e9;

  /// A punch from above: flat end z = 10, edge of radius 2 around (8, 12), side r = 10 up to z
  /// = 30.
  std::vector<Segment> rounded_punch()
  {
    return { Segment::line(Point(0, 10), Point(8, 10)),
             Segment::arc(Point(8, 10), Point(10, 12), Point(8, 12), true),
             Segment::line(Point(10, 12), Point(10, 30)) };
  }

  std::vector<Point> billet(const double height)
  {
    return { Point(0, 0), Point(20, 0), Point(20, height), Point(10, height), Point(0, height) };
  }

  Profile oriented(const std::vector<Segment> &segments, const std::vector<Point> &workpiece)
  {
    Profile profile(segments);
    profile.orient(workpiece);
    return profile;
  }

  Contact nearest(const Profile &profile, const Point &x)
  {
    std::array<Contact, 2> contacts;
    EXPECT_GE(profile.find(x, everything, contacts), 1u);
    return contacts[0];
  }

  /// A wavy spline of two pieces with a smooth joint, an arc tangent to it and a sharp convex
  /// corner.
  std::vector<Segment> wavy_die()
  {
    return { Segment::cubic(Point(0, 0), Point(6, 2), Vector2({ 8, 0 }), Vector2({ 6, 6 })),
             Segment::cubic(Point(6, 2), Point(14, 3), Vector2({ 8, 8 }), Vector2({ 9, -9 })),
             Segment::line(Point(14, 3), Point(14, -6)) };
  }

  double brute_force_distance(const std::vector<Segment> &segments, const Point &x)
  {
    double smallest = 1e300;
    for (const Segment &segment : segments)
      for (unsigned int i = 0; i <= 20000; ++i)
        smallest = std::min(smallest, x.distance(segment.point(i / 20000.)));
    return smallest;
  }
} // namespace

TEST(Segment, ArcIsExact)
{
  const Segment arc = Segment::arc(Point(3, 0), Point(0, 3), Point(0, 0), true);
  EXPECT_NEAR(arc.length(), 3 * M_PI / 2, 1e-14);
  EXPECT_NEAR(arc.curvature(0.3), 1. / 3, 1e-15);
  const Segment::Foot foot = arc.closest(Point(4, 4));
  EXPECT_NEAR(foot.distance, 4 * std::sqrt(2.) - 3, 1e-14);
  EXPECT_NEAR(foot.parameter, 0.5, 1e-15);
  EXPECT_FALSE(arc.closest(Point(3.5, -1)).inside);

  const Segment back = arc.reversed();
  EXPECT_NEAR(back.point(0.25).distance(arc.point(0.75)), 0, 1e-14);
  EXPECT_NEAR(back.curvature(0.3), -1. / 3, 1e-15);

  const Segment circle = Segment::arc(Point(1, 0), Point(1, 0), Point(0, 0), false);
  EXPECT_NEAR(circle.length(), 2 * M_PI, 1e-14);
  EXPECT_NEAR(circle.box().lower[0], -1, 1e-14);
}

TEST(Segment, CubicTakesTheBestOfSeveralNearPoints)
{
  // A loop-like cubic: several local minima of the distance.
  const Segment cubic =
      Segment::cubic(Point(0, 0), Point(10, 0), Vector2({ 40, 60 }), Vector2({ 40, -60 }));
  std::mt19937                           random(7);
  std::uniform_real_distribution<double> in(-5, 15);
  for (unsigned int i = 0; i < 300; ++i)
    {
      const Point         x(in(random), in(random));
      const Segment::Foot foot = cubic.closest(x);
      EXPECT_LE(foot.distance, brute_force_distance({ cubic }, x) + 1e-12);
      if (foot.inside && foot.parameter > 0 && foot.parameter < 1)
        {
          EXPECT_NEAR((x - foot.point) * cubic.tangent(foot.parameter), 0, 1e-9);
        }
    }
}

TEST(Segment, CubicLengthAndCurvatureOfAQuarterCircle)
{
  // The usual cubic for a quarter circle, radius 1: length right to 3e-4, curvature to 2 %; and the
  // length of a straight cubic is exact.
  const double  c = 3 * 0.5522847498;
  const Segment quarter =
      Segment::cubic(Point(1, 0), Point(0, 1), Vector2({ 0, c }), Vector2({ -c, 0 }));
  EXPECT_NEAR(quarter.length(), M_PI / 2, 5e-4);
  EXPECT_NEAR(quarter.curvature(0.5), 1, 0.02);
  EXPECT_NEAR(
      Segment::cubic(Point(0, 0), Point(3, 4), Vector2({ 3, 4 }), Vector2({ 3, 4 })).length(), 5,
      1e-13);
}

TEST(Profile, RoundedPunch)
{
  const Profile punch = oriented(rounded_punch(), billet(9));

  EXPECT_NEAR(nearest(punch, Point(3, 8)).gap, 2, 1e-14);       // below the end
  EXPECT_NEAR(nearest(punch, Point(3, 10.5)).gap, -0.5, 1e-14); // in the tool
  EXPECT_NEAR(nearest(punch, Point(0, 11)).gap, -1, 1e-14);     // on the axis
  EXPECT_NEAR(nearest(punch, Point(13, 20)).gap, 3, 1e-14);     // beside
  EXPECT_NEAR(nearest(punch, Point(9.5, 20)).gap, -0.5, 1e-14);

  const Contact edge = nearest(punch, Point(11, 9)); // 3 sqrt 2 from the arc's centre
  EXPECT_NEAR(edge.gap, 3 * std::sqrt(2.) - 2, 1e-14);
  EXPECT_NEAR(edge.normal[0], std::sqrt(0.5), 1e-14);
  EXPECT_NEAR(edge.normal[1], -std::sqrt(0.5), 1e-14);
  EXPECT_NEAR(edge.curvature, 0.5, 1e-14); // convex
  EXPECT_NEAR(nearest(punch, Point(13, 20)).curvature, 0, 0);

  EXPECT_EQ(punch.n_faces(), 1u); // all joints are smooth
  EXPECT_NEAR(punch.length(), 8 + M_PI + 18, 1e-13);
}

TEST(Profile, GapIsTheDistanceAndTheNormalItsGradient)
{
  const std::vector<Segment> die     = wavy_die();
  const Profile              profile = oriented(die, { Point(1, 9), Point(6, 9), Point(12, 9) });
  std::mt19937               random(1);
  std::uniform_real_distribution<double> r(0, 20), z(-5, 9);
  const double                           h         = 1e-6;
  unsigned int                           n_checked = 0, n_behind = 0;
  for (unsigned int i = 0; i < 400; ++i)
    {
      const Point   x(r(random), z(random));
      const Contact contact = nearest(profile, x);
      EXPECT_NEAR(std::abs(contact.gap), brute_force_distance(die, x), 2e-6);
      EXPECT_NEAR(contact.normal.norm(), 1, 1e-14);
      EXPECT_NEAR((contact.closest + contact.gap * contact.normal).distance(x), 0, 1e-8);
      n_behind += contact.gap < 0;

      std::array<double, 4> gaps;
      for (unsigned int k = 0; k < 4; ++k)
        {
          Point y = x;
          y[k / 2] += k % 2 == 0 ? h : -h;
          gaps[k] = nearest(profile, y).gap;
        }
      const Vector2 gradient({ (gaps[0] - gaps[1]) / (2 * h), (gaps[2] - gaps[3]) / (2 * h) });
      if (std::abs(gradient.norm() - 1) > 1e-4)
        continue; // across the middle between two parts of the profile, or a jump behind the tool
      ++n_checked;
      EXPECT_NEAR((gradient - contact.normal).norm(), 0, 1e-5) << x;
    }
  EXPECT_GT(n_checked, 380u);
  EXPECT_GT(n_behind, 50u);
}

TEST(Profile, SecondDerivativeOfTheGapIsTheCurvature)
{
  const Profile profile = oriented(wavy_die(), { Point(1, 9), Point(6, 9), Point(12, 9) });
  for (const Point &x : { Point(4, 2), Point(7.5, 5), Point(2, -0.4) })
    {
      const Contact contact = nearest(profile, x);
      const Vector2 tangent({ -contact.normal[1], contact.normal[0] });
      const double  h      = 1e-3;
      const double  second = (nearest(profile, x + h * tangent).gap - 2 * contact.gap +
                             nearest(profile, x - h * tangent).gap) /
                            (h * h);
      EXPECT_NEAR(second, contact.curvature / (1 + contact.curvature * contact.gap), 1e-4);
    }
}

TEST(Profile, ContinuousAcrossASmoothJoint)
{
  const Profile punch = oriented(rounded_punch(), billet(9));
  for (const double z : { 9., 10., 10.3 })
    {
      const Contact before = nearest(punch, Point(8 - 1e-9, z)),
                    after  = nearest(punch, Point(8 + 1e-9, z));
      EXPECT_NEAR(before.gap, after.gap, 1e-14);
      EXPECT_NEAR((before.normal - after.normal).norm(), 0, 3e-9);
      EXPECT_NEAR(before.arc_length, after.arc_length, 4e-9);
      EXPECT_EQ(before.face, after.face);
    }
}

TEST(Profile, ConvexCorner)
{
  const Profile punch = oriented(
      { Segment::line(Point(0, 10), Point(8, 10)), Segment::line(Point(8, 10), Point(8, 30)) },
      billet(9));
  EXPECT_EQ(punch.n_faces(), 2u);

  const Contact fan = nearest(punch, Point(8.3, 9.6)); // the fan below and beside the corner
  EXPECT_NEAR(fan.gap, 0.5, 1e-14);
  EXPECT_NEAR(fan.normal[0], 0.6, 1e-14);
  EXPECT_NEAR(fan.normal[1], -0.8, 1e-14);

  const Contact corner = nearest(punch, Point(8, 10)); // exactly there: one of the flanks
  EXPECT_EQ(corner.gap, 0);
  EXPECT_NEAR(corner.normal.norm(), 1, 1e-14);
  EXPECT_NEAR(corner.normal[0] * corner.normal[1], 0, 1e-14);

  // straight below the corner it is the end's normal, to the last bit
  const Contact below = nearest(punch, Point(8, 9.9));
  EXPECT_NEAR(below.normal[0], 0, 1e-15);

  // inside, the nearest face counts
  EXPECT_NEAR(nearest(punch, Point(7.9, 10.3)).gap, -0.1, 1e-14);
  EXPECT_NEAR(nearest(punch, Point(7.9, 10.3)).normal[0], 1, 1e-14);
  EXPECT_NEAR(nearest(punch, Point(7.5, 10.3)).normal[1], -1, 1e-14);

  std::array<Contact, 2> contacts;
  EXPECT_EQ(punch.find(Point(7.9, 9.9), 1, contacts), 1u); // no second contact at a convex corner
}

TEST(Profile, ConcaveCornerHasTwoContacts)
{
  // A die with a floor z = 0 and a wall r = 8; the workpiece stands in it.
  const Profile die = oriented(
      { Segment::line(Point(0, 0), Point(8, 0)), Segment::line(Point(8, 0), Point(8, 20)) },
      { Point(0, 0.), Point(7, 0.), Point(7, 9), Point(0, 9) });
  std::array<Contact, 2> contacts;

  ASSERT_EQ(die.find(Point(7.8, 0.1), 0.5, contacts), 2u);
  EXPECT_NEAR(contacts[0].gap, 0.1, 1e-14);
  EXPECT_NEAR(contacts[0].normal[1], 1, 1e-14);
  EXPECT_NEAR(contacts[1].gap, 0.2, 1e-14);
  EXPECT_NEAR(contacts[1].normal[0], -1, 1e-14);
  EXPECT_NE(contacts[0].face, contacts[1].face);

  EXPECT_EQ(die.find(Point(7.8, 0.1), 0.15, contacts), 1u); // the wall is out of reach
  EXPECT_EQ(die.find(Point(7, 3), 0.5, contacts), 0u);

  // through the floor, on the wall's prolongation, behind the corner, in it
  ASSERT_EQ(die.find(Point(7.9, -0.05), 0.5, contacts), 2u);
  EXPECT_NEAR(contacts[0].gap, -0.05, 1e-14);
  EXPECT_NEAR(contacts[1].gap, 0.1, 1e-14);
  ASSERT_EQ(die.find(Point(8.1, -0.05), 0.5, contacts), 2u);
  EXPECT_NEAR(contacts[0].gap, -0.1, 1e-14);
  EXPECT_NEAR(contacts[0].normal[0], -1, 1e-14);
  EXPECT_NEAR(contacts[1].gap, -0.05, 1e-14);
  EXPECT_NEAR(contacts[1].normal[1], 1, 1e-14);
  ASSERT_EQ(die.find(Point(8, 0), 0.5, contacts), 2u);
  EXPECT_NEAR(contacts[0].gap, 0, 1e-14);
  EXPECT_NEAR(contacts[1].gap, 0, 1e-14);
  EXPECT_NEAR(contacts[0].normal * contacts[1].normal, 0, 1e-14);
}

TEST(Profile, SecondContactOfAFlankOfManyPieces)
{
  // The same, with the wall cut into short pieces that bend outwards a little: one smooth run.
  std::vector<Segment> segments = { Segment::line(Point(0, 0), Point(8, 0)) };
  const auto           wall     = [](const double z) { return Point(8 + 0.001 * z * z, z); };
  for (unsigned int i = 0; i < 200; ++i)
    segments.push_back(Segment::line(wall(0.1 * i), wall(0.1 * (i + 1))));
  const Profile die = oriented(segments, { Point(0, 0.), Point(7, 0.), Point(7, 9), Point(0, 9) });
  std::array<Contact, 2> contacts;
  ASSERT_EQ(die.find(Point(7.9, 2.), 2.5, contacts), 2u);
  EXPECT_NEAR(contacts[0].gap, 0.104, 1e-4);
  EXPECT_NEAR(contacts[1].gap, 2., 1e-14);
}

TEST(Profile, FreeEndsAndDeepBehind)
{
  const Profile platen = oriented({ Segment::line(Point(0, 10), Point(30, 10)) }, billet(10));
  EXPECT_NEAR(nearest(platen, Point(12, 15)).gap, -5, 1e-14);
  EXPECT_NEAR(nearest(platen, Point(33, 14)).gap, 5, 1e-14); // beyond the end: never inside
  EXPECT_NEAR(nearest(platen, Point(33, 10)).gap, 3, 1e-14);
  EXPECT_NEAR(nearest(platen, Point(30, 10)).gap, 0, 1e-14);
  EXPECT_NEAR(nearest(platen, Point(30, 10)).normal[1], -1, 1e-14);
  std::array<Contact, 2> contacts;
  EXPECT_EQ(platen.find(Point(12, 400), 0.1, contacts), 1u); // penetrating points at any depth
  EXPECT_EQ(platen.find(Point(12, 9), 0.1, contacts), 0u);
}

TEST(Profile, EndOnTheAxisIsNoFreeEnd)
{
  // A conical cavity, deepest on the axis, and a cone that points down.
  const Profile cavity =
      oriented({ Segment::line(Point(0, 5), Point(10, 0)) }, { Point(0, 0), Point(5, 0) });
  const double cosine = 2 / std::sqrt(5.);
  EXPECT_NEAR(nearest(cavity, Point(0, 6)).gap, -cosine, 1e-14);
  EXPECT_NEAR(nearest(cavity, Point(0, 4)).gap, cosine, 1e-14);

  const Profile cone =
      oriented({ Segment::line(Point(0, 0), Point(10, 5)) }, { Point(0, -1), Point(5, -1) });
  EXPECT_NEAR(nearest(cone, Point(0, -1)).gap, 1, 1e-14);
  EXPECT_NEAR(nearest(cone, Point(0, -1)).normal[1], -1, 1e-14);
  EXPECT_NEAR(nearest(cone, Point(0, 1)).gap, -cosine, 1e-14);
}

TEST(Profile, ReachChangesWhatIsFoundAndNothingElse)
{
  const std::vector<Profile> profiles = {
    oriented(rounded_punch(), billet(9)),
    oriented(wavy_die(), { Point(1, 9), Point(6, 9), Point(12, 9) }),
    oriented({ Segment::arc(Point(15, 5), Point(15, 5), Point(12, 5), true) },
             { Point(0, 0), Point(5, 9) }),
    oriented({ Segment::arc(Point(15, 5), Point(15, 5), Point(12, 5), true) },
             { Point(12, 4), Point(13, 5) })
  };
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> r(0, 40), z(-40, 40);
  for (const Profile &profile : profiles)
    for (unsigned int i = 0; i < 2000; ++i)
      {
        const Point            x(r(random), z(random));
        std::array<Contact, 2> near;
        const Contact          contact = nearest(profile, x);
        const unsigned int     n       = profile.find(x, 1.5, near);
        EXPECT_EQ(n > 0, contact.gap <= 1.5) << x;
        if (n > 0)
          {
            EXPECT_EQ(near[0].gap, contact.gap);
          }
      }
}

TEST(Profile, OrderAndDirectionOfTheSegmentsDoNotMatter)
{
  const std::vector<Segment> given     = wavy_die();
  const std::vector<Segment> shuffled  = { given[2].reversed(), given[0].reversed(), given[1] };
  const std::vector<Point>   workpiece = { Point(1, 9), Point(6, 9), Point(12, 9) };
  const Profile              a = oriented(given, workpiece), b = oriented(shuffled, workpiece);
  ASSERT_EQ(a.n_chains(), 1u);
  ASSERT_EQ(b.n_chains(), 1u);
  std::mt19937                           random(5);
  std::uniform_real_distribution<double> r(0, 20), z(-5, 9);
  for (unsigned int i = 0; i < 500; ++i)
    {
      const Point   x(r(random), z(random));
      const Contact p = nearest(a, x), q = nearest(b, x);
      EXPECT_NEAR(p.gap, q.gap, 1e-12);
      EXPECT_NEAR((p.normal - q.normal).norm(), 0, 1e-7);
      EXPECT_NEAR(p.arc_length, q.arc_length, 1e-7);
      EXPECT_EQ(p.face, q.face);
    }
}

TEST(Profile, MirroredToolGivesMirroredAnswers)
{
  std::vector<Segment> upper = rounded_punch(), lower;
  const auto           m     = [](const Point &x) { return Point(x[0], -x[1]); };
  lower.push_back(Segment::line(m(upper[0].begin()), m(upper[0].end())));
  lower.push_back(Segment::arc(m(upper[1].begin()), m(upper[1].end()), Point(8, -12), false));
  lower.push_back(Segment::line(m(upper[2].begin()), m(upper[2].end())));
  std::vector<Point> mirrored_billet;
  for (const Point &x : billet(9))
    mirrored_billet.push_back(m(x));
  const Profile a = oriented(upper, billet(9)), b = oriented(lower, mirrored_billet);
  for (double r = 0; r < 15; r += 0.7)
    for (double z = 5.05; z < 20; z += 0.7) // none level with a joint, where the curvature jumps
      {
        const Contact p = nearest(a, Point(r, z)), q = nearest(b, Point(r, -z));
        EXPECT_NEAR(p.gap, q.gap, 1e-13);
        EXPECT_NEAR(p.normal[0], q.normal[0], 1e-13);
        EXPECT_NEAR(p.normal[1], -q.normal[1], 1e-13);
        EXPECT_NEAR(p.curvature, q.curvature, 1e-13);
      }
}

TEST(Profile, ClosedChainsTakeTheWorkpiecesSide)
{
  const Segment circle = Segment::arc(Point(15, 5), Point(15, 5), Point(12, 5), true);
  const Profile solid =
      oriented({ circle }, { Point(0, 0), Point(9, 5), Point(8, 0) }); // it touches
  EXPECT_NEAR(nearest(solid, Point(12, 5)).gap, -3, 1e-14);
  EXPECT_NEAR(nearest(solid, Point(12, 9)).gap, 1, 1e-14);
  EXPECT_NEAR(nearest(solid, Point(12, 9)).curvature, 1. / 3, 1e-14);
  const Profile hollow = oriented({ circle }, { Point(12, 5), Point(15, 5), Point(13, 6) });
  EXPECT_NEAR(nearest(hollow, Point(12, 5.5)).gap, 2.5, 1e-14);
  EXPECT_NEAR(nearest(hollow, Point(12, 9)).gap, -1, 1e-14);
  EXPECT_NEAR(nearest(hollow, Point(12, 5.5)).curvature, -1. / 3, 1e-14);

  // touching points and one that is inside a little do not turn a platen over
  std::vector<Point> workpiece;
  for (unsigned int i = 0; i <= 20; ++i)
    workpiece.emplace_back(i, 10.);
  workpiece.emplace_back(10, 10.001);
  workpiece.emplace_back(0, 0);
  workpiece.emplace_back(20, 0);
  const Profile platen = oriented({ Segment::line(Point(50, 10), Point(0, 10)) }, workpiece);
  EXPECT_NEAR(nearest(platen, Point(3, 4)).gap, 6, 1e-14);
  const auto worst = platen.worst_penetration(workpiece);
  EXPECT_NEAR(worst.gap, -0.001, 1e-13);
  EXPECT_NEAR(worst.place[0], 10, 1e-13);
}

TEST(Profile, TwoChainsOfOneTool)
{
  // A floor and, not joined to it, a wall.
  const Profile tool = oriented(
      { Segment::line(Point(0, 0), Point(9, 0)), Segment::line(Point(8, -3), Point(8, 20)) },
      { Point(0, 0.), Point(7, 0.), Point(7, 9), Point(0, 9) });
  std::array<Contact, 2> contacts;
  EXPECT_EQ(tool.n_chains(), 2u);
  ASSERT_EQ(tool.find(Point(7.9, 0.05), 0.5, contacts), 2u);
  EXPECT_NEAR(contacts[0].gap, 0.05, 1e-14);
  EXPECT_NEAR(contacts[1].gap, 0.1, 1e-14);
  EXPECT_EQ(tool.find(Point(3, 0.05), 0.5, contacts), 1u);
}

TEST(Profile, FaultyOutlines)
{
  EXPECT_THROW(Profile({}, "upper"), InputError);
  try
    {
      Profile profile({ Segment::line(Point(0, 0), Point(5, 0)),
                        Segment::line(Point(5, 0), Point(9, 0)),
                        Segment::line(Point(5, 0), Point(5, 4)) },
                      "upper");
      FAIL();
    }
  catch (const InputError &error)
    {
      const std::string text = error.what();
      EXPECT_NE(text.find("upper"), std::string::npos) << text;
      EXPECT_NE(text.find("r = 5"), std::string::npos) << text;
    }
  Profile platen({ Segment::line(Point(0, 10), Point(30, 10)) });
  EXPECT_THROW(platen.orient({ Point(0, 10), Point(5, 10) }), InputError); // nothing to go by
}

TEST(Profile, SampleStaysWithinTheTolerance)
{
  const Profile punch     = oriented(rounded_punch(), billet(9));
  const auto    polylines = punch.sample(1e-3);
  ASSERT_EQ(polylines.size(), 1u);
  for (std::size_t i = 1; i < polylines[0].size(); ++i)
    EXPECT_LT(std::abs(nearest(punch, Point((polylines[0][i - 1] + polylines[0][i]) / 2.)).gap),
              1.001e-3);
  EXPECT_LT(polylines[0].size(), 40u);
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
