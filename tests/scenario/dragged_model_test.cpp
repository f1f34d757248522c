// A client that moves a dragged body by itself between answers, against the server that knows all of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/local_model/mass_step.hpp"
#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "tests/tools/lab/rendering/rendering_tasks.hpp"

namespace forcebound::lab {
namespace {

/// What is dragged, and the most of E = RMS (model - truth) / RMS truth of the coupling's force, where each answer is
/// 100 ms old when the next one comes.
struct Dragged {
  std::string_view task;
  double error_max;

  friend void PrintTo(const Dragged& dragged, std::ostream* to) { *to << dragged.task; }
};

constexpr double kDraggedStep_s = 1e-3;
constexpr int kStepsOfAnswer = 100;
// The hands begin to touch at 2 s.
constexpr int kStepsBefore = 2000;
constexpr int kStepsOfRun = 6000;

/// The world as the server has it, along the path of a hand.
class DraggedTruth {
 public:
  explicit DraggedTruth(const RenderingTask& task)
      : hand_(task.make_hand()),
        world_(task.scene->dynamic_models().front().dynamic_model->make_state(1)),
        seat_(world_->join()) {}

  void advance(int step) {
    const double time_s = step * kDraggedStep_s;
    device_.place_m = at(time_s);
    device_.velocity_m_per_s = (device_.place_m - at(time_s - kDraggedStep_s)) / kDraggedStep_s;
    world_->press(seat_, hand_->handle(time_s).buttons.value_or(0));
    world_->move(seat_, device_.place_m, device_.velocity_m_per_s);
    world_->advance(kDraggedStep_s);
  }

  [[nodiscard]] std::optional<local_model::Mass> told() {
    local_model::LocalModel model;
    if (!world_->describe(seat_, model) || !model.has_mass) return std::nullopt;
    EXPECT_TRUE(local_model::is_sound(model));
    return model.mass;
  }
  [[nodiscard]] const local_model::DevicePoint& device() const { return device_; }
  [[nodiscard]] local_model::Point force_N() { return world_->touch(seat_).force_N; }
  [[nodiscard]] bool sound() const { return world_->sound(); }

 private:
  [[nodiscard]] local_model::Point at(double time_s) const { return hand_->target(time_s).position.head<3>(); }

  std::unique_ptr<const device::Operator> hand_;
  std::unique_ptr<scene::DynamicModelState> world_;
  int seat_;
  local_model::DevicePoint device_;
};

class DraggedModel : public testing::TestWithParam<Dragged> {};

//   hand's path, every 1 ms --> server's bodies --(answer, every 100 ms)--> local_model::step, every 1 ms, on the same
//   path
TEST_P(DraggedModel, GoesAsItsBodiesForATenthOfASecond) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  SCOPED_TRACE(GetParam().task);
  static const std::vector<RenderingTask> kTasks = rendering_tasks();  // meshes take long to make
  const auto task = std::ranges::find(kTasks, GetParam().task, &RenderingTask::name);
  ASSERT_NE(task, kTasks.end());
  DraggedTruth truth(*task);
  std::optional<local_model::Mass> mass;
  local_model::MassState state;
  double differed_N2 = 0;
  double felt_N2 = 0;
  for (int i = 1; i <= kStepsOfRun; ++i) {
    truth.advance(i);
    const local_model::Point force_N = truth.force_N();
    if (mass) local_model::step(*mass, truth.device(), kDraggedStep_s, 1, state);
    if (i > kStepsBefore) {
      ASSERT_TRUE(mass) << "nothing was told at " << i * kDraggedStep_s << " s";
      differed_N2 += (-local_model::pull_N(*mass, state, truth.device()) - force_N).squaredNorm();
      felt_N2 += force_N.squaredNorm();
    }
    // Asked on each step, as by a motion: what trembles is known from the last ones.
    const std::optional<local_model::Mass> told = truth.told();
    if (i % kStepsOfAnswer != 0) continue;
    mass = told;
    if (mass) state = local_model::state_of(*mass);
  }
  ASSERT_TRUE(truth.sound());
  ASSERT_GT(felt_N2, 0);
  EXPECT_LE(std::sqrt(differed_N2 / felt_N2), GetParam().error_max);
}

INSTANTIATE_TEST_SUITE_P(, DraggedModel,
                         testing::Values(Dragged{"sled of 0.6 kg", 0.05}, Dragged{"stack of two boxes", 0.08},
                                         Dragged{"door", 0.15}, Dragged{"button of 30 g", 0.03},
                                         Dragged{"two_on_a_block", 0.25}, Dragged{"grasped ball of 3 kg", 0.08},
                                         Dragged{"puck against a stop", 0.03}),
                         [](const auto& place) {
                           std::string name(place.param.task);
                           std::ranges::replace_if(
                               name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

}  // namespace
}  // namespace forcebound::lab
