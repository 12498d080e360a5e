#include "Applications/TransformInput.h"

#include "Applications/InputFiles.h"
#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {

bool is_transform_file(const std::string& file) {
  for (const char* ending : {".json", ".tfm", ".txt", ".h5", ".hdf5", ".mat"}) {
    if (has_ending(file, ending)) return true;
  }
  return false;
}

namespace {

bool is_field_file(const std::string& file) {
  for (const char* ending : {".nii", ".nii.gz", ".mha", ".mhd", ".nrrd", ".nhdr"}) {
    if (has_ending(file, ending)) return true;
  }
  return false;
}

TransformFileInfo peek(const std::string& file) {
  if (!is_field_file(file)) return peek_transform(file);
  const ImageHeader header = read_image_header(file);
  if (header.num_components != header.dimension) {
    throw FileError(message(file, ": is an image of ", header.dimension, " dimensions with ",
                            header.num_components,
                            header.num_components == 1 ? " number" : " numbers",
                            " per pixel; a displacement field has ", header.dimension, "."));
  }
  return {header.dimension, header.dimension, "displacement field", "image"};
}

template <int Dim>
std::unique_ptr<Transform<Dim>> read_field(const std::string& file) {
  const DisplacementField<Dim> field = read_displacement_field<Dim>(file);
  ControlPoints<Dim> displacements(Dim, std::ssize(field.values()));
  for (Eigen::Index n = 0; n < displacements.cols(); ++n) {
    displacements.col(n) = field.values()[static_cast<std::size_t>(n)];
  }
  if (!displacements.allFinite()) {
    Eigen::Index n = 0;
    while (displacements.col(n).allFinite()) ++n;
    const auto index = field.index(n);
    throw InvalidInput(message(file, ": the displacement of pixel (", index[0], ", ", index[1],
                               Dim == 3 ? message(", ", index[Dim - 1]) : "",
                               ") is not finite; replace such values, for example by 0."));
  }
  return std::make_unique<DisplacementFieldTransform<Dim>>(field.raster(),
                                                           std::move(displacements));
}

}  // namespace

int transform_dimension(const std::vector<std::string>& files) {
  int dimension = 0;
  for (const std::string& file : files) {
    const TransformFileInfo info = peek(file);
    if (info.in_dim != info.out_dim) {
      throw InvalidInput(message(file, ": maps from ", info.in_dim, "D to ", info.out_dim,
                                 "D; this is a surface, not a map between images."));
    }
    if (dimension == 0) dimension = info.in_dim;
    if (info.in_dim == dimension) continue;
    throw InvalidInput(message(files.front(), " is ", dimension, "D, but ", file, " is ",
                               info.in_dim, "D; a chain needs transforms of one dimension."));
  }
  return dimension;
}

template <int Dim>
std::unique_ptr<Transform<Dim>> read_transforms(RunReport& report,
                                                const std::vector<std::string>& files) {
  std::vector<std::unique_ptr<Transform<Dim>>> parts;
  for (const std::string& file : files) {
    parts.push_back(is_field_file(file) ? read_field<Dim>(file) : load_transform<Dim>(file));
    report.add_input("transform", file);
  }
  if (parts.size() == 1) return std::move(parts.front());
  return std::make_unique<CompositeTransform<Dim>>(std::move(parts));
}

template std::unique_ptr<Transform<2>> read_transforms<2>(RunReport&,
                                                          const std::vector<std::string>&);
template std::unique_ptr<Transform<3>> read_transforms<3>(RunReport&,
                                                          const std::vector<std::string>&);

}  // namespace crease
