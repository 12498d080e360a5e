#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Applications/ElasticCommandOptions.h"
#include "Applications/InputFiles.h"
#include "Registration/Elastic/ElasticRegistration.h"
#include "Registration/Mammogram/MammogramAnatomy.h"

namespace crease {

/// All that `crease elastic` starts from: files read and checked, mammograms looked at.
struct ElasticInput {
  /// The whole fixed image as the body, and no pairs yet.
  ElasticInput(ReadImage<2> fixed_image, ReadImage<2> moving_image);

  ReadImage<2> fixed;   ///< bright tissue, its pixel size mended where the file tells none
  ReadImage<2> moving;  ///< the same, and on a mirrored raster where left and right are swapped
  /// From the moving image as registered to the image as given, mm: the identity unless mirrored.
  AffineMap<2> to_given;
  bool mirrored = false;
  bool nipple_used = false;                                       ///< as a pair
  int muscle_label = 0;                                           ///< 0: no muscle
  std::optional<MammogramAnatomy> fixed_anatomy, moving_anatomy;  ///< where they are needed
  RegionOfInterest region;                                        ///< the elastic body
  std::optional<RegionOfInterest> moving_region;                  ///< where it is known
  std::vector<FeatureLine> lines;
  std::optional<LabelImage<2>> labels;
  Landmarks<2> pairs;  ///< moving points in the image as registered
  int num_pectoral_pairs = 0;
  std::vector<int> contour;                   ///< numbers of those along the skin, in order
  std::vector<std::string> notes;             ///< of the search in the images
  std::optional<DisplacementField<2>> truth;  ///< into the moving image as given

  bool has_muscle() const { return muscle_label > 0; }
  int num_contour_pairs() const { return static_cast<int>(contour.size()); }
  int num_given_pairs() const { return pairs.size() - num_contour_pairs() - num_pectoral_pairs; }
  /// A muscle of which the options say nothing is ten times as stiff as the breast.
  ElasticBody body(const MaterialOptions& material) const;
};

/// @throws FileError, InvalidInput naming the file; UsageError naming the option.
ElasticInput read_input(const ElasticCommandOptions& options, RunReport& report);

}  // namespace crease
