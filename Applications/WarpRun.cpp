#include "Applications/WarpRun.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>

#include "Applications/InputFiles.h"
#include "Applications/TransformInput.h"
#include "Core/Parallel.h"
#include "Geometry/SurfaceMeshFile.h"
#include "Images/MakeInterpolator.h"
#include "Registration/PointFile.h"

namespace crease {
namespace {

/// All samples of a raster, first axis fastest.
template <int Dim>
std::vector<Point<Dim>> samples_of(const Raster<Dim>& raster) {
  std::vector<Point<Dim>> points(static_cast<std::size_t>(raster.num_samples()));
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const Point<Dim> start = raster.row_start(r);
    for (int i = 0; i < raster.size[0]; ++i) {
      points[static_cast<std::size_t>(r * raster.size[0] + i)] = start + i * step;
    }
  });
  return points;
}

/// T, or T^-1 with a record of how well it was found.
template <int Dim>
class WarpMap {
 public:
  /// @param where  holds all points that will be mapped.
  WarpMap(const Transform<Dim>& transform, bool inverse, const Box<Dim>& where)
      : transform_(transform) {
    if (inverse) inverse_ = inverse_transform(transform, where);
  }

  std::vector<Point<Dim>> map(const std::vector<Point<Dim>>& points) {
    std::vector<Point<Dim>> mapped(points.size());
    if (inverse_) {
      residual_ += invert_points<Dim>(transform_, inverse_, points, mapped);
      return mapped;
    }
    constexpr std::int64_t kBlock = 256;
    const auto count = std::ssize(points);
    parallel_for((count + kBlock - 1) / kBlock, [&](std::int64_t b) {
      for (auto k = b * kBlock; k < std::min(count, (b + 1) * kBlock); ++k) {
        mapped[k] = transform_.map(points[k]);
      }
    });
    return mapped;
  }
  /// T, or the inverse where it was found already: the image of every sample of a raster.
  PointMap<Dim> on_samples(const Raster<Dim>& raster, const std::vector<Point<Dim>>* images) const {
    if (images == nullptr) return [this](const Point<Dim>& x) { return transform_.map(x); };
    return [&raster, images](const Point<Dim>& x) -> Point<Dim> {
      const Vector<Dim> index = raster.index(x);
      std::int64_t n = 0;
      for (int a = Dim - 1; a >= 0; --a) n = n * raster.size[a] + std::llround(index[a]);
      return (*images)[static_cast<std::size_t>(n)];
    };
  }
  bool is_inverse() const { return static_cast<bool>(inverse_); }
  const InverseResidual& residual() const { return residual_; }

 private:
  const Transform<Dim>& transform_;
  PointMap<Dim> inverse_;
  InverseResidual residual_;
};

/// An image format that keeps the pixels' type, or the nearest that it can write.
PixelType writable_type(const std::string& file, PixelType type) {
  const ImageFormat format = image_format(file);
  for (const PixelType candidate : {type, PixelType::kFloat, PixelType::kUint16}) {
    if (can_write(format, candidate)) return candidate;
  }
  return PixelType::kUint8;
}

/// A point that has no inverse counts as outside.
template <int Dim>
PointMap<Dim> finite_map(const PointMap<Dim>& map, const Raster<Dim>& moving) {
  const Box<Dim> box = moving.bounds();
  const Point<Dim> outside = box.upper + box.size();
  return [&map, outside](const Point<Dim>& x) -> Point<Dim> {
    const Point<Dim> y = map(x);
    return y.allFinite() ? y : outside;
  };
}

template <int Dim>
Image<float, Dim> warped_values(const WarpCommand& c, const Image<float, Dim>& moving,
                                const Raster<Dim>& reference, const PointMap<Dim>& map) {
  const float outside = static_cast<float>(c.outside.value_or(0));
  if (c.interpolator == "nearest") return resample_nearest(moving, reference, map, outside);
  const auto kind =
      c.interpolator == "linear" ? InterpolationKind::kLinear : InterpolationKind::kCubic;
  return resample(*make_interpolator(moving, kind), reference, map, outside);
}

/// Whether the pixels are whole numbers that single precision might round, but int32 holds.
bool needs_labels(const std::string& file) {
  const PixelType type = read_image_header(file).pixel_type;
  if (type != PixelType::kInt32 && type != PixelType::kUint32 && type != PixelType::kInt64 &&
      type != PixelType::kUint64) {
    return false;
  }
  const ImageInfo info = read_image_info(file);
  return info.maximum > 1 << 24 && info.minimum >= 0 &&
         info.maximum <= std::numeric_limits<std::int32_t>::max();
}

template <int Dim>
void warp_image(const WarpCommand& c, InputFiles& input, const Raster<Dim>& reference,
                const PointMap<Dim>& map, WarpResult& result) {
  if (c.interpolator == "nearest" && needs_labels(*c.moving)) {
    const LabelImage<Dim> moving = input.labels<Dim>("moving", *c.moving);
    const auto outside = static_cast<std::int32_t>(std::lround(c.outside.value_or(0)));
    const LabelImage<Dim> warped =
        resample_nearest(moving, reference, finite_map(map, moving.raster()), outside);
    const PixelType type = read_image_header(*c.moving).pixel_type;
    write_image(*c.output_image, warped, writable_type(*c.output_image, type));
  } else {
    const ReadImage<Dim> moving = input.image<Dim>("moving", *c.moving);
    const Image<float, Dim> warped =
        warped_values(c, moving.image, reference, finite_map(map, moving.image.raster()));
    write_image(*c.output_image, warped, writable_type(*c.output_image, moving.pixel_type));
  }
  result.figures["output_image"] = *c.output_image;
  result.summary += fmt::format("image: {}\n", *c.output_image);
}

template <int Dim>
void write_displacement(const WarpCommand& c, const Raster<Dim>& reference,
                        std::vector<Vector<Dim>> values, WarpResult& result) {
  const std::vector<Point<Dim>> samples = samples_of(reference);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] -= samples[k];
  write_displacement_field(*c.displacement, DisplacementField<Dim>(reference, std::move(values)));
  result.figures["displacement"] = *c.displacement;
  result.summary += fmt::format("displacement: {}\n", *c.displacement);
}

/// What has a grid to be drawn on.
template <int Dim>
void warp_on_grid(const WarpCommand& c, InputFiles& input, const Raster<Dim>& reference,
                  WarpMap<Dim>& map, WarpResult& result) {
  std::vector<Point<Dim>> images;
  if (map.is_inverse() || c.displacement) images = map.map(samples_of(reference));
  if (c.moving) {
    warp_image(c, input, reference, map.on_samples(reference, map.is_inverse() ? &images : nullptr),
               result);
  }
  if (c.displacement) write_displacement(c, reference, std::move(images), result);
}

/// Points of space moved by a map that may be one of the plane.
template <int Dim>
std::vector<Point<3>> mapped(const std::vector<Point<3>>& points, WarpMap<Dim>& map) {
  std::vector<Point<Dim>> heads;
  heads.reserve(points.size());
  for (const Point<3>& p : points) heads.push_back(p.head<Dim>());
  const std::vector<Point<Dim>> images = map.map(heads);
  std::vector<Point<3>> result = points;
  for (std::size_t k = 0; k < result.size(); ++k) result[k].template head<Dim>() = images[k];
  return result;
}

template <int Dim>
std::unique_ptr<PointFile> read_points(const std::string& option, const std::string& file,
                                       RunReport& report) {
  auto points = read_point_file(file);
  report.add_input(option, file);
  if (points->dimension() < Dim) {
    throw InvalidInput(message(file, ": has no column 'z', which a ", Dim, "D transform needs."));
  }
  return points;
}

/// What is to be mapped, read before the map is made.
template <int Dim>
struct WarpInputs {
  std::optional<Raster<Dim>> reference;
  std::unique_ptr<PointFile> points, mesh_points;
  std::optional<SurfaceMesh> mesh;

  Box<Dim> bounds() const {
    Box<Dim> box;
    const auto add = [&](const std::vector<Point<3>>& list) {
      for (const Point<3>& p : list) box.add(p.template head<Dim>());
    };
    if (reference) {
      const Box<Dim> grid = reference->bounds();
      box.add(grid.lower);
      box.add(grid.upper);
    }
    if (points) add(points->points());
    if (mesh_points) add(mesh_points->points());
    if (mesh) add(mesh->vertices);
    return box;
  }
};

bool is_vtk(const std::string& file) { return has_ending(file, ".vtk"); }

template <int Dim>
WarpInputs<Dim> read_inputs(const WarpCommand& c, InputFiles& input, RunReport& report) {
  WarpInputs<Dim> read;
  if (c.reference) {
    read.reference = input.image<Dim>("reference", *c.reference).image.raster();
  }
  if (c.points) read.points = read_points<Dim>("points", *c.points, report);
  if (c.mesh && is_vtk(*c.mesh)) {
    read.mesh_points = read_points<Dim>("mesh", *c.mesh, report);
  } else if (c.mesh) {
    read.mesh = read_surface_mesh(*c.mesh);
    report.add_input("mesh", *c.mesh);
  }
  return read;
}

template <int Dim>
void map_points(const WarpCommand& c, const PointFile& points, WarpMap<Dim>& map,
                WarpResult& result) {
  write_point_file(*c.output_points, points, *c.points, mapped(points.points(), map));
  const std::size_t count = points.points().size();
  result.figures["output_points"] = *c.output_points;
  result.figures["num_points"] = count;
  result.summary += fmt::format("{} points: {}\n", count, *c.output_points);
}

template <int Dim>
void map_mesh(const WarpCommand& c, WarpInputs<Dim>& read, WarpMap<Dim>& map, WarpResult& result) {
  std::size_t count = 0;
  if (read.mesh_points) {
    const auto& points = read.mesh_points->points();
    write_point_file(*c.output_mesh, *read.mesh_points, *c.mesh, mapped(points, map));
    count = points.size();
  } else {
    read.mesh->vertices = mapped(read.mesh->vertices, map);
    write_surface_mesh(*c.output_mesh, *read.mesh);
    count = read.mesh->vertices.size();
  }
  result.figures["output_mesh"] = *c.output_mesh;
  result.figures["num_vertices"] = count;
  result.summary += fmt::format("{} vertices: {}\n", count, *c.output_mesh);
}

void tell_residual(const InverseResidual& residual, WarpResult& result) {
  result.residual = residual;
  result.figures["unresolved"] = residual.unresolved;
  result.figures["residual_mm"] = {{"mean", residual.mean_mm()}, {"max", residual.max_mm}};
  result.summary += fmt::format("T(T^-1(y)) - y: mean {:.2g}, max {:.2g} mm, {} of {} unresolved\n",
                                residual.mean_mm(), residual.max_mm, residual.unresolved,
                                residual.unresolved + residual.resolved);
}

}  // namespace

template <int Dim>
WarpResult warp(const WarpCommand& c, RunReport& report) {
  const auto transform = read_transforms<Dim>(report, c.transforms);
  InputFiles input(report, c.spacing);
  WarpInputs<Dim> read = read_inputs<Dim>(c, input, report);
  WarpMap<Dim> map(*transform, c.inverse, read.bounds());
  WarpResult result;
  if (read.reference) warp_on_grid(c, input, *read.reference, map, result);
  input.check_spacing_was_used();
  if (read.points) map_points(c, *read.points, map, result);
  if (c.mesh) map_mesh(c, read, map, result);
  result.figures["unresolved"] = 0;
  if (c.inverse) tell_residual(map.residual(), result);
  return result;
}

template WarpResult warp<2>(const WarpCommand&, RunReport&);
template WarpResult warp<3>(const WarpCommand&, RunReport&);

}  // namespace crease
