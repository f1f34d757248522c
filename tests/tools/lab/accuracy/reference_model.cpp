#include "tests/tools/lab/accuracy/reference_model.hpp"

#include <utility>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

std::uint32_t rows_of(const std::vector<Vector>& positions) {
  return static_cast<std::uint32_t>(positions.front().rows());
}

}  // namespace

ReferenceModel::ReferenceModel(std::shared_ptr<const scene::Scene> scene, double uncertainty, std::string why)
    : fine_(std::move(scene)), uncertainty_(uncertainty), why_(std::move(why)) {}

ReferenceModel::ReferenceModel(std::span<const std::shared_ptr<const scene::Scene>> levels,
                               std::span<const double> spacings, std::span<const Along> runs, Levels use)
    : fine_(levels.back()) {
  const std::size_t last = levels.size() - 1;
  const Forces& fine = runs[last].forces;
  const Forces& middle = runs[last - 1].forces;
  const double size_N = rms(fine);
  uncertainty_ = size_N > 0 ? rms_difference(middle, fine) / size_N : 0;
  why_ = "the finest level: there are fewer than three";
  if (levels.size() < 3) return;
  const Spacings three{spacings[last - 2], spacings[last - 1], spacings[last]};
  const Extrapolation found = richardson(runs[last - 2].forces, middle, fine, three);
  if (use == Levels::only_the_finest && found.order > 0) {
    why_ =
        "the finest level: bodies in contact come to no common limit, though tick by tick their forces have an "
        "observed order of " +
        text::rounded(found.order);
    return;
  }
  uncertainty_ = found.uncertainty;
  order_ = found.order;
  why_ = found.why;
  if (!(order_ > 0)) return;
  middle_ = levels[last - 1];
  further_ = beyond_the_finest(three, order_);
}

Along ReferenceModel::along(std::span<const Along> runs) const {
  Along fine = runs.back();
  if (middle_ == nullptr) return fine;
  const Along& middle = runs[runs.size() - 2];
  for (std::size_t i = 0; i < fine.forces.size(); ++i) {
    fine.forces[i] += further_ * (fine.forces[i] - middle.forces[i]);
  }
  fine.work_J += further_ * (fine.work_J - middle.work_J);
  return fine;
}

void ReferenceModel::fill_in(DeviceRun& run) const {
  if (run.ticks.empty()) return;
  scene::SceneState fine(fine_, rows_of(run.true_positions));
  std::optional<scene::SceneState> middle;
  if (middle_ != nullptr) middle.emplace(middle_, rows_of(run.true_positions));
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    DeviceTick& tick = run.ticks[i];
    tick.reference = fine.answer(run.true_positions[i], tick.time).force;
    if (middle) tick.reference += further_ * (tick.reference - middle->answer(run.true_positions[i], tick.time).force);
  }
}

}  // namespace forcebound::lab
