#include "Transforms/Splines/KnotLocator.h"

#include <algorithm>
#include <cmath>

#include "Transforms/Splines/SimplexSpline.h"

namespace crease {

template <int Dim>
KnotLocator<Dim>::KnotLocator(const SimplexMesh<Dim>& mesh, double tie)
    : box_(bounding_box<Dim>(mesh.vertices)), tie_(tie) {
  const auto count = mesh.simplices.size();
  const double cells_per_axis = std::pow(2.0 * static_cast<double>(count), 1.0 / Dim);
  const double extent = box_.size().maxCoeff();
  int num_cells = 1;
  for (int a = 0; a < Dim; ++a) {
    const double share = box_.size()[a] / extent;
    size_[a] = std::clamp(static_cast<int>(std::ceil(cells_per_axis * share)), 1, 4096);
    cells_per_mm_[a] = size_[a] / box_.size()[a];
    num_cells *= size_[a];
  }

  facets_.resize(count);
  std::vector<Box<Dim>> boxes(count);
  for (std::size_t s = 0; s < count; ++s) {
    const auto corners = simplex_corners(mesh, static_cast<int>(s));
    facets_[s].normals = barycentric_gradients<Dim>(corners).colwise().normalized();
    for (int j = 0; j <= Dim; ++j) {
      facets_[s].offsets[j] = facets_[s].normals.col(j).dot(corners[j == 0 ? 1 : 0]);
    }
    boxes[s] = bounding_box<Dim>(corners);
    boxes[s].lower.array() -= tie;
    boxes[s].upper.array() += tie;
  }

  cell_start_.assign(num_cells + 1, 0);
  for (const Box<Dim>& box : boxes) for_cells_of(box, [&](int c) { ++cell_start_[c + 1]; });
  for (int c = 0; c < num_cells; ++c) cell_start_[c + 1] += cell_start_[c];
  simplices_.resize(cell_start_.back());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t s = 0; s < count; ++s) {
    for_cells_of(boxes[s], [&](int c) { simplices_[next[c]++] = static_cast<int>(s); });
  }
}

template <int Dim>
std::array<int, Dim> KnotLocator<Dim>::cell(const Point<Dim>& u) const {
  std::array<int, Dim> result;
  for (int a = 0; a < Dim; ++a) {
    const double t = (u[a] - box_.lower[a]) * cells_per_mm_[a];
    result[a] = static_cast<int>(std::clamp(t, 0.0, size_[a] - 1.0));
  }
  return result;
}

template <int Dim>
int KnotLocator<Dim>::cell_number(const std::array<int, Dim>& cell) const {
  int number = cell[Dim - 1];
  for (int a = Dim - 2; a >= 0; --a) number = number * size_[a] + cell[a];
  return number;
}

template <int Dim>
template <typename Visitor>
void KnotLocator<Dim>::for_cells_of(const Box<Dim>& box, const Visitor& visit) const {
  const auto first = cell(box.lower), last = cell(box.upper);
  auto current = first;
  while (true) {
    visit(cell_number(current));
    int a = 0;
    while (a < Dim && current[a] == last[a]) {
      current[a] = first[a];
      ++a;
    }
    if (a == Dim) return;
    ++current[a];
  }
}

template <int Dim>
int KnotLocator<Dim>::find(const Point<Dim>& u) const {
  for (int a = 0; a < Dim; ++a) {
    if (!(u[a] >= box_.lower[a] - tie_ && u[a] <= box_.upper[a] + tie_)) return -1;
  }
  const int c = cell_number(cell(u));
  for (int i = cell_start_[c]; i < cell_start_[c + 1]; ++i) {
    const Facets& facets = facets_[simplices_[i]];
    const auto distances = (facets.normals.transpose() * u - facets.offsets).eval();
    if (distances.minCoeff() >= -tie_) return simplices_[i];
  }
  return -1;
}

template <int Dim>
std::vector<std::vector<int>> vertex_neighbours(const SimplexMesh<Dim>& mesh) {
  std::vector<std::vector<int>> stars(mesh.vertices.size());
  for (std::size_t s = 0; s < mesh.simplices.size(); ++s) {
    for (int v : mesh.simplices[s]) stars[v].push_back(static_cast<int>(s));
  }
  std::vector<std::vector<int>> neighbours(mesh.simplices.size());
  for (std::size_t s = 0; s < mesh.simplices.size(); ++s) {
    auto& list = neighbours[s];
    for (int v : mesh.simplices[s]) list.insert(list.end(), stars[v].begin(), stars[v].end());
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

template class KnotLocator<2>;
template class KnotLocator<3>;
template std::vector<std::vector<int>> vertex_neighbours<2>(const SimplexMesh<2>&);
template std::vector<std::vector<int>> vertex_neighbours<3>(const SimplexMesh<3>&);

}  // namespace crease
