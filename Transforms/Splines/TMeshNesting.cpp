#include "Transforms/Splines/TMeshNesting.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <map>

#include "Core/Error.h"
#include "Core/Parallel.h"

namespace crease {
namespace {

using Lines = std::array<std::vector<int>, 2>;

/// Splits functions until they are those of a mesh.
class Splitter {
 public:
  struct Wish {  // an edge that the mesh lacks
    int axis;
    TPoint through;
  };
  struct Result {
    std::vector<std::pair<TPoint, double>> parts;  // functions of the mesh, by their vertices
    std::vector<Wish> wishes;
  };

  explicit Splitter(const TMesh& mesh) : mesh_(mesh), h_(mesh.border_lines()) {}

  /// Parts of larger support come first, so that equal parts meet and are split together.
  Result split(const Lines& function) const {
    Result result;
    std::map<Key, double> todo;
    todo[key(function)] = 1;
    while (!todo.empty()) {
      const Lines part = todo.begin()->first.second;
      const double share = todo.begin()->second;
      todo.erase(todo.begin());
      const TPoint at = {part[0][h_], part[1][h_]};
      const Lines wanted = {mesh_.knot_lines(0, at), mesh_.knot_lines(1, at)};
      if (insert_missing(part, wanted, share, todo)) continue;
      make_wishes(part, wanted, at, result.wishes);
      result.parts.emplace_back(at, share);
    }
    return result;
  }

 private:
  using Key = std::pair<int, Lines>;
  static Key key(const Lines& f) {
    return {f[0].front() - f[0].back() + f[1].front() - f[1].back(), f};
  }

  /// Splits at the first line within the function that the mesh knows and the function does not.
  bool insert_missing(const Lines& part, const Lines& wanted, double share,
                      std::map<Key, double>& todo) const {
    for (int axis : {0, 1}) {
      const auto& own = part[axis];
      for (int line : wanted[axis]) {
        if (line <= own.front() || line >= own.back() ||
            std::binary_search(own.begin(), own.end(), line)) {
          continue;
        }
        std::vector<int> all = own;
        all.insert(std::upper_bound(all.begin(), all.end(), line), line);
        const auto [first, last] = shares(axis, own, line);
        Lines half = part;
        half[axis].assign(all.begin(), all.end() - 1);
        if (first > 0) todo[key(half)] += first * share;
        half[axis].assign(all.begin() + 1, all.end());
        if (last > 0) todo[key(half)] += last * share;
        return true;
      }
    }
    return false;
  }

  /// N = first * N[all knots but the last] + last * N[all but the first], with `line` inserted. Functions
  /// without support have no share.
  std::pair<double, double> shares(int axis, const std::vector<int>& own, int line) const {
    const auto t = [&](int k) { return mesh_.knot(axis, k); };
    const int n = mesh_.degree();
    const auto share = [](double part, double whole) { return whole > 0 ? part / whole : 0.0; };
    const double first = line < own[n] ? share(t(line) - t(own[0]), t(own[n]) - t(own[0])) : 1.0;
    const double last =
        line > own[1] ? share(t(own[n + 1]) - t(line), t(own[n + 1]) - t(own[1])) : 1.0;
    return {first, last};
  }

  void make_wishes(const Lines& part, const Lines& wanted, TPoint at,
                   std::vector<Wish>& wishes) const {
    for (int axis : {0, 1}) {
      if (!mesh_.touches(axis, at)) wishes.push_back({axis, at});
      for (int line : part[axis]) {
        if (std::binary_search(wanted[axis].begin(), wanted[axis].end(), line)) continue;
        TPoint through = at;
        through[axis] = line;
        wishes.push_back({1 - axis, through});
      }
    }
  }

  const TMesh& mesh_;
  int h_;
};

void add_all(const TMesh& from, TMesh& to) {
  for (const TSegment& s : from.segments()) to.add(s);
}

}  // namespace

TNesting nested(const TMesh& coarse, TMesh finer) {
  if (coarse.degree() != finer.degree()) {
    throw InvalidInput(message("nested: the degrees of the T-meshes are ", coarse.degree(), " and ",
                               finer.degree(), "; they must be equal."));
  }
  const TMesh start = coarse.on_lines({finer.lines(0), finer.lines(1)});
  add_all(start, finer);
  const auto functions = start.vertices();
  while (true) {
    finer = analysis_suitable(std::move(finer));
    const Splitter splitter(finer);
    std::vector<Splitter::Result> results(functions.size());
    constexpr std::int64_t kChunk = 64;
    parallel_for((std::ssize(functions) + kChunk - 1) / kChunk, [&](std::int64_t chunk) {
      const auto end = std::min(std::ssize(functions), (chunk + 1) * kChunk);
      for (auto i = chunk * kChunk; i < end; ++i) {
        results[i] =
            splitter.split({start.knot_lines(0, functions[i]), start.knot_lines(1, functions[i])});
      }
    });
    bool complete = true;
    for (const auto& result : results) {
      for (const auto& wish : result.wishes) {
        if (finer.touches(wish.axis, wish.through)) continue;  // another wish was the same
        finer.add_through(wish.axis, wish.through);
        complete = false;
      }
    }
    if (!complete) continue;

    const auto vertices = finer.vertices();
    std::map<TPoint, int> number;
    for (std::size_t j = 0; j < vertices.size(); ++j) number[vertices[j]] = static_cast<int>(j);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < results.size(); ++i) {
      for (const auto& [at, share] : results[i].parts) {
        entries.emplace_back(static_cast<int>(i), number.at(at), share);
      }
    }
    TNesting result{std::move(finer), {}};
    result.transfer.resize(std::ssize(functions), std::ssize(vertices));
    result.transfer.setFromTriplets(entries.begin(), entries.end());
    return result;
  }
}

TCommonMesh common_refinement(const TMesh& first, const TMesh& second) {
  TNesting of_first = nested(first, second);
  while (true) {
    TNesting of_second = nested(second, of_first.mesh);
    if (of_second.mesh == of_first.mesh) {
      return {std::move(of_second.mesh), of_first.transfer, of_second.transfer};
    }
    of_first = nested(first, std::move(of_second.mesh));
  }
}

TFit fit(const TMesh& to, const TMesh& from,
         const Eigen::Ref<const Eigen::MatrixXd>& control_points) {
  const TCommonMesh common = common_refinement(to, from);
  const Eigen::MatrixXd target = control_points * common.second;
  const Eigen::SparseMatrix<double> normal = common.first * common.first.transpose();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
  if (factor.info() != Eigen::Success) {
    throw SolverError("fit: the functions of the T-mesh depend on each other.");
  }
  TFit result{Eigen::MatrixXd::Zero(target.rows(), common.first.rows()), 0};
  Eigen::MatrixXd rest = target;
  for (int pass = 0; pass < 3; ++pass) {  // the further ones against rounding
    result.control_points += factor.solve(common.first * rest.transpose()).transpose();
    rest = target - result.control_points * common.first;
  }
  result.max_error = rest.colwise().norm().maxCoeff();
  return result;
}

}  // namespace crease
