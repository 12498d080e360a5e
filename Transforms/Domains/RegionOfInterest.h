#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "Core/Box.h"
#include "Core/Raster.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {

/// The part of the plane in which a map is defined: one or several simple polygons with holes, in mm.
class RegionOfInterest {
 public:
  /// @param rings  simple polygons that do not touch each other, in any order and orientation. A ring
  ///               inside an odd number of others is a hole. A repeated first point is dropped.
  /// @throws InvalidInput naming ring and point: fewer than three points, a point that is not finite or
  /// repeated, no area, a ring that crosses itself or another one.
  explicit RegionOfInterest(std::vector<Polyline> rings);

  /// Outer rings counter-clockwise, holes clockwise: the region lies on the left of every edge.
  const std::vector<Polyline>& rings() const { return rings_; }
  bool contains(const Point<2>& p) const;
  double area() const;  ///< mm^2
  Box<2> bounds() const;

 private:
  std::vector<Polyline> rings_;
};

/// All pixels of a raster: a rectangle (turned with the raster's direction) half a pixel beyond the
/// outer centres.
RegionOfInterest rectangle_of(const Raster<2>& raster);

/// The pixels whose mask value is not 0: their outer contours and holes, half way between pixels, simplified
/// to half a pixel. A mask without zeros gives the rectangle.
/// @throws InvalidInput when the mask is empty or its size is not the raster's.
RegionOfInterest region_of_mask(const Raster<2>& raster, std::span<const std::uint8_t> mask);

/// Reads a CSV file with the columns `ring,x,y` (mm): rows of equal `ring` are its corners in order.
/// @throws FileError, InvalidInput naming file, row and column.
RegionOfInterest read_region_of_interest(const std::filesystem::path& path);

/// Share of the region's area that lies outside the raster's rectangle, 0 to 1.
double share_outside(const RegionOfInterest& region, const Raster<2>& raster);

}  // namespace crease
