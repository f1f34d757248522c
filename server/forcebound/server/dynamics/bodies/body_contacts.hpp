#pragma once

#include <mujoco/mujoco.h>

#include <cstddef>
#include <span>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"

/// What a contact of MuJoCo's says of a body.
namespace forcebound::server {

[[nodiscard]] inline bool is_of_body(const mjModel& model, const mjContact& contact, int body) noexcept {
  return model.geom_bodyid[contact.geom1] == body || model.geom_bodyid[contact.geom2] == body;
}

/// Those within a gap do not.
[[nodiscard]] inline bool acts(const mjContact& contact) noexcept { return contact.dist < contact.includemargin; }

[[nodiscard]] inline bool touches(const mjModel& model, const mjContact& contact, int body) noexcept {
  return acts(contact) && is_of_body(model, contact, body);
}

[[nodiscard]] inline bool stands_still(const mjModel& model, int body) noexcept { return model.body_weldid[body] == 0; }

struct Neighbour {
  int body;
  scene::Point into;  ///< unit, from the body towards it
};

[[nodiscard]] inline Neighbour neighbour(const mjModel& model, const mjContact& contact, int body) noexcept {
  // A contact's normal is out of its first geom.
  const scene::Point normal = Eigen::Map<const scene::Point>(contact.frame);
  const int first = model.geom_bodyid[contact.geom1];
  return first == body ? Neighbour{model.geom_bodyid[contact.geom2], normal} : Neighbour{first, -normal};
}

/// Contacts that act, or did until shortly before: what rests on several points stands on some of them at a time, and
/// trembles, hops or rocks while it is pushed, so that one step does not show what bears it. Each as it was when it
/// acted last, where its bodies have carried it since. Memory is taken at the start. Real time.
class RecentContacts {
 public:
  /// For how long what rests may touch nothing [s].
  static constexpr double kTrembles_s = 0.03;
  /// The same of what is hardly lifted [s], [m]: not all steps are looked at, and a box that slides on its front edge
  /// touches with its back but now and then.
  static constexpr double kHops_s = 0.2;
  static constexpr double kHops_m = 5e-4;
  /// More are left out.
  static constexpr std::size_t kMost = 256;

  RecentContacts() { contacts_.reserve(kMost); }

  /// After a step.
  void update(const mjModel& model, const mjData& data) noexcept;

  [[nodiscard]] std::span<const mjContact> all() const noexcept { return contacts_; }

 private:
  /// When it acted last, and where it was then in the frames of its bodies.
  struct Seen {
    double time_s = 0;
    scene::Point in_first_m = scene::Point::Zero();
    scene::Point in_second_m = scene::Point::Zero();
  };

  [[nodiscard]] bool carry(const mjModel& model, const mjData& data, std::size_t at) noexcept;

  std::vector<mjContact> contacts_;
  std::vector<Seen> seen_ = std::vector<Seen>(kMost);
};

}  // namespace forcebound::server
