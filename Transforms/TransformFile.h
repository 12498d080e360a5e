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
  /// "affine", "rigid", "similarity", "composite", "spline", "cauchy-navier" or "displacement field".
  std::string type;
  std::string format = "crease";  ///< or "ITK text", "ITK HDF5", "ITK Matlab"
};

/// Writes a transform completely: the file alone rebuilds it, with the same bits in every number.
///
/// JSON with "format": "crease transform", "version", "dimensions" and "type", followed by the type's own
/// entries; lengths in mm, points in LPS. Displacement fields are base64 of little-endian doubles, or floats
/// where these hold every number. It is written under a temporary name and renamed when whole.
/// @throws InvalidInput when the transform is of no type that files hold. @throws FileError when it
/// cannot be written.
template <int InDim, int OutDim>
void save_transform(const Transform<InDim, OutDim>& transform, const std::filesystem::path& file);

/// Reads such a file, or one of ITK's: text (.tfm, .txt), HDF5 (.h5, .hdf5) or Matlab 4 (.mat, as ANTs
/// writes it), told apart by their contents. What becomes of ITK's classes: ItkFiles/ItkConversion.h. ITK's
/// B-splines are the identity outside their domain; there crease continues them.
/// @throws FileError when the file is missing, no transform file, of a later version, of other
/// dimensions, damaged or cut off, or of a class that crease lacks; the message names the entry at fault.
TransformFileInfo peek_transform(const std::filesystem::path& file);
template <int InDim, int OutDim = InDim>
std::unique_ptr<Transform<InDim, OutDim>> load_transform(const std::filesystem::path& file);

}  // namespace crease
