#include "Transforms/Energies/GradientCells.h"

#include <cstdint>
#include <cstring>
#include <unordered_map>

#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {
namespace {

/// Keeps one copy of equal tables.
class Tables {
 public:
  std::shared_ptr<const Eigen::MatrixXd> shared(Eigen::MatrixXd table) {
    const std::uint64_t key = hash(table);
    const auto [first, last] = known_.equal_range(key);
    for (auto it = first; it != last; ++it) {
      const Eigen::MatrixXd& other = *it->second;
      if (other.rows() == table.rows() && other.cols() == table.cols() && other == table) {
        return it->second;
      }
    }
    auto kept = std::make_shared<const Eigen::MatrixXd>(std::move(table));
    known_.emplace(key, kept);
    return kept;
  }

 private:
  static std::uint64_t hash(const Eigen::MatrixXd& table) {
    std::uint64_t value = 1469598103934665603U ^ static_cast<std::uint64_t>(table.rows());
    for (Eigen::Index i = 0; i < table.size(); ++i) {
      std::uint64_t bits;
      std::memcpy(&bits, table.data() + i, sizeof bits);
      value = (value ^ bits ^ (bits >> 29)) * 1099511628211U;
    }
    return value;
  }
  std::unordered_multimap<std::uint64_t, std::shared_ptr<const Eigen::MatrixXd>> known_;
};

/// Gradients of the functions at the points chosen, side by side: k x (Dim q).
template <int Dim>
Eigen::MatrixXd gathered_gradients(const QuadratureElement<Dim>& element,
                                   const std::vector<Eigen::Index>& points) {
  const auto q = std::ssize(points);
  Eigen::MatrixXd all(element.gradients[0].rows(), Dim * q);
  for (int a = 0; a < Dim; ++a) {
    for (Eigen::Index n = 0; n < q; ++n) all.col(a * q + n) = element.gradients[a].col(points[n]);
  }
  return all;
}

template <int Dim>
class PatchMaker {
 public:
  PatchMaker(const PointWeights<Dim>& weights, bool keep_points)
      : weights_(weights), keep_points_(keep_points) {}

  void add(const std::vector<QuadratureElement<Dim>>& elements,
           std::vector<GradientPatch<Dim>>& patches) {
    for (const PatchRange& group : group_by_patch(elements)) {
      GradientPatch<Dim> patch;
      patch.control_points = group.control_points;
      patch.region = elements[group.begin].region;
      patch.patch = elements[group.begin].patch;
      for (std::size_t e = group.begin; e < group.end; ++e) add_cell(elements[e], group, patch);
      if (!patch.cells.empty()) patches.push_back(std::move(patch));
    }
  }

 private:
  void add_cell(const QuadratureElement<Dim>& element, const PatchRange& group,
                GradientPatch<Dim>& patch) {
    Eigen::VectorXd w = Eigen::VectorXd::Ones(element.weights.size());
    if (weights_) weights_(element, w);
    std::vector<Eigen::Index> points;
    for (Eigen::Index q = 0; q < w.size(); ++q) {
      if (w[q] != 0) points.push_back(q);
    }
    if (points.empty()) return;
    GradientCell<Dim> cell;
    cell.positions = group.positions(element.control_points);
    cell.weights = element.weights.cwiseProduct(w)(points);
    cell.gradients = tables_.shared(gathered_gradients(element, points));
    if (keep_points_) cell.points = element.points(Eigen::all, points);
    patch.cells.push_back(std::move(cell));
  }

  const PointWeights<Dim>& weights_;
  bool keep_points_;
  Tables tables_;
};

}  // namespace

template <int Dim>
std::vector<GradientPatch<Dim>> gradient_patches(
    const SplineBasis<Dim>& basis, int quadrature_degree,
    const std::function<bool(int region, int patch)>& wanted, const PointWeights<Dim>& weights,
    bool keep_points) {
  std::vector<GradientPatch<Dim>> patches;
  PatchMaker<Dim> maker(weights, keep_points);
  visit_quadrature<Dim>(basis, quadrature_degree, 1, wanted,
                        [&](auto& elements) { maker.add(elements, patches); });
  return patches;
}

template <int Dim>
std::vector<GradientPatch<Dim>> gradient_patches(
    const std::vector<QuadratureElement<Dim>>& elements, bool keep_points) {
  std::vector<GradientPatch<Dim>> patches;
  const PointWeights<Dim> everywhere;
  PatchMaker<Dim>(everywhere, keep_points).add(elements, patches);
  return patches;
}

template <int Dim>
void PatchSums<Dim>::resize(const GradientPatch<Dim>& patch, bool with_gradient,
                            bool with_hessian) {
  const auto m = std::ssize(patch.control_points);
  if (with_gradient) gradient.setZero(Dim, m);
  if (with_hessian) hessian.setZero(Dim * m, Dim * m);
}

template <int Dim>
void add_gradient(const GradientPatch<Dim>& patch, const PatchSums<Dim>& sums, double scale,
                  ControlPoints<Dim>& gradient) {
  const auto& numbers = patch.control_points;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    gradient.col(numbers[i]) += scale * sums.gradient.col(i);
  }
}

template <int Dim>
void add_hessian(const GradientPatch<Dim>& patch, const PatchSums<Dim>& sums, double scale,
                 BlockHessian<Dim>& hessian) {
  const auto& numbers = patch.control_points;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      // Functions of one patch that share no cell do not couple.
      const Matrix<Dim> block = sums.hessian.template block<Dim, Dim>(Dim * i, Dim * k);
      if (!block.isZero(0)) hessian.add(numbers[i], numbers[k], scale * block);
    }
    const Matrix<Dim> lower = sums.hessian.template block<Dim, Dim>(Dim * i, Dim * i);
    const Matrix<Dim> diagonal = lower.template selfadjointView<Eigen::Lower>();
    hessian.add(numbers[i], numbers[i], scale * diagonal);
  }
}

#define CREASE_INSTANTIATE(Dim)                                                                   \
  template std::vector<GradientPatch<Dim>> gradient_patches(const SplineBasis<Dim>&, int,         \
                                                            const std::function<bool(int, int)>&, \
                                                            const PointWeights<Dim>&, bool);      \
  template std::vector<GradientPatch<Dim>> gradient_patches(                                      \
      const std::vector<QuadratureElement<Dim>>&, bool);                                          \
  template struct PatchSums<Dim>;                                                                 \
  template void add_gradient(const GradientPatch<Dim>&, const PatchSums<Dim>&, double,            \
                             ControlPoints<Dim>&);                                                \
  template void add_hessian(const GradientPatch<Dim>&, const PatchSums<Dim>&, double,             \
                            BlockHessian<Dim>&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
