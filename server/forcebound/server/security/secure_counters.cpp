#include "forcebound/server/security/secure_counters.hpp"

#include "forcebound/server/session/count_line.hpp"

namespace forcebound::server {

void SecureCounters::add(const SecureCounters& other) noexcept {
  cookies_offered += other.cookies_offered;
  handshakes += other.handshakes;
  handshakes_later += other.handshakes_later;
  handshakes_again += other.handshakes_again;
  handshakes_not_allowed += other.handshakes_not_allowed;
  handshakes_full += other.handshakes_full;
  handshakes_not_authentic += other.handshakes_not_authentic;
  handshakes_malformed += other.handshakes_malformed;
  handshakes_not_proven += other.handshakes_not_proven;
  handshakes_over_rate += other.handshakes_over_rate;
  handshakes_crowded += other.handshakes_crowded;
  handshakes_overtaken += other.handshakes_overtaken;
  addresses_of_others += other.addresses_of_others;
  handshakes_failed += other.handshakes_failed;
  handshakes_unused += other.handshakes_unused;
  sessions_idle += other.sessions_idle;
  in_clear += other.in_clear;
  hellos_in_clear += other.hellos_in_clear;
  for (std::size_t i = 0; i < records.size(); ++i) records[i] += other.records[i];
}

std::string SecureCounters::text() const {
  using security::Opening;
  const auto dropped = [&](Opening why) { return records[static_cast<std::size_t>(why)]; };
  return count_line("handshakes", {"answered", handshakes},
                    {{"for another key of a session", handshakes_later},
                     {"copies answered again", handshakes_again},
                     {"by cookies alone", cookies_offered},
                     {"of clients that are not allowed", handshakes_not_allowed},
                     {"for which there was no room", handshakes_full},
                     {"not authentic", handshakes_not_authentic},
                     {"malformed or of another pattern", handshakes_malformed},
                     {"not proven to be of who may come in", handshakes_not_proven},
                     {"over the rate", handshakes_over_rate},
                     {"beyond those that may wait", handshakes_crowded},
                     {"overtaken by a newer one", handshakes_overtaken},
                     {"without memory for them", handshakes_failed},
                     {"not followed by a session", handshakes_unused},
                     {"whose session was idle or lacked a new key", sessions_idle}}) +
         count_line("sealed datagrams", {"opened", dropped(Opening::opened)},
                    {{"malformed", dropped(Opening::malformed)},
                     {"too long", dropped(Opening::no_room)},
                     {"of another session", dropped(Opening::other_session)},
                     {"of unknown keys", dropped(Opening::unknown_key)},
                     {"of expired keys", dropped(Opening::expired)},
                     {"replayed or too old", dropped(Opening::replayed)},
                     {"not authentic", dropped(Opening::not_authentic)},
                     {"opened, but from another client's address", addresses_of_others}}) +
         count_line("datagrams in the clear", {"dropped", in_clear}, {{"of them Hellos refused", hellos_in_clear}});
}

}  // namespace forcebound::server
