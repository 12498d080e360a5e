#include "Transforms/InvertibilityCertificate.h"

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <queue>

#include "Core/Parallel.h"
#include "Transforms/AffineEquivalent.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/DeterminantPieces.h"

namespace crease {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostDivisions = 20000;  // of the pieces of one patch
constexpr double kTightness = 0.5;     // lower bound over a value

/// What is known about one patch.
template <int Dim>
struct PatchFindings {
  double bound = -kInfinity;
  double lowest_seen = kInfinity;
  Invertibility verdict = Invertibility::kUndecided;
  FailingRegion<Dim> region;  // of the lowest value, or where the search ended undecided
};

/// Divides the pieces of a patch, the one with the lowest bound first.
template <int Dim>
class PatchSearch {
 public:
  PatchSearch(std::vector<DeterminantPiece<Dim>> pieces, double smallest_size, bool tighten)
      : smallest_size_(smallest_size), tighten_(tighten) {
    for (auto& piece : pieces) std::visit([&](auto& p) { add(std::move(p)); }, piece);
  }

  PatchFindings<Dim> run() {
    for (int divisions = 0;; ++divisions) {
      Candidate lowest = queue_.top();
      findings_.bound = lowest.bound;
      if (!(findings_.lowest_seen > 0)) {
        findings_.verdict = Invertibility::kFolded;
        return std::move(findings_);
      }
      const double goal = tighten_ ? kTightness * findings_.lowest_seen : 0.0;
      if (lowest.bound > goal) {
        findings_.verdict = Invertibility::kCertified;
        return std::move(findings_);
      }
      DeterminantPiece<Dim> piece = std::move(pieces_[lowest.piece]);
      const bool too_small = std::visit([&](auto& p) { return p.size() < smallest_size_; }, piece);
      if (too_small || divisions == kMostDivisions) {
        findings_.verdict =
            lowest.bound > 0 ? Invertibility::kCertified : Invertibility::kUndecided;
        std::visit([&](auto& p) { set_region(p); }, piece);
        return std::move(findings_);
      }
      queue_.pop();
      std::visit(
          [&](auto& p) {
            auto [first, second] = p.halves();
            add(std::move(first));
            add(std::move(second));
          },
          piece);
    }
  }

 private:
  struct Candidate {
    double bound;
    int piece;
    bool operator<(const Candidate& other) const {  // the queue's top is its largest
      return bound != other.bound ? bound > other.bound : piece > other.piece;
    }
  };

  template <typename Piece>
  void add(Piece piece) {
    for (int j = 0; j < Piece::kNumCorners; ++j) {
      const double value = piece.determinant.at_corner(j);
      if (value < findings_.lowest_seen) {
        findings_.lowest_seen = value;
        set_region(piece);
      }
    }
    // A coefficient that is not a number bounds nothing.
    const double least = piece.determinant.coefficients().template minCoeff<Eigen::PropagateNaN>();
    const double bound = std::isnan(least) ? -kInfinity : least - piece.error;
    queue_.push({bound, static_cast<int>(pieces_.size())});
    pieces_.push_back(std::move(piece));
  }

  template <typename Piece>
  void set_region(const Piece& piece) {
    FailingRegion<Dim>& region = findings_.region;
    region.corners = piece.corners();
    region.size_mm = piece.size();
    region.determinant = kInfinity;
    for (int j = 0; j < Piece::kNumCorners; ++j) {
      const double value = piece.determinant.at_corner(j);
      if (value < region.determinant) {
        region.determinant = value;
        region.at = piece.corner(j);
      }
    }
  }

  double smallest_size_;
  bool tighten_;
  std::vector<DeterminantPiece<Dim>> pieces_;
  std::priority_queue<Candidate> queue_;
  PatchFindings<Dim> findings_;
};

/// The certificate of one spline map.
template <int Dim>
class SplineCertifier {
 public:
  SplineCertifier(const SplineTransform<Dim>& transform, const DeterminantPieces<Dim>& pieces,
                  const CertificateOptions& options)
      : pieces_(pieces),
        options_(options),
        smallest_size_(options.smallest_part * transform.basis().mean_edge_length()),
        bounds_(pieces.num_patches()) {}

  InvertibilityCertificate<Dim> run() {
    parallel_for(std::ssize(bounds_), [&](std::int64_t p) {
      bounds_[p] = pieces_.rough_bound(static_cast<int>(p));
      if (std::isnan(bounds_[p])) bounds_[p] = -kInfinity;
    });
    std::vector<int> doubtful;
    for (int p = 0; p < static_cast<int>(bounds_.size()); ++p) {
      if (!(bounds_[p] > 0)) doubtful.push_back(p);
    }
    examine(doubtful);
    if (options_.tighten && certificate_.num_failing == 0) tighten();
    certificate_.num_patches = static_cast<int>(bounds_.size());
    certificate_.lower_bound = *std::min_element(bounds_.begin(), bounds_.end());
    certificate_.patch_bounds = std::move(bounds_);
    if (certificate_.num_failing == 0) certificate_.verdict = Invertibility::kCertified;
    return std::move(certificate_);
  }

 private:
  void examine(const std::vector<int>& patches) {
    std::vector<PatchFindings<Dim>> found(patches.size());
    parallel_for(std::ssize(patches), [&](std::int64_t i) {
      found[i] =
          PatchSearch<Dim>(pieces_.pieces(patches[i]), smallest_size_, options_.tighten).run();
    });
    for (std::size_t i = 0; i < patches.size(); ++i) book(patches[i], found[i]);
  }

  void book(int patch, PatchFindings<Dim>& found) {
    ++certificate_.num_examined;
    bounds_[patch] = std::max(bounds_[patch], found.bound);
    lowest_seen_ = std::min(lowest_seen_, found.lowest_seen);
    if (found.verdict == Invertibility::kCertified) return;
    ++certificate_.num_failing;
    const bool worse =
        !certificate_.failing || (found.verdict == certificate_.verdict
                                      ? found.region.determinant < certificate_.failing->determinant
                                      : found.verdict == Invertibility::kFolded);
    if (!worse) return;
    certificate_.verdict = found.verdict;
    certificate_.failing = std::move(found.region);
    certificate_.failing->patch = patch;
  }

  /// Examines the patches with the lowest rough bounds, some at a time, until the rest is above the goal.
  void tighten() {
    constexpr std::size_t kBatch = 16;
    std::vector<int> order(bounds_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return bounds_[a] < bounds_[b]; });
    std::vector<double> rough = bounds_;
    for (std::size_t begin = 0; begin < order.size(); begin += kBatch) {
      std::vector<int> batch;
      for (std::size_t i = begin; i < std::min(begin + kBatch, order.size()); ++i) {
        if (rough[order[i]] < kTightness * lowest_seen_) batch.push_back(order[i]);
      }
      if (batch.empty()) return;
      examine(batch);
    }
  }

  const DeterminantPieces<Dim>& pieces_;
  const CertificateOptions& options_;
  double smallest_size_;
  std::vector<double> bounds_;
  double lowest_seen_ = kInfinity;
  InvertibilityCertificate<Dim> certificate_;
};

/// Of a map that is the same linear map everywhere.
template <int Dim>
InvertibilityCertificate<Dim> of_linear(const Matrix<Dim>& linear) {
  const double determinant = linear.determinant();
  double rounding = 64 * std::numeric_limits<double>::epsilon();  // Hadamard's bound times
  for (int a = 0; a < Dim; ++a) rounding *= linear.col(a).norm();
  InvertibilityCertificate<Dim> certificate;
  certificate.num_patches = 1;
  certificate.lower_bound = determinant - rounding;
  if (certificate.lower_bound > 0) {
    certificate.verdict = Invertibility::kCertified;
    return certificate;
  }
  certificate.verdict = determinant <= 0 ? Invertibility::kFolded : Invertibility::kUndecided;
  certificate.num_failing = 1;
  certificate.failing.emplace();
  certificate.failing->determinant = determinant;
  certificate.failing->size_mm = kInfinity;
  return certificate;
}

/// det of a chain is the product of its parts'.
template <int Dim>
InvertibilityCertificate<Dim> of_chain(const CompositeTransform<Dim>& chain,
                                       const CertificateOptions& options) {
  InvertibilityCertificate<Dim> all;
  all.verdict = Invertibility::kCertified;
  all.lower_bound = 1;
  for (std::size_t k = 0; k < chain.num_parts(); ++k) {
    InvertibilityCertificate<Dim> part = certify_invertibility(chain.part(k), options);
    all.num_patches += part.num_patches;
    all.num_examined += part.num_examined;
    all.num_failing += part.num_failing;
    all.lower_bound = part.certified() ? all.lower_bound * part.lower_bound
                                       : std::numeric_limits<double>::quiet_NaN();
    if (part.certified() || all.verdict == Invertibility::kNotCertifiable) continue;
    const bool first = all.certified();
    all.verdict = part.verdict;
    // Whether points come to where a later part fails, or two parts fail where they meet, is not known.
    if (part.verdict == Invertibility::kFolded && !(first && k == 0)) {
      all.verdict = Invertibility::kUndecided;
    }
    if (!first || !part.failing) continue;
    all.failing = std::move(part.failing);
    all.failing->part = static_cast<int>(k);
  }
  return all;
}

template <int Dim>
InvertibilityCertificate<Dim> certificate_of(const Transform<Dim>& transform,
                                             const CertificateOptions& options) {
  if (const auto* spline = dynamic_cast<const SplineTransform<Dim>*>(&transform)) {
    const auto pieces =
        spline->basis().determinant_pieces(spline->control_points(), spline->affine().linear);
    if (!pieces || pieces->num_patches() == 0) return {};
    return SplineCertifier<Dim>(*spline, *pieces, options).run();
  }
  if (const auto* chain = dynamic_cast<const CompositeTransform<Dim>*>(&transform)) {
    return of_chain(*chain, options);
  }
  if (const auto affine = affine_equivalent(transform)) return of_linear<Dim>(affine->linear);
  return {};
}

}  // namespace

std::string to_string(Invertibility verdict) {
  switch (verdict) {
    case Invertibility::kCertified:
      return "certified";
    case Invertibility::kFolded:
      return "folded";
    case Invertibility::kUndecided:
      return "undecided";
    case Invertibility::kNotCertifiable:
      break;
  }
  return "not certifiable";
}

template <int Dim>
InvertibilityCertificate<Dim> certify_invertibility(const Transform<Dim>& transform,
                                                    const CertificateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  InvertibilityCertificate<Dim> certificate = certificate_of(transform, options);
  certificate.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

template InvertibilityCertificate<2> certify_invertibility<2>(const Transform<2>&,
                                                              const CertificateOptions&);
template InvertibilityCertificate<3> certify_invertibility<3>(const Transform<3>&,
                                                              const CertificateOptions&);

}  // namespace crease
