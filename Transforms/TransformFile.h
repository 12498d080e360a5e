#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "Transforms/Transform.h"

namespace crease {

/// What a transform file says before its contents.
struct TransformFileInfo {
  int in_dim = 0;
  int out_dim = 0;
  std::string type;  ///< "affine", "rigid", "composite" or "spline"
};

/// Writes a transform completely: the file alone rebuilds it, with the same bits in every number.
///
/// JSON with "format": "crease transform", "version", "dimensions" and "type", followed by the type's own
/// entries; lengths in mm, points in LPS. It is written under a temporary name and renamed when whole.
/// @throws InvalidInput when the transform is of no type that files hold. @throws FileError when it
/// cannot be written.
template <int InDim, int OutDim>
void save_transform(const Transform<InDim, OutDim>& transform, const std::filesystem::path& file);

/// @throws FileError when the file is missing, no transform file, of a later version, of other
/// dimensions or damaged; the message names the entry at fault.
TransformFileInfo peek_transform(const std::filesystem::path& file);
template <int InDim, int OutDim = InDim>
std::unique_ptr<Transform<InDim, OutDim>> load_transform(const std::filesystem::path& file);

}  // namespace crease
