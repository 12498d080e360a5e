#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "Core/Point.h"

namespace crease {

/// An axis-aligned box, closed; empty until a point is added.
template <int Dim>
struct Box {
  Point<Dim> lower = Point<Dim>::Constant(std::numeric_limits<double>::infinity());
  Point<Dim> upper = Point<Dim>::Constant(-std::numeric_limits<double>::infinity());

  void add(const Point<Dim>& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  bool empty() const { return (lower.array() > upper.array()).any(); }
  bool contains(const Point<Dim>& p) const {
    return (p.array() >= lower.array()).all() && (p.array() <= upper.array()).all();
  }
  bool intersects(const Box& other) const {
    return (lower.array() <= other.upper.array()).all() &&
           (other.lower.array() <= upper.array()).all();
  }
  Vector<Dim> size() const { return upper - lower; }
  double diagonal() const { return size().norm(); }
};

/// The smallest box that holds all points.
template <int Dim>
Box<Dim> bounding_box(std::span<const Point<Dim>> points) {
  Box<Dim> box;
  for (const auto& p : points) box.add(p);
  return box;
}

}  // namespace crease
