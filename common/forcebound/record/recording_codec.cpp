#include "forcebound/record/internal/recording_codec.hpp"

#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "forcebound/v1/record.pb.h"
#include "forcebound/wire/internal/proto_conversion.hpp"
#include "foxglove/scene.pb.h"

namespace forcebound::record {
namespace {

using Repeated = google::protobuf::RepeatedField<double>;

void put(const control::Vector& vector, Repeated& out) { out.Add(vector.data(), vector.data() + vector.size()); }

control::Vector vector_from(const Repeated& in, const char* name) {
  constexpr int kRowsMax = control::kDofMax;
  if (in.size() > kRowsMax) {
    throw std::invalid_argument(std::string(name) + " must have at most " + std::to_string(kRowsMax) + " rows, got " +
                                std::to_string(in.size()));
  }
  control::Vector vector(in.size());
  for (int row = 0; row < in.size(); ++row) vector[row] = in[row];
  return vector;
}

// Differences of accepted times fit 64 bits, whatever the file says.
Nanoseconds time_from(std::int64_t ns, const char* name) {
  constexpr std::int64_t kMost = wire::kTimeMost.count();
  if (ns > kMost || ns < -kMost) {
    throw std::invalid_argument(std::string(name) + " must be within 2^61, got " + std::to_string(ns));
  }
  return Nanoseconds{ns};
}

template <class Enum>
Enum enum_from(int value, Enum last, const char* name) {
  if (value < 0 || value > static_cast<int>(last)) {
    throw std::invalid_argument(std::string(name) + " must be 0 to " + std::to_string(static_cast<int>(last)) +
                                ", got " + std::to_string(value));
  }
  return static_cast<Enum>(value);
}

control::Handle handle_from(const v1::TickRecord& in) {
  control::Handle handle;
  if (in.has_buttons()) handle.buttons = in.buttons();
  if (in.has_gripper()) handle.gripper = in.gripper();
  if (in.orientation().empty()) return handle;
  auto& orientation = handle.orientation.emplace();
  if (in.orientation_size() != static_cast<int>(orientation.size())) {
    throw std::invalid_argument("orientation must have 4 numbers or none, got " +
                                std::to_string(in.orientation_size()));
  }
  std::ranges::copy(in.orientation(), orientation.begin());
  return handle;
}

template <class Proto, class Value>
void read_into(const Proto& in, Value& value) {
  const auto refuse = [](const wire::Flaws::Flaw& flaw, const std::string& accepted) {
    throw std::invalid_argument(std::string(flaw.field) + " must " + accepted + ", got " + std::to_string(flaw.got));
  };
  value = {};
  const wire::Flaws flaws = wire::read(in, value);
  if (flaws.time.field != nullptr) refuse(flaws.time, "be within 2^61");
  if (flaws.rows.field != nullptr) refuse(flaws.rows, "have at most " + std::to_string(flaws.rows.most) + " rows");
}

template <class Message>
Message parse(std::string_view bytes) {
  Message message;
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw std::invalid_argument("not a " + Message::descriptor()->full_name());
  }
  return message;
}

void add_file(const google::protobuf::FileDescriptor& file, std::set<std::string>& added,
              google::protobuf::FileDescriptorSet& set) {
  if (!added.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), added, set);
  file.CopyTo(set.add_file());
}

}  // namespace

std::string schema_of(std::string_view message_name) {
  // Makes the linker keep the files that declare our messages.
  v1::TickRecord::descriptor();
  foxglove::SceneUpdate::descriptor();
  const auto* message =
      google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(std::string(message_name));
  google::protobuf::FileDescriptorSet set;
  std::set<std::string> added;
  add_file(*message->file(), added, set);
  return set.SerializeAsString();
}

std::string encode(const TickRecord& tick) {
  v1::TickRecord out;
  out.set_tick(tick.tick);
  out.set_time_ns(tick.time.count());
  out.set_interval_ns(tick.interval.count());
  out.set_latency_ns(tick.latency.count());
  out.set_state(static_cast<v1::TickRecord::State>(tick.state));
  out.set_policy(static_cast<v1::TickRecord::Policy>(tick.policy));
  out.set_motion_sequence(tick.motion_sequence);
  out.set_force_sequence(tick.force_sequence);
  out.set_force_age_ns(tick.force_age.count());
  put(tick.position, *out.mutable_position_m());
  put(tick.joint, *out.mutable_joint());
  put(tick.request, *out.mutable_request_n());
  put(tick.applied, *out.mutable_applied_n());
  put(tick.request_torque_N_m, *out.mutable_request_torque_n_m());
  put(tick.applied_torque_N_m, *out.mutable_applied_torque_n_m());
  out.set_penetration_m(tick.penetration_m);
  out.set_displayed_n(tick.displayed_N);
  out.set_contact(tick.contact);
  out.set_energy_j(tick.energy_J);
  out.set_xi(tick.xi);
  out.set_audit_j(tick.audit_J);
  out.set_audit_minimum_j(tick.audit_minimum_J);
  out.set_rendering(static_cast<v1::TickRecord::Rendering>(tick.rendering));
  put(tick.remote, *out.mutable_remote_n());
  put(tick.local, *out.mutable_local_n());
  out.set_local_scene(tick.local_scene);
  out.set_local_scene_age_ns(tick.local_scene_age.count());
  put(tick.model, *out.mutable_model_n());
  out.set_model_deviation_m(tick.model_deviation_m);
  if (tick.model_trust) out.set_model_trust(*tick.model_trust);
  if (tick.handle.buttons) out.set_buttons(*tick.handle.buttons);
  if (tick.handle.gripper) out.set_gripper(*tick.handle.gripper);
  if (tick.handle.orientation)
    out.mutable_orientation()->Add(tick.handle.orientation->begin(), tick.handle.orientation->end());
  return out.SerializeAsString();
}

void decode(std::string_view bytes, TickRecord& tick) {
  const auto in = parse<v1::TickRecord>(bytes);
  tick.tick = in.tick();
  tick.time = time_from(in.time_ns(), "time_ns");
  tick.interval = time_from(in.interval_ns(), "interval_ns");
  tick.latency = time_from(in.latency_ns(), "latency_ns");
  tick.state = enum_from(in.state(), SessionState::reconnecting, "state");
  tick.policy = enum_from(in.policy(), ForcePolicy::dropped, "policy");
  tick.motion_sequence = in.motion_sequence();
  tick.force_sequence = in.force_sequence();
  tick.force_age = time_from(in.force_age_ns(), "force_age_ns");
  tick.position = vector_from(in.position_m(), "position_m");
  tick.joint = vector_from(in.joint(), "joint");
  tick.request = vector_from(in.request_n(), "request_N");
  tick.applied = vector_from(in.applied_n(), "applied_N");
  tick.request_torque_N_m = vector_from(in.request_torque_n_m(), "request_torque_N_m");
  tick.applied_torque_N_m = vector_from(in.applied_torque_n_m(), "applied_torque_N_m");
  tick.penetration_m = in.penetration_m();
  tick.displayed_N = in.displayed_n();
  tick.contact = in.contact();
  tick.energy_J = in.energy_j();
  tick.xi = in.xi();
  tick.audit_J = in.audit_j();
  tick.audit_minimum_J = in.audit_minimum_j();
  tick.rendering = enum_from(in.rendering(), ForceOrigin::both, "rendering");
  tick.remote = vector_from(in.remote_n(), "remote_N");
  tick.local = vector_from(in.local_n(), "local_N");
  tick.local_scene = in.local_scene();
  tick.local_scene_age = time_from(in.local_scene_age_ns(), "local_scene_age_ns");
  tick.model = vector_from(in.model_n(), "model_N");
  tick.model_deviation_m = in.model_deviation_m();
  tick.model_trust.reset();
  if (in.has_model_trust()) tick.model_trust = in.model_trust();
  tick.handle = handle_from(in);
}

std::string encode(const ForceRecord& force) {
  v1::ForceRecord out;
  out.set_receive_time_ns(force.receive_time.count());
  out.set_round_trip_ns(force.round_trip.count());
  wire::fill(force.force, *out.mutable_force());
  return out.SerializeAsString();
}

std::string encode(const SentForceRecord& force) {
  v1::ForceRecord out;
  wire::fill(force.force, *out.mutable_force());
  return out.SerializeAsString();
}

bool decode(std::string_view bytes, ForceRecord& force) {
  const auto in = parse<v1::ForceRecord>(bytes);
  force.receive_time = time_from(in.receive_time_ns(), "receive_time_ns");
  force.round_trip = time_from(in.round_trip_ns(), "round_trip_ns");
  read_into(in.force(), force.force);
  return in.has_receive_time_ns();
}

std::string encode(const wire::MotionSample& motion) {
  v1::MotionSample out;
  wire::fill(motion, out);
  return out.SerializeAsString();
}

void decode(std::string_view bytes, wire::MotionSample& motion) { read_into(parse<v1::MotionSample>(bytes), motion); }

void decode(std::string_view bytes, wire::EnvironmentForce& force) {
  read_into(parse<v1::EnvironmentForce>(bytes), force);
}

}  // namespace forcebound::record
