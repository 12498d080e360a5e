#pragma once

#include <array>

namespace crease {

/// The numbers 0 .. product of size - 1 as index tuples, first axis fastest.
template <int Dim>
std::array<int, Dim> unravel(int number, const std::array<int, Dim>& size) {
  std::array<int, Dim> index;
  for (int a = 0; a < Dim; ++a) {
    index[a] = number % size[a];
    number /= size[a];
  }
  return index;
}

/// The number of an index tuple: the inverse of unravel().
template <int Dim>
int ravel(const std::array<int, Dim>& index, const std::array<int, Dim>& size) {
  int number = index[Dim - 1];
  for (int a = Dim - 2; a >= 0; --a) number = number * size[a] + index[a];
  return number;
}

template <int Dim>
int product(const std::array<int, Dim>& size) {
  int n = 1;
  for (int s : size) n *= s;
  return n;
}

}  // namespace crease
