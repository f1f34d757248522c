#include "tests/tools/relay/packet_rows.hpp"

#include <algorithm>
#include <cstdio>

namespace forcebound::relay {
namespace {

void append_ms(std::string& text, Nanoseconds time) {
  std::array<char, 32> digits;
  const auto ns = time.count();
  const int length = std::snprintf(digits.data(), digits.size(), "%lld.%06lld", static_cast<long long>(ns / 1'000'000),
                                   static_cast<long long>(ns % 1'000'000));
  text.append(digits.data(), static_cast<std::size_t>(length));
}

}  // namespace

void PacketRows::on_verdict(Direction direction, const netem::Verdict& verdict) {
  rows_[static_cast<std::size_t>(direction)].push_back({verdict, verdict.fate != netem::Fate::forwarded});
}

void PacketRows::on_departure(Direction direction, const netem::Verdict& verdict) {
  Rows& rows = rows_[static_cast<std::size_t>(direction)];
  const auto first = std::lower_bound(rows.begin(), rows.end(), verdict.number,
                                      [](const Row& row, std::uint64_t number) { return row.verdict.number < number; });
  const auto found = std::find_if(first, rows.end(), [&](const Row& row) {
    return row.verdict.number != verdict.number || row.verdict.copy == verdict.copy;
  });
  // Absent if the log had no room for its verdict.
  if (found == rows.end() || found->verdict.number != verdict.number) return;
  *found = {verdict, true};
}

std::size_t PacketRows::take_ready(std::string& text) { return take(text, false); }

std::size_t PacketRows::take_all(std::string& text) { return take(text, true); }

std::size_t PacketRows::take(std::string& text, bool incomplete_too) {
  std::size_t taken = 0;
  for (const Direction direction : {Direction::up, Direction::down}) {
    Rows& rows = rows_[static_cast<std::size_t>(direction)];
    for (; !rows.empty() && (incomplete_too || rows.front().complete); ++taken) {
      write(text, direction, rows.front());
      rows.pop_front();
    }
  }
  return taken;
}

void PacketRows::write(std::string& text, Direction direction, const Row& row) const {
  const netem::Verdict& verdict = row.verdict;
  text += to_string(direction);
  text += ',';
  text += std::to_string(verdict.number);
  text += ',';
  append_ms(text, verdict.arrival - start_);
  text += ',';
  text += row.complete ? netem::verdict_text(verdict) : "waiting";
  text += ',';
  if (row.complete && verdict.fate == netem::Fate::forwarded) append_ms(text, verdict.delay);
  text += '\n';
}

}  // namespace forcebound::relay
