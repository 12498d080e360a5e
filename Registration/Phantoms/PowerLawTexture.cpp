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

// Rows of an n x n array, then its columns.
void fourier_transform_2d(std::vector<Complex>& x, int n) {
  std::vector<Complex> roots(n);
  for (int j = 0; j < n; ++j) roots[j] = {std::cos(kTwoPi * j / n), std::sin(kTwoPi * j / n)};
  parallel_for(
      n, [&](std::int64_t row) { fourier_transform(std::span(x).subspan(row * n, n), roots); });
  parallel_for(n, [&](std::int64_t column) {
    std::vector<Complex> line(n);
    for (int row = 0; row < n; ++row) line[row] = x[std::size_t(row) * n + column];
    fourier_transform(line, roots);
    for (int row = 0; row < n; ++row) x[std::size_t(row) * n + column] = line[row];
  });
}

std::array<double, 4> cubic_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (4 - 3 * t * t * (2 - t)) / 6, (4 - 3 * s * s * (2 - s)) / 6,
          t * t * t / 6};
}

}  // namespace

PowerLawTexture::PowerLawTexture(double period_mm, double exponent, double blur_mm, Random random)
    : size_(1) {
  while (size_ < period_mm) size_ *= 2;
  const int n = size_;
  std::vector<Complex> spectrum(std::size_t(n) * n);
  double variance = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double fx = double(i <= n / 2 ? i : i - n) / n, fy = double(j <= n / 2 ? j : j - n) / n;
      const double f2 = fx * fx + fy * fy;
      const Complex z(random.normal(), random.normal());
      if (f2 == 0) continue;  // mean 0
      const double blur = kTwoPi * blur_mm;
      const double amplitude = std::pow(f2, -0.5 * exponent) * std::exp(-0.5 * blur * blur * f2);
      const double prefilter = 9 / ((2 + std::cos(kTwoPi * fx)) * (2 + std::cos(kTwoPi * fy)));
      variance += amplitude * amplitude * std::norm(z) / 2;
      spectrum[std::size_t(j) * n + i] = amplitude * prefilter * z;
    }
  }
  fourier_transform_2d(spectrum, n);
  coefficients_.resize(spectrum.size());
  const double scale = 1 / std::sqrt(variance);
  for (std::size_t i = 0; i < spectrum.size(); ++i) coefficients_[i] = scale * spectrum[i].real();
}

double PowerLawTexture::operator()(const Point<2>& x) const {
  const double fx = std::floor(x[0]), fy = std::floor(x[1]);
  const auto wx = cubic_weights(x[0] - fx), wy = cubic_weights(x[1] - fy);
  const auto mask = static_cast<std::int64_t>(size_ - 1);
  const auto i0 = static_cast<std::int64_t>(fx) - 1, j0 = static_cast<std::int64_t>(fy) - 1;
  double sum = 0;
  for (int b = 0; b < 4; ++b) {
    const double* row = &coefficients_[((j0 + b) & mask) * size_];
    double line = 0;
    for (int a = 0; a < 4; ++a) line += wx[a] * row[(i0 + a) & mask];
    sum += wy[b] * line;
  }
  return sum;
}

}  // namespace crease
