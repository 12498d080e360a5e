#pragma once

#include <filesystem>

#include "Geometry/SurfaceMesh.h"

namespace crease {

/// Whether the name's ending is one of a mesh file: .obj, .off or .ply, in small or capital letters.
bool is_surface_mesh_file(const std::filesystem::path& path);

/// Reads vertices and faces of a Wavefront .obj, Geomview .off or .ply file (text). Normals, colours, texture
/// coordinates and groups are passed over.
/// @throws FileError when the file cannot be read; InvalidInput naming file, line and what is wrong.
SurfaceMesh read_surface_mesh(const std::filesystem::path& path);

/// Writes the form that the ending names, numbers with all their digits.
/// @throws InvalidInput for another ending; FileError when the file cannot be written.
void write_surface_mesh(const std::filesystem::path& path, const SurfaceMesh& mesh);

}  // namespace crease
