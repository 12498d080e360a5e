#include "Transforms/Splines/KnotBorder.h"

#include <algorithm>
#include <map>

#include "Core/Error.h"

namespace crease {
template <int Dim>
std::vector<std::array<int, Dim>> border_facets(const SimplexMesh<Dim>& mesh) {
  struct Entry {
    int simplices = 0;
    std::array<int, Dim> facet{};
  };
  std::map<std::array<int, Dim>, Entry> facets;
  for (const auto& simplex : mesh.simplices) {
    for (int d = 0; d <= Dim; ++d) {
      std::array<int, Dim> facet{};
      for (int j = 0, k = 0; j <= Dim; ++j) {
        if (j != d) facet[k++] = simplex[j];
      }
      auto key = facet;
      std::sort(key.begin(), key.end());
      Entry& entry = facets[key];
      entry.facet = facet;
      if (++entry.simplices > 2) {
        throw InvalidInput(message("mesh: more than two simplices share the facet with vertices ",
                                   key[0], " and ", key[1], "."));
      }
    }
  }
  std::vector<std::array<int, Dim>> border;
  for (const auto& [key, entry] : facets) {
    if (entry.simplices == 1) border.push_back(entry.facet);
  }
  return border;
}

template std::vector<std::array<int, 2>> border_facets<2>(const SimplexMesh<2>&);
template std::vector<std::array<int, 3>> border_facets<3>(const SimplexMesh<3>&);

}  // namespace crease
