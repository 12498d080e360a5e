#include "Testing/Experiments/ExperimentPictures.h"

#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Registration/Pictures.h"

namespace crease::experiments {

void write_pictures(const std::filesystem::path& folder, const std::string& name,
                    const Phantom& phantom, const Transform<2>& transform) {
  const auto& raster = phantom.fixed.raster();
  const auto moving = make_interpolator(phantom.moving);
  Image<float, 2> warped(raster), determinants(raster);
  parallel_for(raster.size[1], [&](std::int64_t j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      const int row = static_cast<int>(j);
      const Point<2> x = raster.point({static_cast<double>(i), static_cast<double>(j)});
      warped(i, row) = static_cast<float>(moving->evaluate(transform.map(x)).value);
      determinants(i, row) = static_cast<float>(transform.spatial_jacobian(x).determinant());
    }
  });
  const auto file = [&](const char* what) { return folder / (name + "_" + what + ".png"); };
  write_picture(file("fixed"), image_picture(phantom.fixed, "fixed"));
  write_picture(file("moving"), image_picture(phantom.moving, "moving"));
  write_picture(file("warped"), image_picture(warped, "warped"));
  write_picture(file("difference"), difference_picture(phantom.fixed, phantom.moving, warped));
  write_picture(file("jacobian"), jacobian_picture(determinants));
  DeformationDrawing<2> drawing;
  drawing.fixed_raster = raster;
  drawing.map = [&](const Point<2>& x) { return transform.map(x); };
  drawing.feature_lines = phantom.feature_lines;
  drawing.landmarks = phantom.landmarks;
  write_picture(file("grid"), deformation_picture(phantom.moving, drawing));
}

}  // namespace crease::experiments
