#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "forcebound/client/rendering/local_scene.hpp"
#include "forcebound/client/rendering/piece_receipts.hpp"
#include "forcebound/client/rendering/scene_builder.hpp"
#include "forcebound/client/rendering/scene_exchange.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

/// Local rendering: the static parts of a scene are handed over by the server, and run at the device's own position and
/// rate.
///
///     tick:     offer, pieces --> exchange --> builder (verifies, caches, builds)
///     tick:     force  <-- local scene <-- exchange <--+
///
/// The tick calls all but `builder()`; that one's `work` may be called by another thread. The scene runs on while the
/// server does not answer, and when a restarted server offers the same scene. Then its time goes on too, so that what
/// happens at a time of its own (drive, vibration) makes no jump in the hand; the restarted server's begins anew, but
/// its forces of these parts are not used. Where a scene begins here anew, its time is the server's.
///
/// Real time but for the builder: noexcept, allocates nothing.
class LocalRendering {
 public:
  explicit LocalRendering(SceneBuilder::Options options)
      : scene_(exchange_, options.limits.nodes_of_a_tick()), builder_(std::move(options), exchange_) {}

  [[nodiscard]] SceneBuilder& builder() noexcept { return builder_; }

  /// A session began, with this offer.
  void begin(std::uint64_t session, const wire::SceneOffer& offer) noexcept;

  /// A motion that is sent was read then. The server's scene begins with the first of the session; one that runs here
  /// already goes on by its own time.
  void start_scene_time(Nanoseconds read_at) noexcept;

  /// The server ended the session: its scene does not run any more.
  void end() noexcept;

  /// A piece came; not of this session: passed over.
  void receive(const wire::ScenePiece& piece) noexcept;

  /// To be sent with the next motion.
  [[nodiscard]] wire::PieceReceipt receipt() const noexcept;

  /// As LocalScene::answer.
  [[nodiscard]] std::optional<Answer> answer(const Vector& position, Nanoseconds device_time,
                                             const std::optional<wire::EnvironmentForce>& newest,
                                             const control::Handle& handle = {}) noexcept;

  /// What runs here.
  [[nodiscard]] const LocalScene& scene() const noexcept { return scene_; }

  [[nodiscard]] BuildPhase phase() const noexcept { return exchange_.phase(); }

  /// While the phase is `refused`: what cannot be, in one line.
  [[nodiscard]] std::string_view why_refused() const noexcept { return builder_.why_refused(); }

  [[nodiscard]] std::uint64_t pieces_received() const noexcept { return pieces_received_; }
  [[nodiscard]] std::uint64_t piece_bytes_received() const noexcept { return piece_bytes_; }

 private:
  void set_offer(const handover::Announcement& offer) noexcept;
  void settle() noexcept;

  SceneExchange exchange_;
  LocalScene scene_;
  SceneBuilder builder_;
  PieceReceipts receipts_;
  std::uint64_t session_ = 0;
  handover::Announcement offer_{};
  bool pending_ = false;  // the offer, until the builder has room for it
  bool begins_ = false;   // with the session's first motion
  std::uint64_t pieces_received_ = 0;
  std::uint64_t piece_bytes_ = 0;
};

}  // namespace forcebound::client
