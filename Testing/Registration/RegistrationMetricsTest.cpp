// Every metric recovers a known motion of images whose intensities differ as it allows.
#include <gtest/gtest.h>

#include "Core/Parallel.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

/// What the other scanner makes of an intensity at a place.
using Scanner = std::function<double(double intensity, const Point<2>& x)>;

struct Case {
  std::string name;
  MetricFactory<2> metric;
  Scanner scanner;
  double largest_error;  // mm, root mean square; the motion's is 3.2
};

double same(double intensity, const Point<2>&) { return intensity; }
double brighter(double intensity, const Point<2>&) { return 40 * intensity - 300; }
double shaded(double intensity, const Point<2>& x) { return intensity * (1 + x[0] / 160); }
double reversed(double intensity, const Point<2>&) { return -intensity; }
double other_kind(double intensity, const Point<2>&) { return std::sin(4 * intensity); }

std::vector<Case> cases() {
  return {{"ssd", ssd<2>(), same, 0.15},
          {"ncc", ncc<2>(), brighter, 0.15},
          {"ncc squared", ncc<2>(true), reversed, 0.15},
          {"lncc", local_ncc<2>(), shaded, 0.4},
          {"lncc, reversed", local_ncc<2>(), reversed, 0.4},
          {"mi", mutual_information<2>(), same, 1},
          {"mi, reversed", mutual_information<2>(), reversed, 1},
          {"mi, other kind", mutual_information<2>(), other_kind, 1},
          {"mi, cubic windows", mutual_information<2>({.fixed_window = FixedWindow::kCubic}),
           other_kind, 1},
          {"nmi, other kind", mutual_information<2>({.kind = InformationKind::kNormalized}),
           other_kind, 1}};
}

RegistrationResult<2> registered(const Phantom& phantom, const Case& what) {
  Image<float, 2> moving = phantom.moving;
  for (std::int64_t k = 0; k < moving.raster().num_samples(); ++k) {
    const auto [i, j] = moving.index(k);
    float& value = moving[{i, j}];
    value = static_cast<float>(what.scanner(value, moving.raster().point({i, j})));
  }
  Registration<2> registration(phantom.fixed, moving);
  const auto basis = testing::tensor_over<2>(phantom.fixed.raster().bounds(), 8, 3);
  registration.basis(basis)
      .initial({})
      .metric(what.metric)
      .energy("bending", default_bending_weight(*basis), bending<2>())
      .schedule({.adapt_weights = true});
  return registration.run();
}

}  // namespace

TEST(RegistrationMetrics, RecoverMotionsOfWhatTheyAllow) {
  const Phantom phantom = make_phantom("blobs", {.size = 128, .noise = 0.005});
  for (const Case& what : cases()) {
    const auto result = registered(phantom, what);
    EXPECT_TRUE(result.improved) << what.name;
    EXPECT_TRUE(result.converged) << what.name;
    const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
    EXPECT_LT(testing::rms_difference(phantom.fixed.raster(), found, phantom.truth, 12),
              what.largest_error)
        << what.name;
  }
}

TEST(RegistrationMetrics, HaveTheSameBytesOnAnyNumberOfThreads) {
  const Phantom phantom = make_phantom("blobs", {.size = 96});
  for (const Case& what : cases()) {
    set_num_threads(1);
    const Eigen::VectorXd one = registered(phantom, what).transform->parameters();
    for (int threads : {2, 8}) {
      set_num_threads(threads);
      EXPECT_EQ(one, registered(phantom, what).transform->parameters()) << what.name;
    }
  }
  set_num_threads(0);
}

// Volumes whose intensities are of another kind: a rigid search, and a spline.
TEST(RegistrationMetrics, WorkInSpace) {
  const auto raster = testing::raster_of<3>(40);
  const AffineMap<3> truth =
      testing::about_centre<3>(raster, Matrix<3>::Identity(), Vector<3>(1.3, -0.9, 0.6));
  Image<float, 3> moving = testing::scene_image<3>(raster);
  for (float& v : moving.values()) v = std::cos(2 * v);
  for (const auto& metric : {mutual_information<3>(), local_ncc<3>(3)}) {
    Registration<3> registration(testing::image_of<3>(raster, truth), moving);
    const auto basis = testing::tensor_over<3>(raster.bounds(), 3, 3);
    registration.basis(basis).initial({}).metric(metric).energy(
        "bending", default_bending_weight(*basis), bending<3>());
    const auto result = registration.run();
    const auto found = [&](const Point<3>& x) { return result.transform->map(x); };
    EXPECT_LT(testing::rms_difference(raster, found, truth, 6), 0.4);
  }
}

TEST(RegistrationMetrics, SearchRigidMapsOfImagesOfOtherKinds) {
  const Phantom phantom = make_phantom("blobs", {.size = 128, .noise = 0});
  const auto raster = phantom.fixed.raster();
  const double c = std::cos(0.2), s = std::sin(0.2);
  Matrix<2> turn;
  turn << c, -s, s, c;
  const AffineMap<2> truth = testing::about_centre<2>(raster, turn, Vector<2>(3, -4));
  const auto interpolator = make_interpolator(phantom.fixed);
  Image<float, 2> fixed(raster), moving = phantom.fixed;
  for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
    const auto [i, j] = fixed.index(k);
    fixed[{i, j}] = static_cast<float>(interpolator->evaluate(truth(raster.point({i, j}))).value);
  }
  for (float& v : moving.values()) v = std::sin(4 * v);
  const auto found =
      align<2>(fixed, moving, nullptr, nullptr, {},
               {.start = AlignmentStart::kIdentity, .search = AlignmentSearch::kRigid}, {},
               std::nullopt, mutual_information<2>());
  EXPECT_LT(testing::rms_difference(
                raster, [&](const Point<2>& x) { return found.map(x); }, truth, 12),
            0.2);
}

}  // namespace crease
