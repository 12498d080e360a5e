#include "Testing/Experiments/BreastScene.h"

#include <cmath>

#include "Core/Parallel.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Registration/Phantoms/MammogramStreams.h"

namespace crease::experiments {
namespace {

MammogramDeformation true_motion(std::uint64_t seed, const MammogramBody& body) {
  const MammogramMotion motion =
      draw_mammogram_motion(mammogram_random(seed, MammogramStream::kMotion));
  return MammogramDeformation(motion, body.follow(motion).further);
}

struct Squares {
  double before = 0, after = 0;
  Squares& operator+=(const Squares& other) {
    before += other.before, after += other.after;
    return *this;
  }
};

}  // namespace

BreastScene::BreastScene(std::uint64_t seed, const MammogramBody& body)
    : seed_(seed), truth_(true_motion(seed, body)), tissue_({.seed = seed, .size = 1024}) {}

double BreastScene::fixed_grey(const Point<2>& x) const {
  const Point<2> p = x / kMammogramWidthMm;
  const double depth = skin_depth(p);
  return depth > 0 ? tissue_.grey(p, depth) : 0;
}

double BreastScene::template_grey(const Point<2>& y, const Point<2>& start) const {
  return fixed_grey(truth_.inverse(y, start));
}

double BreastScene::improvement(const SplineTransform<2>& map) const {
  const int size = static_cast<int>(kMammogramWidthMm);
  const auto add_row = [&](std::int64_t row, Squares& sums) {
    for (int i = 0; i < size; ++i) {
      const Point<2> x(i + 0.5, static_cast<double>(row) + 0.5);
      if (!(skin_depth(x / kMammogramWidthMm) > 0) || !map.in_domain(x)) continue;
      const double reference = fixed_grey(x);
      sums.before += std::pow(template_grey(x, x) - reference, 2);
      sums.after += std::pow(template_grey(map.map(x), x) - reference, 2);
    }
  };
  const Squares sums = parallel_sum(size, Squares{}, add_row, 1);
  return 100 * (1 - sums.after / sums.before);
}

}  // namespace crease::experiments
