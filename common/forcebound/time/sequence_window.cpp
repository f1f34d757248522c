#include "forcebound/time/sequence_window.hpp"

namespace forcebound::time {
namespace {

// Words needed for all 64-bit numbers: a multiple of the words kept, so that positions stay the same when numbers wrap.
constexpr std::uint64_t kWordsOfCircle = std::uint64_t{1} << 58;

constexpr std::uint64_t bit(std::uint64_t sequence) noexcept { return std::uint64_t{1} << sequence % 64; }

}  // namespace

bool SequenceWindow::is_fresh(std::uint64_t sequence) const noexcept {
  if (!any_ || ahead_of_newest(sequence) > 0) return true;
  const std::uint64_t words_behind = (newest_ / kWordBits - sequence / kWordBits) % kWordsOfCircle;
  return words_behind < kWords && (arrived_[index_of(sequence)] & bit(sequence)) == 0;
}

SequenceWindow::Arrival SequenceWindow::add(std::uint64_t sequence, std::uint64_t ahead_most) noexcept {
  if (!is_fresh(sequence)) return Arrival::duplicate;
  const std::int64_t ahead = ahead_of_newest(sequence);
  const bool newest = !any_ || ahead > 0;
  if (any_ && newest && static_cast<std::uint64_t>(ahead) > ahead_most) return Arrival::too_far_ahead;
  if (newest) advance_to(sequence);
  arrived_[index_of(sequence)] |= bit(sequence);
  return newest ? Arrival::newest : Arrival::late;
}

void SequenceWindow::advance_to(std::uint64_t sequence) noexcept {
  if (!any_ || sequence - newest_ >= kNumbers) {
    arrived_.fill(0);
  } else {
    for (std::uint64_t first = newest_ / kWordBits * kWordBits + kWordBits;
         static_cast<std::int64_t>(sequence - first) >= 0; first += kWordBits) {
      arrived_[index_of(first)] = 0;
    }
  }
  newest_ = sequence;
  any_ = true;
}

}  // namespace forcebound::time
