#include "Registration/AdaptiveRegistration.h"

#include <numeric>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kLeastGain = 0.002;  // of the cost; what is got is several times as much

template <typename Values>
void append(Values& to, const Values& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

template <int Dim>
AdaptiveResult<Dim> register_adaptively(const AdaptiveComposition<Dim>& composition,
                                        const RegistrationCallback& progress) {
  bool cancelled = false;
  const RegistrationCallback watch = [&](const RegistrationProgress& state) {
    cancelled = cancelled || (progress && !progress(state));
    return !cancelled;
  };
  AdaptiveResult<Dim> result;
  std::vector<FinerPlace<Dim>> places;
  const auto register_in = [&](const RegistrationResult<Dim>* earlier, bool last) {
    Registration<Dim> registration = composition.compose(composition.make_basis(places));
    if (earlier != nullptr) registration.go_on_from(*earlier);
    return registration.look_for_finer_places(!last).run(watch);
  };
  result.registration = register_in(nullptr, composition.most_rounds == 0);
  for (int round = 1; round <= composition.most_rounds && !cancelled; ++round) {
    RegistrationResult<Dim>& coarse = result.registration;
    RefinementRound report;
    report.places = static_cast<int>(coarse.finer_places.size());
    for (const auto& place : coarse.finer_places) report.expected_gain += place.gain;
    report.cost_before = coarse.cost;
    if (report.expected_gain <= kLeastGain * coarse.cost) break;
    append(places, coarse.finer_places);
    RegistrationResult<Dim> fine = register_in(&coarse, round == composition.most_rounds);
    report.control_points = fine.spline()->basis().num_control_points();
    report.cost = fine.cost;
    report.kept = fine.cost <= coarse.cost;
    result.rounds.push_back(report);
    if (!report.kept) {
      coarse.warnings.push_back(message("finer patches did not lower the cost (", fine.cost,
                                        " instead of ", coarse.cost,
                                        "); the map of the round before stays"));
      break;
    }
    for (const auto& [stage, seconds] : coarse.timings_s) fine.timings_s[stage] += seconds;
    fine.warnings.insert(fine.warnings.begin(), coarse.warnings.begin(), coarse.warnings.end());
    fine.levels.insert(fine.levels.begin(), coarse.levels.begin(), coarse.levels.end());
    fine.alignment = coarse.alignment;
    fine.metric_before = coarse.metric_before;
    result.registration = std::move(fine);
  }
  return result;
}

template AdaptiveResult<2> register_adaptively<2>(const AdaptiveComposition<2>&,
                                                  const RegistrationCallback&);

}  // namespace crease
