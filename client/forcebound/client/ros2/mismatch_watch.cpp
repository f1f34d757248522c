#include "forcebound/client/ros2/mismatch_watch.hpp"

#include <cstring>

#include "forcebound/client/ros2/dds_entities.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::ros2 {
namespace {

constexpr std::size_t kToldMost = 20;

std::string quoted(const char* text) {
  constexpr std::size_t kMost = 120;
  return "'" + text::printable(std::string_view(text).substr(0, kMost)) + "'";
}

}  // namespace

MismatchWatch::MismatchWatch(dds_entity_t participant)
    : publications_(made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                         "a reader of publications")),
      subscriptions_(made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
                          "a reader of subscriptions")) {
  dds_get_guid(participant, &participant_);
}

void MismatchWatch::look_at_types(Direction theirs, std::vector<std::string>& news) const {
  const bool publish = theirs == Direction::out;
  take_all<dds_builtintopic_endpoint_t>(
      publish ? publications_ : subscriptions_, [&](const auto& endpoint, const dds_sample_info_t&) {
        if (std::memcmp(&endpoint.participant_key, &participant_, sizeof participant_) == 0) return;
        for (const Watched& own : own_) {
          const bool opposite = own.is.direction != theirs;
          if (!opposite || own.is.topic != endpoint.topic_name || own.is.type == endpoint.type_name) continue;
          news.push_back("somebody " + std::string(publish ? "publishes " : "subscribes to ") + own.is.topic + " as " +
                         quoted(endpoint.type_name) + ", and is not connected; accepted is '" + own.is.type + "'");
        }
      });
}

void MismatchWatch::look_at_qos(Watched& own, std::vector<std::string>& news) {
  std::uint32_t total = 0;
  if (own.is.direction == Direction::in) {
    dds_requested_incompatible_qos_status_t status{};
    if (dds_get_requested_incompatible_qos_status(own.is.entity, &status) == DDS_RETCODE_OK) total = status.total_count;
  } else {
    dds_offered_incompatible_qos_status_t status{};
    if (dds_get_offered_incompatible_qos_status(own.is.entity, &status) == DDS_RETCODE_OK) total = status.total_count;
  }
  if (total <= own.incompatible) return;
  own.incompatible = total;
  news.push_back("somebody on " + own.is.topic +
                 " is not connected for its quality of service; accepted is ROS 2's default");
}

std::vector<std::string> MismatchWatch::take_news() {
  std::vector<std::string> news;
  look_at_types(Direction::out, news);
  look_at_types(Direction::in, news);
  for (Watched& own : own_) look_at_qos(own, news);
  if (news.size() > kToldMost - told_) news.resize(kToldMost - told_);
  told_ += news.size();
  return news;
}

}  // namespace forcebound::ros2
