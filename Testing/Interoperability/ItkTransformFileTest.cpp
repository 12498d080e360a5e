// Files of save_itk_transform, read and applied by a program that knows ITK alone.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include <numbers>

#include "Core/Error.h"
#include "Testing/Interoperability/ItkPoints.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/StructuredTriangulation.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/TransformFileItk.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-11;  // mm: some hundred roundings of coordinates of 100 mm

template <int Dim>
class ItkTransformFile : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_ / "transform.tfm"; }
  std::size_t num_files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
  }
  /// Points within the small lattice of the sample splines.
  static std::vector<Point<Dim>> points() {
    const auto lattice = testing::small_lattice<Dim>();
    Raster<Dim> raster;
    for (int a = 0; a < Dim; ++a) raster.size[a] = lattice.spans[a] + 1;
    raster.origin = lattice.origin;
    raster.spacing = lattice.spacing;
    raster.direction = lattice.direction;
    return testing::points_within(raster, 200);
  }
  static Point<Dim> centre() { return Point<Dim>::LinSpaced(-80, 120); }
  static AffineMap<Dim> skew_map() {
    AffineMap<Dim> map;
    map.linear = 1.1 * testing::turned<Dim>(0.7);
    map.linear(0, Dim - 1) += 0.2;
    map.offset = Vector<Dim>::LinSpaced(-12, 31);
    return map;
  }
  static SplineTransform<Dim> spline(int degree, const AffineMap<Dim>& affine = {}) {
    const auto basis = testing::small_basis<Dim>(degree);
    SplineTransform<Dim> transform(basis, affine);
    testing::Numbers numbers(3);
    transform.set_control_points(numbers.columns<Dim>(basis->num_control_points(), 2.0));
    return transform;
  }
  /// ITK and crease map the points to the same places.
  void expect_same(const Transform<Dim>& transform, const std::string& which) const {
    ASSERT_TRUE(has_itk_equivalent(transform)) << which;
    save_itk_transform(transform, file());
    std::vector<Point<Dim>> expected;
    for (const auto& x : points()) expected.push_back(transform.map(x));
    const auto mapped = testing::mapped_by_itk<Dim>(file(), points());
    EXPECT_LT(testing::largest_distance<Dim>(mapped, expected), kRounding) << which;
  }

 private:
  testing::TemporaryFolder folder_;
};

template <typename Dim>
class ItkTransformFileOf : public ItkTransformFile<Dim::value> {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ItkTransformFileOf, Dimensions);

TYPED_TEST(ItkTransformFileOf, AffineMapsAreTheSame) {
  constexpr int Dim = TypeParam::value;
  this->expect_same(AffineTransform<Dim>(this->skew_map(), this->centre()), "affine");
}

TYPED_TEST(ItkTransformFileOf, SimilaritiesAreTheSame) {
  constexpr int Dim = TypeParam::value;
  SimilarityTransform<Dim> similarity(this->centre());
  similarity.set_parameters(Eigen::VectorXd::LinSpaced(similarity.num_parameters(), 0.4, 5.0));
  this->expect_same(similarity, "a similarity");
}

TYPED_TEST(ItkTransformFileOf, SplinesAreTheSameInTheirDomain) {
  for (int degree : {1, 2, 3}) {
    const std::string name = "degree " + std::to_string(degree);
    this->expect_same(this->spline(degree), name);
    this->expect_same(this->spline(degree, this->skew_map()), name + " with an affine map");
  }
}

TYPED_TEST(ItkTransformFileOf, ChainsKeepTheirOrder) {
  constexpr int Dim = TypeParam::value;
  std::vector<std::unique_ptr<Transform<Dim>>> parts;
  parts.push_back(std::make_unique<SplineTransform<Dim>>(this->spline(3, this->skew_map())));
  parts.push_back(std::make_unique<AffineTransform<Dim>>(this->skew_map(), this->centre()));
  RigidTransform<Dim> rigid(this->centre());
  rigid.set_parameters(Eigen::VectorXd::LinSpaced(rigid.num_parameters(), 0.4, 5.0));
  parts.push_back(rigid.clone());
  this->expect_same(CompositeTransform<Dim>(std::move(parts)), "a chain");
}

TYPED_TEST(ItkTransformFileOf, OutsideTheSplineItkKeepsTheAffineMap) {
  constexpr int Dim = TypeParam::value;
  const auto transform = this->spline(3, this->skew_map());
  save_itk_transform(transform, this->file());
  const std::vector<Point<Dim>> outside = {Point<Dim>::Constant(-40), Point<Dim>::Constant(50)};
  const auto mapped = testing::mapped_by_itk<Dim>(this->file(), outside);
  for (std::size_t k = 0; k < outside.size(); ++k) {
    ASSERT_FALSE(transform.in_domain(outside[k]));
    EXPECT_LT((mapped[k] - this->skew_map()(outside[k])).norm(), kRounding);
  }
}

TYPED_TEST(ItkTransformFileOf, RefusesWhatItkDoesNotHave) {
  constexpr int Dim = TypeParam::value;
  AffineMap<Dim> flat;
  flat.linear(0, 0) = 0;
  std::vector<std::unique_ptr<Transform<Dim>>> chain;
  chain.push_back(std::make_unique<AffineTransform<Dim>>());
  chain.push_back(this->spline(4).clone());
  EXPECT_FALSE(has_itk_equivalent(this->spline(4)));
  EXPECT_FALSE(has_itk_equivalent(CompositeTransform<Dim>(std::move(chain))));
  EXPECT_FALSE(has_itk_equivalent(this->spline(3, flat)));
  EXPECT_THAT([&] { save_itk_transform(this->spline(4), this->file()); },
              ThrowsMessage<InvalidInput>(HasSubstr("transform.tfm: ITK has no transform")));
  EXPECT_EQ(this->num_files(), 0u);
}

using ItkTransformFile2 = ItkTransformFile<2>;
using ItkTransformFile3 = ItkTransformFile<3>;

TEST_F(ItkTransformFile2, RigidMapsAreTheSame) {
  RigidTransform<2> rigid(centre());
  for (double angle : {0.0, 0.3, -2.5, kPi / 2, kPi}) {
    rigid.set_parameters(Eigen::Vector3d(angle, 4, -90));
    expect_same(rigid, std::to_string(angle));
  }
}

// Half turns, where a versor would lose half its digits, and quarter turns about the first axis, where
// Euler's angles are not unique.
TEST_F(ItkTransformFile3, RigidMapsAreTheSame) {
  RigidTransform<3> rigid(centre());
  const std::vector<Vector<3>> axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, 0, -0.8}, {-2, 1, 3}};
  for (const auto& axis : axes) {
    for (double angle : {0.0, 1e-9, 0.3, kPi / 2 - 1e-9, kPi / 2, -kPi / 2, 2.0, kPi}) {
      Eigen::VectorXd parameters(6);
      parameters << angle * axis.normalized(), 4, -90, 33;
      rigid.set_parameters(parameters);
      expect_same(rigid, message(angle, " about ", axis.transpose()));
    }
  }
}

TEST_F(ItkTransformFile2, TriangularSplinesHaveNoEquivalent) {
  Box<2> box;
  box.add({0, 0});
  box.add({10, 10});
  DomainMesh domain{structured_triangulation(box, 2, 2), {}, {}, {}};
  const auto basis = std::make_shared<TriangularBSplineBasis<2>>(place_knots(domain, {}).net);
  EXPECT_FALSE(has_itk_equivalent(SplineTransform<2>(basis)));
}

TEST_F(ItkTransformFile2, SaysWhenItCannotWriteAndLeavesNothingBehind) {
  EXPECT_THAT([&] { save_itk_transform(spline(3), file() / "below" / "a.tfm"); },
              ThrowsMessage<FileError>(HasSubstr("a.tfm")));
  // A disk that is full after 100 bytes.
  signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlim_t before = limit.rlim_cur;
  limit.rlim_cur = 100;
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_THAT([&] { save_itk_transform(spline(3), file()); },
              ThrowsMessage<FileError>(HasSubstr("transform.tfm: cannot be written")));
  limit.rlim_cur = before;
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_EQ(num_files(), 0u);
}

}  // namespace
}  // namespace crease
