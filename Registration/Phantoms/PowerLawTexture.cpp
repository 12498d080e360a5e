#include "Registration/Phantoms/PowerLawTexture.h"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include "Core/Parallel.h"

namespace crease {
namespace {

using Complex = std::complex<double>;
constexpr double kTwoPi = 2 * std::numbers::pi;

// x_k <- sum_j x_j exp(2 pi i j k / n), n = x.size() a power of two (Cooley and Tukey, in place);
// roots[j] = exp(2 pi i j / n).
void fourier_transform(std::span<Complex> x, std::span<const Complex> roots) {
  const std::size_t n = x.size();
  for (std::size_t i = 1, reversed = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; reversed & bit; bit >>= 1) reversed ^= bit;
    reversed ^= bit;
    if (i < reversed) std::swap(x[i], x[reversed]);
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    for (std::size_t start = 0; start < n; start += length) {
      for (std::size_t k = 0; k < length / 2; ++k) {
        const Complex w = roots[k * (n / length)];
        const Complex a = x[start + k], b = x[start + k + length / 2];
        const Complex turned(w.real() * b.real() - w.imag() * b.imag(),
                             w.real() * b.imag() + w.imag() * b.real());
        x[start + k] = a + turned;
        x[start + k + length / 2] = a - turned;
      }
    }
  }
}

// Along every axis of an array of n per axis.
template <int Dim>
void fourier_transform_all(std::vector<Complex>& x, int n) {
  std::vector<Complex> roots(n);
  for (int j = 0; j < n; ++j) roots[j] = {std::cos(kTwoPi * j / n), std::sin(kTwoPi * j / n)};
  const std::int64_t num_lines = std::ssize(x) / n;
  std::int64_t stride = 1;
  for (int axis = 0; axis < Dim; ++axis, stride *= n) {
    parallel_for(num_lines, [&](std::int64_t k) {
      Complex* first = x.data() + k / stride * stride * n + k % stride;
      std::vector<Complex> line(n);
      for (int i = 0; i < n; ++i) line[i] = first[i * stride];
      fourier_transform(line, roots);
      for (int i = 0; i < n; ++i) first[i * stride] = line[i];
    });
  }
}

std::array<double, 4> cubic_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (4 - 3 * t * t * (2 - t)) / 6, (4 - 3 * s * s * (2 - s)) / 6,
          t * t * t / 6};
}

}  // namespace

template <int Dim>
PowerLawTexture<Dim>::PowerLawTexture(double period_mm, double exponent, double blur_mm,
                                      Random random, double lowest_frequency)
    : size_(1) {
  while (size_ < period_mm) size_ *= 2;
  const int n = size_;
  std::size_t count = 1;
  for (int a = 0; a < Dim; ++a) count *= static_cast<std::size_t>(n);
  std::vector<Complex> spectrum(count);
  double variance = 0;
  for (std::size_t k = 0; k < count; ++k) {
    double f2 = 0, prefilter = 1;
    for (std::size_t a = 0, rest = k; a < Dim; ++a, rest /= static_cast<std::size_t>(n)) {
      const int i = static_cast<int>(rest % static_cast<std::size_t>(n));
      const double f = double(i <= n / 2 ? i : i - n) / n;
      f2 += f * f;
      prefilter *= 3 / (2 + std::cos(kTwoPi * f));
    }
    const Complex z(random.normal(), random.normal());
    if (f2 == 0 || f2 < lowest_frequency * lowest_frequency)
      continue;  // mean 0, and nothing below the lowest frequency
    const double blur = kTwoPi * blur_mm;
    const double amplitude = std::pow(f2, -0.5 * exponent) * std::exp(-0.5 * blur * blur * f2);
    variance += amplitude * amplitude * std::norm(z) / 2;
    spectrum[k] = amplitude * prefilter * z;
  }
  fourier_transform_all<Dim>(spectrum, n);
  coefficients_.resize(count);
  const double scale = 1 / std::sqrt(variance);
  for (std::size_t i = 0; i < count; ++i) coefficients_[i] = scale * spectrum[i].real();
}

template <int Dim>
double PowerLawTexture<Dim>::operator()(const Point<Dim>& x) const {
  const auto mask = static_cast<std::int64_t>(size_ - 1);
  std::array<std::array<double, 4>, Dim> weights;
  std::array<std::int64_t, Dim> first;
  for (int a = 0; a < Dim; ++a) {
    const double floor = std::floor(x[a]);
    weights[a] = cubic_weights(x[a] - floor);
    first[a] = static_cast<std::int64_t>(floor) - 1;
  }
  double sum = 0;
  constexpr int kRows = Dim == 2 ? 4 : 16;
  for (int r = 0; r < kRows; ++r) {
    const int b = r % 4, c = r / 4;
    std::int64_t row = (first[1] + b) & mask;
    double weight = weights[1][b];
    if constexpr (Dim == 3) {
      row += ((first[2] + c) & mask) * size_;
      weight *= weights[2][c];
    }
    const double* values = &coefficients_[static_cast<std::size_t>(row * size_)];
    double line = 0;
    for (int a = 0; a < 4; ++a) line += weights[0][a] * values[(first[0] + a) & mask];
    sum += weight * line;
  }
  return sum;
}

template class PowerLawTexture<2>;
template class PowerLawTexture<3>;

}  // namespace crease
