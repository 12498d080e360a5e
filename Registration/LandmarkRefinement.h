#pragma once

#include <functional>
#include <vector>

#include "Registration/CreasedDomain.h"
#include "Registration/Landmarks.h"
#include "Transforms/Domains/Mesher.h"

namespace crease {

/// Makes a domain whose edges are no longer than asked for in some discs.
using DomainMaker = std::function<CreasedDomain(const std::vector<FineDisc>&)>;

/// Makes a domain and, while exact landmarks contradict each other on it, or so nearly that the map would
/// bend out of all proportion (landmark_strain), makes it again with half the edge length over the triangles
/// that hold these landmarks, at most four times. A warning of the domain tells the old and new sizes.
/// @throws InvalidInput as find_contradiction(), and when they still contradict each other after that.
CreasedDomain refined_for_landmarks(const Landmarks<2>& landmarks, const DomainMaker& make);

}  // namespace crease
