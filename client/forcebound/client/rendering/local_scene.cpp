#include "forcebound/client/rendering/local_scene.hpp"

#include <algorithm>
#include <utility>

#include "forcebound/control/translation.hpp"
#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/tool/tool.hpp"

namespace forcebound::client {
namespace {

// Above a surface that the server says was touched.
constexpr double kAbove_m = 1e-6;

}  // namespace

void LocalScene::forget() noexcept {
  active_ = false;
  exchange_.give_back(std::exchange(scene_, nullptr));
}

void LocalScene::adopt() noexcept {
  BuiltScene* const next = exchange_.take();
  if (next == nullptr) return;
  active_ = active_ && next->state.go_on_from(scene_->state);
  exchange_.give_back(std::exchange(scene_, next));
}

bool LocalScene::knows_about(const scene::Point& place_m, double more_m) const noexcept {
  const handover::AssembledScene& made = scene_->assembled;
  const std::vector<handover::Coverage>& known = coarse_counts_ ? made.coverage : made.exact;
  const auto steps = made.scene->plan().steps();
  if (const auto& tool = made.scene->facts().tool) more_m += tool->reach_m();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double wanted_m = std::max(depth_m_, steps[i].reach_m) + more_m + handover::kBorder_m;
    if (!(known[i].known_within_m(place_m) >= wanted_m)) return false;
  }
  return true;
}

bool LocalScene::begin(const Vector& position, const scene::Point& place_m,
                       const wire::EnvironmentForce& newest) noexcept {
  const Answer& answer = newest.answer;
  const bool touched = answer.contact_normal.rows() == newest.position.rows();
  Vector outside_m = newest.position;
  if (touched) outside_m += (answer.penetration_m + kAbove_m) * answer.contact_normal;
  if (outside_m.rows() != position.rows() || !outside_m.allFinite()) return false;
  depth_m_ = 0;
  if (!knows_about(place_m, (control::translation_of(outside_m) - place_m).norm())) return false;
  scene_->state.begin_again(outside_m, first_time_);
  return true;
}

std::optional<Answer> LocalScene::answer(const Vector& position, Nanoseconds device_time,
                                         const wire::EnvironmentForce* newest, const control::Handle& handle) noexcept {
  const scene::Point place_m = control::translation_of(position);
  exchange_.store_place(place_m);
  adopt();
  if (scene_ == nullptr) return std::nullopt;
  swapped_ = !active_;
  const scene::SearchBudget budget(nodes_of_a_tick_);
  Nanoseconds age = Nanoseconds::max();
  if (newest != nullptr) {
    age = device_time - newest->motion_device_time;
    coarse_counts_ = age > (coarse_counts_ ? kCoarseSince / 2 : kCoarseSince);
  }
  if (active_) {
    active_ = knows_about(place_m, 0);
  } else {
    active_ = age <= kAnswerAgeMax && begin(position, place_m, *newest);
  }
  if (!active_) return std::nullopt;

  Answer answer = scene_->state.answer(position, device_time, {}, false, handle);
  // Something may have been passed over, now and for what the scene remembers: it begins anew.
  if (scene::SearchBudget::exhausted()) {
    ++searches_exhausted_;
    active_ = false;
    return std::nullopt;
  }
  depth_m_ = answer.penetration_m;
  quarantined_ += scene_->state.quarantined().size();
  answer.force += ripples_N(answer, {.answered_at = position, .position = position, .pushing_N = answer.force});
  return answer;
}

}  // namespace forcebound::client
