#include "Transforms/Splines/NurbsBasis.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "Core/Parallel.h"
#include "Transforms/GaussRule.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/NurbsWeights.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TensorBSplineGrid.h"
#include "Transforms/Splines/TensorIndex.h"

namespace crease {
namespace {

constexpr double kAffineTolerance = 1e-12;  // of the domain
constexpr int kMostExtraDegrees = 60;

template <int Dim>
NurbsNet<Dim> checked(NurbsNet<Dim> net) {
  if (net.degree < 1 || net.degree > kMaxTensorDegree) {
    throw InvalidInput(message("NurbsBasis: the degree is ", net.degree, "; it must be 1 to ",
                               kMaxTensorDegree, "."));
  }
  std::int64_t count = 1;
  for (const auto& knots : net.knots) {
    count *= std::max<std::int64_t>(0, std::ssize(knots) - net.degree - 1);
    if (count > 200'000'000) {
      throw InvalidInput("NurbsBasis: the knots ask for too many control points.");
    }
  }
  if (net.weights.size() == 0) net.weights.setOnes(count);
  if (net.weights.size() != count) {
    throw InvalidInput(message("NurbsBasis: ", net.weights.size(), " weights given for ", count,
                               " control points; give one each, or none."));
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(net.weights[i] > 0) || !std::isfinite(net.weights[i])) {
      throw InvalidInput(
          message("NurbsBasis: weight ", i, " is ", net.weights[i], "; weights must be positive."));
    }
  }
  return net;
}

template <int Dim>
std::array<KnotVector, Dim> axes_of(const NurbsNet<Dim>& net) {
  std::array<KnotVector, Dim> axes;
  for (int a = 0; a < Dim; ++a) axes[a] = KnotVector(net.degree, net.knots[a]);
  return axes;
}

template <int Dim>
ParameterBox<Dim> box_of(const NurbsNet<Dim>& net, const std::array<KnotVector, Dim>& axes) {
  ParameterBox<Dim> box{net.origin, net.direction};
  for (int a = 0; a < Dim; ++a) {
    box.lower[a] = axes[a].begin();
    box.upper[a] = axes[a].end();
  }
  box.check("NurbsBasis");
  return box;
}

/// See NurbsBasis::product_degree.
int extra_degree(double ratio) {
  const double root = std::sqrt(ratio);
  const double extra = 16 / std::log10((root + 1) / std::max(root - 1, 1e-12));
  return static_cast<int>(std::min<double>(std::ceil(extra), kMostExtraDegrees));
}

/// Whether all values and derivatives agree up to rounding.
bool alike(std::span<const BSplineSegment> a, std::span<const BSplineSegment> b) {
  constexpr double kRounding = 1e-13;
  for (const auto part :
       {&BSplineSegment::value, &BSplineSegment::first, &BSplineSegment::second}) {
    double size = 0, difference = 0;
    for (std::size_t q = 0; q < a.size(); ++q) {
      for (std::size_t r = 0; r < (a[q].*part).size(); ++r) {
        size = std::max(size, std::abs((a[q].*part)[r]));
        difference = std::max(difference, std::abs((a[q].*part)[r] - (b[q].*part)[r]));
      }
    }
    if (difference > kRounding * size) return false;
  }
  return true;
}

/// A Gauss rule on every span of an axis, with the functions at its points. Spans whose functions differ by
/// rounding only get the same bits: energies share what they make of them.
struct AxisRule {
  AxisRule(const KnotVector& axis, const GaussRule& rule, int derivatives)
      : num_points(static_cast<int>(rule.points.size())) {
    const auto count = static_cast<std::size_t>(num_points);
    std::vector<std::size_t> different;  // first entries of spans unlike each other
    for (int s = 0; s < axis.num_spans(); ++s) {
      const std::size_t begin = functions.size();
      const double length = axis.span_length(s);
      for (std::size_t q = 0; q < count; ++q) {
        points.push_back(axis.span_begin(s) + length * rule.points[q]);
        weights.push_back(length * rule.weights[q]);
        functions.push_back(length > 0 ? axis.evaluate(s, points.back(), derivatives)
                                       : BSplineSegment());
      }
      const auto of = [&](std::size_t first) { return std::span(functions).subspan(first, count); };
      const auto known = std::find_if(different.begin(), different.end(), [&](std::size_t first) {
        return alike(of(first), of(begin));
      });
      if (known == different.end()) {
        if (different.size() < 16) different.push_back(begin);
      } else {
        std::copy_n(functions.begin() + *known, count, functions.begin() + begin);
      }
    }
  }
  int num_points;
  std::vector<double> points, weights;  // span by span
  std::vector<BSplineSegment> functions;
};

template <int Dim>
void reserve_points(QuadratureElement<Dim>& element, Eigen::Index functions, int points,
                    int derivatives) {
  element.points.resize(Dim, points);
  element.weights.resize(points);
  element.values.resize(functions, points);
  if (derivatives > 0) element.gradients.assign(Dim, Eigen::MatrixXd(functions, points));
  if (derivatives > 1) {
    element.hessians.assign(kNumSecondDerivatives<Dim>, Eigen::MatrixXd(functions, points));
  }
}

}  // namespace

template <int Dim>
NurbsBasis<Dim>::NurbsBasis(NurbsNet<Dim> net, AffineMaps affine_maps)
    : net_(checked(std::move(net))),
      axes_(axes_of(net_)),
      box_(box_of<Dim>(net_, axes_)),
      functions_({{}, Point<Dim>::Zero(), Vector<Dim>::Ones(), net_.direction}, net_.degree),
      rational_(net_.weights.minCoeff() != net_.weights.maxCoeff()) {
  const auto identity = nearest_identity<Dim>(axes_, net_.weights);
  greville_ = identity.control_points;
  affine_error_ = identity.error;
  if (rational_) extra_degree_ = extra_degree(largest_change<Dim>(axes_, net_.weights));
  if (affine_maps == AffineMaps::kRequired && !reproduces_affine_maps()) {
    throw InvalidInput(
        message("NurbsBasis: with these weights no control points give the identity map; the best "
                "miss it by up to ",
                affine_error_,
                " of the domain's length. Take equal weights, or weights of a "
                "weight function of degree ",
                net_.degree - 1, " (elevated_weights)."));
  }
}

template <int Dim>
bool NurbsBasis<Dim>::reproduces_affine_maps() const {
  return affine_error_ <= kAffineTolerance;
}

template <int Dim>
std::array<int, Dim> NurbsBasis<Dim>::net_size() const {
  std::array<int, Dim> size;
  for (int a = 0; a < Dim; ++a) size[a] = axes_[a].num_functions();
  return size;
}

template <int Dim>
std::array<int, Dim> NurbsBasis<Dim>::num_spans() const {
  std::array<int, Dim> size;
  for (int a = 0; a < Dim; ++a) size[a] = axes_[a].num_spans();
  return size;
}

template <int Dim>
int NurbsBasis<Dim>::num_control_points() const {
  return static_cast<int>(net_.weights.size());
}

template <int Dim>
int NurbsBasis<Dim>::smoothness() const {
  int least = axes_[0].smoothness();
  for (const auto& axis : axes_) least = std::min(least, axis.smoothness());
  return std::min(least, net_.degree - 1);
}

template <int Dim>
double NurbsBasis<Dim>::mean_edge_length() const {
  double mean = 0;
  for (const auto& axis : axes_) {
    int count = 0;
    for (int s = 0; s < axis.num_spans(); ++s) count += axis.span_length(s) > 0;
    mean += (axis.end() - axis.begin()) / count / Dim;
  }
  return mean;
}

template <int Dim>
int NurbsBasis<Dim>::product_degree(int factors, int) const {
  return factors * net_.degree + extra_degree_;
}

template <int Dim>
void NurbsBasis<Dim>::fill_control_points(const std::array<int, Dim>& span,
                                          std::vector<int>& numbers) const {
  const auto size = net_size();
  const int corner = ravel<Dim>(span, size), n = net_.degree;
  numbers.resize(static_cast<std::size_t>(functions_.count()));
  auto* number = numbers.data();
  for (int k = 0; k <= (Dim == 3 ? n : 0); ++k) {
    for (int j = 0; j <= n; ++j) {
      const int row = corner + size[0] * (j + size[1] * k);
      for (int i = 0; i <= n; ++i) *number++ = row + i;
    }
  }
}

// R = A / W; R' = (A' - R W') / W; R'' = (A'' - R' W'^T - W' R'^T - R W'') / W, with A = w N.
template <int Dim>
void NurbsBasis<Dim>::divide_by_weight(BasisValues<Dim>& b) const {
  if (!rational_) return;
  const Eigen::VectorXd w = net_.weights(b.control_points);
  b.values.array() *= w.array();
  const double total = b.values.sum();
  b.values /= total;
  if (b.gradients.cols() == 0) return;
  b.gradients *= w.asDiagonal();
  const Vector<Dim> slope = b.gradients.rowwise().sum();
  b.gradients = (b.gradients - slope * b.values.transpose()) / total;
  if (b.hessians.cols() == 0) return;
  b.hessians *= w.asDiagonal();
  const Matrix<kNumSecondDerivatives<Dim>, 1> bend = b.hessians.rowwise().sum();
  b.hessians -= bend * b.values.transpose();
  for (int a = 0, s = 0; a < Dim; ++a) {
    for (int c = a; c < Dim; ++c, ++s) {
      b.hessians.row(s) -= slope[c] * b.gradients.row(a) + slope[a] * b.gradients.row(c);
    }
  }
  b.hessians /= total;
}

template <int Dim>
BasisValues<Dim> NurbsBasis<Dim>::evaluate(const Point<Dim>& x, int derivatives) const {
  const Vector<Dim> u = box_.inner_coordinates(x, "NurbsBasis");
  std::array<int, Dim> span;
  std::array<BSplineSegment, Dim> segments;
  for (int a = 0; a < Dim; ++a) {
    span[a] = axes_[a].find_span(u[a]);
    segments[a] = axes_[a].evaluate(span[a], u[a], derivatives);
  }
  BasisValues<Dim> result;
  fill_control_points(span, result.control_points);
  functions_.multiply(segments, derivatives, result);
  divide_by_weight(result);
  return result;
}

template <int Dim>
ControlPoints<Dim> NurbsBasis<Dim>::greville_points() const {
  if (!reproduces_affine_maps()) {
    throw InvalidInput(
        message("NurbsBasis: no control points give the identity map with these "
                "weights; the best miss it by up to ",
                affine_error_, " of the domain's length."));
  }
  return (net_.direction * greville_).colwise() + net_.origin;
}

template <int Dim>
std::vector<QuadratureElement<Dim>> NurbsBasis<Dim>::quadrature(
    int polynomial_degree, int derivatives,
    const std::function<bool(int region, int patch)>& wanted) const {
  const auto spans = num_spans();
  std::vector<int> patches;
  for (int patch = 0; patch < product<Dim>(spans); ++patch) {
    const auto span = unravel<Dim>(patch, spans);
    bool empty = false;
    for (int a = 0; a < Dim; ++a) empty = empty || !(axes_[a].span_length(span[a]) > 0);
    if (!empty && (!wanted || wanted(-1, patch))) patches.push_back(patch);
  }
  if (patches.empty()) return {};
  const GaussRule rule = gauss_rule(polynomial_degree / 2 + 1);
  std::vector<AxisRule> rules;
  for (const auto& axis : axes_) rules.emplace_back(axis, rule, derivatives);
  std::array<int, Dim> rule_size;
  rule_size.fill(static_cast<int>(rule.points.size()));

  std::vector<QuadratureElement<Dim>> elements(patches.size());
  parallel_for(std::ssize(patches), [&](std::int64_t n) {
    auto& element = elements[static_cast<std::size_t>(n)];
    element.patch = patches[static_cast<std::size_t>(n)];
    const auto span = unravel<Dim>(element.patch, spans);
    reserve_points(element, functions_.count(), product<Dim>(rule_size), derivatives);
    BasisValues<Dim> here;
    fill_control_points(span, here.control_points);
    element.control_points = here.control_points;
    std::array<BSplineSegment, Dim> segments;
    for (int q = 0; q < product<Dim>(rule_size); ++q) {
      const auto index = unravel<Dim>(q, rule_size);
      Vector<Dim> u;
      element.weights[q] = 1;
      for (int a = 0; a < Dim; ++a) {
        const auto at = static_cast<std::size_t>(span[a] * rule_size[a] + index[a]);
        u[a] = rules[a].points[at];
        element.weights[q] *= rules[a].weights[at];
        segments[a] = rules[a].functions[at];
      }
      element.points.col(q) = box_.point(u);
      functions_.multiply(segments, derivatives, here);
      divide_by_weight(here);
      element.values.col(q) = here.values;
      for (std::size_t a = 0; a < element.gradients.size(); ++a) {
        element.gradients[a].col(q) = here.gradients.row(a);
      }
      for (std::size_t s = 0; s < element.hessians.size(); ++s) {
        element.hessians[s].col(q) = here.hessians.row(s);
      }
    }
  });
  return elements;
}

template <int Dim>
std::vector<std::pair<int, int>> NurbsBasis<Dim>::couplings() const {
  // Functions overlap where knots differ between the later one's first and the earlier one's last.
  const auto size = net_size();
  const auto overlap = [&](int a, int i, int k) {
    const auto& knots = axes_[a].knots();
    return knots[std::max(i, k)] < knots[std::min(i, k) + net_.degree + 1];
  };
  std::array<int, Dim> reach;
  reach.fill(2 * net_.degree + 1);
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < num_control_points(); ++i) {
    const auto at = unravel<Dim>(i, size);
    for (int n = product<Dim>(reach) / 2; n < product<Dim>(reach); ++n) {
      auto other = unravel<Dim>(n, reach);
      bool together = true;
      for (int a = 0; a < Dim && together; ++a) {
        other[a] += at[a] - net_.degree;
        together = other[a] >= 0 && other[a] < size[a] && overlap(a, at[a], other[a]);
      }
      if (together) pairs.emplace_back(i, ravel<Dim>(other, size));
    }
  }
  return pairs;
}

template <int Dim>
std::unique_ptr<BoundGrid<Dim>> NurbsBasis<Dim>::bind(const Raster<Dim>& raster) const {
  if (TensorBSplineGrid<Dim>::can_bind(box_, raster)) {
    return std::make_unique<TensorBSplineGrid<Dim>>(
        axes_, box_, rational_ ? net_.weights : Eigen::VectorXd(), raster);
  }
  return std::make_unique<SparseRowGrid<Dim>>(*this, raster);
}

template <int Dim>
NurbsNet<Dim> covering_nurbs(const Raster<Dim>& raster, double span_length_mm, int degree) {
  const TensorLattice<Dim> lattice = covering_lattice(raster, span_length_mm);
  NurbsNet<Dim> net;
  net.degree = degree;
  net.origin = lattice.origin;
  net.direction = lattice.direction;
  for (int a = 0; a < Dim; ++a) {
    net.knots[a] =
        KnotVector::even(degree, 0.0, lattice.spans[a] * lattice.spacing[a], lattice.spans[a])
            .knots();
  }
  return net;
}

template class NurbsBasis<2>;
template class NurbsBasis<3>;
template NurbsNet<2> covering_nurbs(const Raster<2>&, double, int);
template NurbsNet<3> covering_nurbs(const Raster<3>&, double, int);

}  // namespace crease
