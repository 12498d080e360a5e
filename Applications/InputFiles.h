#pragma once

#include <string>
#include <vector>

#include "Applications/RunReport.h"
#include "Images/ImageFile.h"
#include "Registration/Landmarks.h"

namespace crease {

/// Reads the image files of one run: checks them, records them with their hash and turns the readers'
/// notes into warnings. Every error names the file.
class InputFiles {
 public:
  /// @param spacing  of images whose format tells none; empty: 1 mm. @param report  must outlive this.
  InputFiles(RunReport& report, std::vector<double> spacing = {})
      : report_(report), spacing_(std::move(spacing)) {}

  /// 2 or 3, as all of these files say.
  /// @throws InvalidInput when two of them differ; the message names both.
  static int common_dimension(const std::vector<std::string>& files);

  /// @throws InvalidInput when the image is empty or has pixels that are not finite (count and first index).
  template <int Dim>
  ReadImage<Dim> image(const std::string& option, const std::string& file);
  /// @throws InvalidInput when no pixel is set.
  template <int Dim>
  Mask<Dim> mask(const std::string& option, const std::string& file);
  template <int Dim>
  LabelImage<Dim> labels(const std::string& option, const std::string& file);
  template <int Dim>
  DisplacementField<Dim> displacement(const std::string& option, const std::string& file);
  /// One CSV file, or two files of 3D Slicer with the fixed points first.
  template <int Dim>
  Landmarks<Dim> landmarks(const std::string& option, const std::vector<std::string>& files);

  /// @throws UsageError when a spacing was given but every image told its own.
  void check_spacing_was_used() const;

 private:
  template <int Dim>
  void set_spacing(const std::string& file, Raster<Dim>& raster);

  RunReport& report_;
  std::vector<double> spacing_;
  bool spacing_used_ = false;
};

/// The pixel nearest to each sample of the raster; 0 beyond the image.
template <typename Pixel, int Dim>
Image<Pixel, Dim> on_raster(const Image<Pixel, Dim>& image, const Raster<Dim>& raster);

/// Whether the file's name ends so, in upper or lower case.
bool has_ending(const std::string& file, const std::string& ending);

/// Whether the file is a CSV table with this column, without reading its rows.
bool has_csv_column(const std::string& file, const std::string& column);

}  // namespace crease
