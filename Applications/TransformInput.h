#pragma once

#include <memory>
#include <string>
#include <vector>

#include "Applications/RunReport.h"
#include "Transforms/Transform.h"

namespace crease {

/// Whether the name says so: .json, or ITK's .tfm, .txt, .h5, .hdf5 and .mat.
bool is_transform_file(const std::string& file);

// An image of vectors (.nii, .nii.gz, .mha, .mhd, .nrrd) is a transform, too: a DisplacementFieldTransform.

/// 2 or 3, as all of these transform files say.
/// @throws FileError for a file that is no transform of an image; InvalidInput when two differ.
int transform_dimension(const std::vector<std::string>& files);

/// Reads the files, records them as inputs and applies the first one first.
template <int Dim>
std::unique_ptr<Transform<Dim>> read_transforms(RunReport& report,
                                                const std::vector<std::string>& files);

}  // namespace crease
