#include "Transforms/Domains/Contours.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace crease {
namespace {

/// The borders as a graph: nodes are crossings of grid edges and junctions within cells.
class ContourGraph {
 public:
  ContourGraph(int width, const std::vector<int>& labels,
               const std::function<double(int, int)>& share)
      : width_(width), labels_(labels), share_(share) {}

  void add_cell(int i, int j);
  std::vector<ContourArc> arcs() const;

 private:
  struct Link {
    int to = 0;
    int left = 0, right = 0;
  };
  struct Node {
    Point<2> point;
    std::vector<Link> links;
  };

  int crossing(int from, int to);
  void connect(int a, int b, int left, int right) {
    nodes_[a].links.push_back({b, left, right});
    nodes_[b].links.push_back({a, right, left});
  }
  bool first_and_third_joined(const std::array<int, 4>& corners) const;
  Point<2> point(int node) const { return {node % width_, node / width_}; }
  ContourArc follow(int start, int link, std::vector<char>& visited) const;

  int width_;
  const std::vector<int>& labels_;
  const std::function<double(int, int)>& share_;
  std::vector<Node> nodes_;
  std::unordered_map<std::int64_t, int> crossings_;  // by grid edge
};

int ContourGraph::crossing(int from, int to) {
  const int low = std::min(from, to), high = std::max(from, to);
  const std::int64_t key = 2 * static_cast<std::int64_t>(low) + (high - low == 1 ? 0 : 1);
  const auto [it, is_new] = crossings_.try_emplace(key, static_cast<int>(nodes_.size()));
  if (is_new) {
    const int a = labels_[low], b = labels_[high];
    const double at_low = share_(a, low) - share_(b, low);
    const double at_high = share_(a, high) - share_(b, high);
    const double sum = at_low - at_high;
    // Borders that run exactly through a node would make edges of length zero.
    const double t = sum > 0 ? std::clamp(at_low / sum, 1e-3, 1 - 1e-3) : 0.5;
    nodes_.push_back({point(low) + t * (point(high) - point(low)), {}});
  }
  return it->second;
}

/// In a cell whose opposite corners agree, whether the first pair is joined through the middle.
bool ContourGraph::first_and_third_joined(const std::array<int, 4>& c) const {
  const int a = labels_[c[0]], b = labels_[c[1]];
  double difference = 0;
  for (int k : c) difference += share_(a, k) - share_(b, k);
  return difference >= 0;
}

void ContourGraph::add_cell(int i, int j) {
  const int first = j * width_ + i;
  std::array<int, 4> c = {first, first + 1, first + width_ + 1, first + width_};  // ccw
  const auto label = [&](int k) { return labels_[c[k & 3]]; };
  if (label(0) == label(1) && label(1) == label(2) && label(2) == label(3)) return;
  // Walking round the cell, the crossing from label a to label b, seen from the rim inwards, has a on its left.
  struct Crossing {
    int node, before, after;
  };
  std::vector<Crossing> rim;
  for (int k = 0; k < 4; ++k) {
    if (label(k) != label(k + 1)) {
      rim.push_back({crossing(c[k], c[(k + 1) & 3]), label(k), label(k + 1)});
    }
  }
  if (rim.size() == 2) {
    connect(rim[0].node, rim[1].node, rim[0].before, rim[0].after);
    return;
  }
  if (rim.size() == 4) {
    const bool even = label(0) == label(2), odd = label(1) == label(3);
    const bool cut_odd = even && (!odd || first_and_third_joined(c));
    if (cut_odd || odd) {
      // Cut two opposite corners off: crossings k-1 and k lie on either side of corner k.
      for (int k : cut_odd ? std::array{1, 3} : std::array{2, 0}) {
        const Crossing& in = rim[(k + 3) & 3];
        connect(in.node, rim[k].node, in.before, in.after);
      }
      return;
    }
  }
  const int junction = static_cast<int>(nodes_.size());
  Point<2> middle = Point<2>::Zero();
  for (const auto& r : rim) middle += nodes_[r.node].point / static_cast<double>(rim.size());
  nodes_.push_back({middle, {}});
  for (const auto& r : rim) connect(r.node, junction, r.before, r.after);
}

ContourArc ContourGraph::follow(int start, int link, std::vector<char>& visited) const {
  const Link& first = nodes_[start].links[link];
  ContourArc arc{{nodes_[start].point}, false, first.left, first.right};
  int previous = start, node = first.to;
  visited[start] = 1;
  while (node != start && nodes_[node].links.size() == 2) {
    visited[node] = 1;
    arc.points.push_back(nodes_[node].point);
    const auto& links = nodes_[node].links;
    const int next = links[0].to == previous ? links[1].to : links[0].to;
    previous = node;
    node = next;
  }
  arc.closed = node == start && nodes_[start].links.size() == 2;
  if (!arc.closed) arc.points.push_back(nodes_[node].point);
  visited[node] = 1;
  return arc;
}

std::vector<ContourArc> ContourGraph::arcs() const {
  std::vector<ContourArc> result;
  std::vector<char> visited(nodes_.size(), 0);
  // Arcs between ends and junctions, each followed from both sides and kept from one.
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].links.size() == 2) continue;
    for (std::size_t l = 0; l < nodes_[n].links.size(); ++l) {
      const Link& link = nodes_[n].links[l];
      ContourArc arc = follow(static_cast<int>(n), static_cast<int>(l), visited);
      if (link.left > link.right) result.push_back(std::move(arc));
    }
  }
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (visited[n]) continue;
    const int l = nodes_[n].links[0].left > nodes_[n].links[0].right ? 0 : 1;
    result.push_back(follow(static_cast<int>(n), l, visited));
  }
  return result;
}

}  // namespace

std::vector<ContourArc> trace_contours(int width, int height, const std::vector<int>& labels,
                                       const std::function<double(int, int)>& share) {
  ContourGraph graph(width, labels, share);
  for (int j = 0; j + 1 < height; ++j) {
    const int* row = labels.data() + static_cast<std::size_t>(j) * width;
    const int* above = row + width;
    for (int i = 0; i + 1 < width; ++i) {
      if (row[i] != row[i + 1] || row[i] != above[i] || row[i] != above[i + 1]) {
        graph.add_cell(i, j);
      }
    }
  }
  return graph.arcs();
}

}  // namespace crease
