#include <dlfcn.h>

#include "Core/Error.h"
#include "Transforms/ItkFiles/Hdf5Plugin.h"
#include "Transforms/ItkFiles/ReadItkFile.h"

namespace crease {
namespace {

namespace fs = std::filesystem;
using ReadHdf5 = decltype(&crease_read_itk_hdf5);

/// The folder of the library that this code is in.
fs::path own_folder() {
  Dl_info info;
  const auto* address = reinterpret_cast<const void*>(&read_itk_hdf5);
  if (dladdr(address, &info) == 0 || info.dli_fname == nullptr) return {};
  return fs::absolute(info.dli_fname).parent_path();
}

ReadHdf5 load_plugin(const fs::path& file) {
  const fs::path library = own_folder() / "libcrease_transforms_hdf5.so";
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded
  void* function = handle == nullptr ? nullptr : dlsym(handle, "crease_read_itk_hdf5");
  if (function == nullptr) {
    throw FileError(message(file.string(),
                            ": HDF5 files are read by a part of crease that is missing (",
                            dlerror(), "); install it, or save the transform as .tfm."));
  }
  return reinterpret_cast<ReadHdf5>(function);
}

}  // namespace

std::vector<ItkTransform> read_itk_hdf5(const fs::path& file) {
  static const ReadHdf5 read = load_plugin(file);
  std::vector<ItkTransform> transforms;
  read(file, transforms);
  return transforms;
}

}  // namespace crease
