#include "Transforms/Energies/ElasticEnergy.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr int kNeoHookeanDegrees = 2;  // of the quadrature, beyond that of a quartic energy

template <int Dim>
int quadrature_degree(const SplineBasis<Dim>& basis, const ElasticMaterial& material,
                      const ElasticOptions<Dim>& options) {
  if (options.quadrature_degree >= 0) return options.quadrature_degree;
  const int quartic = basis.product_degree(4, 1);
  const bool polynomial = material.law == ElasticLaw::kStVenantKirchhoff || quartic == 0;
  return polynomial ? quartic : quartic + kNeoHookeanDegrees;
}

template <int Dim>
std::vector<GradientPatch<Dim>> patches_of(const SplineBasis<Dim>& basis,
                                           const ElasticMaterial& material,
                                           const ElasticOptions<Dim>& options) {
  if (options.quadrature == ElasticQuadrature::kCheap) {
    return gradient_patches<Dim>(cheap_elements(basis), /*keep_points=*/true);
  }
  return gradient_patches<Dim>(basis, quadrature_degree(basis, material, options), nullptr, nullptr,
                               /*keep_points=*/true);
}

/// "0, 1 and 4".
std::string listed(const std::set<int>& numbers) {
  std::ostringstream text;
  std::size_t n = 0;
  for (int number : numbers) {
    if (n > 0) text << (n + 1 == numbers.size() ? " and " : ", ");
    text << number;
    ++n;
  }
  return text.str();
}

void check_regions(const ElasticMaterial& material, const std::set<int>& present) {
  for (const auto& [region, tissue] : material.regions) {
    if (present.contains(region)) continue;
    throw InvalidInput(
        message("ElasticEnergy: the material names region ", region, ", but the domain has ",
                present == std::set<int>{-1} ? std::string("no regions")
                                             : "the regions " + listed(present) + " only",
                "; correct the label or the image of labels."));
  }
}

/// Pads the tables, which many cells may share, to rows that vectorised loops like.
class TablePadding {
 public:
  void pad(std::shared_ptr<const Eigen::MatrixXd>& table) {
    auto& padded = padded_[table];
    if (!padded) {
      Eigen::MatrixXd wider = Eigen::MatrixXd::Zero((table->rows() + 3) / 4 * 4, table->cols());
      wider.topRows(table->rows()) = *table;
      padded = std::make_shared<const Eigen::MatrixXd>(std::move(wider));
    }
    table = padded;
  }

 private:
  std::map<std::shared_ptr<const Eigen::MatrixXd>, std::shared_ptr<const Eigen::MatrixXd>> padded_;
};

/// Number of points at which two functions of a cell both have a gradient: a cell may be several small ones.
template <int Dim>
Eigen::MatrixXd shared_points(const GradientCell<Dim>& cell) {
  const Eigen::Index q = cell.weights.size();
  Eigen::MatrixXd present = Eigen::MatrixXd::Zero(cell.gradients->rows(), q);
  for (int a = 0; a < Dim; ++a) present += cell.gradients->middleCols(a * q, q).cwiseAbs();
  present = (present.array() > 0).template cast<double>();
  return present * present.transpose();
}

}  // namespace

template <int Dim>
ElasticEnergy<Dim>::ElasticEnergy(const SplineBasis<Dim>& basis, const ElasticMaterial& material,
                                  const AffineMap<Dim>& affine, const ElasticOptions<Dim>& options)
    : material_(material),
      linear_(affine.linear),
      tangent_(options.tangent),
      num_control_points_(basis.num_control_points()) {
  if constexpr (Dim == 3)
    material_.plane = PlaneState::kStrain;  // its parameters are those of space
  check_material(material_);
  if (!affine.finite()) throw InvalidInput("ElasticEnergy: the affine part is not finite.");
  set_materials(patches_of(basis, material_, options), options);
  set_slots(basis);
}

template <int Dim>
void ElasticEnergy<Dim>::set_materials(std::vector<GradientPatch<Dim>> patches,
                                       const ElasticOptions<Dim>& options) {
  std::set<int> present;
  std::map<int, LameParameters> known;
  const auto lame_of = [&](int region) {
    present.insert(region);
    const auto [found, is_new] = known.try_emplace(region);
    if (is_new) found->second = lame_parameters(material_.of(region), material_.plane);
    const LameParameters& lame = found->second;
    largest_stiffness_ = std::max(largest_stiffness_, lame.lambda + 2 * lame.mu);
    return lame;
  };
  TablePadding padding;
  for (GradientPatch<Dim>& cells : patches) {
    ElasticPatch<Dim> patch;
    for (GradientCell<Dim>& cell : cells.cells) {
      padding.pad(cell.gradients);
      std::vector<LameParameters> lame;
      if (options.region_at) {
        for (Eigen::Index p = 0; p < cell.weights.size(); ++p) {
          lame.push_back(lame_of(options.region_at(cell.points.col(p))));
          patch.mean_lambda += cell.weights[p] * lame.back().lambda;
        }
      } else {
        lame.push_back(lame_of(cells.region));
        patch.mean_lambda += cell.weights.sum() * lame.back().lambda;
      }
      patch.measure += cell.weights.sum();
      patch.lame.push_back(std::move(lame));
    }
    patch.mean_lambda /= patch.measure;
    measure_ += patch.measure;
    patch.cells = std::move(cells);
    patches_.push_back(std::move(patch));
  }
  check_regions(material_, present);
}

/// A mean dilatation couples all control points of a patch, otherwise only those that share a point.
template <int Dim>
void ElasticEnergy<Dim>::set_slots(const SplineBasis<Dim>& basis) {
  std::vector<std::vector<char>> coupled(patches_.size());
  parallel_for(std::ssize(patches_), [&](std::int64_t p) {
    const GradientPatch<Dim>& patch = patches_[p].cells;
    const auto m = std::ssize(patch.control_points);
    coupled[p].assign(m * (m + 1) / 2, material_.mean_dilatation);
    for (const GradientCell<Dim>& cell : patch.cells) {
      const Eigen::MatrixXd shared = shared_points(cell);
      for (std::size_t i = 0; i < cell.positions.size(); ++i) {
        const std::int64_t row = cell.positions[i];
        for (std::size_t k = 0; k <= i; ++k) {
          if (shared(i, k) > 0) coupled[p][row * (row + 1) / 2 + cell.positions[k]] = 1;
        }
      }
      for (std::int64_t i : cell.positions) coupled[p][i * (i + 1) / 2 + i] = 1;
    }
  });
  pattern_ = material_.mean_dilatation ? whole_patch_pattern(basis) : basis.pattern();
  slots_.resize(patches_.size());
  parallel_for(std::ssize(patches_), [&](std::int64_t p) {
    const auto& numbers = patches_[p].cells.control_points;
    for (std::size_t i = 0, n = 0; i < numbers.size(); ++i) {
      for (std::size_t k = 0; k <= i; ++k, ++n) {
        slots_[p].push_back(coupled[p][n] ? pattern_->slot(numbers[i], numbers[k]) : -1);
      }
    }
  });
}

template <int Dim>
std::shared_ptr<const HessianPattern> ElasticEnergy<Dim>::whole_patch_pattern(
    const SplineBasis<Dim>& basis) const {
  auto couplings = basis.couplings();
  for (const ElasticPatch<Dim>& patch : patches_) {
    const auto& numbers = patch.cells.control_points;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) couplings.emplace_back(numbers[k], numbers[i]);
    }
  }
  return std::make_shared<const HessianPattern>(num_control_points_, couplings);
}

template <int Dim>
double ElasticEnergy<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                    ControlPoints<Dim>* gradient,
                                    BlockHessian<Dim>* hessian) const {
  return evaluate(phi, scale, gradient, hessian, tangent_, nullptr);
}

template <int Dim>
double ElasticEnergy<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                    ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian,
                                    ElasticTangent tangent, LeastDeterminant<Dim>* least) const {
  if (phi.cols() != num_control_points_) {
    throw InvalidInput(message("ElasticEnergy: ", phi.cols(), " control points given, ",
                               num_control_points_, " expected."));
  }
  double energy = 0;
  if (least) least->value = std::numeric_limits<double>::infinity();
  add_in_order(
      std::ssize(patches_),
      [&](std::int64_t p) {
        const ControlPoints<Dim> local = phi(Eigen::all, patches_[p].cells.control_points);
        return evaluate_elastic_patch<Dim>(patches_[p], material_, linear_, local,
                                           gradient != nullptr, hessian != nullptr, tangent);
      },
      [&](std::int64_t p, const ElasticSums<Dim>& sums) {
        energy += sums.energy;
        if (least && sums.least.value < least->value) *least = sums.least;
        if (gradient) add_gradient(patches_[p].cells, sums, scale, *gradient);
        if (hessian) add_patch_hessian(p, sums, scale, *hessian);
      });
  return energy;
}

template <int Dim>
void ElasticEnergy<Dim>::add_patch_hessian(std::size_t p, const ElasticSums<Dim>& sums,
                                           double scale, BlockHessian<Dim>& hessian) const {
  if (&hessian.pattern() != pattern_.get()) {
    return add_hessian(patches_[p].cells, sums, scale, hessian);
  }
  const auto& numbers = patches_[p].cells.control_points;
  const int* slot = slots_[p].data();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k, ++slot) {
      // Control points ascend, so that this is the block of the pattern's lower triangle.
      if (*slot < 0) continue;
      hessian.block(*slot) += scale * sums.hessian.template block<Dim, Dim>(Dim * i, Dim * k);
    }
    const Matrix<Dim> lower = sums.hessian.template block<Dim, Dim>(Dim * i, Dim * i);
    const Matrix<Dim> diagonal = lower.template selfadjointView<Eigen::Lower>();
    hessian.block(*slot++) += scale * diagonal;
  }
}

template <int Dim>
double relative_tangent_difference(const ElasticEnergy<Dim>& a, const ElasticEnergy<Dim>& b) {
  const auto at_rest = [](const ElasticEnergy<Dim>& energy) {
    BlockHessian<Dim> hessian(energy.pattern());
    const auto rest = ControlPoints<Dim>::Zero(Dim, energy.pattern()->size());
    energy.evaluate(rest, 1, nullptr, &hessian, ElasticTangent::kExact, nullptr);
    const Eigen::SparseMatrix<double> lower = hessian.to_sparse();
    return Eigen::SparseMatrix<double>(lower.template selfadjointView<Eigen::Lower>());
  };
  const Eigen::SparseMatrix<double> expected = at_rest(b);
  return (at_rest(a) - expected).norm() / expected.norm();
}

template double relative_tangent_difference<2>(const ElasticEnergy<2>&, const ElasticEnergy<2>&);
template double relative_tangent_difference<3>(const ElasticEnergy<3>&, const ElasticEnergy<3>&);
template class ElasticEnergy<2>;
template class ElasticEnergy<3>;

}  // namespace crease
