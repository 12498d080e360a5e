#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace crease {

/// A multiset of at most 9 knot numbers (degree 5 in 3D), ascending.
struct KnotSet {
  std::array<int, 9> knots{};
  int size = 0;

  void insert(int knot) {
    int i = size++;
    for (; i > 0 && knots[i - 1] > knot; --i) knots[i] = knots[i - 1];
    knots[i] = knot;
  }
  /// The set without the knot at a position.
  KnotSet without(int position) const {
    KnotSet rest;
    for (int i = 0; i < size; ++i) {
      if (i != position) rest.knots[rest.size++] = knots[i];
    }
    return rest;
  }
  bool operator==(const KnotSet& other) const = default;
};

/// A hash table from multisets of knots to numbers.
class KnotSetIndex {
 public:
  KnotSetIndex() : slots_(1 << 10) {}

  /// Puts (set, value) unless the set is there. Returns its slot and whether it was new; slots move
  /// when later sets are inserted.
  std::pair<std::size_t, bool> insert(const KnotSet& set, int value) {
    if (4 * count_ > 3 * slots_.size()) grow();
    const std::size_t slot = find(set);
    if (slots_[slot].used) return {slot, false};
    slots_[slot] = {set, value, true};
    ++count_;
    return {slot, true};
  }
  /// The slot of a set, or the free one where it would go.
  std::size_t find(const KnotSet& set) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash(set) & mask;
    while (slots_[slot].used && !(slots_[slot].set == set)) slot = (slot + 1) & mask;
    return slot;
  }
  int& value(std::size_t slot) { return slots_[slot].value; }

 private:
  struct Slot {
    KnotSet set;
    int value = 0;
    bool used = false;
  };

  static std::size_t hash(const KnotSet& set) {
    std::uint64_t h = 0x9e3779b97f4a7c15u + set.size;
    for (int i = 0; i < set.size; ++i) {
      h = (h ^ static_cast<std::uint64_t>(set.knots[i])) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return h;
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& s : old) {
      if (s.used) slots_[find(s.set)] = s;
    }
  }

  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

}  // namespace crease
