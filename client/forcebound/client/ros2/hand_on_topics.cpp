#include "forcebound/client/ros2/hand_on_topics.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <memory>

#include "forcebound/client/app/event_words.hpp"
#include "forcebound/server/session/count_text.hpp"
#include "forcebound/text/printable.hpp"

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
      frame_(options.topics.frame),
      is_remote_(!options.listen.empty()),
      inbox_(options.topics.frame, policy_.drop),
      topics_(options.topics, inbox_),
      publisher_(queue_, topics_, ages_, options.publish_Hz) {}

server::EnvironmentKind HandOnTopics::environment() {
  return {.name = "ros2", .sessions_max = 1, .make = [this](const server::ClientFacts& client) {
            auto made = std::make_unique<TopicEnvironment>(inbox_, policy_, ages_, client.shows_torque,
                                                           is_remote_ ? &queue_ : nullptr);
            return server::MadeEnvironment{.environment = std::move(made), .simulated = kSimulated};
          }};
}

void HandOnTopics::log_news() {
  for (const News& news : topics_.take_news())
    spdlog::log(news.is_good ? spdlog::level::info : spdlog::level::warn, "{}", news.text);
  log_refusals();
  log_age();
}

std::string HandOnTopics::refusal_in_words(Verdict verdict) const {
  if (verdict != Verdict::in_another_frame) return kVerdicts[static_cast<std::size_t>(verdict)].words;
  return "its frame is '" + text::printable(inbox_.other_frame()) + "', accepted is '" + frame_ +
         "' (--frame), or none";
}

/// The first of each reason; all are counted.
void HandOnTopics::log_refusals() {
  const WrenchInbox::Counts counts = inbox_.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (told_[i] > 0 || counts[i] == 0) continue;
    const auto verdict = static_cast<Verdict>(i);
    if (verdict == Verdict::taken) {
      spdlog::info("servo_cf: a publisher's wrenches arrive");
    } else {
      spdlog::warn("servo_cf: a wrench is refused: {}; further ones are only counted", refusal_in_words(verdict));
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

std::vector<HandOnTopics::Count> HandOnTopics::counts() const {
  std::vector<Count> all;
  const WrenchInbox::Counts wrenches = inbox_.counts();
  for (std::size_t i = 0; i < wrenches.size(); ++i)
    all.push_back({"servo_cf", kVerdicts[i].words, kVerdicts[i].name, wrenches[i]});
  const PeerWatch::Publishers& publishers = topics_.publishers();
  const AnswerAges::Counts ages = ages_.counts();
  const std::array more{
      Count{"publishers", "connected", "publishers", publishers.connected},
      Count{"publishers", "of another type", "publishers_of_another_type", publishers.of_another_type},
      Count{"publishers", "of another quality of service", "publishers_of_another_qos", publishers.of_another_qos},
      Count{"answers", "without a wrench", "answers_without_wrench", ages[0]},
      Count{"answers", "fresh", "answers_fresh", ages[1]},
      Count{"answers", "fading", "answers_fading", ages[2]},
      Count{"answers", "zero", "answers_zero", ages[3]},
      Count{"measured", "published", "measured_published", publisher_.published()},
      Count{"measured", "dropped", "measured_dropped", queue_.dropped()},
      Count{"measured", "refused by DDS", "measured_refused_by_dds", topics_.not_written()}};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string HandOnTopics::totals() const {
  server::CountText text;
  for (const Count& count : counts()) text.add(count.subject, count.count, count.words);
  const bool none = topics_.publishers().connected == 0;
  return text.text() + (none ? "nobody published " + topics_.wrench_topic() + "\n" : "");
}

}  // namespace forcebound::ros2
