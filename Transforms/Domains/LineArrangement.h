#pragma once

#include <functional>
#include <string>
#include <vector>

#include "Transforms/Domains/FeatureLine.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {

/// Border and feature lines of a domain as straight edges that meet in common vertices only.
struct LineArrangement {
  struct Edge {
    int a = 0, b = 0;
    int line = -1;                               ///< -1: border of the domain
    bool body_left = false, body_right = false;  ///< of feature lines, walking from a to b
  };
  std::vector<Point<2>> vertices;
  std::vector<Edge> edges;      ///< each pair of vertices at most once
  std::vector<Polyline> rings;  ///< the border as divided, the domain on the left
  std::vector<std::string> notes, warnings;
};

struct LineArrangementOptions {
  double edge_length = 1;  ///< of the lines, mm: they are sampled to about this length
  double tolerance = 0;    ///< mm that sampled lines may run off the given ones
  bool resample = true;    ///< false: lines keep their points, apart from merging
  std::function<double(const Point<2>&)> border_length;  ///< wanted on the border given the lines
};

/// The parts of a line inside the region, in order; a closed line that lies wholly inside stays closed. Stretches
/// along the border itself are left out.
std::vector<FeatureLine> clipped_to_region(const FeatureLine& line, const RegionOfInterest& region);

/// Lines clipped to the region, dense or coarse ones sampled, in an order and direction that do not depend on
/// how they were given: with their bodies on the left. Lines with a body label may lie outside.
std::vector<FeatureLine> prepared_lines(const RegionOfInterest& region,
                                        const std::vector<FeatureLine>& lines,
                                        const LineArrangementOptions& options,
                                        std::vector<std::string>& notes,
                                        std::vector<std::string>& warnings);

/// Joins border and prepared lines into one planar graph: points nearer than a quarter edge to another line are
/// merged with it, ends near the border meet it, crossings get a vertex, edges shared by two lines become one.
/// @throws InvalidInput when lines and border cannot be disentangled.
LineArrangement arrange(const RegionOfInterest& region, const std::vector<FeatureLine>& prepared,
                        const LineArrangementOptions& options);

}  // namespace crease
