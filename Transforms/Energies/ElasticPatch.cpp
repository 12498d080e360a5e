#include "Transforms/Energies/ElasticPatch.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "Core/Cpu.h"
#include "Transforms/Energies/ElasticKernels.h"

namespace crease {
namespace {

template <int Dim>
constexpr int kNumPairs = Dim*(Dim + 1) / 2;

int padded_to_four(Eigen::Index count) { return static_cast<int>((count + 3) / 4 * 4); }

/// The kernels that suit the processor.
template <int Dim>
struct Kernels {
  void (*deformation)(const ElasticCell&);
  void (*dilatation)(const ElasticCell&);
  void (*stress)(const ElasticCell&);
  void (*forces)(const ElasticCell&, double*);
  void (*hessian)(const ElasticCell&, double*);
};

template <int Dim>
const Kernels<Dim>& kernels() {
  static const Kernels<Dim> chosen = [] {
    if constexpr (Dim == 2) {
      return cpu_has_avx2() ? Kernels<2>{avx2::elastic_deformation_2, avx2::elastic_dilatation_2,
                                         avx2::elastic_stress_2, avx2::elastic_forces_2,
                                         avx2::elastic_hessian_2}
                            : Kernels<2>{baseline::elastic_deformation_2,
                                         baseline::elastic_dilatation_2, baseline::elastic_stress_2,
                                         baseline::elastic_forces_2, baseline::elastic_hessian_2};
    } else {
      return cpu_has_avx2() ? Kernels<3>{avx2::elastic_deformation_3, avx2::elastic_dilatation_3,
                                         avx2::elastic_stress_3, avx2::elastic_forces_3,
                                         avx2::elastic_hessian_3}
                            : Kernels<3>{baseline::elastic_deformation_3,
                                         baseline::elastic_dilatation_3, baseline::elastic_stress_3,
                                         baseline::elastic_forces_3, baseline::elastic_hessian_3};
    }
  }();
  return chosen;
}

/// Arrays for one cell at a time, kept by each thread.
struct Workspace {
  std::vector<double> phi, products, deformation, determinant, weight, lambda, mu, energy, stress,
      tangent, pivot, forces, hessian;
};

double* sized(std::vector<double>& array, int size) {
  if (std::ssize(array) < size) array.resize(size);
  return array.data();
}

/// The positive semi-definite part of a symmetric matrix.
template <int Size>
Matrix<Size> positive_part(const Matrix<Size>& matrix) {
  Eigen::SelfAdjointEigenSolver<Matrix<Size>> eigen;
  if constexpr (Size == 2) {
    eigen.computeDirect(matrix);
  } else {
    eigen.compute(matrix);
  }
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Of the tangent dP_as/dF_bt of an isotropic law. In the plane it falls into two blocks of 2 x 2 in the basis
/// u_i v_j^T of F = sum_i sigma_i u_i v_i^T: stretches i = j, and shears i != j.
template <int Dim>
Matrix<Dim * Dim> semidefinite_part(const Matrix<Dim * Dim>& tangent, const Matrix<Dim>& F) {
  if constexpr (Dim == 3) {
    return positive_part<9>(tangent);
  } else {
    const double left = std::atan2(F(1, 0) + F(0, 1), F(0, 0) - F(1, 1)),
                 right = std::atan2(F(1, 0) - F(0, 1), F(0, 0) + F(1, 1));
    const double of_u = 0.5 * (left + right), of_v = 0.5 * (left - right);
    Matrix<2> U, V;
    U << std::cos(of_u), -std::sin(of_u), std::sin(of_u), std::cos(of_u);
    V << std::cos(of_v), -std::sin(of_v), std::sin(of_v), std::cos(of_v);
    Matrix<4> Q;  // columns u_0 v_0^T, u_1 v_1^T, u_0 v_1^T, u_1 v_0^T, entries by rows
    constexpr int kFirst[] = {0, 1, 0, 1}, kSecond[] = {0, 1, 1, 0};
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) Q(r, c) = U(r / 2, kFirst[c]) * V(r % 2, kSecond[c]);
    }
    const Matrix<4> turned = Q.transpose() * tangent * Q;
    Matrix<4> part = Matrix<4>::Zero();
    part.topLeftCorner<2, 2>() = positive_part<2>(turned.topLeftCorner<2, 2>());
    part.bottomRightCorner<2, 2>() = positive_part<2>(turned.bottomRightCorner<2, 2>());
    return Q * part * Q.transpose();
  }
}

template <int Dim>
class PatchEvaluation {
 public:
  PatchEvaluation(const ElasticPatch<Dim>& patch, const ElasticMaterial& material,
                  const Matrix<Dim>& linear, const ControlPoints<Dim>& phi, bool with_gradient,
                  bool with_hessian, ElasticTangent tangent)
      : patch_(patch),
        material_(material),
        linear_(linear),
        phi_(phi),
        with_gradient_(with_gradient),
        with_hessian_(with_hessian),
        tangent_(tangent) {
    sums_.resize(patch.cells, with_gradient, with_hessian);
    sums_.least = {std::numeric_limits<double>::infinity(), Point<Dim>::Zero(), patch.cells.region};
  }

  ElasticSums<Dim> run() {
    if (material_.mean_dilatation) add_mean_dilatation();
    for (std::size_t c = 0; c < patch_.cells.cells.size(); ++c) add_cell(c);
    return std::move(sums_);
  }

 private:
  void prepare(std::size_t c);
  void add_cell(std::size_t c);
  void add_mean_dilatation();
  void add_forces(ControlPoints<Dim>& sum);
  void find_least_determinant(const GradientCell<Dim>& cell);
  void make_semidefinite();
  void add_hessian(const std::vector<int>& positions);
  const std::vector<int>& positions(std::size_t c) const { return patch_.cells.cells[c].positions; }

  const ElasticPatch<Dim>& patch_;
  const ElasticMaterial& material_;
  const Matrix<Dim> linear_;
  const ControlPoints<Dim>& phi_;
  bool with_gradient_, with_hessian_;
  ElasticTangent tangent_;
  double dilatation_slope_ = 0;
  std::size_t current_ = 0;
  ElasticCell at_{};
  Eigen::Matrix<double, Dim, Dim, Eigen::RowMajor> linear_rows_;
  ElasticSums<Dim> sums_;
};

thread_local Workspace workspace;

/// Loads a cell and evaluates F there.
template <int Dim>
void PatchEvaluation<Dim>::prepare(std::size_t c) {
  const GradientCell<Dim>& cell = patch_.cells.cells[c];
  const int q = static_cast<int>(cell.weights.size()), k = static_cast<int>(cell.positions.size());
  const int n = padded_to_four(q), w = static_cast<int>(cell.gradients->rows());
  Workspace& space = workspace;
  current_ = c;
  linear_rows_ = linear_;
  double* phi = sized(space.phi, Dim * w);
  double* weight = sized(space.weight, n);
  double* lambda = sized(space.lambda, n);
  double* mu = sized(space.mu, n);
  for (int a = 0; a < Dim; ++a) {
    for (int i = 0; i < w; ++i) phi[a * w + i] = i < k ? phi_(a, cell.positions[i]) : 0.0;
  }
  const auto& lame = patch_.lame[c];
  for (int p = 0; p < n; ++p) {
    const LameParameters& of_point = lame[lame.size() == 1 || p >= q ? 0 : p];
    weight[p] = p < q ? cell.weights[p] : 0.0;
    lambda[p] = of_point.lambda;
    mu[p] = of_point.mu;
  }
  at_ = {.num_points = q,
         .stride = n,
         .num_functions = k,
         .width = w,
         .gradients = cell.gradients->data(),
         .phi = phi,
         .linear = linear_rows_.data(),
         .weight = weight,
         .lambda = lambda,
         .mu = mu,
         .neo_hookean = material_.law == ElasticLaw::kNeoHookean,
         .mean_dilatation = material_.mean_dilatation,
         .dilatation_slope = dilatation_slope_,
         .deformation = sized(space.deformation, Dim * Dim * n),
         .determinant = sized(space.determinant, n),
         .energy = sized(space.energy, n),
         .stress = sized(space.stress, Dim * Dim * n),
         .tangent = with_hessian_ ? sized(space.tangent, kNumPairs<Dim> * Dim * Dim * n) : nullptr,
         .pivot = sized(space.pivot, n),
         .products = sized(space.products, Dim * q * w)};
  kernels<Dim>().deformation(at_);
}

template <int Dim>
void PatchEvaluation<Dim>::add_cell(std::size_t c) {
  prepare(c);
  find_least_determinant(patch_.cells.cells[c]);
  kernels<Dim>().stress(at_);
  for (int p = 0; p < at_.num_points; ++p) sums_.energy += at_.energy[p];
  if (with_gradient_) add_forces(sums_.gradient);
  if (!with_hessian_) return;
  if (tangent_ == ElasticTangent::kSemidefinite) make_semidefinite();
  add_hessian(positions(c));
}

template <int Dim>
void PatchEvaluation<Dim>::add_forces(ControlPoints<Dim>& sum) {
  double* forces = sized(workspace.forces, Dim * at_.width);
  std::fill(forces, forces + Dim * at_.width, 0.0);
  kernels<Dim>().forces(at_, forces);
  const auto& at = positions(current_);
  for (int i = 0; i < at_.num_functions; ++i) {
    for (int a = 0; a < Dim; ++a) sum(a, at[i]) += forces[a * at_.width + i];
  }
}

/// Energy of the patch's mean dilatation m, V lambda/2 g(m)^2 with g(m) = m or ln m, and what its second
/// derivative has beside that of m itself.
template <int Dim>
void PatchEvaluation<Dim>::add_mean_dilatation() {
  double total = 0;
  ControlPoints<Dim> derivative = ControlPoints<Dim>::Zero(Dim, phi_.cols());
  for (std::size_t c = 0; c < patch_.cells.cells.size(); ++c) {
    prepare(c);
    kernels<Dim>().dilatation(at_);
    for (int p = 0; p < at_.num_points; ++p) total += at_.energy[p];
    if (with_hessian_) add_forces(derivative);
  }
  const double V = patch_.measure, lambda = patch_.mean_lambda, m = total / V;
  double g = m, slope = 1, bend = 0;  // g, g', g''
  if (material_.law == ElasticLaw::kNeoHookean) {
    if (!(m > 0)) {
      sums_.energy = std::numeric_limits<double>::infinity();
      return;
    }
    g = std::log(m);
    slope = 1 / m;
    bend = -slope * slope;
  }
  sums_.energy += 0.5 * V * lambda * g * g;
  dilatation_slope_ = lambda * g * slope;
  if (!with_hessian_) return;
  double factor = lambda * (slope * slope + g * bend) / V;
  if (tangent_ == ElasticTangent::kSemidefinite) factor = std::max(factor, 0.0);
  const Eigen::VectorXd column = derivative.reshaped();
  sums_.hessian.template triangularView<Eigen::Lower>() += factor * column * column.transpose();
}

template <int Dim>
void PatchEvaluation<Dim>::find_least_determinant(const GradientCell<Dim>& cell) {
  for (int p = 0; p < at_.num_points; ++p) {
    if (at_.determinant[p] >= sums_.least.value) continue;
    sums_.least.value = at_.determinant[p];
    sums_.least.place = cell.points.col(p);
  }
}

/// Replaces the tangent at points where it is not positive semi-definite by its part that is.
template <int Dim>
void PatchEvaluation<Dim>::make_semidefinite() {
  constexpr double kRounding = 1e-12;
  constexpr int kSize = Dim * Dim;
  const auto entry = [&](int pair, int s, int t, int p) -> double& {
    return at_.tangent[((pair * Dim + s) * Dim + t) * at_.stride + p];
  };
  const auto for_each_entry = [&](const auto& visit) {
    for (int a = 0, pair = 0; a < Dim; ++a) {
      for (int b = a; b < Dim; ++b, ++pair) {
        for (int s = 0; s < Dim; ++s) {
          for (int t = 0; t < Dim; ++t) visit(pair, a, b, s, t);
        }
      }
    }
  };
  for (int p = 0; p < at_.num_points; ++p) {
    if (at_.pivot[p] >= -kRounding) continue;
    Matrix<kSize> tangent;
    for_each_entry([&](int pair, int a, int b, int s, int t) {
      tangent(Dim * a + s, Dim * b + t) = entry(pair, s, t, p);
      tangent(Dim * b + t, Dim * a + s) = entry(pair, s, t, p);
    });
    Matrix<Dim> F;
    for (int r = 0; r < kSize; ++r) F(r / Dim, r % Dim) = at_.deformation[r * at_.stride + p];
    const Matrix<kSize> part = semidefinite_part<Dim>(tangent, F);
    for_each_entry([&](int pair, int a, int b, int s, int t) {
      entry(pair, s, t, p) = part(Dim * a + s, Dim * b + t);
    });
  }
}

template <int Dim>
void PatchEvaluation<Dim>::add_hessian(const std::vector<int>& positions) {
  const int w = at_.width, k = at_.num_functions;
  double* hessian = sized(workspace.hessian, kNumPairs<Dim> * w * w);
  kernels<Dim>().hessian(at_, hessian);
  // Positions ascend, so the lower triangle stays the lower one.
  for (int a = 0, pair = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++pair) {
      const double* rows = hessian + pair * w * w;  // (i, k): a of i with b of k
      for (int j = 0; j < k; ++j) {
        double* column = &sums_.hessian(0, Dim * positions[j] + b) + a;
        for (int i = j; i < k; ++i) column[Dim * positions[i]] += rows[i * w + j];
        if (a == b) continue;
        column = &sums_.hessian(0, Dim * positions[j] + a) + b;
        for (int i = j; i < k; ++i) column[Dim * positions[i]] += rows[j * w + i];
      }
    }
  }
}

}  // namespace

template <int Dim>
ElasticSums<Dim> evaluate_elastic_patch(const ElasticPatch<Dim>& patch,
                                        const ElasticMaterial& material, const Matrix<Dim>& linear,
                                        const ControlPoints<Dim>& phi, bool with_gradient,
                                        bool with_hessian, ElasticTangent tangent) {
  return PatchEvaluation<Dim>(patch, material, linear, phi, with_gradient, with_hessian, tangent)
      .run();
}

template ElasticSums<2> evaluate_elastic_patch<2>(const ElasticPatch<2>&, const ElasticMaterial&,
                                                  const Matrix<2>&, const ControlPoints<2>&, bool,
                                                  bool, ElasticTangent);
template ElasticSums<3> evaluate_elastic_patch<3>(const ElasticPatch<3>&, const ElasticMaterial&,
                                                  const Matrix<3>&, const ControlPoints<3>&, bool,
                                                  bool, ElasticTangent);

}  // namespace crease
