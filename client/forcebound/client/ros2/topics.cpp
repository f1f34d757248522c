#include "forcebound/client/ros2/topics.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "forcebound/client/ros2/dds_entities.hpp"
#include "forcebound/client/ros2/peer_watch.hpp"
#include "forcebound/client/ros2/topic_names.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "messages.h"

namespace forcebound::ros2 {
namespace {

// Participants find each other without multicast, which the loopback does not have, at the ports of the first of them.
constexpr const char* kLoopback =
    "<CycloneDDS><Domain id=\"any\"><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>"
    "</Domain></CycloneDDS>";

enum class Out : std::size_t { pose, twist, wrench, joints, joy, state };
constexpr std::size_t kOuts = 6;
struct OutRow {
  const char* name;
  const dds_topic_descriptor_t* type;
};
const std::array<OutRow, kOuts> kRows{{{"measured_cp", &geometry_msgs_msg_dds__PoseStamped__desc},
                                       {"measured_cv", &geometry_msgs_msg_dds__TwistStamped__desc},
                                       {"measured_cf", &geometry_msgs_msg_dds__WrenchStamped__desc},
                                       {"measured_js", &sensor_msgs_msg_dds__JointState__desc},
                                       {"joy", &sensor_msgs_msg_dds__Joy__desc},
                                       {"operating_state", &crtk_msgs_msg_dds__OperatingState__desc}}};
constexpr const char* kIn = "servo_cf";

template <class Xyz>
Xyz xyz_of(const Vector& vector) noexcept {
  const auto row = [&](Eigen::Index i) { return i < vector.rows() ? vector[i] : 0.0; };
  return {.x = row(0), .y = row(1), .z = row(2)};
}

Eigen::Vector3d vector_of(const geometry_msgs_msg_dds__Vector3_& xyz) noexcept { return {xyz.x, xyz.y, xyz.z}; }

const char* name_of(OperatingState state) noexcept {
  switch (state) {
    case OperatingState::disabled:
      return "DISABLED";
    case OperatingState::enabled:
      return "ENABLED";
    case OperatingState::fault:
      return "FAULT";
  }
  return "FAULT";
}

/// A sequence of DDS that only refers to numbers.
template <class Sequence, class Numbers>
Sequence sequence_of(Numbers& numbers, std::size_t count) noexcept {
  const auto length = static_cast<std::uint32_t>(count);
  return {._maximum = length, ._length = length, ._buffer = numbers.data(), ._release = false};
}

/// The domain and in it the participant; DDS deletes the rest with the first.
dds_entity_t open_domain(const Topics::Settings& settings) {
  if (settings.beyond_this_machine) return 0;
  return made(dds_create_domain(settings.domain, kLoopback), "domain " + std::to_string(settings.domain));
}

}  // namespace

struct Topics::Parts {
  Parts(const Settings& chosen, WrenchInbox& its_inbox)
      : settings(chosen),
        inbox(its_inbox),
        domain(open_domain(settings)),
        participant(made(dds_create_participant(settings.domain, nullptr, nullptr),
                         "a participant in domain " + std::to_string(settings.domain))),
        watch(participant.get(), clock.now()) {
    for (std::size_t i = 0; i < kOuts; ++i) {
      const Qos qos = qos_of(DDS_RELIABILITY_RELIABLE, static_cast<Out>(i) == Out::state);
      const std::string name = dds_topic(settings.name_space, kRows[i].name);
      const dds_topic_descriptor_t& type = *kRows[i].type;
      writers[i] = made(dds_create_writer(participant.get(), topic(name, type), qos.get(), nullptr), name);
      watch.add({.topic = name, .type = type.m_typename, .entity = writers[i], .direction = Direction::out});
    }
    const std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)> listener(dds_create_listener(this),
                                                                                   &dds_delete_listener);
    dds_lset_data_available(listener.get(),
                            [](dds_entity_t reader, void* parts) { static_cast<Parts*>(parts)->receive(reader); });
    const Qos qos = qos_of(DDS_RELIABILITY_BEST_EFFORT, false);
    const std::string name = dds_topic(settings.name_space, kIn);
    const dds_topic_descriptor_t& type = geometry_msgs_msg_dds__WrenchStamped__desc;
    const dds_entity_t reader =
        made(dds_create_reader(participant.get(), topic(name, type), qos.get(), listener.get()), name);
    watch.add({.topic = name, .type = type.m_typename, .entity = reader, .direction = Direction::in});
  }

  [[nodiscard]] dds_entity_t topic(const std::string& name, const dds_topic_descriptor_t& type) const {
    return made(dds_create_topic(participant.get(), &type, name.c_str(), nullptr, nullptr), "topic " + name);
  }

  /// On a thread of DDS, one call at a time, and for each message that arrives, so that none hides another's.
  void receive(dds_entity_t reader) noexcept {
    take_all<geometry_msgs_msg_dds__WrenchStamped_>(reader, [this](const auto& message, const dds_sample_info_t& info) {
      const char* const frame = message.header.frame_id;
      inbox.receive({.publisher = info.publication_handle,
                     .frame = frame == nullptr ? "" : frame,
                     .wrench = {.force_N = vector_of(message.wrench.force),
                                .torque_N_m = vector_of(message.wrench.torque),
                                .arrival = clock.now()}});
    });
  }

  [[nodiscard]] std_msgs_msg_dds__Header_ header_at(Nanoseconds reading) noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    const std::int64_t stamp = (time::wall_clock_now() - (clock.now() - reading)).count();
    return {.stamp = {.sec = static_cast<std::int32_t>(stamp / kSecond),
                      .nanosec = static_cast<std::uint32_t>(stamp % kSecond)},
            .frame_id = settings.frame.data()};
  }

  template <class Message>
  void write(Out topic, const Message& message) noexcept {
    if (dds_write(writers[static_cast<std::size_t>(topic)], &message) != DDS_RETCODE_OK)
      not_written.fetch_add(1, std::memory_order_relaxed);
  }

  void write_joints(const std_msgs_msg_dds__Header_& header, const Vector& joint) noexcept {
    static std::array<const char*, control::kJointsMax> names{"joint_1", "joint_2", "joint_3", "joint_4",
                                                              "joint_5", "joint_6", "joint_7"};
    const auto count = static_cast<std::size_t>(joint.rows());
    std::array<double, control::kJointsMax> position{};
    std::copy_n(joint.data(), count, position.begin());
    sensor_msgs_msg_dds__JointState_ message{};
    message.header = header;
    message.name = {._maximum = static_cast<std::uint32_t>(count),
                    ._length = static_cast<std::uint32_t>(count),
                    ._buffer = const_cast<char**>(names.data()),
                    ._release = false};
    message.position = sequence_of<dds_sequence_double>(position, count);
    write(Out::joints, message);
  }

  void write_joy(const std_msgs_msg_dds__Header_& header, const control::Handle& handle) noexcept {
    std::array<float, 1> axes{static_cast<float>(handle.gripper.value_or(0))};
    std::array<std::int32_t, control::Handle::kButtons> buttons{};
    for (int i = 0; i < control::Handle::kButtons; ++i)
      buttons[static_cast<std::size_t>(i)] = handle.pressed(i) ? 1 : 0;
    sensor_msgs_msg_dds__Joy_ message{};
    message.header = header;
    message.axes = sequence_of<dds_sequence_float>(axes, handle.gripper ? 1 : 0);
    message.buttons = sequence_of<dds_sequence_long>(buttons, handle.buttons ? buttons.size() : 0);
    write(Out::joy, message);
  }

  Settings settings;
  WrenchInbox& inbox;
  time::SteadyClock clock{};
  Entity domain;
  Entity participant;
  PeerWatch watch;
  std::array<dds_entity_t, kOuts> writers{};
  std::optional<std::pair<OperatingState, bool>> published{};
  std::atomic<std::uint64_t> not_written{0};
};

Topics::Topics(const Settings& settings, WrenchInbox& inbox) : parts_(std::make_unique<Parts>(settings, inbox)) {}
Topics::~Topics() = default;

void Topics::publish(const StateSample& sample, const std::optional<Velocity>& velocity) {
  Parts& p = *parts_;
  const std_msgs_msg_dds__Header_ header = p.header_at(sample.time);
  if (sample.position.rows() > 0 && sample.position.allFinite()) {
    const auto [w, x, y, z] = sample.handle.orientation.value_or(control::Handle::Orientation{1, 0, 0, 0});
    p.write(Out::pose, geometry_msgs_msg_dds__PoseStamped_{
                           .header = header,
                           .pose = {.position = xyz_of<geometry_msgs_msg_dds__Point_>(sample.position),
                                    .orientation = {.x = x, .y = y, .z = z, .w = w}}});
    if (sample.joint.rows() > 0) p.write_joints(header, sample.joint);
  }
  if (velocity) {
    p.write(Out::twist,
            geometry_msgs_msg_dds__TwistStamped_{
                .header = header,
                .twist = {.linear = xyz_of<geometry_msgs_msg_dds__Vector3_>(velocity->linear_m_per_s),
                          .angular = xyz_of<geometry_msgs_msg_dds__Vector3_>(velocity->angular_rad_per_s)}});
  }
  p.write(Out::wrench, geometry_msgs_msg_dds__WrenchStamped_{
                           .header = header,
                           .wrench = {.force = xyz_of<geometry_msgs_msg_dds__Vector3_>(sample.force_N),
                                      .torque = xyz_of<geometry_msgs_msg_dds__Vector3_>(sample.torque_N_m)}});
  if (sample.handle.buttons || sample.handle.gripper) p.write_joy(header, sample.handle);
}

void Topics::publish(OperatingState state, bool is_busy) {
  Parts& p = *parts_;
  const std::pair now{state, is_busy};
  if (std::exchange(p.published, now) == now) return;
  p.write(Out::state, crtk_msgs_msg_dds__OperatingState_{.header = p.header_at(p.clock.now()),
                                                         .state = const_cast<char*>(name_of(state)),
                                                         .is_homed = state == OperatingState::enabled,
                                                         .is_busy = is_busy});
}

std::string Topics::in_words() const {
  const Settings& settings = parts_->settings;
  std::string words = "DDS domain " + std::to_string(settings.domain) +
                      (settings.beyond_this_machine ? " of the network" : " of this machine") + ": publishes ";
  for (const OutRow& row : kRows) words += ros_topic(dds_topic(settings.name_space, row.name)) + ", ";
  return words + "subscribes to " + wrench_topic() + " (" +
         ros_type(geometry_msgs_msg_dds__WrenchStamped__desc.m_typename) + ")";
}

std::string Topics::wrench_topic() const { return ros_topic(dds_topic(parts_->settings.name_space, kIn)); }

std::vector<News> Topics::take_news() { return parts_->watch.take_news(parts_->clock.now()); }

const PeerWatch::Publishers& Topics::publishers() const noexcept { return parts_->watch.publishers(); }

std::uint64_t Topics::not_written() const noexcept { return parts_->not_written.load(std::memory_order_relaxed); }

}  // namespace forcebound::ros2
