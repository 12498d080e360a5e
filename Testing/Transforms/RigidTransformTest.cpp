#include "Transforms/RigidTransform.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {

TEST(RigidTransform, TurnsFromTheFirstAxisToTheSecond) {
  RigidTransform<2> transform(Point<2>(1, 1));
  transform.set_parameters(Eigen::Vector3d(std::numbers::pi / 2, 10, 0));
  EXPECT_LT((transform.map({3, 1}) - Point<2>(11, 3)).norm(), 1e-14);

  RigidTransform<3> turn;
  turn.set_parameters((Eigen::VectorXd(6) << 0, 0, std::numbers::pi / 2, 0, 0, 5).finished());
  EXPECT_LT((turn.map({1, 0, 0}) - Point<3>(0, 1, 5)).norm(), 1e-14);
}

TEST(RigidTransform, MatricesAreRotations) {
  testing::Numbers numbers;
  for (double size : {1e-9, 1e-5, 1.0, 3.0}) {
    RigidTransform<3> transform;
    transform.set_parameters(numbers.columns<1>(6, size).transpose());
    EXPECT_LT(
        (transform.rotation() * transform.rotation().transpose() - Matrix<3>::Identity()).norm(),
        1e-14);
    EXPECT_NEAR(transform.rotation().determinant(), 1, 1e-14);
  }
}

TEST(RigidTransform, IsRebuiltFromItsMap) {
  RigidTransform<3> transform(Point<3>(1, 2, 3));
  transform.set_parameters((Eigen::VectorXd(6) << 0.4, -1.1, 2.0, 5, -6, 7).finished());
  const RigidTransform<3> again(transform.affine_map(), Point<3>(-4, 0, 2));
  EXPECT_LT((again.map({9, 8, 7}) - transform.map({9, 8, 7})).norm(), 1e-13);
  const RigidTransform<3> same(transform.affine_map(), transform.centre());
  EXPECT_LT((same.parameters() - transform.parameters()).norm(), 1e-12);
}

TEST(RigidTransform, RefusesWhatIsNoRotation) {
  AffineMap<2> mirror;
  mirror.linear(0, 0) = -1;
  EXPECT_THROW(RigidTransform<2>{mirror}, InvalidInput);
  AffineMap<2> stretch;
  stretch.linear *= 1.01;
  EXPECT_THROW(RigidTransform<2>{stretch}, InvalidInput);
}

}  // namespace crease
