#include "Applications/ImageOutput.h"

#include <algorithm>
#include <cmath>

#include "Applications/InputFiles.h"
#include "Core/Parallel.h"

namespace crease {
namespace {

using Path = std::filesystem::path;

/// The ending of a single file in the moving image's format; empty when it cannot be written.
std::string single_file_ending(const std::string& moving, ImageFormat format) {
  switch (format) {
    case ImageFormat::kNifti:
      return has_ending(moving, ".gz") ? ".nii.gz" : ".nii";
    case ImageFormat::kMetaImage:
      return ".mha";
    case ImageFormat::kNrrd:
      return ".nrrd";
    case ImageFormat::kPng:
      return ".png";
    case ImageFormat::kJpeg:
      return has_ending(moving, ".jpeg") ? ".jpeg" : ".jpg";
    case ImageFormat::kTiff:
      return has_ending(moving, ".tiff") ? ".tiff" : ".tif";
    case ImageFormat::kPgm:
      return ".pgm";
    case ImageFormat::kDicom:
      break;
  }
  return "";
}

}  // namespace

template <int Dim>
void write_warped(const OutputFolder& output, const std::string& name, const std::string& file_name,
                  const ReadImage<Dim>& moving, Image<float, Dim> warped) {
  std::ranges::replace_if(
      warped.values(), [](float value) { return std::isnan(value); }, 0.0f);
  const std::string ending = single_file_ending(file_name, moving.format);
  const bool own_format = !ending.empty() && can_write(moving.format, moving.pixel_type);
  if (own_format) {
    output.write(name + ending,
                 [&](const Path& file) { write_image(file, warped, moving.pixel_type); });
  }
  if (own_format && has_spacing(moving.format)) return;
  output.write(name + ".mha",
               [&](const Path& file) { write_image(file, warped, PixelType::kFloat); });
}

void write_all(const OutputFolder& output, const std::vector<NamedPicture>& pictures,
               std::vector<std::function<void()>> further_jobs) {
  std::vector<std::function<void()>> jobs = std::move(further_jobs);
  for (const auto& [name, draw] : pictures) {
    jobs.emplace_back([&output, &draw = draw, file = std::string("pictures/") + name + ".png"] {
      output.write(file, [&](const Path& path) { write_picture(path, draw()); });
    });
  }
  parallel_for(std::ssize(jobs), [&](std::int64_t i) { jobs[static_cast<std::size_t>(i)](); });
}

template void write_warped<2>(const OutputFolder&, const std::string&, const std::string&,
                              const ReadImage<2>&, Image<float, 2>);
template void write_warped<3>(const OutputFolder&, const std::string&, const std::string&,
                              const ReadImage<3>&, Image<float, 3>);

}  // namespace crease
