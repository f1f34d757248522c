#include "forcebound/client/ros2/hand_on_topics.hpp"

#include <spdlog/spdlog.h>

#include <memory>

#include "forcebound/client/app/event_words.hpp"

namespace forcebound::ros2 {
namespace {

client::Event event_of(record::ForcePolicy policy, Nanoseconds duration) {
  client::Event event;
  event.duration = duration;
  event.kind = policy == record::ForcePolicy::fresh    ? client::Event::Kind::force_fresh
               : policy == record::ForcePolicy::fading ? client::Event::Kind::force_fading
                                                       : client::Event::Kind::force_dropped;
  return event;
}

}  // namespace

HandOnTopics::HandOnTopics(const Options& options)
    : policy_(options.client.client.policy),
      is_remote_(!options.listen.empty()),
      inbox_(options.topics.frame, policy_.drop),
      topics_(options.topics, inbox_),
      publisher_(queue_, topics_, ages_, options.publish_Hz) {}

server::EnvironmentLibrary HandOnTopics::environments() {
  server::EnvironmentLibrary environments;
  environments.add({.name = "ros2", .sessions_max = 1, .make = [this](const server::ClientFacts& client) {
                      auto made = std::make_unique<TopicEnvironment>(inbox_, policy_, ages_, client.shows_torque,
                                                                     is_remote_ ? &queue_ : nullptr);
                      return server::MadeEnvironment{.environment = std::move(made),
                                                     .simulated = "nothing: forces are a ROS 2 publisher's"};
                    }});
  return environments;
}

void HandOnTopics::log_news() {
  for (const std::string& line : topics_.take_news()) spdlog::warn("{}", line);
  log_refusals();
  log_age();
}

/// The first of each reason; all are counted.
void HandOnTopics::log_refusals() {
  const WrenchInbox::Counts counts = inbox_.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (told_[i] > 0 || counts[i] == 0) continue;
    if (static_cast<Verdict>(i) == Verdict::taken) {
      spdlog::info("servo_cf: a publisher's wrenches arrive");
    } else {
      spdlog::warn("servo_cf: a wrench is refused: {}; further ones are only counted", kVerdicts[i]);
    }
  }
  told_ = counts;
}

void HandOnTopics::log_age() {
  const record::ForcePolicy policy = ages_.newest();
  const Nanoseconds now = clock_.now();
  if (policy != told_policy_) {
    const bool first = told_policy_ == record::ForcePolicy::none;
    if (told_policy_ == record::ForcePolicy::fresh) not_fresh_since_ = now;
    const bool fresh = policy == record::ForcePolicy::fresh;
    if (!first) late_forces_.store(event_of(policy, fresh ? now - not_fresh_since_ : ages_.age()));
    told_policy_ = policy;
  }
  if (const auto line = late_forces_.take(now)) {
    client::Event event;
    event.kind = line->kind;
    event.duration = line->duration;
    const client::EventWords words = client::words_of(event);
    spdlog::log(words.level, "servo_cf: {}", words.text);
  }
}

std::string HandOnTopics::totals() const {
  const WrenchInbox::Counts wrenches = inbox_.counts();
  std::string text = "servo_cf: ";
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(wrenches[i]) + " " + kVerdicts[i];
  }
  const AnswerAges::Counts ages = ages_.counts();
  return text + "\nanswers: " + std::to_string(ages[0]) + " without a wrench, " + std::to_string(ages[1]) + " fresh, " +
         std::to_string(ages[2]) + " fading, " + std::to_string(ages[3]) +
         " zero\nmeasured: " + std::to_string(publisher_.published()) + " published, " +
         std::to_string(queue_.dropped()) + " dropped, " + std::to_string(topics_.not_written()) + " refused by DDS\n";
}

}  // namespace forcebound::ros2
