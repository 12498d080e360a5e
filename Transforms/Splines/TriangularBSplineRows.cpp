#include "Transforms/Splines/TriangularBSplineRows.h"

#include <algorithm>
#include <cmath>

#include "Core/Parallel.h"
#include "Transforms/Splines/BlockSampling.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/KnotRaster.h"
#include "Transforms/Splines/TriangularBSplineEvaluator.h"

namespace crease {
namespace {

constexpr int kBlock = RowBand::kRows;  // bands and curvature blocks have the same height
constexpr int kMaxStrip = 16;
constexpr int kLanes = LanePoints::kMaxLanes;
constexpr double kStripFineness = 0.25;  // control points lie closer at creases
constexpr float kNegligible = 1e-8f;     // below the resolution of single precision next to 1

static_assert(kBlock == CurvatureBlocks<2>::kBlock);

// What the builder of a band knows of a sample.
struct Sample {
  int owner = -1;     // triangle, -1 outside
  bool core = false;  // of the owner
  int batch = -1;     // strips: where its values are
  int lane = 0;
};

// The values of up to 16 samples, within the band's arrays: weights [control point][lane].
struct Batch {
  int start = 0, count = 0;  // control points
  int lanes = 0;
};

class BandBuilder {
 public:
  BandBuilder(const TriangularBSplineBasis<2>& basis, const TriangularBSplineEvaluator& evaluator,
              const Raster<2>& raster, const std::vector<RasterTriangle>& triangles, double tie)
      : basis_(basis),
        evaluator_(evaluator),
        raster_(raster),
        triangles_(triangles),
        tie_(tie),
        step_(raster.index_to_point()),
        place_(basis.num_control_points()),
        point_stamp_(basis.num_control_points(), 0) {}

  RowBand build(int band, const std::vector<int>& candidates,
                TriangularBSplineEvaluator::Scratch& scratch) {
    first_row_ = band * kBlock;
    num_rows_ = std::min(kBlock, raster_.size[1] - first_row_);
    samples_.assign(static_cast<std::size_t>(kBlock) * raster_.size[0], {});
    for (int t : candidates) mark(t);
    evaluate_strips(scratch);
    RowBand result;
    reserve_weights(result);
    for (int r = 0; r < num_rows_; ++r) {
      result.row_start[r] = static_cast<int>(result.runs.size());
      add_runs(r, result);
    }
    for (int r = num_rows_; r <= kBlock; ++r) {
      result.row_start[r] = static_cast<int>(result.runs.size());
    }
    result.weights.resize(result.weights.size() + kMaxStrip, 0.0f);
    list_parts(result);
    add_blocks(result);
    return result;
  }

 private:
  Sample& sample(int row, int i) {
    return samples_[static_cast<std::size_t>(row) * raster_.size[0] + i];
  }
  Point<2> position(int row, int i) const {
    return raster_.origin + i * step_.col(0) + (first_row_ + row) * step_.col(1);
  }

  // Triangles come in ascending order: the lowest number keeps a sample on a common edge, but a core has
  // the first claim, its polynomial holds on its border too.
  void mark(int t) {
    for (int r = 0; r < num_rows_; ++r) {
      const auto [first, last] = triangles_[t].whole.samples(first_row_ + r, tie_);
      for (int i = first; i <= last; ++i) {
        if (sample(r, i).owner < 0) sample(r, i).owner = t;
      }
      const auto [core_first, core_last] = triangles_[t].core.samples(first_row_ + r, tie_);
      for (int i = core_first; i <= core_last; ++i) {
        if (!sample(r, i).core) sample(r, i) = {t, true, -1, 0};
      }
    }
  }

  // Strip samples of neighbouring blocks are evaluated together as far as they fit.
  void evaluate_strips(TriangularBSplineEvaluator::Scratch& scratch) {
    batches_.clear();
    batch_points_.clear();
    batch_weights_.clear();
    pending_.clear();
    int last_block = 0;
    const int num_blocks = (raster_.size[0] + kBlock - 1) / kBlock;
    for (int b = 0; b < num_blocks; ++b) {
      const int begin = b * kBlock, end = std::min(raster_.size[0], begin + kBlock);
      const std::size_t before = pending_.size();
      for (int r = 0; r < num_rows_; ++r) {
        for (int i = begin; i < end; ++i) {
          if (sample(r, i).owner >= 0 && !sample(r, i).core) pending_.emplace_back(r, i);
        }
      }
      if (pending_.size() == before) continue;
      if (before > 0 && (pending_.size() > kLanes || b > last_block + 1)) {
        std::vector<std::pair<int, int>> next(pending_.begin() + before, pending_.end());
        pending_.resize(before);
        evaluate_pending(scratch);
        pending_ = std::move(next);
      }
      last_block = b;
    }
    if (!pending_.empty()) evaluate_pending(scratch);
  }

  void evaluate_pending(TriangularBSplineEvaluator::Scratch& scratch) {
    const int count = static_cast<int>(pending_.size());
    const int batch = static_cast<int>(batches_.size());
    holders_.clear();
    for (int l = 0; l < count; ++l) {
      const auto [r, i] = pending_[l];
      Sample& s = sample(r, i);
      s.batch = batch;
      s.lane = l;
      const Point<2> p = position(r, i);
      const Point<2>& inside = basis_.patch(s.owner).centre();
      lanes_.x[l] = lanes_.side_x[l] = p.x();
      lanes_.y[l] = lanes_.side_y[l] = p.y();
      lanes_.inside_x[l] = inside.x();
      lanes_.inside_y[l] = inside.y();
      if (std::find(holders_.begin(), holders_.end(), s.owner) == holders_.end()) {
        holders_.push_back(s.owner);
      }
    }
    fill_lanes(lanes_, count);
    evaluator_.evaluate(lanes_, holders_, 0, scratch);
    Batch result{static_cast<int>(batch_points_.size()), 0, count};
    const auto found = scratch.control_points();
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double* values = scratch.lanes(static_cast<int>(k), 0);
      float weights[kLanes] = {};
      float largest = 0.0f;
      for (int l = 0; l < lanes_.lanes; ++l) {
        weights[l] = static_cast<float>(values[l]);
        largest = std::max(largest, std::abs(weights[l]));
      }
      if (largest < kNegligible) continue;
      ++result.count;
      batch_points_.push_back(found[k]);
      batch_weights_.insert(batch_weights_.end(), weights, weights + kLanes);
    }
    batches_.push_back(result);
    pending_.clear();
  }

  void add_runs(int r, RowBand& band) {
    const auto kind = [&](int i) {
      const Sample& s = sample(r, i);
      if (s.owner < 0) return static_cast<int>(GridRun::kOutside);
      return s.core ? s.owner : static_cast<int>(GridRun::kStrip);
    };
    int first = 0, end = raster_.size[0];
    while (first < end && sample(r, first).owner < 0) ++first;
    while (end > first && sample(r, end - 1).owner < 0) --end;
    while (first < end) {
      GridRun run{first, 1, kind(first), 0, 0, 0};
      const int limit = run.kind == GridRun::kStrip ? std::min(end, first + kMaxStrip) : end;
      while (first + run.count < limit && kind(first + run.count) == run.kind) ++run.count;
      if (run.kind == GridRun::kStrip) add_weights(r, run, band);
      band.runs.push_back(run);
      first += run.count;
    }
  }

  // Runs join samples of several batches, and so need somewhat more than these.
  void reserve_weights(RowBand& band) const {
    std::size_t total = 0;
    for (const Batch& batch : batches_)
      total += static_cast<std::size_t>(batch.count) * batch.lanes;
    band.weights.reserve(total + total / 3 + kMaxStrip);
  }

  // The sorted union of the control points of a strip run's samples, and their weights.
  void add_weights(int r, GridRun& run, RowBand& band) {
    ++stamp_;
    union_.clear();
    for (int i = run.first, last_batch = -1; i < run.first + run.count; ++i) {
      const int number = sample(r, i).batch;
      if (number == last_batch) continue;
      last_batch = number;
      const Batch& batch = batches_[number];
      for (int k = batch.start; k < batch.start + batch.count; ++k) {
        const int point = batch_points_[k];
        if (point_stamp_[point] == stamp_) continue;
        point_stamp_[point] = stamp_;
        union_.push_back(point);
      }
    }
    std::sort(union_.begin(), union_.end());
    for (std::size_t k = 0; k < union_.size(); ++k) place_[union_[k]] = static_cast<int>(k);

    const std::size_t start = band.weights.size();
    run.points_start = static_cast<long long>(band.points.size());
    run.weights_start = static_cast<long long>(start);
    band.weights.resize(start + union_.size() * run.count, 0.0f);
    for (int i = 0; i < run.count;) {  // pieces of neighbouring lanes of one batch
      const Sample first = sample(r, run.first + i);
      int length = 1;
      while (i + length < run.count && sample(r, run.first + i + length).batch == first.batch &&
             sample(r, run.first + i + length).lane == first.lane + length) {
        ++length;
      }
      const Batch& batch = batches_[first.batch];
      for (int k = batch.start; k < batch.start + batch.count; ++k) {
        const float* from = &batch_weights_[static_cast<std::size_t>(k) * kLanes + first.lane];
        float* to = &band.weights[start + place_[batch_points_[k]] * run.count + i];
        for (int l = 0; l < length; ++l) to[l] = from[l];
      }
      i += length;
    }
    compress(start, run.count, band);
    run.num_points = static_cast<int>(union_.size());
    band.points.insert(band.points.end(), union_.begin(), union_.end());
  }

  // Leaves out control points whose weights are negligible on this run.
  void compress(std::size_t start, int count, RowBand& band) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < union_.size(); ++k) {
      float* from = &band.weights[start + k * count];
      if (std::all_of(from, from + count, [](float w) { return std::abs(w) < kNegligible; }))
        continue;
      if (kept < k) std::copy(from, from + count, &band.weights[start + kept * count]);
      union_[kept++] = union_[k];
    }
    union_.resize(kept);
    band.weights.resize(start + kept * count);
  }

  void list_parts(RowBand& band) {
    for (const GridRun& run : band.runs) {
      if (run.kind >= 0) band.triangles.push_back(run.kind);
    }
    std::sort(band.triangles.begin(), band.triangles.end());
    band.triangles.erase(std::unique(band.triangles.begin(), band.triangles.end()),
                         band.triangles.end());
    ++stamp_;
    for (int point : band.points) {
      if (point_stamp_[point] == stamp_) continue;
      point_stamp_[point] = stamp_;
      band.strip_points.push_back(point);
    }
  }

  // How far apart the samples may lie that stand for a block: functions of narrow triangles, and those in
  // strips, vary within few samples.
  int sampling_of(const Sample& s) const {
    return block_sampling(triangles_[s.owner].control_spacing * (s.core ? 1.0 : kStripFineness));
  }

  // Each block's basis at the middle samples of its squares of `sampling` samples a side.
  void add_blocks(RowBand& band) {
    const int num_blocks = (raster_.size[0] + kBlock - 1) / kBlock;
    choose_block_samples(
        num_rows_, raster_.size[0], [&](int r, int i) { return sample(r, i).owner >= 0; },
        [&](int r, int i) { return sampling_of(sample(r, i)); },
        [&](int block, int r, int i, double share) {
          add_block((first_row_ / kBlock) * num_blocks + block, r, i,
                    static_cast<float>(std::sqrt(share)), band.blocks);
        });
  }

  void add_block(int block, int r, int i, float root_share, BlockSamples& blocks) {
    const Sample& s = sample(r, i);
    const int start = static_cast<int>(blocks.points.size());
    if (!s.core) {
      const Batch& batch = batches_[s.batch];
      order_.clear();
      for (int k = batch.start; k < batch.start + batch.count; ++k) {
        const float w = batch_weights_[static_cast<std::size_t>(k) * kLanes + s.lane];
        if (std::abs(w) >= kNegligible) order_.emplace_back(batch_points_[k], w);
      }
      std::sort(order_.begin(), order_.end());
      for (const auto& [point, weight] : order_) {
        blocks.points.push_back(point);
        blocks.weights.push_back(weight);
      }
    }
    const int count = static_cast<int>(blocks.points.size()) - start;
    blocks.samples.push_back({block, s.owner, position(r, i), s.core, root_share, start, count});
  }

  const TriangularBSplineBasis<2>& basis_;
  const TriangularBSplineEvaluator& evaluator_;
  const Raster<2>& raster_;
  const std::vector<RasterTriangle>& triangles_;
  const double tie_;
  const Matrix<2> step_;
  int first_row_ = 0, num_rows_ = 0;
  std::vector<Sample> samples_;
  std::vector<Batch> batches_;
  std::vector<std::pair<int, int>> pending_;
  std::vector<int> batch_points_;     // of all batches
  std::vector<float> batch_weights_;  // kLanes per point
  std::vector<int> holders_, union_;
  std::vector<std::pair<int, float>> order_;
  std::vector<int> place_, point_stamp_;  // per control point
  int stamp_ = 0;
  LanePoints lanes_;
};

}  // namespace

std::vector<RowBand> make_row_bands(const TriangularBSplineBasis<2>& basis,
                                    const TriangularBSplineEvaluator& evaluator,
                                    const Raster<2>& raster) {
  const auto triangles = triangles_on_raster(basis, raster);
  const auto candidates = triangles_of_block_rows(triangles, raster.size[1]);
  const double tie = kKnotTie * mesh_scale(basis.net().mesh);
  std::vector<RowBand> bands(candidates.size());
  parallel_for(std::ssize(candidates), [&](std::int64_t b) {
    thread_local TriangularBSplineEvaluator::Scratch scratch;
    BandBuilder builder(basis, evaluator, raster, triangles, tie);
    bands[b] = builder.build(static_cast<int>(b), candidates[b], scratch);
  });
  return bands;
}

}  // namespace crease
