#include <dds/dds.h>

#include <stdexcept>
#include <utility>

#include "messages.h"
#include "tests/support/ros2/bus.hpp"

namespace forcebound::ros2_peer {
namespace {

constexpr const char* kLoopback =
    "<CycloneDDS><Domain id=\"any\"><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";

dds_entity_t made(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("Cyclone DDS: ") + dds_strretcode(-entity));
  return entity;
}

Header header_of(const std_msgs_msg_dds__Header_& header) {
  return {.sec = header.stamp.sec, .nanosec = header.stamp.nanosec, .frame = header.frame_id};
}

/// Only poses, wrenches and states: what a measurement needs.
class CycloneBus final : public Bus {
 public:
  CycloneBus(const Settings& settings, Ears ears)
      : settings_(settings),
        ears_(std::move(ears)),
        domain_(made(dds_create_domain(settings.domain, kLoopback))),
        participant_(made(dds_create_participant(settings.domain, nullptr, nullptr))) {
    subscribe<geometry_msgs_msg_dds__PoseStamped_>(
        "measured_cp", geometry_msgs_msg_dds__PoseStamped__desc,
        [](const CycloneBus& bus, const geometry_msgs_msg_dds__PoseStamped_& message) {
          const auto& [position, turned] = message.pose;
          bus.ears_.pose({.header = header_of(message.header),
                          .values = {position.x, position.y, position.z, turned.x, turned.y, turned.z, turned.w}});
        });
    subscribe<geometry_msgs_msg_dds__WrenchStamped_>(
        "measured_cf", geometry_msgs_msg_dds__WrenchStamped__desc,
        [](const CycloneBus& bus, const geometry_msgs_msg_dds__WrenchStamped_& message) {
          const auto& [force, torque] = message.wrench;
          bus.ears_.wrench({.header = header_of(message.header),
                            .values = {force.x, force.y, force.z, torque.x, torque.y, torque.z}});
        });
    subscribe<crtk_msgs_msg_dds__OperatingState_>(
        "operating_state", crtk_msgs_msg_dds__OperatingState__desc,
        [](const CycloneBus& bus, const crtk_msgs_msg_dds__OperatingState_& message) {
          bus.ears_.state({.header = header_of(message.header), .state = message.state});
        },
        true);
    dds_topic_descriptor_t type = geometry_msgs_msg_dds__WrenchStamped__desc;
    type.m_typename = settings_.type.c_str();
    dds_qos_t* const qos = qos_of(false);
    writer_ = made(dds_create_writer(participant_, topic("servo_cf", type), qos, nullptr));
    dds_delete_qos(qos);
  }

  ~CycloneBus() override { dds_delete(domain_); }

  void publish(const Wrench& wrench) override {
    const auto& v = wrench.values;
    const geometry_msgs_msg_dds__WrenchStamped_ message{
        .header = {.stamp = {.sec = wrench.header.sec, .nanosec = wrench.header.nanosec},
                   .frame_id = const_cast<char*>(wrench.header.frame.c_str())},
        .wrench = {.force = {.x = v[0], .y = v[1], .z = v[2]}, .torque = {.x = v[3], .y = v[4], .z = v[5]}}};
    dds_write(writer_, &message);
  }

  [[nodiscard]] bool matched() const override {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_, &status);
    return status.current_count > 0;
  }

 private:
  [[nodiscard]] dds_qos_t* qos_of(bool latched) const {
    constexpr std::int32_t kDepth = 10;
    dds_qos_t* const qos = dds_create_qos();
    const bool best_effort = settings_.best_effort && !latched;
    dds_qset_reliability(qos, best_effort ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kDepth);
    dds_qset_durability(qos, latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    return qos;
  }

  [[nodiscard]] dds_entity_t topic(const std::string& name, const dds_topic_descriptor_t& type) const {
    return made(
        dds_create_topic(participant_, &type, ("rt" + settings_.name_space + "/" + name).c_str(), nullptr, nullptr));
  }

  template <class Message, class Hear>
  void subscribe(const char* name, const dds_topic_descriptor_t& type, Hear /*hear*/, bool latched = false) {
    dds_listener_t* const listener = dds_create_listener(this);
    dds_lset_data_available(listener, [](dds_entity_t reader, void* bus) {
      void* sample = nullptr;
      dds_sample_info_t info;
      while (dds_take(reader, &sample, &info, 1, 1) == 1) {
        if (info.valid_data) Hear{}(*static_cast<const CycloneBus*>(bus), *static_cast<const Message*>(sample));
        dds_return_loan(reader, &sample, 1);
        sample = nullptr;
      }
    });
    dds_qos_t* const qos = qos_of(latched);
    made(dds_create_reader(participant_, topic(name, type), qos, listener));
    dds_delete_qos(qos);
    dds_delete_listener(listener);
  }

  Settings settings_;
  Ears ears_;
  dds_entity_t domain_;
  dds_entity_t participant_;
  dds_entity_t writer_ = 0;
};

}  // namespace

std::unique_ptr<Bus> cyclone_bus(const Settings& settings, Ears ears) {
  return std::make_unique<CycloneBus>(settings, std::move(ears));
}

}  // namespace forcebound::ros2_peer
