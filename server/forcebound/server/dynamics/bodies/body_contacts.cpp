#include "forcebound/server/dynamics/bodies/body_contacts.hpp"

#include <cmath>

namespace forcebound::server {
namespace {

// Contacts of the same geometries this close to each other are one.
constexpr double kSame_m = 0.005;

bool is_same(const mjContact& one, const mjContact& other) noexcept {
  return one.geom1 == other.geom1 && one.geom2 == other.geom2 && mju_dist3(one.pos, other.pos) < kSame_m;
}

}  // namespace

void RecentContacts::update(const mjData& data) noexcept {
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    if (!acts(contact)) continue;
    std::size_t at = 0;
    while (at < contacts_.size() && !is_same(contacts_[at], contact)) ++at;
    if (at == kMost) continue;
    if (at == contacts_.size()) contacts_.emplace_back();
    contacts_[at] = contact;
    seen_s_[at] = data.time;
  }
  // A state copied from another may be of an earlier time.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!(std::abs(data.time - seen_s_[i]) < kTrembles_s)) continue;
    contacts_[kept] = contacts_[i];
    seen_s_[kept++] = seen_s_[i];
  }
  contacts_.resize(kept);
}

}  // namespace forcebound::server
