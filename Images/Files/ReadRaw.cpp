#include "Images/Files/ReadRaw.h"

#include <Eigen/SVD>
#include <cmath>

#include "Core/Error.h"
#include "Core/WholeFile.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"
#include "Images/Files/ItkImageFile.h"
#include "Images/Files/JpegFile.h"
#include "Images/Files/PortableGraymap.h"

namespace crease {
namespace {

/// Headers hold rounded numbers: directions this far from orthonormal are rounded back to it.
constexpr double kDirectionTolerance = 1e-3;

std::string list(const std::vector<int>& size) {
  std::ostringstream text;
  for (std::size_t a = 0; a < size.size(); ++a) text << (a == 0 ? "" : " x ") << size[a];
  return text.str();
}

Eigen::MatrixXd direction_of(const RawImage& image) {
  const auto n = std::ssize(image.size);
  return Eigen::Map<const Eigen::MatrixXd>(image.direction.data(), n, n);
}

void set_direction(RawImage& image, const Eigen::MatrixXd& direction) {
  image.direction.assign(direction.data(), direction.data() + direction.size());
}

/// Vectors of a field are turned into the plane's coordinates, too.
void project_vectors(const Eigen::MatrixXd& plane, RawImage& image) {
  with_pixel_type(image.type, [&](auto zero) {
    using T = decltype(zero);
    T* values = image.values<T>();
    for (std::int64_t p = 0; p < image.num_pixels(); ++p) {
      const Eigen::Vector3d v(static_cast<double>(values[3 * p]),
                              static_cast<double>(values[3 * p + 1]),
                              static_cast<double>(values[3 * p + 2]));
      for (int a = 0; a < 2; ++a) values[2 * p + a] = static_cast<T>(plane.col(a).dot(v));
    }
  });
  image.num_components = 2;
}

/// A single slice of a volume becomes a 2D image: its xy coordinates if it lies in such a plane,
/// otherwise the coordinates along its own axes.
void drop_slice_axis(RawImage& image) {
  Eigen::MatrixXd plane = direction_of(image).leftCols(2);
  const bool in_xy = plane.row(2).cwiseAbs().maxCoeff() < 1e-6;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(3, 2);  // of the coordinates that are kept
  if (!in_xy) {
    basis = plane;
    image.notes.emplace_back(
        "the slice is not parallel to the xy plane: coordinates are those within its own plane");
  }
  const bool vectors = !image.colour && image.num_components == 3 && image.data != nullptr;
  if (vectors) project_vectors(basis, image);
  const Eigen::Vector3d origin(image.origin[0], image.origin[1], image.origin[2]);
  const Eigen::Vector2d projected = basis.transpose() * origin;
  image.origin = {projected[0], projected[1]};
  image.spacing.resize(2);
  image.size.resize(2);
  set_direction(image, basis.transpose() * plane);
}

void reduce_dimension(const std::filesystem::path& path, RawImage& image) {
  const std::string size = list(image.size);
  const auto before = std::ssize(image.size);
  const Eigen::MatrixXd direction = direction_of(image);
  while (image.size.size() > 3 && image.size.back() == 1) image.size.pop_back();
  const auto dimension = std::ssize(image.size);
  if (dimension < 2 || dimension > 3) {
    fail(path, message("an image of ", size, " pixels has ", dimension,
                       " dimensions; only 2 and 3 are supported: extract one volume"));
  }
  if (dimension == before) return;
  image.spacing.resize(image.size.size());
  image.origin.resize(image.size.size());
  set_direction(image, direction.topLeftCorner(dimension, dimension));
}

void check_geometry(const std::filesystem::path& path, RawImage& image) {
  for (std::size_t a = 0; a < image.size.size(); ++a) {
    if (!std::isfinite(image.spacing[a]) || !(image.spacing[a] > 0)) {
      fail(path, message("the spacing along axis ", a + 1, " is ", image.spacing[a],
                         " mm; it must be positive: correct the file's header"));
    }
    if (!std::isfinite(image.origin[a])) {
      fail(path, message("the origin along axis ", a + 1, " is ", image.origin[a], " mm"));
    }
  }
  const Eigen::MatrixXd direction = direction_of(image);
  const auto identity = Eigen::MatrixXd::Identity(direction.rows(), direction.cols());
  const double deviation = (direction.transpose() * direction - identity).cwiseAbs().maxCoeff();
  if (!(deviation <= kDirectionTolerance)) {
    fail(path, "its axes are not at right angles; resample the image onto orthogonal axes");
  }
  if (deviation > 0) {  // the nearest orthonormal matrix
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(direction,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    set_direction(image, svd.matrixU() * svd.matrixV().transpose());
  }
}

template <typename T>
void mix_colours(const RawImage& image, float* grey, bool& coloured) {
  const T* values = image.values<T>();
  for (std::int64_t p = 0; p < image.num_pixels(); ++p) {
    const T* rgb = values + p * image.num_components;
    coloured = coloured || rgb[0] != rgb[1] || rgb[0] != rgb[2];
    grey[p] = static_cast<float>(0.299 * static_cast<double>(rgb[0]) +
                                 0.587 * static_cast<double>(rgb[1]) +
                                 0.114 * static_cast<double>(rgb[2]));
  }
}

template <typename T>
void keep_first_component(RawImage& image) {
  T* values = image.values<T>();
  for (std::int64_t p = 0; p < image.num_pixels(); ++p)
    values[p] = values[p * image.num_components];
}

/// ITK tells NIfTI files by their names, in small letters: another name gets a link with such a one.
RawImage read_nifti_by_name(const std::filesystem::path& path, bool with_pixels) {
  const std::string name = path.filename().string();
  for (const char* ending : {".nii", ".nii.gz", ".hdr", ".img", ".hdr.gz", ".img.gz"}) {
    if (name.ends_with(ending)) return read_with_itk(path, ImageFormat::kNifti, with_pixels);
  }
  const TemporaryFolder folder(std::filesystem::temp_directory_path());
  const bool compressed = ByteReader(read_bytes(path, 2), true).number(0, 2) == 0x1f8b;
  const auto link = folder.path() / (compressed ? "image.nii.gz" : "image.nii");
  std::filesystem::create_symlink(std::filesystem::absolute(path), link);
  return read_with_itk(link, ImageFormat::kNifti, with_pixels);
}

RawImage read_nifti(const std::filesystem::path& path, bool with_pixels) {
  const NiftiFacts facts = check_nifti(path);
  RawImage image = read_nifti_by_name(path, with_pixels);
  image.spacing_known = true;
  if (!with_pixels || facts.not_finite.empty()) return image;
  // In the file a whole image of each component follows the other; here they stand side by side.
  const std::int64_t pixels = image.num_pixels();
  with_pixel_type(image.type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (std::is_floating_point_v<T>) {
      for (const auto& [position, value] : facts.not_finite) {
        image.values<T>()[position % pixels * image.num_components + position / pixels] =
            static_cast<T>(value);
      }
    }
  });
  return image;
}

/// Reads the file in its own format.
RawImage decode(const std::filesystem::path& path, ImageFormat format, bool with_pixels) {
  if (format == ImageFormat::kPgm) return read_pgm(path, with_pixels);
  if (format == ImageFormat::kJpeg) return read_jpeg(path, with_pixels);
  if (format == ImageFormat::kNifti) return read_nifti(path, with_pixels);
  if (format != ImageFormat::kDicom) {
    const FileFacts facts = check_file(path, format);
    RawImage image = read_with_itk(path, format, with_pixels);
    image.spacing_known = facts.has_spacing;
    return image;
  }
  const DicomFacts facts = check_dicom(path);
  RawImage image = read_with_itk(path, format, with_pixels);
  image.spacing_known = facts.has_spacing;
  if (!facts.has_spacing) {
    image.notes.emplace_back("the file does not say how large its pixels are: 1 mm is assumed");
  }
  if (facts.monochrome1) {
    image.notes.emplace_back(
        "MONOCHROME1: the stored values are turned round, high values are bright");
  }
  return image;
}

}  // namespace

RawImage read_raw(const std::filesystem::path& path, bool with_pixels) {
  RawImage image = decode(path, image_format(path), with_pixels);
  reduce_dimension(path, image);
  check_geometry(path, image);
  if (image.size.size() == 3 && image.size[2] == 1) drop_slice_axis(image);
  return image;
}

void make_grey(const std::filesystem::path& path, RawImage& image) {
  if (image.num_components == 1) return;
  if (!image.colour) {
    fail(path, message("it holds vectors of ", image.num_components,
                       " components, not an image of grey values"));
  }
  if (image.num_components == 2 || image.num_components == 4) {
    image.notes.emplace_back("transparency ignored");
  }
  if (image.num_components == 2) {
    with_pixel_type(image.type, [&](auto zero) { keep_first_component<decltype(zero)>(image); });
    image.num_components = 1;
    return;
  }
  RawImage grey;
  grey.size = image.size;
  grey.type = PixelType::kFloat;
  grey.allocate();
  bool coloured = false;
  with_pixel_type(image.type, [&](auto zero) {
    mix_colours<decltype(zero)>(image, grey.values<float>(), coloured);
  });
  if (coloured) image.notes.emplace_back("colour converted to grey");
  image.type = PixelType::kFloat;
  image.num_components = 1;
  image.data = std::move(grey.data);
}

}  // namespace crease
