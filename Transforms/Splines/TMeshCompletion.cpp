#include <algorithm>
#include <cmath>
#include <limits>

#include "Transforms/Splines/TMeshPoints.h"

namespace crease {
namespace {

/// Adds the edge that leads from a point to the next edge across.
void lead_on(TMesh& mesh, TPoint at, int axis, int side) {
  int k = at[axis] + side;
  while (!mesh.touches(1 - axis, moved(at, axis, k - at[axis]))) k += side;
  mesh.add({axis, at[1 - axis], std::min(k, at[axis]), std::max(k, at[axis])});
}

bool on_border(const TMesh& mesh, TPoint at) {
  return at[0] == 0 || at[1] == 0 || at[0] + 1 == mesh.num_lines(0) ||
         at[1] + 1 == mesh.num_lines(1);
}

}  // namespace

TMesh rectangular(TMesh mesh) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (int j = 0; j < mesh.num_lines(1); ++j) {
      for (int i = 0; i < mesh.num_lines(0); ++i) {
        const TPoint at = {i, j};
        // Where an axis has an edge on one side only, inside the mesh, and the other axis does not pass.
        std::array<int, 2> missing = {0, 0};
        int edges = 0;
        for (int a : {0, 1}) {
          const bool before = mesh.has_edge(a, moved(at, a, -1)), after = mesh.has_edge(a, at);
          edges += before + after;
          const bool inside = at[a] > 0 && at[a] + 1 < mesh.num_lines(a);
          if (inside && before != after) missing[a] = after ? -1 : 1;
        }
        if ((missing[0] == 0 && missing[1] == 0) || edges > 2 || on_border(mesh, at)) continue;
        const auto gap = [&](int a) {
          if (missing[a] == 0) return std::numeric_limits<double>::infinity();
          int k = at[a] + missing[a];
          while (!mesh.touches(1 - a, moved(at, a, k - at[a]))) k += missing[a];
          return std::abs(mesh.knot(a, k) - mesh.knot(a, at[a]));
        };
        const int a = gap(0) <= gap(1) ? 0 : 1;
        lead_on(mesh, at, a, missing[a]);
        changed = true;
      }
    }
  }
  return mesh;
}

TMesh analysis_suitable(TMesh mesh) {
  const int h = mesh.border_lines();
  // Moves over the gap until the crossing at `along` is left behind.
  const auto cost = [&](const TJunction& t, int along) {
    const int start = t.at[t.axis], step = along > start ? 1 : -1;
    int edges = 0;
    for (int k = start; k != along; k += step) {
      edges += mesh.touches(1 - t.axis, moved(t.at, t.axis, k + step - start));
    }
    return (along - start) * t.side > 0 ? edges : h - edges;
  };
  for (auto pairs = mesh.crossings(); !pairs.empty(); pairs = mesh.crossings()) {
    std::vector<TPoint> done;  // extensions that have moved since
    for (const auto& [across, up] : pairs) {
      const auto has_moved = [&](const TJunction& t) {
        return std::find(done.begin(), done.end(), t.at) != done.end();
      };
      if (has_moved(across) || has_moved(up)) continue;
      const TJunction& t = cost(across, up.at[0]) <= cost(up, across.at[1]) ? across : up;
      lead_on(mesh, t.at, t.axis, t.side);
      done.push_back(t.at);
    }
  }
  return mesh;
}

}  // namespace crease
