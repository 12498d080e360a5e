// Fits of known maps with a kink: how well creases on curved outlines catch it. Figures in comments are
// those of the theory's prototype (n = 3, cloud radius 1/2, disc of 16 edges).
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <functional>

#include "Testing/Transforms/CreasedDomains.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/Splines/Jumps.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Energies/BendingEnergy.h"

namespace crease {
namespace {

using testing::kHalfWidth;

/// A displacement.
using Truth = std::function<Vector<2>(const Point<2>&)>;

/// 0.25 rad and a shift.
Vector<2> rigid(const Point<2>& x) {
  const double c = std::cos(0.25), s = std::sin(0.25);
  return {c * x[0] - s * x[1] - x[0] + 0.2, s * x[0] + c * x[1] - x[1] - 0.1};
}

/// Rigid where the distance to a line is negative, fading away from it on the other side.
Truth fading(const std::function<double(const Point<2>&)>& distance) {
  return [=](const Point<2>& x) -> Vector<2> {
    return std::exp(-1.2 * std::max(0.0, distance(x))) * rigid(x);
  };
}

const Truth kDisc = fading([](const Point<2>& x) { return x.norm() - 1; });

/// Centres of count x count cells of the frame.
std::vector<Point<2>> samples(int count) {
  std::vector<Point<2>> points;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      points.emplace_back(kHalfWidth * ((2 * i + 1.0) / count - 1),
                          kHalfWidth * ((2 * j + 1.0) / count - 1));
    }
  }
  return points;
}

/// The spline that minimises the square error, integrated on a grid, plus 1e-5 times the bending energy.
class Fit {
 public:
  Fit(const KnotNet<2>& net, Truth truth)
      : basis_(std::make_shared<const TriangularBSplineBasis<2>>(net)), truth_(std::move(truth)) {
    const int n = basis_->num_control_points();
    const auto points = samples(120);
    const double scale = 2 * kHalfWidth / 120;  // its square is a sample's area
    ControlPoints<2> rhs = ControlPoints<2>::Zero(2, n);
    std::vector<Eigen::Triplet<double>> rows;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto b = basis_->evaluate(points[k]);
      for (std::size_t i = 0; i < b.control_points.size(); ++i) {
        rows.emplace_back(static_cast<int>(k), b.control_points[i], scale * b.values[i]);
        rhs.col(b.control_points[i]) += scale * scale * b.values[i] * truth_(points[k]);
      }
    }
    Eigen::SparseMatrix<double> B(static_cast<Eigen::Index>(points.size()), n);
    B.setFromTriplets(rows.begin(), rows.end());
    matrix_ = B.transpose() * B;
    matrix_ += 1e-5 * BendingEnergy<2>(*basis_).matrix();
    phi_ = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix_)
               .solve(rhs.transpose().eval())
               .transpose();
  }

  Vector<2> map(const Point<2>& x) const {
    const auto b = basis_->evaluate(x);
    return phi_(Eigen::all, b.control_points) * b.values;
  }
  Matrix<2> gradient(const Point<2>& x) const {
    const auto b = basis_->evaluate(x, 1);
    return phi_(Eigen::all, b.control_points) * b.gradients.transpose();
  }
  const KnotNet<2>& net() const { return basis_->net(); }

  /// Relative L2 error, on a finer grid.
  double error() const {
    double miss = 0, size = 0;
    for (const auto& x : samples(170)) {
      miss += (map(x) - truth_(x)).squaredNorm();
      size += truth_(x).squaredNorm();
    }
    return std::sqrt(miss / size);
  }

  /// Root mean square of the normal derivative's jump across the line's edges, measured a tenth of an
  /// edge to both sides: of the fit, and of the truth.
  std::pair<double, double> kink() const {
    double measured = 0, wanted = 0;
    int count = 0;
    for (const auto& edge : net().crease_edges) {
      const Point<2>&a = net().mesh.vertices[edge.vertices[0]],
            &b = net().mesh.vertices[edge.vertices[1]];
      const Vector<2> normal = Vector<2>(a[1] - b[1], b[0] - a[0]).normalized();
      const Vector<2> offset = 0.1 * (b - a).norm() * normal;
      for (double s : {0.25, 0.5, 0.75}) {
        const Point<2> x = (1 - s) * a + s * b;
        measured += ((gradient(x + offset) - gradient(x - offset)) * normal).squaredNorm();
        wanted += (slope(x + offset, normal) - slope(x - offset, normal)).squaredNorm();
        ++count;
      }
    }
    return {std::sqrt(measured / count), std::sqrt(wanted / count)};
  }
  double sharpness() const { return kink().first / kink().second; }
  /// The largest gradient jump on all other edges, relative to the kink.
  double hinge() const {
    const testing::Jumps jumps(basis_, phi_);
    return jumps.largest_on_edges([&](int a, int b) {
      return !testing::is_crease(net(), a, b);
    })[1] / kink().first;
  }
  /// Condition number of the fit's matrix with its diagonal scaled to 1.
  double condition() const {
    const Eigen::VectorXd d = matrix_.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = d.asDiagonal() * Eigen::MatrixXd(matrix_) * d.asDiagonal();
    const Eigen::VectorXd spectrum =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly)
            .eigenvalues();
    return spectrum[spectrum.size() - 1] / spectrum[0];
  }

 private:
  Vector<2> slope(const Point<2>& x, const Vector<2>& direction) const {
    return (truth_(x + 1e-6 * direction) - truth_(x - 1e-6 * direction)) / 2e-6;
  }

  std::shared_ptr<const TriangularBSplineBasis<2>> basis_;
  Truth truth_;
  Eigen::SparseMatrix<double> matrix_;
  ControlPoints<2> phi_;
};

/// The same net with all knots of its lines at the vertices: creases that are exact, and hinges.
KnotNet<2> collapsed(KnotNet<2> net) {
  for (const auto& edge : net.crease_edges) {
    for (int v : edge.vertices) std::ranges::fill(net.clouds[v], net.clouds[v][0]);
  }
  return net;
}

double largest_difference(const Fit& a, const Fit& b) {
  double largest = 0;
  for (const auto& x : samples(50)) largest = std::max(largest, (a.map(x) - b.map(x)).norm());
  return largest;
}

}  // namespace

TEST(CreaseFit, OfADiscIsSharpAndBetterThanCollapsedClouds) {
  const auto placed = place_knots(testing::disc_domain(16));
  ASSERT_EQ(placed.plan.num_crease_edges, 16);
  const Fit fanned(placed.net, kDisc), hinged(collapsed(placed.net), kDisc);
  EXPECT_GE(fanned.sharpness(), 0.95);               // 0.983
  EXPECT_LE(fanned.error(), 0.75 * hinged.error());  // 1.05e-3 of 1.86e-3
  EXPECT_LE(fanned.hinge(), 0.05);                   // below 1e-9
  EXPECT_GE(hinged.hinge(), 0.1);                    // 0.38
}

// Without a body side, on corners of both signs, on lines that end on the border, inside, or in a junction.
TEST(CreaseFit, HasNoHingesOnAnyShape) {
  const testing::RoundedRectangle box{{0.1, 0}, 0.2, 1.2, 0.9, 0.4};
  Polyline outline;
  for (int k = 0; k < 200; ++k) {  // by rays from the middle
    const double angle = 2 * std::numbers::pi * k / 200;
    double inside = 0, outside = 2;
    while (outside - inside > 1e-12) {
      const double r = 0.5 * (inside + outside);
      const Point<2> p(0.1 + r * std::cos(angle), r * std::sin(angle));
      (box.distance(p) < 0 ? inside : outside) = r;
    }
    outline.emplace_back(0.1 + inside * std::cos(angle), inside * std::sin(angle));
  }
  const auto arc = [](const Point<2>& x) -> Vector<2> {  // a kink that fades towards both ends
    const Vector<2> d = x - Point<2>(0, -0.5);
    const double t = (std::atan2(d[1], d[0]) - 0.3) / 2.3;
    const double fade = t > 0 && t < 1 ? std::pow(4 * t * (1 - t), 2) : 0.0;
    return (1 - 0.5 * fade * std::max(0.0, d.norm() - 1) * std::exp(-d.norm())) * rigid(x);
  };
  const auto junction = [](const Point<2>& x) -> Vector<2> {
    const double r = x.norm(), angle = std::atan2(x[1], x[0]) - testing::kSpiral * r;
    return (1 + 0.3 * r * std::abs(std::sin(1.5 * angle)) * std::exp(-r)) * rigid(x);
  };
  const auto near_lines = [](const std::vector<FeatureLine>& lines) {
    return testing::domain_with(lines, 0.5, 0.35);
  };
  const struct {
    const char* name;
    DomainMesh mesh;
    Truth truth;
  } cases[] = {{"disc without body", testing::disc_domain(16, BodySide::kNone), kDisc},
               {"rounded rectangle", near_lines({testing::closed_line(outline)}),
                fading([=](const Point<2>& x) { return box.distance(x); })},
               {"wavy line", near_lines({testing::wavy_line()}),
                fading([](const Point<2>& x) { return x[1] - testing::wave_height(x[0]); })},
               {"inner arc", near_lines({testing::inner_arc()}), arc},
               {"junction", near_lines(testing::spiral_junction()), junction}};
  for (const auto& c : cases) {
    const Fit fit(place_knots(c.mesh).net, c.truth);
    EXPECT_LE(fit.hinge(), 0.05) << c.name;
    EXPECT_GT(fit.kink().first, 0.01) << c.name;  // something to compare with
  }
}

TEST(CreaseFit, IsAsWellConditionedAsWithoutCreases) {
  for (const auto body : {BodySide::kAutomatic, BodySide::kNone}) {
    const auto mesh = testing::disc_domain(16, body);
    const double creased = Fit(place_knots(mesh).net, kDisc).condition();
    const double smooth = Fit(place_knots(mesh, {.creases = false}).net, kDisc).condition();
    EXPECT_LE(creased, 2 * smooth);
  }
}

TEST(CreaseFit, ReversedLinesGiveTheSame) {
  for (const auto body : {BodySide::kLeft, BodySide::kRight, BodySide::kNone}) {
    const auto line = testing::closed_line(testing::regular_polygon({0, 0}, 1, 12), body);
    const auto net = [](const FeatureLine& l) {
      return place_knots(testing::domain_with({l})).net;
    };
    EXPECT_LT(largest_difference(Fit(net(line), kDisc), Fit(net(reversed(line)), kDisc)), 1e-9);
  }
}

TEST(CreaseFit, RenumberedNetsGiveTheSame) {
  const auto net = place_knots(testing::disc_domain(12)).net;
  EXPECT_LT(largest_difference(Fit(net, kDisc), Fit(testing::renumbered(net), kDisc)), 1e-9);
}

}  // namespace crease
