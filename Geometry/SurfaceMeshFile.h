#pragma once

#include <filesystem>

#include "Geometry/SurfaceMesh.h"

namespace crease {

/// Whether the name's ending is one of a mesh file: .obj, .off, .ply or .stl, in small or capital letters.
bool is_surface_mesh_file(const std::filesystem::path& path);

/// Reads vertices and faces of a Wavefront .obj, Geomview .off, .ply or .stl file (the last two text or
/// binary). Normals, colours, texture coordinates and groups are passed over. Corners of .stl triangles with
/// the same coordinates are one vertex.
/// @throws FileError when the file cannot be read; InvalidInput naming file, line and what is wrong.
SurfaceMesh read_surface_mesh(const std::filesystem::path& path);

/// Writes the form that the ending names, as text, numbers with all their digits; polygons of .stl files are cut
/// into triangles.
/// @throws InvalidInput for another ending; FileError when the file cannot be written.
void write_surface_mesh(const std::filesystem::path& path, const SurfaceMesh& mesh);

}  // namespace crease
