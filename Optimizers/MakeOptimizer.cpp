#include "Optimizers/MakeOptimizer.h"

#include "Optimizers/GaussNewton.h"
#include "Optimizers/Lbfgs.h"
#include "Optimizers/NelderMead.h"
#include "Optimizers/NonlinearConjugateGradient.h"
#include "Optimizers/SteepestDescent.h"

namespace crease {

std::unique_ptr<Optimizer> make_optimizer(OptimizerKind kind, const OptimizerOptions& stopping) {
  switch (kind) {
    case OptimizerKind::kLbfgs:
      return std::make_unique<Lbfgs>(stopping);
    case OptimizerKind::kConjugateGradient:
      return std::make_unique<NonlinearConjugateGradient>(stopping);
    case OptimizerKind::kSteepestDescent:
      return std::make_unique<SteepestDescent>(stopping);
    case OptimizerKind::kNelderMead:
      return std::make_unique<NelderMead>(stopping);
    default:
      return std::make_unique<GaussNewton>(stopping);
  }
}

}  // namespace crease
