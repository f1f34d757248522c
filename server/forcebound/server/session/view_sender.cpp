#include "forcebound/server/session/view_sender.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace forcebound::server {
namespace {

constexpr Nanoseconds kSecond = std::chrono::seconds{1};
constexpr Nanoseconds kRound = kSecond / 30;
// For what was lost every time.
constexpr Nanoseconds kSlow = kSecond / 10;
constexpr int kFastRounds = 3;
constexpr int kPiecesAtOnce = 4;

}  // namespace

ViewSender::ViewSender(std::shared_ptr<const view::Description> description, const ViewRate& rate, Nanoseconds now)
    : description_(std::move(description)),
      rate_(kSecond / std::max(1, rate.pieces_per_s), kPiecesAtOnce, now),
      next_slow_(now),
      next_round_(now) {}

std::optional<wire::ViewPiece> ViewSender::next(const Environment& environment, time::TokenBucket& all,
                                                Nanoseconds now) noexcept {
  const bool describes = description_due(now);
  const bool moves = !description_->moving.empty() && (going_round_ || now >= next_round_);
  if ((!describes && !moves) || !rate_.take(now) || !all.take(now)) return std::nullopt;
  // In turns, so that nobody waits for the picture, or for what moves in it.
  if (moves && (!describes || !moved_last_)) {
    if (auto piece = movement_piece(environment, now)) {
      moved_last_ = true;
      return piece;
    }
  }
  if (!describes) return std::nullopt;
  moved_last_ = false;
  next_slow_ = now + kSlow;
  return description_piece();
}

bool ViewSender::description_due(Nanoseconds now) noexcept {
  return description_->pieces() > 0 && (rounds_ < kFastRounds || now >= next_slow_);
}

wire::ViewPiece ViewSender::description_piece() noexcept {
  const std::uint32_t pieces = description_->pieces();
  const std::uint32_t number = next_piece_++;
  if (next_piece_ == pieces) {
    next_piece_ = 0;
    rounds_ = std::min(rounds_ + 1, kFastRounds);
  }
  return {.view = description_->hash, .pieces = pieces, .number = number, .content = description_->piece(number)};
}

std::optional<wire::ViewPiece> ViewSender::movement_piece(const Environment& environment, Nanoseconds now) noexcept {
  if (!std::exchange(going_round_, true)) {
    group_ = first_ = 0;
    next_round_ = now + kRound;
  }
  std::optional<wire::ViewPiece> piece;
  while (!piece && find_next()) {
    const std::size_t each = description_->moving[group_].numbers_of_item();
    const std::size_t most = std::min(numbers_.size() / each, description_->moving[group_].items() - first_);
    const std::size_t count = environment.sample(group_, first_, std::span(numbers_).first(most * each)) / each;
    if (count > 0) {
      piece = {.view = description_->hash,
               .number = static_cast<std::uint32_t>(group_),
               .first = static_cast<std::uint32_t>(first_),
               .content = std::as_bytes(std::span(numbers_).first(count * each))};
    }
    // Of what is not to be seen any more, such as a model that is not sound, the rest is passed over.
    first_ = count > 0 ? first_ + count : description_->moving[group_].items();
  }
  going_round_ = find_next();
  return piece;
}

bool ViewSender::find_next() noexcept {
  while (group_ < description_->moving.size() && first_ >= description_->moving[group_].items()) {
    ++group_;
    first_ = 0;
  }
  return group_ < description_->moving.size();
}

}  // namespace forcebound::server
