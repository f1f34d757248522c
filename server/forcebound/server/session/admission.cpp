#include "forcebound/server/session/admission.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/text/names.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/wire/version_mismatch.hpp"

namespace forcebound::server {
namespace {

using text::printable;
using wire::RefusalReason;

// Limits on the motion rate that a client can promise.
constexpr double kPeriodLeast_s = 100e-6;
constexpr double kPeriodMost_s = 1;

// Of a session: a client repeats its Hello no faster, and a network may hold some up and deliver them together.
constexpr Nanoseconds kRepeatedHelloInterval = std::chrono::milliseconds{50};
constexpr int kRepeatedHellosAtOnce = 20;

double believed_period_s(const wire::Hello& hello) { return std::clamp(hello.period_s, kPeriodLeast_s, kPeriodMost_s); }

// A server-side law exchanges the environment's force through the network: it needs all of it from here.
bool renders_locally(const wire::Hello& hello) noexcept { return hello.renders_locally && hello.server_law.empty(); }

/// @throws std::exception with the reason if the environment cannot be made
MadeEnvironment make_for(const wire::Hello& hello, const EnvironmentKind& kind) {
  MadeEnvironment made = kind.make({.device = printable(hello.device),
                                    .degrees_of_freedom = hello.degrees_of_freedom,
                                    .period_s = believed_period_s(hello),
                                    .force_N_max = hello.force_N_max,
                                    .round_trip = hello.round_trip,
                                    .renders_locally = renders_locally(hello),
                                    .shows_torque = hello.shows_torque});
  if (!made.environment) throw std::runtime_error("its maker returned none");
  return made;
}

// Burst: one second's worth of motion may arrive at once after a network delay.
int burst(double period_s) { return std::max(16, static_cast<int>(1 / period_s)); }

/// What a session needs once it is open is less than this, so that there is memory for it and for those that are.
constexpr std::size_t kSpareBytes = std::size_t{4} << 20U;

/// @throws std::bad_alloc if less is left
void expect_spare_memory() {
  const std::unique_ptr<char[]> spare(new char[kSpareBytes]);
  // Written to, lest the compiler leave it out.
  static_cast<volatile char*>(spare.get())[0] = 0;
}

std::string refusal_of_rights(const ClientRights& rights, std::string_view scene) {
  return "client '" + printable(rights.name) + "' may not use scene '" + printable(scene) +
         "' (allowed: " + printable(text::join(rights.scenes)) + ")";
}

/// The least time between motions that are answered, in the mean [s].
double answered_every_s(double period_s, double motions_per_promised, const ClientRights& rights) {
  constexpr double kMost_s = 3600;  // so that a token bucket can count it
  const double interval_s = period_s / motions_per_promised;
  if (!rights.motions_per_s_max) return interval_s;
  return std::max(interval_s, std::min(1 / *rights.motions_per_s_max, kMost_s));
}

/// A server-side law accounts for the tip's motion. At the client the force acts at the grip, and its torque about that
/// takes up the difference only where there are motors for it.
bool is_law_of_wrong_point(const wire::Hello& hello, const MadeEnvironment& made) noexcept {
  return !hello.server_law.empty() && made.tool_m.rows() > 0 && !hello.shows_torque;
}

std::string refusal_of_law(const wire::Hello& hello, const std::string& scene) {
  return "scene '" + scene + "' has a tool in the hand ([tool]), for which the law '" + printable(hello.server_law) +
         "' needs a device that shows torque: use a law without a server-side law, or a scene without a tool";
}

std::string refusal_for_now(const std::string& scene, std::string_view why) {
  return "scene '" + scene + "' is not available at the moment: " + std::string(why);
}

std::string refusal_of_server_law(const control::LawRegistry& laws, std::string_view law) {
  std::vector<std::string> known = laws.names();
  std::erase_if(known, [&](const std::string& name) { return !laws.find(name).make_server_side; });
  return "this server has no server-side law '" + printable(law) +
         "' (known: " + (known.empty() ? "none" : text::join(known)) + ")";
}

std::string refusal_of_dof(const EnvironmentKind& kind, const wire::Hello& hello) {
  return "scene '" + kind.name + "' accepts devices with " + kind.accepted_degrees_of_freedom() +
         " degrees of freedom, device '" + printable(hello.device) + "' has " +
         std::to_string(hello.degrees_of_freedom);
}

}  // namespace

Admission::Admission(const ServerOptions& options, EnvironmentLibrary environments, const Parts& parts, Nanoseconds now)
    : options_(options),
      environments_(std::move(environments)),
      parts_(parts),
      memory_(options.memory),
      hellos_(options.hellos_per_s_max, now, parts.random()) {}

Decision Admission::decide(const wire::Hello& hello, const Sender& sender, Nanoseconds now) {
  // A client with a session is answered even while untrusted clients use up the rate.
  if (Session* const session = parts_.table.find(sender.address, hello.client_nonce)) {
    if (!session->hellos.take(now)) {
      ++parts_.counters.hellos_over_rate;
      return Unanswered{};
    }
    ++parts_.counters.hellos_repeated;
    return LetIn{.session = *session, .repeated = true};
  }
  if (is_dropped(hello, sender, now)) return Unanswered{};
  const std::string_view scene = hello.scene.empty() ? std::string_view{options_.scene} : hello.scene;
  if (auto refused = refusal_to_ask(hello, sender.rights, scene)) return *std::move(refused);
  auto wanted = environments_.request(scene);
  if (wanted.coming) {
    // Compiling here would delay the answers of other sessions; the client repeats its Hello.
    ++parts_.counters.hellos_too_early;
    return Unanswered{};
  }
  if (!wanted.why_not.empty()) {
    return Refused{RefusalReason::server_full, refusal_for_now(printable(hello.scene), wanted.why_not)};
  }
  if (!wanted.found) {
    return Refused{RefusalReason::unknown_scene, environments_.unknown_text(printable(hello.scene))};
  }
  return decide_place(hello, std::move(wanted.found), sender, now);
}

bool Admission::is_dropped(const wire::Hello& hello, const Sender& sender, Nanoseconds now) noexcept {
  if (is_over_rate(sender, now)) {
    ++parts_.counters.hellos_over_rate;
    return true;
  }
  if (parts_.table.has_ended(sender.address, hello.client_nonce)) {
    ++parts_.counters.hellos_after_bye;
    return true;
  }
  return false;
}

bool Admission::is_over_rate(const Sender& sender, Nanoseconds now) noexcept {
  if (sender.judged) return false;
  SharedLimits* const limits = options_.worker.limits;
  return limits != nullptr ? !limits->take_hello(sender.rights.key, sender.address, now)
                           : !hellos_.take(sender.rights.key, sender.address, now);
}

std::optional<Refused> Admission::refusal_to_ask(const wire::Hello& hello, const ClientRights& rights,
                                                 std::string_view scene) {
  if (hello.protocol_version != wire::kProtocolVersion) {
    ++parts_.counters.hellos_of_other_versions;
    const wire::VersionMismatch mismatch(wire::kProtocolVersion, hello.protocol_version);
    return Refused{RefusalReason::version_mismatch, std::string(mismatch.text())};
  }
  if (!admits_none_.empty()) return Refused{RefusalReason::server_full, admits_none_};
  if (!is_offered(hello.scene)) return Refused{RefusalReason::unknown_scene, refusal_of_scene(hello.scene)};
  if (!rights.may_use(scene)) return Refused{RefusalReason::unknown_scene, refusal_of_rights(rights, scene)};
  return std::nullopt;
}

Decision Admission::decide_place(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind,
                                 const Sender& sender, Nanoseconds now) {
  if (const std::size_t home = options_.worker.home_of(kind->name);
      kind->sessions_max > 0 && home != options_.worker.number) {
    return Elsewhere{home};
  }
  if (auto refused = refusal_of_device(hello, *kind)) return *std::move(refused);
  if (auto no_room = parts_.capacity.refusal_of(*kind, sender, now)) {
    if (!no_room->place_soon) return Refused{RefusalReason::server_full, std::move(no_room->text)};
    ++parts_.counters.hellos_too_early;
    return Unanswered{};
  }
  if (kind->wants_round_trip && hello.round_trip <= Nanoseconds{0}) return RoundTripWanted{};
  return let_in(hello, std::move(kind), sender, now);
}

std::optional<Refused> Admission::refusal_of_device(const wire::Hello& hello, const EnvironmentKind& kind) const {
  if (!kind.accepts(hello.degrees_of_freedom)) {
    return Refused{RefusalReason::wrong_degrees_of_freedom, refusal_of_dof(kind, hello)};
  }
  if (!hello.server_law.empty() &&
      !options_.laws.make_server_side(hello.server_law, static_cast<int>(hello.degrees_of_freedom))) {
    return Refused{RefusalReason::unknown_server_law, refusal_of_server_law(options_.laws, hello.server_law)};
  }
  return std::nullopt;
}

Decision Admission::let_in(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, const Sender& sender,
                           Nanoseconds now) {
  const std::string name = kind->name;
  const auto refused_for_memory = [](MemoryBudget::Refusal too_much) {
    return Refused{too_much.for_now ? RefusalReason::server_full : RefusalReason::unknown_scene,
                   std::move(too_much.text)};
  };
  try {
    std::unique_lock<std::mutex> making;
    if (options_.worker.limits != nullptr && memory_.measures()) {
      making = options_.worker.limits->try_making();
      if (!making) {  // waiting for another worker's scene would delay the answers of other sessions
        ++parts_.counters.hellos_too_early;
        return Unanswered{};
      }
    }
    if (auto too_much = memory_.refusal_of(name); !too_much.text.empty()) return refused_for_memory(too_much);
    const std::size_t before = memory_.in_use();
    MadeEnvironment made = make_for(hello, *kind);
    if (is_law_of_wrong_point(hello, made)) {
      return Refused{RefusalReason::unknown_server_law, refusal_of_law(hello, name)};
    }
    expect_spare_memory();
    if (auto too_much = memory_.refusal_of_made(name, before); !too_much.text.empty()) {
      return refused_for_memory(too_much);
    }
    return LetIn{.session = open(hello, std::move(kind), std::move(made), sender, now), .repeated = false};
  } catch (const std::bad_alloc&) {
    return Refused{RefusalReason::server_full, refusal_for_now(name, kNoMemory)};
  } catch (const std::exception& error) {
    return Refused{RefusalReason::server_full, refusal_for_now(name, error.what())};
  }
}

bool Admission::is_offered(std::string_view scene) const {
  return options_.scenes.empty() || scene.empty() || scene == options_.scene ||
         std::ranges::find(options_.scenes, scene) != options_.scenes.end();
}

std::string Admission::refusal_of_scene(std::string_view scene) const {
  std::string known = options_.scene;
  for (const std::string& name : options_.scenes) {
    if (name != options_.scene) known += ", " + name;
  }
  return "this server does not offer scene '" + printable(scene) + "' (offered: " + known + ")";
}

std::uint64_t Admission::new_session_number() {
  std::uint64_t number = parts_.random();
  // Zero means "no session" on the wire.
  while (number == 0 || !options_.worker.owns(number) || parts_.table.find(number) != nullptr) number = parts_.random();
  return number;
}

const Session& Admission::open(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind,
                               MadeEnvironment made, const Sender& sender, Nanoseconds now) {
  const std::uint64_t id = new_session_number();
  SharedLimits::Place place = parts_.capacity.place_for(id, sender);
  const double period_s = believed_period_s(hello);
  const double interval_s = answered_every_s(period_s, options_.motions_per_promised, sender.rights);
  SessionInfo info{.session = id,
                   .address = sender.address,
                   .device = printable(hello.device),
                   .degrees_of_freedom = hello.degrees_of_freedom,
                   .scene = kind->name,
                   .client = printable(sender.rights.name),
                   .choice = made.choice};
  Session session{.info = std::move(info),
                  .nonce = hello.client_nonce,
                  .kind = std::move(kind),
                  .made = std::move(made),
                  .place = std::move(place),
                  .server_side = {.law = options_.laws.make_server_side(hello.server_law,
                                                                        static_cast<int>(hello.degrees_of_freedom))},
                  .rate = time::TokenBucket(time::from_seconds(interval_s), burst(std::max(period_s, interval_s)), now),
                  .hellos = time::TokenBucket(kRepeatedHelloInterval, kRepeatedHellosAtOnce, now),
                  .last_received = now,
                  .last_moved = now,
                  .proven_at = sender.address,
                  .compute = ComputeShare(options_.session_compute_max, now)};
  session.arrivals.counts.session = id;
  // What it may send is not what is answered: its numbers go on meanwhile.
  session.arrivals.motions_per_s_max = options_.motions_per_promised / period_s;
  session.client = sender.rights.key;
  session.wants_models = renders_locally(hello);
  if (session.wants_models && session.made.packed)
    session.sender = std::make_unique<SceneSender>(session.made.packed, options_.handover, now);
  if (hello.shows_scene) {
    auto appearance =
        session.made.environment->appearance(session.sender ? view::Which::not_handed_over : view::Which::all);
    if (appearance) session.view = std::make_unique<ViewSender>(std::move(appearance), options_.view, now);
  }
  const Session& opened = parts_.table.open(std::move(session));
  parts_.capacity.count_opened();
  return opened;
}

}  // namespace forcebound::server
