#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <vector>

#include "Optimizers/LinearConstraints.h"
#include "Optimizers/RowDependencies.h"

namespace crease {

/// The free coordinates of all Phi (m x k) that satisfy C Phi = d:
///
///     Phi = N Y + Phi0,   C N = 0,   C Phi0 = d,   dE/dY = N^T dE/dPhi,   Hess_Y = N^T Hess_Phi N
///
/// with N of m x (m - rank), the same for each of the k columns. Vectors stack these matrices by rows
/// (Phi: full_size() = k m numbers, Y: reduced_size() = k (m - rank)), so that on vectors N stands for
/// N (x) I_k. Rows of C that depend on others are dropped and reported; Phi0 meets the others exactly.
///
/// Members are const but share work space: one call at a time per object. Vectors of another size are
/// refused with InvalidInput.
/// Source: registration by B-splines with landmarks, equations (3.8) to (3.10).
class NullSpace {
 public:
  virtual ~NullSpace() = default;

  Eigen::Index num_rows() const { return constraints_.C.cols(); }     ///< m
  Eigen::Index num_columns() const { return constraints_.d.cols(); }  ///< k
  Eigen::Index rank() const { return static_cast<Eigen::Index>(independent_rows_.size()); }
  Eigen::Index num_free() const { return num_rows() - rank(); }
  Eigen::Index full_size() const { return num_rows() * num_columns(); }
  Eigen::Index reduced_size() const { return num_free() * num_columns(); }
  const LinearConstraints& constraints() const { return constraints_; }
  /// Phi0, m x k.
  const RowMatrix& offset() const { return offset_; }

  /// N Y + Phi0.
  Eigen::VectorXd expand(const Eigen::Ref<const Eigen::VectorXd>& y) const;
  /// The Y whose expand() is Phi if Phi satisfies the constraints, and one near it otherwise.
  Eigen::VectorXd coordinates(const Eigen::Ref<const Eigen::VectorXd>& phi) const;
  /// N Y: a step in Phi.
  Eigen::VectorXd apply(const Eigen::Ref<const Eigen::VectorXd>& y) const;
  /// N^T G: the gradient in Y.
  Eigen::VectorXd apply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const;
  /// (N^T N)^-1 G: carries a gradient in Y to the step that is steepest in Phi.
  Eigen::VectorXd solve_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const;
  /// (N (x) I_k)^T H (N (x) I_k), lower triangle with full diagonal. Of H (compressed) only the lower
  /// triangle is read. The result's pattern depends on H's pattern only; calls with the same pattern
  /// reuse the analysis.
  void reduce_hessian(const Eigen::SparseMatrix<double>& H,
                      Eigen::SparseMatrix<double>& reduced) const;
  /// N^T K N likewise, for a scalar K (m x m) that serves every column.
  void reduce_scalar(const Eigen::SparseMatrix<double>& K,
                     Eigen::SparseMatrix<double>& reduced) const;

  /// Rows of C that make the rank, ascending, and those that depend on them.
  const std::vector<int>& independent_rows() const { return independent_rows_; }
  const std::vector<DependentRow>& dependent_rows() const { return dependent_rows_; }

 protected:
  /// Checks the constraints. @throws InvalidInput as check_constraints().
  NullSpace(LinearConstraints constraints, Eigen::Index m);
  /// To be called once by the constructor of a final class.
  void set_rows(std::vector<int> independent, std::span<const int> dependent);
  RowMatrix offset_;

 private:
  // Of apply(), apply_transpose(), solve_gram(), of coordinates() less Phi0, and of both reductions (k = 1
  // or num_columns()); sizes are checked.
  virtual Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& y) const = 0;
  virtual Eigen::VectorXd multiply_transpose(const Eigen::Ref<const Eigen::VectorXd>& g) const = 0;
  virtual Eigen::VectorXd divide_by_gram(const Eigen::Ref<const Eigen::VectorXd>& g) const = 0;
  virtual Eigen::VectorXd project(const Eigen::Ref<const Eigen::VectorXd>& step) const = 0;
  virtual void reduce(const Eigen::SparseMatrix<double>& H, Eigen::Index k,
                      Eigen::SparseMatrix<double>& reduced) const = 0;

  LinearConstraints constraints_;
  std::vector<int> independent_rows_;
  std::vector<DependentRow> dependent_rows_;
};

enum class NullSpaceKind {
  kElimination,  ///< sparse N by Gauss-Jordan elimination: the default
  kQr,           ///< orthonormal N, kept as the Householder vectors of a sparse QR factorisation
  kSvd           ///< orthonormal N, dense; knows the condition of C
};

/// @throws InvalidInput as check_constraints().
std::unique_ptr<NullSpace> make_null_space(NullSpaceKind kind, LinearConstraints constraints,
                                           Eigen::Index m);

/// Dependent rows by what is to be done with them.
struct DependentRowClasses {
  std::vector<DependentRow> redundant;      ///< |rho| <= tolerance: they follow from the others
  std::vector<DependentRow> contradictory;  ///< they cannot be met together with the others
};

/// @param tolerance  largest norm of a residual rho that counts as none, in the unit of d.
DependentRowClasses classify_dependent_rows(const NullSpace& null_space, double tolerance);

}  // namespace crease
