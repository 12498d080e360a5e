#include "Transforms/Splines/KnotCellRule.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/GaussRule.h"
#include "Transforms/Splines/KnotPolygon.h"

namespace crease {
namespace {

constexpr int kMaxDegree = 20;

void add_centre(TriangleRule& rule, double weight) {
  rule.points.push_back({1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0});
  rule.weights.push_back(weight);
}

// The points (1 - 2a, a, a) and their permutations.
void add_three(TriangleRule& rule, double weight, double a) {
  for (int j = 0; j < 3; ++j) {
    std::array<double, 3> p = {a, a, a};
    p[j] = 1.0 - 2.0 * a;
    rule.points.push_back(p);
    rule.weights.push_back(weight);
  }
}

void add_six(TriangleRule& rule, double weight, double a, double b) {
  std::array<double, 3> p = {a, b, 1.0 - a - b};
  std::sort(p.begin(), p.end());
  do {
    rule.points.push_back(p);
    rule.weights.push_back(weight);
  } while (std::next_permutation(p.begin(), p.end()));
}

// x = s, y = (1 - s) t on the unit square, with the Jacobian 1 - s.
TriangleRule collapsed_square(int degree) {
  const GaussRule s = gauss_rule((degree + 3) / 2), t = gauss_rule((degree + 2) / 2);
  TriangleRule rule;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    for (std::size_t k = 0; k < t.points.size(); ++k) {
      const double x = s.points[i], y = (1.0 - x) * t.points[k];
      rule.points.push_back({1.0 - x - y, x, y});
      rule.weights.push_back(2.0 * (1.0 - x) * s.weights[i] * t.weights[k]);
    }
  }
  return rule;
}

TriangleRule make_rule(int degree) {
  TriangleRule rule;
  if (degree <= 1) {
    add_centre(rule, 1.0);
  } else if (degree == 2) {
    add_three(rule, 1.0 / 3.0, 1.0 / 6.0);
  } else if (degree <= 4) {
    add_three(rule, 0.22338158967801146569, 0.44594849091596488631);
    add_three(rule, 0.10995174365532186763, 0.09157621350977074345);
  } else if (degree == 5) {
    add_centre(rule, 0.225);
    add_three(rule, 0.13239415278850618073, 0.47014206410511508977);
    add_three(rule, 0.12593918054482715259, 0.10128650732345633880);
  } else if (degree == 6) {
    add_three(rule, 0.11678627572637936602, 0.24928674517091042129);
    add_three(rule, 0.05084490637020681692, 0.06308901449150222834);
    add_six(rule, 0.08285107561837357519, 0.31035245103378440541, 0.05314504984481694735);
  } else if (degree <= 8) {
    add_centre(rule, 0.14431560767778716825);
    add_three(rule, 0.09509163426728462479, 0.45929258829272315602);
    add_three(rule, 0.10321737053471825028, 0.17056930775176020662);
    add_three(rule, 0.03245849762319808031, 0.05054722831703097545);
    add_six(rule, 0.02723031417443499426, 0.26311282963463811342, 0.00839477740995760533);
  } else {
    rule = collapsed_square(degree);
  }
  return rule;
}

void set_three_points(const PolygonMoments& moments, CellRule& rule) {
  const Eigen::LLT<Matrix<2>> factor(moments.covariance);
  if (factor.info() != Eigen::Success) {  // a sliver without width
    rule.points.assign(1, moments.centroid);
    rule.weights.assign(1, moments.area);
    return;
  }
  const Matrix<2> root = std::sqrt(2.0) * Matrix<2>(factor.matrixL());
  const double half_root = std::sqrt(3.0) / 2.0;
  for (const Vector<2>& e :
       {Vector<2>(0.0, 1.0), Vector<2>(-half_root, -0.5), Vector<2>(half_root, -0.5)}) {
    rule.points.push_back(moments.centroid + root * e);
    rule.weights.push_back(moments.area / 3.0);
  }
}

}  // namespace

const TriangleRule& triangle_rule(int degree) {
  static const std::vector<TriangleRule> rules = [] {
    std::vector<TriangleRule> all;
    for (int d = 0; d <= kMaxDegree; ++d) all.push_back(make_rule(d));
    return all;
  }();
  if (degree < 0 || degree > kMaxDegree) {
    throw InvalidInput(
        message("triangle_rule: degree ", degree, "; ask for 0 to ", kMaxDegree, "."));
  }
  return rules[degree];
}

void set_cell_rule(std::span<const Point<2>> polygon, int degree, CellRule& rule) {
  rule.points.clear();
  rule.weights.clear();
  const TriangleRule& triangle = triangle_rule(degree);
  if (degree <= 2 && polygon.size() > 3) {
    const PolygonMoments moments = polygon_moments(polygon);
    if (degree == 2) {
      set_three_points(moments, rule);
    } else {
      rule.points.push_back(moments.centroid);
      rule.weights.push_back(moments.area);
    }
    return;
  }
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Point<2>&a = polygon[0], &b = polygon[i - 1], &c = polygon[i];
    const double area = 0.5 * cross(b - a, c - a);
    if (area <= 0.0) continue;
    for (std::size_t k = 0; k < triangle.points.size(); ++k) {
      const auto& p = triangle.points[k];
      rule.points.push_back(p[0] * a + p[1] * b + p[2] * c);
      rule.weights.push_back(area * triangle.weights[k]);
    }
  }
}

CellRule cell_rule(std::span<const Point<2>> polygon, int degree) {
  CellRule rule;
  set_cell_rule(polygon, degree, rule);
  return rule;
}

}  // namespace crease
