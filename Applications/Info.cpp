#include "Applications/Info.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "Applications/FileInfo.h"
#include "Applications/InputFiles.h"
#include "Applications/RunOptions.h"
#include "Applications/RunReport.h"
#include "Applications/TransformInput.h"
#include "Geometry/SurfaceMeshFile.h"
#include "Images/ImageFile.h"
#include "Registration/Landmarks.h"
#include "Registration/PointFile.h"
#include "Transforms/Domains/CsvTable.h"
#include "Transforms/Domains/FeatureLineFile.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

FileInfo image_info(const std::string& file) {
  const ImageInfo info = read_image_info(file);
  const ImageHeader& h = info.header;
  const auto n = static_cast<std::size_t>(h.dimension);
  const auto list = [&](const double* values) { return std::vector<double>(values, values + n); };
  Json direction = Json::array();
  for (int a = 0; a < h.dimension; ++a) direction.push_back(list(h.direction.col(a).data()));
  FileInfo result;
  result.figures = {{"kind", "image"},
                    {"format", to_string(h.format)},
                    {"dimension", h.dimension},
                    {"size", std::vector<int>(h.size.begin(), h.size.begin() + h.dimension)},
                    {"spacing_mm", list(h.spacing.data())},
                    {"origin_mm", list(h.origin.data())},
                    {"axes", direction},
                    {"type", to_string(h.pixel_type)},
                    {"components", h.num_components},
                    {"min", info.minimum},
                    {"max", info.maximum},
                    {"not_finite", info.num_not_finite},
                    {"notes", h.notes}};
  std::string size;
  for (int a = 0; a < h.dimension; ++a) size += fmt::format("{}{}", a > 0 ? " x " : "", h.size[a]);
  result.text = fmt::format("{} image, {}D, {} pixels, {}, {} value{} per pixel\n",
                            to_string(h.format), h.dimension, size, to_string(h.pixel_type),
                            h.num_components, h.num_components == 1 ? "" : "s");
  result.text += fmt::format("spacing {} mm, first pixel at ({}) mm\n",
                             numbers_text(h.spacing.data(), h.dimension, " x "),
                             numbers_text(h.origin.data(), h.dimension, ", "));
  if (!h.direction.isIdentity(1e-6)) {
    for (int a = 0; a < h.dimension; ++a) {
      result.text += fmt::format("axis {} runs along ({})\n", a + 1,
                                 numbers_text(h.direction.col(a).data(), h.dimension, ", "));
    }
  }
  result.text += fmt::format("values {:.6g} to {:.6g}, {} not finite\n", info.minimum, info.maximum,
                             info.num_not_finite);
  for (const std::string& note : h.notes) result.text += note + "\n";
  return result;
}

template <int Dim>
FileInfo landmark_info(const std::string& file) {
  const Landmarks<Dim> landmarks = read_landmarks<Dim>(file);
  double sum = 0, largest = 0;
  for (int j = 0; j < landmarks.size(); ++j) {
    const double distance = (landmarks.moving[j] - landmarks.fixed[j]).norm();
    sum += distance;
    largest = std::max(largest, distance);
  }
  const double mean = landmarks.empty() ? 0 : sum / landmarks.size();
  FileInfo result;
  result.figures = {{"kind", "landmarks"},
                    {"dimension", Dim},
                    {"count", landmarks.size()},
                    {"has_sigma", !landmarks.sigma_mm.empty()},
                    {"has_angles", !landmarks.fixed_angle.empty()},
                    {"distance_mm", {{"mean", mean}, {"max", largest}}}};
  result.text =
      fmt::format("{} landmark pairs, {}D{}{}\nfixed to moving: mean {:.4g}, largest {:.4g} mm\n",
                  landmarks.size(), Dim, landmarks.sigma_mm.empty() ? "" : ", with uncertainties",
                  landmarks.fixed_angle.empty() ? "" : ", with directions", mean, largest);
  return result;
}

FileInfo feature_line_info(const std::string& file) {
  const auto lines = read_feature_lines(file);
  FileInfo result;
  result.figures = {{"kind", "feature lines"}, {"count", lines.size()}, {"lines", Json::array()}};
  result.text = fmt::format("{} feature lines\n", lines.size());
  for (const FeatureLine& line : lines) {
    const double length = polyline_length(line.points, line.closed);
    const std::string body = to_string(body_side(line));
    result.figures["lines"].push_back({{"name", line.name},
                                       {"points", line.points.size()},
                                       {"closed", line.closed},
                                       {"kind", to_string(line.kind)},
                                       {"body", body},
                                       {"length_mm", length}});
    result.text += fmt::format("  {}: {} {}, {} points, {:.4g} mm, body {}\n", line.name,
                               line.closed ? "closed" : "open", to_string(line.kind),
                               line.points.size(), length, body);
  }
  return result;
}

FileInfo region_info(const std::string& file) {
  const RegionOfInterest region = read_region_of_interest(file);
  const Box<2> box = region.bounds();
  FileInfo result;
  result.figures = {{"kind", "region of interest"},
                    {"rings", region.rings().size()},
                    {"area_mm2", region.area()},
                    {"lower_mm", {box.lower.x(), box.lower.y()}},
                    {"upper_mm", {box.upper.x(), box.upper.y()}}};
  result.text =
      fmt::format("region of interest: {} rings, {:.6g} mm^2, ({}) to ({}) mm\n",
                  region.rings().size(), region.area(), numbers_text(box.lower.data(), 2, ", "),
                  numbers_text(box.upper.data(), 2, ", "));
  return result;
}

/// Places of one image: a table for `crease warp --points`, or a list of 3D Slicer.
FileInfo points_info(const std::vector<Point<3>>& points, int dimension) {
  Box<3> box;
  for (const Point<3>& p : points) box.add(p);
  const auto list = [&](const Point<3>& p) {
    return std::vector<double>(p.begin(), p.begin() + dimension);
  };
  FileInfo result;
  result.figures = {{"kind", "points"}, {"dimension", dimension}, {"count", points.size()}};
  result.text = fmt::format("{} points, {}D", points.size(), dimension);
  if (!points.empty()) {
    result.figures["lower_mm"] = list(box.lower);
    result.figures["upper_mm"] = list(box.upper);
    result.text +=
        fmt::format(", from ({}) to ({}) mm", numbers_text(box.lower.data(), dimension, ", "),
                    numbers_text(box.upper.data(), dimension, ", "));
  }
  result.text += "\n";
  return result;
}

FileInfo point_file_info(const std::string& file) {
  const auto points = read_point_file(file);
  return points_info(points->points(), points->dimension());
}

/// A list of points, or curves.
FileInfo slicer_info(const std::string& file) {
  std::ifstream stream(file);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  const bool curves = has_ending(file, ".json") && text.find("\"Fiducial\"") == std::string::npos;
  if (curves) return feature_line_info(file);
  return point_file_info(file);
}

FileInfo table_info(const std::string& file) {
  if (has_csv_column(file, "fixed_z")) return landmark_info<3>(file);
  if (has_csv_column(file, "fixed_x")) return landmark_info<2>(file);
  if (has_csv_column(file, "line")) return feature_line_info(file);
  if (has_csv_column(file, "ring")) return region_info(file);
  if (has_csv_column(file, "x")) return point_file_info(file);
  throw InvalidInput(
      message(file,
              ": the table has neither landmarks (fixed_x,fixed_y,...), nor feature "
              "lines (line,x,y), nor a region of interest (ring,x,y), nor points (x,y)."));
}

FileInfo mesh_info(const std::string& file) {
  const SurfaceMesh mesh = read_surface_mesh(file);
  const SurfaceTopology topology = surface_topology(mesh);
  Box<3> box;
  for (const Point<3>& p : mesh.vertices) box.add(p);
  const auto list = [](const Point<3>& p) { return std::vector<double>(p.begin(), p.end()); };
  FileInfo result;
  result.figures = {{"kind", "mesh"},
                    {"vertices", mesh.vertices.size()},
                    {"faces", mesh.faces.size()},
                    {"edges", topology.edges},
                    {"components", topology.components},
                    {"boundary_loops", topology.boundary_loops},
                    {"non_manifold_edges", topology.non_manifold_edges},
                    {"euler", topology.euler},
                    {"genus", topology.genus < 0 ? Json() : Json(topology.genus)},
                    {"lower_mm", list(box.lower)},
                    {"upper_mm", list(box.upper)}};
  result.text = fmt::format(
      "mesh, {} vertices, {} faces, from ({}) to ({}) mm\n"
      "{} component{}, {} boundary loop{}, Euler characteristic {}, {}\n",
      mesh.vertices.size(), mesh.faces.size(), numbers_text(box.lower.data(), 3, ", "),
      numbers_text(box.upper.data(), 3, ", "), topology.components,
      topology.components == 1 ? "" : "s", topology.boundary_loops,
      topology.boundary_loops == 1 ? "" : "s", topology.euler,
      topology.genus < 0
          ? fmt::format("{} edges with three faces or more", topology.non_manifold_edges)
          : fmt::format("genus {}", topology.genus));
  return result;
}

FileInfo file_info(const std::string& file) {
  if (!std::filesystem::exists(file)) throw FileError(message(file, ": there is no such file."));
  if (has_ending(file, ".csv")) return table_info(file);
  if (has_ending(file, ".mrk.json") || has_ending(file, ".fcsv")) return slicer_info(file);
  if (has_ending(file, ".vtk")) return point_file_info(file);
  if (is_transform_file(file)) return transform_info(file);
  if (is_surface_mesh_file(file)) return mesh_info(file);
  return image_info(file);
}

struct InfoCommand {
  RunOptions run;
  std::string file;
};

ExitCode run(const InfoCommand& command) {
  RunReport report("info", prepare_process(command.run));
  const FileInfo info = file_info(command.file);
  report.add_input("file", command.file);
  report.end_stage("reading");
  std::cout << (command.run.json ? report.to_json("ok", info.figures) : info.text);
  return ExitCode::kSuccess;
}

constexpr const char* kDetails =
    R"(Understands images, transforms (of crease, and .tfm, .txt, .h5, .hdf5 and .mat of ITK and ANTs),
landmarks, feature lines, regions of interest, points (.csv, .fcsv, .mrk.json, .vtk) and meshes (.obj, .off, .ply, .stl).

Example:
  crease info thorax.nii.gz)";

}  // namespace

Subcommand info_subcommand() {
  const auto command = std::make_shared<InfoCommand>();
  std::vector<Option> options = {{.name = "file",
                                  .target = &command->file,
                                  .placeholder = "FILE",
                                  .help = "File to describe",
                                  .required = true,
                                  .is_path = true,
                                  .positional = true}};
  const auto run_options = options_of(command->run);
  options.insert(options.end(), run_options.begin(), run_options.end());
  return {.name = "info",
          .summary = "Say what a file holds",
          .details = kDetails,
          .options = options,
          .run = [command](const std::string&) { return run(*command); }};
}

}  // namespace crease
