#pragma once

#include <sys/types.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

namespace forcebound::client::commands {

/// Text of a fixed size that one process writes and another reads once that one has ended.
template <std::size_t size>
class SharedText {
 public:
  void set(std::string_view text) noexcept {
    const std::size_t bytes = std::min(text.size(), size - 1);
    std::copy_n(text.begin(), bytes, text_.begin());
    text_[bytes] = '\0';
  }
  [[nodiscard]] const char* text() const noexcept { return text_.data(); }

 private:
  std::array<char, size> text_{};
};

/// How the process that checks a device ended.
enum class CheckEnd : std::uint8_t {
  none,      ///< it still runs, or ended by itself
  finished,  ///< after all checks
  crashed,   ///< the driver
  hung,      ///< a call did not return
  overdue,   ///< all of it took too long
};

/// What the process that checks a device leaves in memory that it shares with the one that waits for it, so that
/// nothing is lost when a driver ends it. Lines of `rows` are the checks, as JSON.
struct CheckProgress {
  static constexpr std::size_t kRowBytes = std::size_t{1} << 16U;

  std::atomic<bool> cancelled{false};
  std::atomic<CheckEnd> end{CheckEnd::none};
  std::atomic<bool> stopped{false};        ///< `stop` returned, after a call that did not
  std::atomic<std::int64_t> called_ns{0};  ///< when the call that is in progress began; 0: none is
  SharedText<64> check{};
  SharedText<16> call{};
  SharedText<512> crash{};  ///< in words
  std::atomic<std::size_t> row_bytes{0};
  std::array<char, kRowBytes> rows{};

  /// Of the process that checks. What does not fit is left out.
  void add_row(std::string_view row) noexcept {
    const std::size_t at = row_bytes;
    if (at + row.size() + 1 > rows.size()) return;
    std::copy(row.begin(), row.end(), rows.begin() + static_cast<std::ptrdiff_t>(at));
    rows[at + row.size()] = '\n';
    row_bytes = at + row.size() + 1;
  }
};

}  // namespace forcebound::client::commands
