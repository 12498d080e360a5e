#include "Testing/Benchmarks/Samples.h"

#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/StructuredTriangulation.h"

namespace crease::benchmarks {

KnotNet<2> jittered_net(const Raster<2>& raster, const std::array<int, 2>& cells, int degree,
                        double alpha) {
  const Box<2> box = raster.bounds();
  DomainMesh domain;
  domain.mesh = structured_triangulation(box, cells[0], cells[1], Diagonals::kRising);
  const Vector<2> cell = box.size().cwiseQuotient(Vector<2>(cells[0], cells[1]));
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  for (auto& v : domain.mesh.vertices) {
    const Vector<2> shift(uniform(engine) * cell.x(), uniform(engine) * cell.y());
    const bool inner = (v - box.lower).minCoeff() > 1.0 && (box.upper - v).minCoeff() > 1.0;
    if (inner) v += shift;
  }
  KnotOptions options;
  options.degree = degree;
  options.alpha = alpha;
  return place_knots(domain, options).net;
}

}  // namespace crease::benchmarks
