#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "forcebound/answer/answer.hpp"
#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

/// The messages between client and server, as plain values. Text is a view: into the caller's string when encoding,
/// into the decoder's storage, until its next use, when decoding.
namespace forcebound::wire {

using answer::Answer;
using time::Nanoseconds;

inline constexpr std::uint32_t kProtocolVersion = 2;

/// Bound on times on the wire (73 years from zero), so that differences and sums never overflow.
inline constexpr Nanoseconds kTimeMost{std::int64_t{1} << 61};

/// Client to server: requests a session. Sent again until answered; the same nonce always means the same session.
/// Padded on the wire so that no answer is larger than its request.
struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint64_t client_nonce = 0;
  std::uint32_t degrees_of_freedom = 0;
  std::string_view device{};  ///< the device's name, for the server's log
  double period_s = 0;        ///< period of the motions
  double force_N_max = 0;     ///< the device's largest force
  std::string_view scene{};   ///< requested scene; empty: the server's default
  Nanoseconds client_time{0};
  Nanoseconds round_trip{0};      ///< measured by the client from a refusal `round_trip_wanted`; 0: not measured
  std::string_view server_law{};  ///< the client's law, by name, if it works with a server-side law; empty: none
  bool renders_locally = false;   ///< requests the scene itself, to run what does not move at the client
  bool shows_scene = false;       ///< requests what can be seen of the scene, for a page
  bool shows_torque = false;      ///< the device turns its handle by motors: Answer::torque_N_m is for it
};

/// The static part of a scene that the server hands over, in numbered pieces (handover/packed_scene.hpp).
struct SceneOffer {
  std::array<std::byte, 32> manifest_sha256{};
  std::uint32_t manifest_bytes = 0;  ///< 0: nothing is handed over
  std::uint32_t pieces = 0;
};

/// What the server computes beside the parts that it hands over.
enum class ServerParts : std::uint8_t {
  held,      ///< some of it without local models: its force is held
  modelled,  ///< all of it with local models
  none,      ///< nothing
};

/// Server to client: the Hello is accepted, and a session begins. Sent again for each copy of that Hello; the same
/// nonce always gets the same session, as long as that lives.
struct Welcome {
  std::uint64_t client_nonce = 0;  ///< of the Hello
  std::uint64_t session = 0;       ///< its number, in every further message; unguessable
  std::uint64_t scene_hash = 0;    ///< same hash, same scene; 0: not known
  std::string_view scene{};        ///< its name
  std::string_view simulated{};    ///< what is simulated, for people
  SceneOffer offer{};
  ServerParts server_parts = ServerParts::held;
  bool takes_energy = false;  ///< a robot can use what the law at the device gives up: MotionSample::energy_given_J
  /// From the grip to the tip of the tool that the scene puts into the hand, in the handle's axes: motions tell the
  /// tip, forces act there. No rows: none, the tip is the grip.
  control::Vector tool_m{};
};

/// Server to client: a piece of the scene, sent again until it is acknowledged.
struct ScenePiece {
  std::uint64_t session = 0;
  std::uint64_t transmission = 0;        ///< 1, 2, 3, ... in the order of sending; sent again, a piece has another
  std::uint32_t number = 0;              ///< of the piece, from 0
  std::span<const std::byte> content{};  ///< as text is, a view
};

/// Server to client: a piece of what can be seen of the scene (view/description.hpp), for pictures alone. None is sent
/// again.
struct ViewPiece {
  std::uint64_t session = 0;
  std::uint64_t view = 0;                ///< hash of the description that it is about
  std::uint32_t pieces = 0;              ///< of that description; 0: the content is where a part of it is now
  std::uint32_t number = 0;              ///< of the piece, or of the part
  std::uint32_t first = 0;               ///< vertex of a part that deforms
  std::span<const std::byte> content{};  ///< as text is, a view
};

/// Which transmissions of pieces came.
struct PieceReceipt {
  bool wanted = false;       ///< whether more are
  std::uint64_t newest = 0;  ///< 0: none came
  std::uint64_t before = 0;  ///< the lowest bit is that of the transmission before the newest, and so on for 64

  friend bool operator==(const PieceReceipt&, const PieceReceipt&) = default;
};

enum class RefusalReason : std::uint8_t {
  unspecified,
  version_mismatch,
  unknown_scene,
  wrong_degrees_of_freedom,
  server_full,
  unknown_session,    ///< the answer to a motion of an unknown session: the server restarted, or closed it
  round_trip_wanted,  ///< the scene's accuracy depends on it: send Hello again with the round trip from the echoed time
  unknown_server_law,  ///< the server has no server-side law of that name
  encryption_wanted,   ///< the server takes encrypted sessions alone; sent in the clear, hence by anybody
};

struct Refusal {
  std::uint64_t client_nonce = 0;  ///< of the Hello refused, or
  std::uint64_t session = 0;       ///< the session refused
  RefusalReason reason = RefusalReason::unspecified;
  std::string_view text{};     ///< what is refused, and what would be accepted
  Nanoseconds client_time{0};  ///< of the Hello, echoed
  /// That the server speaks, of a version_mismatch; 0: not said, by version 1.
  std::uint32_t protocol_version = 0;
};

/// Client to server, each tick.
struct MotionSample {
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;                      ///< 1, 2, 3, ... per client process, across sessions
  Nanoseconds device_time{0};                      ///< client's clock at the reading
  control::Vector position{};                      ///< [m], scene frame, dof rows
  control::ServerLawNumbers server_law_numbers{};  ///< from the law at the device to the server-side law
  PieceReceipt pieces{};
  std::uint64_t challenge = 0;  ///< of the newest force, sent back from where it came; 0: it has none
  /// With 24 bits to each number. As it came, so that it may be unsound: control::sound.
  control::Handle handle{};
  double energy_given_J = 0;  ///< by the law at the device since it began; finite, of any sign
};

/// Server to client: the answer to one motion, with what is sent beside it.
struct EnvironmentForce {
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;            ///< of this force: 1, 2, 3, ... per session
  std::uint64_t motion_sequence = 0;     ///< which motion it answers
  Nanoseconds motion_device_time{0};     ///< echoed
  control::Vector position{};            ///< [m] where it was computed
  Nanoseconds server_receive_time{0};    ///< server's clock
  Nanoseconds server_send_time{0};       ///< server's clock
  Nanoseconds compute_time{0};           ///< spent on the scene
  std::uint64_t motions_received = 0;    ///< distinct motions of this session that reached the server so far
  std::uint64_t motions_duplicated = 0;  ///< further copies of them
  std::uint64_t motions_reordered = 0;   ///< of the received, those that came after a newer one: not answered
  /// From the server-side law to the law at the device.
  control::ServerLawNumbers server_law_numbers{};
  /// The motions come from an address that is not proven to be the client's: to be sent back from there. 0: not needed.
  std::uint64_t challenge = 0;
  /// Its force is what the server-side law made of it. Its model is as it came, so that it may be unsound.
  Answer answer{};
};

/// Either way: this session ends. The server's answer carries its final counts.
struct Bye {
  std::uint64_t session = 0;
  std::uint64_t motions_received = 0;
  std::uint64_t motions_duplicated = 0;
  std::uint64_t motions_reordered = 0;
  std::uint64_t forces_sent = 0;
  std::uint64_t motions_behind = 0;  ///< largest distance of a reordered number behind the newest
};

using Message = std::variant<Hello, Welcome, Refusal, MotionSample, EnvironmentForce, Bye, ScenePiece, ViewPiece>;

}  // namespace forcebound::wire
