#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kNowhere = "127.0.0.1:9";  // never contacted: every command here is refused before

struct Program {
  const char* path;
  const char* name;
};
const std::vector<Program> kPrograms = [] {
  std::vector<Program> programs{{kServer, "forcebound-server"},
                                {kRelay, "forcebound-relay"},
                                {kClient, "forcebound-client"},
                                {kLab, "forcebound-lab"},
                                {kForcebound, "forcebound"}};
  if (kRos2 != nullptr) programs.push_back({kRos2, "forcebound-ros2"});
  return programs;
}();

TEST(EveryProgram, PrintsItsHelp) {
  for (const Program& program : kPrograms) {
    SCOPED_TRACE(program.name);
    for (const char* option : {"--help", "-h"}) {
      const Ran ran = run(program.path, {option});
      EXPECT_EQ(ran.exit_code, 0);
      EXPECT_EQ(ran.err, "");
      EXPECT_THAT(ran.out, HasSubstr("Example"));
      EXPECT_THAT(ran.out, HasSubstr(std::string("  ") + program.name + " "));
      EXPECT_THAT(ran.out, HasSubstr("Exit code: 0 "));
    }
  }
}

TEST(EveryProgram, TellsOfNoExitCodeThatItNeverEndsWith) {
  for (const Program& program : kPrograms) {
    SCOPED_TRACE(program.name);
    const std::string name = program.name;
    const std::string help = unwrapped(run(program.path, {"--help"}).out);
    const auto tells = [&](const char* code) { return help.find(code, help.find("Exit code: ")) != std::string::npos; };
    const bool runs_device = name == "forcebound-client" || name == "forcebound-ros2";
    EXPECT_EQ(tells("3 NOT PASSIVE"), runs_device);
    EXPECT_EQ(tells("5 never connected"), runs_device);
    EXPECT_EQ(tells("6 driver crashed"), name != "forcebound-relay" && name != "forcebound-lab");
  }
}

TEST(EveryProgram, TellsItsVersion) {
  for (const Program& program : kPrograms) {
    const Ran ran = run(program.path, {"--version"});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_EQ(ran.out, std::string(program.name) + " " + FORCEBOUND_VERSION + "\n");
  }
}

TEST(EveryProgram, NamesAnUnknownOptionInOneLine) {
  for (const Program& program : kPrograms) {
    const Ran ran = run(program.path, {"--bogus"});
    EXPECT_EQ(ran.exit_code, 2) << program.name;
    EXPECT_THAT(ran.err, StartsWith(std::string(program.name) + ": "));
    EXPECT_THAT(ran.err, HasSubstr("--bogus"));
    EXPECT_EQ(lines(ran.err), 1U) << ran.err;
    EXPECT_EQ(ran.out, "");
  }
}

TEST(TheServer, SuggestsTheOptionsOfAClientThatFeelsTheScene) {
  const Ran sphere = run(kServer, {"--scene", "sphere", "--suggest"});
  EXPECT_EQ(sphere.exit_code, 0) << sphere.err;
  EXPECT_EQ(sphere.out, "--device omni --operator trace-sphere\n");
  EXPECT_EQ(run(kServer, {"--scene", "wall", "--suggest"}).out, "--device wall-1dof --operator press\n");
  EXPECT_EQ(run(kServer, {"--scene", "adhesion", "--suggest"}).out, "--device omni --operator stroke\n");
  const Ran unknown = run(kServer, {"--scene", "spere", "--suggest"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'sphere'?"));
}

struct Refusal {
  Words arguments;
  int exit_code;
  std::vector<std::string> said;  ///< what, where, and what would be accepted
};

/// Each is refused with one line on stderr and nothing on stdout.
void expect_refusals(const Program& program, const Words& always, const std::vector<Refusal>& refusals) {
  for (const Refusal& refusal : refusals) {
    Words words = refusal.arguments;
    words.insert(words.end(), always.begin(), always.end());
    SCOPED_TRACE(std::string(program.name) + " " + testing::PrintToString(words));
    const Ran ran = run(program.path, words);
    EXPECT_EQ(ran.exit_code, refusal.exit_code);
    EXPECT_EQ(ran.out, "");
    EXPECT_EQ(lines(ran.err), 1U) << ran.err;
    EXPECT_THAT(ran.err, StartsWith(std::string(program.name) + ": "));
    for (const std::string& part : refusal.said) EXPECT_THAT(ran.err, HasSubstr(part));
  }
}

TEST(TheServer, RefusesWhatItCannotUseInOneLine) {
  const TemporaryFolder folder;
  const std::string scene = folder.file("scene.toml");
  write_file(
      scene,
      "[scene]\nname = \"ball\"\ndescription = \"A ball.\"\ndegrees_of_freedom = 3\n[[object]]\nname = \"ball\"\n"
      "shape = { kind = \"sphere\", center_m = [0, 0, 0], radius_m = 0.02 }\neffects = [\"surface\"]\n\n"
      "[object.surface]\nstiffness_N_per_m = -200\n");
  const std::string no_toml = folder.file("no.toml");
  write_file(no_toml, "[scene]\nname = \n");
  expect_refusals(kPrograms[0], {},
                  {{{"--listen", "nonsense"}, 2, {"--listen", "'nonsense'", "127.0.0.1:47800"}},
                   {{"--listen", "127.0.0.1:99999"}, 2, {"'127.0.0.1:99999'", "from 0 to 65535"}},
                   {{"--listen", "no-such-host.invalid:1"}, 1, {"host 'no-such-host.invalid'"}},
                   {{"--listen", "192.0.2.1:47800", "--insecure"}, 1, {"192.0.2.1:47800", "no interface"}},
                   {{"--listen", "0.0.0.0:0"}, 2, {"--listen", "0.0.0.0:0", "keygen", "--clients", "--insecure"}},
                   {{"--listen", "[::]:0"}, 2, {"--listen", "[::]:0", "--psk", "--insecure"}},
                   {{"--key", "server.key"}, 2, {"--key", "anybody", "--clients", "--psk"}},
                   {{"--clients", scene}, 2, {"--clients", "--key"}},
                   {{"--insecure", "--psk", "shared.key"}, 2, {"--insecure", "does not go with", "--psk"}},
                   {{"--psk", "/no/such/shared.key"}, 1, {"/no/such/shared.key", "No such file"}},
                   {{"--psk", scene, "--record", scene}, 2, {"--record", scene, "would replace the file of --psk"}},
                   {{"--scene", "spere"}, 2, {"'spere'", "'sphere'", "(known: "}},
                   {{"--scene", scene}, 1, {scene + ":11: ", "object 'ball'", "stiffness_N_per_m", "> 0", "-200"}},
                   {{"--scene", no_toml}, 1, {no_toml + ":2: "}},
                   {{"--scene", "/no/such/scene.toml"}, 1, {"/no/such/scene.toml", "No such file"}},
                   {{"--scene"}, 2, {"--scene"}},
                   {{"--sessions-max", "0"}, 2, {"--sessions-max", "'0'", "1 to 10000"}},
                   {{"--idle-timeout", "soon"}, 2, {"--idle-timeout", "soon"}},
                   {{"--calibrate"}, 2, {"--calibrate", "--explain"}},
                   {{"--explain", "--suggest"}, 2, {"--explain", "does not go with", "--suggest"}},
                   {{"--schema", "--explain"}, 2, {"--explain", "does not go with", "--schema"}},
                   {{"--explain", "--record", "x.mcap"}, 2, {"--explain", "does not go with", "--record"}},
                   {{"--record", ""}, 2, {"--record", "must not be empty"}},
                   {{"--scene", scene, "--record", scene}, 2, {"--record", scene, "would replace the file of --scene"}},
                   {{"--explain", "--device-damping", "0"}, 2, {"--device-damping", "'0'"}},
                   {{"--explain", "--round-trip", "-1"}, 2, {"--round-trip", "'-1'"}},
                   {{"--scen", "wall"}, 2, {"unknown option '--scen', did you mean '--scene'?"}},
                   {{"sphere"}, 2, {"sphere"}}});
}

TEST(TheRelay, RefusesWhatItCannotUseInOneLine) {
  const TemporaryFolder folder;
  const std::string trace = folder.file("trace.csv");
  write_file(trace, "send_time_ms,rtt_ms\n0,10\n5,abc\n");
  expect_refusals(kPrograms[1], {"--listen", "127.0.0.1:0", "--upstream", kNowhere},
                  {{{"--netem", "delay 50msx"}, 2, {"--netem", "'50msx'", "50ms"}},
                   {{"--netem", "latency 50ms"}, 2, {"'latency'", "delay", "loss", "slot"}},
                   {{"--netem-up", "loss 200%"}, 2, {"--netem-up", "'200%'", "0% to 100%"}},
                   {{"--netem-down", "delay 1ms distribution normal"}, 2, {"--netem-down", "distribution"}},
                   {{"--seed", "-4"}, 2, {"--seed", "'-4'", "whole number"}},
                   {{"--trace", trace}, 1, {trace + ":3: ", "'5,abc'", "send_time_ms,rtt_ms"}},
                   {{"--trace", trace, "--log", trace}, 2, {"--log", trace, "would replace the file of --trace"}},
                   {{"--trace", "/no/such/trace"}, 1, {"/no/such/trace", "No such file"}},
                   {{"extra"}, 2, {"extra"}}});
  expect_refusals(kPrograms[1], {},
                  {{{"--listen", "here", "--upstream", kNowhere}, 2, {"--listen", "'here'", "127.0.0.1:47800"}},
                   {{"--listen", "127.0.0.1:0"}, 2, {"--upstream", "required"}},
                   {{"--listen", "0.0.0.0:9", "--upstream", kNowhere}, 2, {"--upstream", kNowhere, "--listen"}},
                   {{"--listen", "[::]:9", "--upstream", "[::1]:9"}, 2, {"--upstream", "[::1]:9", "--listen"}},
                   {{"--listen", kNowhere, "--upstream", "localhost:9"}, 2, {"--upstream", kNowhere, "--listen"}},
                   {{"--listen", "127.0.0.1:0", "--upstream", "here"}, 2, {"--upstream", "from 1 to 65535"}},
                   {{"--listen", "127.0.0.1:0", "--upstream", "127.0.0.1:0"}, 2, {"--upstream", "1 to 65535"}}});
}

TEST(TheClient, RefusesWhatItCannotUseInOneLine) {
  const TemporaryFolder folder;
  const std::string device = folder.file("device.toml");
  write_file(device,
             "kind = \"cartesian\"\ndegrees_of_freedom = 1\nmass_kg = -1\ndamping_N_s_per_m = 1\nforce_N_max = 1\n");
  const std::string hand = folder.file("hand.csv");
  write_file(hand, "time_s,x_m\n0,0\n1,two\n");
  const std::string laws = folder.file("laws.toml");
  write_file(laws, "[vc]\ncoupling_N_per_m = 60000\n\n[sfa]\nincrement = 1e-6\n");
  const std::string coupling = folder.file("coupling.toml");
  write_file(coupling, "[vc]\ncoupling_N_per_m = 60000\n");
  expect_refusals(kPrograms[2], {"--server", kNowhere, "--duration", "1"},
                  {{{"--device", device}, 1, {device + ":3: ", "mass_kg", "> 0", "-1"}},
                   {{"--device", "omny"}, 2, {"--device: ", "'omny'", "'omni'", "wall-1dof"}},
                   {{"--device", "/no/such/device.toml"}, 1, {"/no/such/device.toml", "No such file"}},
                   {{"--operator", "pres"}, 2, {"--operator: ", "'pres'", "'press'", "trace-circle"}},
                   {{"--operator", "press:depth=1"}, 2, {"--operator: ", "'press'", "'depth'", "from_m"}},
                   {{"--operator", "press:mass_kg=heavy"}, 2, {"mass_kg", "'heavy'"}},
                   {{"--operator", "press:mass_kg=-1"}, 2, {"mass_kg", ">= 0", "-1"}},
                   {{"--device", "wall-1dof", "--operator", "replay:" + hand}, 1, {hand + ":3: ", "'1,two'"}},
                   {{"--operator", "replay:/no/such/hand.csv"}, 1, {"/no/such/hand.csv", "No such file"}},
                   {{"--law", "fba"}, 2, {"--law", "unknown law 'fba'", "(known: none, fba-less, fba-more,"}},
                   {{"--law-parameters", laws}, 1, {laws + ":5: ", "law 'sfa'", "'increment'", "'increment_m'"}},
                   {{"--law-parameters", "/no/such/laws.toml"}, 1, {"/no/such/laws.toml", "No such file"}},
                   {{"--law", "vc", "--law-parameters", coupling}, 2, {"'wall-1dof'", "60000", "Kc T/2 + |Bc|"}},
                   {{"--law", "vc", "--device", "omni"}, 2, {"law 'vc'", "'omni' is an arm"}},
                   {{"--law-help", "vx"}, 2, {"--law-help", "unknown law 'vx', did you mean 'vc'?"}},
                   {{"--seed", "-1"}, 2, {"--seed", "'-1'", "whole number"}},
                   {{"--hold", "nan"}, 2, {"--hold", "'nan'", "from 0"}},
                   {{"--hold", "300", "--drop", "100"}, 2, {"--hold, --drop", "hold <= drop", "300 ms", "100 ms"}},
                   {{"--record", ""}, 2, {"--record", "must not be empty"}},
                   {{"--summary", ""}, 2, {"--summary", "must not be empty"}},
                   {{"--record", "x", "--summary", "./x"}, 2, {"--summary", "would replace the file of --record"}},
                   {{"--device", device, "--record", device}, 2, {"--record", "would replace the file of --device"}},
                   {{"--operator", "replay:" + hand + ",scale=2", "--record", hand}, 2, {hand, "--operator"}},
                   {{"--law-parameters", laws, "--summary", laws}, 2, {laws, "--law-parameters"}},
                   {{"--memory", "none"}, 2, {"--memory", "'none'", "capped, full"}},
                   {{"extra"}, 2, {"extra"}}});
  expect_refusals(kPrograms[2], {},
                  {{{"--duration", "1"}, 2, {"--server", "required"}},
                   {{"--server", "there"}, 2, {"--server", "'there'", "127.0.0.1:47800"}},
                   {{"--server", "127.0.0.1:0"}, 2, {"--server", "'127.0.0.1:0'", "1 to 65535"}},
                   {{"--server", kNowhere, "--duration", "-1"}, 2, {"--duration", "'-1'", "from 0"}},
                   {{"--server", kNowhere, "--duration", "long"}, 2, {"--duration", "'long'", "from 0"}}});
}

TEST(TheClient, TellsOfALawWithoutAServer) {
  const Ran ran = run(kClient, {"--law-help", "vc", "--device", "wall-1dof"}, 10s);
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.err, "");
  for (const char* part : {"Colgate", "coupling_N_per_m", "Standard values on 'wall-1dof'", "54000"}) {
    EXPECT_THAT(ran.out, HasSubstr(part));
  }
  EXPECT_THAT(run(kClient, {"--law-help", "vc", "--device", "omni"}, 10s).out, HasSubstr("But it refuses: "));
}

TEST(TheLab, RefusesWhatItCannotUseInOneLine) {
  expect_refusals(kPrograms[3], {},
                  {{{}, 2, {"command is required", "--help"}},
                   {{"dance"}, 2, {"unknown command 'dance'", "trials"}},
                   {{"reproduce", "spere"}, 2, {"'spere', did you mean 'sphere'?", "wall, delay, circle, sphere, all"}},
                   {{"reproduce", "wall", "--json", "/no/such/runs.json"}, 1, {"/no/such/runs.json"}},
                   {{"violations", "--seeds", "0"}, 2, {"--seeds", "whole number from 1", "got '0'"}},
                   {{"soak", "--seeds", "0"}, 2, {"--seeds", "whole number from 1", "got '0'"}},
                   {{"soak", "--seeds", "1", "--minutes", "1"}, 2, {"--minutes", "does not go with", "--seeds"}},
                   {{"soak", "--law", "fba-exac"}, 2, {"--law", "'fba-exac', did you mean 'fba-exact'?"}},
                   {{"soak", "--tools", "--law", "vc"}, 2, {"--tools: ", "law 'vc' has one gain"}},
                   {{"passivity", "--seconds", "-1"}, 2, {"--seconds", "above 0", "'-1'"}},
                   {{"passivity", "--csv", "/no/such/leaks.csv"}, 1, {"/no/such/leaks.csv", "No such file"}},
                   {{"trials", "spere"}, 2, {"SCENE", "'spere'", "'sphere'"}},
                   {{"trials", "/no/such/scene.toml"}, 1, {"/no/such/scene.toml", "No such file"}},
                   {{"trials", "--device", "omny"}, 2, {"--device", "'omny'", "'omni'"}},
                   {{"trials", "--operator", "pres"}, 2, {"--operator: ", "'pres'", "'press'"}},
                   {{"trials", "--netem", "latency 5ms"}, 2, {"--netem", "'latency'"}},
                   {{"trials", "--netem", "trace:/no/such.csv"}, 1, {"/no/such.csv", "No such file"}},
                   {{"trials", "--laws", "none,fba"}, 2, {"--laws", "'fba'"}},
                   {{"trials", "--seed", "-1"}, 2, {"--seed", "'-1'"}},
                   {{"trials", "--live", "/no/such.json"}, 1, {"/no/such.json", "No such file"}},
                   {{"bench"}, 2, {"RESULTS is required"}},
                   {{"compare", "--scenes", "spere"}, 2, {"--scenes", "'spere'", "'sphere'"}},
                   {{"compare", "--network", "delay soon"}, 2, {"--network", "'soon'"}},
                   {{"compare", "--device", "omny"}, 2, {"--device", "'omny'"}},
                   {{"compare", "--stiffness", "0"}, 2, {"--stiffness", "above 0"}},
                   {{"compare", "--delays", "-1"}, 2, {"--delays", "'-1'"}},
                   {{"compare", "--seeds", "0"}, 2, {"--seeds", "'0'"}},
                   {{"compare", "--effort", "many"}, 2, {"--effort", "'many'"}},
                   {{"load"}, 2, {"--server", "required"}},
                   {{"load", "--server", "here"}, 2, {"--server", "'here'"}},
                   {{"load", "--server", "x"}, 2, {"--server", "'x'", "127.0.0.1:47800"}},
                   {{"load", "--server", kNowhere, "--limit", "2"}, 2, {"--limit requires --find-most"}},
                   {{"load", "--server", kNowhere, "--find-most", "--clients", "2"},
                    2,
                    {"--clients", "does not go with", "--find-most"}},
                   {{"load", "--server", kNowhere, "--json", ""}, 2, {"--json", "must not be empty"}},
                   {{"load", "--server", kNowhere, "--wait", "idle"}, 2, {"--wait", "'idle'", "ping-pong"}},
                   {{"load", "--server", kNowhere, "--dof", "7"}, 2, {"--dof", "'7'", "1 to 6"}},
                   {{"accuracy", "spere"}, 2, {"SCENE", "'spere'", "'sphere'"}},
                   {{"accuracy", "sphere", "--device", "omny"}, 2, {"--device", "'omny'"}},
                   {{"accuracy", "sphere", "--law", "fba"}, 2, {"--law", "'fba'"}},
                   {{"accuracy", "sphere", "--rtt", "nan"}, 2, {"--rtt", "'nan'", "5ms"}},
                   {{"accuracy", "/no/such/scene.toml", "--rtt", "nan"}, 2, {"--rtt", "'nan'"}},
                   {{"accuracy", "sphere", "--device", "wall-1dof"}, 2, {"--device", "'wall-1dof'", "accepts 3 or 6"}},
                   {{"trials", "sphere", "--device", "wall-1dof"}, 2, {"--device", "'wall-1dof'", "accepts 3 or 6"}},
                   {{"accuracy", "sphere", "--sweep", "law=none,fba-exact", "--hold", "5000"},
                    2,
                    {"--hold, --drop", "hold 5000 ms, drop 1000 ms"}},
                   {{"accuracy", "sphere", "--motion", "wave"}, 2, {"--motion", "'wave'", "press, slide"}},
                   {{"accuracy", "sphere", "--sweep", "foo=1"}, 2, {"--sweep", "'foo'", "law, hold_ms", "have dots"}},
                   {{"accuracy", "sphere", "--sweep", "object.foo.x=1"}, 2, {"--sweep", "'foo'"}},
                   {{"accuracy", "sphere", "--set", "foo.bar=1"}, 2, {"--set", "'foo'"}},
                   {{"identification", "--devices", "0"}, 2, {"--devices", "1 to 1000000", "'0'"}}});
}

TEST(Forcebound, RefusesWhatItCannotUseInOneLine) {
  const TemporaryFolder folder;
  const std::string laws = folder.file("laws.toml");
  write_file(laws, "[fba-more]\nmemory = 1\n");
  const std::string recording = folder.file("bad.mcap");
  write_file(recording, "hello");
  const std::string rows = folder.file("rows.csv");
  write_file(rows, "time_s,x0_m,fe0_N\n0,0,0\n0.001,here,0\n");
  const Words replay{"replay", "--law", "fba-more", "--damping", "30", "--input", rows};
  const auto with = [&](const Words& more) {
    Words words = replay;
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  expect_refusals(kPrograms[4], {},
                  {{{}, 2, {"command is required", "--help"}},
                   {{"dance"}, 2, {"unknown command 'dance'", "report", "client", "keygen"}},
                   {{"tabel"}, 2, {"did you mean 'table'?"}},
                   {{"report", recording}, 1, {recording, "byte 0", "not an MCAP file"}},
                   {{"report", "/no/such/run.mcap"}, 1, {"/no/such/run.mcap", "No such file"}},
                   {{"report"}, 2, {"RECORDING is required", "forcebound report --help"}},
                   {{"table", recording}, 1, {recording, "not an MCAP file"}},
                   {{"replay"}, 2, {"--law", "required"}},
                   {{"replay", "--bogus"}, 2, {"--bogus"}},
                   {with({"--damping-matrix", "1,x"}), 2, {"--damping-matrix", "'x'"}},
                   {with({"--law-parameters", laws}), 1, {laws + ":2: ", "law 'fba-more'", "no parameter 'memory'"}},
                   {with({"--period", "0"}), 2, {"--period", "> 0", "0"}},
                   {with({"--output", "/no/such/out.csv"}), 1, {"/no/such/out.csv"}},
                   {with({"--encoder", "1,x"}), 2, {"--encoder", "'x'"}},
                   {with({"--hold", "long"}), 2, {"--hold: must be a number such as", "'long'"}},
                   {{"table"}, 2, {"RUN is required"}},
                   {{"table", "/no/such.json"}, 1, {"/no/such.json: cannot be read: No such file"}},
                   {{"doctor"}, 2, {"--server", "required"}},
                   {{"doctor", "--server", "here"}, 2, {"--server", "'here'"}},
                   {{"doctor", "--server", "127.0.0.1:0"}, 2, {"--server", "'127.0.0.1:0'", "1 to 65535"}},
                   {{"doctor", "--server", "no-such-host.invalid:1"}, 1, {"host 'no-such-host.invalid'"}},
                   {{"doctor", "--server", kNowhere, "--seconds", "0"}, 2, {"--seconds", "0.1 to 60", "'0'"}},
                   {{"doctor", "--server", kNowhere, "--seconds", "nan"}, 2, {"--seconds", "'nan'"}},
                   {{"doctor", "--server", kNowhere, "--json", ""}, 2, {"--json", "must not be empty"}},
                   {{"doctor", "--server", kNowhere, "--json", "/no/such/found.json"}, 1, {"/no/such/found.json"}},
                   {{"identify"}, 2, {"--device", "required"}},
                   {{"identify", "--device", "omny"}, 2, {"'omny'", "'omni'"}},
                   {{"identify", "--device", "omni", "--known-mass", "0"}, 2, {"--known-mass", "'0'"}},
                   {{"identify", "--device", "omni", "--known-mass", "-0.1"}, 2, {"--known-mass", "'-0.1'"}},
                   {{"identify", "--device", "omni", "--known-mass", "1e9"}, 2, {"--known-mass", "100", "'1e9'"}},
                   {{"identify", "--device", "omni", "--known-mass", "0.1,0.2"}, 2, {"--known-mass", "3 joints", "2"}},
                   {{"identify", "--device", "omni", "--mass-share", "0.1"}, 2, {"--mass-share", "--known-mass"}},
                   {{"clint"}, 2, {"unknown command 'clint'", "did you mean 'client'?"}}});
  // The rows before the bad one are answered.
  const Ran ran = run(kForcebound, replay);
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(lines(ran.out), 2U) << ran.out;
  EXPECT_EQ(lines(ran.err), 1U) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr(rows + ":3: "));
  EXPECT_THAT(ran.err, HasSubstr("'here'"));
}

TEST(Forcebound, RunsTheOtherProgramsWithTheirOwnWordsAndExitCodes) {
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string name = kPrograms[i].name;
    const std::string command = name.substr(name.find('-') + 1);
    EXPECT_EQ(run(kForcebound, {command, "--version"}).out, name + " " + FORCEBOUND_VERSION + "\n");
    const Ran refused = run(kForcebound, {command, "--bogus"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, StartsWith(name + ": unknown option '--bogus'"));
  }
}

TEST(Forcebound, FindsTheOtherProgramsOnThePathAndSaysWhereItLooked) {
  const TemporaryFolder here;
  const TemporaryFolder on_path;
  namespace fs = std::filesystem;
  fs::copy_file(kForcebound, here.path() / "forcebound");
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", on_path.path().c_str(), 1);
  const Ran missing = run((here.path() / "forcebound").c_str(), {"relay", "--version"});
  write_file(on_path.file("forcebound-relay"), "#!/bin/sh\necho \"$0 $*\"\n");
  fs::permissions(on_path.file("forcebound-relay"), fs::perms::owner_all);
  const Ran found = run((here.path() / "forcebound").c_str(), {"relay", "one", "two words"});
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_EQ(lines(missing.err), 1U) << missing.err;
  EXPECT_THAT(missing.err, StartsWith("forcebound: forcebound-relay: No such file or directory"));
  EXPECT_THAT(missing.err, HasSubstr(here.path().string()));
  EXPECT_THAT(missing.err, HasSubstr("on PATH"));
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.out, EndsWith("forcebound-relay one two words\n"));
}

}  // namespace
}  // namespace forcebound::test
