#include "Applications/Warp.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Applications/InputFiles.h"
#include "Applications/OutputFolder.h"
#include "Applications/ProgressReporter.h"
#include "Applications/RunReport.h"
#include "Applications/TransformInput.h"
#include "Core/Parallel.h"
#include "Core/WholeFile.h"
#include "Geometry/SurfaceMeshFile.h"
#include "Images/MakeInterpolator.h"
#include "Images/Resample.h"
#include "Registration/InverseTransform.h"
#include "Transforms/Domains/CsvTable.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

struct WarpCommand {
  RunOptions run;
  std::vector<std::string> transforms;
  std::optional<std::string> moving, reference, output_image, points, output_points, mesh,
      output_mesh, displacement;
  std::string interpolator = "cubic";
  std::optional<double> outside;
  bool inverse = false;
  std::vector<double> spacing;
};

constexpr const char* kDetails =
    R"(A transform maps points of the fixed image to the moving image. Give one of
  --moving M --reference F --output-image W     M on the grid of F: W(x) = M(T(x))
  --points IN.csv --output-points OUT.csv       T(x) for points with the columns x,y[,z][,name] in mm
  --mesh IN --output-mesh OUT                   T(x) for the vertices of a mesh, .obj, .off or .ply
  --displacement OUT.mha --reference F          T(x) - x on the grid of F, mm
Several --transform are a chain: the first one is applied first. With --inverse all of this is done with
T^-1, the reference being an image in the space that T maps to; where there is no inverse the
image gets the value outside, and points and displacements are NaN. A 2D transform leaves the z of a mesh as
it is.

Example:
  crease warp --transform out/transform.json --moving labels.nii.gz --reference fixed.nii.gz \
      --output-image warped-labels.nii.gz --interpolator nearest)";

std::vector<Option> options_of(WarpCommand& c) {
  const auto file = [](const char* name, std::optional<std::string>& target, const char* help) {
    return Option{
        .name = name, .target = &target, .placeholder = "FILE", .help = help, .is_path = true};
  };
  std::vector<Option> options = {
      {.name = "transform",
       .target = &c.transforms,
       .placeholder = "FILE",
       .help = "Transform; given several times, a chain",
       .required = true,
       .is_path = true},
      file("moving", c.moving, "Image to warp"),
      file("reference", c.reference, "Image whose grid the result has"),
      file("output-image", c.output_image, "Where the warped image goes"),
      {.name = "interpolator",
       .target = &c.interpolator,
       .help = "Between the pixels; nearest for label images",
       .choices = {"nearest", "linear", "cubic"}},
      {.name = "outside",
       .target = &c.outside,
       .placeholder = "V",
       .help = "Value where the moving image does not reach (0)"},
      file("points", c.points, "Points to map: CSV x,y[,z][,name]"),
      file("output-points", c.output_points, "Where the mapped points go: CSV"),
      file("mesh", c.mesh, "Mesh to map: .obj, .off or .ply"),
      file("output-mesh", c.output_mesh, "Where the mapped mesh goes: .obj, .off or .ply"),
      file("displacement", c.displacement, "Where the displacement field goes"),
      {.name = "inverse", .target = &c.inverse, .help = "Use T^-1"},
      {.name = "spacing",
       .target = &c.spacing,
       .placeholder = "X,Y[,Z]",
       .help = "Pixel size in mm of images whose files tell none",
       .minimum = 0,
       .open_minimum = true},
  };
  const auto run = options_of(c.run);
  options.insert(options.end(), run.begin(), run.end());
  return options;
}

void check(const WarpCommand& c) {
  const auto together = [](bool one, bool other, const char* a, const char* b) {
    if (one != other) throw UsageError(message("--", one ? a : b, " needs --", one ? b : a, "."));
  };
  together(c.moving.has_value(), c.output_image.has_value(), "moving", "output-image");
  together(c.points.has_value(), c.output_points.has_value(), "points", "output-points");
  together(c.mesh.has_value(), c.output_mesh.has_value(), "mesh", "output-mesh");
  if (!c.moving && !c.points && !c.mesh && !c.displacement) {
    throw UsageError(
        "nothing to do: give --moving with --output-image, --points with --output-points, --mesh "
        "with "
        "--output-mesh, or --displacement.");
  }
  const bool needs_grid = c.moving || c.displacement;
  if (needs_grid && !c.reference) throw UsageError("--reference FILE is needed for the grid.");
  if (!needs_grid && c.reference) {
    throw UsageError("--reference has no meaning without --moving or --displacement.");
  }
  if (!c.moving && (c.outside || c.interpolator != "cubic")) {
    throw UsageError("--outside and --interpolator have no meaning without --moving.");
  }
  for (const auto& [name, file] : {std::pair("output-image", &c.output_image),
                                   {"output-points", &c.output_points},
                                   {"output-mesh", &c.output_mesh},
                                   {"displacement", &c.displacement}}) {
    if (*file) check_output_file(name, **file);
  }
}

/// What a run has written, for the report.
struct WarpResult {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  Json figures;
  std::string summary;
  std::int64_t unresolved = 0;
};

/// An image format that keeps the pixels' type, or the nearest that it can write.
PixelType writable_type(const std::string& file, PixelType type) {
  const ImageFormat format = image_format(file);
  for (const PixelType candidate : {type, PixelType::kFloat, PixelType::kUint16}) {
    if (can_write(format, candidate)) return candidate;
  }
  return PixelType::kUint8;
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

template <int Dim>
void warp_image(const WarpCommand& c, InputFiles& input, const Raster<Dim>& reference,
                const PointMap<Dim>& map, WarpResult& result) {
  const ReadImage<Dim> moving = input.image<Dim>("moving", *c.moving);
  // A point that has no inverse counts as outside.
  const Box<Dim> box = moving.image.raster().bounds();
  const Point<Dim> outside = box.upper + box.size();
  const PointMap<Dim> finite_map = [&](const Point<Dim>& x) -> Point<Dim> {
    const Point<Dim> y = map(x);
    return y.allFinite() ? y : outside;
  };
  const Image<float, Dim> warped = warped_values(c, moving.image, reference, finite_map);
  const PixelType type = writable_type(*c.output_image, moving.pixel_type);
  write_image(*c.output_image, warped, type);
  result.figures["output_image"] = *c.output_image;
  result.summary += fmt::format("image: {}\n", *c.output_image);
}

template <int Dim>
void write_displacement(const WarpCommand& c, const Raster<Dim>& reference,
                        const PointMap<Dim>& map, WarpResult& result) {
  DisplacementField<Dim> field(reference);
  parallel_for(reference.num_rows(), [&](std::int64_t r) {
    const Vector<Dim> step = reference.index_to_point().col(0);
    const auto row = field.row(r);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Point<Dim> x = reference.row_start(r) + static_cast<double>(i) * step;
      row[i] = map(x) - x;
    }
  });
  for (const Vector<Dim>& u : field.values()) result.unresolved += u.allFinite() ? 0 : 1;
  write_displacement_field(*c.displacement, field);
  result.figures["displacement"] = *c.displacement;
  result.summary += fmt::format("displacement: {}\n", *c.displacement);
}

template <int Dim>
void map_points(const WarpCommand& c, RunReport& report, const PointMap<Dim>& map,
                WarpResult& result) {
  constexpr std::array kAxes = {"x", "y", "z"};
  const CsvTable table(*c.points);
  report.add_input("points", *c.points);
  const std::vector<std::string> axes(kAxes.begin(), kAxes.begin() + Dim);
  table.check_columns(axes, {"name"});
  const bool named = table.has_column("name");
  std::string text = Dim == 2 ? "x,y" : "x,y,z";
  text += named ? ",name\n" : "\n";
  for (int row = 0; row < table.num_rows(); ++row) {
    Point<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = table.number(row, axes[static_cast<std::size_t>(a)]);
    const Point<Dim> y = map(x);
    if (!y.allFinite()) ++result.unresolved;
    for (int a = 0; a < Dim; ++a) text += fmt::format("{}{}", a > 0 ? "," : "", y[a]);
    if (named) text += "," + table.text(row, "name");
    text += "\n";
  }
  write_whole_file(*c.output_points, text);
  result.figures["output_points"] = *c.output_points;
  result.figures["num_points"] = table.num_rows();
  result.summary += fmt::format("{} points: {}\n", table.num_rows(), *c.output_points);
}

template <int Dim>
void map_mesh(const WarpCommand& c, RunReport& report, const PointMap<Dim>& map,
              WarpResult& result) {
  SurfaceMesh mesh = read_surface_mesh(*c.mesh);
  report.add_input("mesh", *c.mesh);
  for (Point<3>& p : mesh.vertices) {
    p.head<Dim>() = map(p.head<Dim>());
    if (!p.allFinite()) ++result.unresolved;
  }
  write_surface_mesh(*c.output_mesh, mesh);
  result.figures["output_mesh"] = *c.output_mesh;
  result.figures["num_vertices"] = mesh.vertices.size();
  result.summary += fmt::format("{} vertices: {}\n", mesh.vertices.size(), *c.output_mesh);
}

template <int Dim>
WarpResult warp(const WarpCommand& c, RunReport& report) {
  const auto transform = read_transforms<Dim>(report, c.transforms);
  PointMap<Dim> map = [&transform](const Point<Dim>& x) { return transform->map(x); };
  if (c.inverse) map = inverse_transform(*transform);
  InputFiles input(report, c.spacing);
  WarpResult result;
  if (c.reference) {
    const Raster<Dim> reference = input.image<Dim>("reference", *c.reference).image.raster();
    if (c.moving) warp_image(c, input, reference, map, result);
    if (c.displacement) write_displacement(c, reference, map, result);
  }
  input.check_spacing_was_used();
  if (c.points) map_points(c, report, map, result);
  if (c.mesh) map_mesh(c, report, map, result);
  result.figures["unresolved"] = result.unresolved;
  return result;
}

ExitCode run(const WarpCommand& command) {
  check(command);
  RunReport report("warp", prepare_process(command.run));
  ProgressReporter progress(command.run, "warp");
  progress.report({.stage = "warp"});
  const int dimension = transform_dimension(command.transforms);
  for (const auto* file : {&command.moving, &command.reference}) {
    if (!*file || read_image_header(**file).dimension == dimension) continue;
    throw InvalidInput(message(command.transforms.front(), " is ", dimension, "D, but ", **file,
                               " is not; give files of the same dimension."));
  }
  const WarpResult result = dimension == 2 ? warp<2>(command, report) : warp<3>(command, report);
  if (result.unresolved > 0) {
    report.add_warning(message("no inverse at ", result.unresolved,
                               " points: the map folds there or does not reach them."));
  }
  report.end_stage("warp");
  for (const std::string& warning : report.warnings()) progress.warn(warning);
  std::cout << (command.run.json ? report.to_json("ok", result.figures) : result.summary);
  return ExitCode::kSuccess;
}

}  // namespace

Subcommand warp_subcommand() {
  const auto command = std::make_shared<WarpCommand>();
  return {.name = "warp",
          .summary = "Apply saved transforms to an image, to points or as a displacement field",
          .details = kDetails,
          .options = options_of(*command),
          .run = [command](const std::string&) { return run(*command); }};
}

}  // namespace crease
