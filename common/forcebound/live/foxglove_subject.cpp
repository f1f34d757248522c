#include "forcebound/live/foxglove_subject.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <stdexcept>
#include <utility>

#include "forcebound/page/json_member.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::live {
namespace {

page::Text shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

/// A scene is not told again.
page::Worth worth_of(record::Topic topic) {
  return topic == record::Topic::scene ? page::Worth::needed : page::Worth::stream;
}

std::string shown(const std::string& text) {
  constexpr std::size_t kMost = 40;
  return text::printable(text.substr(0, kMost));
}

}  // namespace

FoxgloveSubject::FoxgloveSubject(Options options, Source& source)
    : options_(std::move(options)), source_(source), encoder_(options_.epoch, *this) {}

void FoxgloveSubject::greet(page::ViewerId viewer, page::Viewers& viewers) {
  viewers_[viewer];
  const auto say = [&](std::string message) { viewers.send(viewer, shared(std::move(message)), page::Worth::needed); };
  say(server_info(options_.name, !options_.services.empty()));
  say(advertise(options_.topics));
  if (!options_.services.empty()) say(advertise_services(options_.services));
}

void FoxgloveSubject::receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) {
  try {
    const auto wish = read_text(text);
    if (const auto* const more = std::get_if<Subscribe>(&wish)) {
      for (const Subscription& one : more->subscriptions) subscribe(viewer, one, viewers);
    } else {
      for (const std::uint32_t id : std::get<Unsubscribe>(wish).subscriptions) {
        if (viewers_[viewer].erase(id) > 0) continue;
        throw std::invalid_argument("there is no subscription " + std::to_string(id));
      }
    }
  } catch (const std::invalid_argument& error) {
    viewers.send(viewer, shared(status(StatusLevel::error, error.what())), page::Worth::stream);
  }
}

void FoxgloveSubject::subscribe(page::ViewerId viewer, const Subscription& wish, page::Viewers& viewers) {
  const std::size_t channels = options_.topics.size();
  if (wish.channel == 0 || wish.channel > channels) {
    throw std::invalid_argument("there is no channel " + std::to_string(wish.channel) + "; accepted are 1 to " +
                                std::to_string(channels));
  }
  const record::Topic topic = options_.topics[wish.channel - 1];
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return;  // it has left, while the scene was sent to it
  Subscriptions& has = found->second;
  if (std::ranges::any_of(has, [topic](const auto& one) { return one.second == topic; })) {
    throw std::invalid_argument("channel " + std::to_string(wish.channel) + " has a subscription already");
  }
  if (!has.emplace(wish.id, topic).second) {
    throw std::invalid_argument("subscription " + std::to_string(wish.id) +
                                " is there already; accepted is another id");
  }
  if (topic != record::Topic::scene || scene_.empty()) return;
  const record::TopicMessage message{.topic = topic, .at = scene_at_, .content = scene_};
  viewers.send_binary(viewer, shared(message_data(wish.id, message)), worth_of(topic));
}

void FoxgloveSubject::receive_binary(page::ViewerId viewer, std::string_view content, page::Viewers& viewers) {
  Answer answer{.viewer = viewer};
  try {
    const Call call = read_binary(content);
    answer.number = call.number;
    const std::size_t services = options_.services.size();
    if (call.number.service == 0 || call.number.service > services) {
      answer.refusal = services == 0 ? "there are no services here"
                                     : "there is no service " + std::to_string(call.number.service) +
                                           "; accepted are 1 to " + std::to_string(services);
      return send(answer, viewers);
    }
    if (call.encoding != kJson) {
      answer.refusal = "encoding is '" + shown(call.encoding) + "'; accepted is json";
      return send(answer, viewers);
    }
    const std::uint64_t number = ++last_call_;
    calls_.emplace(number, answer);
    source_.call(number, options_.services[call.number.service - 1], call.request);
  } catch (const std::invalid_argument& error) {
    viewers.send(viewer, shared(status(StatusLevel::error, error.what())), page::Worth::stream);
  }
}

void FoxgloveSubject::answer(std::uint64_t number, const std::string& refusal) {
  auto call = calls_.extract(number);
  if (call.empty()) return;
  call.mapped().refusal = refusal;
  answers_.push_back(std::move(call.mapped()));
}

void FoxgloveSubject::send(const Answer& answer, page::Viewers& viewers) {
  if (answer.refusal.empty()) {
    viewers.send_binary(answer.viewer, shared(call_response(answer.number)), page::Worth::needed);
  } else {
    viewers.send(answer.viewer, shared(call_failure(answer.number, answer.refusal)), page::Worth::needed);
  }
}

bool FoxgloveSubject::wants(record::Topic topic) const noexcept {
  if (topic == record::Topic::scene) return !viewers_.empty();
  return std::ranges::any_of(viewers_, [topic](const auto& viewer) {
    return std::ranges::any_of(viewer.second, [topic](const auto& one) { return one.second == topic; });
  });
}

void FoxgloveSubject::take(const record::TopicMessage& message) {
  if (message.topic == record::Topic::scene) {
    scene_ = message.content;
    scene_at_ = message.at;
  }
  // Viewers may leave while something is sent to them.
  receivers_.clear();
  for (const auto& [viewer, subscriptions] : viewers_) {
    for (const auto& [id, topic] : subscriptions) {
      if (topic == message.topic) receivers_.emplace_back(viewer, id);
    }
  }
  for (const auto& [viewer, id] : receivers_) {
    to_->send_binary(viewer, shared(message_data(id, message)), worth_of(message.topic));
  }
}

void FoxgloveSubject::beat(page::Viewers& viewers) {
  to_ = &viewers;
  source_.write_new(encoder_, !viewers_.empty());
  for (const Answer& answer : std::exchange(answers_, {})) send(answer, viewers);
}

}  // namespace forcebound::live
