#include "Registration/RowSubset.h"

#include <algorithm>
#include <cmath>

#include "Registration/Phantoms/Random.h"

namespace crease {

RowSubset::RowSubset(std::int64_t num_rows, double fraction, std::uint64_t seed) {
  const auto rows = static_cast<double>(num_rows);
  const auto count = std::max<std::int64_t>(1, std::llround(fraction * rows));
  if (count >= num_rows) return;
  constexpr std::uint64_t kStream = 17;  // no phantom's
  Random random(seed, kStream);
  const double height = rows / static_cast<double>(count);  // of a strip
  chosen_.assign(static_cast<std::size_t>(num_rows), 0);
  for (std::int64_t strip = 0; strip < count; ++strip) {
    const double row = height * (static_cast<double>(strip) + random.uniform());
    chosen_[static_cast<std::size_t>(std::min(row, rows - 1))] = 1;
  }
  factor_ = static_cast<float>(rows / static_cast<double>(std::ranges::count(chosen_, 1)));
}

void RowSubset::apply(std::vector<float>& weights) const {
  if (chosen_.empty()) return;
  const std::size_t width = weights.size() / chosen_.size();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = chosen_[i / width] != 0 ? factor_ * weights[i] : 0.0f;
  }
}

}  // namespace crease
