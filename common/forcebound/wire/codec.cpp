#include "forcebound/wire/codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "forcebound/control/assertion.hpp"
#include "forcebound/wire/internal/bodies.hpp"
#include "forcebound/wire/internal/frame.hpp"
#include "forcebound/wire/internal/known_fields.hpp"
#include "forcebound/wire/internal/proto_conversion.hpp"

namespace forcebound::wire {
namespace {

// Tag and two bytes of length: the padding of a Hello is always longer than 127 bytes.
constexpr std::size_t kPaddingOverhead = 3;

/// Silences Protocol Buffers, which writes to stderr about our own text that is not UTF-8; the other end refuses it.
/// Only the kinds with text need this, and it locks.
class QuietProtobuf {
 public:
  explicit QuietProtobuf(std::size_t kind) {
    constexpr std::size_t kKindsWithText = 3;  // Hello, Welcome, Refusal
    if (kind <= kKindsWithText) silencer_.emplace();
  }

 private:
  std::optional<google::protobuf::LogSilencer> silencer_;
};

/// At most `bytes` of the text, not ending within a character.
std::string_view cut(std::string_view text, std::size_t bytes) noexcept {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) --bytes;
  return text.substr(0, bytes);
}

std::string_view cut_name(std::string_view text) noexcept { return cut(text, kNameBytesMax); }
std::string_view cut_text(std::string_view text) noexcept { return cut(text, kTextBytesMax); }

// Tags of a fixed64.
constexpr std::byte kNumberInField1{0x09};
constexpr std::byte kNumberInField2{0x11};

}  // namespace

struct Codec::Storage : Bodies {
  void fill(const Hello& from) noexcept;
  void fill(const Welcome& from) noexcept;
  void fill(const Refusal& from) noexcept;
  void fill(const MotionSample& from) noexcept { wire::fill(from, motion); }
  void fill(const EnvironmentForce& from) noexcept { wire::fill(from, force); }
  void fill(const Bye& from) noexcept;
  void fill(const ScenePiece& from) noexcept;
  void fill(const ViewPiece& from) noexcept;

  template <class Proto>
  std::span<const std::byte> frame(std::size_t kind, Proto& body) noexcept;

  template <class Proto>
  std::variant<Message, Malformed> read(Proto& proto, std::span<const std::byte> datagram) noexcept;

  KnownFields known;
  std::array<std::byte, kFrameBytesMax> datagram{};
};

void Codec::Storage::fill(const Hello& from) noexcept {
  hello.Clear();
  hello.set_protocol_version(from.protocol_version);
  hello.set_client_nonce(from.client_nonce);
  hello.set_degrees_of_freedom(from.degrees_of_freedom);
  hello.mutable_device()->assign(cut_name(from.device));
  hello.set_period_s(from.period_s);
  hello.set_force_n_max(from.force_N_max);
  hello.mutable_scene()->assign(cut_name(from.scene));
  hello.set_client_time_ns(from.client_time.count());
  hello.set_round_trip_ns(from.round_trip.count());
  hello.mutable_server_law()->assign(cut_name(from.server_law));
  hello.set_renders_locally(from.renders_locally);
  hello.set_shows_scene(from.shows_scene);
  hello.set_shows_torque(from.shows_torque);
  hello.mutable_padding()->assign(kFrameBytesMax - kHeaderBytes - kPaddingOverhead - hello.ByteSizeLong(), '\0');
}

void Codec::Storage::fill(const Welcome& from) noexcept {
  welcome.Clear();
  welcome.set_client_nonce(from.client_nonce);
  welcome.set_session(from.session);
  welcome.set_scene_hash(from.scene_hash);
  welcome.mutable_scene()->assign(cut_name(from.scene));
  welcome.mutable_simulated()->assign(cut_text(from.simulated));
  welcome.set_server_parts(static_cast<v1::Welcome::ServerParts>(from.server_parts));
  welcome.set_takes_energy(from.takes_energy);
  for (Eigen::Index i = 0; i < from.tool_m.rows(); ++i) welcome.add_tool_m(from.tool_m[i]);
  if (from.offer.manifest_bytes == 0) return;
  const auto& hash = from.offer.manifest_sha256;
  welcome.mutable_manifest_sha256()->assign(reinterpret_cast<const char*>(hash.data()), hash.size());
  welcome.set_manifest_bytes(from.offer.manifest_bytes);
  welcome.set_pieces(from.offer.pieces);
}

void Codec::Storage::fill(const Refusal& from) noexcept {
  refusal.Clear();
  refusal.set_client_nonce(from.client_nonce);
  refusal.set_session(from.session);
  refusal.set_reason(static_cast<v1::Refusal::Reason>(from.reason));
  refusal.mutable_text()->assign(cut_text(from.text));
  refusal.set_client_time_ns(from.client_time.count());
  refusal.set_protocol_version(from.protocol_version);
}

void Codec::Storage::fill(const Bye& from) noexcept {
  bye.Clear();
  bye.set_session(from.session);
  bye.set_motions_received(from.motions_received);
  bye.set_motions_duplicated(from.motions_duplicated);
  bye.set_motions_reordered(from.motions_reordered);
  bye.set_forces_sent(from.forces_sent);
  bye.set_motions_behind(from.motions_behind);
}

void Codec::Storage::fill(const ScenePiece& from) noexcept {
  piece.Clear();
  piece.set_session(from.session);
  piece.set_transmission(from.transmission);
  piece.set_number(from.number);
  piece.mutable_content()->assign(reinterpret_cast<const char*>(from.content.data()), from.content.size());
}

void Codec::Storage::fill(const ViewPiece& from) noexcept {
  view.Clear();
  view.set_session(from.session);
  view.set_view(from.view);
  view.set_pieces(from.pieces);
  view.set_number(from.number);
  view.set_first(from.first);
  view.mutable_content()->assign(reinterpret_cast<const char*>(from.content.data()), from.content.size());
}

namespace {

using Decoded = std::variant<Message, Malformed>;

bool plausible(Nanoseconds time) noexcept { return time >= -kTimeMost && time <= kTimeMost; }

Decoded to_value(const v1::Hello& from, std::size_t datagram_bytes) noexcept {
  const Nanoseconds time{from.client_time_ns()};
  const Nanoseconds round_trip{from.round_trip_ns()};
  if (datagram_bytes != kFrameBytesMax || !plausible(time) || !plausible(round_trip)) return Malformed::unreadable;
  if (!std::isfinite(from.period_s()) || !std::isfinite(from.force_n_max())) return Malformed::non_finite;
  return Message{Hello{.protocol_version = from.protocol_version(),
                       .client_nonce = from.client_nonce(),
                       .degrees_of_freedom = from.degrees_of_freedom(),
                       .device = cut_name(from.device()),
                       .period_s = from.period_s(),
                       .force_N_max = from.force_n_max(),
                       .scene = cut_name(from.scene()),
                       .client_time = time,
                       .round_trip = round_trip,
                       .server_law = cut_name(from.server_law()),
                       .renders_locally = from.renders_locally(),
                       .shows_scene = from.shows_scene(),
                       .shows_torque = from.shows_torque()}};
}

Decoded to_value(const v1::Welcome& from, std::size_t) noexcept {
  SceneOffer offer{.manifest_bytes = from.manifest_bytes(), .pieces = from.pieces()};
  if (offer.manifest_bytes > 0 && from.manifest_sha256().size() != offer.manifest_sha256.size())
    return Malformed::unreadable;
  // Three numbers, or the tool is none.
  control::Vector tool_m;
  constexpr int kSpace = 3;
  if (from.tool_m_size() == kSpace) tool_m = Eigen::Map<const Eigen::Vector3d>(from.tool_m().data());
  if (!tool_m.allFinite()) return Malformed::non_finite;
  // As in scenes: what a hand holds is no longer.
  constexpr double kToolLongest_m = 0.5;
  if (tool_m.rows() > 0 && tool_m.cwiseAbs().maxCoeff() > kToolLongest_m) return Malformed::unreadable;
  std::memcpy(offer.manifest_sha256.data(), from.manifest_sha256().data(),
              std::min(offer.manifest_sha256.size(), from.manifest_sha256().size()));
  return Message{Welcome{.client_nonce = from.client_nonce(),
                         .session = from.session(),
                         .scene_hash = from.scene_hash(),
                         .scene = cut_name(from.scene()),
                         .simulated = cut_text(from.simulated()),
                         .offer = offer,
                         .server_parts = v1::Welcome::ServerParts_IsValid(from.server_parts())
                                             ? static_cast<ServerParts>(from.server_parts())
                                             : ServerParts::held,
                         .takes_energy = from.takes_energy(),
                         .tool_m = tool_m}};
}

Decoded to_value(const v1::Refusal& from, std::size_t) noexcept {
  const bool known = v1::Refusal::Reason_IsValid(from.reason());
  const Nanoseconds time{from.client_time_ns()};
  if (!plausible(time)) return Malformed::unreadable;
  return Message{Refusal{.client_nonce = from.client_nonce(),
                         .session = from.session(),
                         .reason = known ? static_cast<RefusalReason>(from.reason()) : RefusalReason::unspecified,
                         .text = cut_text(from.text()),
                         .client_time = time,
                         .protocol_version = from.protocol_version()}};
}

template <class Value, class Proto>
Decoded taken(const Proto& from) noexcept {
  Value value;
  const Flaws flaws = read(from, value);
  if (flaws.time.field != nullptr) return Malformed::unreadable;
  if (flaws.rows.field != nullptr || flaws.not_finite) return Malformed::non_finite;
  return Message{value};
}

Decoded to_value(const v1::MotionSample& from, std::size_t) noexcept {
  // Without a position it would be smaller than the Refusal that may answer it: amplification.
  return from.position_m().empty() ? Decoded{Malformed::unreadable} : taken<MotionSample>(from);
}

Decoded to_value(const v1::EnvironmentForce& from, std::size_t) noexcept { return taken<EnvironmentForce>(from); }

Decoded to_value(const v1::Bye& from, std::size_t) noexcept {
  return Message{Bye{.session = from.session(),
                     .motions_received = from.motions_received(),
                     .motions_duplicated = from.motions_duplicated(),
                     .motions_reordered = from.motions_reordered(),
                     .forces_sent = from.forces_sent(),
                     .motions_behind = from.motions_behind()}};
}

Decoded to_value(const v1::ScenePiece& from, std::size_t) noexcept {
  return Message{ScenePiece{.session = from.session(),
                            .transmission = from.transmission(),
                            .number = from.number(),
                            .content = std::as_bytes(std::span(from.content()))}};
}

Decoded to_value(const v1::ViewPiece& from, std::size_t) noexcept {
  return Message{ViewPiece{.session = from.session(),
                           .view = from.view(),
                           .pieces = from.pieces(),
                           .number = from.number(),
                           .first = from.first(),
                           .content = std::as_bytes(std::span(from.content()))}};
}

/// A surface before all others, and a mass, which has the most to tell, at last. False if there is none left.
bool leave_out_a_model(v1::EnvironmentForce& body) noexcept {
  if (body.model_surface_size() > 0) {
    body.mutable_model_surface()->RemoveLast();
  } else if (body.model_field_size() > 0) {
    body.clear_model_field();
  } else if (body.model_mass_size() > 0) {
    body.clear_model_mass();
  } else {
    return false;
  }
  return true;
}

}  // namespace

template <class Proto>
std::span<const std::byte> Codec::Storage::frame(std::size_t kind, Proto& body) noexcept {
  std::size_t bytes = kHeaderBytes + body.ByteSizeLong();
  if constexpr (std::is_same_v<Proto, v1::EnvironmentForce>) {
    // Models that do not fit beside all else are left out, and their forces held.
    while (bytes > kFrameBytesMax && leave_out_a_model(body)) bytes = kHeaderBytes + body.ByteSizeLong();
  }
  FORCEBOUND_ASSERT(bytes <= kFrameBytesMax, "texts are cut, and pieces made, so that their message fits a datagram");
  body.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(datagram.data() + kHeaderBytes));
  const std::span<std::byte> framed{datagram.data(), bytes};
  write_header(framed, kind);
  return framed;
}

template <class Proto>
Decoded Codec::Storage::read(Proto& proto, std::span<const std::byte> bytes) noexcept {
  const auto body = known.of(*Proto::descriptor(), bytes.subspan(kHeaderBytes));
  if (!body || !proto.ParseFromArray(body->data(), static_cast<int>(body->size()))) return Malformed::unreadable;
  return to_value(proto, bytes.size());
}

Codec::Codec() : storage_(std::make_unique<Storage>()) {}
Codec::~Codec() = default;
Codec::Codec(Codec&&) noexcept = default;
Codec& Codec::operator=(Codec&&) noexcept = default;

std::span<const std::byte> Codec::encode(const Message& message) noexcept {
  const QuietProtobuf quiet(message.index() + 1);
  std::visit([this](const auto& value) { storage_->fill(value); }, message);
  switch (const std::size_t kind = message.index() + 1; kind) {
    case 1:
      return storage_->frame(kind, storage_->hello);
    case 2:
      return storage_->frame(kind, storage_->welcome);
    case 3:
      return storage_->frame(kind, storage_->refusal);
    case 4:
      return storage_->frame(kind, storage_->motion);
    case 5:
      return storage_->frame(kind, storage_->force);
    case 6:
      return storage_->frame(kind, storage_->bye);
    case 7:
      return storage_->frame(kind, storage_->piece);
    default:
      return storage_->frame(kind, storage_->view);
  }
}

std::span<const std::byte> Codec::encode(const EnvironmentForce& force) noexcept {
  storage_->fill(force);
  return storage_->frame(index_in<EnvironmentForce>(static_cast<const Message*>(nullptr)) + 1, storage_->force);
}

std::variant<Heading, Malformed> heading_of(std::span<const std::byte> datagram) noexcept {
  if (const auto flaw = flaw_of_header(datagram)) return *flaw;

  // Kind 0 is none, and becomes the largest number.
  Heading heading{.kind = kind_of(datagram) - 1};
  const auto body = datagram.subspan(kHeaderBytes);
  if (heading.is<Welcome>()) {
    heading.client_nonce = first_number(body, kNumberInField1);
  } else if (heading.is<Refusal>()) {
    heading.client_nonce = first_number(body, kNumberInField1);
    heading.session = first_number(body, kNumberInField2);
  } else if (!heading.is<Hello>()) {
    heading.session = first_number(body, kNumberInField1);
  }
  return heading;
}

std::variant<Message, Malformed> Codec::decode(std::span<const std::byte> datagram) noexcept {
  const auto heading = heading_of(datagram);
  if (const auto* malformed = std::get_if<Malformed>(&heading)) return *malformed;
  return decode(datagram, std::get<Heading>(heading));
}

std::variant<Message, Malformed> Codec::decode(std::span<const std::byte> datagram, const Heading& heading) noexcept {
  switch (heading.kind + 1) {
    case 1:
      return storage_->read(storage_->hello, datagram);
    case 2:
      return storage_->read(storage_->welcome, datagram);
    case 3:
      return storage_->read(storage_->refusal, datagram);
    case 4:
      return storage_->read(storage_->motion, datagram);
    case 5:
      return storage_->read(storage_->force, datagram);
    case 6:
      return storage_->read(storage_->bye, datagram);
    case 7:
      return storage_->read(storage_->piece, datagram);
    case 8:
      return storage_->read(storage_->view, datagram);
    default:
      return Malformed::unreadable;
  }
}

}  // namespace forcebound::wire
