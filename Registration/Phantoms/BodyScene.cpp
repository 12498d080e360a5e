#include "Registration/Phantoms/BodyScene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace crease {
namespace {

// 1 inside the disc, 0 outside; distances are exact along its shorter axis.
double coverage(const SoftDisc& disc, const Point<2>& y) {
  const Vector<2> local = Eigen::Rotation2D<double>(-disc.angle_rad) * (y - disc.center);
  const double depth = (1 - local.cwiseQuotient(disc.half_axes).norm()) * disc.half_axes.minCoeff();
  return 0.5 * std::erfc(-depth / (disc.edge_mm * std::numbers::sqrt2));
}

}  // namespace

BodyScene::BodyScene(const std::vector<RigidBody>& bodies, SceneStyle style,
                     std::shared_ptr<const PowerLawTexture<2>> texture)
    : bodies_(bodies), style_(std::move(style)), texture_(std::move(texture)) {
  for (const auto& body : bodies_) to_fixed_.push_back(body.motion.inverse());
}

double BodyScene::operator()(const Point<2>& y) const {
  double grey = style_.background, contrast = style_.background_texture;
  for (const auto& disc : style_.discs) {
    const double share = coverage(disc, y);
    grey += share * (disc.grey - grey);
  }
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const double share = bodies_[k].shape.coverage(to_fixed_[k](y), style_.blur_mm);
    grey += share * (bodies_[k].grey - grey);
    contrast += share * (style_.body_texture - contrast);
  }
  return texture_ ? grey + contrast * (*texture_)(y) : grey;
}

}  // namespace crease
