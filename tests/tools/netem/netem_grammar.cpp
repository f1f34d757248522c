#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/netem/loss_model.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/netem_values.hpp"

namespace forcebound::netem {
namespace {

using netem::parse_integer;

constexpr std::int64_t kSlotNumberMax = 0x7fffffff;
constexpr std::int64_t kRateBytesMax = 10'000;  // more than any link layer adds; keeps sums of bits within 64 bits

/// Takes the words one by one, and keeps them as they were understood.
class Words {
 public:
  explicit Words(std::string_view line) : words_(text::split_at_blanks(line)) {}

  [[nodiscard]] bool empty() const { return next_ == words_.size(); }
  [[nodiscard]] bool next_is(std::string_view word) const { return !empty() && words_[next_] == word; }
  [[nodiscard]] bool next_is_number() const { return !empty() && netem::looks_like_number(words_[next_]); }

  std::string_view take(std::string_view meaning) {
    if (empty()) throw std::invalid_argument("the line ends where " + std::string(meaning) + " is expected");
    understood_.append(understood_.empty() ? "" : " ").append(words_[next_]);
    return words_[next_++];
  }

  [[nodiscard]] std::string_view last() const { return words_.at(next_ - 1); }

  /// Of the number that was taken last: what it means without a unit.
  void complete(std::string_view unit) {
    const char last = understood_.back();
    if ((last >= '0' && last <= '9') || last == '.') understood_.append(unit);
  }

  [[nodiscard]] const std::string& understood() const { return understood_; }

 private:
  std::vector<std::string_view> words_;
  std::size_t next_ = 0;
  std::string understood_;
};

class Grammar {
 public:
  explicit Grammar(std::string_view line) : words_(line) {}

  NetemParameters read() {
    while (!words_.empty()) read_one();
    check_together();
    return result_;
  }

  [[nodiscard]] const std::string& understood() const { return words_.understood(); }

 private:
  struct Keyword {
    std::string_view word;
    void (Grammar::*read)();
  };

  void read_one() {
    static constexpr std::array<Keyword, 10> kKeywords{{{"delay", &Grammar::delay},
                                                        {"distribution", &Grammar::distribution},
                                                        {"loss", &Grammar::loss},
                                                        {"duplicate", &Grammar::duplicate},
                                                        {"corrupt", &Grammar::corrupt},
                                                        {"reorder", &Grammar::reorder},
                                                        {"gap", &Grammar::gap},
                                                        {"rate", &Grammar::rate},
                                                        {"limit", &Grammar::limit},
                                                        {"slot", &Grammar::slot}}};
    const std::string_view word = words_.take("a netem word");
    const auto keyword =
        std::find_if(kKeywords.begin(), kKeywords.end(), [&](const Keyword& k) { return k.word == word; });
    if (keyword == kKeywords.end() && is_unit(word))
      throw std::invalid_argument("'" + std::string(word) +
                                  "' stands apart from its number: expected both together, such as 50ms, 5% or 1Mbit "
                                  "(units: s, ms, us and ns; %; bit or bps, also with k, M, G or T)");
    if (keyword == kKeywords.end())
      throw std::invalid_argument("'" + std::string(word) +
                                  "' is not a netem word: expected delay, distribution, loss, duplicate, corrupt, "
                                  "reorder, gap, rate, limit or slot");
    if (!said_.insert(word).second)
      throw std::invalid_argument("'" + std::string(word) + "' is given twice: expected once");
    (this->*keyword->read)();
  }

  Nanoseconds time(std::string_view expected, std::string_view meaning) {
    const Nanoseconds value = parse_time(words_.take(expected), meaning);
    words_.complete("us");
    return value;
  }

  Share percent(std::string_view expected, std::string_view meaning) {
    const Share value = parse_percent(words_.take(expected), meaning);
    words_.complete("%");
    return value;
  }

  Chance chance(std::string_view what) {
    Chance result{percent("a percentage for " + std::string(what), std::string(what) + " percentage"), 0};
    result.correlation = optional_percent(std::string(what) + " correlation", 0);
    return result;
  }

  Share optional_percent(const std::string& meaning, Share otherwise) {
    return words_.next_is_number() ? percent(meaning, meaning) : otherwise;
  }

  void delay() {
    result_.delay.mean = time("a time for delay", "delay time");
    if (!words_.next_is_number()) return;
    result_.delay.jitter = time("jitter", "delay jitter");
    result_.delay.correlation = optional_percent("delay correlation", 0);
  }

  void distribution() {
    const std::string_view name = words_.take("the name of a distribution");
    if (name == "normal") {
      result_.delay.shape = DelayShape::normal;
    } else if (name == "pareto") {
      result_.delay.shape = DelayShape::pareto;
    } else if (name == "paretonormal") {
      result_.delay.shape = DelayShape::paretonormal;
    } else {
      throw std::invalid_argument("'" + std::string(name) +
                                  "' is not a distribution: expected normal, pareto or paretonormal (for a uniform one "
                                  "leave the word out)");
    }
  }

  void loss() {
    if (words_.next_is("gemodel")) return gemodel();
    if (words_.next_is("state")) return state();
    if (words_.next_is("random")) words_.take("random");
    if (!words_.empty() && !words_.next_is_number())
      throw std::invalid_argument("'" + std::string(words_.take("")) +
                                  "' is not a loss model: expected a percentage, random, gemodel or state");
    result_.loss = RandomLoss{chance("loss")};
  }

  void gemodel() {
    words_.take("gemodel");
    GilbertElliottLoss model;
    model.good_to_bad = percent("P of loss gemodel", "P of loss gemodel");
    model.bad_to_good = optional_percent("R of loss gemodel", kCertain - model.good_to_bad);
    model.bad_loss = optional_percent("1-H of loss gemodel", kCertain);
    model.good_loss = optional_percent("1-K of loss gemodel", 0);
    result_.loss = model;
  }

  void state() {
    words_.take("state");
    FourStateLoss model;
    model.p13 = percent("P13 of loss state", "P13 of loss state");
    model.p31 = optional_percent("P31 of loss state", kCertain - model.p13);
    model.p32 = optional_percent("P32 of loss state", 0);
    model.p23 = optional_percent("P23 of loss state", kCertain);
    model.p14 = optional_percent("P14 of loss state", 0);
    result_.loss = model;
  }

  void duplicate() { result_.duplicate = chance("duplicate"); }
  void corrupt() { result_.corrupt = chance("corrupt"); }
  void reorder() { result_.reorder.chance = chance("reorder"); }

  void gap() {
    result_.reorder.gap = static_cast<std::uint32_t>(parse_integer(words_.take("a number for gap"), "gap", 1));
  }

  void rate() {
    Rate& rate = result_.rate;
    rate.bits_per_second = parse_rate(words_.take("a rate"), "rate");
    words_.complete("bit");
    if (words_.next_is_number())
      rate.packet_overhead_bytes = static_cast<std::int32_t>(
          parse_integer(words_.take("overhead"), "packet overhead of rate", -kRateBytesMax, kRateBytesMax));
    if (words_.next_is_number())
      rate.cell_bytes =
          static_cast<std::uint32_t>(parse_integer(words_.take("cell"), "cell size of rate", 0, kRateBytesMax));
    if (words_.next_is_number())
      rate.cell_overhead_bytes = static_cast<std::int32_t>(
          parse_integer(words_.take("cell overhead"), "cell overhead of rate", -kRateBytesMax, kRateBytesMax));
  }

  void limit() {
    result_.limit_packets =
        static_cast<std::uint32_t>(parse_integer(words_.take("a number for limit"), "limit in packets", 0));
  }

  void slot() {
    Slot& slot = result_.slot;
    slot.shortest = time("a time for slot", "shortest slot");
    slot.longest = slot.shortest;
    if (words_.next_is_number()) {
      slot.longest = time("longest slot", "longest slot");
      if (slot.longest < slot.shortest)
        throw std::invalid_argument("'" + std::string(words_.last()) +
                                    "' is shorter than the shortest slot: expected at least " +
                                    std::to_string(slot.shortest.count()) + "ns");
    }
    if (words_.next_is("packets")) slot.packets = slot_number("packets");
    if (words_.next_is("bytes")) slot.bytes = slot_number("bytes");
  }

  std::uint64_t slot_number(std::string_view word) {
    words_.take(word);
    const std::string meaning = std::string(word) + " of slot";
    return static_cast<std::uint64_t>(parse_integer(words_.take(meaning), meaning, 0, kSlotNumberMax));
  }

  void check_together() {
    const Delay& delay = result_.delay;
    if (said_.contains("distribution") && (delay.mean.count() == 0 || delay.jitter.count() == 0))
      throw std::invalid_argument(
          "'distribution' needs a delay and a jitter: expected for example 'delay 50ms 10ms distribution normal'");
    const bool reorders = result_.reorder.chance.probability != 0;
    if (reorders && delay.mean.count() == 0)
      throw std::invalid_argument("'reorder' needs a delay: expected for example 'delay 10ms reorder 25% gap 5'");
    if (said_.contains("gap") && !reorders)
      throw std::invalid_argument("'gap' needs reorder: expected for example 'delay 10ms reorder 25% gap 5'");
    if (reorders && result_.reorder.gap == 0) result_.reorder.gap = 1;
  }

  Words words_;
  std::set<std::string_view> said_;
  NetemParameters result_;
};

double percent_of(Share share) { return 100.0 * share / kCertain; }

}  // namespace

NetemParameters parse_netem(std::string_view words) { return Grammar(words).read(); }

std::string with_units(std::string_view words) {
  Grammar grammar(words);
  (void)grammar.read();
  return grammar.understood();
}

std::vector<std::string> netem_warnings(const NetemParameters& parameters) {
  const auto* random_loss = std::get_if<RandomLoss>(&parameters.loss);
  if (random_loss == nullptr || random_loss->chance.probability == 0 || random_loss->chance.correlation == 0) return {};
  return {"loss " + text::rounded(percent_of(random_loss->chance.probability), 6) + "% with correlation " +
          text::rounded(percent_of(random_loss->chance.correlation), 6) + "% really loses about " +
          text::rounded(percent_of(measured_loss(parameters.loss)), 2) +
          "%, since correlating the draws pulls them to the middle; for loss in bursts use 'loss gemodel'"};
}

std::string_view netem_help() noexcept {
  return "  delay TIME [JITTER [CORR]] [distribution normal|pareto|paretonormal]\n"
         "  loss [random] PCT [CORR] | loss gemodel P [R [1-H [1-K]]] |\n"
         "    loss state P13 [P31 [P32 [P23 [P14]]]]\n"
         "  duplicate PCT [CORR]\n"
         "  corrupt PCT [CORR]\n"
         "  reorder PCT [CORR] [gap N]\n"
         "  rate RATE [OVERHEAD [CELL [CELL_OVERHEAD]]]\n"
         "  limit N\n"
         "  slot MIN [MAX] [packets N] [bytes N]\n"
         "A time without a unit is microseconds. Jitter without a distribution is uniform. The queue holds 1000 "
         "packets unless limit says otherwise.";
}

}  // namespace forcebound::netem
