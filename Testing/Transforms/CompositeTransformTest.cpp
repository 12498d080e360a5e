#include "Transforms/CompositeTransform.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"

namespace crease {

TEST(CompositeTransform, AppliesTheFirstPartFirst) {
  AffineMap<2> twice, shift;
  twice.linear *= 2;
  shift.offset = {1, 0};
  std::vector<std::unique_ptr<Transform<2>>> parts;
  parts.push_back(std::make_unique<AffineTransform<2>>(twice));
  parts.push_back(std::make_unique<AffineTransform<2>>(shift));
  const CompositeTransform<2> transform(std::move(parts));
  EXPECT_EQ(transform.map({3, 4}), Point<2>(7, 8));
  EXPECT_EQ(transform.num_parts(), 2u);
}

TEST(CompositeTransform, IsInItsDomainWhereEveryPartIs) {
  const auto basis = testing::box_basis<2>(4, 4.0);
  AffineMap<2> shift;
  shift.offset = {3, 0};
  std::vector<std::unique_ptr<Transform<2>>> parts;
  parts.push_back(std::make_unique<AffineTransform<2>>(shift));
  parts.push_back(std::make_unique<SplineTransform<2>>(basis));
  const CompositeTransform<2> transform(std::move(parts));
  EXPECT_TRUE(transform.in_domain({0.5, 1}));
  EXPECT_FALSE(transform.in_domain({2, 1}));
}

TEST(CompositeTransform, SamplesAtOnceWhatItTellsOneByOne) {
  std::vector<std::unique_ptr<Transform<2>>> parts;
  for (unsigned seed : {1u, 2u}) {
    const auto basis = testing::box_basis<2>(4, 4.0);
    auto part = std::make_unique<SplineTransform<2>>(basis);
    part->set_control_points(testing::Numbers(seed).columns<2>(basis->num_control_points(), 0.4));
    parts.push_back(std::move(part));
  }
  const CompositeTransform<2> transform(std::move(parts));
  for (const Point<2>& x : {Point<2>(1.3, 2.2), Point<2>(3.97, 0.02), Point<2>(-1, 5)}) {
    const auto sample = transform.sample(x);
    EXPECT_EQ(sample.point, transform.map(x));
    EXPECT_EQ(sample.jacobian, transform.spatial_jacobian(x));
    EXPECT_EQ(sample.in_domain, transform.in_domain(x));
  }
}

TEST(CompositeTransform, OfNothingIsTheIdentity) {
  const CompositeTransform<3> transform({});
  EXPECT_EQ(transform.map({1, 2, 3}), Point<3>(1, 2, 3));
  EXPECT_EQ(transform.num_parameters(), 0);
  std::vector<std::unique_ptr<Transform<3>>> null(1);
  EXPECT_THROW(CompositeTransform<3>(std::move(null)), InvalidInput);
}

}  // namespace crease
