// What `crease elastic` says about pairs and mammograms that look wrong, and about what it makes of them.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "Registration/Landmarks.h"
#include "Testing/Applications/ElasticFixture.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::read_result;
using testing::run_crease;

std::vector<std::string> warnings_of(const nlohmann::json& result) {
  return result["warnings"].get<std::vector<std::string>>();
}

class ElasticPairsCommand : public testing::ElasticFixture {};

/// Five pairs that move by (1, 0).
constexpr const char* kShift = "10,10,11,10\n50,10,51,10\n10,50,11,50\n50,50,51,50\n30,30,31,30\n";

TEST_F(ElasticPairsCommand, PairsJustOutsideAreMovedOntoTheBorder) {
  const auto result = registered(
      {"--no-refine", "--pairs", pairs(std::string(kShift) + "65,30,62,30\n60,40,65,40\n")});
  EXPECT_THAT(warnings_of(result),
              AllOf(Contains(AllOf(HasSubstr("pair 6"), HasSubstr("1.50 mm outside"),
                                   HasSubstr("moved onto its border"))),
                    Contains(AllOf(HasSubstr("pair 7"), HasSubstr("1.50 mm outside"),
                                   HasSubstr("moved onto its border")))));
}

TEST_F(ElasticPairsCommand, PairsFartherOutsideAreRefusedInEitherImage) {
  expect_refused(run({"--pairs", pairs(std::string(kShift) + "70,30,60,30\n")}), 3,
                 {"pair 6", "fixed point", "6.5 mm outside", "move or delete"});
  expect_refused(run({"--pairs", pairs(std::string(kShift) + "60,30,70,30\n")}), 3,
                 {"pair 6", "moving point", "6.50 mm outside", "correct it or leave"});
}

// Two neighbours on the border have changed places.
TEST_F(ElasticPairsCommand, CrossingPairsAreNamed) {
  expect_refused(run({"--pairs", pairs("0,10,0,10\n0,30,0,50\n0,50,0,30\n63,10,63,10\n"
                                       "63,50,63,50\n30,63,30,63\n")}),
                 3, {"contour pairs 6, 3 and 2 turn back", "exchanged", "fold", "delete"});
  expect_refused(run({"--pairs", pairs("0,10,0,10\n5,0,40,0\n40,0,5,0\n63,10,63,10\n"
                                       "63,50,63,50\n0,50,0,50\n")}),
                 3, {"cross in the moving image", "pair 1 to 2", "pair 3 to 4"});
}

// Two pairs so close and so different that they are held against each other.
TEST_F(ElasticPairsCommand, PairsHeldByLargeReactionsAreSuspected) {
  std::string rows;
  for (int j = 6; j <= 57; j += 10) {
    for (int i = 6; i <= 57; i += 10) {
      rows += message(i, ',', j, ',', i + 0.05 * (i % 3), ',', j + 0.05 * (j % 4), '\n');
    }
  }
  const std::string wrong = "33,33,34.2,32.4\n";  // pair 37
  const auto result = registered({"--no-refine", "--pairs", pairs(rows + wrong)});
  EXPECT_THAT(warnings_of(result),
              Contains(AllOf(HasSubstr("pair 37 is held by"),
                             HasSubstr("times the median reaction"), HasSubstr("may be wrong"))));
  EXPECT_THAT(warnings_of(registered({"--no-refine", "--pairs", pairs(rows)})),
              Not(Contains(HasSubstr("median reaction"))));
}

TEST_F(ElasticPairsCommand, PairsUnlikeTheirNeighboursAreSuspected) {
  const auto result =
      registered({"--no-refine", "--steps", "adaptive", "--material", "neo-hookean", "--pairs",
                  pairs(std::string(kShift) + "40,20,61,20\n")});  // 20 mm of 64
  EXPECT_THAT(warnings_of(result), Contains(AllOf(HasSubstr("pair 6 at (40.00, 20.00) mm"),
                                                  HasSubstr("20.00 mm unlike its neighbours"))));
}

// Too many pairs in one triangle: the answer names what this command has.
TEST_F(ElasticPairsCommand, ContradictionsAreToldInItsOwnWords) {
  std::string rows = kShift;
  for (int n = 0; n < 60; ++n) {
    const int x = 20 + n % 8, y = 20 + n / 8;
    rows += message(x, ',', y, ',', x + 0.3 * (n * 7 % 5), ',', y + 0.3 * (n * 3 % 4), '\n');
  }
  const auto refused = run({"--pairs", pairs(rows)});
  expect_refused(refused, 3, {"pairs contradict each other", "--mesh-size"});
  EXPECT_THAT(refused.err, Not(HasSubstr("landmark")));
}

// A slender column pressed by a tenth in one step: straight, where it would rather buckle.
TEST_F(ElasticPairsCommand, UnstableStatesAreFlagged) {
  const std::string roi =
      folder.write("column.csv", "ring,x,y\n0,20,0\n0,27,0\n0,27,60\n0,20,60\n");
  const auto pressed = [&](double by, const char* corrector) {
    std::string rows;
    for (const double y : {0.0, 60.0}) {
      for (const double x : {20.0, 23.5, 27.0}) {
        rows += message(x, ',', y, ',', x, ',', y * (1 - by), '\n');
      }
    }
    return run({"--no-refine", "--roi", roi, "--pairs", pairs(rows), "--poisson", "0", "--steps",
                "1", "--corrector", corrector});
  };
  const auto straight = pressed(0.1, "none");
  const auto result = result_of(straight);
  EXPECT_EQ(result["unstable_equilibrium"], true);
  EXPECT_THAT(warnings_of(result), Contains(HasSubstr("unstable equilibrium at load fraction 1")));
  EXPECT_THAT(straight.out, HasSubstr("unstable"));
  const auto less = pressed(0.01, "newton");
  EXPECT_EQ(result_of(less)["unstable_equilibrium"], false);
  EXPECT_THAT(less.out, Not(HasSubstr("unstable")));
}

TEST_F(ElasticPairsCommand, CheapQuadratureTellsItsError) {
  const auto exact = registered({"--no-refine"});
  EXPECT_EQ(exact["quadrature"]["rule"], "cells");
  EXPECT_TRUE(exact["quadrature"]["relative_error"].is_null());
  const auto cheap = run({"--no-refine", "--quadrature", "cheap"});
  const auto result = result_of(cheap);
  EXPECT_EQ(result["quadrature"]["rule"], "cheap");
  EXPECT_GT(result["quadrature"]["relative_error"], 1e-4);
  EXPECT_LT(result["quadrature"]["relative_error"], 0.1);
  EXPECT_THAT(cheap.out, HasSubstr("12 points per triangle, stiffness off by"));
  EXPECT_NEAR(result["improvement_percent"]["pairs"], exact["improvement_percent"]["pairs"], 2);
}

/// Small mammograms.
class ElasticMammograms : public testing::CommandFixture {
 protected:
  ElasticMammograms() : CommandFixture("elastic") {}

  std::string in(const char* name) const { return (folder / name).string(); }

  void draw(const std::string& view, const char* pair = "--temporal",
            const char* seed = "3") const {
    ASSERT_EQ(run_crease({"phantom", "mammogram", "--seed", seed, "--size", "256", "--view", view,
                          pair, "--output", folder.path().string(), "--quiet"})
                  .code,
              0);
  }

  testing::CommandResult run(const std::vector<std::string>& extra = {}) const {
    std::vector<std::string> arguments = {
        "elastic",     "--fixed",  in("fixed.mha"), "--moving",    in("moving.mha"),
        "--no-refine", "--output", output(),        "--triangles", "200",
        "--steps",     "adaptive", "--quiet"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_crease(arguments);
  }
};

TEST_F(ElasticMammograms, WithoutAMuscleTheBreastIsHomogeneous) {
  draw("cc");
  const auto result = result_of(run());
  EXPECT_THAT(warnings_of(result),
              Contains(AllOf(HasSubstr("no pectoral muscle was found"), HasSubstr("homogeneous"))));
  EXPECT_EQ(result["breast"]["pectoral_muscle"], false);
  EXPECT_TRUE(result["material"]["regions"].empty());
}

// A negative of 8 bits is the same breast as a positive of 12, and is said to have been turned round.
TEST_F(ElasticMammograms, NegativesAndOtherBitDepthsAreBroughtToOneScale) {
  draw("mlo");
  const double once = result_of(run())["improvement_percent"]["pairs"];
  auto moving = read_image<2>(folder / "moving.mha").image;
  for (float& grey : moving.values()) grey = 255 - std::round(grey / 16);
  write_image(folder / "moving.mha", moving, PixelType::kUint8);
  const auto inverted = run();
  const auto result = result_of(inverted);
  EXPECT_THAT(inverted.out, HasSubstr("moving.mha: the image is a negative and was inverted"));
  EXPECT_THAT(inverted.out, HasSubstr("grey values were multiplied by 16"));
  EXPECT_THAT(result["notes"].dump(), HasSubstr("was inverted"));
  // The darkest grey is that of the fixed image now, as it was not before; on two scales it would be 0.
  EXPECT_NEAR(result["improvement_percent"]["pairs"], once, 10);
}

// The other breast is registered as its mirror image; messages have the places of the file.
TEST_F(ElasticMammograms, PairsOutsideAMirroredBreastAreNamedAsGiven) {
  draw("mlo", "--bilateral");
  std::ofstream(in("seen.csv")) << "fixed_x,fixed_y,moving_x,moving_y\n60,100,3,100\n";
  expect_refused(run({"--pairs", in("seen.csv"), "--contour-pairs", "9"}), 3,
                 {"pair 1: the moving point (3.00, 100.00) mm", "outside the moving image's body"});
}

// St. Venant-Kirchhoff tissue cannot follow the pairs of this breast; who asks for it is told so.
TEST_F(ElasticMammograms, ResistFoldingWhereNobodyAskedForALaw) {
  draw("mlo", "--temporal", "2");
  const auto result = result_of(run());
  EXPECT_EQ(result["material"]["law"], "neo-hookean");
  EXPECT_EQ(result["equilibrium"], true);
  EXPECT_GT(result["jacobian"]["min"], 0);
  EXPECT_THAT(warnings_of(result), Contains(HasSubstr("neo-Hookean tissue")));
  const auto insisting = run({"--material", "st-venant-kirchhoff"});
  EXPECT_EQ(insisting.code, 5);
  EXPECT_THAT(insisting.err, HasSubstr("no elastic equilibrium"));
}

// A given pair on one that was found along the skin takes its place.
TEST_F(ElasticMammograms, GivenPairsDisplaceThoseFoundAlongTheSkin) {
  draw("mlo");
  ASSERT_EQ(run().code, 0);
  const auto found = read_landmarks<2>(folder / "out/pairs.csv");
  std::ofstream(in("seen.csv")) << "fixed_x,fixed_y,moving_x,moving_y\n"
                                << found.fixed[4].x() << ',' << found.fixed[4].y() << ','
                                << found.moving[4].x() << ',' << found.moving[4].y() << '\n';
  const auto result = result_of(run({"--contour-pairs", "40", "--pairs", in("seen.csv")}));
  EXPECT_EQ(result["pairs"]["given"], 1);
  EXPECT_GE(result["pairs"]["contour"], 37);  // without it, and an end that the film may have cut
  EXPECT_LE(result["pairs"]["contour"], 39);
  EXPECT_EQ(result["pairs"]["pectoral"], 4);
  EXPECT_THAT(
      warnings_of(result),
      Contains(AllOf(HasSubstr("pair 1 lies"), HasSubstr("(contour 5)"), HasSubstr("left out"))));
}

}  // namespace
}  // namespace crease
