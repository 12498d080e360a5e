#include "Transforms/Splines/BPatch.h"

#include <algorithm>

#include "Transforms/Splines/KnotPolygon.h"
#include "Transforms/Splines/SimplexSpline.h"

namespace crease {
namespace {

// Sides through the facet opposite to corner d, every choice of used knots once.
template <int Dim>
void append_sides(const typename BPatch<Dim>::Clouds& clouds, int degree, int d,
                  std::vector<KnotPlane<Dim>>& sides) {
  const int last = std::max(0, degree - 1);
  for (const auto& beta : multi_indices<Dim>(degree)) {
    // beta_d absorbs what the facet's knots leave over, so that every i + j (+ k) <= n comes up once.
    std::array<Point<Dim>, Dim + 1> corners;
    bool used = true;
    for (int j = 0; j <= Dim; ++j) {
      if (j != d && beta[j] > last) used = false;
      corners[j] = j == d || !used ? clouds[d][0] : clouds[j][beta[j]];
    }
    if (!used) continue;
    const Vector<Dim> inwards = barycentric_gradients<Dim>(corners).col(d).normalized();
    sides.push_back({inwards, inwards.dot(corners[d == 0 ? 1 : 0])});
  }
}

// Place of the monomial X^m X_a.
template <int Dim>
int raised(const std::array<int, Dim>& exponents, int a) {
  MultiIndex<Dim> m{};
  for (int b = 0; b < Dim; ++b) m[b + 1] = exponents[b] + (a == b);
  return multi_index_position<Dim>(m);
}

}  // namespace

template <int Dim>
std::vector<KnotPlane<Dim>> core_sides(const typename BPatch<Dim>::Clouds& clouds, int degree) {
  std::vector<KnotPlane<Dim>> sides;
  for (int d = 0; d <= Dim; ++d) append_sides<Dim>(clouds, std::max(1, degree), d, sides);
  return sides;
}

std::vector<Point<2>> core_polygon(const BPatch<2>::Clouds& clouds, int degree) {
  KnotPolygon polygon = {clouds[0][0], clouds[1][0], clouds[2][0]};
  for (const auto& side : core_sides<2>(clouds, degree)) polygon = clip(polygon, side);
  return polygon;
}

template <int Dim>
Eigen::MatrixXd bpatch_power_form(const typename BPatch<Dim>::Clouds& clouds, int degree,
                                  const Point<Dim>& centre, double size) {
  const int count = num_multi_indices<Dim>(degree);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(count, 1);
  weights(0, 0) = 1.0;
  for (int level = 0; level < degree; ++level) {
    Eigen::MatrixXd next = Eigen::MatrixXd::Zero(count, num_multi_indices<Dim>(level + 1));
    for (const auto& beta : multi_indices<Dim>(level)) {
      std::array<Point<Dim>, Dim + 1> corners;
      for (int j = 0; j <= Dim; ++j) corners[j] = clouds[j][beta[j]];
      const auto gradients = barycentric_gradients<Dim>(corners);
      const auto w = weights.col(multi_index_position<Dim>(beta));
      for (int j = 0; j <= Dim; ++j) {
        MultiIndex<Dim> child = beta;
        ++child[j];
        auto target = next.col(multi_index_position<Dim>(child));
        const Vector<Dim> slope = size * gradients.col(j);
        const double constant = gradients.col(j).dot(centre - corners[j == 0 ? 1 : 0]);
        for (int m = 0; m < num_multi_indices<Dim>(level); ++m) {
          target[m] += constant * w[m];
          for (int a = 0; a < Dim; ++a)
            target[raised<Dim>(kMonomials<Dim>[m], a)] += slope[a] * w[m];
        }
      }
    }
    weights = std::move(next);
  }
  return weights;
}

template <int Dim>
BPatch<Dim>::BPatch(const Clouds& clouds, int degree)
    : degree_(degree), core_sides_(crease::core_sides<Dim>(clouds, degree)) {
  centre_.setZero();
  double longest = 0.0;
  for (int j = 0; j <= Dim; ++j) {
    centre_ += clouds[j][0] / (Dim + 1);
    for (int k = 0; k < j; ++k) longest = std::max(longest, (clouds[j][0] - clouds[k][0]).norm());
  }
  size_ = longest;
  matrix_ = bpatch_power_form<Dim>(clouds, degree, centre_, size_);
  if constexpr (Dim == 2) {
    const KnotPolygon polygon = core_polygon(clouds, degree);
    std::erase_if(core_sides_, [&](const KnotPlane<2>& side) {
      return std::none_of(polygon.begin(), polygon.end(),
                          [&](const Point<2>& p) { return side.distance(p) <= 1e-9 * size_; });
    });
  }
}

template <int Dim>
bool BPatch<Dim>::in_core(const Point<Dim>& u, double tie) const {
  for (const auto& side : core_sides_) {
    if (!(side.distance(u) >= -tie)) return false;
  }
  return !core_sides_.empty();
}

template <int Dim>
typename BPatch<Dim>::Jets BPatch<Dim>::evaluate(const Point<Dim>& u, int derivatives) const {
  // Powers of each local coordinate with their derivatives by u: [coordinate][order][exponent].
  double power[Dim][3][kMaxSplineDegree + 1] = {};
  const double slope = 1.0 / size_;
  for (int a = 0; a < Dim; ++a) {
    const double x = slope * (u[a] - centre_[a]);
    power[a][0][0] = 1.0;
    for (int k = 1; k <= degree_; ++k) {
      power[a][0][k] = power[a][0][k - 1] * x;
      power[a][1][k] = slope * k * power[a][0][k - 1];
      power[a][2][k] = slope * k * power[a][1][k - 1];
    }
  }
  const auto product = [&](const std::array<int, Dim>& m, const std::array<int, Dim>& order) {
    double result = 1.0;
    for (int a = 0; a < Dim; ++a) result *= power[a][order[a]][m[a]];
    return result;
  };
  Jets monomials(matrix_.rows(), derivatives == 0   ? 1
                                 : derivatives == 1 ? 1 + Dim
                                                    : 1 + Dim + kNumSecondDerivatives<Dim>);
  for (Eigen::Index row = 0; row < matrix_.rows(); ++row) {
    const auto& m = kMonomials<Dim>[row];
    monomials(row, 0) = product(m, {});
    for (int a = 0; a < Dim && derivatives > 0; ++a) {
      std::array<int, Dim> order{};
      ++order[a];
      monomials(row, 1 + a) = product(m, order);
      for (int b = a; b < Dim && derivatives > 1; ++b) {
        auto both = order;
        ++both[b];
        monomials(row, 1 + Dim + second_derivative_index<Dim>(a, b)) = product(m, both);
      }
    }
  }
  return matrix_.transpose().lazyProduct(monomials);
}

template class BPatch<2>;
template class BPatch<3>;
template Eigen::MatrixXd bpatch_power_form<2>(const BPatch<2>::Clouds&, int, const Point<2>&,
                                              double);
template Eigen::MatrixXd bpatch_power_form<3>(const BPatch<3>::Clouds&, int, const Point<3>&,
                                              double);
template std::vector<KnotPlane<2>> core_sides<2>(const BPatch<2>::Clouds&, int);
template std::vector<KnotPlane<3>> core_sides<3>(const BPatch<3>::Clouds&, int);

}  // namespace crease
