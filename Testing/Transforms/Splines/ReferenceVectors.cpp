#include "Testing/Transforms/Splines/ReferenceVectors.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace crease::testing {

std::filesystem::path vectors_folder() {
  const char* chosen = std::getenv("CREASE_VECTORS_DIR");
  const std::filesystem::path folder =
      chosen ? std::filesystem::path(chosen)
             : std::filesystem::path(CREASE_SHARED_DIR) / "spec" / "vectors";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

std::vector<nlohmann::json> reference_vectors(const std::string& kind, int dim) {
  std::vector<nlohmann::json> result;
  const auto folder = vectors_folder();
  if (folder.empty()) return result;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& path : files) {
    std::ifstream stream(path);
    auto file = nlohmann::json::parse(stream);
    if (file["kind"] != kind) continue;
    if (!file.contains("dim") || file["dim"] == dim) result.push_back(std::move(file));
  }
  return result;
}

std::vector<double> numbers(const nlohmann::json& array) {
  std::vector<double> result;
  for (const auto& entry : array) {
    result.push_back(entry.is_string() ? std::stod(entry.get<std::string>()) : entry.get<double>());
  }
  return result;
}

}  // namespace crease::testing
