#include "Registration/LandmarkWords.h"

#include "Core/Error.h"

namespace crease {

std::string LandmarkWords::listed(const std::vector<int>& numbers) const {
  constexpr std::size_t kMost = 12;
  std::string text = noun + (numbers.size() == 1 ? " " : "s ");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool cut = i + 1 == kMost && numbers.size() > kMost;
    if (i > 0) text += cut || i + 1 == numbers.size() ? " and " : ", ";
    if (cut) return text + message(numbers.size() - i, " more");
    text += std::to_string(numbers[i] + 1);
  }
  return text;
}

}  // namespace crease
