#include "Transforms/Energies/QuadraticForm.h"

#include "Core/Error.h"

namespace crease {
namespace {

/// visit(slot, value) for the entries of the lower triangle.
template <typename Visit>
void for_each_slot(const Eigen::SparseMatrix<double>& matrix, const HessianPattern& pattern,
                   Visit&& visit) {
  for (int i = 0; i < matrix.cols(); ++i) {
    // Both the pattern's row and the symmetric matrix's column i list their entries in order.
    int slot = pattern.row_start()[i];
    const int end = pattern.row_start()[i + 1];
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, i); it && it.row() <= i; ++it) {
      while (slot < end && pattern.columns()[slot] < it.row()) ++slot;
      if (slot == end || pattern.columns()[slot] != it.row()) {
        slot = pattern.slot(i, static_cast<int>(it.row()));  // throws: not in the pattern
      }
      visit(slot, it.value());
    }
  }
}

}  // namespace

template <int Dim>
double QuadraticForm<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                    ControlPoints<Dim>* gradient,
                                    BlockHessian<Dim>* hessian) const {
  if (phi.cols() != matrix_.cols()) {
    throw InvalidInput(message("QuadraticForm: ", phi.cols(), " control points given, ",
                               matrix_.cols(), " expected."));
  }
  const ControlPoints<Dim> product = phi * matrix_;
  if (gradient) *gradient += scale * product;
  if (hessian) {
    for_each_slot(matrix_, hessian->pattern(), [&](int slot, double value) {
      hessian->block(slot).diagonal().array() += scale * value;
    });
  }
  return 0.5 * phi.cwiseProduct(product).sum();
}

template <int Dim>
void QuadraticForm<Dim>::add_stiffness(double scale, const HessianPattern& pattern,
                                       std::span<double> stiffness) const {
  for_each_slot(matrix_, pattern,
                [&](int slot, double value) { stiffness[slot] += scale * value; });
}

template class QuadraticForm<2>;
template class QuadraticForm<3>;

}  // namespace crease
