#pragma once

#include <algorithm>
#include <cstdint>

#include "Core/Raster.h"

namespace crease {

/// Tiles of rows that a sweep over a raster hands to threads: 16 consecutive rows of a plane, in 3D of 4
/// consecutive planes, so that a block of 4 x 4 (x 4) samples never lies in two tiles.
template <int Dim>
class RowTiles {
 public:
  static constexpr int kRows = 16;
  static constexpr int kPlanes = 4;

  explicit RowTiles(const Raster<Dim>& raster) : raster_(raster) {
    tiles_per_plane_ = (raster.size[1] + kRows - 1) / kRows;
  }

  std::int64_t count() const {
    if constexpr (Dim == 2) return tiles_per_plane_;
    return static_cast<std::int64_t>(tiles_per_plane_) *
           ((raster_.size[Dim - 1] + kPlanes - 1) / kPlanes);
  }

  /// Calls visit(row) for every row of the tile, in order.
  template <typename Visit>
  void for_each_row(std::int64_t tile, Visit&& visit) const {
    const int first = static_cast<int>(tile % tiles_per_plane_) * kRows;
    const int last = std::min(first + kRows, raster_.size[1]);
    int plane = 0, planes = 1;
    if constexpr (Dim == 3) {
      plane = static_cast<int>(tile / tiles_per_plane_) * kPlanes;
      planes = std::min(plane + kPlanes, raster_.size[2]);
    }
    for (; plane < planes; ++plane) {
      for (int j = first; j < last; ++j) {
        visit(static_cast<std::int64_t>(plane) * raster_.size[1] + j);
      }
    }
  }

 private:
  Raster<Dim> raster_;
  int tiles_per_plane_ = 0;
};

}  // namespace crease
