#include "Transforms/ItkFiles/ReadItkFile.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>

#include "Core/Error.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

enum class Form { kNone, kText, kHdf5, kMatlab };

constexpr std::string_view kHdf5Mark("\x89HDF\r\n\x1a\n", 8);
constexpr std::string_view kMatlab5Mark = "MATLAB 5.0 MAT-file";

Form form_of_ending(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".tfm" || ending == ".txt") return Form::kText;
  if (ending == ".h5" || ending == ".hdf5") return Form::kHdf5;
  if (ending == ".mat") return Form::kMatlab;
  return Form::kNone;
}

/// The first bytes; empty when the file cannot be read.
std::string head_of(const fs::path& file) {
  std::string head(512 + kHdf5Mark.size(), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
  return head;
}

Form form_of(const fs::path& file, const std::string& head) {
  const std::string_view text = head;
  if (text.starts_with("#Insight Transform File")) return Form::kText;
  if (text.starts_with(kHdf5Mark)) return Form::kHdf5;
  if (text.size() > 512 && text.substr(512).starts_with(kHdf5Mark)) return Form::kHdf5;
  return form_of_ending(file);
}

}  // namespace

bool is_itk_file(const fs::path& file) { return form_of(file, head_of(file)) != Form::kNone; }

ItkTransformList read_itk_file(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    throw FileError(message(file.string(), ": cannot be opened: there is no such file."));
  }
  if (fs::is_directory(file, ignored)) {
    throw FileError(message(file.string(), ": is a folder, not a transform file."));
  }
  const std::string head = head_of(file);
  if (head.empty()) throw FileError(message(file.string(), ": is empty or cannot be read."));
  switch (form_of(file, head)) {
    case Form::kText:
      return {file, "ITK text", read_itk_text(file)};
    case Form::kHdf5:
      if (head.find(kHdf5Mark) == std::string::npos) {
        throw FileError(message(file.string(), ": is not an HDF5 file, though its name says so."));
      }
      return {file, "ITK HDF5", read_itk_hdf5(file)};
    case Form::kMatlab:
      if (head.starts_with(kMatlab5Mark)) {
        throw FileError(
            message(file.string(),
                    ": was saved by Matlab itself; transforms of ITK and ANTs are files "
                    "of Matlab 4."));
      }
      return {file, "ITK Matlab", read_itk_matlab(file)};
    case Form::kNone:
      break;
  }
  throw FileError(message(file.string(), ": is not a transform file of ITK."));
}

}  // namespace crease
