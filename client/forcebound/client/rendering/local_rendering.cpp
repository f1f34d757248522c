#include "forcebound/client/rendering/local_rendering.hpp"

namespace forcebound::client {

void LocalRendering::begin(std::uint64_t session, const wire::SceneOffer& offer) noexcept {
  session_ = session;
  receipts_ = {};
  const handover::Announcement offered{
      .hash = offer.manifest_sha256, .manifest_bytes = offer.manifest_bytes, .pieces = offer.pieces};
  // The same scene again, of a server that started anew or forgot us: what is there of it stays.
  if (offered == offer_ && exchange_.phase() != BuildPhase::refused) return;
  begins_ = true;
  set_offer(offered);
}

void LocalRendering::set_offer(const handover::Announcement& offer) noexcept {
  offer_ = offer;
  scene_.forget();
  pending_ = true;
  settle();
}

void LocalRendering::start_scene_time(Nanoseconds read_at) noexcept {
  if (begins_) scene_.set_first_time(read_at);
  begins_ = false;
}

void LocalRendering::end() noexcept {
  session_ = 0;
  set_offer({});
}

void LocalRendering::settle() noexcept {
  if (pending_ && exchange_.begin(offer_)) pending_ = false;
}

void LocalRendering::receive(const wire::ScenePiece& piece) noexcept {
  if (session_ == 0 || piece.session != session_ || pending_) return;
  ++pieces_received_;
  piece_bytes_ += piece.content.size();
  // What finds no room is not acknowledged, and comes again.
  if (exchange_.put(piece.number, piece.content)) receipts_.add(piece.transmission);
}

wire::PieceReceipt LocalRendering::receipt() const noexcept {
  const bool wanted = !pending_ && exchange_.phase() == BuildPhase::wanting;
  return wanted ? receipts_.receipt(true) : wire::PieceReceipt{};
}

std::optional<Answer> LocalRendering::answer(const Vector& position, Nanoseconds device_time,
                                             const std::optional<wire::EnvironmentForce>& newest,
                                             const control::Handle& handle) noexcept {
  settle();
  // Until the builder has room for the order, the exchange still hands out the scene that ended.
  if (pending_) return std::nullopt;
  // What was built of a scene before it turned out wrong is not trusted either.
  if (exchange_.phase() == BuildPhase::refused) {
    scene_.forget();
    return std::nullopt;
  }
  // Where the device was in another session's scene says nothing about this one.
  return scene_.answer(position, device_time, newest && newest->session == session_ ? &*newest : nullptr, handle);
}

}  // namespace forcebound::client
