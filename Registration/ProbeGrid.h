#pragma once

#include <algorithm>
#include <memory>

#include "Transforms/BoundGrid.h"

namespace crease {

/// Maps by one basis and carries forces back onto the functions of another: what a spline of that other
/// basis, added to the map, would feel. Both are bound to the same raster.
template <int Dim>
class ProbeGrid final : public BoundGrid<Dim> {
 public:
  using typename BoundGrid<Dim>::Coefficients;
  using typename BoundGrid<Dim>::Accumulator;

  /// @param map    bound to the basis of the map: prepare() and map_row() are its.
  /// @param probe  bound to the basis that feels the forces; it covers the whole raster.
  ProbeGrid(std::shared_ptr<const BoundGrid<Dim>> map, std::unique_ptr<BoundGrid<Dim>> probe)
      : map_(std::move(map)), probe_(std::move(probe)) {}

  const Raster<Dim>& raster() const override { return map_->raster(); }
  /// Of the probe.
  int num_control_points() const override { return probe_->num_control_points(); }
  std::pair<int, int> row_range(std::int64_t row) const override { return map_->row_range(row); }
  void coverage(std::int64_t row, std::span<std::uint8_t> inside) const override {
    map_->coverage(row, inside);
  }
  std::unique_ptr<Coefficients> prepare(
      const Eigen::Ref<const ControlPoints<Dim>>& control_points) const override {
    return map_->prepare(control_points);
  }
  void map_row(const Coefficients& coefficients, std::int64_t row,
               const std::array<float*, Dim>& out) const override {
    map_->map_row(coefficients, row, out);
  }
  std::unique_ptr<Accumulator> new_accumulator() const override {
    return probe_->new_accumulator();
  }
  /// Forces beyond the map's range are none; the probe sweeps the whole row.
  void add_row(Accumulator& sums, std::int64_t row,
               const std::array<const float*, Dim>& force) const override {
    const auto [begin, end] = map_->row_range(row);
    thread_local std::array<std::vector<float>, Dim> whole;
    std::array<const float*, Dim> pointers;
    for (int a = 0; a < Dim; ++a) {
      whole[a].assign(padded_row_size(raster()), 0.0f);
      std::copy(force[a] + begin, force[a] + end, whole[a].begin() + begin);
      pointers[a] = whole[a].data();
    }
    probe_->add_row(sums, row, pointers);
  }
  void finish(std::span<const std::unique_ptr<Accumulator>> sums,
              Eigen::Ref<ControlPoints<Dim>> gradient) const override {
    probe_->finish(sums, gradient);
  }
  void add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                     BlockHessian<Dim>& hessian) const override {
    probe_->add_curvature(blocks, scale, hessian);
  }

 private:
  std::shared_ptr<const BoundGrid<Dim>> map_;
  std::unique_ptr<BoundGrid<Dim>> probe_;
};

}  // namespace crease
