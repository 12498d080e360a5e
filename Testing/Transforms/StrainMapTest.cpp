#include "Transforms/StrainMap.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/JacobianMap.h"

namespace crease {
namespace {

Raster<2> some_raster() {
  Raster<2> raster;
  raster.size = {7, 5};
  raster.direction = testing::turned<2>();
  return raster;
}

}  // namespace

TEST(StrainMap, IsZeroForRigidMapsAndKnownForStretches) {
  AffineMap<2> map{testing::turned<2>(1.1), Vector<2>(5, 5)};
  for (double e : strain_map<2>(AffineTransform<2>(map), some_raster())) EXPECT_LT(e, 1e-15);
  map.linear *= Eigen::Vector2d(1.5, 1).asDiagonal();
  const auto strain = strain_map<2>(AffineTransform<2>(map), some_raster());
  EXPECT_EQ(strain.size(), 35u);
  for (double e : strain) EXPECT_NEAR(e, 0.5 * (1.5 * 1.5 - 1), 1e-14);
}

// The only stretched sample is the one that the raster's third row, second column names.
TEST(StrainMap, FollowsTheRastersOrder) {
  const auto raster = some_raster();
  SplineTransform<2> transform(
      std::make_shared<TensorBSplineBasis<2>>(covering_lattice(raster, 1.0), 2));
  ControlPoints<2> phi = transform.control_points();
  const auto net = dynamic_cast<const TensorBSplineBasis<2>&>(transform.basis()).net_size();
  phi(0, 2 + net[0] * 3) = 0.1;  // the function whose middle is sample (1, 2)
  transform.set_control_points(phi);
  const auto strain = strain_map<2>(transform, raster);
  // Its gradient vanishes at its own middle and is largest at the samples beside.
  EXPECT_LT(strain[1 + 7 * 2], 1e-15);
  const auto largest = std::max_element(strain.begin(), strain.end()) - strain.begin();
  EXPECT_TRUE(largest == 0 + 7 * 2 || largest == 2 + 7 * 2);
}

}  // namespace crease
