#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Images/Resample.h"
#include "Registration/Landmarks.h"
#include "Transforms/Domains/FeatureLine.h"
#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// A picture for people: 3 bytes (red, green, blue) per pixel, row by row from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Writes a PNG file. @throws FileError when it cannot be written.
void write_picture(const std::filesystem::path& path, const Picture& picture);

// The pictures below show images enlarged or shrunk so that the longer side has 560 to 1200 pixels,
// in true proportions, grey from the 1 % to the 99 % percentile; volumes by their three middle
// slices.

/// An image alone, under a title.
template <int Dim>
Picture image_picture(const Image<float, Dim>& image, const std::string& title);

/// Squares of the fixed and the warped image in turn: what crosses from square to square must meet.
/// @param shared_window  both in the fixed image's grey window; false (other modality): each in its
/// own.
/// @throws InvalidInput when the images differ in size (likewise below).
template <int Dim>
Picture checkerboard_picture(const Image<float, Dim>& fixed, const Image<float, Dim>& warped,
                             bool shared_window = true);

/// before - fixed and after - fixed side by side in one diverging scale, with a legend. Pixels that
/// are not finite (warped from outside the moving image) are grey and not in the rms.
/// @param body  samples of the rms; null: all.
template <int Dim>
Picture difference_picture(const Image<float, Dim>& fixed, const Image<float, Dim>& before,
                           const Image<float, Dim>& after, const Mask<Dim>* body = nullptr);

/// det grad T in logarithmic diverging colours about 1 (blue: shrinks from fixed to moving, red:
/// grows); folded pixels (det <= 0) in neon green, however small; pixels without a finite value in
/// grey.
template <int Dim>
Picture jacobian_picture(const Image<float, Dim>& determinants);

/// The strain of T, |E| with E the Green-St. Venant strain (StrainMap.h), from dark blue (0: rigid) over
/// green to yellow.
template <int Dim>
Picture strain_picture(const Image<float, Dim>& strain);

/// What to draw over the moving image.
template <int Dim>
struct DeformationDrawing {
  Raster<Dim> fixed_raster;                ///< whose grid is mapped
  PointMap<Dim> map;                       ///< T
  int grid_lines = 24;                     ///< along the longer side; 0: none
  const SimplexMesh<Dim>* mesh = nullptr;  ///< its edges are mapped instead of the grid (2D)
  std::vector<FeatureLine> feature_lines;  ///< of the fixed image (2D)
  Landmarks<Dim> landmarks;
};

/// The fixed image's grid and feature lines mapped by T, drawn over the moving image: where T is
/// rigid the grid stays square, along creases it bends. Landmarks: a ring at the moving point, a
/// cross at T(fixed point).
template <int Dim>
Picture deformation_picture(const Image<float, Dim>& moving,
                            const DeformationDrawing<Dim>& drawing);

extern template Picture image_picture<2>(const Image<float, 2>&, const std::string&);
extern template Picture image_picture<3>(const Image<float, 3>&, const std::string&);
extern template Picture checkerboard_picture<2>(const Image<float, 2>&, const Image<float, 2>&,
                                                bool);
extern template Picture checkerboard_picture<3>(const Image<float, 3>&, const Image<float, 3>&,
                                                bool);
extern template Picture difference_picture<2>(const Image<float, 2>&, const Image<float, 2>&,
                                              const Image<float, 2>&, const Mask<2>*);
extern template Picture difference_picture<3>(const Image<float, 3>&, const Image<float, 3>&,
                                              const Image<float, 3>&, const Mask<3>*);
extern template Picture jacobian_picture<2>(const Image<float, 2>&);
extern template Picture jacobian_picture<3>(const Image<float, 3>&);
extern template Picture strain_picture<2>(const Image<float, 2>&);
extern template Picture strain_picture<3>(const Image<float, 3>&);
extern template Picture deformation_picture<2>(const Image<float, 2>&,
                                               const DeformationDrawing<2>&);
extern template Picture deformation_picture<3>(const Image<float, 3>&,
                                               const DeformationDrawing<3>&);

}  // namespace crease
