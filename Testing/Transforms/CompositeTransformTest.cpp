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

TEST(CompositeTransform, OfNothingIsTheIdentity) {
  const CompositeTransform<3> transform({});
  EXPECT_EQ(transform.map({1, 2, 3}), Point<3>(1, 2, 3));
  EXPECT_EQ(transform.num_parameters(), 0);
  std::vector<std::unique_ptr<Transform<3>>> null(1);
  EXPECT_THROW(CompositeTransform<3>(std::move(null)), InvalidInput);
}

}  // namespace crease
