#include "Transforms/Energies/FoldingEnergy.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {
namespace {

/// d det F / dF.
Matrix<2> cofactors(const Matrix<2>& f) {
  Matrix<2> c;
  c << f(1, 1), -f(1, 0), -f(0, 1), f(0, 0);
  return c;
}
Matrix<3> cofactors(const Matrix<3>& f) {
  Matrix<3> c;
  c << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
  return c;
}

void check_threshold(double threshold) {
  if (threshold > 0) return;
  throw InvalidInput(
      message("FoldingEnergy: the threshold is ", threshold, "; it must be positive."));
}

bool same_tables(const std::vector<Eigen::MatrixXd>& a, const std::vector<Eigen::MatrixXd>& b) {
  return std::ranges::equal(a, b, [](const auto& m, const auto& n) {
    return m.rows() == n.rows() && m.cols() == n.cols() && m == n;
  });
}

}  // namespace

/// What one element adds.
template <int Dim>
struct FoldingEnergy<Dim>::Part {
  double energy = 0;
  ControlPoints<Dim> gradient;  // empty where the element adds nothing
  Eigen::MatrixXd hessian;      // lower triangle, likewise

  Part& operator+=(const Part& other) {
    energy += other.energy;
    return *this;
  }
};

template <int Dim>
FoldingEnergy<Dim>::FoldingEnergy(const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine,
                                  const FoldingOptions& options)
    : threshold_(options.threshold),
      linear_(affine.linear),
      num_control_points_(basis.num_control_points()) {
  check_threshold(threshold_);
  if (!affine.finite()) throw InvalidInput("FoldingEnergy: the affine part is not finite.");
  const int degree = options.quadrature_degree >= 0 ? options.quadrature_degree
                                                    : std::max(2, basis.product_degree(2, 2));
  visit_quadrature<Dim>(basis, degree, 1, options.wanted, [&](auto& elements) {
    for (auto& element : elements) {
      measure_ += element.weights.sum();
      const bool known =
          !elements_.empty() && same_tables(*elements_.back().gradients, element.gradients);
      elements_.push_back({std::move(element.control_points), std::move(element.weights),
                           known ? elements_.back().gradients
                                 : std::make_shared<const std::vector<Eigen::MatrixXd>>(
                                       std::move(element.gradients))});
    }
  });
}

template <int Dim>
FoldingEnergy<Dim> FoldingEnergy<Dim>::with_threshold(double threshold) const {
  check_threshold(threshold);
  FoldingEnergy other = *this;
  other.threshold_ = threshold;
  return other;
}

/// Those of F, by point.
template <int Dim>
std::array<ControlPoints<Dim>, Dim> FoldingEnergy<Dim>::columns(
    const Element& element, const ControlPoints<Dim>& local) const {
  std::array<ControlPoints<Dim>, Dim> columns;
  for (int a = 0; a < Dim; ++a) {
    columns[a].noalias() = local * (*element.gradients)[a];
    columns[a].colwise() += linear_.col(a);
  }
  return columns;
}

template <int Dim>
double FoldingEnergy<Dim>::least_determinant(
    const Eigen::Ref<const ControlPoints<Dim>>& phi) const {
  std::vector<double> least(elements_.size(), std::numeric_limits<double>::infinity());
  parallel_for(std::ssize(elements_), [&](std::int64_t n) {
    const Element& element = elements_[n];
    const auto columns = this->columns(element, phi(Eigen::all, element.control_points));
    for (Eigen::Index q = 0; q < element.weights.size(); ++q) {
      Matrix<Dim> f;
      for (int a = 0; a < Dim; ++a) f.col(a) = columns[a].col(q);
      least[n] = std::min(least[n], f.determinant());
    }
  });
  return least.empty() ? std::numeric_limits<double>::infinity() : *std::ranges::min_element(least);
}

template <int Dim>
typename FoldingEnergy<Dim>::Part FoldingEnergy<Dim>::evaluate_element(
    const Element& element, const Eigen::Ref<const ControlPoints<Dim>>& phi, bool with_gradient,
    bool with_hessian) const {
  const ControlPoints<Dim> local = phi(Eigen::all, element.control_points);
  const auto columns = this->columns(element, local);
  Part part;
  const Eigen::Index k = local.cols();
  for (Eigen::Index q = 0; q < element.weights.size(); ++q) {
    Matrix<Dim> f;
    for (int a = 0; a < Dim; ++a) f.col(a) = columns[a].col(q);
    const double s = 1 - f.determinant() / threshold_, w = element.weights[q];
    if (!(s > 0)) {
      if (std::isnan(s)) part.energy = s;
      continue;
    }
    part.energy += w * s * s * s * s;
    if (!with_gradient && !with_hessian) continue;
    ControlPoints<Dim> slopes(Dim, k);  // of det F: cof F grad B_i
    Matrix<Dim> cofactor = cofactors(f);
    slopes.noalias() = cofactor.col(0) * (*element.gradients)[0].col(q).transpose();
    for (int a = 1; a < Dim; ++a) {
      slopes.noalias() += cofactor.col(a) * (*element.gradients)[a].col(q).transpose();
    }
    if (with_gradient) {
      if (part.gradient.size() == 0) part.gradient.setZero(Dim, k);
      part.gradient -= 4 * w * s * s * s / threshold_ * slopes;
    }
    if (with_hessian) {
      if (part.hessian.size() == 0) part.hessian.setZero(Dim * k, Dim * k);
      part.hessian.template selfadjointView<Eigen::Lower>().rankUpdate(
          slopes.reshaped(), 12 * w * s * s / (threshold_ * threshold_));
    }
  }
  return part;
}

template <int Dim>
double FoldingEnergy<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                    ControlPoints<Dim>* gradient,
                                    BlockHessian<Dim>* hessian) const {
  if (phi.cols() != num_control_points_) {
    throw InvalidInput(message("FoldingEnergy: ", phi.cols(), " control points given, ",
                               num_control_points_, " expected."));
  }
  constexpr std::size_t kChunk = 1024;  // elements whose matrices wait to be added in order
  double energy = 0;
  for (std::size_t begin = 0; begin < elements_.size(); begin += kChunk) {
    std::vector<Part> parts(std::min(kChunk, elements_.size() - begin));
    parallel_for(std::ssize(parts), [&](std::int64_t n) {
      parts[n] =
          evaluate_element(elements_[begin + n], phi, gradient != nullptr, hessian != nullptr);
    });
    for (std::size_t n = 0; n < parts.size(); ++n) {
      const Part& part = parts[n];
      const auto& numbers = elements_[begin + n].control_points;
      energy += part.energy;
      for (Eigen::Index i = 0; gradient && i < part.gradient.cols(); ++i) {
        gradient->col(numbers[i]) += scale * part.gradient.col(i);
      }
      for (Eigen::Index i = 0; hessian && i < part.hessian.rows() / Dim; ++i) {
        for (Eigen::Index j = 0; j < i; ++j) {
          // Functions of one element that share no cell do not couple.
          const Matrix<Dim> block = part.hessian.template block<Dim, Dim>(Dim * i, Dim * j);
          if (!block.isZero(0)) hessian->add(numbers[i], numbers[j], scale * block);
        }
        const Matrix<Dim> lower = part.hessian.template block<Dim, Dim>(Dim * i, Dim * i);
        const Matrix<Dim> diagonal = lower.template selfadjointView<Eigen::Lower>();
        hessian->add(numbers[i], numbers[i], scale * diagonal);
      }
    }
  }
  return energy;
}

template class FoldingEnergy<2>;
template class FoldingEnergy<3>;

}  // namespace crease
