#include "tests/tools/relay/summary.hpp"

#include <fmt/format.h>

#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::relay {
namespace {

double milliseconds(Nanoseconds t) { return static_cast<double>(t.count()) * 1e-6; }

/// What became of the datagrams, a column for each direction.
text::Table totals(const Relay& relay) {
  const netem::ImpairmentCounters& up = relay.impairment(Direction::up).counters();
  const netem::ImpairmentCounters& down = relay.impairment(Direction::down).counters();
  text::Table table(
      {{"datagrams"}, {std::string(to_string(Direction::up))}, {std::string(to_string(Direction::down))}});
  const auto add = [&](const char* fate, auto up_count, auto down_count) {
    table.add({fate, std::to_string(up_count), std::to_string(down_count)});
  };
  add("received", up.received, down.received);
  add("forwarded", up.forwarded, down.forwarded);
  add("lost", up.lost, down.lost);
  add("duplicated", up.duplicated, down.duplicated);
  add("corrupted", up.corrupted, down.corrupted);
  // By netem's `reorder`; packets that jitter puts out of order are delayed like others.
  add("sent ahead", up.reordered, down.reordered);
  add("over limit", up.over_limit, down.over_limit);
  add("blackout", up.blackout, down.blackout);
  add("waiting", relay.impairment(Direction::up).waiting(), relay.impairment(Direction::down).waiting());
  return table;
}

std::string count_line(std::uint64_t count, const char* one, const char* more) {
  return count == 0 ? "" : text::counted(count, one) + " " + more + "\n";
}

}  // namespace

std::string summary(const Relay& relay) {
  std::string text = totals(relay).to_text();
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
  text += count_line(c.flow_refused, "datagram", "refused: no room for another client");
  text += count_line(c.orphaned, "packet", "dropped: the client was forgotten");
  text += count_line(c.send_failed, "packet", "dropped: not taken by the system");
  return text;
}

}  // namespace forcebound::relay
