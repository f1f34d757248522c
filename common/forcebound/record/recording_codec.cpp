#include "forcebound/record/recording_codec.hpp"

#include <google/protobuf/descriptor.pb.h>

#include <set>
#include <stdexcept>

#include "forcebound/v1/record.pb.h"

namespace forcebound::record {
namespace {

using Repeated = google::protobuf::RepeatedField<double>;

template <class Rows>
void put(const Rows& vector, Repeated& out) {
  out.Add(vector.data(), vector.data() + vector.size());
}

template <class Rows = control::Vector>
Rows vector_from(const Repeated& in, const char* name) {
  constexpr int kRowsMax = Rows::MaxRowsAtCompileTime;
  if (in.size() > kRowsMax) {
    throw std::invalid_argument(std::string(name) + " must have at most " + std::to_string(kRowsMax) + " rows, got " +
                                std::to_string(in.size()));
  }
  Rows vector(in.size());
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

void put(const wire::EnvironmentForce& force, v1::EnvironmentForce& out) {
  out.set_session(force.session);
  out.set_sequence(force.sequence);
  out.set_motion_sequence(force.motion_sequence);
  out.set_motion_device_time_ns(force.motion_device_time.count());
  put(force.force, *out.mutable_force_n());
  put(force.position, *out.mutable_position_m());
  put(force.contact_normal, *out.mutable_contact_normal());
  out.set_penetration_m(force.penetration_m);
  out.set_server_receive_time_ns(force.server_receive_time.count());
  out.set_server_send_time_ns(force.server_send_time.count());
  out.set_compute_time_ns(force.compute_time.count());
  out.set_motions_received(force.motions_received);
  out.set_motions_duplicated(force.motions_duplicated);
  out.set_motions_reordered(force.motions_reordered);
  out.set_texture_n(force.texture_N);
  put(force.texture_wave, *out.mutable_texture_wave_rad_per_m());
  put(force.texture_across, *out.mutable_texture_across_rad_per_m());
  put(force.port, *out.mutable_port());
}

void take(const v1::EnvironmentForce& in, wire::EnvironmentForce& force) {
  force.session = in.session();
  force.sequence = in.sequence();
  force.motion_sequence = in.motion_sequence();
  force.motion_device_time = time_from(in.motion_device_time_ns(), "motion_device_time_ns");
  force.force = vector_from(in.force_n(), "force_N");
  force.position = vector_from(in.position_m(), "position_m");
  force.contact_normal = vector_from(in.contact_normal(), "contact_normal");
  force.penetration_m = in.penetration_m();
  force.server_receive_time = time_from(in.server_receive_time_ns(), "server_receive_time_ns");
  force.server_send_time = time_from(in.server_send_time_ns(), "server_send_time_ns");
  force.compute_time = time_from(in.compute_time_ns(), "compute_time_ns");
  force.motions_received = in.motions_received();
  force.motions_duplicated = in.motions_duplicated();
  force.motions_reordered = in.motions_reordered();
  force.texture_N = in.texture_n();
  force.texture_wave = vector_from(in.texture_wave_rad_per_m(), "texture_wave_rad_per_m");
  force.texture_across = vector_from(in.texture_across_rad_per_m(), "texture_across_rad_per_m");
  force.port = vector_from<control::PortNumbers>(in.port(), "port");
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
  v1::TickRecord::descriptor();  // makes the linker keep the file that declares our messages
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
  out.set_penetration_m(tick.penetration_m);
  out.set_displayed_n(tick.displayed_N);
  out.set_contact(tick.contact);
  out.set_energy_j(tick.energy_J);
  out.set_xi(tick.xi);
  out.set_audit_j(tick.audit_J);
  out.set_audit_minimum_j(tick.audit_minimum_J);
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
  tick.penetration_m = in.penetration_m();
  tick.displayed_N = in.displayed_n();
  tick.contact = in.has_contact() ? in.contact() : in.penetration_m() > 0;
  tick.energy_J = in.energy_j();
  tick.xi = in.xi();
  tick.audit_J = in.audit_j();
  tick.audit_minimum_J = in.audit_minimum_j();
}

std::string encode(const ForceRecord& force) {
  v1::ForceRecord out;
  out.set_receive_time_ns(force.receive_time.count());
  out.set_round_trip_ns(force.round_trip.count());
  put(force.force, *out.mutable_force());
  return out.SerializeAsString();
}

void decode(std::string_view bytes, ForceRecord& force) {
  const auto in = parse<v1::ForceRecord>(bytes);
  force.receive_time = time_from(in.receive_time_ns(), "receive_time_ns");
  force.round_trip = time_from(in.round_trip_ns(), "round_trip_ns");
  take(in.force(), force.force);
}

std::string encode(const wire::MotionSample& motion) {
  v1::MotionSample out;
  out.set_session(motion.session);
  out.set_sequence(motion.sequence);
  out.set_device_time_ns(motion.device_time.count());
  put(motion.position, *out.mutable_position_m());
  put(motion.port, *out.mutable_port());
  return out.SerializeAsString();
}

void decode(std::string_view bytes, wire::MotionSample& motion) {
  const auto in = parse<v1::MotionSample>(bytes);
  motion.session = in.session();
  motion.sequence = in.sequence();
  motion.device_time = time_from(in.device_time_ns(), "device_time_ns");
  motion.position = vector_from(in.position_m(), "position_m");
  motion.port = vector_from<control::PortNumbers>(in.port(), "port");
}

std::string encode(const wire::EnvironmentForce& force) {
  v1::EnvironmentForce out;
  put(force, out);
  return out.SerializeAsString();
}

void decode(std::string_view bytes, wire::EnvironmentForce& force) { take(parse<v1::EnvironmentForce>(bytes), force); }

}  // namespace forcebound::record
