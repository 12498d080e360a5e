#pragma once

#include <filesystem>
#include <string>

#include "Geometry/SurfaceMesh.h"

// Forms of mesh files that need a file of their own here. Errors are those of SurfaceMeshFile.h.
namespace crease {

/// Polygons of a .ply file: text, or binary of either order of bytes.
SurfaceMesh read_ply(const std::filesystem::path& path);

/// Triangles of an .stl file, text or binary. The form repeats every corner: corners of the same
/// coordinates become one vertex, and triangles with two equal corners are passed over.
SurfaceMesh read_stl(const std::filesystem::path& path);

/// A mesh as .stl text, numbers with all their digits (binary files hold single precision only); polygons
/// are cut into triangles from their first corner.
std::string stl_text(const SurfaceMesh& mesh);

}  // namespace crease
