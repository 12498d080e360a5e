#include "Transforms/Bernstein.h"

#include <Eigen/LU>

#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/TensorBSplineSegments.h"

namespace crease {
namespace {

constexpr int kMaxDegree = 16;

double binomial(int n, int k) {
  static const auto table = [] {
    std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1> t{};
    for (int i = 0; i <= kMaxDegree; ++i) {
      t[i][0] = 1.0;
      for (int j = 1; j <= i; ++j) t[i][j] = t[i - 1][j - 1] + (j < i ? t[i - 1][j] : 0.0);
    }
    return t;
  }();
  return table[n][k];
}

template <int Dim>
const std::vector<MultiIndex<Dim>>& indices(int degree) {
  static const auto tables = [] {
    std::array<std::vector<MultiIndex<Dim>>, kMaxDegree + 1> all;
    for (int d = 0; d <= kMaxDegree; ++d) all[d] = multi_indices<Dim>(d);
    return all;
  }();
  return tables[degree];
}

/// degree! / beta!
template <int Dim>
double multinomial(const MultiIndex<Dim>& beta) {
  double value = 1.0;
  int sum = beta[0];
  for (int j = 1; j <= Dim; ++j) {
    sum += beta[j];
    value *= binomial(sum, beta[j]);
  }
  return value;
}

/// One term of a product: coefficient `sum` += weight a[first] b[second].
struct Term {
  int first, second, sum;
  double weight;
};

template <int Dim>
std::vector<Term> product_terms(int a, int b) {
  std::vector<Term> terms;
  for (const auto& alpha : indices<Dim>(a)) {
    for (const auto& beta : indices<Dim>(b)) {
      MultiIndex<Dim> sum;
      for (int j = 0; j <= Dim; ++j) sum[j] = alpha[j] + beta[j];
      terms.push_back({multi_index_position<Dim>(alpha), multi_index_position<Dim>(beta),
                       multi_index_position<Dim>(sum),
                       multinomial<Dim>(alpha) * multinomial<Dim>(beta) / multinomial<Dim>(sum)});
    }
  }
  return terms;
}

/// Of derivatives of splines, and of products of all but one of them.
constexpr int kMaxFactor = kMaxSplineDegree - 1;

template <int Dim>
const std::vector<Term>& terms_of(int a, int b) {
  static const auto tables = [] {
    std::array<std::array<std::vector<Term>, (Dim - 1) * kMaxFactor + 1>, kMaxFactor + 1> all;
    for (int i = 0; i < static_cast<int>(all.size()); ++i) {
      for (int j = 0; j < static_cast<int>(all[i].size()); ++j) {
        all[i][j] = product_terms<Dim>(i, j);
      }
    }
    return all;
  }();
  return tables[a][b];
}

template <int Dim>
Eigen::MatrixXd interpolation_matrix(int degree) {
  const auto& all = indices<Dim>(degree);
  const auto count = std::ssize(all);
  Eigen::MatrixXd values(count, count);  // of the Bernstein polynomials at the domain points
  for (Eigen::Index point = 0; point < count; ++point) {
    for (Eigen::Index function = 0; function < count; ++function) {
      double value = multinomial<Dim>(all[function]);
      for (int j = 0; j <= Dim; ++j) {
        const double lambda = degree == 0 ? 1.0 : all[point][j] / static_cast<double>(degree);
        for (int power = 0; power < all[function][j]; ++power) value *= lambda;
      }
      values(point, function) = value;
    }
  }
  return values.inverse();
}

template <int Dim>
int num_coefficients(const std::array<int, Dim>& degrees) {
  int n = 1;
  for (int d : degrees) n *= d + 1;
  return n;
}

/// Multiplies or divides by the products of binomials.
template <int Dim, typename Operation>
void scale_by_binomials(const std::array<int, Dim>& degrees, Eigen::VectorXd& coefficients,
                        Operation apply) {
  Eigen::Index n = 0;
  for (int k = 0; k <= (Dim == 3 ? degrees[Dim - 1] : 0); ++k) {
    const double in_depth = Dim == 3 ? binomial(degrees[Dim - 1], k) : 1.0;
    for (int j = 0; j <= degrees[1]; ++j) {
      const double of_row = in_depth * binomial(degrees[1], j);
      for (int i = 0; i <= degrees[0]; ++i, ++n)
        apply(coefficients[n], of_row * binomial(degrees[0], i));
    }
  }
}

}  // namespace

template <int Dim>
double BernsteinSimplex<Dim>::at_corner(int j) const {
  MultiIndex<Dim> beta{};
  beta[j] = degree_;
  return coefficients_[multi_index_position<Dim>(beta)];
}

// De Casteljau: b^0 = c, b^r_beta = (b^{r-1}_{beta + e_j} + b^{r-1}_{beta + e_k}) / 2; a half's coefficient
// takes as many steps as its index says for m.
template <int Dim>
std::pair<BernsteinSimplex<Dim>, BernsteinSimplex<Dim>> BernsteinSimplex<Dim>::split(int j,
                                                                                     int k) const {
  Eigen::VectorXd first(coefficients_.size()), second(coefficients_.size());
  Eigen::VectorXd level = coefficients_, next;
  for (int step = 0;; ++step) {
    for (auto beta : indices<Dim>(degree_ - step)) {
      const double value = level[multi_index_position<Dim>(beta)];
      if (beta[k] == 0) {
        beta[k] = step;
        first[multi_index_position<Dim>(beta)] = value;
        beta[k] = 0;
      }
      if (beta[j] == 0) {
        beta[j] = step;
        second[multi_index_position<Dim>(beta)] = value;
      }
    }
    if (step == degree_) break;
    const auto& rest = indices<Dim>(degree_ - step - 1);
    next.resize(std::ssize(rest));
    for (auto beta : rest) {
      const int at = multi_index_position<Dim>(beta);
      ++beta[j];
      next[at] = 0.5 * level[multi_index_position<Dim>(beta)];
      --beta[j];
      ++beta[k];
      next[at] += 0.5 * level[multi_index_position<Dim>(beta)];
    }
    level.swap(next);
  }
  return {{degree_, std::move(first)}, {degree_, std::move(second)}};
}

template <int Dim>
double BernsteinBox<Dim>::at_corner(int corner) const {
  int number = 0, stride = 1;
  for (int a = 0; a < Dim; ++a) {
    if (corner >> a & 1) number += stride * degrees_[a];
    stride *= degrees_[a] + 1;
  }
  return coefficients_[number];
}

template <int Dim>
std::pair<BernsteinBox<Dim>, BernsteinBox<Dim>> BernsteinBox<Dim>::split(int axis) const {
  const int count = degrees_[axis] + 1;
  int stride = 1;
  for (int a = 0; a < axis; ++a) stride *= degrees_[a] + 1;
  Eigen::VectorXd lower(coefficients_.size()), upper = coefficients_;
  const int blocks = static_cast<int>(coefficients_.size()) / (count * stride);
  for (int block = 0; block < blocks; ++block) {
    for (int offset = 0; offset < stride; ++offset) {
      double* c = upper.data() + block * count * stride + offset;
      double* low = lower.data() + block * count * stride + offset;
      for (int step = 0; step < count; ++step) {
        low[step * stride] = c[0];
        for (int i = 0; i < count - 1 - step; ++i) {
          c[i * stride] = 0.5 * (c[i * stride] + c[(i + 1) * stride]);
        }
      }
    }
  }
  return {{degrees_, std::move(lower)}, {degrees_, std::move(upper)}};
}

template <int Dim>
BernsteinSimplex<Dim> operator*(const BernsteinSimplex<Dim>& a, const BernsteinSimplex<Dim>& b) {
  if (a.degree() > b.degree()) return b * a;
  const int degree = a.degree() + b.degree();
  Eigen::VectorXd product = Eigen::VectorXd::Zero(num_multi_indices<Dim>(degree));
  for (const Term& t : terms_of<Dim>(a.degree(), b.degree())) {
    product[t.sum] += t.weight * (a.coefficients()[t.first] * b.coefficients()[t.second]);
  }
  return {degree, std::move(product)};
}

// With the binomials in the coefficients the product is a convolution.
template <int Dim>
BernsteinBox<Dim> operator*(const BernsteinBox<Dim>& a, const BernsteinBox<Dim>& b) {
  const auto &da = a.degrees(), &db = b.degrees();
  std::array<int, Dim> degrees;
  for (int axis = 0; axis < Dim; ++axis) degrees[axis] = da[axis] + db[axis];
  Eigen::VectorXd first = a.coefficients(), second = b.coefficients();
  const auto multiply = [](double& c, double factor) { c *= factor; };
  scale_by_binomials<Dim>(da, first, multiply);
  scale_by_binomials<Dim>(db, second, multiply);
  Eigen::VectorXd product = Eigen::VectorXd::Zero(num_coefficients<Dim>(degrees));
  const int deep_a = Dim == 3 ? da[Dim - 1] : 0, deep_b = Dim == 3 ? db[Dim - 1] : 0;
  for (int ka = 0; ka <= deep_a; ++ka) {
    for (int ja = 0; ja <= da[1]; ++ja) {
      const double* row_a = first.data() + (ka * (da[1] + 1) + ja) * (da[0] + 1);
      for (int kb = 0; kb <= deep_b; ++kb) {
        for (int jb = 0; jb <= db[1]; ++jb) {
          const double* row_b = second.data() + (kb * (db[1] + 1) + jb) * (db[0] + 1);
          double* row =
              product.data() + ((ka + kb) * (degrees[1] + 1) + ja + jb) * (degrees[0] + 1);
          for (int ia = 0; ia <= da[0]; ++ia) {
            for (int ib = 0; ib <= db[0]; ++ib) row[ia + ib] += row_a[ia] * row_b[ib];
          }
        }
      }
    }
  }
  scale_by_binomials<Dim>(degrees, product, [](double& c, double factor) { c /= factor; });
  return {degrees, std::move(product)};
}

template <int Dim>
std::vector<Point<Dim>> domain_points(const std::array<Point<Dim>, Dim + 1>& corners, int degree) {
  std::vector<Point<Dim>> points;
  for (const auto& beta : indices<Dim>(degree)) {
    Point<Dim> x = Point<Dim>::Zero();
    for (int j = 0; j <= Dim; ++j) {
      x += (degree == 0 ? 1.0 / (Dim + 1) : beta[j] / static_cast<double>(degree)) * corners[j];
    }
    points.push_back(x);
  }
  return points;
}

template <int Dim>
const Eigen::MatrixXd& coefficients_from_values(int degree) {
  static const auto tables = [] {
    std::array<Eigen::MatrixXd, kMaxSplineDegree + 1> all;
    for (int d = 0; d <= kMaxSplineDegree; ++d) all[d] = interpolation_matrix<Dim>(d);
    return all;
  }();
  return tables[degree];
}

// b_k = sum_t C(k, t) / C(degree, t) a_t with the coefficients a_t of powers.
const Eigen::MatrixXd& bernstein_from_bspline(int degree) {
  static const auto tables = [] {
    std::array<Eigen::MatrixXd, kMaxTensorDegree + 1> all;
    for (int d = 0; d <= kMaxTensorDegree; ++d) {
      all[d].setZero(d + 1, d + 1);
      const BSplinePolynomials powers = bspline_polynomials(d);
      for (int k = 0; k <= d; ++k) {
        for (int r = 0; r <= d; ++r) {
          for (int t = 0; t <= k; ++t) {
            all[d](k, r) += binomial(k, t) / binomial(d, t) * powers[t][r];
          }
        }
      }
    }
    return all;
  }();
  return tables[degree];
}

#define CREASE_INSTANTIATE(Dim)                                                                  \
  template class BernsteinSimplex<Dim>;                                                          \
  template class BernsteinBox<Dim>;                                                              \
  template BernsteinSimplex<Dim> operator*                                                       \
      <Dim>(const BernsteinSimplex<Dim>&, const BernsteinSimplex<Dim>&);                         \
  template BernsteinBox<Dim> operator*<Dim>(const BernsteinBox<Dim>&, const BernsteinBox<Dim>&); \
  template std::vector<Point<Dim>> domain_points<Dim>(const std::array<Point<Dim>, Dim + 1>&,    \
                                                      int);                                      \
  template const Eigen::MatrixXd& coefficients_from_values<Dim>(int);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
