#pragma once

#include <dds/dds.h>

#include <memory>
#include <span>
#include <stdexcept>
#include <string>

/// Entities of Cyclone DDS, with errors as exceptions.
namespace forcebound::ros2 {

/// What was made, or @throws std::runtime_error with `what` and DDS's own words.
inline dds_entity_t made(dds_entity_t entity, const std::string& what) {
  if (entity < 0) throw std::runtime_error("DDS refuses " + what + ": " + dds_strretcode(-entity));
  return entity;
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// As ROS 2's default: volatile, the last ten. @param latched who comes later gets the last one
inline Qos qos_of(dds_reliability_kind_t reliability, bool latched) {
  constexpr std::int32_t kDepth = 10;
  Qos qos(dds_create_qos(), &dds_delete_qos);
  // A writer never waits: what does not fit is dropped, and counted.
  dds_qset_reliability(qos.get(), reliability, 0);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, latched ? 1 : kDepth);
  dds_qset_durability(qos.get(), latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  return qos;
}

/// Deletes an entity with all that was made of it.
class Entity {
 public:
  explicit Entity(dds_entity_t entity) noexcept : entity_(entity) {}
  ~Entity() { dds_delete(entity_); }
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  [[nodiscard]] dds_entity_t get() const noexcept { return entity_; }

 private:
  dds_entity_t entity_;
};

/// Takes what waits in a reader, in lots, and calls `each(const Message&, const dds_sample_info_t&)` for what is valid.
template <class Message, class Each>
void take_all(dds_entity_t reader, const Each& each) {
  constexpr std::size_t kLot = 16;
  void* samples[kLot] = {};
  dds_sample_info_t infos[kLot];
  for (;;) {
    samples[0] = nullptr;  // lent by the reader
    const dds_return_t count = dds_take(reader, samples, infos, kLot, kLot);
    if (count <= 0) return;
    for (dds_return_t i = 0; i < count; ++i) {
      if (infos[i].valid_data) each(*static_cast<const Message*>(samples[i]), infos[i]);
    }
    dds_return_loan(reader, samples, count);
    if (static_cast<std::size_t>(count) < kLot) return;
  }
}

}  // namespace forcebound::ros2
