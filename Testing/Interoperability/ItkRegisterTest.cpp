// What `crease register` writes for ITK, end to end: images on turned grids of oblong pixels are
// registered by the command, and a program that knows ITK alone maps points as `crease warp` does.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Images/ImageFile.h"
#include "Testing/Interoperability/ItkPoints.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using testing::mapped_by_itk;
using testing::points_within;
using testing::run_crease;

// The promises of `crease register --help`.
constexpr double kTransformError = 1e-9;  // mm
constexpr double kSampleError = 1e-12;    // mm: roundings of coordinates of some 100 mm

/// The grid of the images: oblong pixels, turned about one axis (2D) or about an oblique one.
template <int Dim>
Raster<Dim> turned_raster(const std::array<int, Dim>& size) {
  Raster<Dim> raster;
  raster.size = size;
  raster.spacing = Vector<Dim>::LinSpaced(0.8, 1.3);
  raster.origin = Point<Dim>::LinSpaced(-60, 90);
  const double c = std::cos(0.4), s = std::sin(0.4);
  raster.direction.template topLeftCorner<2, 2>() << c, -s, s, c;
  if constexpr (Dim == 3) {
    Matrix<3> tilt = Matrix<3>::Identity();
    tilt.bottomRightCorner<2, 2>() << c, s, -s, c;
    raster.direction = raster.direction * tilt;
  }
  return raster;
}

template <int Dim>
class ItkRegister : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  static Raster<Dim> raster();
  /// fixed.mha, moving.mha and, in 2D, labels.mha.
  void SetUp() override;

  /// Registers into "out" and reads what was found.
  void register_images(std::vector<std::string> extra) {
    std::vector<std::string> arguments = {
        "register", "--fixed",   file("fixed.mha"), "--moving", file("moving.mha"),
        "--output", file("out"), "--levels",        "1",        "--quiet"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto run = run_crease(arguments);
    ASSERT_EQ(run.code, 0) << run.err;
    transform_ = load_transform<Dim>(file("out/transform.json"));
  }
  bool has_tfm() const { return std::filesystem::exists(file("out/transform.tfm")); }

  /// `crease warp --points`.
  std::vector<Point<Dim>> warped(const std::vector<Point<Dim>>& points) const {
    std::string text = Dim == 2 ? "x,y\n" : "x,y,z\n";
    for (const auto& x : points) text += fmt::format("{}\n", fmt::join(x.begin(), x.end(), ","));
    const auto run =
        run_crease({"warp", "--transform", file("out/transform.json"), "--points",
                    folder_.write("in.csv", text), "--output-points", file("out.csv"), "--quiet"});
    EXPECT_EQ(run.code, 0) << run.err;
    std::istringstream rows(testing::read_text(folder_ / "out.csv"));
    std::string header;
    std::getline(rows, header);
    std::vector<Point<Dim>> mapped(points.size());
    for (auto& y : mapped) {
      for (int a = 0; a < Dim; ++a) {
        rows >> y[a];
        rows.ignore(1);
      }
    }
    EXPECT_TRUE(rows);
    return mapped;
  }

  void expect_same_by_transform_file() const {
    ASSERT_TRUE(has_tfm());
    const auto points = points_within(raster(), 200, -0.4);  // up to the pixels' outer borders
    const auto mapped = mapped_by_itk<Dim>(file("out/transform.tfm"), points);
    EXPECT_LT(testing::largest_distance<Dim>(mapped, warped(points)), kTransformError);
  }
  void expect_same_by_displacement_field() const {
    const auto grid = raster();
    std::vector<Point<Dim>> samples = points_within(grid, 200);
    for (auto& x : samples) x = grid.point(grid.index(x).array().round().matrix());
    const auto at_samples = mapped_by_itk<Dim>(file("out/displacement.mha"), samples);
    EXPECT_LT(testing::largest_distance<Dim>(at_samples, warped(samples)), kSampleError);

    const auto points = points_within(grid, 100);
    const auto mapped = mapped_by_itk<Dim>(file("out/displacement.mha"), points);
    const auto expected = warped(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double bound = interpolation_bound(grid.index(points[k])) + kSampleError;
      EXPECT_LE((mapped[k] - expected[k]).norm(), bound) << points[k].transpose();
    }
  }

 private:
  /// What `crease register --help` says of linear interpolation between pixels.
  double interpolation_bound(const Vector<Dim>& index) const {
    const auto* spline = dynamic_cast<const SplineTransform<Dim>*>(transform_.get());
    const bool creased = spline == nullptr ||
                         dynamic_cast<const TensorBSplineBasis<Dim>*>(&spline->basis()) == nullptr;
    return creased ? slope_bound(index) : curvature_bound(*spline, index);
  }
  /// Per axis h^2/8 times the second derivative, which the cell and its neighbours show.
  double curvature_bound(const SplineTransform<Dim>& spline, const Vector<Dim>& index) const {
    const Raster<Dim> grid = raster();
    Vector<Dim> largest = Vector<Dim>::Zero();
    visit_cells_around(index, [&](const Point<Dim>& x) {
      const auto second = spline.second_derivatives(x);
      for (int a = 0; a < Dim; ++a) {
        const Vector<Dim> axis = grid.direction.col(a);
        Vector<Dim> along;
        for (int c = 0; c < Dim; ++c) along[c] = axis.dot(second[c] * axis);
        largest[a] = std::max(largest[a], along.norm());
      }
    });
    return largest.dot(grid.spacing.cwiseAbs2()) / 8;
  }
  /// Per axis h/4 times the range of the slope: this holds across creases, too.
  double slope_bound(const Vector<Dim>& index) const {
    Matrix<Dim> lower = Matrix<Dim>::Constant(1e300), upper = -lower;
    visit_cells_around(index, [&](const Point<Dim>& x) {
      const Matrix<Dim> per_step = transform_->spatial_jacobian(x) * raster().index_to_point();
      lower = lower.cwiseMin(per_step);
      upper = upper.cwiseMax(per_step);
    });
    return 0.25 * (upper - lower).colwise().norm().sum();
  }
  /// Points a fifth of a pixel (3D: a third) apart in the cell of an index and the cells around it.
  template <typename Visit>
  static void visit_cells_around(const Vector<Dim>& index, Visit&& visit) {
    constexpr int kSteps = Dim == 2 ? 15 : 9;
    for (int n = 0; n < static_cast<int>(std::pow(kSteps + 1, Dim)); ++n) {
      Vector<Dim> i = index.array().floor() - 1;
      for (int a = 0, rest = n; a < Dim; ++a, rest /= kSteps + 1) {
        i[a] = std::clamp(i[a] + 3.0 * (rest % (kSteps + 1)) / kSteps, 0.0, raster().size[a] - 1.0);
      }
      visit(raster().point(i));
    }
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<Transform<Dim>> transform_;
};

using ItkRegister2 = ItkRegister<2>;
using ItkRegister3 = ItkRegister<3>;

template <>
Raster<2> ItkRegister<2>::raster() {
  return turned_raster<2>({64, 64});
}

/// The command's phantom of three bodies, its pixels laid on another grid.
template <>
void ItkRegister<2>::SetUp() {
  ASSERT_EQ(
      run_crease({"phantom", "bodies", "--size", "64", "--output", file("phantom"), "--quiet"})
          .code,
      0);
  for (const char* name : {"fixed.mha", "moving.mha"}) {
    const auto pixels = read_image<2>(file(std::string("phantom/") + name)).image;
    write_image(file(name), Image<float, 2>(raster(), pixels.values()), PixelType::kFloat);
  }
  const auto labels = read_labels<2>(file("phantom/labels.mha"));
  write_labels(file("labels.mha"), LabelImage<2>(raster(), labels.values()));
}

template <>
Raster<3> ItkRegister<3>::raster() {
  return turned_raster<3>({24, 20, 16});
}

/// Soft blobs, turned and swollen a little.
template <>
void ItkRegister<3>::SetUp() {
  const auto grid = raster();
  const Point<3> centre = grid.point({11.5, 9.5, 7.5});
  for (const bool moving : {false, true}) {
    Image<float, 3> volume(grid);
    for (std::int64_t n = 0; n < grid.num_samples(); ++n) {
      const auto index = volume.index(n);
      Vector<3> x = grid.point(Vector<3>(index[0], index[1], index[2])) - centre;
      if (moving)
        x = 0.95 * x + 0.1 * Vector<3>(-x.y(), x.x(), 0.02 * x.z() * x.z()) + Vector<3>(1, 0, -1);
      volume[index] = static_cast<float>(std::exp(-(x - Vector<3>(3, 2, -2)).squaredNorm() / 20) +
                                         std::exp(-(x + Vector<3>(4, 3, -1)).squaredNorm() / 30));
    }
    write_image(file(moving ? "moving.mha" : "fixed.mha"), volume, PixelType::kFloat);
  }
}

TEST_F(ItkRegister2, RigidAndAffineMaps) {
  for (const char* transform : {"rigid", "affine"}) {
    register_images({"--transform", transform});
    expect_same_by_transform_file();
    expect_same_by_displacement_field();
  }
}

TEST_F(ItkRegister2, TensorSplineOnAnAffineMap) {
  for (const char* degree : {"2", "3"}) {
    register_images({"--transform", "bspline", "--degree", degree, "--mesh-size", "12",
                     "--init-transform", "affine"});
    const auto loaded = load_transform<2>(file("out/transform.json"));
    const auto& affine = dynamic_cast<const SplineTransform<2>&>(*loaded).affine();
    EXPECT_FALSE(affine.linear.isIdentity(1e-4));  // the case where ITK needs a composite transform
    expect_same_by_transform_file();
    expect_same_by_displacement_field();
  }
}

TEST_F(ItkRegister2, TensorSplineOnTheIdentity) {
  register_images({"--transform", "bspline", "--mesh-size", "12", "--init", "identity"});
  expect_same_by_transform_file();
}

TEST_F(ItkRegister2, TriangularSplineWithCreasesAsADisplacementField) {
  register_images({"--transform", "affine"});
  EXPECT_TRUE(has_tfm());
  register_images({"--rigid-labels", file("labels.mha"), "--mesh-size", "24"});
  EXPECT_FALSE(has_tfm());  // not even the one of the run before
  expect_same_by_displacement_field();
}

TEST_F(ItkRegister3, RigidAndAffineMaps) {
  for (const char* transform : {"rigid", "affine"}) {
    register_images({"--transform", transform});
    expect_same_by_transform_file();
    expect_same_by_displacement_field();
  }
}

TEST_F(ItkRegister3, TensorSplineOnARigidMap) {
  register_images({"--transform", "bspline", "--mesh-size", "8", "--init-transform", "rigid"});
  expect_same_by_transform_file();
  expect_same_by_displacement_field();
}

}  // namespace
}  // namespace crease
