#include "Transforms/Domains/FeatureLine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"

namespace crease {
namespace {

using ::testing::AllOf;
using testing::closed_line;
using ::testing::HasSubstr;
using testing::open_line;
using ::testing::ThrowsMessage;

const Polyline kSquare = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
const Polyline kInner = {{4, 4}, {6, 4}, {6, 6}, {4, 6}};

}  // namespace

TEST(FeatureLine, BodyOfAClosedLineIsInsideUnlessToldOtherwise) {
  EXPECT_EQ(body_side(closed_line(kSquare)), BodySide::kLeft);
  EXPECT_EQ(body_side(closed_line({kSquare.rbegin(), kSquare.rend()})), BodySide::kRight);
  EXPECT_EQ(body_side(closed_line(kSquare, BodySide::kRight)), BodySide::kRight);
  EXPECT_EQ(body_side(closed_line(kSquare, BodySide::kNone)), BodySide::kNone);
  FeatureLine open;
  open.points = kSquare;
  EXPECT_EQ(body_side(open), BodySide::kNone);
}

TEST(FeatureLine, ReversingSwapsSidesAndKeepsKindsWithTheirEdges) {
  FeatureLine line = closed_line(kSquare, BodySide::kLeft);
  line.left_label = 7;
  line.edge_kinds = {FeatureKind::kCrease, FeatureKind::kSlide, FeatureKind::kSlit,
                     FeatureKind::kCrease};
  const FeatureLine back = reversed(line);
  EXPECT_EQ(back.body, BodySide::kRight);
  EXPECT_EQ(back.right_label, 7);
  // The edge from (10,0) to (10,10) slides in both.
  for (int e = 0; e < 4; ++e) {
    const Point<2> middle = 0.5 * (back.points[e] + back.points[(e + 1) % 4]);
    EXPECT_EQ(back.edge_kind(e) == FeatureKind::kSlide, middle == Point<2>(10, 5));
  }
}

TEST(FeatureLine, BadLinesAreNamed) {
  FeatureLine line = open_line({{1, 2}});
  EXPECT_THAT(
      [&] { check_feature_lines({line}); },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("feature line 1"), HasSubstr("1 point(s)"))));
  line.points = {{0, 0}, {1, std::numeric_limits<double>::quiet_NaN()}};
  line.name = "rib";
  EXPECT_THAT(
      [&] {
        check_feature_lines({closed_line(kSquare), line});
      },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("feature line 2 (rib)"), HasSubstr("point 2"))));
  EXPECT_THAT(
      [&] {
        check_feature_lines({closed_line({{0, 0}, {1, 1}})});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("at least three")));
}

TEST(FeatureLine, SlitAndSlideAreRefusedForNow) {
  FeatureLine line = open_line({{0, 0}, {1, 0}, {2, 0}});
  line.kind = FeatureKind::kSlide;
  EXPECT_THAT([&] { check_kinds_available({line}); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("slide lines are not available"), HasSubstr("use crease"))));
  line.kind = FeatureKind::kCrease;
  line.edge_kinds = {FeatureKind::kCrease, FeatureKind::kSlit};
  EXPECT_THAT([&] { check_kinds_available({line}); },
              ThrowsMessage<InvalidInput>(HasSubstr("slit lines are not available")));
}

TEST(FeatureLine, LabelsFillTheGaps) {
  FeatureLine labelled = closed_line(kSquare);
  labelled.left_label = 3;
  const auto lines = with_body_labels(
      {labelled, closed_line(kInner), closed_line(kInner, BodySide::kNone),
       closed_line({kInner.rbegin(), kInner.rend()}), open_line({{0, 0}, {1, 0}})});
  EXPECT_EQ(lines[0].left_label, 3);
  EXPECT_EQ(lines[1].left_label, 4);
  EXPECT_EQ(lines[2].left_label + lines[2].right_label, 0);
  EXPECT_EQ(lines[3].right_label, 5);
  EXPECT_EQ(lines[4].left_label + lines[4].right_label, 0);
}

TEST(BodyRegions, HolesAndOutsidesFollowTheLabels) {
  FeatureLine outer = closed_line(kSquare), hole = closed_line(kInner, BodySide::kRight);
  outer.left_label = 2;
  hole.right_label = 2;
  const BodyRegions ring({outer, hole});
  EXPECT_EQ(ring.label_at({1, 1}), 2);
  EXPECT_EQ(ring.label_at({5, 5}), 0);
  EXPECT_EQ(ring.label_at({11, 5}), 0);
  const BodyRegions everywhere_else({hole});
  EXPECT_EQ(everywhere_else.label_at({5, 5}), 0);
  EXPECT_EQ(everywhere_else.label_at({1, 1}), 2);
}

TEST(BodyRegions, ArcsOfTwoBodiesCloseEachOthersRings) {
  FeatureLine left = open_line({{5, 10}, {0, 10}, {0, 0}, {5, 0}}, BodySide::kLeft);
  FeatureLine right = open_line({{5, 0}, {10, 0}, {10, 10}, {5, 10}}, BodySide::kLeft);
  FeatureLine shared = open_line({{5, 0}, {5, 10}});
  left.left_label = 1;
  right.left_label = 2;
  shared.left_label = 1;
  shared.right_label = 2;
  const BodyRegions regions({left, right, shared});
  EXPECT_EQ(regions.label_at({2, 5}), 1);
  EXPECT_EQ(regions.label_at({8, 5}), 2);
  EXPECT_EQ(regions.label_at({12, 5}), 0);
}

}  // namespace crease
