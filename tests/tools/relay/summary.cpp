#include "tests/tools/relay/summary.hpp"

#include <fmt/format.h>

#include "forcebound/text/terminal.hpp"

namespace forcebound::relay {
namespace {

double milliseconds(Nanoseconds t) { return static_cast<double>(t.count()) * 1e-6; }

std::string totals(const Relay& relay, Direction direction) {
  const netem::Impairment& impairment = relay.impairment(direction);
  const netem::ImpairmentCounters& c = impairment.counters();
  return fmt::format("{:<9} {:>8} {:>9} {:>7} {:>5} {:>7} {:>7} {:>6} {:>8} {:>5}\n", to_string(direction), c.received,
                     c.forwarded, c.lost, c.duplicated, c.corrupted, c.reordered, c.over_limit, c.blackout,
                     impairment.waiting());
}

std::string count_line(std::uint64_t count, const char* what) {
  return count == 0 ? "" : fmt::format("{} {}\n", count, what);
}

}  // namespace

std::string summary(const Relay& relay) {
  std::string text =
      fmt::format("{:<9} {:>8} {:>9} {:>7} {:>5} {:>7} {:>7} {:>6} {:>8} {:>5}\n", "direction", "received", "forwarded",
                  "lost", "twice", "corrupt", "reorder", "excess", "blackout", "wait");
  text += totals(relay, Direction::up) + totals(relay, Direction::down);
  const Lateness& late = relay.lateness();
  if (late.packets != 0)
    text += text::wrapped(
        fmt::format("delay added by the relay itself: mean {:.3f} ms, most {:.3f} ms, more than {} ms for {} of {}\n",
                    milliseconds(late.total) / static_cast<double>(late.packets), milliseconds(late.most),
                    milliseconds(Lateness::kLate), late.late, late.packets),
        2);
  const RelayCounters& c = relay.counters();
  text +=
      fmt::format("clients: {} seen, {} forgotten after 60 s without a datagram\n", c.flows_opened, c.flows_expired);
  text += count_line(c.flow_refused, "datagrams refused: no room for another client");
  text += count_line(c.orphaned, "packets dropped: their client was forgotten");
  text += count_line(c.send_failed, "packets dropped: the system did not take them");
  return text;
}

}  // namespace forcebound::relay
