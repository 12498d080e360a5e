#include "Transforms/Domains/RegionOfInterest.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/Contours.h"
#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Domains/CsvTable.h"

namespace crease {
namespace {

constexpr double kHalfPixel =
    0.49;  // a little less, or edges along the image's border would be lost

bool on_one_line(const Polyline& ring) {
  const auto far = std::max_element(ring.begin(), ring.end(), [&](const auto& p, const auto& q) {
    return (p - ring[0]).squaredNorm() < (q - ring[0]).squaredNorm();
  });
  const Vector<2> side = *far - ring[0];
  return std::all_of(ring.begin(), ring.end(), [&](const Point<2>& p) {
    return std::abs(cross(side, p - ring[0])) <= 1e-12 * side.squaredNorm();
  });
}

void check_ring(Polyline& ring, std::size_t number) {
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (!ring[i].allFinite()) {
      throw InvalidInput(message("region of interest, ring ", number + 1, ", point ", i + 1, " (",
                                 ring[i].x(), ", ", ring[i].y(), ") mm is not finite."));
    }
  }
  if (ring.size() < 3) {
    throw InvalidInput(message("region of interest, ring ", number + 1, " has ", ring.size(),
                               " point(s); a polygon needs at least three."));
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (ring[i] == ring[(i + 1) % ring.size()]) {
      throw InvalidInput(message("region of interest, ring ", number + 1, ": points ", i + 1,
                                 " and ", (i + 1) % ring.size() + 1, " coincide; delete one."));
    }
  }
  if (on_one_line(ring)) {
    throw InvalidInput(message("region of interest, ring ", number + 1,
                               " has no area: points 1 to ", ring.size(), " lie on one line."));
  }
  if (const auto crossing = find_self_intersection(ring, true)) {
    throw InvalidInput(message("region of interest, ring ", number + 1,
                               " crosses itself: the edges from points ", crossing->first_edge + 1,
                               " and ", crossing->second_edge + 1, " meet at (",
                               crossing->point.x(), ", ", crossing->point.y(), ") mm."));
  }
}

void check_pair(const std::vector<Polyline>& rings, std::size_t r, std::size_t s) {
  Box<2> first, second;
  for (const auto& p : rings[r]) first.add(p);
  for (const auto& p : rings[s]) second.add(p);
  if (!first.intersects(second)) return;
  for (std::size_t i = 0; i < rings[r].size(); ++i) {
    const Point<2>&a = rings[r][i], &b = rings[r][(i + 1) % rings[r].size()];
    for (std::size_t k = 0; k < rings[s].size(); ++k) {
      const Point<2>&c = rings[s][k], &d = rings[s][(k + 1) % rings[s].size()];
      const bool touches = (a - closest_point_on_segment(a, c, d)).norm() == 0 ||
                           (c - closest_point_on_segment(c, a, b)).norm() == 0;
      if (touches || segment_crossing(a, b, c, d)) {
        throw InvalidInput(message("region of interest: rings ", r + 1, " and ", s + 1,
                                   " meet at their edges from points ", i + 1, " and ", k + 1,
                                   "; rings must be apart."));
      }
    }
  }
}

}  // namespace

RegionOfInterest::RegionOfInterest(std::vector<Polyline> rings) : rings_(std::move(rings)) {
  if (rings_.empty()) throw InvalidInput("region of interest: it has no polygon.");
  for (std::size_t r = 0; r < rings_.size(); ++r) check_ring(rings_[r], r);
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    for (std::size_t s = r + 1; s < rings_.size(); ++s) check_pair(rings_, r, s);
  }
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    int depth = 0;
    for (std::size_t s = 0; s < rings_.size(); ++s) {
      if (s != r && point_in_polygon(rings_[s], rings_[r][0])) ++depth;
    }
    const bool hole = depth % 2 == 1;
    if ((signed_area(rings_[r]) < 0) != hole) std::reverse(rings_[r].begin(), rings_[r].end());
  }
}

bool RegionOfInterest::contains(const Point<2>& p) const {
  int winding = 0;
  for (const auto& ring : rings_) winding += winding_number(ring, p);
  return winding > 0;
}

double RegionOfInterest::area() const {
  double sum = 0;
  for (const auto& ring : rings_) sum += signed_area(ring);
  return sum;
}

Box<2> RegionOfInterest::bounds() const {
  Box<2> box;
  for (const auto& ring : rings_) {
    for (const auto& p : ring) box.add(p);
  }
  return box;
}

RegionOfInterest rectangle_of(const Raster<2>& raster) {
  const double width = raster.size[0] - 0.5, height = raster.size[1] - 0.5;
  return RegionOfInterest({{raster.point({-0.5, -0.5}), raster.point({width, -0.5}),
                            raster.point({width, height}), raster.point({-0.5, height})}});
}

RegionOfInterest region_of_mask(const Raster<2>& raster, std::span<const std::uint8_t> mask) {
  const int width = raster.size[0], height = raster.size[1];
  if (static_cast<std::int64_t>(mask.size()) != raster.num_samples()) {
    throw InvalidInput(message("region of interest: the mask has ", mask.size(), " values, but ",
                               width, " x ", height, " pixels."));
  }
  const auto num_inside = static_cast<std::size_t>(
      std::count_if(mask.begin(), mask.end(), [](auto m) { return m != 0; }));
  if (num_inside == 0) throw InvalidInput("region of interest: the mask is empty (all values 0).");
  if (num_inside == mask.size()) return rectangle_of(raster);
  // One ring of empty pixels round the image closes the contours half a pixel outside it.
  std::vector<int> inside(static_cast<std::size_t>(width + 2) * (height + 2), 0);
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      inside[static_cast<std::size_t>(j + 1) * (width + 2) + i + 1] = mask[j * width + i] != 0;
    }
  }
  const auto arcs = trace_contours(width + 2, height + 2, inside, [&](int label, int node) {
    return inside[node] == label ? 1.0 : 0.0;
  });
  const auto rings = [&](double tolerance) {
    std::vector<Polyline> result;
    for (const auto& arc : arcs) {
      Polyline ring = simplify_polyline(arc.points, true, tolerance);
      if (ring.size() < 3) ring = arc.points;
      for (auto& p : ring) p = raster.point(p - Vector<2>::Ones());
      result.push_back(std::move(ring));
    }
    return result;
  };
  try {
    return RegionOfInterest(rings(kHalfPixel));
  } catch (const InvalidInput&) {  // simplified contours of narrow parts may cross
    return RegionOfInterest(rings(0));
  }
}

RegionOfInterest read_region_of_interest(const std::filesystem::path& path) {
  const CsvTable table(path);
  table.check_columns({"ring", "x", "y"}, {});
  std::vector<std::string> names;
  std::vector<Polyline> rings;
  for (int row = 0; row < table.num_rows(); ++row) {
    const std::string& name = table.text(row, "ring");
    auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) {
      it = names.insert(it, name);
      rings.emplace_back();
    }
    rings[it - names.begin()].emplace_back(table.number(row, "x"), table.number(row, "y"));
  }
  try {
    return RegionOfInterest(std::move(rings));
  } catch (const InvalidInput& error) {
    throw InvalidInput(message(path.string(), ": ", error.what()));
  }
}

double share_outside(const RegionOfInterest& region, const Raster<2>& raster) {
  const auto rectangle = rectangle_of(raster).rings().front();
  double inside = 0;
  for (const auto& ring : region.rings()) {
    // Clipping a ring by a convex polygon keeps its signed area, even where the result degenerates.
    inside += signed_area(clipped_by_convex(ring, rectangle));
  }
  return std::clamp(1 - inside / region.area(), 0.0, 1.0);
}

}  // namespace crease
