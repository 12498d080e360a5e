#include "Transforms/SimilarityTransform.h"

#include <gtest/gtest.h>

#include <numbers>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {

TEST(SimilarityTransform, TurnsThenScalesAboutItsCentre) {
  SimilarityTransform<2> transform(Point<2>(1, 1));
  transform.set_parameters(Eigen::Vector4d(std::numbers::pi / 2, std::log(3), 10, 0));
  EXPECT_NEAR(transform.scale(), 3, 1e-14);
  EXPECT_LT((transform.map({3, 1}) - Point<2>(11, 7)).norm(), 1e-14);
}

TEST(SimilarityTransform, IsRebuiltFromItsMap) {
  SimilarityTransform<3> transform(Point<3>(1, 2, 3));
  transform.set_parameters((Eigen::VectorXd(7) << 0.4, -1.1, 2.0, -0.7, 5, -6, 7).finished());
  const SimilarityTransform<3> again(transform.affine_map(), Point<3>(-4, 0, 2));
  EXPECT_LT((again.map({9, 8, 7}) - transform.map({9, 8, 7})).norm(), 1e-13);
  const SimilarityTransform<3> same(transform.affine_map(), transform.centre());
  EXPECT_LT((same.parameters() - transform.parameters()).norm(), 1e-12);
}

TEST(SimilarityTransform, RefusesWhatIsNoSimilarity) {
  AffineMap<2> map;
  map.linear(0, 0) = -1;
  EXPECT_THROW(SimilarityTransform<2>{map}, InvalidInput);
  map.linear(0, 0) = 1.01;
  EXPECT_THROW(SimilarityTransform<2>{map}, InvalidInput);
  map.linear.setZero();
  EXPECT_THROW(SimilarityTransform<2>{map}, InvalidInput);
  map.linear = 1e-5 * testing::turned<2>();
  EXPECT_NO_THROW(SimilarityTransform<2>{map});
}

}  // namespace crease
