#include "Applications/Warp.h"

#include <iostream>
#include <memory>

#include "Applications/InputFiles.h"
#include "Applications/OutputFolder.h"
#include "Applications/ProgressReporter.h"
#include "Applications/TransformInput.h"
#include "Applications/WarpRun.h"

namespace crease {
namespace {

constexpr const char* kDetails =
    R"(A transform maps points of the fixed image to the moving image. Give one of
  --moving M --reference F --output-image W     M on the grid of F: W(x) = M(T(x))
  --points IN --output-points OUT               T(x) for points, in the same form: CSV with the columns
                                                x,y[,z][,name] in mm; .fcsv and .mrk.json of 3D Slicer;
                                                legacy .vtk of any kind. All else in the file is kept
  --mesh IN --output-mesh OUT                   T(x) for the vertices of a mesh: .obj, .off, .ply or .stl,
                                                or .vtk to .vtk
  --displacement OUT.mha --reference F          T(x) - x on the grid of F, mm
Transforms are files of crease (.json), of ITK, elastix, ANTs and 3D Slicer (.tfm, .txt, .h5, .hdf5, ANTs'
.mat), and displacement fields (.nii, .nii.gz, .mha, .mhd, .nrrd; ITK's convention), in any mixture. ITK's
B-splines end at their domain; crease continues them.
Several --transform are a chain: the first one is applied first. With --inverse all of this is done with
T^-1, the reference being an image in the space that T maps to; where there is no inverse the
image gets the value outside, and points and displacements are NaN (in .mrk.json "undefined"). How far
T(T^-1(y)) is from y is told. A 2D transform leaves z as it is.

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
       .help = "Transform or displacement field; given several times, a chain",
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
      file("points", c.points, "Points to map: .csv, .fcsv, .mrk.json or .vtk"),
      file("output-points", c.output_points, "Where the mapped points go, in the same form"),
      file("mesh", c.mesh, "Mesh to map: .obj, .off, .ply, .stl or .vtk"),
      file("output-mesh", c.output_mesh, "Where the mapped mesh goes: the same, or another"),
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
        "with --output-mesh, or --displacement.");
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
  if (result.unresolved() > 0) {
    report.add_warning(message("no inverse at ", result.unresolved(),
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
