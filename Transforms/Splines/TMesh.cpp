#include "Transforms/Splines/TMesh.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Splines/TMeshPoints.h"

namespace crease {
namespace {

constexpr double kSameLine = 1e-9;  // of the domain

void check_lines(int degree, int axis, const std::vector<double>& lines) {
  const int h = (degree + 1) / 2, count = static_cast<int>(lines.size());
  if (count < 2 * h) {
    throw InvalidInput(message("TMesh: axis ", axis, " has ", count, " lines; degree ", degree,
                               " needs ", h, " at either border."));
  }
  for (int k = 0, run = 0; k < count; ++k) {
    if (!std::isfinite(lines[k]) || (k > 0 && lines[k] < lines[k - 1])) {
      throw InvalidInput(message("TMesh: line ", k, " of axis ", axis, " is at ", lines[k],
                                 "; lines must be finite and never decrease."));
    }
    run = k > 0 && lines[k] == lines[k - 1] ? run + 1 : 1;
    const bool inner = lines[k] > lines.front() && lines[k] < lines.back();
    if (run > (inner ? degree + 1 : h)) {
      throw InvalidInput(message("TMesh: line ", k, " of axis ", axis, " repeats ", lines[k],
                                 " too often; inside it may stand ", degree + 1,
                                 " times, at the border ", h, " times."));
    }
  }
  if (lines[h - 1] != lines.front() || lines[count - h] != lines.back() ||
      !(lines.front() < lines.back())) {
    throw InvalidInput(message("TMesh: the first and the last ", h, " lines of axis ", axis,
                               " must be equal, and the borders differ."));
  }
}

}  // namespace

TMesh::TMesh(int degree, std::array<std::vector<double>, 2> lines,
             const std::vector<TSegment>& segments)
    : degree_(degree), lines_(std::move(lines)) {
  if (degree != 1 && degree != 3 && degree != 5) {
    throw InvalidInput(message("TMesh: the degree is ", degree, "; it must be 1, 3 or 5."));
  }
  for (int a = 0; a < 2; ++a) check_lines(degree_, a, lines_[a]);
  if (static_cast<double>(num_lines(0)) * num_lines(1) > 1e8) {
    throw InvalidInput("TMesh: there are too many lines.");
  }
  for (auto& edges : edges_) edges.assign(lines_[0].size() * lines_[1].size(), 0);
  for (const TSegment& s : segments) {
    if (s.axis < 0 || s.axis > 1 || s.line < 0 || s.line >= num_lines(1 - s.axis) || s.begin < 0 ||
        s.end <= s.begin || s.end >= num_lines(s.axis)) {
      throw InvalidInput(message("TMesh: the segment along axis ", s.axis, " on line ", s.line,
                                 " from ", s.begin, " to ", s.end, " does not lie on the lines."));
    }
    for (int k = s.begin; k < s.end; ++k) edges_[s.axis][number(point_on(s.axis, s.line, k))] = 1;
  }
  check();
}

TMesh TMesh::tensor(const KnotVector& u, const KnotVector& v) {
  if (u.degree() != v.degree() || u.degree() % 2 == 0) {
    throw InvalidInput(message("TMesh: the degrees are ", u.degree(), " and ", v.degree(),
                               "; they must be equal and odd."));
  }
  const int h = (u.degree() + 1) / 2;
  std::array<std::vector<double>, 2> lines;
  lines[0].assign(u.knots().begin() + h, u.knots().end() - h);
  lines[1].assign(v.knots().begin() + h, v.knots().end() - h);
  std::vector<TSegment> segments;
  for (int a = 0; a < 2; ++a) {
    for (int line = 0; line < std::ssize(lines[1 - a]); ++line) {
      segments.push_back({a, line, 0, static_cast<int>(lines[a].size()) - 1});
    }
  }
  return {u.degree(), std::move(lines), segments};
}

double TMesh::knot(int axis, int line) const {
  return lines_[axis][std::clamp(line, 0, num_lines(axis) - 1)];
}

bool TMesh::has_edge(int axis, TPoint from) const {
  return from[axis] >= 0 && from[axis] + 1 < num_lines(axis) && edges_[axis][number(from)] != 0;
}

bool TMesh::touches(int axis, TPoint at) const {
  return has_edge(axis, at) || has_edge(axis, moved(at, axis, -1));
}

std::vector<TPoint> TMesh::vertices() const {
  std::vector<TPoint> result;
  for (int j = 0; j < num_lines(1); ++j) {
    for (int i = 0; i < num_lines(0); ++i) {
      if (is_vertex({i, j})) result.push_back({i, j});
    }
  }
  return result;
}

std::vector<int> TMesh::knot_lines(int axis, TPoint at) const {
  const int h = border_lines(), last = num_lines(axis) - 1;
  std::vector<int> result(static_cast<std::size_t>(2 * h + 1), at[axis]);
  for (int side : {-1, 1}) {
    int k = at[axis];
    for (int n = 1; n <= h; ++n) {
      k += side;
      while (k > 0 && k < last && !touches(1 - axis, moved(at, axis, k - at[axis]))) k += side;
      result[h + side * n] = k;
    }
  }
  return result;
}

std::vector<TJunction> TMesh::junctions() const {
  std::vector<TJunction> result;
  for (int j = 1; j + 1 < num_lines(1); ++j) {
    for (int i = 1; i + 1 < num_lines(0); ++i) {
      const TPoint at = {i, j};
      if (!is_vertex(at)) continue;
      for (int axis : {0, 1}) {
        if (!has_edge(axis, at)) result.push_back({at, axis, 1});
        if (!has_edge(axis, moved(at, axis, -1))) result.push_back({at, axis, -1});
      }
    }
  }
  return result;
}

TSegment TMesh::extension(const TJunction& t) const {
  const int last = num_lines(t.axis) - 1, start = t.at[t.axis];
  const auto reach = [&](int side, int edges) {
    int k = start;
    while (edges > 0 && k > 0 && k < last) {
      k += side;
      if (touches(1 - t.axis, moved(t.at, t.axis, k - start))) --edges;
    }
    return k;
  };
  const int over_gap = reach(t.side, border_lines()), back = reach(-t.side, border_lines() - 1);
  return {t.axis, t.at[1 - t.axis], std::min(over_gap, back), std::max(over_gap, back)};
}

std::vector<std::pair<TJunction, TJunction>> TMesh::crossings() const {
  const auto all = junctions();
  std::vector<int> owner(lines_[0].size() * lines_[1].size(), -1);  // of an extension along u
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].axis != 0) continue;
    const TSegment e = extension(all[n]);
    for (int k = e.begin; k <= e.end; ++k) owner[number({k, e.line})] = static_cast<int>(n);
  }
  std::vector<std::pair<TJunction, TJunction>> result;
  for (const TJunction& t : all) {
    if (t.axis != 1) continue;
    const TSegment e = extension(t);
    for (int k = e.begin; k <= e.end; ++k) {
      const int other = owner[number({e.line, k})];
      if (other < 0) continue;
      result.emplace_back(all[other], t);
      break;
    }
  }
  return result;
}

std::vector<TSegment> TMesh::segments() const {
  std::vector<TSegment> result;
  for (int a = 0; a < 2; ++a) {
    for (int line = 0; line < num_lines(1 - a); ++line) {
      for (int k = 0; k + 1 < num_lines(a); ++k) {
        if (!has_edge(a, point_on(a, line, k))) continue;
        const int begin = k;
        while (has_edge(a, point_on(a, line, k))) ++k;
        result.push_back({a, line, begin, k});
      }
    }
  }
  return result;
}

std::vector<TFace> TMesh::faces_between(
    const std::array<std::vector<std::uint8_t>, 2>& edges) const {
  std::vector<std::uint8_t> taken(edges[0].size(), 0);
  std::vector<TFace> result;
  for (int j = 0; j + 1 < num_lines(1); ++j) {
    for (int i = 0; i + 1 < num_lines(0); ++i) {
      if (taken[number({i, j})]) continue;
      TFace face{{i, j}, {i + 1, j + 1}};
      while (face.upper[0] + 1 < num_lines(0) && !edges[1][number({face.upper[0], j})]) {
        ++face.upper[0];
      }
      while (face.upper[1] + 1 < num_lines(1) && !edges[0][number({i, face.upper[1]})]) {
        ++face.upper[1];
      }
      for (int y = j; y < face.upper[1]; ++y) {
        for (int x = i; x < face.upper[0]; ++x) taken[number({x, y})] = 1;
      }
      result.push_back(face);
    }
  }
  return result;
}

std::vector<TFace> TMesh::faces() const { return faces_between(edges_); }

std::vector<TFace> TMesh::bezier_faces() const {
  auto edges = edges_;
  for (const TJunction& t : junctions()) {
    const TSegment e = extension(t);
    for (int k = e.begin; k < e.end; ++k) edges[t.axis][number(point_on(t.axis, e.line, k))] = 1;
  }
  return faces_between(edges);
}

int TMesh::find_line(int axis, double knot) const {
  const auto& all = lines_[axis];
  const double slack = kSameLine * (all.back() - all.front());
  const auto at = std::lower_bound(all.begin(), all.end(), knot - slack);
  if (at == all.end() || *at > knot + slack) {
    throw InvalidInput(message("TMesh: axis ", axis, " has no line at ", knot, "."));
  }
  return static_cast<int>(at - all.begin());
}

TMesh TMesh::on_lines(std::array<std::vector<double>, 2> lines) const {
  TMesh result = *this;
  result.lines_ = std::move(lines);
  std::array<std::vector<int>, 2> place;  // of our lines among the new ones
  for (int a = 0; a < 2; ++a) {
    const auto& found = result.lines_[a];
    const double slack = kSameLine * (lines_[a].back() - lines_[a].front());
    std::size_t at = 0;
    for (double knot : lines_[a]) {
      while (at < found.size() && found[at] < knot - slack) ++at;
      if (at == found.size() || found[at] > knot + slack) {
        throw InvalidInput(message("TMesh: the new lines of axis ", a, " leave out ", knot, "."));
      }
      place[a].push_back(static_cast<int>(at++));
    }
  }
  for (auto& edges : result.edges_) {
    edges.assign(result.lines_[0].size() * result.lines_[1].size(), 0);
  }
  for (const TSegment& s : segments()) {
    for (int k = place[s.axis][s.begin]; k < place[s.axis][s.end]; ++k) {
      const TPoint at = point_on(s.axis, place[1 - s.axis][s.line], k);
      result.edges_[s.axis][result.number(at)] = 1;
    }
  }
  return result;
}

TMesh TMesh::with_knots(const std::array<std::vector<double>, 2>& knots) const {
  auto lines = lines_;
  for (int a = 0; a < 2; ++a) {
    const double slack = kSameLine * (lines_[a].back() - lines_[a].front());
    for (double knot : knots[a]) {
      const auto above = std::lower_bound(lines[a].begin(), lines[a].end(), knot);
      const bool known = (above != lines[a].end() && *above <= knot + slack) ||
                         (above != lines[a].begin() && *(above - 1) >= knot - slack);
      if (!known) lines[a].insert(above, knot);
    }
  }
  return on_lines(std::move(lines));
}

TMesh TMesh::without_inner_edges() const {
  TMesh result = *this;
  for (auto& edges : result.edges_) std::fill(edges.begin(), edges.end(), std::uint8_t{0});
  const int h = border_lines();
  for (int a : {0, 1}) {
    for (int n = 0; n < h; ++n) {
      result.add({a, n, 0, num_lines(a) - 1});
      result.add({a, num_lines(1 - a) - 1 - n, 0, num_lines(a) - 1});
    }
  }
  return result;
}

TMesh TMesh::without_empty_lines() const {
  TMesh result = *this;
  std::array<std::vector<int>, 2> place;  // of our lines among those left
  for (int a : {0, 1}) {
    result.lines_[a].clear();
    for (int line = 0; line < num_lines(a); ++line) {
      place[a].push_back(static_cast<int>(result.lines_[a].size()));
      bool empty = true;
      for (int k = 0; k < num_lines(1 - a) && empty; ++k) {
        empty = !has_edge(1 - a, point_on(1 - a, line, k));
      }
      if (!empty) result.lines_[a].push_back(lines_[a][line]);
    }
  }
  for (auto& edges : result.edges_) {
    edges.assign(result.lines_[0].size() * result.lines_[1].size(), 0);
  }
  for (const TSegment& s : segments()) {
    result.add({s.axis, place[1 - s.axis][s.line], place[s.axis][s.begin], place[s.axis][s.end]});
  }
  return result;
}

void TMesh::add(const TSegment& s) {
  const int h = border_lines(), last = num_lines(s.axis) - 1;
  const int begin = s.begin < h ? 0 : s.begin, end = s.end > last - h ? last : s.end;
  for (int k = begin; k < end; ++k) edges_[s.axis][number(point_on(s.axis, s.line, k))] = 1;
}

void TMesh::add_through(int axis, TPoint at) {
  const auto stops = [&](int k) { return touches(1 - axis, moved(at, axis, k - at[axis])); };
  int begin = at[axis], end = at[axis];
  if (!stops(end) || end + 1 < num_lines(axis)) {
    do ++end;
    while (!stops(end));
  } else {
    --begin;
  }
  while (!stops(begin)) --begin;
  add({axis, at[1 - axis], begin, end});
}

void TMesh::check() const {
  const int h = border_lines();
  for (int j = 0; j < num_lines(1); ++j) {
    for (int i = 0; i < num_lines(0); ++i) {
      const TPoint at = {i, j};
      std::array<bool, 4> edge;  // left, right, down, up
      for (int a = 0; a < 2; ++a) {
        edge[2 * a] = has_edge(a, moved(at, a, -1));
        edge[2 * a + 1] = has_edge(a, at);
        // Beyond the border everything goes on.
        if (at[a] == 0) edge[2 * a] = edge[2 * a + 1];
        if (at[a] == num_lines(a) - 1) edge[2 * a + 1] = edge[2 * a];
      }
      const auto fail = [&](const char* what) {
        throw InvalidInput(message("TMesh: ", what, " at u = ", lines_[0][i],
                                   ", v = ", lines_[1][j], " (lines ", i, ", ", j, ")."));
      };
      const int count = edge[0] + edge[1] + edge[2] + edge[3];
      if (count == 1) fail("an edge ends inside a face");
      if (count == 2 && edge[0] != edge[1]) fail("edges meet in a corner");
      for (int a = 0; a < 2; ++a) {
        const int other = 1 - a, lines = num_lines(other);
        if ((at[other] < h || at[other] >= lines - h) && !(edge[2 * a] && edge[2 * a + 1])) {
          fail("a border line is not complete");
        }
        // Between the border lines no T-junction.
        const bool in_border = at[a] < h || at[a] >= num_lines(a) - h;
        if (in_border && edge[2 * a] != edge[2 * a + 1]) {
          fail("an edge ends at the inner border line instead of the border");
        }
      }
    }
  }
}

}  // namespace crease
