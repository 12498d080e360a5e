#include "Images/RasterCheck.h"

#include "Core/Error.h"

namespace crease {
namespace {

template <typename Values>
std::string join(const Values& values, int count, const char* separator) {
  std::ostringstream text;
  for (int a = 0; a < count; ++a) text << (a == 0 ? "" : separator) << values[a];
  return text.str();
}

}  // namespace

template <int Dim>
void check_raster(const Raster<Dim>& raster, std::string_view what) {
  for (int size : raster.size) {
    if (size < 1) {
      throw InvalidInput(
          message(what, ": a size of ", join(raster.size, Dim, " x "), " pixels holds no image"));
    }
  }
  if (!raster.origin.allFinite()) {
    throw InvalidInput(
        message(what, ": the origin (", join(raster.origin, Dim, ", "), ") mm is not finite"));
  }
  if (!raster.spacing.allFinite() || !(raster.spacing.array() > 0).all()) {
    throw InvalidInput(message(what, ": the spacing (", join(raster.spacing, Dim, ", "),
                               ") mm must be positive along every axis"));
  }
  const Matrix<Dim> product = raster.direction.transpose() * raster.direction;
  const double deviation = (product - Matrix<Dim>::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= 1e-6)) {
    throw InvalidInput(message(what, ": the axes are not orthogonal unit vectors (off by ",
                               deviation, "); resample the image onto orthogonal axes"));
  }
}

template <int Dim>
bool same_raster(const Raster<Dim>& a, const Raster<Dim>& b, double tolerance) {
  if (a.size != b.size) return false;
  const double limit = tolerance * a.spacing.minCoeff();
  for (int corner = 0; corner < (1 << Dim); ++corner) {
    Vector<Dim> index;
    for (int d = 0; d < Dim; ++d) index[d] = (corner >> d & 1) ? a.size[d] - 1 : 0;
    if (!((a.point(index) - b.point(index)).norm() <= limit)) return false;
  }
  return true;
}

template <int Dim>
std::string describe(const Raster<Dim>& raster) {
  return message(join(raster.size, Dim, " x "), " pixels of ", join(raster.spacing, Dim, " x "),
                 " mm at (", join(raster.origin, Dim, ", "), ") mm");
}

template void check_raster<2>(const Raster<2>&, std::string_view);
template void check_raster<3>(const Raster<3>&, std::string_view);
template bool same_raster<2>(const Raster<2>&, const Raster<2>&, double);
template bool same_raster<3>(const Raster<3>&, const Raster<3>&, double);
template std::string describe<2>(const Raster<2>&);
template std::string describe<3>(const Raster<3>&);

}  // namespace crease
