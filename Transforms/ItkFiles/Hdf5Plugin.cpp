#include "Transforms/ItkFiles/Hdf5Plugin.h"

#include <hdf5.h>

#include <string>

#include "Core/Error.h"

namespace crease {
namespace {

/// A handle of HDF5, closed when it goes.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Without a lock, which some network file systems refuse.
hid_t open(const std::filesystem::path& file) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access, /*use_file_locking=*/false, /*ignore_when_disabled=*/true);
  return H5Fopen(file.c_str(), H5F_ACC_RDONLY, access);
}

/// ITK's layout: /TransformGroup/k holds "TransformType" (a text) and, but for composites,
/// "TransformFixedParameters" and "TransformParameters". Before ITK 5 both names began with "Tranform".
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& file)
      : name_(file.string()), file_(open(file), H5Fclose) {
    if (!file_.valid()) fail("is not a complete HDF5 file; it may be cut off or damaged");
  }

  std::vector<ItkTransform> read() {
    if (!exists("/TransformGroup")) {
      fail("holds no transform of ITK: there is no group \"/TransformGroup\"");
    }
    std::vector<ItkTransform> transforms;
    while (true) {
      const std::string group = message("/TransformGroup/", transforms.size());
      if (!exists(group)) break;
      transforms.push_back({text(group + "/TransformType"), numbers(group, "FixedParameters"),
                            numbers(group, "Parameters")});
    }
    if (transforms.empty()) fail("holds no transform");
    return transforms;
  }

 private:
  bool exists(const std::string& path) const {
    return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
  }

  std::string text(const std::string& path) const {
    if (!exists(path)) fail(message("lacks \"", path, "\""));
    const Handle data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(data.valid() ? H5Dget_type(data) : -1, H5Tclose);
    const Handle space(data.valid() ? H5Dget_space(data) : -1, H5Sclose);
    if (!type.valid() || H5Tget_class(type) != H5T_STRING ||
        H5Sget_simple_extent_npoints(space) != 1) {
      fail(message("\"", path, "\" is not a text"));
    }
    const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    if (H5Tis_variable_str(type) > 0) {
      char* value = nullptr;
      H5Tset_size(memory, H5T_VARIABLE);
      if (H5Dread(data, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0 || value == nullptr) {
        fail(message("\"", path, "\" cannot be read"));
      }
      std::string result = value;
      H5free_memory(value);
      return result;
    }
    std::string result(H5Tget_size(type), '\0');
    if (result.size() > 1000 ||
        H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.data()) < 0) {
      fail(message("\"", path, "\" cannot be read"));
    }
    return result.c_str();  // up to the first zero
  }

  /// None where there is no such entry: composites have none.
  Eigen::VectorXd numbers(const std::string& group, const std::string& which) const {
    for (const char* beginning : {"/Transform", "/Tranform"}) {
      const std::string path = group + beginning + which;
      if (exists(path)) return numbers(path);
    }
    return {};
  }

  Eigen::VectorXd numbers(const std::string& path) const {
    const Handle data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(data.valid() ? H5Dget_type(data) : -1, H5Tclose);
    const Handle space(data.valid() ? H5Dget_space(data) : -1, H5Sclose);
    if (!type.valid() || H5Tget_class(type) != H5T_FLOAT || !space.valid()) {
      fail(message("\"", path, "\" is not a list of numbers"));
    }
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count < 0 || count > hssize_t{10'000'000'000}) {
      fail(message("\"", path, "\" has ", count, " numbers"));
    }
    Eigen::VectorXd values(count);
    if (count > 0 &&
        H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      fail(message("\"", path, "\" cannot be read; the file may be cut off or damaged"));
    }
    return values;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(message(name_, ": ", what, "."));
  }

  std::string name_;
  Handle file_;
};

}  // namespace
}  // namespace crease

extern "C" void crease_read_itk_hdf5(const std::filesystem::path& file,
                                     std::vector<crease::ItkTransform>& transforms) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are ours to tell
  transforms = crease::Hdf5Reader(file).read();
}
