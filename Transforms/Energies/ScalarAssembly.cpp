#include "Transforms/Energies/ScalarAssembly.h"

#include <algorithm>

#include "Core/Parallel.h"
#include "Transforms/BlockHessian.h"

namespace crease {
namespace {

/// One patch's part of the matrix.
struct PatchMatrix {
  std::vector<int> control_points;
  Eigen::MatrixXd sum;  // lower triangle
};

Eigen::MatrixXd outer_square(const Eigen::MatrixXd& factor) {
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(factor.rows(), factor.rows());
  square.selfadjointView<Eigen::Lower>().rankUpdate(factor);
  return square;
}

/// The elements of tensor lattices are equal but for their place: their matrix is made once.
struct Template {
  Eigen::MatrixXd factor, square;
};

template <int Dim>
PatchMatrix patch_matrix(const std::vector<QuadratureElement<Dim>>& elements,
                         const PatchRange& patch, const ElementFactor<Dim>& factor,
                         const Template& first) {
  PatchMatrix result;
  result.control_points = patch.control_points;
  const auto m = std::ssize(patch.control_points);
  result.sum.setZero(m, m);
  Eigen::MatrixXd a, computed;
  for (std::size_t e = patch.begin; e < patch.end; ++e) {
    a.resize(0, 0);
    factor(elements[e], a);
    if (a.cols() == 0) continue;
    const bool known =
        a.rows() == first.factor.rows() && a.cols() == first.factor.cols() && a == first.factor;
    if (!known) computed = outer_square(a);
    const Eigen::MatrixXd& square = known ? first.square : computed;
    const auto at = patch.positions(elements[e].control_points);
    for (std::size_t k = 0; k < at.size(); ++k) {
      for (std::size_t i = k; i < at.size(); ++i) result.sum(at[i], at[k]) += square(i, k);
    }
  }
  return result;
}

Eigen::SparseMatrix<double> both_triangles(const HessianPattern& pattern,
                                           const std::vector<double>& values) {
  const int n = pattern.size();
  Eigen::SparseMatrix<double> lower(n, n);
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(values.size());
  for (int i = 0; i < n; ++i) {
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s) {
      triplets.emplace_back(i, pattern.columns()[s], values[s]);
    }
  }
  lower.setFromTriplets(triplets.begin(), triplets.end());
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace

std::vector<int> PatchRange::positions(const std::vector<int>& of_element) const {
  std::vector<int> at(of_element.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] = static_cast<int>(
        std::lower_bound(control_points.begin(), control_points.end(), of_element[i]) -
        control_points.begin());
  }
  return at;
}

template <int Dim>
std::vector<PatchRange> group_by_patch(const std::vector<QuadratureElement<Dim>>& elements) {
  std::vector<PatchRange> groups;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (e == 0 || elements[e].patch != elements[e - 1].patch) groups.push_back({e, e, {}});
    auto& group = groups.back();
    group.end = e + 1;
    group.control_points.insert(group.control_points.end(), elements[e].control_points.begin(),
                                elements[e].control_points.end());
  }
  for (auto& group : groups) {
    auto& points = group.control_points;
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
  }
  return groups;
}

template <int Dim>
void visit_quadrature(const SplineBasis<Dim>& basis, int polynomial_degree, int derivatives,
                      const std::function<bool(int region, int patch)>& wanted,
                      const std::function<void(std::vector<QuadratureElement<Dim>>&)>& visit) {
  std::vector<int> patches;
  basis.quadrature(polynomial_degree, derivatives, [&](int region, int patch) {
    if (!wanted || wanted(region, patch)) patches.push_back(patch);
    return false;
  });
  std::sort(patches.begin(), patches.end());
  constexpr std::size_t kBatch = 128;
  for (std::size_t begin = 0; begin < patches.size(); begin += kBatch) {
    const int first = patches[begin], last = patches[std::min(begin + kBatch, patches.size()) - 1];
    auto elements = basis.quadrature(polynomial_degree, derivatives, [&](int region, int patch) {
      return patch >= first && patch <= last && (!wanted || wanted(region, patch));
    });
    visit(elements);
  }
}

template <int Dim>
Eigen::SparseMatrix<double> assemble_scalar_matrix(
    const SplineBasis<Dim>& basis, int polynomial_degree, int derivatives,
    const ElementFactor<Dim>& factor, const std::function<bool(int region, int patch)>& wanted) {
  const HessianPattern& pattern = *basis.pattern();
  std::vector<double> values(static_cast<std::size_t>(pattern.num_entries()), 0.0);
  visit_quadrature<Dim>(basis, polynomial_degree, derivatives, wanted, [&](auto& elements) {
    Template first;
    factor(elements.front(), first.factor);
    first.square = outer_square(first.factor);
    const auto patches = group_by_patch(elements);
    std::vector<PatchMatrix> parts(patches.size());
    parallel_for(std::ssize(patches), [&](std::int64_t p) {
      parts[p] = patch_matrix<Dim>(elements, patches[p], factor, first);
    });
    for (const PatchMatrix& part : parts) {
      for (std::size_t i = 0; i < part.control_points.size(); ++i) {
        for (std::size_t k = 0; k <= i; ++k) {
          const double value = part.sum(i, k);
          if (value == 0) continue;
          values[pattern.slot(part.control_points[i], part.control_points[k])] += value;
        }
      }
    }
  });
  return both_triangles(pattern, values);
}

template <int Dim>
Eigen::SparseMatrix<double> mass_matrix(const SplineBasis<Dim>& basis) {
  return assemble_scalar_matrix<Dim>(
      basis, basis.product_degree(2, 0), 0,
      [](const QuadratureElement<Dim>& element, Eigen::MatrixXd& factor) {
        factor = element.values * element.weights.cwiseSqrt().asDiagonal();
      });
}

#define CREASE_INSTANTIATE(Dim)                                                                \
  template std::vector<PatchRange> group_by_patch(const std::vector<QuadratureElement<Dim>>&); \
  template void visit_quadrature(                                                              \
      const SplineBasis<Dim>&, int, int, const std::function<bool(int, int)>&,                 \
      const std::function<void(std::vector<QuadratureElement<Dim>>&)>&);                       \
  template Eigen::SparseMatrix<double> assemble_scalar_matrix(                                 \
      const SplineBasis<Dim>&, int, int, const ElementFactor<Dim>&,                            \
      const std::function<bool(int, int)>&);                                                   \
  template Eigen::SparseMatrix<double> mass_matrix(const SplineBasis<Dim>&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
