#include "Transforms/Domains/Mesher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/KnotNetCheck.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/LabelOutlines.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {
namespace {

using testing::closed_line;
using ::testing::HasSubstr;
using testing::open_line;
using testing::rectangle;
using ::testing::ThrowsMessage;

/// Every edge of a chain is a mesh edge.
void expect_chains_on_edges(const DomainMesh& domain) {
  const MeshTopology topology(domain.mesh);
  for (const auto& chain : domain.chains) {
    for (int e = 0; e < chain.num_edges(); ++e) {
      const int a = chain.vertices[e], b = chain.vertices[(e + 1) % chain.vertices.size()];
      EXPECT_GE(topology.edge_between(a, b), 0);
    }
  }
}

}  // namespace

TEST(Mesher, FillsTheRegionWithRoundTriangles) {
  const auto region = rectangle(0, 0, 100, 60);
  const auto domain = mesh_domain(region, {}, {.edge_length = 8});
  const auto figures = mesh_figures(domain.mesh);
  EXPECT_NEAR(figures.area, 6000, 1e-8);
  EXPECT_GT(figures.smallest_angle_deg, 20.7);
  EXPECT_NEAR(figures.mean_edge, 8, 1.2);
  EXPECT_TRUE(domain.warnings.empty());
}

TEST(Mesher, HolesStayEmpty) {
  const RegionOfInterest region({{{0, 0}, {50, 0}, {50, 50}, {0, 50}},
                                 testing::regular_polygon({25, 25}, 12, 12),
                                 testing::regular_polygon({25, 25}, 6, 9)});
  const auto domain = mesh_domain(region, {}, {.edge_length = 5});
  const auto figures = mesh_figures(domain.mesh);
  EXPECT_NEAR(figures.area, region.area(), 1e-8);
  EXPECT_GT(figures.smallest_angle_deg, 20.7);
  for (const auto& s : domain.mesh.simplices) {
    EXPECT_TRUE(region.contains(
        (domain.mesh.vertices[s[0]] + domain.mesh.vertices[s[1]] + domain.mesh.vertices[s[2]]) /
        3));
  }
}

TEST(Mesher, BodiesBecomeRegionsWithTheAreaOfTheirPolygons) {
  FeatureLine first = closed_line(testing::regular_polygon({30, 40}, 15, 20));
  first.left_label = 7;
  const FeatureLine second = closed_line({{60, 60}, {60, 20}, {80, 20}, {80, 60}});  // clockwise
  const auto domain = mesh_domain(rectangle(0, 0, 100, 80), {first, second},
                                  {.edge_length = 12, .edge_length_near_lines = 5});
  EXPECT_NEAR(testing::region_area(domain.mesh, 7), signed_area(first.points), 1e-9);
  EXPECT_NEAR(testing::region_area(domain.mesh, 8), 800, 1e-9);
  ASSERT_EQ(domain.chains.size(), 2U);
  for (const auto& chain : domain.chains) {
    EXPECT_TRUE(chain.closed);
    EXPECT_EQ(chain.body, BodySide::kLeft);
  }
  expect_chains_on_edges(domain);
  EXPECT_GT(mesh_figures(domain.mesh).smallest_angle_deg, 20.7);
}

TEST(Mesher, EdgesGrowAwayFromLines) {
  const auto domain =
      mesh_domain(rectangle(0, 0, 200, 200), {open_line({{100, 60}, {100, 140}})},
                  {.edge_length = 40, .edge_length_near_lines = 4, .gradation = 0.4});
  const MeshTopology topology(domain.mesh);
  double far = 0, near = 0;
  int num_far = 0, num_near = 0;
  for (const auto& edge : topology.edges()) {
    const Point<2>& a = domain.mesh.vertices[edge.vertices[0]];
    const Point<2>& b = domain.mesh.vertices[edge.vertices[1]];
    const double distance =
        distance_to_polyline(Polyline{{100, 60}, {100, 140}}, false, 0.5 * (a + b));
    if (distance < 3) near += (a - b).norm(), ++num_near;
    if (distance > 85) far += (a - b).norm(), ++num_far;
  }
  EXPECT_NEAR(near / num_near, 4.5, 1);
  EXPECT_GT(far / num_far, 25);
}

TEST(Mesher, TargetNumberOfTrianglesWithinFivePercent) {
  const FeatureLine line = closed_line(testing::regular_polygon({50, 50}, 20, 200));
  for (int wanted : {130, 600, 5000}) {
    const auto domain = mesh_domain(rectangle(0, 0, 100, 100), {line}, {.num_triangles = wanted});
    EXPECT_NEAR(static_cast<double>(domain.mesh.simplices.size()), wanted, 0.05 * wanted);
  }
}

// Both strands have a point in the very place where they cross.
TEST(Mesher, LineThatCrossesItselfGetsOneVertexThere) {
  const auto domain =
      mesh_domain(rectangle(0, 0, 100, 100), {open_line({{20, 20}, {80, 80}, {80, 20}, {20, 80}})},
                  {.edge_length = 20, .edge_length_near_lines = 5});
  expect_chains_on_edges(domain);
  int there = 0;
  for (const auto& p : domain.mesh.vertices) there += (p - Point<2>(50, 50)).norm() < 1e-9 ? 1 : 0;
  EXPECT_EQ(there, 1);
  EXPECT_GT(mesh_figures(domain.mesh).smallest_angle_deg, 20.7);
}

TEST(Mesher, ClosedLineShorterThanThreeEdgesIsNamed) {
  FeatureLine dot = closed_line(testing::regular_polygon({50, 50}, 0.5, 6));
  dot.name = "dot";
  EXPECT_THAT([&] { mesh_domain(rectangle(0, 0, 100, 100), {dot}, {.edge_length_near_lines = 5}); },
              ThrowsMessage<InvalidInput>(::testing::AllOf(HasSubstr("feature line dot"),
                                                           HasSubstr("shorter than three edges"))));
}

TEST(Mesher, EdgesInDiscsAreAsShortAsAskedFor) {
  const MeshOptions coarse{.edge_length = 20};
  MeshOptions fine = coarse;
  fine.fine_discs = {{.centre = {30, 60}, .radius = 12, .edge_length = 2}};
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100), {}, fine);
  const MeshTopology topology(domain.mesh);
  double sum = 0, count = 0, far = 0;
  for (const auto& edge : topology.edges()) {
    const Point<2>& a = domain.mesh.vertices[edge.vertices[0]];
    const Point<2>& b = domain.mesh.vertices[edge.vertices[1]];
    const double distance = (0.5 * (a + b) - Point<2>(30, 60)).norm();
    if (distance < 12) sum += (a - b).norm(), ++count;
    if (distance > 60) far = std::max(far, (a - b).norm());
  }
  EXPECT_NEAR(sum / count, 2, 0.3);
  EXPECT_GT(far, 15);
  fine.fine_discs[0].edge_length = 0;
  EXPECT_THAT([&] { mesh_domain(rectangle(0, 0, 100, 100), {}, fine); },
              ThrowsMessage<InvalidInput>(HasSubstr("disc")));
}

TEST(Mesher, SizeInsideBodies) {
  const FeatureLine line = closed_line(testing::regular_polygon({50, 50}, 30, 100));
  MeshOptions options{.edge_length = 20, .edge_length_near_lines = 6, .edge_length_in_bodies = 3};
  const auto fine = mesh_domain(rectangle(0, 0, 100, 100), {line}, options);
  options.edge_length_in_bodies = 20;
  const auto coarse = mesh_domain(rectangle(0, 0, 100, 100), {line}, options);
  const auto inside = [](const DomainMesh& domain) {
    return std::count(domain.mesh.regions.begin(), domain.mesh.regions.end(), 1);
  };
  EXPECT_GT(inside(fine), 2.5 * static_cast<double>(inside(coarse)));
}

TEST(Mesher, SameBytesWhateverTheHeapHolds) {
  const FeatureLine line = closed_line(testing::regular_polygon({50, 50}, 20, 24));
  const auto first = mesh_domain(rectangle(0, 0, 100, 100), {line});
  std::vector<std::unique_ptr<char[]>> clutter;
  for (int i = 1; i < 2000; ++i) {
    clutter.push_back(std::make_unique<char[]>(static_cast<std::size_t>(i * 37 % 911 + 1)));
    if (i % 3 == 0) clutter[i / 2].reset();
  }
  const auto second = mesh_domain(rectangle(0, 0, 100, 100), {line});
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
  EXPECT_EQ(first.mesh.simplices, second.mesh.simplices);
  EXPECT_EQ(first.mesh.regions, second.mesh.regions);
  EXPECT_EQ(first.chains[0].vertices, second.chains[0].vertices);
}

TEST(Mesher, OrderDirectionAndStartOfLinesDoNotMatter) {
  const FeatureLine a = closed_line(testing::regular_polygon({30, 50}, 15, 16), BodySide::kLeft);
  const FeatureLine b = open_line({{60, 20}, {70, 50}, {65, 80}}, BodySide::kLeft);
  FeatureLine c = closed_line(testing::regular_polygon({80, 80}, 9, 10), BodySide::kNone);
  const auto first = mesh_domain(rectangle(0, 0, 100, 100), {a, b, c});
  FeatureLine turned = reversed(a);
  std::rotate(turned.points.begin(), turned.points.begin() + 5, turned.points.end());
  const auto second = mesh_domain(rectangle(0, 0, 100, 100), {reversed(c), reversed(b), turned});
  EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
  EXPECT_EQ(first.mesh.simplices, second.mesh.simplices);
  const auto net = place_knots(first).net, other = place_knots(second).net;
  ASSERT_EQ(net.clouds.size(), other.clouds.size());
  for (std::size_t v = 0; v < net.clouds.size(); ++v) {
    for (std::size_t k = 0; k < net.clouds[v].size(); ++k) {
      EXPECT_LT((net.clouds[v][k] - other.clouds[v][k]).norm(), 1e-9);
    }
  }
}

TEST(Mesher, TooManyTrianglesAreRefusedBeforeTheyAreMade) {
  EXPECT_THAT([] { mesh_domain(rectangle(0, 0, 512, 512), {}, {.edge_length = 0.1}); },
              ThrowsMessage<InvalidInput>(
                  ::testing::AllOf(HasSubstr("0.1 mm"), HasSubstr("at most 2000000"))));
  EXPECT_THAT(
      [] {
        mesh_domain(rectangle(0, 0, 512, 512), {open_line({{10, 10}, {500, 500}})},
                    {.edge_length = 40, .edge_length_near_lines = 1e-4});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("0.0001 mm near lines")));
}

TEST(Mesher, BadOptionsAreNamed) {
  const auto region = rectangle(0, 0, 10, 10);
  EXPECT_THROW(mesh_domain(region, {}, {.edge_length = -1}), InvalidInput);
  EXPECT_THROW(mesh_domain(region, {}, {.edge_length = std::nan("")}), InvalidInput);
  EXPECT_THROW(mesh_domain(region, {}, {.gradation = 0}), InvalidInput);
  EXPECT_THROW(mesh_domain(region, {}, {.num_triangles = -4}), InvalidInput);
  FeatureLine slit = open_line({{1, 1}, {5, 5}});
  slit.kind = FeatureKind::kSlit;
  EXPECT_THAT([&] { mesh_domain(region, {slit}); },
              ThrowsMessage<InvalidInput>(HasSubstr("not available yet")));
}

/// Star-shaped regions with notches, a hole, a body and an open line: everything must fit together.
TEST(Mesher, RandomDomainsAreValid) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 25; ++trial) {
    Polyline outer;
    const int corners = 9 + trial % 7;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.6 * uniform(generator)) / corners;
      const double radius = 40 + 40 * uniform(generator);
      outer.push_back({100 + radius * std::cos(angle), 100 + radius * std::sin(angle)});
    }
    const RegionOfInterest region({outer, testing::regular_polygon({112, 96}, 6, 7)});
    const FeatureLine body = closed_line(testing::regular_polygon({84, 104}, 11, 14));
    const FeatureLine open = open_line({{100, 120}, {105 + 5 * uniform(generator), 80}, {100, 72}});
    const FeatureLine across = open_line({{20, 125}, {100, 118}, {180, 130 * uniform(generator)}});
    const auto domain =
        mesh_domain(region, {body, open, across}, {.edge_length = 12, .edge_length_near_lines = 4});
    EXPECT_NEAR(mesh_figures(domain.mesh).area, region.area(), 1e-8);
    EXPECT_NEAR(testing::region_area(domain.mesh, 1), signed_area(body.points),
                0.02 * signed_area(body.points));
    expect_chains_on_edges(domain);
    for (int degree : {2, 3, 4}) {
      const auto placed = place_knots(domain, {.degree = degree});
      EXPECT_NO_THROW(validate(placed.net)) << "trial " << trial << ", degree " << degree;
    }
  }
}

TEST(Mesher, SpineFromLabelsToKnots) {
  const auto raster = testing::square_raster(512);
  const auto labels = testing::label_image(raster, testing::spine_bodies());
  const auto outlines = label_outlines(raster, labels, {.edge_length = 12});
  const auto domain = mesh_domain(rectangle_of(raster), outlines.lines,
                                  {.edge_length = 40, .edge_length_near_lines = 12});
  EXPECT_NEAR(mesh_figures(domain.mesh).area, 512.0 * 512.0, 1e-6);
  EXPECT_GT(mesh_figures(domain.mesh).smallest_angle_deg, 20.7);
  for (int body = 1; body <= 5; ++body) {
    const auto pixels = static_cast<double>(std::count(labels.begin(), labels.end(), body));
    EXPECT_NEAR(testing::region_area(domain.mesh, body), pixels, 0.01 * pixels);
  }
  const auto placed = place_knots(domain);
  EXPECT_NO_THROW(validate(placed.net));
  // Turns below a degree count as straight, which lets the bands reach a hundredth of a mm inside.
  EXPECT_LT(placed.plan.band_area_in_bodies, 0.02 * placed.plan.band_area);
  EXPECT_LT(placed.plan.band_share, 0.01);
  EXPECT_TRUE(placed.plan.warnings.empty());
}

}  // namespace crease
