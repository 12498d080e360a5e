#include "Images/DisplacedInterpolator.h"

#include <Eigen/Core>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr int kMargin = 16;  // entries that an interpolator may write beyond the row

/// The displacement of one row; kept by each thread for its next row.
template <int Dim>
struct RowBuffers {
  std::array<std::vector<float>, Dim> value;
  std::array<std::array<std::vector<float>, Dim>, Dim> gradient;
  std::vector<float> inside;

  void resize(std::size_t size) {
    inside.resize(size);
    for (int a = 0; a < Dim; ++a) {
      value[a].resize(size);
      for (auto& g : gradient[a]) g.resize(size);
    }
  }
};

template <int Dim>
RowBuffers<Dim>& buffers(std::size_t size) {
  static thread_local RowBuffers<Dim> instance;
  instance.resize(size);
  return instance;
}

Eigen::Map<Eigen::ArrayXf> entries(float* row, int begin, int end) {
  return {row + begin, end - begin};
}

}  // namespace

template <int Dim>
DisplacedInterpolator<Dim>::DisplacedInterpolator(std::shared_ptr<const Interpolator<Dim>> image,
                                                  Components displacement)
    : image_(std::move(image)), displacement_(std::move(displacement)) {
  bool complete = image_ != nullptr;
  for (const auto& component : displacement_) complete = complete && component != nullptr;
  if (!complete) throw InvalidInput("DisplacedInterpolator: a part is null.");
}

template <int Dim>
auto DisplacedInterpolator<Dim>::evaluate(const Point<Dim>& y) const -> Sample {
  Point<Dim> x = y;
  Matrix<Dim> linear = Matrix<Dim>::Identity();
  for (int a = 0; a < Dim; ++a) {
    const Sample d = displacement_[a]->evaluate(y);
    x[a] += d.value;
    linear.row(a) += d.gradient.transpose();
  }
  Sample sample = image_->evaluate(x);
  sample.gradient = (linear.transpose() * sample.gradient).eval();
  return sample;
}

template <int Dim>
void DisplacedInterpolator<Dim>::evaluate_row(const MappedRow<Dim>& row, float* value,
                                              const std::array<float*, Dim>& gradient,
                                              float* inside) const {
  if (row.begin >= row.end) return;
  auto& b = buffers<Dim>(static_cast<std::size_t>(row.end + 3 * kMargin));
  const bool with_gradient = gradient[0] != nullptr;
  MappedRow<Dim> displaced = row;
  for (int a = 0; a < Dim; ++a) {
    float* d = b.value[a].data() + kMargin;
    std::array<float*, Dim> slopes{};
    for (int c = 0; c < Dim && with_gradient; ++c) slopes[c] = b.gradient[a][c].data() + kMargin;
    displacement_[a]->evaluate_row(row, d, slopes, b.inside.data() + kMargin);
    if (row.displacement[a] != nullptr) {
      entries(d, row.begin, row.end) +=
          Eigen::Map<const Eigen::ArrayXf>(row.displacement[a] + row.begin, row.end - row.begin);
    }
    displaced.displacement[a] = d;
  }
  image_->evaluate_row(displaced, value, gradient, inside);
  if (!with_gradient) return;
  constexpr int kStrip = 64;  // samples whose new gradients wait until the old ones are used
  for (int begin = row.begin; begin < row.end; begin += kStrip) {
    const int end = std::min(begin + kStrip, row.end);
    std::array<Eigen::Array<float, Eigen::Dynamic, 1, 0, kStrip, 1>, Dim> sums;
    for (int c = 0; c < Dim; ++c) {
      sums[c] = entries(gradient[c], begin, end);
      for (int a = 0; a < Dim; ++a) {
        sums[c] += entries(b.gradient[a][c].data() + kMargin, begin, end) *
                   entries(gradient[a], begin, end);
      }
    }
    for (int c = 0; c < Dim; ++c) entries(gradient[c], begin, end) = sums[c];
  }
}

template class DisplacedInterpolator<2>;
template class DisplacedInterpolator<3>;

}  // namespace crease
