#include "Images/ImageFile.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Registration.h"
int main() {
  using namespace crease;
  const auto fixed = read_image<2>("fixed.mha").image, moving = read_image<2>("moving.mha").image;
  const auto bones = read_labels<2>("labels.mha");
  const auto domain = make_creased_domain(rectangle_of(fixed.raster()), bones, {});
  Registration<2> registration(fixed, moving);
  registration.basis(domain.basis)
      .metric(ssd<2>())
      .energy("bending", default_bending_weight(*domain.basis), bending<2>(body_weights<2>()))
      .energy("rigidity", 1, rigidity<2>())
      .landmarks(read_landmarks<2>("landmarks.csv"))
      .schedule({.levels = 3, .adapt_weights = true});
  const auto result = registration.run();
  return result.improved ? 0 : 1;
}
