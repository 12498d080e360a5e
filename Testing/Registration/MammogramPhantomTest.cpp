// The mammogram phantom's images: what each option changes, and bad options.
#include "Registration/Phantoms/MammogramPhantom.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "Core/Error.h"
#include "Images/MakeInterpolator.h"
#include "Testing/Registration/MammogramPhantoms.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::parameter;
using testing::same_bytes;
using ::testing::ThrowsMessage;

constexpr double kWidthMm = testing::kMammogramFrameMm;

// Undoing the response, the moving image at T(x) is the fixed image at x, as far as cubic interpolation, blur
// after the motion and 16 bits allow.
TEST(MammogramPhantom, MovingImageIsTheMovedBreast) {
  for (const auto view : {MammogramView::kMlo, MammogramView::kCc}) {
    const auto phantom = make_mammogram_phantom(
        {.size = 512, .seed = 3, .view = view, .noise = 0, .bits = 16, .label = false});
    const double gain = parameter(phantom, "gain"), gamma = parameter(phantom, "gamma");
    const auto moving = make_interpolator<2>(phantom.moving.pixels);
    double sum = 0, unregistered = 0;
    int count = 0;
    for (int j = 0; j < 512; j += 3) {
      for (int i = 0; i < 512; i += 3) {
        const Point<2> y = phantom.truth(phantom.fixed.pixels.raster().point(Vector<2>(i, j)));
        if (y.minCoeff() < 1 || y.maxCoeff() > kWidthMm - 1 || !phantom.fixed.mask(i, j)) continue;
        const auto undone = [&](double level) {
          return std::pow(std::max(level / 65535, 0.0) / gain, 1 / gamma);
        };
        const double fixed = phantom.fixed.pixels(i, j) / 65535;
        sum += std::pow(undone(moving->evaluate(y).value) - fixed, 2);
        unregistered += std::pow(undone(phantom.moving.pixels(i, j)) - fixed, 2);
        ++count;
      }
    }
    EXPECT_GT(count, 8000);
    EXPECT_LT(std::sqrt(sum / count), 0.004);
    EXPECT_LT(sum, 0.01 * unregistered);
  }
}

TEST(MammogramPhantom, BitsSayHowFinelyGreysAreTold) {
  std::map<int, MammogramPhantom> by_bits;
  for (const int bits : {8, 12, 16}) {
    by_bits[bits] = make_mammogram_phantom({.size = 128, .bits = bits});
    const auto& values = by_bits[bits].fixed.pixels.values();
    const double largest = *std::max_element(values.begin(), values.end());
    EXPECT_LE(largest, (1 << bits) - 1);
    EXPECT_GT(largest, 0.8 * (1 << bits));  // the label
    EXPECT_TRUE(std::all_of(values.begin(), values.end(),
                            [](float v) { return v >= 0 && v == std::floor(v); }));
  }
  for (const int bits : {8, 12}) {
    const double levels = (1 << bits) - 1;
    for (std::size_t i = 0; i < by_bits[bits].moving.pixels.values().size(); ++i) {
      EXPECT_NEAR(by_bits[bits].moving.pixels.values()[i] / levels,
                  by_bits[16].moving.pixels.values()[i] / 65535, 0.5 / levels + 1e-5);
    }
  }
}

TEST(MammogramPhantom, OnlyObliqueViewsShowThePectoralMuscle) {
  const auto mlo = make_mammogram_phantom({.size = 256, .noise = 0});
  const auto cc = make_mammogram_phantom({.size = 256, .view = MammogramView::kCc, .noise = 0});
  EXPECT_TRUE(cc.fixed.labels.empty() && cc.fixed.pectoral.empty() && cc.moving.pectoral.empty());
  for (const auto* image : {&mlo.fixed, &mlo.moving}) {
    ASSERT_GT(image->pectoral.size(), 30u);
    const auto& line = image->pectoral;
    const Raster<2>& raster = image->labels.raster();
    // Across the line's middle, the muscle lies towards the upper corner of the chest wall.
    const Point<2> middle = line[line.size() / 2];
    const Vector<2> along = (line.back() - line.front()).normalized();
    for (const double side : {-1.0, 1.0}) {
      const Vector<2> index = raster.index(middle + side * 2 * turned_left(along));
      const bool muscle = image->labels(static_cast<int>(std::lround(index.x())),
                                        static_cast<int>(std::lround(index.y()))) == 1;
      EXPECT_EQ(muscle, side * turned_left(along).x() < 0);
    }
    EXPECT_LT(std::abs(line.front().x()), 1);  // the chest wall
    EXPECT_LT(distance_to_polyline(image->outline, false, line.back()), 1);
  }
  const auto difference = [&](int i, int j) {
    return (mlo.fixed.pixels(i, j) - cc.fixed.pixels(i, j)) / 4095;
  };
  EXPECT_NEAR(difference(16, 75), 0.22, 0.001);  // deep in the muscle, where the breast is thick
  EXPECT_EQ(difference(70, 130), 0);
}

TEST(MammogramPhantom, OtherBreastIsMirrored) {
  const auto phantom = make_mammogram_phantom({.size = 256, .pair = MammogramPairKind::kBilateral});
  const auto column_sum = [](const Mask<2>& mask, int i) {
    int sum = 0;
    for (int j = 0; j < 256; ++j) sum += mask(i, j);
    return sum;
  };
  EXPECT_GT(column_sum(phantom.fixed.mask, 2), 150);
  EXPECT_EQ(column_sum(phantom.fixed.mask, 253), 0);
  EXPECT_GT(column_sum(phantom.moving.mask, 253), 150);
  EXPECT_EQ(column_sum(phantom.moving.mask, 2), 0);
  EXPECT_GT(phantom.fixed.nipple.x(), 100);
  EXPECT_LT(phantom.moving.nipple.x(), 104);
  EXPECT_GT(phantom.fixed.pixels(230, 17), 3000);  // the labels
  EXPECT_GT(phantom.moving.pixels(25, 17), 3000);
}

TEST(MammogramPhantom, MassIsInOneImageOnly) {
  MammogramPhantomOptions options = {.size = 256, .seed = 2, .noise = 0};
  const auto without = make_mammogram_phantom(options);
  options.mass = MammogramMassPlace::kFixed;
  const auto in_fixed = make_mammogram_phantom(options);
  options.mass = MammogramMassPlace::kMoving;
  const auto in_moving = make_mammogram_phantom(options);
  EXPECT_TRUE(same_bytes(in_fixed.moving, without.moving));
  EXPECT_TRUE(same_bytes(in_moving.fixed, without.fixed));
  const auto check = [&](const MammogramPhantom& with, const Image<float, 2>& image,
                         const Image<float, 2>& plain, const std::string& name) {
    const double radius = parameter(with, "mass_radius_mm");
    EXPECT_GE(radius, 4);
    EXPECT_LE(radius, 12);
    const Point<2> center(parameter(with, "mass_" + name + "_x_mm"),
                          parameter(with, "mass_" + name + "_y_mm"));
    double largest = 0;
    Point<2> where = Point<2>::Zero();
    for (int j = 0; j < 256; ++j) {
      for (int i = 0; i < 256; ++i) {
        const double more = (image(i, j) - plain(i, j)) / 4095;
        const Point<2> x = image.raster().point(Vector<2>(i, j));
        if (more > largest) {
          largest = more;
          where = x;
        }
        if ((x - center).norm() > 3 * radius) EXPECT_LT(more, 0.001);
      }
    }
    EXPECT_NEAR(largest, 0.15, 0.03);
    EXPECT_LT((where - center).norm(), 2);
  };
  check(in_fixed, in_fixed.fixed.pixels, without.fixed.pixels, "fixed");
  check(in_moving, in_moving.moving.pixels, without.moving.pixels, "moving");
}

TEST(MammogramPhantom, LabelStaysAwayFromTheBreast) {
  for (const auto pair : {MammogramPairKind::kTemporal, MammogramPairKind::kBilateral}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const MammogramPhantomOptions with = {.size = 128, .seed = seed, .pair = pair, .noise = 0};
      auto without = with;
      without.label = false;
      const auto a = make_mammogram_phantom(with), b = make_mammogram_phantom(without);
      for (const auto& [labelled, plain] :
           {std::pair(&a.fixed, &b.fixed), {&a.moving, &b.moving}}) {
        int pixels = 0;
        for (int j = 0; j < 128; ++j) {
          for (int i = 0; i < 128; ++i) {
            if (labelled->pixels(i, j) == plain->pixels(i, j)) continue;
            ++pixels;
            const Point<2> x = labelled->pixels.raster().point(Vector<2>(i, j));
            EXPECT_GT(distance_to_polyline(labelled->outline, false, x), 20);
          }
        }
        EXPECT_GT(pixels, 100);
      }
    }
  }
}

TEST(MammogramPhantom, NoiseHasItsDeviationAndIsIndependent) {
  MammogramPhantomOptions options = {.size = 256, .seed = 1, .noise = 0, .bits = 16};
  const auto clean = make_mammogram_phantom(options);
  options.noise = 0.005;
  const auto noisy = make_mammogram_phantom(options);
  double fixed = 0, moving = 0, both = 0;
  int n = 0;
  for (std::size_t i = 0; i < clean.fixed.pixels.values().size(); ++i) {
    if (!clean.fixed.mask.values()[i]) continue;
    const double f = (noisy.fixed.pixels.values()[i] - clean.fixed.pixels.values()[i]) / 65535;
    const double m = (noisy.moving.pixels.values()[i] - clean.moving.pixels.values()[i]) / 65535;
    fixed += f * f;
    moving += m * m;
    both += f * m;
    ++n;
  }
  EXPECT_NEAR(std::sqrt(fixed / n), 0.005, 0.0001);  // 4 standard errors of 23000 samples
  EXPECT_NEAR(std::sqrt(moving / n), 0.005, 0.0001);
  EXPECT_LT(std::abs(both / n), 0.005 * 0.005 * 0.03);
}

TEST(MammogramPhantom, DensityBrightensTheGland) {
  double last = 0;
  for (const double density : {0.0, 0.5, 1.0}) {
    const auto phantom = make_mammogram_phantom(
        {.size = 128, .view = MammogramView::kCc, .density = density, .noise = 0});
    double sum = 0;
    for (int j = 60; j < 75; ++j) {
      for (int i = 28; i < 43; ++i) sum += phantom.fixed.pixels(i, j) / 4095 / 225;
    }
    EXPECT_GT(sum, last + 0.04);
    last = sum;
  }
}

TEST(MammogramPhantom, FurtherMapIsAdded) {
  AffineMap<2> shear;
  shear.linear << 1.02, 0.03, -0.01, 0.99;
  shear.offset = {1.5, -2};
  MammogramPhantomOptions options = {.size = 128, .seed = 4};
  const auto plain = make_mammogram_phantom(options);
  options.further = std::make_shared<AffineTransform<2>>(shear);
  const auto further = make_mammogram_phantom(options);
  for (const Point<2>& x : {Point<2>(20, 100), Point<2>(70, 60), Point<2>(3, 180)}) {
    EXPECT_LT((further.truth(x) - plain.truth(x) - (shear(x) - x)).norm(), 1e-11);
    EXPECT_LT((further.inverse(further.truth(x)) - x).norm(), 1e-10);
  }
  EXPECT_FALSE(same_bytes(further.moving.pixels, plain.moving.pixels));
}

// A further map that leaves little room: determinant 0.49 by itself.
TEST(MammogramPhantom, MotionIsHalvedUntilTissueIsNotSqueezed) {
  AffineMap<2> squeeze;
  squeeze.linear *= 0.7;
  squeeze.offset = {20, 30};
  MammogramPhantomOptions options = {.size = 128, .seed = 4};
  const auto plain = make_mammogram_phantom(options);
  options.further = std::make_shared<AffineTransform<2>>(squeeze);
  const auto squeezed = make_mammogram_phantom(options);
  EXPECT_GT(parameter(squeezed, "determinant_min"), 0.4);
  const double factor = parameter(squeezed, "rotation_deg") / parameter(plain, "rotation_deg");
  EXPECT_LE(factor, 0.5);
  EXPECT_EQ(std::log2(factor), std::round(std::log2(factor)));
  for (const char* name : {"shear", "stretch_x", "wave_x1_amplitude_mm", "wave_y2_amplitude_mm"}) {
    EXPECT_NEAR(parameter(squeezed, name), factor * parameter(plain, name), 1e-12) << name;
  }
}

TEST(MammogramPhantom, RefusesBadOptions) {
  const auto refused = [](const MammogramPhantomOptions& options, const std::string& text) {
    EXPECT_THAT([&] { make_mammogram_phantom(options); },
                ThrowsMessage<InvalidInput>(HasSubstr(text)));
  };
  refused({.size = 64}, "size 64 is not in 128 .. 4096");
  refused({.density = 1.5}, "density 1.5");
  refused({.density = std::nan("")}, "density nan");
  refused({.noise = -0.1}, "noise -0.1");
  refused({.bits = 10}, "choose 8, 12 or 16");
  AffineMap<2> squeeze;
  squeeze.linear *= 0.5;  // determinant 0.25
  refused({.size = 128, .further = std::make_shared<AffineTransform<2>>(squeeze)},
          "make it milder");
  refused({.size = 128, .elastic = true, .further = std::make_shared<AffineTransform<2>>(squeeze)},
          "leave out the further map");
}

}  // namespace
}  // namespace crease
