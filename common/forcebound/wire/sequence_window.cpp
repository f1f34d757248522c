#include "forcebound/wire/sequence_window.hpp"

namespace forcebound::wire {
namespace {

// Words needed for all 64-bit numbers: a multiple of the words kept, so that positions stay the same when numbers wrap.
constexpr std::uint64_t kWordsOfCircle = std::uint64_t{1} << 58;

constexpr std::uint64_t bit(std::uint64_t sequence) noexcept { return std::uint64_t{1} << sequence % 64; }

}  // namespace

SequenceWindow::Arrival SequenceWindow::note(std::uint64_t sequence, std::uint64_t ahead_most) noexcept {
  const auto ahead = static_cast<std::int64_t>(sequence - newest_);
  if (any_ && ahead > 0 && static_cast<std::uint64_t>(ahead) > ahead_most) return Arrival::too_far_ahead;
  if (!any_ || ahead > 0) {
    advance_to(sequence);
    word(sequence) |= bit(sequence);
    return Arrival::newest;
  }
  const std::uint64_t words_behind = (newest_ / kWordBits - sequence / kWordBits) % kWordsOfCircle;
  if (words_behind >= kWords) return Arrival::duplicate;
  if ((word(sequence) & bit(sequence)) != 0) return Arrival::duplicate;
  word(sequence) |= bit(sequence);
  return Arrival::late;
}

void SequenceWindow::advance_to(std::uint64_t sequence) noexcept {
  if (!any_ || sequence - newest_ >= kNumbers) {
    arrived_.fill(0);
  } else {
    for (std::uint64_t first = newest_ / kWordBits * kWordBits + kWordBits;
         static_cast<std::int64_t>(sequence - first) >= 0; first += kWordBits) {
      word(first) = 0;
    }
  }
  newest_ = sequence;
  any_ = true;
}

}  // namespace forcebound::wire
