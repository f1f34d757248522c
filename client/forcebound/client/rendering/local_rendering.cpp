#include "forcebound/client/rendering/local_rendering.hpp"

namespace forcebound::client {

void LocalRendering::begin(std::uint64_t session, const wire::SceneOffer& offer) noexcept {
  session_ = session;
  receipts_ = {};
  const handover::Announcement offered{
      .hash = offer.manifest_sha256, .manifest_bytes = offer.manifest_bytes, .pieces = offer.pieces};
  // The same scene again, of a server that started anew or forgot us: what is there of it stays.
  if (offered == offer_ && exchange_.phase() != BuildPhase::refused) return;
  offer_ = offered;
  begins_ = true;
  scene_.forget();
  pending_ = offered.manifest_bytes > 0 ? Pending::begin : Pending::end;
  settle();
}

void LocalRendering::note_motion(Nanoseconds read_at) noexcept {
  if (begins_) scene_.set_first_time(read_at);
  begins_ = false;
}

void LocalRendering::end() noexcept {
  session_ = 0;
  offer_ = {};
  scene_.forget();
  pending_ = Pending::end;
  settle();
}

void LocalRendering::settle() noexcept {
  if (pending_ == Pending::begin && exchange_.begin(offer_)) pending_ = Pending::nothing;
  if (pending_ == Pending::end && exchange_.end()) pending_ = Pending::nothing;
}

void LocalRendering::take(const wire::ScenePiece& piece) noexcept {
  if (session_ == 0 || piece.session != session_ || pending_ != Pending::nothing) return;
  ++pieces_received_;
  piece_bytes_ += piece.content.size();
  // What finds no room is not acknowledged, and comes again.
  if (exchange_.put(piece.number, piece.content)) receipts_.note(piece.transmission);
}

wire::PieceReceipt LocalRendering::receipt() const noexcept {
  const bool wanted = pending_ == Pending::nothing && exchange_.phase() == BuildPhase::wanting;
  return wanted ? receipts_.receipt(true) : wire::PieceReceipt{};
}

std::optional<LocalAnswer> LocalRendering::answer(const Vector& position, Nanoseconds device_time,
                                                  const std::optional<wire::EnvironmentForce>& newest,
                                                  const control::Handle& handle) noexcept {
  if (pending_ != Pending::nothing) settle();
  // Until the builder has room for the order, the exchange still hands out the scene that ended.
  if (pending_ != Pending::nothing) return std::nullopt;
  // What was built of a scene before it turned out wrong is not trusted either.
  if (exchange_.phase() == BuildPhase::refused) {
    scene_.forget();
    return std::nullopt;
  }
  // Where the device was in another session's scene says nothing about this one.
  return scene_.answer(position, device_time, newest && newest->session == session_ ? &*newest : nullptr, handle);
}

}  // namespace forcebound::client
