#include "Registration/AffineObjective.h"

#include <array>
#include <limits>
#include <vector>

#include "Core/Parallel.h"
#include "Metrics/MetricInput.h"
#include "Registration/RowTiles.h"

namespace crease {
namespace {

constexpr int num_second(int dim) { return dim * (dim + 1) / 2; }

/// Number of (a, b), a <= b, in (xx, xy, yy) or (xx, xy, xz, yy, yz, zz).
constexpr int entry(int a, int b, int dim) {
  return a <= b ? a * dim - a * (a - 1) / 2 + b - a : entry(b, a, dim);
}

template <int Dim>
struct RowBuffers {
  std::array<std::vector<float>, Dim> force;
  std::array<std::vector<float>, num_second(Dim)> curvature;
};

template <int Dim>
RowBuffers<Dim>& buffers(int width) {
  static thread_local RowBuffers<Dim> instance;
  const auto size = static_cast<std::size_t>(width + 32);
  for (auto& row : instance.force) row.resize(size);
  for (auto& row : instance.curvature) row.assign(size / 4 + 1, 0.0f);
  return instance;
}

}  // namespace

/// Sums over samples of force and curvature times the frame's coordinates.
template <int Dim>
struct AffineObjective<Dim>::Moments {
  static constexpr int kSize = Dim * (Dim + 1);
  Eigen::Matrix<double, kSize, 1> gradient = Eigen::Matrix<double, kSize, 1>::Zero();
  Eigen::Matrix<double, kSize, kSize> hessian = Eigen::Matrix<double, kSize, kSize>::Zero();

  /// Forces of samples begin .. end-1 at coordinates first + i * step.
  void add_forces(const RowBuffers<Dim>& rows, int begin, int end,
                  const Eigen::Matrix<double, Dim + 1, 1>& first,
                  const Eigen::Matrix<double, Dim + 1, 1>& step) {
    for (int a = 0; a < Dim; ++a) {
      double sum = 0, first_moment = 0;
      for (int i = begin; i < end; ++i) {
        const double f = rows.force[a][static_cast<std::size_t>(i)];
        sum += f;
        first_moment += i * f;
      }
      for (int k = 0; k <= Dim; ++k) {
        gradient[Dim * k + a] += first[k] * sum + step[k] * first_moment;
      }
    }
  }

  void add_curvature(const RowBuffers<Dim>& rows, int begin, int end,
                     const Eigen::Matrix<double, Dim + 1, 1>& first,
                     const Eigen::Matrix<double, Dim + 1, 1>& step) {
    for (int block = begin / 4; 4 * block < end; ++block) {
      const Eigen::Matrix<double, Dim + 1, 1> b = first + (4 * block + 1.5) * step;
      for (int j = 0; j <= Dim; ++j) {
        for (int k = 0; k <= j; ++k) {
          for (int a = 0; a < Dim; ++a) {
            for (int c = 0; c < Dim; ++c) {
              const double g = rows.curvature[entry(a, c, Dim)][static_cast<std::size_t>(block)];
              hessian(Dim * j + a, Dim * k + c) += b[j] * b[k] * g;
            }
          }
        }
      }
    }
  }

  Moments& operator+=(const Moments& other) {
    gradient += other.gradient;
    hessian += other.hessian;
    return *this;
  }
};

template <int Dim>
AffineObjective<Dim>::AffineObjective(std::shared_ptr<Metric<Dim>> metric,
                                      std::unique_ptr<Transform<Dim>> transform,
                                      const Point<Dim>& frame, double radius)
    : metric_(std::move(metric)), transform_(std::move(transform)), radius_(radius) {
  for (int k = 0; k <= Dim; ++k) {
    frame_[k] = frame;
    if (k > 0) frame_[k][k - 1] += radius;
  }
}

template <int Dim>
AffineMap<Dim> AffineObjective<Dim>::map(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  transform_->set_parameters(parameters);
  AffineMap<Dim> map;
  const Point<Dim> q = transform_->map(frame_[0]);
  for (int k = 0; k < Dim; ++k) {
    map.linear.col(k) = (transform_->map(frame_[k + 1]) - q) / radius_;
  }
  map.offset = q - map.linear * frame_[0];
  return map;
}

template <int Dim>
Eigen::MatrixXd AffineObjective<Dim>::frame_jacobian() const {
  Eigen::MatrixXd jacobian(Moments::kSize, transform_->num_parameters());
  for (int k = 0; k <= Dim; ++k) {
    for (int a = 0; a < Dim; ++a) {
      const Vector<Dim> unit = Vector<Dim>::Unit(a);
      Eigen::VectorXd row = Eigen::VectorXd::Zero(transform_->num_parameters());
      transform_->add_adjoint(std::span(&frame_[k], 1), std::span(&unit, 1), row);
      jacobian.row(Dim * k + a) = row.transpose();
    }
  }
  return jacobian;
}

/// The metric's value; sums its forces and curvature where not null.
template <int Dim>
double AffineObjective<Dim>::sweep(const AffineMap<Dim>& affine, Moments* total) {
  const Raster<Dim>& raster = metric_->fixed_raster();
  const RowTiles<Dim> tiles(raster);
  const Vector<Dim> step = raster.index_to_point().col(0);
  Eigen::Matrix<double, Dim + 1, 1> coordinate_step;
  coordinate_step << -step.sum() / radius_, step / radius_;
  const bool derivatives = total != nullptr;

  std::vector<Moments> moments(static_cast<std::size_t>(tiles.count()));
  double value = 0;
  const int num_passes = derivatives ? metric_->num_passes() : metric_->value_pass() + 1;
  for (int pass = 0; pass < num_passes; ++pass) {
    const bool last = pass + 1 == metric_->num_passes();
    std::vector<std::unique_ptr<typename Metric<Dim>::Sums>> sums(moments.size());
    parallel_for(tiles.count(), [&](std::int64_t tile) {
      const auto t = static_cast<std::size_t>(tile);
      sums[t] = metric_->new_sums();
      tiles.for_each_row(tile, [&](std::int64_t r) {
        MappedRow<Dim> row;
        row.row = r;
        row.end = raster.size[0];
        row.start = affine(raster.row_start(r));
        row.step = affine.linear * step;
        RowBuffers<Dim>& rows = buffers<Dim>(raster.size[0]);
        ForceRow<Dim> out;
        if (last && derivatives) {
          for (int a = 0; a < Dim; ++a) out.force[a] = rows.force[a].data();
          for (int k = 0; k < num_second(Dim); ++k) out.curvature[k] = rows.curvature[k].data();
        }
        metric_->evaluate_row(pass, row, out, *sums[t]);
        if (!last || !derivatives) return;
        const Vector<Dim> local = (raster.row_start(r) - frame_[0]) / radius_;
        Eigen::Matrix<double, Dim + 1, 1> first;
        first << 1 - local.sum(), local;
        moments[t].add_forces(rows, row.begin, row.end, first, coordinate_step);
        moments[t].add_curvature(rows, row.begin, row.end, first, coordinate_step);
      });
    });
    value = metric_->finish_pass(pass, sums);
  }
  if (total != nullptr) {
    for (const Moments& m : moments) *total += m;
  }
  return value;
}

template <int Dim>
double AffineObjective<Dim>::evaluate(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                      Eigen::VectorXd* gradient,
                                      Eigen::SparseMatrix<double>* hessian) {
  const AffineMap<Dim> affine = map(parameters);
  const bool derivatives = gradient != nullptr || hessian != nullptr;
  Moments total;
  double value = 0;
  try {
    value = sweep(affine, derivatives ? &total : nullptr);
  } catch (const OverlapError&) {  // a step that went too far, but for the start
    if (!evaluated_) throw;
    return std::numeric_limits<double>::infinity();
  }
  evaluated_ = true;
  if (!derivatives) return value;
  const Eigen::MatrixXd jacobian = frame_jacobian();
  if (gradient != nullptr) *gradient = jacobian.transpose() * total.gradient;
  if (hessian != nullptr) {
    const Eigen::MatrixXd full = total.hessian.template selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd reduced = jacobian.transpose() * full * jacobian;
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < reduced.cols(); ++j) {
      for (int i = j; i < reduced.rows(); ++i) entries.emplace_back(i, j, reduced(i, j));
    }
    hessian->resize(reduced.rows(), reduced.cols());
    hessian->setFromTriplets(entries.begin(), entries.end());
  }
  return value;
}

template <int Dim>
double AffineObjective<Dim>::step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const {
  const Eigen::VectorXd moved = frame_jacobian() * step;
  double largest = 0;
  for (int k = 0; k <= Dim; ++k) {
    largest = std::max(largest, moved.template segment<Dim>(Dim * k).norm());
  }
  return largest / metric_->fixed_raster().spacing.minCoeff();
}

template class AffineObjective<2>;
template class AffineObjective<3>;

}  // namespace crease
