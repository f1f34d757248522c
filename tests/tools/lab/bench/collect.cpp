#include "tests/tools/lab/bench/collect.hpp"

#include <array>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "forcebound/text/file.hpp"
#include "tests/tools/lab/bench/readings.hpp"
#include "tests/tools/lab/trials/percentile.hpp"

namespace forcebound::lab {
namespace {

namespace fs = std::filesystem;

constexpr double kPeriod_us = 1000;

/// A pair of benchmarks to compare.
struct Beside {
  const char* what;
  const char* ours;
  const char* yardstick;
  const char* theirs;
  const char* wanted = "";
};

constexpr Beside kBeside[]{
    {"law fba-exact: a step of 3 axes", "law_step/fba_exact/3", "no law", "law_step/none/3"},
    {"god object on 70224 triangles", "god_object_slides/depth_um:1000", "Embree: one query",
     "embree_nearest_point/triangles:70224"},
    {"nearest point of 70224 triangles", "our_nearest_point/triangles:70224", "Embree",
     "embree_nearest_point/triangles:70224"},
    {"nearest point of 70224 triangles", "our_nearest_point/triangles:70224", "FCL",
     "fcl_nearest_point/triangles:70224"},
    {"three fields", "three_fields", "by hand in Eigen", "three_fields_in_eigen"},
    {"stack of 20 boxes", "our_step/boxes:20", "mj_step", "mujocos_step/boxes:20"},
    {"600 tetrahedra: a sphere pressed in", "sphere_step/radius_mm:20/depth_mm:10", "eight sparse solves",
     "eight_sparse_solves/tetrahedra:600"},
    {"600 tetrahedra: bent far and sliding", "corotational_step/tetrahedra:600", "eight sparse solves",
     "eight_sparse_solves/tetrahedra:600"},
    {"a client's tick with --record", "tick/recorded", "without", "tick/plain"},
    {"a client's tick: a plane locally", "plane/local", "remote rendering", "plane/remote"},
    {"a client's tick: the same encrypted", "plane/local/encrypted", "not encrypted", "plane/local"},
    {"a motion's 64 bytes sealed", "seal/64", "copy and checksum", "copy_and_checksum/64"},
    {"a motion's 64 bytes sealed and opened", "seal_and_open/64", "copy and checksum", "copy_and_checksum/64"},
};

struct Growing {
  const char* what;
  const char* size;
  const char* ours;
  const char* yardstick = "";
  const char* theirs = "";
};

constexpr Growing kGrowing[]{
    {"server: one motion", "clients", "server_motion"},
    {"law fba-exact: a step", "degrees of freedom", "law_step/fba_exact"},
    {"law fba-more: a step", "degrees of freedom", "law_step/fba_more"},
    {"nearest point", "triangles", "our_nearest_point", "Embree", "embree_nearest_point"},
    {"nearest point", "triangles", "our_nearest_point", "FCL", "fcl_nearest_point"},
    {"tissue bent far: a point's step", "tetrahedra", "corotational_step", "Eigen: eight sparse solves",
     "eight_sparse_solves"},
    {"stack of boxes", "boxes", "our_step", "mj_step", "mujocos_step"},
};

std::string text_of(const fs::path& file) { return text::read_file(file.string()); }

/// Reads a file; errors name it.
template <class Read>
auto read_from(const fs::path& file, Read read) {
  const std::string content = text_of(file);
  try {
    return read(content);
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

double number_at(const std::string& json, const char* path) {
  return nlohmann::json::parse(json).at(nlohmann::json::json_pointer(path)).get<double>();
}

/// One number of each run, out of the files called N-NAME.
std::vector<double> of_runs(const fs::path& folder, const std::string& name,
                            const std::function<double(const std::string&)>& read) {
  std::vector<double> values;
  for (int run = 1; fs::exists(folder / (std::to_string(run) + "-" + name)); ++run) {
    values.push_back(read_from(folder / (std::to_string(run) + "-" + name), read));
  }
  if (values.empty()) throw std::runtime_error("no run '1-" + name + "' in " + folder.string());
  return values;
}

std::vector<double> of_runs(const fs::path& folder, const std::string& name, const char* json_path) {
  return of_runs(folder, name, [&](const std::string& json) { return number_at(json, json_path); });
}

std::vector<double> beyond_period(std::vector<double> periods_us) {
  for (double& period : periods_us) period -= kPeriod_us;
  return periods_us;
}

constexpr const char* kAwake = "processors kept awake";

/// `state` is "awake" or "asleep", as the files are called.
void add_round_trips(const fs::path& folder, const std::string& state, const char* conditions,
                     std::array<const char*, 2> wanted, std::vector<BenchRow>& rows) {
  const auto sockperfs = [&](auto member) {
    return of_runs(folder, state + "-sockperf.txt",
                   [&](const std::string& text) { return read_sockperf(text).*member; });
  };
  const auto p50_us = sockperfs(&Sockperf::p50_us);
  const auto p99_us = sockperfs(&Sockperf::p99_us);
  const auto ours = [&](const char* path) { return of_runs(folder, state + "-ours.json", path); };
  rows.push_back(
      turns_row("round trip: median", "us", conditions, ours("/read_us/p50"), "sockperf ping-pong", p50_us, wanted[0]));
  rows.push_back(
      turns_row("round trip: p99", "us", conditions, ours("/read_us/p99"), "sockperf ping-pong", p99_us, wanted[1]));
  for (const auto& [what, path] : {std::pair{"median", "/read_us/p50"}, {"p99", "/read_us/p99"}}) {
    rows.push_back(turns_row(std::string("encrypted round trip: ") + what, "us", conditions,
                             of_runs(folder, state + "-encrypted.json", path), "not encrypted", ours(path)));
  }
  if (state != "awake") return;
  // The client keeps the processors awake by itself.
  rows.push_back(turns_row("client's round trip: median", "us", conditions,
                           of_runs(folder, "client.json", "/rtt_us/p50"), "sockperf ping-pong", p50_us));
  rows.push_back(turns_row("client's round trip: p99", "us", conditions, of_runs(folder, "client.json", "/rtt_us/p99"),
                           "sockperf ping-pong", p99_us));
  for (const auto& [what, path] : {std::pair{"median", "/rtt_us/p50"}, {"p99", "/rtt_us/p99"}}) {
    rows.push_back(turns_row(std::string("client's encrypted round trip: ") + what, "us", conditions,
                             of_runs(folder, "client-encrypted.json", path), "not encrypted",
                             of_runs(folder, "client.json", path)));
  }
}

void add_periods(const fs::path& folder, std::vector<BenchRow>& rows) {
  const auto cyclictest_us = of_runs(folder, "cyclictest.txt", [](const std::string& text) {
    return percentile(periods_us(kPeriod_us, read_cyclictest_us(text)), 0.999) - kPeriod_us;
  });
  rows.push_back(turns_row("tick's period beyond 1 ms: p99.9", "us", kAwake,
                           beyond_period(of_runs(folder, "client.json", "/period_us/p999")), "cyclictest",
                           cyclictest_us, "<= 1.2"));
  // A thread beside the tick that only sleeps: where it is late too, the machine is.
  rows.push_back(turns_row("idle timer beyond 1 ms: p99.9", "us", kAwake,
                           beyond_period(of_runs(folder, "client.json", "/idle_timer/period_us/p999")), "cyclictest",
                           cyclictest_us));
}

/// What hand-over and local models cost the server, beside what it serves without them.
struct CapacityOf {
  const char* what;
  const char* scene;
};

constexpr CapacityOf kCapacities[]{
    {"most clients: a ball locally", "sphere"},
    {"most clients: tissue locally", "pad"},
    {"most clients: a dragged body locally", "block_and_stop"},
};

void add_capacity(const fs::path& folder, std::vector<BenchRow>& rows) {
  const auto clients = [&](const std::string& served) {
    return of_runs(folder, "capacity-" + served + ".json", "/clients");
  };
  rows.push_back(turns_row("most clients at 1 kHz on one core", "clients", kAwake, clients("sphere-remote"),
                           "plain echo server", clients("echo"), ">= 0.7"));
  rows.push_back(turns_row("most encrypted clients on one core", "clients", kAwake, clients("sphere-encrypted"),
                           "not encrypted", clients("sphere-remote")));
  for (const CapacityOf& capacity : kCapacities) {
    const std::string scene = capacity.scene;
    rows.push_back(turns_row(capacity.what, "clients", kAwake, clients(scene + "-local"), "remote rendering",
                             clients(scene + "-remote")));
  }
}

Benchmarks all_benchmarks(const fs::path& folder) {
  Benchmarks all;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.path().string().ends_with("_benchmark.json")) continue;
    all.merge(read_from(entry.path(), read_benchmarks));
  }
  return all;
}

void add_benchmarks(const fs::path& folder, std::vector<BenchRow>& rows) {
  const Benchmarks all = all_benchmarks(folder);
  const auto us = [&](const char* name) {
    const auto found = all.find(name);
    if (found == all.end()) throw std::runtime_error("no benchmark '" + std::string(name) + "' in " + folder.string());
    return 1e-3 * found->second;
  };
  for (const Beside& pair : kBeside) {
    rows.push_back(ratio_row(pair.what, "us", us(pair.ours), pair.yardstick, us(pair.theirs), pair.wanted));
  }
  const auto exponent = [&](const char* prefix) {
    try {
      return growth(by_size(all, prefix));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("benchmarks '" + std::string(prefix) + "/...': " + error.what());
    }
  };
  for (const Growing& one : kGrowing) {
    const bool alone = *one.yardstick == '\0';
    rows.push_back(growth_row(one.what, one.size, exponent(one.ours), one.yardstick, alone ? 0 : exponent(one.theirs)));
  }
}

}  // namespace

BenchResults collect(const fs::path& folder) {
  BenchResults results;
  std::istringstream machine(text_of(folder / "machine.txt"));
  for (std::string line; std::getline(machine, line);) {
    if (const std::size_t colon = line.find(": "); colon != std::string::npos) {
      results.machine.emplace_back(line.substr(0, colon), line.substr(colon + 2));
    }
  }
  if (fs::exists(folder / "1-awake-sockperf.txt"))
    add_round_trips(folder, "awake", kAwake, {"<= 1.1", "<= 1.2"}, results.rows);
  add_round_trips(folder, "asleep", "processors may sleep", {"", ""}, results.rows);
  add_periods(folder, results.rows);
  add_capacity(folder, results.rows);
  add_benchmarks(folder, results.rows);
  return results;
}

}  // namespace forcebound::lab
