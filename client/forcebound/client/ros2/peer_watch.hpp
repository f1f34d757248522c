#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/time/clock.hpp"

namespace forcebound::ros2 {

using time::Nanoseconds;

enum class Direction : std::uint8_t { in, out };

/// What a user has to know, in one line.
struct News {
  bool is_good = false;
  std::string text;
};

/// Who else is on our topics: publishers that come and leave, and those that cannot be reached there. DDS matches
/// neither another type nor a quality of service that asks for more than is offered, and says nothing. Not real time.
class PeerWatch {
 public:
  /// @param now when it begins
  PeerWatch(dds_entity_t participant, Nanoseconds now);

  struct Own {
    std::string topic;
    std::string type;
    dds_entity_t entity = 0;  ///< its reader or writer
    Direction direction = Direction::in;
  };
  void add(Own own) { own_.push_back({.is = std::move(own)}); }

  /// Of who came or left since the last call, and, once, that after some seconds nobody publishes what we subscribe to;
  /// after the twentieth none.
  [[nodiscard]] std::vector<News> take_news(Nanoseconds now);

  /// Publishers of what we subscribe to, so far.
  struct Publishers {
    std::uint64_t connected = 0;
    std::uint64_t of_another_type = 0;
    std::uint64_t of_another_qos = 0;
  };
  /// As of the last call of `take_news`, of the same thread.
  [[nodiscard]] const Publishers& publishers() const noexcept { return publishers_; }

 private:
  struct Watched {
    Own is;
    std::uint32_t others = 0;  // connected now
    std::uint32_t incompatible = 0;
  };
  void look_at_types(Direction theirs, std::vector<News>& news);
  void look_at_qos(Watched& own, std::vector<News>& news);
  void look_at_publishers(Watched& own, std::vector<News>& news, Nanoseconds now);

  dds_guid_t participant_{};
  dds_domainid_t domain_ = 0;
  dds_entity_t publications_;
  dds_entity_t subscriptions_;
  Nanoseconds patience_ends_;
  bool none_told_ = false;
  std::vector<Watched> own_{};
  Publishers publishers_{};
  std::size_t told_ = 0;
};

}  // namespace forcebound::ros2
