#include "Transforms/CompositeTransform.h"

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"
#include "Transforms/TransformSampler.h"

namespace crease {

namespace {

/// Part after part, on all points.
template <int Dim>
class CompositeSampler final : public TransformSampler<Dim> {
 public:
  using typename TransformSampler<Dim>::Sample;
  explicit CompositeSampler(const std::vector<std::unique_ptr<Transform<Dim>>>& parts) {
    for (const auto& part : parts) parts_.push_back(part->sampler());
  }

  void sample(std::span<const Point<Dim>> x, std::span<Sample> samples) const override {
    std::vector<Point<Dim>> places(x.begin(), x.end());
    std::vector<Sample> here(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) samples[k] = {x[k], Matrix<Dim>::Identity(), true};
    for (const auto& part : parts_) {
      part->sample(places, here);
      for (std::size_t k = 0; k < x.size(); ++k) {
        samples[k].point = places[k] = here[k].point;
        samples[k].jacobian = (here[k].jacobian * samples[k].jacobian).eval();
        samples[k].in_domain = samples[k].in_domain && here[k].in_domain;
      }
    }
  }

 private:
  std::vector<std::unique_ptr<TransformSampler<Dim>>> parts_;
};

}  // namespace

template <int Dim>
CompositeTransform<Dim>::CompositeTransform(std::vector<std::unique_ptr<Transform<Dim>>> parts)
    : parts_(std::move(parts)) {
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (!parts_[k]) throw InvalidInput(message("CompositeTransform: part ", k, " is null."));
  }
}

template <int Dim>
CompositeTransform<Dim>::CompositeTransform(const CompositeTransform& other) : Transform<Dim>() {
  for (const auto& part : other.parts_) parts_.push_back(part->clone());
}

template <int Dim>
std::unique_ptr<Transform<Dim>> CompositeTransform<Dim>::clone() const {
  return std::make_unique<CompositeTransform>(*this);
}

template <int Dim>
Point<Dim> CompositeTransform<Dim>::map(const Point<Dim>& x) const {
  Point<Dim> y = x;
  for (const auto& part : parts_) y = part->map(y);
  return y;
}

template <int Dim>
Matrix<Dim> CompositeTransform<Dim>::spatial_jacobian(const Point<Dim>& x) const {
  Point<Dim> y = x;
  Matrix<Dim> jacobian = Matrix<Dim>::Identity();
  for (const auto& part : parts_) {
    jacobian = (part->spatial_jacobian(y) * jacobian).eval();
    y = part->map(y);
  }
  return jacobian;
}

template <int Dim>
typename Transform<Dim>::Sample CompositeTransform<Dim>::sample(const Point<Dim>& x) const {
  typename Transform<Dim>::Sample all{x, Matrix<Dim>::Identity(), true};
  for (const auto& part : parts_) {
    const auto here = part->sample(all.point);
    all.point = here.point;
    all.jacobian = (here.jacobian * all.jacobian).eval();
    all.in_domain = all.in_domain && here.in_domain;
  }
  return all;
}

template <int Dim>
std::unique_ptr<TransformSampler<Dim, Dim>> CompositeTransform<Dim>::sampler() const {
  return std::make_unique<CompositeSampler<Dim>>(parts_);
}

template <int Dim>
bool CompositeTransform<Dim>::in_domain(const Point<Dim>& x) const {
  Point<Dim> y = x;
  for (const auto& part : parts_) {
    if (!part->in_domain(y)) return false;
    y = part->map(y);
  }
  return true;
}

template <int Dim>
Eigen::Index CompositeTransform<Dim>::num_parameters() const {
  Eigen::Index n = 0;
  for (const auto& part : parts_) n += part->num_parameters();
  return n;
}

template <int Dim>
Eigen::VectorXd CompositeTransform<Dim>::parameters() const {
  Eigen::VectorXd all(num_parameters());
  Eigen::Index at = 0;
  for (const auto& part : parts_) {
    all.segment(at, part->num_parameters()) = part->parameters();
    at += part->num_parameters();
  }
  return all;
}

template <int Dim>
void CompositeTransform<Dim>::set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("CompositeTransform", parameters, num_parameters());
  Eigen::Index at = 0;
  for (const auto& part : parts_) {
    part->set_parameters(parameters.segment(at, part->num_parameters()));
    at += part->num_parameters();
  }
}

// Points go forward through the parts, forces back: behind part k the force is J_{k+1}^T ... J_n^T F.
template <int Dim>
void CompositeTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                          std::span<const Vector<Dim>> forces,
                                          Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("CompositeTransform", x.size(), forces.size(), gradient.size(), num_parameters());
  std::vector<std::vector<Point<Dim>>> stages = {{x.begin(), x.end()}};
  for (const auto& part : parts_) {
    std::vector<Point<Dim>> next;
    next.reserve(x.size());
    for (const auto& p : stages.back()) next.push_back(part->map(p));
    stages.push_back(std::move(next));
  }
  std::vector<Vector<Dim>> force(forces.begin(), forces.end());
  Eigen::Index at = num_parameters();
  for (std::size_t k = parts_.size(); k-- > 0;) {
    const auto& part = *parts_[k];
    at -= part.num_parameters();
    part.add_adjoint(stages[k], force, gradient.segment(at, part.num_parameters()));
    for (std::size_t p = 0; p < force.size(); ++p) {
      force[p] = (part.spatial_jacobian(stages[k][p]).transpose() * force[p]).eval();
    }
  }
}

template class CompositeTransform<2>;
template class CompositeTransform<3>;

}  // namespace crease
