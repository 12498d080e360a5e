#include "Registration/Elastic/PairText.h"

#include <iomanip>
#include <sstream>

namespace crease {

std::string fixed_text(double mm) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << mm;
  return text.str();
}

std::string place_text(const Point<2>& p) {
  return "(" + fixed_text(p.x()) + ", " + fixed_text(p.y()) + ") mm";
}

}  // namespace crease
