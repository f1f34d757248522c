#include "forcebound/client/ros2/peer_watch.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <utility>

#include "forcebound/client/ros2/dds_entities.hpp"
#include "forcebound/client/ros2/topic_names.hpp"

namespace forcebound::ros2 {
namespace {

constexpr std::size_t kToldMost = 20;
constexpr Nanoseconds kPatience = std::chrono::seconds{4};

/// Whose kind or number is compared; by the identifiers of DDS.
std::string policy_in_words(std::uint32_t policy) {
  struct Row {
    std::uint32_t id;
    const char* name;
  };
  constexpr std::array<Row, 8> kRows{{{DDS_DURABILITY_QOS_POLICY_ID, "durability"},
                                      {DDS_PRESENTATION_QOS_POLICY_ID, "presentation"},
                                      {DDS_DEADLINE_QOS_POLICY_ID, "deadline"},
                                      {DDS_LATENCYBUDGET_QOS_POLICY_ID, "latency budget"},
                                      {DDS_OWNERSHIP_QOS_POLICY_ID, "ownership"},
                                      {DDS_LIVELINESS_QOS_POLICY_ID, "liveliness"},
                                      {DDS_RELIABILITY_QOS_POLICY_ID, "reliability"},
                                      {DDS_DESTINATIONORDER_QOS_POLICY_ID, "destination order"}}};
  const auto* const row = std::ranges::find(kRows, policy, &Row::id);
  return row == kRows.end() ? "policy " + std::to_string(policy) : row->name;
}

std::string somebody(bool publishes, const std::string& topic) {
  return std::string(publishes ? "somebody publishes " : "somebody subscribes to ") + ros_topic(topic);
}

}  // namespace

PeerWatch::PeerWatch(dds_entity_t participant, Nanoseconds now)
    : publications_(made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                         "a reader of publications")),
      subscriptions_(made(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
                          "a reader of subscriptions")),
      patience_ends_(now + kPatience) {
  dds_get_guid(participant, &participant_);
  dds_get_domainid(participant, &domain_);
}

void PeerWatch::look_at_types(Direction theirs, std::vector<News>& news) {
  const bool publish = theirs == Direction::out;
  take_all<dds_builtintopic_endpoint_t>(
      publish ? publications_ : subscriptions_, [&](const auto& endpoint, const dds_sample_info_t&) {
        if (std::memcmp(&endpoint.participant_key, &participant_, sizeof participant_) == 0) return;
        for (const Watched& own : own_) {
          const bool opposite = own.is.direction != theirs;
          if (!opposite || own.is.topic != endpoint.topic_name || own.is.type == endpoint.type_name) continue;
          if (publish) ++publishers_.of_another_type;
          news.push_back({.text = somebody(publish, own.is.topic) + " as " + ros_type(endpoint.type_name) +
                                  ", and is not connected; accepted is " + ros_type(own.is.type)});
        }
      });
}

void PeerWatch::look_at_qos(Watched& own, std::vector<News>& news) {
  const bool publish = own.is.direction == Direction::in;
  const auto read = [&](auto status, auto get) {
    (void)get(own.is.entity, &status);
    return std::pair{status.total_count, status.last_policy_id};
  };
  const auto [total, policy] =
      publish ? read(dds_requested_incompatible_qos_status_t{}, &dds_get_requested_incompatible_qos_status)
              : read(dds_offered_incompatible_qos_status_t{}, &dds_get_offered_incompatible_qos_status);
  if (total <= own.incompatible) return;
  if (publish) publishers_.of_another_qos += total - own.incompatible;
  own.incompatible = total;
  news.push_back({.text = somebody(publish, own.is.topic) + " with another quality of service (" +
                          policy_in_words(policy) + "), and is not connected; accepted is ROS 2's default"});
}

void PeerWatch::look_at_publishers(Watched& own, std::vector<News>& news, Nanoseconds now) {
  if (own.is.direction != Direction::in) return;
  dds_subscription_matched_status_t status{};
  if (dds_get_subscription_matched_status(own.is.entity, &status) != DDS_RETCODE_OK) return;
  publishers_.connected = status.total_count;
  const std::string topic = ros_topic(own.is.topic);
  if (status.current_count != own.others) {
    const bool more = status.current_count > own.others;
    news.push_back({.is_good = more,
                    .text = topic + ": a publisher is " + (more ? "here" : "gone") + ", " +
                            std::to_string(status.current_count) + " now"});
  }
  own.others = status.current_count;
  if (publishers_.connected > 0 || none_told_ || now < patience_ends_) return;
  none_told_ = true;
  news.push_back({.text = topic + ": nobody publishes here, in domain " + std::to_string(domain_) + "; wanted is " +
                          ros_type(own.is.type) + ", reliable or best effort"});
}

std::vector<News> PeerWatch::take_news(Nanoseconds now) {
  std::vector<News> news;
  look_at_types(Direction::out, news);
  look_at_types(Direction::in, news);
  for (Watched& own : own_) {
    look_at_qos(own, news);
    look_at_publishers(own, news, now);
  }
  if (news.size() > kToldMost - told_) news.resize(kToldMost - told_);
  told_ += news.size();
  return news;
}

}  // namespace forcebound::ros2
