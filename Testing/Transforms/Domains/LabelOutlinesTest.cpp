#include "Transforms/Domains/LabelOutlines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/CurveSampling.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Disc {
  Point<2> centre;
  double radius = 0;
  double distance(const Point<2>& p) const { return (p - centre).norm() - radius; }
};

template <typename Shape>
double largest_error(const FeatureLine& line, const Shape& shape) {
  double largest = 0;
  for (const auto& p : line.points) largest = std::max(largest, std::abs(shape.distance(p)));
  return largest;
}

/// The points of a line, whatever its direction and start.
bool same_points(const Polyline& a, const Polyline& b, double tolerance) {
  return std::all_of(a.begin(), a.end(), [&](const Point<2>& p) {
    return distance_to_polyline(b, false, p) < tolerance;
  });
}

}  // namespace

TEST(LabelOutlines, DiscsAreFoundToAThirdOfAPixelWithTheirArea) {
  const auto raster = testing::square_raster(140);
  for (const Disc& disc : {Disc{{70.3, 69.6}, 50.2}, Disc{{68.9, 71.2}, 33.7}, Disc{{71, 70}, 20.5},
                           Disc{{70.6, 70.1}, 12.3}}) {
    const auto labels = testing::label_image<Disc>(raster, {disc});
    const auto outlines = label_outlines(raster, labels);
    ASSERT_EQ(outlines.lines.size(), 1U);
    const FeatureLine& line = outlines.lines[0];
    EXPECT_TRUE(line.closed);
    EXPECT_EQ(line.body, BodySide::kLeft);
    EXPECT_EQ(line.left_label, 1);
    EXPECT_LT(largest_error(line, disc), 0.3) << "radius " << disc.radius;
    const auto pixels = static_cast<double>(std::count(labels.begin(), labels.end(), 1));
    EXPECT_NEAR(signed_area(line.points) / pixels, 1, 0.01);  // positive: counter-clockwise
  }
}

TEST(LabelOutlines, TurnedRoundedRectanglesAreFound) {
  const auto raster = testing::square_raster(140);
  for (double angle : {0.3, 0.55, 1.1}) {
    const testing::RoundedRectangle body{{70.2, 69.7}, angle, 45, 27, 8};
    const auto labels = testing::label_image<testing::RoundedRectangle>(raster, {body});
    const auto outlines = label_outlines(raster, labels);
    ASSERT_EQ(outlines.lines.size(), 1U);
    EXPECT_LT(largest_error(outlines.lines[0], body), 0.4);
    EXPECT_NEAR(signed_area(outlines.lines[0].points), body.area(), 0.01 * body.area());
    EXPECT_LT(largest_turn_deg(outlines.lines[0].points, true), 20);  // no stairs left
  }
}

TEST(LabelOutlines, SpacingAndDirectionsMapToMillimetres) {
  Raster<2> raster = testing::square_raster(90);
  raster.spacing = {0.5, 0.8};
  raster.origin = {-10, 4};
  raster.direction << 0, -1, -1, 0;  // mirrored: determinant -1
  const Disc disc{raster.point({45, 44}), 14};
  const auto outlines = label_outlines(raster, testing::label_image<Disc>(raster, {disc}));
  ASSERT_EQ(outlines.lines.size(), 1U);
  EXPECT_GT(signed_area(outlines.lines[0].points), 0);
  EXPECT_LT(largest_error(outlines.lines[0], disc), 0.3 * 0.8);
}

TEST(LabelOutlines, HolesRunClockwiseWithTheBodyOnTheLeft) {
  const auto raster = testing::square_raster(100);
  auto labels = testing::label_image<Disc>(raster, {Disc{{50, 50}, 40}});
  const auto hole = testing::label_image<Disc>(raster, {Disc{{50, 50}, 15}});
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = hole[i] ? 0 : 4 * labels[i];
  const auto outlines = label_outlines(raster, labels);
  ASSERT_EQ(outlines.lines.size(), 2U);
  double sum = 0;
  for (const auto& line : outlines.lines) {
    EXPECT_EQ(line.left_label, 4);
    EXPECT_EQ(line.body, BodySide::kLeft);
    sum += signed_area(line.points);
  }
  EXPECT_NEAR(sum, std::count(labels.begin(), labels.end(), 4), 0.01 * sum);
  const BodyRegions regions(outlines.lines);
  EXPECT_EQ(regions.label_at({50, 50}), 0);
  EXPECT_EQ(regions.label_at({50, 22}), 4);
}

TEST(LabelOutlines, TouchingBodiesShareOneLine) {
  const auto raster = testing::square_raster(100);
  auto labels = testing::label_image<Disc>(raster, {Disc{{50, 50}, 38}});
  for (int j = 0; j < 100; ++j) {
    for (int i = 0; i < 100; ++i) {
      if (labels[j * 100 + i] && i + 0.3 * j > 66) labels[j * 100 + i] = 2;
    }
  }
  const auto outlines = label_outlines(raster, labels);
  ASSERT_EQ(outlines.lines.size(), 3U);
  int shared = 0;
  for (const auto& line : outlines.lines) {
    EXPECT_FALSE(line.closed);
    if (line.left_label > 0 && line.right_label > 0) {
      ++shared;
      EXPECT_EQ(line.body, BodySide::kNone);
    } else {
      EXPECT_EQ(line.body, BodySide::kLeft);
    }
  }
  EXPECT_EQ(shared, 1);
  const BodyRegions regions(outlines.lines);
  EXPECT_EQ(regions.label_at({25, 50}), 1);
  EXPECT_EQ(regions.label_at({75, 50}), 2);
  EXPECT_EQ(regions.label_at({5, 5}), 0);
}

TEST(LabelOutlines, NarrowGapsAreClosedWithAWarning) {
  const auto raster = testing::square_raster(100);
  std::vector<std::int32_t> labels(100 * 100, 0);
  for (int j = 20; j < 80; ++j) {
    for (int i = 10; i < 90; ++i) labels[j * 100 + i] = i < 49 ? 1 : i > 50 ? 2 : 0;
  }
  const auto apart = label_outlines(raster, labels);
  EXPECT_EQ(apart.lines.size(), 2U);
  EXPECT_TRUE(apart.warnings.empty());
  const auto joined = label_outlines(raster, labels, {.edge_length = 12});  // gap 2 <= 3
  EXPECT_EQ(joined.lines.size(), 3U);
  ASSERT_EQ(joined.warnings.size(), 1U);
  EXPECT_THAT(joined.warnings[0], HasSubstr("nearer than 3 mm"));
}

TEST(LabelOutlines, BodiesAtTheImageBorderGoOnOutsideAndAreCutByTheMesher) {
  const auto raster = testing::square_raster(80);
  const double inside = 0.5 * std::numbers::pi * 400;
  for (const Point<2>& centre : {Point<2>(-0.5, 40), {79.5, 40}, {40, -0.5}, {40, 79.5}}) {
    const auto outlines =
        label_outlines(raster, testing::label_image<Disc>(raster, {Disc{centre, 20}}));
    ASSERT_EQ(outlines.lines.size(), 1U);
    EXPECT_TRUE(outlines.lines[0].closed);
    EXPECT_EQ(outlines.lines[0].body, BodySide::kLeft);
    const auto domain = mesh_domain(rectangle_of(raster), outlines.lines,
                                    {.edge_length = 12, .edge_length_near_lines = 5});
    EXPECT_NEAR(testing::region_area(domain.mesh, 1), inside, 0.02 * inside);
    EXPECT_EQ(place_knots(domain).plan.count(VertexRule::kBorderMeeting), 2);
    EXPECT_TRUE(domain.warnings.empty());
  }
}

TEST(LabelOutlines, BodyInTheCornerOfTheImage) {
  const auto raster = testing::square_raster(80);
  const auto labels = testing::label_image<Disc>(raster, {Disc{{79.5, 79.5}, 30}});
  const auto outlines = label_outlines(raster, labels);
  const auto domain = mesh_domain(rectangle_of(raster), outlines.lines,
                                  {.edge_length = 12, .edge_length_near_lines = 5});
  const double inside = 0.25 * std::numbers::pi * 900;
  EXPECT_NEAR(testing::region_area(domain.mesh, 1), inside, 0.02 * inside);
}

TEST(LabelOutlines, BodiesOutsideTheRegionOfInterestAreLeftOut) {
  const auto raster = testing::square_raster(100);
  const auto labels = testing::label_image<Disc>(raster, {Disc{{25, 50}, 12}, Disc{{75, 50}, 12}});
  const auto domain = mesh_domain(testing::rectangle(0, 0, 50, 99),
                                  label_outlines(raster, labels).lines, {.edge_length = 12});
  EXPECT_GT(testing::region_area(domain.mesh, 1), 400);
  EXPECT_EQ(testing::region_area(domain.mesh, 2), 0);
}

TEST(LabelOutlines, TinyBodiesAreLeftOutWithAWarning) {
  const auto raster = testing::square_raster(60);
  auto labels = testing::label_image<Disc>(raster, {Disc{{30, 30}, 12}});
  labels[3 * 60 + 5] = 9;
  labels[10 * 60 + 50] = labels[10 * 60 + 51] = labels[11 * 60 + 50] = labels[11 * 60 + 51] = 5;
  const auto outlines = label_outlines(raster, labels);
  EXPECT_EQ(outlines.lines.size(), 1U);
  ASSERT_EQ(outlines.warnings.size(), 2U);
  EXPECT_THAT(outlines.warnings,
              ::testing::UnorderedElementsAre(HasSubstr("body 9"), HasSubstr("body 5")));
}

TEST(LabelOutlines, SampledOutlinesKeepAreaAndTurnLittle) {
  const auto raster = testing::square_raster(512);
  const auto bodies = testing::spine_bodies();
  const auto outlines = label_outlines(raster, testing::label_image(raster, bodies),
                                       {.edge_length = 12, .sampled = true});
  ASSERT_EQ(outlines.lines.size(), 5U);
  for (const auto& line : outlines.lines) {
    const auto& body = bodies[line.left_label - 1];
    EXPECT_LE(line.points.size(), 30U);
    EXPECT_NEAR(signed_area(line.points), body.area(), 0.01 * body.area());
    EXPECT_LT(largest_error(line, body), 0.7);
    EXPECT_LT(largest_turn_deg(line.points, true), 60);
  }
}

TEST(LabelOutlines, SameLabelsUnderOtherNumbersGiveTheSameLines) {
  const auto raster = testing::square_raster(100);
  const auto labels = testing::label_image<Disc>(raster, {Disc{{30, 30}, 15}, Disc{{70, 60}, 20}});
  auto renamed = labels;
  for (auto& label : renamed) label = label == 1 ? 8 : label == 2 ? 3 : 0;
  const auto first = label_outlines(raster, labels), second = label_outlines(raster, renamed);
  ASSERT_EQ(first.lines.size(), second.lines.size());
  for (const auto& line : first.lines) {
    EXPECT_TRUE(
        std::any_of(second.lines.begin(), second.lines.end(), [&](const FeatureLine& other) {
          return (line.left_label == 1) == (other.left_label == 8) &&
                 same_points(line.points, other.points, 1e-9);
        }));
  }
}

TEST(LabelOutlines, BadLabelImagesAreRefused) {
  const auto raster = testing::square_raster(10);
  std::vector<std::int32_t> labels(100, 0);
  EXPECT_THAT([&] { label_outlines(raster, labels); },
              ThrowsMessage<InvalidInput>(HasSubstr("no body")));
  labels[23] = -1;
  EXPECT_THAT([&] { label_outlines(raster, labels); },
              ThrowsMessage<InvalidInput>(HasSubstr("pixel (3, 2)")));
  labels.resize(50);
  EXPECT_THAT([&] { label_outlines(raster, labels); },
              ThrowsMessage<InvalidInput>(HasSubstr("50 labels")));
}

}  // namespace crease
