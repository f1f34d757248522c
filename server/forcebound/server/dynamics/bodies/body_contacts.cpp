#include "forcebound/server/dynamics/bodies/body_contacts.hpp"

#include <cmath>

namespace forcebound::server {
namespace {

// Contacts of the same geometries this close to each other are one.
constexpr double kSame_m = 0.005;

bool is_same(const mjContact& one, const mjContact& other) noexcept {
  return one.geom1 == other.geom1 && one.geom2 == other.geom2 && mju_dist3(one.pos, other.pos) < kSame_m;
}

using Turned = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

scene::Point in_body(const mjData& data, int body, const scene::Point& at_m) noexcept {
  return Turned(data.xmat + 9 * body).transpose() * (at_m - Eigen::Map<const scene::Point>(data.xpos + 3 * body));
}

scene::Point in_scene(const mjData& data, int body, const scene::Point& at_m) noexcept {
  return Eigen::Map<const scene::Point>(data.xpos + 3 * body) + Turned(data.xmat + 9 * body) * at_m;
}

}  // namespace

/// To where its bodies are now. False if it is over.
bool RecentContacts::carry(const mjModel& model, const mjData& data, std::size_t at) noexcept {
  const Seen& seen = seen_[at];
  // A state copied from another may be of an earlier time.
  const double since_s = std::abs(data.time - seen.time_s);
  if (!(since_s < kHops_s)) return false;
  mjContact& contact = contacts_[at];
  const int first = model.geom_bodyid[contact.geom1];
  const int second = model.geom_bodyid[contact.geom2];
  const scene::Point of_first_m = in_scene(data, first, seen.in_first_m);
  const scene::Point of_second_m = in_scene(data, second, seen.in_second_m);
  // A contact's normal is out of its first geom.
  const double lifted_m = Eigen::Map<const scene::Point>(contact.frame).dot(of_second_m - of_first_m);
  if (!(since_s < kTrembles_s || lifted_m < kHops_m)) return false;
  Eigen::Map<scene::Point>(contact.pos) = stands_still(model, first) ? of_second_m : of_first_m;
  return true;
}

void RecentContacts::update(const mjModel& model, const mjData& data) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!carry(model, data, i)) continue;
    contacts_[kept] = contacts_[i];
    seen_[kept++] = seen_[i];
  }
  contacts_.resize(kept);
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    if (!acts(contact)) continue;
    std::size_t at = 0;
    while (at < contacts_.size() && !is_same(contacts_[at], contact)) ++at;
    if (at == kMost) continue;
    if (at == contacts_.size()) contacts_.emplace_back();
    contacts_[at] = contact;
    const Eigen::Map<const scene::Point> at_m(contact.pos);
    seen_[at] = {.time_s = data.time,
                 .in_first_m = in_body(data, model.geom_bodyid[contact.geom1], at_m),
                 .in_second_m = in_body(data, model.geom_bodyid[contact.geom2], at_m)};
  }
}

}  // namespace forcebound::server
