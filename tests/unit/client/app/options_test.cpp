#include "forcebound/client/app/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/client/app/live_track.hpp"
#include "forcebound/program/command_line.hpp"

namespace forcebound::client {
namespace {

TEST(ClientOptions, RenderLocallyUnlessRemoteIsSaid) {
  const std::array unsaid{"forcebound-client", "--server", "127.0.0.1:47800"};
  EXPECT_TRUE(parse_options(static_cast<int>(unsaid.size()), unsaid.data()).client.renders_locally);
  const std::array arguments{"forcebound-client", "--server", "127.0.0.1:47800", "--rendering", "remote"};
  EXPECT_FALSE(parse_options(static_cast<int>(arguments.size()), arguments.data()).client.renders_locally);
}

TEST(ClientOptions, RefuseLocalRenderingWithALawThatHasAServerSideLaw) {
  std::array words{"forcebound-client", "--server", "127.0.0.1:47800", "--law", "tdpa-er", "--rendering", "local"};
  const auto parsed = [&](std::size_t count) { return parse_options(static_cast<int>(count), words.data()); };
  EXPECT_THAT([&] { (void)parsed(words.size()); },
              testing::ThrowsMessage<std::invalid_argument>(
                  "--rendering local: all forces go through the server-side law of 'tdpa-er'; accepted are --rendering "
                  "remote, or a law other than pspm, tdpa-2port, tdpa-er, tla, wave"));
  EXPECT_NO_THROW((void)parsed(words.size() - 2)) << "it is remote then";
  words.back() = "remote";
  EXPECT_FALSE(parsed(words.size()).client.renders_locally);
}

Options with_rate(const char* rate_Hz) {
  const std::array words{"forcebound-client", "--server", "127.0.0.1:47800", "--rate", rate_Hz};
  return parse_options(static_cast<int>(words.size()), words.data());
}

TEST(ClientOptions, LeaveTheRateToTheDeviceUnlessOneIsSaid) {
  const std::array unsaid{"forcebound-client", "--server", "127.0.0.1:47800"};
  EXPECT_EQ(parse_options(static_cast<int>(unsaid.size()), unsaid.data()).device.rate_Hz, 0);
  EXPECT_EQ(with_rate("500").device.rate_Hz, 500);
  EXPECT_EQ(with_rate("4000").device.rate_Hz, 4000);
}

TEST(ClientOptions, RefuseARateThatNoLoopRunsAt) {
  for (const char* const rate_Hz : {"499.9", "4000.1", "0", "-1000", "nan", "fast"}) {
    SCOPED_TRACE(rate_Hz);
    EXPECT_THROW((void)with_rate(rate_Hz), program::End);
  }
}

Options with(const std::vector<const char*>& more) {
  std::vector<const char*> words{"forcebound-client", "--server", "127.0.0.1:47800"};
  words.insert(words.end(), more.begin(), more.end());
  return parse_options(static_cast<int>(words.size()), words.data());
}

TEST(ClientOptions, ServeAPageOnlyIfAsked) {
  EXPECT_FALSE(with({}).page.has_value());
  EXPECT_EQ(with({"--page"}).page->port, page::kClientPort);
  EXPECT_EQ(with({"--page"}).page->host, "127.0.0.1");
  EXPECT_EQ(with({"--page", "5000"}).page->port, 5000);
  EXPECT_EQ(with({"--page", "0.0.0.0:5000"}).page->host, "0.0.0.0");
  EXPECT_EQ(with({"--page", "--scene", "wall"}).client.scene, "wall");
  EXPECT_THROW((void)with({"--page", "nowhere"}), std::invalid_argument);
  EXPECT_THROW((void)with({"--relay-control", "127.0.0.1:1"}), program::End);
}

TEST(ClientOptions, TakeAPointerForTheHandWithAPageAndADeviceThatSuitsTheScene) {
  EXPECT_EQ(with({"--page"}).device.hand, "pointer");
  EXPECT_EQ(with({"--page"}).device.device, "omni");
  EXPECT_EQ(with({"--page", "--scene", "dome"}).device.device, "firm-3dof");
  EXPECT_EQ(with({"--page", "--device", "wall-1dof"}).device.hand, "pointer");
  EXPECT_EQ(with({"--page", "--operator", "press"}).device.hand, "press");
  EXPECT_EQ(with({"--page", "--operator", "press"}).device.device, "wall-1dof");
  EXPECT_EQ(with({}).device.hand, "press");
}

TEST(RunFiles, AreNumberedFromTheSecondOn) {
  EXPECT_EQ(file_of_run("out/run.mcap", 1), "out/run.mcap");
  EXPECT_EQ(file_of_run("out/run.mcap", 2), "out/run-2.mcap");
  EXPECT_EQ(file_of_run("run.mcap", 1, true), "run-beside.mcap");
  EXPECT_EQ(file_of_run("run.mcap", 3, true), "run-3-beside.mcap");
  EXPECT_EQ(file_of_run("", 3), "");
}

}  // namespace
}  // namespace forcebound::client
