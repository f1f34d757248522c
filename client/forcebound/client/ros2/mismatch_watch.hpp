#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace forcebound::ros2 {

enum class Direction : std::uint8_t { in, out };

/// Finds others on our topics who cannot be reached there: DDS matches neither another type nor a quality of service
/// that asks for more than is offered, and says nothing. Not real time.
class MismatchWatch {
 public:
  explicit MismatchWatch(dds_entity_t participant);

  struct Own {
    std::string topic;
    std::string type;
    dds_entity_t entity = 0;  ///< its reader or writer
    Direction direction = Direction::in;
  };
  void add(Own own) { own_.push_back({.is = std::move(own)}); }

  /// Of who came since the last call, in lines; each once, and after the twentieth none.
  [[nodiscard]] std::vector<std::string> take_news();

 private:
  struct Watched {
    Own is;
    std::uint32_t incompatible = 0;
  };
  void look_at_types(Direction theirs, std::vector<std::string>& news) const;
  static void look_at_qos(Watched& own, std::vector<std::string>& news);

  dds_guid_t participant_{};
  dds_entity_t publications_;
  dds_entity_t subscriptions_;
  std::vector<Watched> own_{};
  std::size_t told_ = 0;
};

}  // namespace forcebound::ros2
