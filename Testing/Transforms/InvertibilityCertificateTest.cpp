#include "Transforms/InvertibilityCertificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>

#include "Core/Parallel.h"
#include "Testing/Transforms/FoldingMaps.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/Splines/DeterminantPieces.h"

namespace crease {
namespace {

using testing::Numbers;

template <int Dim>
Box<Dim> sample_box() {
  Box<Dim> box;
  box.add(Point<Dim>::Constant(-1));
  box.add(Point<Dim>::Constant(5));
  return box;
}

/// x -> x + f(x) with quadratic f, whose determinant is known everywhere.
ControlPoints<2> quadratic_points(const TriangularBSplineBasis<2>& basis,
                                  const std::array<std::array<double, 3>, 2>& c) {
  ControlPoints<2> phi(2, basis.num_control_points());
  const std::array<std::array<int, 2>, 3> exponents = {{{2, 0}, {1, 1}, {0, 2}}};
  for (int a = 0; a < 2; ++a) {
    phi.row(a) = basis.control_values([&](std::span<const Point<2>> arguments) {
      double sum = 0;
      for (int e = 0; e < 3; ++e) sum += c[a][e] * monomial_polar_form<2>(exponents[e], arguments);
      return sum;
    });
  }
  return phi;
}

/// A random point of a piece.
template <int Dim>
Point<Dim> point_in(const SimplexPiece<Dim>& piece, Numbers& numbers) {
  Point<Dim> sum = Point<Dim>::Zero();
  double weights = 0;
  for (const auto& corner : piece.points) {
    const double w = 1.05 + numbers();
    sum += w * corner;
    weights += w;
  }
  return sum / weights;
}
template <int Dim>
Point<Dim> point_in(const BoxPiece<Dim>& piece, Numbers& numbers) {
  return piece.origin + piece.edges * (0.5 + 0.45 * numbers.columns<Dim>(1).array()).matrix();
}

/// Bases that know their determinants as polynomials.
bool is_certifiable(const std::string& basis) {
  return basis.find("thin plates") == std::string::npos;
}

/// Their pieces hold a multiple of det, not above it where positive.
bool is_rational(const std::string& basis) { return basis.find("rational") != std::string::npos; }

template <int Dim>
void expect_bounds_hold() {
  const Box<Dim> box = sample_box<Dim>();
  AffineMap<Dim> affine;
  affine.linear = testing::turned<Dim>(0.4);
  affine.linear(0, 1) += 0.2;
  for (const auto& sample : testing::sample_bases<Dim>(box)) {
    SplineTransform<Dim> transform(sample.basis, affine);
    transform.set_control_points(Numbers(3).columns<Dim>(sample.basis->num_control_points(), 0.5));
    const auto pieces = sample.basis->determinant_pieces(transform.control_points(), affine.linear);
    if (!sample.integrates || !is_certifiable(sample.name)) {
      EXPECT_EQ(pieces, nullptr) << sample.name;
      continue;
    }
    Numbers numbers(8);
    for (int patch = 0; patch < pieces->num_patches(); patch += 3) {
      const double rough = pieces->rough_bound(patch);
      int n = 0;
      for (const auto& any : pieces->pieces(patch)) {
        if (++n % 5 != 0 && Dim == 2) continue;
        std::visit(
            [&](const auto& piece) {
              const Point<Dim> x = point_in<Dim>(piece, numbers);
              if (piece.size() < 1e-3 || !sample.basis->contains(x)) return;
              const double det = transform.spatial_jacobian(x).determinant();
              EXPECT_GE(det, rough) << sample.name << ", patch " << patch;
              const bool rational = is_rational(sample.name);
              if (rational && !(det > 0)) {
                EXPECT_LE(piece.determinant.coefficients().minCoeff(), piece.error);
                return;
              }
              EXPECT_GE(det, piece.determinant.coefficients().minCoeff() - piece.error - 1e-9)
                  << sample.name << ", patch " << patch << ", at " << x.transpose();
              EXPECT_LT(piece.error, 1e-6);
              if (rational) return;
              EXPECT_LE(det, piece.determinant.coefficients().maxCoeff() + piece.error + 1e-9)
                  << sample.name << ", patch " << patch << ", at " << x.transpose();
              // Halves have tighter bounds, and hold, too.
              const auto [first, second] = piece.halves();
              EXPECT_GE(first.determinant.coefficients().minCoeff(),
                        piece.determinant.coefficients().minCoeff() - 1e-12);
              EXPECT_GE(std::max(first.determinant.coefficients().maxCoeff(),
                                 second.determinant.coefficients().maxCoeff()),
                        det - 1e-9);
            },
            any);
      }
    }
  }
}

}  // namespace

TEST(InvertibilityCertificate, BoundsOfPatchesAndPiecesHoldInThePlane) { expect_bounds_hold<2>(); }
TEST(InvertibilityCertificate, BoundsOfPatchesAndPiecesHoldInSpace) { expect_bounds_hold<3>(); }

TEST(InvertibilityCertificate, IdentityHasDeterminantOneEverywhere) {
  for (const auto& sample : testing::sample_bases<2>(sample_box<2>())) {
    const auto certificate = certify_invertibility(SplineTransform<2>(sample.basis));
    if (!is_certifiable(sample.name)) {
      EXPECT_EQ(certificate.verdict, Invertibility::kNotCertifiable) << sample.name;
      continue;
    }
    EXPECT_EQ(certificate.verdict, Invertibility::kCertified) << sample.name;
    if (is_rational(sample.name)) {
      EXPECT_GT(certificate.lower_bound, 0) << sample.name;
    } else {
      EXPECT_NEAR(certificate.lower_bound, 1, 1e-9) << sample.name;
    }
    EXPECT_LT(certificate.lower_bound, 1) << sample.name;  // rounding is taken off
    EXPECT_FALSE(certificate.failing.has_value());
  }
}

// T = (x + a x^2, y) has det 1 + 2 a x, least at the left border.
TEST(InvertibilityCertificate, FindsTheLeastDeterminantOfAPolynomial) {
  const auto box = sample_box<2>();
  for (const auto& basis :
       {testing::triangles_over(box, {.degree = 3}), testing::creased_over(box)}) {
    const auto& triangles = dynamic_cast<const TriangularBSplineBasis<2>&>(*basis);
    SplineTransform<2> transform(basis);
    for (double least : {0.5, 0.01, 1e-5}) {
      transform.set_control_points(quadratic_points(triangles, {{{(1 - least) / 2, 0, 0}, {}}}));
      const auto certificate = certify_invertibility(transform);
      EXPECT_EQ(certificate.verdict, Invertibility::kCertified) << least;
      EXPECT_LE(certificate.lower_bound, least);
      EXPECT_GE(certificate.lower_bound, 0.5 * least - 1e-9);
    }
    transform.set_control_points(quadratic_points(triangles, {{{0.51, 0, 0}, {}}}));
    const auto certificate = certify_invertibility(transform);
    EXPECT_EQ(certificate.verdict, Invertibility::kFolded);
    ASSERT_TRUE(certificate.failing.has_value());
    EXPECT_NEAR(certificate.failing->at.x(), -1, 1e-9);
    EXPECT_NEAR(certificate.failing->determinant, -0.02, 1e-9);
    EXPECT_LE(certificate.lower_bound, -0.02);
    EXPECT_NEAR(transform.spatial_jacobian(certificate.failing->at).determinant(), -0.02, 1e-8);
    EXPECT_GE(certificate.failing->corners.size(), 3u);
    EXPECT_GT(certificate.failing->size_mm, 0);
  }
}

// det touches 0 on a line: no bound can be positive, no value is negative but by rounding.
TEST(InvertibilityCertificate, AZeroOfTheDeterminantIsNeverCertified) {
  const auto basis = testing::triangles_over(sample_box<2>(), {.degree = 3});
  const auto& triangles = dynamic_cast<const TriangularBSplineBasis<2>&>(*basis);
  SplineTransform<2> transform(basis);
  transform.set_control_points(quadratic_points(triangles, {{{0.5, 0, 0}, {}}}));
  const auto certificate = certify_invertibility(transform);
  EXPECT_FALSE(certificate.certified());
  ASSERT_TRUE(certificate.failing.has_value());
  EXPECT_NEAR(certificate.failing->determinant, 0, 1e-6);
}

TEST(InvertibilityCertificate, IsTheSameOnAnyNumberOfThreads) {
  const auto basis = testing::creased_over(sample_box<2>());
  SplineTransform<2> transform(basis);
  transform.set_control_points(Numbers(3).columns<2>(basis->num_control_points(), 0.06));
  const auto one = [&] {
    set_num_threads(1);
    return certify_invertibility(transform);
  }();
  set_num_threads(0);
  const auto many = certify_invertibility(transform);
  EXPECT_EQ(one.verdict, many.verdict);
  EXPECT_EQ(one.lower_bound, many.lower_bound);
  EXPECT_EQ(one.num_examined, many.num_examined);
  EXPECT_EQ(one.patch_bounds, many.patch_bounds);
}

TEST(InvertibilityCertificate, LinearMapsHaveOneDeterminant) {
  EXPECT_TRUE(certify_invertibility(RigidTransform<2>()).certified());
  EXPECT_TRUE(certify_invertibility(RigidTransform<3>()).certified());
  AffineMap<2> map;
  map.linear << 2, 1, 0, 0.25;
  const auto stretched = certify_invertibility(AffineTransform<2>(map));
  EXPECT_TRUE(stretched.certified());
  EXPECT_NEAR(stretched.lower_bound, 0.5, 1e-13);
  map.linear << 0, 1, 1, 0;
  EXPECT_EQ(certify_invertibility(AffineTransform<2>(map)).verdict, Invertibility::kFolded);
  map.linear << 1, 1 + 1e-16, 1, 1;
  EXPECT_FALSE(certify_invertibility(AffineTransform<2>(map)).certified());
}

TEST(InvertibilityCertificate, ChainsMultiplyTheBoundsOfTheirParts) {
  const auto basis = testing::tensor_over<2>(sample_box<2>(), 4, 3);
  SplineTransform<2> good(basis), folded(basis);
  good.set_control_points(Numbers(3).columns<2>(basis->num_control_points(), 0.1));
  folded.set_control_points(Numbers(3).columns<2>(basis->num_control_points(), 3));
  AffineMap<2> half;
  half.linear *= 0.5;
  const auto chain = [&](const Transform<2>& first, const Transform<2>& second) {
    std::vector<std::unique_ptr<Transform<2>>> parts;
    parts.push_back(first.clone());
    parts.push_back(second.clone());
    return certify_invertibility(CompositeTransform<2>(std::move(parts)));
  };
  const auto alone = certify_invertibility(good);
  ASSERT_TRUE(alone.certified());
  const auto both = chain(good, AffineTransform<2>(half));
  EXPECT_TRUE(both.certified());
  EXPECT_NEAR(both.lower_bound, 0.25 * alone.lower_bound, 1e-12);
  EXPECT_EQ(chain(folded, AffineTransform<2>(half)).verdict, Invertibility::kFolded);
  // Whether the first part leads to where the second one folds is not known.
  const auto later = chain(AffineTransform<2>(half), folded);
  EXPECT_EQ(later.verdict, Invertibility::kUndecided);
  ASSERT_TRUE(later.failing.has_value());
  EXPECT_EQ(later.failing->part, 1);
}

TEST(InvertibilityCertificate, OtherKindsAreNotCertifiable) {
  const auto tetrahedra = testing::sample_bases<3>(sample_box<3>()).back();
  const auto certificate = certify_invertibility(SplineTransform<3>(tetrahedra.basis));
  EXPECT_EQ(certificate.verdict, Invertibility::kNotCertifiable);
  EXPECT_TRUE(std::isnan(certificate.lower_bound));
}

// The two sides of a crease have their own determinants: a shear that starts at a line.
TEST(InvertibilityCertificate, BothSidesOfACreaseCount) {
  const auto basis = testing::creased_over(sample_box<2>());
  const auto family = testing::folding_family<2>(basis, 5);
  const auto certificate = certify_invertibility(family.scaled_to(0.05));
  EXPECT_TRUE(certificate.certified());
  EXPECT_LE(certificate.lower_bound, 0.05 + 1e-6);
}

/// Maps whose least determinant is known by sampling: half of them between 0 and 0.2. No map that is certified
/// folds at a sample eight times finer than its mesh, and nearly all that do not fold are certified.
TEST(InvertibilityCertificate, CertifiesMapsThatDoNotFoldAndNoOthers) {
  int unfolded = 0, certified = 0, count = 0;
  const auto judge = [&]<int Dim>(const std::string& name,
                                  const testing::FoldingFamily<Dim>& family, double target) {
    const auto transform = family.scaled_to(target);
    const auto certificate = certify_invertibility(transform);
    double least = family.least_determinant(transform);
    ++count;
    if (certificate.certified()) {
      EXPECT_GT(least, 0) << name << ", target " << target;
      EXPECT_LE(certificate.lower_bound, least) << name << ", target " << target;
      EXPECT_GT(family.least_on_grid(transform), 0) << name << ", target " << target;
    } else {
      EXPECT_NE(certificate.verdict, Invertibility::kNotCertifiable);
      ASSERT_TRUE(certificate.failing.has_value());
      // Sampling may miss what the certificate found; the map itself is asked, just inside of the cell's part.
      const auto& region = *certificate.failing;
      Point<Dim> inside = Point<Dim>::Zero();
      for (const auto& corner : region.corners) inside += corner / region.corners.size();
      const Point<Dim> x = region.at + 1e-6 * (inside - region.at);
      if (transform.basis().contains(x)) {
        least = std::min(least, transform.spatial_jacobian(x).determinant());
      }
    }
    if (least > 0) {
      ++unfolded;
      certified += certificate.certified();
    }
  };
  const auto run = [&](const std::string& name, const auto& basis, int families) {
    Numbers numbers(17);
    for (int f = 0; f < families; ++f) {
      const auto family = testing::folding_family(basis, 100 + f);
      judge(name, family, 0.1 + 0.1 * numbers());
      judge(name, family, 0.1 + 0.1 * numbers());
      judge(name, family, 0.5 + 0.3 * numbers());
      judge(name, family, -0.3 + 0.3 * numbers());
    }
  };
  const auto box = sample_box<2>();
  run("tensor", testing::tensor_over<2>(box, 5, 3), 10);
  run("C2", testing::triangles_over(box, {.degree = 3}, 3), 10);
  run("C1", testing::triangles_over(box, {.degree = 3, .smoothness = 1}, 3), 10);
  run("creased C2", testing::creased_over(box), 9);
  run("creased C1", testing::creased_over(box, 3, 1), 9);
  for (const auto& sample : testing::sample_bases<2>(box)) {
    const bool other = sample.name.find("NURBS") == 0 || sample.name.find("T-spline") == 0;
    if (other && sample.integrates) run(sample.name, sample.basis, 2);
  }
  run("space", testing::tensor_over<3>(sample_box<3>(), 3, 3), 4);
  EXPECT_GE(count, 200);
  EXPECT_GE(certified, 0.95 * unfolded) << certified << " of " << unfolded;
  RecordProperty("unfolded", unfolded);
  RecordProperty("certified", certified);
}

}  // namespace crease
