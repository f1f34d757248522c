#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/live/foxglove_messages.hpp"
#include "forcebound/page/subject.hpp"
#include "forcebound/record/topic_encoder.hpp"
#include "forcebound/record/topics.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::live {

/// Shows Foxglove, and others that speak its protocol, what a recording of the run would have: the same topics, schemas
/// and pictures. What a viewer does not read in time is left out and counted, as PageServer says; a wrong message is
/// answered with a status of one line. All on the page's thread.
class FoxgloveSubject final : public page::Subject, private record::TopicSink {
 public:
  /// Where messages come from, and calls of services go to.
  class Source {
   public:
    virtual ~Source() = default;

    /// Writes what is new. @param wanted whether anybody looks: else what is written is passed over
    virtual void write_new(record::TopicEncoder& to, bool wanted) = 0;

    /// A call of one of its services: `FoxgloveSubject::answer` is to follow. Without services there is none.
    /// @param value JSON
    virtual void call(std::uint64_t /*number*/, const Service& /*service*/, const std::string& /*value*/) {}
  };

  struct Options {
    std::string name;            ///< of the program
    time::Nanoseconds epoch{0};  ///< wall-clock time [since 1970] at time zero of the records
    std::vector<record::Topic> topics;
    std::vector<Service> services{};
  };

  /// @param source must outlive it
  FoxgloveSubject(Options options, Source& source);

  /// What became of a call. @param refusal why it was not done; empty: it was
  void answer(std::uint64_t number, const std::string& refusal);

  /// Whom a server shows this.
  [[nodiscard]] page::Subprotocol subprotocol() noexcept { return {kFoxgloveSubprotocol, this}; }

  void greet(page::ViewerId viewer, page::Viewers& viewers) override;
  void receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) override;
  void receive_binary(page::ViewerId viewer, std::string_view content, page::Viewers& viewers) override;
  void leave(page::ViewerId viewer) noexcept override { viewers_.erase(viewer); }
  void beat(page::Viewers& viewers) override;
  [[nodiscard]] std::string metrics() override { return {}; }

 private:
  /// The channels that a viewer has subscribed to, by its ids of them.
  using Subscriptions = std::map<std::uint32_t, record::Topic>;

  struct Answer {
    page::ViewerId viewer = 0;
    CallNumber number{};
    std::string refusal{};
  };

  [[nodiscard]] bool wants(record::Topic topic) const noexcept override;
  void take(const record::TopicMessage& message) override;

  void subscribe(page::ViewerId viewer, const Subscription& wish, page::Viewers& viewers);
  static void send(const Answer& answer, page::Viewers& viewers);

  Options options_;
  Source& source_;
  record::TopicEncoder encoder_;
  std::map<page::ViewerId, Subscriptions> viewers_;
  page::Viewers* to_ = nullptr;                                      // during a beat
  std::vector<std::pair<page::ViewerId, std::uint32_t>> receivers_;  // of a message, by their subscriptions
  std::string scene_;  // the newest of Topic::scene, for who subscribes later
  time::Nanoseconds scene_at_{0};
  std::map<std::uint64_t, Answer> calls_;  // that wait for their answer
  std::uint64_t last_call_ = 0;
  std::vector<Answer> answers_;  // that wait to be sent
};

}  // namespace forcebound::live
