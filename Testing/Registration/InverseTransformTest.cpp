#include "Registration/InverseTransform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/RigidTransform.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A class that the inverse does not know: x + shift + 3 sin(x / 9), smooth and without folds.
template <int Dim>
class Waves final : public Transform<Dim> {
 public:
  explicit Waves(const Vector<Dim>& shift) : shift_(shift) {}
  std::unique_ptr<Transform<Dim>> clone() const override { return std::make_unique<Waves>(*this); }
  Point<Dim> map(const Point<Dim>& x) const override {
    return x + shift_ + 3 * (x.array() / 9).sin().matrix();
  }
  Matrix<Dim> spatial_jacobian(const Point<Dim>& x) const override {
    return Matrix<Dim>(Vector<Dim>(1 + (x.array() / 9).cos() / 3).asDiagonal());
  }
  Eigen::Index num_parameters() const override { return 0; }
  Eigen::VectorXd parameters() const override { return {}; }
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>&) override {}
  void add_adjoint(std::span<const Point<Dim>>, std::span<const Vector<Dim>>,
                   Eigen::Ref<Eigen::VectorXd>) const override {}

 private:
  Vector<Dim> shift_;
};

/// u = 2 sin(x / 7 + y / 11) and the like, on a turned grid of oblong pixels that holds [-20, 40]^Dim.
template <int Dim>
std::unique_ptr<DisplacementFieldTransform<Dim>> smooth_field() {
  Raster<Dim> raster;
  raster.direction = testing::turned<Dim>();
  raster.spacing = Vector<Dim>::LinSpaced(2, 3);
  for (int a = 0; a < Dim; ++a) raster.size[a] = 48;
  raster.origin = Point<Dim>::Constant(10) -
                  raster.index_to_point() * Vector<Dim>::Constant(0.5 * raster.size[0]);
  ControlPoints<Dim> u(Dim, raster.num_samples());
  for (std::int64_t n = 0; n < u.cols(); ++n) {
    const Point<Dim> x = raster.row_start(n / raster.size[0]) +
                         double(n % raster.size[0]) * raster.index_to_point().col(0);
    for (int a = 0; a < Dim; ++a) u(a, n) = 2 * std::sin(x[a] / 7 + x[(a + 1) % Dim] / 11 + a);
  }
  return std::make_unique<DisplacementFieldTransform<Dim>>(raster, u);
}

template <int Dim>
std::unique_ptr<Transform<Dim>> turn() {
  RigidTransform<Dim> rigid(Point<Dim>::Constant(10));
  rigid.set_parameters(Eigen::VectorXd::LinSpaced(rigid.num_parameters(), 0.3, 4));
  return rigid.clone();
}

template <int Dim>
Box<Dim> box() {
  Box<Dim> result;
  result.add(Point<Dim>::Constant(-5));
  result.add(Point<Dim>::Constant(25));
  return result;
}

/// T(T^-1(y)) = y at random points of a box.
template <int Dim>
InverseResidual residual(const Transform<Dim>& transform, const Box<Dim>& where = box<Dim>()) {
  testing::Numbers numbers(3);
  std::vector<Point<Dim>> y(500), x(500);
  for (auto& p : y) {
    const Vector<Dim> share = 0.5 * (numbers.columns<Dim>(1).array() + 1);
    p = where.lower + share.cwiseProduct(where.size());
  }
  const auto inverse = inverse_transform(transform, where);
  const auto result = invert_points<Dim>(transform, inverse, y, x);
  double largest = 0, sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!x[k].allFinite()) continue;
    largest = std::max(largest, (transform.map(x[k]) - y[k]).norm());
    sum += (transform.map(x[k]) - y[k]).norm();
  }
  EXPECT_EQ(result.max_mm, largest);
  EXPECT_NEAR(result.mean_mm() * static_cast<double>(result.resolved), sum, 1e-12 * (1 + sum));
  EXPECT_EQ(result.resolved + result.unresolved, 500);
  return result;
}

template <int Dim>
void inverts_chains_of_all_kinds() {
  std::vector<std::unique_ptr<Transform<Dim>>> parts;
  parts.push_back(smooth_field<Dim>());
  parts.push_back(turn<Dim>());
  parts.push_back(std::make_unique<Waves<Dim>>(Vector<Dim>::Constant(400)));
  parts.push_back(turn<Dim>());
  const CompositeTransform<Dim> chain(std::move(parts));
  Box<Dim> where;
  const Point<Dim> middle = chain.map(Point<Dim>::Constant(10));
  where.add(middle - Vector<Dim>::Constant(12));
  where.add(middle + Vector<Dim>::Constant(12));
  const auto result = residual<Dim>(chain, where);
  EXPECT_EQ(result.unresolved, 0);
  EXPECT_LT(result.max_mm, 1e-6);
}

}  // namespace

TEST(InverseTransform, UndoesDisplacementFields) {
  const auto in_plane = residual<2>(*smooth_field<2>());
  EXPECT_EQ(in_plane.unresolved, 0);
  EXPECT_LT(in_plane.max_mm, 2e-6);  // a millionth of a pixel
  const auto in_space = residual<3>(*smooth_field<3>());
  EXPECT_EQ(in_space.unresolved, 0);
  EXPECT_LT(in_space.max_mm, 2e-6);
}

TEST(InverseTransform, OfAFieldIsTheIdentityWhereTheFieldEnded) {
  const auto field = smooth_field<2>();
  const auto inverse = inverse_transform<2>(*field);
  for (const Point<2>& y : {Point<2>(300, 5), Point<2>(-200, -200)}) EXPECT_EQ(inverse(y), y);
}

TEST(InverseTransform, UndoesClassesThatItDoesNotKnow) {
  const auto near = residual<2>(Waves<2>({0, 0}));
  EXPECT_EQ(near.unresolved, 0);
  EXPECT_LT(near.max_mm, 1e-6);
  const auto far = residual<3>(Waves<3>({500, -300, 80}));
  EXPECT_EQ(far.unresolved, 0);
  EXPECT_LT(far.max_mm, 1e-6);
}

TEST(InverseTransform, UndoesChainsOfAllKinds) {
  inverts_chains_of_all_kinds<2>();
  inverts_chains_of_all_kinds<3>();
}

TEST(InverseTransform, AffineMapsAreUndoneToRounding) {
  std::vector<std::unique_ptr<Transform<3>>> parts;
  parts.push_back(turn<3>());
  AffineMap<3> map;
  map.linear *= 1.3;
  map.linear(0, 2) = 0.4;
  parts.push_back(std::make_unique<AffineTransform<3>>(map));
  EXPECT_LT(residual<3>(CompositeTransform<3>(std::move(parts)), box<3>()).max_mm, 1e-13);
}

TEST(InverseTransform, CountsWhatFoldsOverItself) {
  auto field = smooth_field<2>();
  field->set_parameters(40 * field->parameters());
  Box<2> far = box<2>();
  for (double& c : far.upper) c = 60;
  const auto result = residual<2>(*field, far);
  EXPECT_GT(result.resolved, 0);
  EXPECT_LT(result.max_mm, 2e-6);  // what is found is right
  set_num_threads(1);
  const auto single = residual<2>(*field, far);
  set_num_threads(4);
  const auto again = residual<2>(*field, far);
  set_num_threads(0);
  EXPECT_EQ(single.sum_mm, again.sum_mm);
  EXPECT_EQ(single.unresolved, again.unresolved);
}

TEST(InverseTransform, SaysWhenItNeedsABox) {
  EXPECT_THAT(
      [] {
        inverse_transform<2>(Waves<2>({0, 0}));
      },
      ThrowsMessage<InvalidInput>(HasSubstr("say where it is to be inverted")));
}

}  // namespace crease
