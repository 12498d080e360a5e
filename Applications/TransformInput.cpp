#include "Applications/TransformInput.h"

#include "Applications/InputFiles.h"
#include "Core/Error.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {

bool is_transform_file(const std::string& file) {
  for (const char* ending : {".json", ".tfm", ".h5"}) {
    if (has_ending(file, ending)) return true;
  }
  return false;
}

int transform_dimension(const std::vector<std::string>& files) {
  int dimension = 0;
  for (const std::string& file : files) {
    const TransformFileInfo info = peek_transform(file);
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
    parts.push_back(load_transform<Dim>(file));
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
