#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "forcebound/server/offer/environment.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/token_bucket.hpp"
#include "forcebound/view/description.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// How much of what can be seen is sent, in pieces of at most some 1180 bytes with their headings.
struct ViewRate {
  int pieces_per_s = 300;       ///< to each client that asks
  int pieces_per_s_all = 3000;  ///< to all of them
};

/// Tells one client how the scene looks, a piece at a time as the answers to its motions leave. Nothing is acknowledged
/// or sent again: the description comes round three times at first and then slowly, and where things are 30 times a
/// second, or as often as the rate allows.
///
/// Real time after construction: noexcept, no allocation, O(one piece).
class ViewSender {
 public:
  /// @param description of the environment that `next` is asked with
  ViewSender(std::shared_ptr<const view::Description> description, const ViewRate& rate, Nanoseconds now);

  /// What is to be sent now, if anything; its content is valid until the next call. Without the session's number.
  /// @param all the rate of all clients together
  [[nodiscard]] std::optional<wire::ViewPiece> next(const Environment& environment, time::TokenBucket& all,
                                                    Nanoseconds now) noexcept;

 private:
  [[nodiscard]] bool description_due(Nanoseconds now) noexcept;
  [[nodiscard]] wire::ViewPiece description_piece() noexcept;
  /// Goes to the next item that moves; false: the round is over.
  [[nodiscard]] bool find_next() noexcept;
  [[nodiscard]] std::optional<wire::ViewPiece> movement_piece(const Environment& environment, Nanoseconds now) noexcept;

  std::shared_ptr<const view::Description> description_;
  time::TokenBucket rate_;
  std::uint32_t next_piece_ = 0;
  int rounds_ = 0;  // of the whole description
  bool moved_last_ = false;
  Nanoseconds next_slow_{0};
  // Where the round of all that moves is.
  bool going_round_ = false;
  std::size_t group_ = 0;
  std::size_t first_ = 0;
  Nanoseconds next_round_{0};
  std::array<float, view::kNumbersMost> numbers_{};
};

}  // namespace forcebound::server
