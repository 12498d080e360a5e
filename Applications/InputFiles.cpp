#include "Applications/InputFiles.h"

#include <algorithm>
#include <cctype>
#include <fstream>

#include "Applications/ExitCode.h"
#include "Images/RasterCheck.h"
#include "Images/Resample.h"

namespace crease {
namespace {

template <typename Pixel, int Dim>
Image<Pixel, Dim> with_raster(Image<Pixel, Dim> image, const Raster<Dim>& raster) {
  return Image<Pixel, Dim>(raster, std::move(image).take_values());
}

}  // namespace

int InputFiles::common_dimension(const std::vector<std::string>& files) {
  int dimension = 0;
  for (const std::string& file : files) {
    const int own = read_image_header(file).dimension;
    if (dimension == 0) dimension = own;
    if (own == dimension) continue;
    throw InvalidInput(message(files.front(), " is ", dimension, "D, but ", file, " is ", own,
                               "D; give images of the same dimension."));
  }
  return dimension;
}

template <int Dim>
void InputFiles::set_spacing(const std::string& file, Raster<Dim>& raster) {
  if (spacing_.empty() || has_spacing(image_format(file))) return;
  if (std::ssize(spacing_) != Dim) {
    throw UsageError(message("--spacing has ", spacing_.size(), " numbers, but ", file, " is ", Dim,
                             "D; give ", Dim, "."));
  }
  for (int a = 0; a < Dim; ++a) raster.spacing[a] = spacing_[static_cast<std::size_t>(a)];
  spacing_used_ = true;
}

template <int Dim>
ReadImage<Dim> InputFiles::image(const std::string& option, const std::string& file) {
  ReadImage<Dim> read = read_image<Dim>(file);
  report_.add_input(option, file);
  for (const std::string& note : read.notes) report_.add_warning(message(file, ": ", note));
  if (read.image.empty()) throw InvalidInput(message(file, ": the image has no pixels."));
  check_finite(read.image, file);
  Raster<Dim> raster = read.image.raster();
  set_spacing(file, raster);
  read.image = with_raster(std::move(read.image), raster);
  return read;
}

template <int Dim>
Mask<Dim> InputFiles::mask(const std::string& option, const std::string& file) {
  Mask<Dim> mask = read_mask<Dim>(file);
  report_.add_input(option, file);
  if (std::ranges::none_of(mask.values(), [](std::uint8_t value) { return value != 0; })) {
    throw InvalidInput(
        message("--", option, " ", file, ": the mask is empty; set the pixels that count to 1."));
  }
  Raster<Dim> raster = mask.raster();
  set_spacing(file, raster);
  return with_raster(std::move(mask), raster);
}

template <int Dim>
LabelImage<Dim> InputFiles::labels(const std::string& option, const std::string& file) {
  LabelImage<Dim> labels = read_labels<Dim>(file);
  report_.add_input(option, file);
  Raster<Dim> raster = labels.raster();
  set_spacing(file, raster);
  return with_raster(std::move(labels), raster);
}

template <int Dim>
DisplacementField<Dim> InputFiles::displacement(const std::string& option,
                                                const std::string& file) {
  DisplacementField<Dim> field = read_displacement_field<Dim>(file);
  report_.add_input(option, file);
  return field;
}

template <int Dim>
Landmarks<Dim> InputFiles::landmarks(const std::string& option,
                                     const std::vector<std::string>& files) {
  Landmarks<Dim> landmarks = files.size() == 2 ? read_slicer_landmarks<Dim>(files[0], files[1])
                                               : read_landmarks<Dim>(files[0]);
  for (const std::string& file : files) report_.add_input(option, file);
  return landmarks;
}

void InputFiles::check_spacing_was_used() const {
  if (spacing_.empty() || spacing_used_) return;
  throw UsageError("--spacing is for images whose files tell none; these tell their own.");
}

template <typename Pixel, int Dim>
Image<Pixel, Dim> on_raster(const Image<Pixel, Dim>& image, const Raster<Dim>& raster) {
  if (same_raster(image.raster(), raster)) return Image<Pixel, Dim>(raster, image.values());
  return resample_nearest(image, raster, PointMap<Dim>([](const Point<Dim>& x) { return x; }),
                          Pixel());
}

bool has_ending(const std::string& file, const std::string& ending) {
  std::string lower = file;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower.ends_with(ending);
}

bool has_csv_column(const std::string& file, const std::string& column) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    if (line.empty() || line.front() == '#' || line.front() == '\r') continue;
    std::string cell;
    for (const char c : line + ",") {
      if (c == ',' || c == ';') {
        if (cell == column) return true;
        cell.clear();
      } else if (c != ' ' && c != '"' && c != '\r') {
        cell += c;
      }
    }
    return false;
  }
  return false;
}

template ReadImage<2> InputFiles::image<2>(const std::string&, const std::string&);
template ReadImage<3> InputFiles::image<3>(const std::string&, const std::string&);
template Mask<2> InputFiles::mask<2>(const std::string&, const std::string&);
template Mask<3> InputFiles::mask<3>(const std::string&, const std::string&);
template LabelImage<2> InputFiles::labels<2>(const std::string&, const std::string&);
template LabelImage<3> InputFiles::labels<3>(const std::string&, const std::string&);
template DisplacementField<2> InputFiles::displacement<2>(const std::string&, const std::string&);
template DisplacementField<3> InputFiles::displacement<3>(const std::string&, const std::string&);
template Landmarks<2> InputFiles::landmarks<2>(const std::string&, const std::vector<std::string>&);
template Landmarks<3> InputFiles::landmarks<3>(const std::string&, const std::vector<std::string>&);
template Mask<2> on_raster(const Mask<2>&, const Raster<2>&);
template Mask<3> on_raster(const Mask<3>&, const Raster<3>&);
template LabelImage<2> on_raster(const LabelImage<2>&, const Raster<2>&);
template LabelImage<3> on_raster(const LabelImage<3>&, const Raster<3>&);

}  // namespace crease
