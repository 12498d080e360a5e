#include "Optimizers/LinearConstraints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "Core/Error.h"
#include "Testing/Optimizers/Problems.h"

namespace crease {
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class LinearConstraintsInput : public ::testing::Test {
 protected:
  LinearConstraints constraints_ = testing::landmark_constraints(6, 4, 2, 1);
  std::function<void()> check_ = [this] { check_constraints(constraints_, 36); };
};

TEST_F(LinearConstraintsInput, GoodOnesPass) { EXPECT_NO_THROW(check_()); }

TEST_F(LinearConstraintsInput, MissingRightHandSide) {
  constraints_.d.conservativeResize(3, 2);
  EXPECT_THAT(check_, ThrowsMessage<InvalidInput>(HasSubstr("C has 4 rows and d has 3")));
}

TEST_F(LinearConstraintsInput, MissingName) {
  constraints_.names.pop_back();
  EXPECT_THAT(check_, ThrowsMessage<InvalidInput>(HasSubstr("3 names for 4 rows")));
}

TEST_F(LinearConstraintsInput, OtherNumberOfUnknowns) {
  EXPECT_THAT([this] { check_constraints(constraints_, 49); },
              ThrowsMessage<InvalidInput>(HasSubstr("36 columns, but there are 49")));
}

TEST_F(LinearConstraintsInput, NotANumberNamesTheRow) {
  constraints_.d(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(check_, ThrowsMessage<InvalidInput>(HasSubstr("landmark 3")));
}

TEST_F(LinearConstraintsInput, InfiniteCoefficientNamesTheRow) {
  constraints_.C.valuePtr()[17] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(check_, ThrowsMessage<InvalidInput>(HasSubstr("landmark 2")));
}
}  // namespace crease
