#include "library/source/callback_environment.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "library/source/structs.hpp"

namespace forcebound::library {
namespace {

using server::Answer;
using server::ClientFacts;
using server::Motion;
using Stiffness = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

fb_client_facts facts_of(const ClientFacts& client) noexcept {
  fb_client_facts facts{};
  facts.size = sizeof facts;
  set_text(facts.device, client.device);
  facts.axes = static_cast<std::int32_t>(client.degrees_of_freedom);
  facts.renders_locally = client.renders_locally ? 1 : 0;
  facts.shows_torque = client.shows_torque ? 1 : 0;
  facts.period_s = client.period_s;
  facts.force_N_max = client.force_N_max;
  facts.round_trip_s = time::to_seconds(client.round_trip);
  return facts;
}

fb_client_motion motion_of(const Motion& motion) noexcept {
  fb_client_motion told{};
  told.size = sizeof told;
  told.read_ns = motion.device_time.count();
  told.arrived_ns = motion.server_time.count();
  std::copy_n(motion.position.data(), motion.position.rows(), told.position_m);
  if (motion.handle.buttons) {
    told.has |= FB_HAS_BUTTONS;
    told.buttons = *motion.handle.buttons;
  }
  if (motion.handle.gripper) {
    told.has |= FB_HAS_GRIPPER;
    told.gripper = *motion.handle.gripper;
  }
  if (motion.handle.orientation) {
    told.has |= FB_HAS_ORIENTATION;
    std::ranges::copy(*motion.handle.orientation, told.orientation);
  }
  return told;
}

Answer answer_of(const fb_answer& given, const Motion& motion) noexcept {
  const Eigen::Index rows = motion.position.rows();
  Answer answer{.force = Eigen::Map<const Eigen::VectorXd>(given.force_N, rows)};
  if ((given.has & FB_HAS_TORQUE) != 0) answer.torque_N_m = Eigen::Map<const Eigen::Vector3d>(given.torque_N_m);
  if ((given.has & FB_HAS_CONTACT) != 0) {
    answer.contact_normal = Eigen::Map<const Eigen::VectorXd>(given.normal, rows);
    answer.penetration_m = given.depth_m;
  }
  if (!motion.wants_model || (given.has & FB_HAS_STIFFNESS) == 0) return answer;
  local_model::Field& field = answer.model.field;
  const Eigen::Index translations = std::min<Eigen::Index>(rows, 3);
  answer.model.has_field = true;
  field.force_N.head(translations) = answer.force.head(translations);
  field.place_m.head(translations) = motion.position.head(translations);
  field.jacobian_N_per_m.topLeftCorner(translations, translations) =
      -Eigen::Map<const Stiffness>(given.stiffness_N_per_m).topLeftCorner(translations, translations);
  field.radius_m = given.radius_m;
  return answer;
}

}  // namespace

EnvironmentCallbacks::EnvironmentCallbacks(const fb_environment& given)
    : table(given), name(text_of(given.name, "environment")), simulated(text_of(given.simulated, name)) {
  table.name = table.simulated = nullptr;  // the program's, until its call ends
}

CallbackEnvironment::CallbackEnvironment(std::shared_ptr<EnvironmentCallbacks> callbacks, const ClientFacts& client)
    : callbacks_(std::move(callbacks)), own_(callbacks_->table.user) {
  if (callbacks_->table.create == nullptr) return;
  const fb_client_facts facts = facts_of(client);
  const CallbackCounts::Called called =
      callbacks_->calls.call([&] { return callbacks_->table.create(callbacks_->table.user, &facts, &own_) == FB_OK; });
  if (called.threw) throw std::runtime_error("its callback 'create' threw an exception");
  if (!called.done) throw std::runtime_error("its callback 'create' failed");
}

CallbackEnvironment::~CallbackEnvironment() {
  if (callbacks_->table.destroy == nullptr) return;
  callbacks_->calls.call([&] {
    callbacks_->table.destroy(own_);
    return true;
  });
}

Answer CallbackEnvironment::respond(const Motion& motion) noexcept {
  const fb_client_motion told = motion_of(motion);
  fb_answer given{};
  given.size = sizeof given;
  const CallbackCounts::Called called =
      callbacks_->calls.call([&] { return callbacks_->table.update(own_, &told, &given) == FB_OK; });
  return called.done ? answer_of(given, motion) : Answer{};
}

server::EnvironmentKind kind_of(const std::shared_ptr<EnvironmentCallbacks>& callbacks) {
  server::EnvironmentKind kind{.name = callbacks->name, .make = [callbacks](const ClientFacts& client) {
                                 return server::MadeEnvironment{
                                     .environment = std::make_unique<CallbackEnvironment>(callbacks, client),
                                     .simulated = callbacks->simulated};
                               }};
  if (callbacks->table.axes > 0) kind.degrees_of_freedom = {static_cast<std::uint32_t>(callbacks->table.axes)};
  return kind;
}

}  // namespace forcebound::library
