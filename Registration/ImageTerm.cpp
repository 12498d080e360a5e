#include "Registration/ImageTerm.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/RowTiles.h"

namespace crease {
namespace {

constexpr int kFewRows = 64;  // so few rows are all looked at to tell how long a step is
constexpr int kStepRows = 4;  // one row in so many tells how long a step is

/// Row buffers of one thread, reused from row to row.
template <int Dim>
struct RowBuffers {
  std::array<std::vector<float>, Dim> displacement, force;

  void resize(std::size_t size) {
    for (int a = 0; a < Dim; ++a) {
      displacement[a].resize(size);
      force[a].resize(size);
    }
  }
};

template <int Dim>
RowBuffers<Dim>& buffers() {
  static thread_local RowBuffers<Dim> instance;
  return instance;
}

template <int Dim>
std::array<float*, Dim> pointers(std::array<std::vector<float>, Dim>& rows) {
  std::array<float*, Dim> p;
  for (int a = 0; a < Dim; ++a) p[a] = rows[a].data();
  return p;
}

template <int Dim>
bool same_raster(const Raster<Dim>& a, const Raster<Dim>& b) {
  return a.size == b.size && a.origin.isApprox(b.origin) && a.spacing.isApprox(b.spacing) &&
         a.direction.isApprox(b.direction);
}

}  // namespace

/// What a pass writes besides sums: nothing, forces, or forces and curvature.
template <int Dim>
struct ImageTerm<Dim>::Outputs {
  bool forces = false;
  CurvatureBlocks<Dim>* curvature = nullptr;
};

template <int Dim>
ImageTerm<Dim>::ImageTerm(std::shared_ptr<const BoundGrid<Dim>> grid,
                          std::shared_ptr<Metric<Dim>> metric, AffineMap<Dim> affine,
                          RowSubset rows)
    : grid_(std::move(grid)), metric_(std::move(metric)), affine_(affine), rows_(std::move(rows)) {
  if (grid_ == nullptr || metric_ == nullptr) {
    throw InvalidInput("image term: it needs a bound grid and a metric");
  }
  if (!same_raster(grid_->raster(), metric_->fixed_raster())) {
    throw InvalidInput("image term: the grid is bound to another raster than the fixed image's");
  }
}

template <int Dim>
void ImageTerm<Dim>::sweep_tile(int pass, std::int64_t tile,
                                const typename BoundGrid<Dim>::Coefficients& phi,
                                const Outputs& outputs, typename Metric<Dim>::Sums& sums,
                                typename BoundGrid<Dim>::Accumulator* accumulator) const {
  const Raster<Dim>& raster = grid_->raster();
  RowBuffers<Dim>& rows = buffers<Dim>();
  rows.resize(padded_row_size(raster));
  const Vector<Dim> step = affine_.linear * raster.index_to_point().col(0);
  RowTiles<Dim>(raster).for_each_row(tile, [&](std::int64_t r) {
    const auto [begin, end] = grid_->row_range(r);
    if (begin >= end || !rows_.contains(r)) return;
    MappedRow<Dim> row;
    row.row = r;
    row.begin = begin;
    row.end = end;
    row.start = affine_(raster.row_start(r));
    row.step = step;
    if (metric_->needs_map(pass)) {
      grid_->map_row(phi, r, pointers<Dim>(rows.displacement));
      for (int a = 0; a < Dim; ++a) row.displacement[a] = rows.displacement[a].data();
    }
    ForceRow<Dim> out;
    for (int a = 0; a < Dim; ++a) {
      if (outputs.forces) out.force[a] = rows.force[a].data();
    }
    if (outputs.curvature != nullptr) {
      const std::int64_t offset = outputs.curvature->row_offset(r, raster.size);
      for (std::size_t k = 0; k < out.curvature.size(); ++k) {
        out.curvature[k] = outputs.curvature->sums[k].data() + offset;
      }
    }
    metric_->evaluate_row(pass, row, out, sums);
    if (accumulator == nullptr) return;
    std::array<const float*, Dim> force;
    for (int a = 0; a < Dim; ++a) force[a] = rows.force[a].data();
    grid_->add_row(*accumulator, r, force);
  });
}

template <int Dim>
double ImageTerm<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) {
  if (hessian == nullptr) return evaluate_blocks(phi, scale, gradient, nullptr);
  CurvatureBlocks<Dim> curvature(grid_->raster().size);
  const double value = evaluate_blocks(phi, scale, gradient, &curvature);
  grid_->add_curvature(curvature, scale, *hessian);
  return value;
}

template <int Dim>
double ImageTerm<Dim>::evaluate_blocks(const Eigen::Ref<const ControlPoints<Dim>>& phi,
                                       double scale, ControlPoints<Dim>* gradient,
                                       CurvatureBlocks<Dim>* curvature) {
  const Raster<Dim>& raster = grid_->raster();
  const std::int64_t count = RowTiles<Dim>(raster).count();
  const auto coefficients = grid_->prepare(phi);
  std::vector<Accumulator> accumulators(static_cast<std::size_t>(count));
  double value = 0;
  const bool derivatives = gradient != nullptr || curvature != nullptr;
  const int num_passes = derivatives ? metric_->num_passes() : metric_->value_pass() + 1;
  for (int pass = 0; pass < num_passes; ++pass) {
    const bool last = pass + 1 == metric_->num_passes();
    const Outputs outputs{last && derivatives, last ? curvature : nullptr};
    std::vector<Sums> sums(static_cast<std::size_t>(count));
    parallel_for(count, [&](std::int64_t tile) {
      const auto t = static_cast<std::size_t>(tile);
      sums[t] = metric_->new_sums();
      if (last && gradient != nullptr) accumulators[t] = grid_->new_accumulator();
      sweep_tile(pass, tile, *coefficients, outputs, *sums[t], accumulators[t].get());
    });
    value = metric_->finish_pass(pass, sums);
  }
  if (gradient != nullptr) {
    ControlPoints<Dim> forces = ControlPoints<Dim>::Zero(Dim, grid_->num_control_points());
    grid_->finish(accumulators, forces);
    *gradient += scale * forces;
  }
  return value;
}

template <int Dim>
double ImageTerm<Dim>::largest_step(const Eigen::Ref<const ControlPoints<Dim>>& step) const {
  const Raster<Dim>& raster = grid_->raster();
  const RowTiles<Dim> tiles(raster);
  const auto coefficients = grid_->prepare(step);
  std::vector<double> largest(static_cast<std::size_t>(tiles.count()), 0.0);
  // A domain of few rows needs them all.
  std::int64_t rows_inside = 0;
  for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
    const auto [begin, end] = grid_->row_range(r);
    rows_inside += begin < end ? 1 : 0;
  }
  const int stride = rows_inside < kFewRows ? 1 : kStepRows;
  parallel_for(tiles.count(), [&](std::int64_t tile) {
    RowBuffers<Dim>& rows = buffers<Dim>();
    rows.resize(padded_row_size(raster));
    float squared = 0;
    tiles.for_each_row(tile, [&](std::int64_t r) {
      const auto [begin, end] = grid_->row_range(r);
      if (r % stride != 0 || begin >= end) return;
      grid_->map_row(*coefficients, r, pointers<Dim>(rows.displacement));
      for (int i = begin; i < end; ++i) {
        float sum = 0;
        for (int a = 0; a < Dim; ++a) sum += rows.displacement[a][i] * rows.displacement[a][i];
        squared = std::max(squared, sum);
      }
    });
    largest[static_cast<std::size_t>(tile)] = std::sqrt(static_cast<double>(squared));
  });
  return *std::max_element(largest.begin(), largest.end()) / raster.spacing.minCoeff();
}

template class ImageTerm<2>;
template class ImageTerm<3>;

}  // namespace crease
