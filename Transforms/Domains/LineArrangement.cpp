#include "Transforms/Domains/LineArrangement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "Core/Error.h"
#include "Transforms/Domains/BorderRings.h"

namespace crease {
namespace {

/// Border rings and lines as chains of common vertices, brought into the state in which they meet in
/// vertices only.
class Arranger {
 public:
  Arranger(const RegionOfInterest& region, const std::vector<FeatureLine>& lines,
           const LineArrangementOptions& options);
  LineArrangement result();

 private:
  struct Chain {
    std::vector<int> vertices;
    bool closed = false;
    int line = -1;  // -1: border

    int num_edges() const { return static_cast<int>(vertices.size()) - (closed ? 0 : 1); }
    int next(int e) const { return (e + 1) % static_cast<int>(vertices.size()); }
    bool has(int v) const {
      return std::find(vertices.begin(), vertices.end(), v) != vertices.end();
    }
  };
  struct EdgeOfChain {
    int chain, edge;
  };
  /// Vertices to insert into edges: v into the first, and into the second if it is a new crossing.
  struct Meeting {
    std::optional<EdgeOfChain> first, second;
    int vertex = -1;  // -1: a new one at `point`
    Point<2> point = Point<2>::Zero();
  };

  void add_border(const RegionOfInterest& region);
  void add_line(const FeatureLine& line, int number);
  void merge_with_earlier(int chain);
  void insert_crossings();
  bool insert_crossings_once();
  std::optional<Meeting> meeting(const EdgeOfChain& a, const EdgeOfChain& b) const;
  void clean(Chain& chain) const;
  bool movable(int vertex) const;
  int add_vertex(const Point<2>& p) {
    vertices_.push_back(p);
    return static_cast<int>(vertices_.size()) - 1;
  }
  int find_vertex(const Point<2>& p, double distance, int end) const;
  const Point<2>& a(const EdgeOfChain& e) const {
    return vertices_[chains_[e.chain].vertices[e.edge]];
  }
  const Point<2>& b(const EdgeOfChain& e) const {
    const Chain& chain = chains_[e.chain];
    return vertices_[chain.vertices[chain.next(e.edge)]];
  }

  const LineArrangementOptions& options_;
  double near_, tolerance_;  // mm: merge distance, rounding
  std::vector<Point<2>> vertices_;
  std::vector<Chain> chains_;  // border first
  std::vector<FeatureLine> lines_;
  std::vector<Polyline> rings_;
  int num_border_vertices_ = 0, num_merged_ = 0, num_crossings_ = 0;
  double largest_shift_ = 0;
};

Arranger::Arranger(const RegionOfInterest& region, const std::vector<FeatureLine>& lines,
                   const LineArrangementOptions& options)
    : options_(options),
      near_(0.25 * options.edge_length),
      tolerance_(1e-9 * region.bounds().diagonal()),
      lines_(lines) {
  add_border(region);
  for (std::size_t l = 0; l < lines_.size(); ++l) add_line(lines_[l], static_cast<int>(l));
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    if (chains_[c].line >= 0) merge_with_earlier(static_cast<int>(c));
  }
  insert_crossings();
}

/// The border, divided as wanted between the line ends that lie on it.
void Arranger::add_border(const RegionOfInterest& region) {
  const auto meetings = attach_to_border(region, lines_, near_, tolerance_);
  num_merged_ = meetings.num_moved;
  largest_shift_ = meetings.largest_shift;
  rings_ = sampled_border(region, meetings.points, options_, tolerance_);
  for (const auto& ring : rings_) {
    Chain chain{{}, true, -1};
    for (const auto& p : ring) chain.vertices.push_back(add_vertex(p));
    chains_.push_back(std::move(chain));
  }
  num_border_vertices_ = static_cast<int>(vertices_.size());
}

int Arranger::find_vertex(const Point<2>& p, double distance, int end) const {
  int nearest = -1;
  for (int v = 0; v < end; ++v) {
    const double d = (vertices_[v] - p).norm();
    if (d <= distance) {
      distance = d;
      nearest = v;
    }
  }
  return nearest;
}

void Arranger::add_line(const FeatureLine& line, int number) {
  Chain chain{{}, line.closed, number};
  for (const auto& p : line.points) {
    // A line that crosses itself, or another one, may have points of both strands in one place.
    const int known = find_vertex(p, tolerance_, static_cast<int>(vertices_.size()));
    if (chain.has(known) && known != chain.vertices.back()) ++num_crossings_;
    chain.vertices.push_back(known >= 0 ? known : add_vertex(p));
  }
  chains_.push_back(std::move(chain));
}

/// Removes repeated vertices that merging has left behind.
void Arranger::clean(Chain& chain) const {
  auto& v = chain.vertices;
  v.erase(std::unique(v.begin(), v.end()), v.end());
  while (chain.closed && v.size() > 1 && v.front() == v.back()) v.pop_back();
  if (chain.closed && v.size() < 3) {
    const FeatureLine& line = lines_[chain.line];
    throw InvalidInput(message("feature line ", line.name,
                               ": the closed line is shorter than three "
                               "edges of ",
                               options_.edge_length,
                               " mm; use shorter edges or leave it "
                               "out."));
  }
}

/// On a straight stretch of one line only: moving it along changes nothing.
bool Arranger::movable(int vertex) const {
  if (vertex < num_border_vertices_) return false;
  const Chain* host = nullptr;
  for (const auto& chain : chains_) {
    if (!chain.has(vertex)) continue;
    if (host) return false;
    host = &chain;
  }
  if (!host) return false;
  const auto& v = host->vertices;
  const int n = static_cast<int>(v.size());
  const int i = static_cast<int>(std::find(v.begin(), v.end(), vertex) - v.begin());
  if (!host->closed && (i == 0 || i == n - 1)) return false;
  const Vector<2> in = vertices_[vertex] - vertices_[v[(i + n - 1) % n]];
  const Vector<2> out = vertices_[v[(i + 1) % n]] - vertices_[vertex];
  return std::abs(turn_angle(in, out)) < 0.09;
}

void Arranger::merge_with_earlier(int number) {
  Chain& chain = chains_[number];
  const auto is_other_line = [&](const Chain& other) {
    return other.line >= 0 && other.line < chain.line;
  };
  for (int& v : chain.vertices) {
    if (v < num_border_vertices_) continue;
    const Point<2> p = vertices_[v];
    int target = -1;
    double distance = near_;
    for (const auto& other : chains_) {
      if (!is_other_line(other)) continue;
      for (int w : other.vertices) {
        const double d = (vertices_[w] - p).norm();
        if (d <= distance && w != v) {
          distance = d;
          target = w;
        }
      }
    }
    if (target < 0) {  // no vertex near: an edge?
      Chain* host = nullptr;
      int edge = -1;
      for (auto& other : chains_) {
        if (!is_other_line(other) || other.has(v)) continue;
        for (int e = 0; e < other.num_edges(); ++e) {
          const auto q = closest_point_on_segment(p, vertices_[other.vertices[e]],
                                                  vertices_[other.vertices[other.next(e)]]);
          if ((q - p).norm() > distance) continue;
          distance = (q - p).norm();
          vertices_[v] = q;
          host = &other;
          edge = e;
        }
      }
      if (!host) continue;
      host->vertices.insert(host->vertices.begin() + edge + 1, v);
    }
    if (target >= 0) {
      if (!movable(v) && movable(target)) vertices_[target] = p;
      v = target;
    }
    if (distance > tolerance_) {
      ++num_merged_;
      largest_shift_ = std::max(largest_shift_, distance);
    }
  }
  clean(chain);
  for (const auto& other : chains_) {
    if (!is_other_line(other)) continue;
    for (int w : other.vertices) {
      if (chain.has(w)) continue;
      for (int e = 0; e < chain.num_edges(); ++e) {
        const auto q = closest_point_on_segment(vertices_[w], vertices_[chain.vertices[e]],
                                                vertices_[chain.vertices[chain.next(e)]]);
        if ((q - vertices_[w]).norm() > near_) continue;
        largest_shift_ = std::max(largest_shift_, (q - vertices_[w]).norm());
        chain.vertices.insert(chain.vertices.begin() + e + 1, w);
        break;
      }
    }
  }
}

std::optional<Arranger::Meeting> Arranger::meeting(const EdgeOfChain& e,
                                                   const EdgeOfChain& f) const {
  const Chain &ce = chains_[e.chain], &cf = chains_[f.chain];
  const int e0 = ce.vertices[e.edge], e1 = ce.vertices[ce.next(e.edge)];
  const int f0 = cf.vertices[f.edge], f1 = cf.vertices[cf.next(f.edge)];
  const auto on = [&](int v, const EdgeOfChain& edge, int v0, int v1) {
    if (v == v0 || v == v1) return false;
    const Point<2>& p = vertices_[v];
    return (p - closest_point_on_segment(p, a(edge), b(edge))).norm() <= tolerance_;
  };
  for (int v : {f0, f1}) {
    if (on(v, e, e0, e1)) return Meeting{e, std::nullopt, v, vertices_[v]};
  }
  for (int v : {e0, e1}) {
    if (on(v, f, f0, f1)) return Meeting{f, std::nullopt, v, vertices_[v]};
  }
  if (e0 == f0 || e0 == f1 || e1 == f0 || e1 == f1) return std::nullopt;
  const auto crossing = segment_crossing(a(e), b(e), a(f), b(f));
  if (!crossing) return std::nullopt;
  // A vertex near by takes the crossing's place.
  Meeting result{e, f, -1, *crossing};
  double distance = near_;
  for (int v : {e0, e1, f0, f1}) {
    if ((vertices_[v] - *crossing).norm() >= distance) continue;
    distance = (vertices_[v] - *crossing).norm();
    result.vertex = v;
    result.first = v == e0 || v == e1 ? f : e;
    result.second = std::nullopt;
  }
  return result;
}

bool Arranger::insert_crossings_once() {
  std::vector<EdgeOfChain> edges;
  std::vector<Point<2>> lower, upper;
  for (std::size_t c = 0; c < chains_.size(); ++c) {
    for (int e = 0; e < chains_[c].num_edges(); ++e) {
      edges.push_back({static_cast<int>(c), e});
      const Vector<2> margin = Vector<2>::Constant(tolerance_);
      lower.emplace_back(a(edges.back()).cwiseMin(b(edges.back())) - margin);
      upper.emplace_back(a(edges.back()).cwiseMax(b(edges.back())) + margin);
    }
  }
  std::vector<Meeting> meetings;
  std::set<std::pair<int, int>> busy;
  for (const auto& [i, k] : intersecting_boxes(lower, upper)) {
    const EdgeOfChain &e = edges[i], &f = edges[k];
    if (chains_[e.chain].line < 0 && chains_[f.chain].line < 0) continue;
    if (busy.contains({e.chain, e.edge}) || busy.contains({f.chain, f.edge})) continue;
    auto found = meeting(e, f);
    if (!found) continue;
    busy.insert({e.chain, e.edge});
    busy.insert({f.chain, f.edge});
    meetings.push_back(*found);
  }
  // Insert from the back, so that edge numbers stay right.
  std::map<std::pair<int, int>, int> insertions;
  for (auto& m : meetings) {
    if (m.vertex < 0) {
      m.vertex = add_vertex(m.point);
      ++num_crossings_;
    } else if (movable(m.vertex)) {
      vertices_[m.vertex] = m.point;
    }
    for (const auto& edge : {m.first, m.second}) {
      if (edge) insertions[{edge->chain, edge->edge}] = m.vertex;
    }
  }
  for (auto it = insertions.rbegin(); it != insertions.rend(); ++it) {
    auto& vertices = chains_[it->first.first].vertices;
    vertices.insert(vertices.begin() + it->first.second + 1, it->second);
  }
  return !meetings.empty();
}

void Arranger::insert_crossings() {
  constexpr int kMostRounds = 100;
  constexpr int kRoundsWithMerging = 20;  // bending edges to vertices may go round in circles
  for (int round = 0; round < kMostRounds; ++round) {
    if (!insert_crossings_once()) return;
    if (round == kRoundsWithMerging) near_ = 0;
  }
  throw InvalidInput(
      "feature lines: they cross each other too often within a quarter edge; "
      "simplify them or use shorter edges.");
}

LineArrangement Arranger::result() {
  LineArrangement result;
  std::map<std::pair<int, int>, int> known;
  int num_on_border = 0;
  for (const auto& chain : chains_) {
    for (int e = 0; e < chain.num_edges(); ++e) {
      const int a = chain.vertices[e], b = chain.vertices[chain.next(e)];
      if (a == b) continue;
      const bool has_body = chain.line >= 0 && lines_[chain.line].body == BodySide::kLeft;
      const auto [it, is_new] =
          known.try_emplace(std::minmax(a, b), static_cast<int>(result.edges.size()));
      if (!is_new) {
        auto& edge = result.edges[it->second];
        if (edge.line < 0) {
          ++num_on_border;
        } else if (edge.line != chain.line) {
          // Both lines' bodies count; lines between two bodies have none.
          const bool none = !has_body || (!edge.body_left && !edge.body_right);
          (edge.a == a ? edge.body_left : edge.body_right) = true;
          if (none) edge.body_left = edge.body_right = true;
        }
        continue;
      }
      if (chain.line >= 0) {
        const Point<2> middle = 0.5 * (vertices_[a] + vertices_[b]);
        int winding = 0;
        for (const auto& ring : rings_) winding += winding_number(ring, middle);
        if (winding <= 0) {
          known.erase(it);
          continue;
        }
      }
      result.edges.push_back({a, b, chain.line, has_body, false});
    }
  }
  if (num_merged_ > 0) {
    result.notes.push_back(
        message(num_merged_, " points nearer than a quarter edge to another line ",
                "or the border were merged with it; largest shift ", largest_shift_, " mm."));
  }
  if (num_crossings_ > 0) {
    result.notes.push_back(
        message(num_crossings_, " crossing(s) of lines: a vertex was inserted, ", "a junction."));
  }
  if (num_on_border > 0) {
    result.notes.push_back(message(num_on_border,
                                   " edges of lines lie on the border of the domain, ",
                                   "where they mean nothing, and were left out."));
  }
  result.rings = std::move(rings_);
  // Merging has left vertices behind that no edge uses.
  std::vector<int> number(vertices_.size(), -1);
  for (auto& edge : result.edges) {
    for (int* v : {&edge.a, &edge.b}) {
      if (number[*v] < 0) {
        number[*v] = static_cast<int>(result.vertices.size());
        result.vertices.push_back(vertices_[*v]);
      }
      *v = number[*v];
    }
  }
  return result;
}

}  // namespace

LineArrangement arrange(const RegionOfInterest& region, const std::vector<FeatureLine>& prepared,
                        const LineArrangementOptions& options) {
  return Arranger(region, prepared, options).result();
}

}  // namespace crease
